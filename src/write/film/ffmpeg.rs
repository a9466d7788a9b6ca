//! The program `ffmpeg` that is on the PATH.

use std::io::ErrorKind;
use std::process::{Command, Stdio};

use super::{FilmError, FilmSettings};

/// Encoders of H.264, the best first, and one of what came before it.
const ENCODERS: [&str; 3] = ["libx264", "libopenh264", "mpeg4"];

/// Bits of each pixel of each frame, where an encoder asks for a number of bits and for no quality.
const BITS: f64 = 0.25;

/// Bytes of its messages that are told at most.
const MAX_SAID: usize = 400;

/// A command of ffmpeg that says nothing but errors and asks nothing.
pub(super) fn ffmpeg() -> Command {
    let mut command = Command::new("ffmpeg");
    command.args(["-hide_banner", "-nostdin", "-loglevel", "error"]);
    command
}

/// The encoder that this ffmpeg has.
///
/// # Errors
///
/// There is no ffmpeg, it fails, or it has none of the encoders.
pub(super) fn find_encoder() -> Result<&'static str, FilmError> {
    let asked = ffmpeg().arg("-encoders").stdin(Stdio::null()).output();
    let answer = asked.map_err(not_started)?;
    if !answer.status.success() {
        return Err(failed(&answer.stderr));
    }
    let text = String::from_utf8_lossy(&answer.stdout);
    let has = |encoder: &&str| text.split_whitespace().any(|word| word == *encoder);
    let expected = || FilmError::NoEncoder {
        expected: ENCODERS.join(", "),
    };
    ENCODERS.into_iter().find(has).ok_or_else(expected)
}

/// How the encoder is to choose between size and quality.
pub(super) fn quality(encoder: &str, settings: &FilmSettings) -> Vec<String> {
    let words = |text: &str| text.split(' ').map(str::to_owned).collect();
    match encoder {
        "libx264" => words("-preset medium -crf 18"),
        "mpeg4" => words("-q:v 2"),
        _ => {
            let pixels = f64::from(settings.size.width()) * f64::from(settings.size.height());
            let bits = BITS * pixels * settings.rate.get();
            words(&format!("-b:v {}", bits.max(1e5) as u64))
        }
    }
}

/// Why it could not be started.
pub(super) fn not_started(error: std::io::Error) -> FilmError {
    match error.kind() {
        ErrorKind::NotFound => FilmError::NoFfmpeg,
        _ => FilmError::Ffmpeg {
            said: format!("it cannot be started: {error}"),
        },
    }
}

/// Its last words.
pub(super) fn failed(stderr: &[u8]) -> FilmError {
    let text = String::from_utf8_lossy(&stderr[stderr.len().saturating_sub(MAX_SAID)..]);
    let said = text.trim().trim_start_matches('\u{fffd}').to_owned();
    FilmError::Ffmpeg {
        said: match said.is_empty() {
            true => "it says nothing of why".to_owned(),
            false => said.replace('\n', "; "),
        },
    }
}
