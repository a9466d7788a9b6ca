//! Films as GIF.

use std::io::{self, Write};

use gif::{Encoder, EncodingError, Frame, Repeat};

use super::palette::paletted;
use super::rate::MAX_GIF_RATE;
use super::{FilmError, FilmSettings};
use crate::render::Picture;

/// A GIF in the making.
pub(super) struct GifFilm<W: Write> {
    encoder: Encoder<W>,
    settings: FilmSettings,
    frames: usize,
}

impl<W: Write> GifFilm<W> {
    pub(super) fn check(settings: &FilmSettings) -> Result<(), FilmError> {
        let rate = settings.rate.get();
        match rate <= MAX_GIF_RATE {
            true => Ok(()),
            false => Err(FilmError::GifRate(rate)),
        }
    }

    pub(super) fn new(writer: W, settings: &FilmSettings) -> io::Result<Self> {
        // No side of a picture has more than 16384 pixels.
        let [width, height] = [settings.size.width(), settings.size.height()].map(|n| n as u16);
        let mut encoder = Encoder::new(writer, width, height, &[]).map_err(as_io)?;
        if settings.loops {
            encoder.set_repeat(Repeat::Infinite).map_err(as_io)?;
        }
        Ok(Self {
            encoder,
            settings: *settings,
            frames: 0,
        })
    }

    pub(super) fn frame(&mut self, picture: &Picture) -> io::Result<()> {
        let made = paletted(picture.bytes().as_chunks().0);
        let frame = Frame {
            delay: self.settings.rate.duration(self.frames, 100.0) as u16,
            width: self.settings.size.width() as u16,
            height: self.settings.size.height() as u16,
            palette: Some(made.palette),
            buffer: made.indices.into(),
            ..Frame::default()
        };
        self.frames += 1;
        self.encoder.write_frame(&frame).map_err(as_io)
    }

    pub(super) fn finish(self) -> io::Result<W> {
        self.encoder.into_inner().map_err(as_io)
    }
}

fn as_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        error => io::Error::other(error),
    }
}
