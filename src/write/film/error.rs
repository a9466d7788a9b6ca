//! Why pictures do not make a film.

use thiserror::Error;

use super::format::{FilmFormat, FilmFormatError};
use super::rate::{FrameRateError, MAX_GIF_RATE};
use crate::write::WriteError;

/// Why pictures do not make a film.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FilmError {
    /// The name of the file does not say the format.
    #[error(transparent)]
    Format(#[from] FilmFormatError),
    /// A frame rate that no film has.
    #[error(transparent)]
    FrameRate(#[from] FrameRateError),
    /// A frame rate that a GIF cannot say.
    #[error(
        "{0} frames per second, but a GIF shows at most {MAX_GIF_RATE}; choose fewer, or a .png (APNG), .webp or .mp4"
    )]
    GifRate(f64),
    /// A frame differs from the others in its size.
    #[error("frame {frame} has {found:?} pixels, expected {expected:?} as in the whole film")]
    FrameSize {
        /// Which frame, from 0.
        frame: usize,
        /// Its width and height.
        found: [u32; 2],
        /// The width and height of the film.
        expected: [u32; 2],
    },
    /// More or fewer frames than were announced.
    #[error("the film has {found} frames, expected {expected}")]
    FrameCount {
        /// Number of frames that were written, or would be.
        found: usize,
        /// Number of frames that were announced.
        expected: usize,
    },
    /// A format that is not written from its beginning to its end.
    #[error("{0} is not written to a pipe or a device; choose a file, or a .gif or a .png (APNG)")]
    NeedsFile(FilmFormat),
    /// More bytes than the format can say.
    #[error(
        "the film would have more than {limit} bytes, which {format} cannot have; choose a smaller size or fewer frames"
    )]
    TooLarge {
        /// Which format.
        format: FilmFormat,
        /// How many bytes it can have.
        limit: u64,
    },
    /// There is no ffmpeg.
    #[error(
        "an .mp4 is made by ffmpeg, which is not on the PATH; install it (Debian and Ubuntu: apt install ffmpeg; \
         macOS: brew install ffmpeg; Windows: winget install ffmpeg), or write a .gif, .png (APNG) or .webp"
    )]
    NoFfmpeg,
    /// This ffmpeg has no encoder for an `.mp4`.
    #[error(
        "this ffmpeg has none of the encoders {expected}; install another one, or write a .gif, .png (APNG) or .webp"
    )]
    NoEncoder {
        /// The names of the encoders that would do.
        expected: String,
    },
    /// ffmpeg says no.
    #[error("ffmpeg failed: {said}")]
    Ffmpeg {
        /// What it says.
        said: String,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
