//! Where a glTF file goes: its data as it comes, and its JSON, which is known last.

use std::env::temp_dir;
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use tempfile::SpooledTempFile;

use super::glb::{InPlace, Json, check_size, least_room, padding, write_front};
use super::{Target, WriteError};

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
    form: Form<'a>,
    /// For what has to wait and is too much for memory.
    directory: PathBuf,
}

enum Form<'a> {
    /// JSON, and the data in a file beside it.
    Parts {
        json: &'a mut dyn Write,
        data: &'a mut dyn Write,
        /// Of the file of the data.
        name: String,
    },
    /// A GLB whose data waits until the JSON has gone out.
    Stream {
        out: &'a mut dyn Write,
        data: SpooledTempFile,
    },
    /// A GLB whose data is where it belongs.
    InPlace(InPlace<'a>),
}

impl<'a> GltfOutput<'a> {
    /// A GLB; `meshes` are as many as are expected, for which room is left in a file. More of them, or fewer, make a
    /// good file too.
    ///
    /// What goes to a stream waits, the first 32 MiB in memory and the rest in a temporary file, until all is known.
    pub fn glb(target: Target<'a>, meshes: usize) -> Self {
        match target {
            Target::File { file, directory } => Self {
                form: Form::InPlace(InPlace::new(file, meshes)),
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
            form: Form::Stream { out, data },
            directory: temp_dir(),
        }
    }

    /// JSON with its data in a file beside it, called `binary_name`.
    pub fn gltf(
        binary_name: &str,
        json_writer: &'a mut dyn Write,
        binary_writer: &'a mut dyn Write,
    ) -> Self {
        Self {
            form: Form::Parts {
                json: json_writer,
                data: binary_writer,
                name: utf8_percent_encode(binary_name, IN_REFERENCE).to_string(),
            },
            directory: temp_dir(),
        }
    }

    pub(super) fn directory(&self) -> &Path {
        &self.directory
    }

    /// What the JSON calls the file of the data, where that is one of its own.
    pub(super) fn binary_name(&self) -> Option<String> {
        match &self.form {
            Form::Parts { name, .. } => Some(name.clone()),
            _ => None,
        }
    }

    /// What the JSON has come to, before more data is written.
    pub(super) fn describe(&mut self, meshes: usize, bytes: u64) {
        if let Form::InPlace(file) = &mut self.form {
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
            Form::Parts { .. } => Ok(()),
            Form::Stream { .. } | Form::InPlace(_) => check_size(bytes),
        }
    }

    /// Writes the JSON; there were so many bytes of data.
    ///
    /// # Errors
    ///
    /// More than 4 GiB in a GLB, what waited cannot be read, or the writer fails.
    pub(super) fn finish(self, json: Json, bytes: u64) -> Result<(), WriteError> {
        match self.form {
            Form::Parts {
                json: out, data, ..
            } => {
                data.flush()?;
                json.write_to(out)?;
                out.write_all(b"\n")?;
                Ok(out.flush()?)
            }
            Form::Stream { out, mut data } => {
                let room = least_room(&json);
                write_front(out, json, room, bytes)?;
                data.rewind()?;
                io::copy(&mut data, out)?;
                out.write_all(padding(bytes))?;
                Ok(out.flush()?)
            }
            Form::InPlace(file) => file.finish(json, bytes),
        }
    }
}

/// The data.
impl Write for GltfOutput<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.form {
            Form::Parts { data, .. } => data.write(bytes),
            Form::Stream { data, .. } => data.write(bytes),
            Form::InPlace(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.form {
            Form::Parts { data, .. } => data.flush(),
            Form::Stream { data, .. } => data.flush(),
            Form::InPlace(file) => file.flush(),
        }
    }
}
