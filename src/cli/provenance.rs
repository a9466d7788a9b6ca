//! What results say of the command and of the files that it read.

use std::path::{Path, PathBuf};

use photosurface::write::Provenance;

use super::args::InputArgs;

/// The command line of this process, and the files that were read.
pub(super) fn provenance(input: &InputArgs, files: &[PathBuf]) -> Provenance {
    let stdin = input.input.iter().filter(|path| *path == Path::new("-"));
    let files = stdin.chain(files);
    let arguments = std::env::args_os().skip(1);
    let arguments = arguments.map(|argument| argument.to_string_lossy().into_owned());
    Provenance {
        // Wherever the program lies, its name is the same.
        command: std::iter::once("photosurface".to_owned())
            .chain(arguments)
            .collect(),
        inputs: files.map(|file| file.display().to_string()).collect(),
        ..Provenance::default()
    }
}
