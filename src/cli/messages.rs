//! What the user is told, on stderr.

use std::fmt::Display;
use std::fs;
use std::io::{self, StdoutLock, Write, stderr, stdout};
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, ensure};

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

    /// Whether details are told.
    pub(super) fn is_verbose(self) -> bool {
        self.verbose
    }

    /// Something the user should know about the input.
    pub(super) fn note(self, note: impl Display) {
        if let Ok(mut notes) = NOTES.lock() {
            notes.push(note.to_string());
        }
        if !self.quiet {
            say(format_args!("note: {note}"));
        }
    }

    /// A note that was found, or an error that was met, where nobody was told of it.
    pub(super) fn retold(self, note: impl Display) {
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

/// All notes of this process, told or not, for results that hold them.
static NOTES: Mutex<Vec<String>> = Mutex::new(vec![]);

/// What the user should know, in the order in which it was found.
pub(super) fn notes_so_far() -> Vec<String> {
    NOTES.lock().map_or(vec![], |notes| notes.clone())
}

/// One error with its causes, in one line.
pub(super) fn error(error: &anyhow::Error) {
    say(format_args!("error: {error:#}"));
}

/// One line on stderr. Where nobody can be told (a full disk, a closed pipe) the work goes on, and the exit
/// status still says how it ended.
///
/// It may have texts of files in it, which are shown and never obeyed.
fn say(message: impl Display) {
    let _ = writeln!(stderr().lock(), "{}", shown(&message.to_string()));
}

/// Of a message, or a text in it, no more characters than so many are shown, of its beginning and of its end.
const MAX_SHOWN: (usize, usize) = (1200, 600);

/// A text in one line as a terminal may have it: what would move the cursor, colour what follows, begin a line of its own
/// or turn the direction of writing is written out, and the middle of what is very long is left out.
pub(super) fn shown(text: &str) -> String {
    let acts = |c: char| {
        c.is_control()
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let mut line = String::with_capacity(text.len().min(8000));
    let mut add = |part: &str| {
        for c in part.chars() {
            match acts(c) {
                true => line.extend(c.escape_default()),
                false => line.push(c),
            }
        }
    };
    let (first, last) = MAX_SHOWN;
    let mut starts = text.char_indices().map(|(start, _)| start);
    match starts.nth(first + last) {
        None => add(text),
        Some(_) => {
            let place = |count: usize| text.char_indices().nth(count).map(|(start, _)| start);
            let end = text
                .char_indices()
                .rev()
                .nth(last - 1)
                .map(|(start, _)| start);
            add(&text[..place(first).unwrap_or(text.len())]);
            add(" ... ");
            add(&text[end.unwrap_or(0)..]);
        }
    }
    line
}

/// Writes a result to stdout and makes sure that all of it has gone out.
pub(super) fn print(
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    ensure!(
        !stdout_is_closed(),
        "stdout: it is closed, expected a file or a pipe"
    );
    print_if_open(write)
}

/// The same for what a program may well want to throw away, and only know the exit status.
pub(super) fn print_if_open(
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut out = Watched {
        out: stdout().lock(),
        has_failed: false,
    };
    let written = write(&mut out).and_then(|()| Ok(out.flush()?));
    // What else goes wrong names its own place.
    match out.has_failed {
        true => written.context("stdout"),
        false => written,
    }
}

/// Whether stdout was closed when the program began. The runtime opens `/dev/null` in its place, for reading and writing,
/// so that all that is written would go well; a shell opens it for writing alone.
pub(super) fn stdout_is_closed() -> bool {
    let leads_nowhere =
        fs::read_link("/proc/self/fd/1").is_ok_and(|place| place == Path::new("/dev/null"));
    let about = fs::read_to_string("/proc/self/fdinfo/1").unwrap_or_default();
    let flags = about.lines().find_map(|line| line.strip_prefix("flags:"));
    let flags = flags.and_then(|flags| u32::from_str_radix(flags.trim(), 8).ok());
    const READ_AND_WRITE: u32 = 2;
    leads_nowhere && flags.is_some_and(|flags| flags & 3 == READ_AND_WRITE)
}

/// Stdout, and whether it has ever failed.
struct Watched {
    out: StdoutLock<'static>,
    has_failed: bool,
}

impl Write for Watched {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes);
        let failed = |error: &io::Error| error.kind() != io::ErrorKind::Interrupted;
        self.has_failed |= written.as_ref().is_err_and(failed);
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.out.flush();
        self.has_failed |= flushed.is_err();
        flushed
    }
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
    fn texts_are_shown_and_never_obeyed() {
        assert_eq!(super::shown("立方体 \"é\" kept"), "立方体 \"é\" kept");
        let forged = super::shown("a\u{1b}[31m\nnote: all is well\r\u{9b}2J\u{202e}z");
        assert_eq!(
            forged,
            "a\\u{1b}[31m\\nnote: all is well\\r\\u{9b}2J\\u{202e}z"
        );
        let long = format!("begin{}end", "é".repeat(100_000));
        let short = super::shown(&long);
        assert!(short.chars().count() < 2000);
        assert!(short.starts_with("begin") && short.ends_with("end"));
    }

    #[test]
    fn thousands_are_set_off() {
        let texts: Vec<_> = [0, 999, 1000, 75730, 1234567].map(super::grouped).into();
        assert_eq!(texts, ["0", "999", "1,000", "75,730", "1,234,567"]);
    }
}
