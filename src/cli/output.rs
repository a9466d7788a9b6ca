//! Where results go: names of files, what must not be written over, how far the work has got.

use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::ensure;
use indicatif::{ProgressBar, ProgressStyle};
use photosurface::jobs::check_outputs;
use photosurface::write::{Format, write_whole};
use photosurface::{Cancelled, Progress};

use super::messages::{Verbosity, print};

/// As `export` writes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum FileFormat {
    Glb,
    Gltf,
    Ply,
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
    let written = written.into_iter().filter(|file| !is_stdout(file));
    Ok(check_outputs(written, read)?)
}

/// Whether a table for people goes to stdout: not where its JSON or its CSV does. Both cannot.
pub(super) fn shows_table(json: Option<&Path>, csv: Option<&Path>) -> anyhow::Result<bool> {
    let [json, csv] = [json, csv].map(|file| file.is_some_and(is_stdout));
    ensure!(!(json && csv), "--json and --csv cannot both go to stdout");
    Ok(!json && !csv)
}

/// Writes a result to stdout or to a file, which appears whole or not at all.
pub(super) fn write_result(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if is_stdout(path) {
        return print(|out| Ok(out.write_all(bytes)?));
    }
    Ok(write_whole(path, |writer| Ok(writer.write_all(bytes)?))?)
}

/// A bar of so many things, on a terminal.
fn progress_bar(length: usize, things: &str, verbosity: Verbosity) -> ProgressBar {
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

/// A bar that shows how far a job has got.
pub(super) struct Bar(ProgressBar);

impl Bar {
    /// A bar of so many things, on a terminal.
    pub(super) fn new(length: usize, things: &str, verbosity: Verbosity) -> Self {
        Self(progress_bar(length, things, verbosity))
    }

    /// The job is done: the bar goes.
    pub(super) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&self, pieces: usize) {
        self.0.set_length(pieces as u64);
    }

    fn advance(&self, pieces: usize) -> Result<(), Cancelled> {
        self.0.inc(pieces as u64);
        Ok(())
    }
}
