//! Formats of films.

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A name that does not say the format of a film.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: unknown extension of a film, expected .gif, .png (APNG), .webp or .mp4", .0.display())]
pub struct FilmFormatError(pub PathBuf);

/// A format of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// GIF: shown everywhere; 256 colours in each frame.
    Gif,
    /// Animated PNG, without loss.
    Apng,
    /// Animated WebP, without loss.
    WebP,
    /// H.264 in MP4, made by the program `ffmpeg`.
    Mp4,
}

impl FilmFormat {
    /// The format that the extension of a name says.
    ///
    /// # Errors
    ///
    /// The extension is none of `.gif`, `.png`, `.apng`, `.webp` and `.mp4`, in capitals or not.
    pub fn from_path(path: &Path) -> Result<Self, FilmFormatError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "gif" => Ok(Self::Gif),
            "png" | "apng" => Ok(Self::Apng),
            "webp" => Ok(Self::WebP),
            "mp4" => Ok(Self::Mp4),
            _ => Err(FilmFormatError(path.to_owned())),
        }
    }
}

impl Display for FilmFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gif => "a GIF",
            Self::Apng => "an animated PNG",
            Self::WebP => "an animated WebP",
            Self::Mp4 => "an MP4",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_says_the_format() {
        let of = |name: &str| FilmFormat::from_path(Path::new(name));
        assert_eq!(of("a/b.c.MP4").unwrap(), FilmFormat::Mp4);
        assert_eq!(of("-x.Png").unwrap(), FilmFormat::Apng);
        for wrong in ["film", "film.mov", ".gif", ""] {
            let message = of(wrong).unwrap_err().to_string();
            assert!(
                message.contains(".gif, .png (APNG), .webp or .mp4"),
                "{message}"
            );
        }
    }
}
