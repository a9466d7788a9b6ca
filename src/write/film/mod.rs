//! Films: pictures that follow each other in one file, written one by one, so that no frame stays in memory.

mod apng;
mod error;
mod ffmpeg;
mod format;
mod gif;
mod mp4;
mod palette;
mod rate;
mod settings;
mod webp;
mod writer;

pub use error::FilmError;
pub use format::{FilmFormat, FilmFormatError};
pub use rate::{FrameRate, FrameRateError};
pub use settings::FilmSettings;
pub use writer::FilmWriter;
