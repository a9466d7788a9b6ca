//! A program at work that several parts of this one may end.

use std::io;
use std::process::{Child, ExitStatus};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Locked only for moments: nobody waits for the program with the lock held.
#[derive(Clone)]
pub(super) struct SharedChild(Arc<Mutex<Child>>);

impl SharedChild {
    pub(super) fn new(child: Child) -> Self {
        Self(Arc::new(Mutex::new(child)))
    }

    /// How the program has ended, if it has.
    pub(super) fn status(&self) -> io::Result<Option<ExitStatus>> {
        self.lock().try_wait()
    }

    fn lock(&self) -> MutexGuard<'_, Child> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has the program end at once.
    pub(super) fn end(&self) {
        let mut child = self.lock();
        // It may have ended already.
        let _ = child.kill();
        let _ = child.wait();
    }
}
