//! Films: pictures that follow each other in one file, written one by one, so that no frame stays in memory.

mod apng;
mod error;
mod ffmpeg;
mod format;
mod gif;
mod mp4;
mod palette;
mod rate;
mod webp;
mod writer;

pub use error::FilmError;
pub use format::FilmFormat;
pub use rate::FrameRate;
pub use writer::{FilmSettings, FilmWriter};
