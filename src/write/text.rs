//! Text that may get long: what is beyond a little waits in a temporary file.

use std::fs::File;
use std::io::{self, Seek, Write};
use std::path::Path;

/// So many bytes wait in memory.
const HELD_IN_MEMORY: usize = 1 << 16;

/// What failed was not the output: data waits in a temporary file in `directory`.
pub(super) fn of_temporary_file(directory: &Path, source: io::Error) -> io::Error {
    // tempfile names its file behind what the system says; nobody else knows that file.
    let text = source.to_string();
    let said = text
        .split_once(" at path ")
        .map_or(&*text, |(said, _)| said);
    let place = directory.display();
    io::Error::new(
        source.kind(),
        format!("a temporary file in {place}: {said}"),
    )
}

/// Text to which more is added at its end.
#[derive(Default)]
pub(super) struct LongText {
    /// The end of it.
    held: Vec<u8>,
    /// What comes before.
    spilled: Option<(File, u64)>,
}

impl LongText {
    /// Adds something; what there is no room for in memory goes to a file without a name in `directory`.
    ///
    /// # Errors
    ///
    /// That file cannot be written, or `add` fails.
    pub(super) fn add(
        &mut self,
        directory: &Path,
        add: impl FnOnce(&mut Vec<u8>) -> io::Result<()>,
    ) -> io::Result<()> {
        add(&mut self.held)?;
        if self.held.len() > HELD_IN_MEMORY {
            let spilled = self.spill(directory);
            spilled.map_err(|source| of_temporary_file(directory, source))?;
        }
        Ok(())
    }

    fn spill(&mut self, directory: &Path) -> io::Result<()> {
        let (mut file, length) = match self.spilled.take() {
            Some(spilled) => spilled,
            None => (tempfile::tempfile_in(directory)?, 0),
        };
        file.write_all(&self.held)?;
        self.spilled = Some((file, length + self.held.len() as u64));
        self.held.clear();
        Ok(())
    }

    /// How many bytes there are.
    pub(super) fn len(&self) -> u64 {
        let spilled = self.spilled.as_ref().map_or(0, |(_, length)| *length);
        spilled + self.held.len() as u64
    }

    /// Writes all of it.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or the writer fails.
    pub(super) fn write_to(self, out: &mut dyn Write) -> io::Result<()> {
        if let Some((mut file, _)) = self.spilled {
            file.rewind()?;
            io::copy(&mut file, out)?;
        }
        out.write_all(&self.held)
    }
}

impl From<Vec<u8>> for LongText {
    fn from(held: Vec<u8>) -> Self {
        Self {
            held,
            spilled: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_long_comes_back_as_it_was() {
        let directory = tempfile::tempdir().unwrap();
        for lines in [0, 10, 100_000] {
            let (mut text, mut expected) = (LongText::default(), String::new());
            for line in 0..lines {
                let line = format!("line {line}\n");
                let add = |held: &mut Vec<u8>| held.write_all(line.as_bytes());
                text.add(directory.path(), add).unwrap();
                expected += &line;
            }
            assert!(text.held.capacity() <= 2 * HELD_IN_MEMORY);
            assert_eq!(text.spilled.is_some(), expected.len() > HELD_IN_MEMORY);
            assert_eq!(text.len(), expected.len() as u64);
            let mut back = vec![];
            text.write_to(&mut back).unwrap();
            assert!(back == expected.as_bytes());
        }
        let left = std::fs::read_dir(directory.path()).unwrap().count();
        assert_eq!(left, 0, "the file has no name");
    }
}
