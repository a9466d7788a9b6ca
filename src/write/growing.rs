//! A file that grows piece by piece, in one hand, and appears when it is finished.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::WriteError;
use super::file::{Destination, Unfinished, io_error, temporary_beside};

/// As [`write_whole`](super::write_whole) writes a file, for whoever has the content only in pieces. Where it is dropped
/// before it is finished, what stood there is kept.
pub(super) struct Growing(Kind);

enum Kind {
    Whole {
        unfinished: Box<Unfinished>,
        place: PathBuf,
    },
    /// A device or a pipe, which is written to as it is.
    Special(File),
}

impl Growing {
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn begin(path: &Path) -> Result<Self, WriteError> {
        let here = |source| io_error(path, source);
        Ok(Self(match Destination::of(path)? {
            Destination::Special(place) => {
                let file = File::options().write(true).open(place);
                Kind::Special(file.map_err(here)?)
            }
            Destination::Regular(place) => Kind::Whole {
                unfinished: Box::new(temporary_beside(&place).map_err(here)?),
                place,
            },
        }))
    }

    /// Where the file grows; nowhere if it is a device or a pipe.
    pub(super) fn unfinished_path(&self) -> Option<&Path> {
        match &self.0 {
            Kind::Whole { unfinished, .. } => Some(unfinished.path()),
            Kind::Special(_) => None,
        }
    }

    pub(super) fn file(&mut self) -> &mut File {
        match &mut self.0 {
            Kind::Whole { unfinished, .. } => unfinished.file(),
            Kind::Special(file) => file,
        }
    }

    /// Writes over bytes that are there, of a file that is no device.
    pub(super) fn patch(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        let file = self.file();
        file.seek(SeekFrom::Start(place))?;
        file.write_all(bytes)
    }

    /// Gives the file its name.
    pub(super) fn finish(self) -> io::Result<()> {
        match self.0 {
            Kind::Whole { unfinished, place } => unfinished.persist(&place),
            Kind::Special(mut file) => file.flush(),
        }
    }
}
