//! Films as animated PNG.

use std::cell::RefCell;
use std::io::{self, Write};
use std::rc::Rc;

use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::FilmSettings;
use crate::render::Picture;

/// An animated PNG in the making.
pub(super) struct ApngFilm<W: Write> {
    encoder: png::Writer<Shared<W>>,
    writer: Rc<RefCell<W>>,
}

/// The encoder gives its writer to nobody: it has only a share.
struct Shared<W>(Rc<RefCell<W>>);

impl<W: Write> Write for Shared<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.borrow_mut().flush()
    }
}

impl<W: Write> ApngFilm<W> {
    pub(super) fn new(writer: W, settings: &FilmSettings) -> io::Result<Self> {
        let writer = Rc::new(RefCell::new(writer));
        let share = Shared(writer.clone());
        let mut encoder = Encoder::new(share, settings.size.width(), settings.size.height());
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        let frames = u32::try_from(settings.frames).unwrap_or(u32::MAX);
        let plays = if settings.loops { 0 } else { 1 };
        encoder.set_animated(frames, plays).map_err(as_io)?;
        let (numerator, denominator) = settings.rate.seconds_as_fraction();
        let timed = encoder.set_frame_delay(numerator, denominator);
        timed.map_err(as_io)?;
        let encoder = encoder.write_header().map_err(as_io)?;
        Ok(Self { encoder, writer })
    }

    pub(super) fn frame(&mut self, picture: &Picture) -> io::Result<()> {
        self.encoder
            .write_image_data(picture.bytes())
            .map_err(as_io)
    }

    pub(super) fn finish(self) -> io::Result<W> {
        self.encoder.finish().map_err(as_io)?;
        let writer = Rc::into_inner(self.writer);
        Ok(writer.expect("the encoder's share is gone").into_inner())
    }
}

fn as_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        error => io::Error::other(error),
    }
}
