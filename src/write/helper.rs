//! Another program that writes a file for this one.

use std::io;
use std::process::{ChildStdin, Command, ExitStatus};

use super::child::SharedChild;
use super::file::Writes;

/// A program that is at work for this one. It ends when this is dropped, or with
/// [`abandon_writes`](super::abandon_writes).
pub(super) struct Helper {
    id: u32,
    child: SharedChild,
}

impl Helper {
    /// Starts the program; its stdin, if that is a pipe.
    ///
    /// # Errors
    ///
    /// The program cannot be started, or all writing has been abandoned.
    pub(super) fn start(command: &mut Command) -> io::Result<(Self, Option<ChildStdin>)> {
        // A terminal sends its signals to a whole group: how the program ends is for this one to say.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let mut writes = Writes::going_on()?;
        let mut child = command.spawn()?;
        let stdin = child.stdin.take();
        let id = child.id();
        let child = SharedChild::new(child);
        writes.helpers.insert(id, child.clone());
        Ok((Self { id, child }, stdin))
    }

    /// How the program has ended, if it has.
    pub(super) fn status(&self) -> io::Result<Option<ExitStatus>> {
        self.child.status()
    }
}

impl Drop for Helper {
    fn drop(&mut self) {
        Writes::lock().helpers.remove(&self.id);
        self.child.end();
    }
}
