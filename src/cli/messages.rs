//! What the user is told, on stderr.

use std::fmt::Display;
use std::io::{Write, stderr, stdout};

use anyhow::Context;

/// How much the user wants to be told.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
#[command(next_help_heading = "Messages")]
pub(super) struct Verbosity {
    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Say more: every photosurface, and how long each stage took
    #[arg(short, long)]
    verbose: bool,
}

impl Verbosity {
    /// For a command that has words of its own for the two flags.
    pub(super) fn new(quiet: bool, verbose: bool) -> Self {
        Self { quiet, verbose }
    }

    /// Whether progress and results are told at all.
    pub(super) fn is_quiet(self) -> bool {
        self.quiet
    }

    /// Something the user should know about the input.
    pub(super) fn note(self, note: impl Display) {
        if !self.quiet {
            say(format_args!("note: {note}"));
        }
    }

    /// What was done.
    pub(super) fn result(self, result: impl Display) {
        if !self.quiet {
            say(result);
        }
    }

    /// What only the curious want to know.
    pub(super) fn detail(self, detail: impl Display) {
        if self.verbose {
            say(detail);
        }
    }
}

/// One error with its causes, in one line.
pub(super) fn error(error: &anyhow::Error) {
    say(format_args!("error: {error:#}"));
}

/// One line on stderr. Where nobody can be told (a full disk, a closed pipe) the work goes on, and the exit
/// status still says how it ended.
fn say(message: impl Display) {
    let _ = writeln!(stderr().lock(), "{message}");
}

/// Writes a result to stdout and makes sure that all of it has gone out.
pub(super) fn print(
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut out = stdout().lock();
    write(&mut out)
        .and_then(|()| Ok(out.flush()?))
        .context("stdout")
}

/// Such as "1 triangle", "1,200 triangles", "2 vertices".
pub(super) fn counted(count: usize, singular: &str) -> String {
    let number = grouped(count);
    match (count, singular) {
        (1, _) => format!("{number} {singular}"),
        (_, "vertex") => format!("{number} vertices"),
        _ => format!("{number} {singular}s"),
    }
}

/// A number of bytes as people read it, in powers of a thousand.
pub(super) fn size(bytes: u64) -> String {
    let bytes = bytes as f64;
    // Below what would be printed as 1000.0 of the unit.
    match bytes {
        ..1e3 => format!("{bytes} bytes"),
        ..999.95e3 => format!("{:.1} kB", bytes / 1e3),
        ..999.95e6 => format!("{:.1} MB", bytes / 1e6),
        _ => format!("{:.1} GB", bytes / 1e9),
    }
}

/// A count with its thousands set off, as people read it.
pub(super) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    #[test]
    fn sizes_and_counts_read_well() {
        let sizes = [0, 999, 1000, 999_949, 999_950, 62_500_000, 4_294_967_296].map(super::size);
        assert_eq!(
            sizes,
            [
                "0 bytes",
                "999 bytes",
                "1.0 kB",
                "999.9 kB",
                "1.0 MB",
                "62.5 MB",
                "4.3 GB"
            ]
        );
        assert_eq!(super::counted(1, "triangle"), "1 triangle");
        assert_eq!(super::counted(2000, "vertex"), "2,000 vertices");
    }

    #[test]
    fn thousands_are_set_off() {
        let texts: Vec<_> = [0, 999, 1000, 75730, 1234567].map(super::grouped).into();
        assert_eq!(texts, ["0", "999", "1,000", "75,730", "1,234,567"]);
    }
}
