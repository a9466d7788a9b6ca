//! Bytes in memory, or in a file that is read piece by piece as they are wanted.
//!
//! The data of a large model is as large as the model: held whole beside it, it would take half of all memory.

use std::borrow::Cow;
use std::fs::{File, Metadata};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::ReadError;
use super::access::{Reach, open_ordinary};

/// How many bytes are read at most of a file that does not say how many it has.
const MAX_UNANNOUNCED: u64 = 1 << 30;

/// A run of bytes; several threads may read it at once.
pub(super) enum Bytes<'a> {
    Held(Cow<'a, [u8]>),
    InFile {
        file: Arc<File>,
        path: PathBuf,
        /// Which bytes of the file.
        range: Range<u64>,
    },
}

impl Bytes<'_> {
    /// At most `limit` bytes of an ordinary file, wherever it lies.
    pub(super) fn open(path: &Path, limit: u64) -> Result<Self, ReadError> {
        Self::of_file(open_ordinary(path)?, path, limit)
    }

    /// At most `limit` bytes of a file that another one names.
    pub(super) fn open_in(reach: &Reach, path: &Path, limit: u64) -> Result<Self, ReadError> {
        Self::of_file(reach.open(path)?, path, limit)
    }

    fn of_file(
        (file, metadata): (File, Metadata),
        path: &Path,
        limit: u64,
    ) -> Result<Self, ReadError> {
        // Some systems have files that only seem to be empty.
        if metadata.len() == 0 {
            let mut bytes = vec![];
            let limit = limit.min(MAX_UNANNOUNCED);
            io::Read::read_to_end(&mut io::Read::take(file, limit), &mut bytes).map_err(
                |source| ReadError::File {
                    path: path.to_owned(),
                    source,
                },
            )?;
            return Ok(Self::Held(bytes.into()));
        }
        Ok(Self::InFile {
            file: file.into(),
            path: path.to_owned(),
            range: 0..metadata.len().min(limit),
        })
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Held(bytes) => bytes.len(),
            Self::InFile { range, .. } => (range.end - range.start) as usize,
        }
    }

    /// All of the bytes, in memory.
    pub(super) fn into_vec(self) -> Result<Vec<u8>, ReadError> {
        let mut buffer = vec![];
        match self {
            Self::Held(bytes) => Ok(bytes.into_owned()),
            Self::InFile { .. } => {
                self.part(0..self.len(), &mut buffer)?;
                Ok(buffer)
            }
        }
    }

    /// Some of the bytes, which are there; read into `buffer` if they have to be.
    pub(super) fn part<'b>(
        &'b self,
        part: Range<usize>,
        buffer: &'b mut Vec<u8>,
    ) -> Result<&'b [u8], ReadError> {
        match self {
            Self::Held(bytes) => Ok(&bytes[part]),
            Self::InFile { file, path, range } => {
                debug_assert!(part.end <= self.len());
                buffer.resize(part.len(), 0);
                let start = range.start + part.start as u64;
                read_exact_at(file, buffer, start).map_err(|source| ReadError::File {
                    path: path.clone(),
                    source,
                })?;
                Ok(buffer)
            }
        }
    }

    /// Some of the bytes, which are there, as bytes of their own.
    pub(super) fn view(&self, part: Range<usize>) -> Bytes<'_> {
        match self {
            Self::Held(bytes) => Bytes::Held(bytes[part].into()),
            Self::InFile { file, path, range } => Bytes::InFile {
                file: file.clone(),
                path: path.clone(),
                range: range.start + part.start as u64..range.start + part.end as u64,
            },
        }
    }

    /// Nothing but some of the bytes, which are there.
    pub(super) fn cut(self, part: Range<usize>) -> Self {
        match self {
            Self::Held(Cow::Borrowed(bytes)) => Self::Held(bytes[part].into()),
            Self::Held(Cow::Owned(bytes)) => Self::Held(bytes[part].to_vec().into()),
            Self::InFile { file, path, range } => Self::InFile {
                file,
                path,
                range: range.start + part.start as u64..range.start + part.end as u64,
            },
        }
    }
}

#[cfg(unix)]
fn read_exact_at(file: &File, buffer: &mut [u8], start: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, start)
}

#[cfg(windows)]
fn read_exact_at(file: &File, mut buffer: &mut [u8], mut start: u64) -> io::Result<()> {
    while !buffer.is_empty() {
        match std::os::windows::fs::FileExt::seek_read(file, buffer, start) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(read) => {
                buffer = &mut buffer[read..];
                start += read as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_part_is_the_same_in_memory_and_in_a_file() {
        let all: Vec<u8> = (0..100).collect();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), &all).unwrap();
        for bytes in [
            Bytes::open(file.path(), 90).unwrap(),
            Bytes::Held((&all[..90]).into()),
            Bytes::Held(all[..90].to_vec().into()),
        ] {
            assert_eq!(bytes.len(), 90);
            assert_eq!(bytes.view(3..5).into_vec().unwrap(), [3, 4]);
            let cut = bytes.cut(20..60);
            assert_eq!(cut.len(), 40);
            // What is left in the buffer does no harm.
            let mut buffer = vec![7; 200];
            assert_eq!(cut.part(5..8, &mut buffer).unwrap(), [25, 26, 27]);
            assert_eq!(cut.view(1..3).into_vec().unwrap(), [21, 22]);
            assert_eq!(cut.cut(39..40).into_vec().unwrap(), [59]);
        }
    }

    #[test]
    fn a_file_cut_short_while_it_is_read_is_an_error_that_names_it() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), [1; 100]).unwrap();
        let bytes = Bytes::open(file.path(), u64::MAX).unwrap();
        file.as_file().set_len(50).unwrap();
        let error = bytes.part(40..60, &mut vec![]).unwrap_err();
        assert!(matches!(error, ReadError::File { path, .. } if path == file.path()));
        assert!(matches!(
            Bytes::open("nowhere.bin".as_ref(), 1),
            Err(ReadError::File { path, .. }) if path == Path::new("nowhere.bin")
        ));
    }
}
