//! Where a glTF file goes: its data as it comes, and its JSON, which is known last.

use std::env::temp_dir;
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use tempfile::SpooledTempFile;

use super::glb::{InPlace, Json, check_size, min_room, padding, write_front};
use crate::write::text::of_temporary_file;
use crate::write::{Target, WriteError};

/// What may not stand in a relative reference as it is.
const IN_REFERENCE: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'\\');

/// Of the data of a GLB that goes where nothing can be put in front later, no more than so many bytes wait in memory.
const HELD_IN_MEMORY: usize = 1 << 25;

/// Where a glTF file goes.
pub struct GltfOutput<'a> {
    form: Container<'a>,
    /// For what has to wait and is too much for memory.
    directory: PathBuf,
}

enum Container<'a> {
    /// JSON, and the data in a file beside it.
    Parts {
        json: &'a mut dyn Write,
        data: &'a mut dyn Write,
        /// Of the file of the data.
        name: BinaryName<'a>,
    },
    /// A GLB whose data waits until the JSON has gone out.
    Stream {
        out: &'a mut dyn Write,
        data: SpooledTempFile,
    },
    /// A GLB whose data is where it belongs.
    InPlace(InPlace<'a>),
}

/// How the file of the data is called.
enum BinaryName<'a> {
    /// As whoever writes it says.
    Given(&'a str),
    /// By what is in it: `out-1a2b3c4d.bin`.
    OfContent {
        stem: &'a str,
        digest: crc32fast::Hasher,
        /// To be told when it is known.
        told: &'a mut String,
    },
}

impl BinaryName<'_> {
    fn name(&self) -> String {
        match self {
            Self::Given(name) => (*name).to_owned(),
            Self::OfContent { stem, digest, .. } => {
                format!("{stem}-{:08x}.bin", digest.clone().finalize())
            }
        }
    }
}

impl<'a> GltfOutput<'a> {
    /// A GLB; `meshes` are as many as are expected, for which room is left in a file. More of them, or fewer, make a
    /// good file too.
    ///
    /// What goes to a stream waits, the first 32 MiB in memory and the rest in a temporary file, until all is known.
    pub fn glb(target: Target<'a>, meshes: usize) -> Self {
        match target {
            Target::File { file, directory } => Self {
                form: Container::InPlace(InPlace::new(file, meshes)),
                directory: directory.to_owned(),
            },
            Target::Stream(out) => Self::waiting(out, HELD_IN_MEMORY),
        }
    }

    /// A GLB all of whose data waits in memory.
    pub(super) fn from_memory(out: &'a mut dyn Write) -> Self {
        Self::waiting(out, usize::MAX)
    }

    fn waiting(out: &'a mut dyn Write, held_in_memory: usize) -> Self {
        let data = SpooledTempFile::new(held_in_memory);
        Self {
            form: Container::Stream { out, data },
            directory: temp_dir(),
        }
    }

    /// JSON with its data in a file beside it, called `binary_name`.
    pub fn gltf(
        binary_name: &'a str,
        json_writer: &'a mut dyn Write,
        binary_writer: &'a mut dyn Write,
    ) -> Self {
        Self {
            form: Container::Parts {
                json: json_writer,
                data: binary_writer,
                name: BinaryName::Given(binary_name),
            },
            directory: temp_dir(),
        }
    }

    /// JSON with its data in a file beside it, whose name is made of `stem` and of what is in it; `told` what it is when
    /// all is written. What has to wait may do so in `directory`.
    pub(super) fn named_by_content(
        stem: &'a str,
        directory: &Path,
        json_writer: &'a mut dyn Write,
        binary_writer: &'a mut dyn Write,
        told: &'a mut String,
    ) -> Self {
        Self {
            form: Container::Parts {
                json: json_writer,
                data: binary_writer,
                name: BinaryName::OfContent {
                    stem,
                    digest: crc32fast::Hasher::new(),
                    told,
                },
            },
            directory: directory.to_owned(),
        }
    }

    pub(super) fn directory(&self) -> &Path {
        &self.directory
    }

    /// What the JSON calls the file of the data, where that is one of its own; to be asked when all data is written.
    pub(super) fn binary_name(&self) -> Option<String> {
        match &self.form {
            Container::Parts { name, .. } => {
                Some(utf8_percent_encode(&name.name(), IN_REFERENCE).to_string())
            }
            _ => None,
        }
    }

    /// What the JSON has come to, before more data is written.
    pub(super) fn describe(&mut self, meshes: usize, bytes: u64) {
        if let Container::InPlace(file) = &mut self.form {
            file.describe(meshes, bytes);
        }
    }

    /// Whether so much data finds room at all.
    ///
    /// # Errors
    ///
    /// More than 4 GiB in a GLB.
    pub(super) fn check_size(&self, bytes: u64) -> Result<(), WriteError> {
        match self.form {
            Container::Parts { .. } => Ok(()),
            Container::Stream { .. } | Container::InPlace(_) => check_size(bytes),
        }
    }

    /// Writes the JSON; there were so many bytes of data.
    ///
    /// # Errors
    ///
    /// More than 4 GiB in a GLB, what waited cannot be read, or the writer fails.
    pub(super) fn finish(self, json: Json, bytes: u64) -> Result<(), WriteError> {
        match self.form {
            Container::Parts {
                json: out,
                data,
                name,
            } => {
                let called = name.name();
                if let BinaryName::OfContent { told, .. } = name {
                    *told = called;
                }
                data.flush()?;
                json.write_to(out)?;
                out.write_all(b"\n")?;
                Ok(out.flush()?)
            }
            Container::Stream { out, mut data } => {
                let room = min_room(&json);
                write_front(out, json, room, bytes)?;
                copy(&mut data, out, &self.directory)?;
                out.write_all(padding(bytes))?;
                Ok(out.flush()?)
            }
            Container::InPlace(file) => file.finish(json, bytes),
        }
    }
}

/// Copies what waited.
fn copy(from: &mut SpooledTempFile, to: &mut dyn Write, directory: &Path) -> io::Result<()> {
    let waiting = |source| of_temporary_file(directory, source);
    from.rewind().map_err(waiting)?;
    let mut piece = vec![0; 1 << 18];
    loop {
        match from.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(length) => to.write_all(&piece[..length])?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(waiting(error)),
        }
    }
}

/// The data.
impl Write for GltfOutput<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.form {
            Container::Parts { data, name, .. } => {
                let written = data.write(bytes)?;
                if let BinaryName::OfContent { digest, .. } = name {
                    digest.update(&bytes[..written]);
                }
                Ok(written)
            }
            Container::Stream { data, .. } => {
                let written = data.write(bytes);
                written.map_err(|source| of_temporary_file(&self.directory, source))
            }
            Container::InPlace(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.form {
            Container::Parts { data, .. } => data.flush(),
            Container::Stream { data, .. } => data.flush(),
            Container::InPlace(file) => file.flush(),
        }
    }
}
