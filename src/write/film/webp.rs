//! Films as animated WebP: frames without loss in the container of an animation.
//!
//! Source: Google, *WebP Container Specification* (RFC 9649), sections 2.7.1.1 and 2.7.2.

use std::io::{self, Write};

use image_webp::{ColorType, EncodingError, WebPEncoder};

use super::{FilmError, FilmFormat, FilmSettings};
use crate::render::Picture;
use crate::write::WriteError;

/// Bytes of a file before its first chunk: RIFF, its length, WEBP.
const HEAD: usize = 12;

/// What `RIFF` says of its length is at most this.
const MAX_LENGTH: u64 = u32::MAX as u64 - 1;

/// Where the length of the whole file stands.
pub(super) const LENGTH_PLACE: u64 = 4;

/// An animated WebP in the making, whose length is written last.
pub(super) struct WebPFilm<W: Write> {
    writer: W,
    settings: FilmSettings,
    frames: usize,
    /// Bytes after the length.
    length: u64,
}

impl<W: Write> WebPFilm<W> {
    pub(super) fn new(writer: W, settings: &FilmSettings) -> Result<Self, FilmError> {
        const ANIMATION: u32 = 0b10;
        let mut film = Self {
            writer,
            settings: *settings,
            frames: 0,
            length: 4,
        };
        let begun = film.writer.write_all(b"RIFF\0\0\0\0WEBP");
        begun.map_err(WriteError::from)?;
        let mut canvas = ANIMATION.to_le_bytes().to_vec();
        canvas.extend(film.sides());
        film.chunk(b"VP8X", &[&canvas])?;
        let plays: u16 = if settings.loops { 0 } else { 1 };
        film.chunk(b"ANIM", &[&[0; 4], &plays.to_le_bytes()])?;
        Ok(film)
    }

    pub(super) fn frame(&mut self, picture: &Picture) -> Result<(), FilmError> {
        const REPLACES_WHAT_WAS_THERE: u8 = 0b10;
        let [width, height] = [self.settings.size.width(), self.settings.size.height()];
        let mut file = Vec::new();
        let encoder = WebPEncoder::new(&mut file);
        let encoded = encoder.encode(picture.bytes(), width, height, ColorType::Rgb8);
        encoded.map_err(|error| {
            WriteError::from(match error {
                EncodingError::IoError(error) => error,
                error => io::Error::other(error),
            })
        })?;
        let mut about = vec![0; 6];
        about.extend(self.sides());
        let milliseconds = self.settings.rate.duration(self.frames, 1000.0);
        about.extend(&milliseconds.to_le_bytes()[..3]);
        about.push(REPLACES_WHAT_WAS_THERE);
        self.frames += 1;
        // A picture by itself is one chunk, and that chunk is the frame.
        self.chunk(b"ANMF", &[&about, &file[HEAD..]])
    }

    /// The writer, and the length to be written at [`LENGTH_PLACE`].
    pub(super) fn finish(self) -> (W, u32) {
        (self.writer, self.length as u32)
    }

    /// Width and height, each less one, in 24 bits.
    fn sides(&self) -> Vec<u8> {
        let sides = [self.settings.size.width(), self.settings.size.height()];
        let bytes = sides.map(|side| (side - 1).to_le_bytes());
        bytes.iter().flat_map(|bytes| bytes[..3].to_vec()).collect()
    }

    fn chunk(&mut self, name: &[u8; 4], parts: &[&[u8]]) -> Result<(), FilmError> {
        let length: u64 = parts.iter().map(|part| part.len() as u64).sum();
        self.length += 8 + length.next_multiple_of(2);
        if self.length > MAX_LENGTH {
            return Err(FilmError::TooLarge {
                format: FilmFormat::WebP,
                limit: MAX_LENGTH + 8,
            });
        }
        let mut write = || {
            self.writer.write_all(name)?;
            self.writer.write_all(&(length as u32).to_le_bytes())?;
            for part in parts {
                self.writer.write_all(part)?;
            }
            self.writer.write_all(&[0][..(length % 2) as usize])
        };
        Ok(write().map_err(WriteError::from)?)
    }
}
