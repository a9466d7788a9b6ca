//! Names of the files that a job writes, and checks that it overwrites no file that it must not.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::pipeline::step_label;
use crate::write::{WriteError, destination};

/// The path with a suffix before its extension: `out.glb` and `_lod0` make `out_lod0.glb`.
pub fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    if suffix.is_empty() {
        return path.to_owned();
    }
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(suffix);
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// The names of one file for each step: `out_step000.glb`, `out_step001.glb`, ...
pub fn file_for_each_step(path: &Path, steps: usize) -> Vec<PathBuf> {
    let file = |step| with_suffix(path, &format!("_{}", step_label(step)));
    (0..steps).map(file).collect()
}

/// Reasons why a job must not write a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output file is also an input file of the job.
    #[error(
        "the output {} would overwrite the input {}; choose another name for the output",
        output.display(),
        input.display()
    )]
    Input {
        /// The file to be written.
        output: PathBuf,
        /// The file that is read.
        input: PathBuf,
    },
    /// Two outputs are the same file.
    #[error(
        "the output {} would overwrite another output, {}; choose another name for one of them",
        output.display(),
        other.display()
    )]
    Output {
        /// The file to be written.
        output: PathBuf,
        /// The other name of the same file.
        other: PathBuf,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Checks, before any work, that every file of `written` can be written, is not one of the files `read`, and differs
/// from all other files of `written`; links are followed.
///
/// # Errors
///
/// The first file that fails the check.
pub fn check_outputs(
    written: impl IntoIterator<Item = PathBuf>,
    read: &[PathBuf],
) -> Result<(), OutputError> {
    let read: HashMap<PathBuf, &PathBuf> = read
        .iter()
        .filter_map(|file| Some((fs::canonicalize(file).ok()?, file)))
        .collect();
    let mut places: HashMap<PathBuf, PathBuf> = HashMap::new();
    for output in written {
        let place = destination(&output)?;
        if let Some(&input) = read.get(&place) {
            let input = input.clone();
            return Err(OutputError::Input { output, input });
        }
        if let Some(other) = places.get(&place) {
            let other = other.clone();
            return Err(OutputError::Output { output, other });
        }
        places.insert(place, output);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suffixes_come_before_the_extension() {
        let named = |path: &str, suffix| with_suffix(Path::new(path), suffix);
        assert_eq!(named("a/out.glb", "_lod0"), Path::new("a/out_lod0.glb"));
        assert_eq!(named("out", "_lod0"), Path::new("out_lod0"));
        assert_eq!(named("out.x.glb", ""), Path::new("out.x.glb"));
        let steps = file_for_each_step(Path::new("out.glb"), 2);
        assert_eq!(
            steps,
            ["out_step000.glb", "out_step001.glb"].map(PathBuf::from)
        );
    }

    #[test]
    fn inputs_and_other_outputs_are_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        fs::write(file("in.glb"), "").unwrap();
        let around = folder.path().join(".").join("in.glb");
        let read = [file("in.glb")];
        assert!(check_outputs([file("out.glb"), file("other.glb")], &read).is_ok());
        let over_input = check_outputs([around.clone()], &read).unwrap_err();
        assert!(matches!(over_input, OutputError::Input { output, .. } if output == around));
        let over_output = check_outputs([file("in.glb"), around], &[]).unwrap_err();
        assert!(matches!(over_output, OutputError::Output { .. }));
        let nowhere = check_outputs([file("no/out.glb")], &[]).unwrap_err();
        assert!(matches!(nowhere, OutputError::Write(_)));
    }
}
