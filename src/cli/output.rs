//! Where results go: names of files, what must not be written over, how far the work has got.

use std::collections::HashMap;
use std::fs;
use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{bail, ensure};
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use photosurface::{Format, PlacedScene, destination, step_label};

use super::messages::Verbosity;

/// As `export` writes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum FileFormat {
    Glb,
    Gltf,
    Ply,
}

impl FileFormat {
    /// Of the names of its files.
    pub(super) fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Ply => "ply",
        }
    }

    pub(super) fn of_extension(extension: &str) -> Option<Self> {
        let all = Self::value_variants().iter().copied();
        all.into_iter()
            .find(|format| format.extension() == extension)
    }
}

impl From<FileFormat> for Format {
    fn from(format: FileFormat) -> Self {
        match format {
            FileFormat::Glb => Self::Glb,
            FileFormat::Gltf => Self::Gltf,
            FileFormat::Ply => Self::Ply,
        }
    }
}

/// Whether a name means stdout.
pub(super) fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// The extension of a name, in lower case.
pub(super) fn extension(path: &Path) -> Option<String> {
    path.extension()
        .map(|extension| extension.to_string_lossy().to_ascii_lowercase())
}

/// `out.glb` and `_lod0` make `out_lod0.glb`; a stream stays what it is.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    if suffix.is_empty() || is_stdout(path) {
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

/// A file for each step: `out_step000.glb`, `out_step001.glb`, ...
pub(super) fn file_for_each(path: &Path, steps: usize) -> Vec<PathBuf> {
    let file = |step| with_suffix(path, &format!("_{}", step_label(step)));
    (0..steps).map(file).collect()
}

/// Several files in a few words.
pub(super) fn from_first_to_last(files: &[PathBuf]) -> String {
    match files {
        [file] => file.display().to_string(),
        [first, .., last] => format!("{} to {}", first.display(), last.display()),
        [] => unreachable!("a scene has at least one step"),
    }
}

/// Before any work: every file can be written, none is one of those that are `read`, and no two are one.
pub(super) fn check_destinations(
    written: impl IntoIterator<Item = PathBuf>,
    read: &[PathBuf],
) -> anyhow::Result<()> {
    let read: HashMap<PathBuf, &PathBuf> = read
        .iter()
        .filter_map(|file| Some((fs::canonicalize(file).ok()?, file)))
        .collect();
    let mut places: HashMap<PathBuf, PathBuf> = HashMap::new();
    for file in written.into_iter().filter(|file| !is_stdout(file)) {
        let place = destination(&file)?;
        if let Some(input) = read.get(&place) {
            bail!(
                "the output {} would be written over the input {}; choose another name for the output",
                file.display(),
                input.display()
            );
        }
        if let Some(other) = places.get(&place) {
            bail!(
                "the output {} would be written over another output, {}; choose another name for one of them",
                file.display(),
                other.display()
            );
        }
        places.insert(place, file);
    }
    Ok(())
}

/// Whether a file of this format can hold what is seen. Where another one could, the error says so.
pub(super) fn check_range(format: Format, placed: &PlacedScene) -> anyhow::Result<()> {
    let Err(error) = format.check_range(placed) else {
        return Ok(());
    };
    ensure!(
        format == Format::Ply || Format::Ply.check_range(placed).is_err(),
        "{error}; or write a .ply, whose 64-bit numbers hold it"
    );
    Err(error.into())
}

/// A bar of so many things, on a terminal.
pub(super) fn progress_bar(length: usize, things: &str, verbosity: Verbosity) -> ProgressBar {
    if verbosity.is_quiet() || !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(&format!(
        "{{spinner}} {{bar:40}} {{pos}}/{{len}} {things} {{eta}}"
    ))
    .expect("the template is well-formed");
    let bar = ProgressBar::new(length as u64).with_style(style);
    // One thing may take a minute, in which there is to be seen that it goes on.
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
