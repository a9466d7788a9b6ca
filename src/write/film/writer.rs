//! Films that are written frame by frame.

use std::io::{BufWriter, Write};
use std::path::Path;

use super::apng::ApngFilm;
use super::gif::GifFilm;
use super::mp4::Mp4Film;
use super::settings::FilmSettings;
use super::webp::{LENGTH_PLACE, WebPFilm};
use super::{FilmError, FilmFormat};
use crate::render::Picture;
use crate::write::WriteError;
use crate::write::file::io_error;
use crate::write::growing::Growing;

/// A film in the making. Each frame is written as soon as it is there, and none is kept. The file appears when the film is
/// finished; if that does not happen, what stood there before stays.
pub struct FilmWriter<'a> {
    encoder: Encoder<'a>,
    settings: FilmSettings,
    frames: usize,
    /// As errors name it; none of a stream.
    path: Option<&'a Path>,
}

type Out<'a> = BufWriter<Sink<'a>>;

enum Encoder<'a> {
    Gif(GifFilm<Out<'a>>),
    Apng(ApngFilm<Out<'a>>),
    WebP(WebPFilm<Out<'a>>),
    Mp4(Box<Mp4Film>),
}

/// Where the bytes go.
enum Sink<'a> {
    File(Growing),
    Stream(&'a mut dyn Write),
}

impl<'a> FilmWriter<'a> {
    /// Begins a film that will be the file `path`. An MP4 starts the program `ffmpeg`.
    ///
    /// # Errors
    ///
    /// The file cannot be written, the format cannot have that frame rate, or there is no ffmpeg.
    pub fn create(path: &'a Path, settings: FilmSettings) -> Result<Self, FilmError> {
        let growing = Growing::begin(path)?;
        if growing.unfinished_path().is_none()
            && matches!(settings.format, FilmFormat::Mp4 | FilmFormat::WebP)
        {
            return Err(FilmError::NeedsFile(settings.format));
        }
        Self::new(Sink::File(growing), settings, Some(path))
    }

    /// Begins a film that goes to a writer as it is made.
    ///
    /// # Errors
    ///
    /// As [`FilmWriter::create`]; also if the format is MP4 or WebP, which are not written from their beginning to their end.
    pub fn stream(writer: &'a mut dyn Write, settings: FilmSettings) -> Result<Self, FilmError> {
        match settings.format {
            FilmFormat::Gif | FilmFormat::Apng => Self::new(Sink::Stream(writer), settings, None),
            format => Err(FilmError::NeedsFile(format)),
        }
    }

    fn new(
        sink: Sink<'a>,
        settings: FilmSettings,
        path: Option<&'a Path>,
    ) -> Result<Self, FilmError> {
        let here = |error| named(path, error);
        let encoder = match (settings.format, sink) {
            (FilmFormat::Mp4, Sink::File(growing)) => {
                Encoder::Mp4(Box::new(Mp4Film::new(growing, &settings)?))
            }
            (FilmFormat::Gif, sink) => {
                GifFilm::<Out<'a>>::check(&settings)?;
                let film = GifFilm::new(BufWriter::new(sink), &settings);
                Encoder::Gif(film.map_err(WriteError::from).map_err(here)?)
            }
            (FilmFormat::Apng, sink) => {
                let film = ApngFilm::new(BufWriter::new(sink), &settings);
                Encoder::Apng(film.map_err(WriteError::from).map_err(here)?)
            }
            (FilmFormat::WebP, sink) => {
                let film = WebPFilm::new(BufWriter::new(sink), &settings);
                Encoder::WebP(film.map_err(|error| of(path, error))?)
            }
            (FilmFormat::Mp4, Sink::Stream(_)) => {
                return Err(FilmError::NeedsFile(FilmFormat::Mp4));
            }
        };
        Ok(Self {
            encoder,
            settings,
            frames: 0,
            path,
        })
    }

    /// Writes the next frame.
    ///
    /// # Errors
    ///
    /// The frame has another size than the film, there are more frames than were announced, the file cannot be written, or
    /// ffmpeg fails.
    pub fn frame(&mut self, picture: &Picture) -> Result<(), FilmError> {
        let (size, expected) = (picture.size(), self.settings.size);
        if size != expected {
            return Err(FilmError::FrameSize {
                frame: self.frames,
                found: [size.width(), size.height()],
                expected: [expected.width(), expected.height()],
            });
        }
        self.frames += 1;
        if self.frames > self.settings.frames {
            return Err(self.wrong_count());
        }
        let path = self.path;
        let written = match &mut self.encoder {
            Encoder::Gif(film) => film.frame(picture),
            Encoder::Apng(film) => film.frame(picture),
            Encoder::WebP(film) => return film.frame(picture).map_err(|error| of(path, error)),
            Encoder::Mp4(film) => return film.frame(picture).map_err(|error| of(path, error)),
        };
        Ok(written.map_err(|error| named(path, error.into()))?)
    }

    /// Ends the film; its file appears.
    ///
    /// # Errors
    ///
    /// There are fewer frames than were announced, the file cannot be written, or ffmpeg fails.
    pub fn finish(self) -> Result<(), FilmError> {
        if self.frames != self.settings.frames {
            return Err(self.wrong_count());
        }
        let path = self.path;
        let here = |error: std::io::Error| named(path, error.into());
        let out = match self.encoder {
            Encoder::Mp4(film) => {
                let growing = film.finish().map_err(|error| of(path, error))?;
                return Ok(growing.finish().map_err(here)?);
            }
            Encoder::Gif(film) => film.finish().map_err(here)?,
            Encoder::Apng(film) => film.finish().map_err(here)?,
            Encoder::WebP(film) => {
                let (mut out, length) = film.finish();
                out.flush().map_err(here)?;
                if let Sink::File(growing) = out.get_mut() {
                    growing
                        .patch(LENGTH_PLACE, &length.to_le_bytes())
                        .map_err(here)?;
                }
                out
            }
        };
        let sink = out.into_inner().map_err(|error| here(error.into_error()))?;
        match sink {
            Sink::File(growing) => Ok(growing.finish().map_err(here)?),
            Sink::Stream(stream) => Ok(stream.flush().map_err(here)?),
        }
    }

    fn wrong_count(&self) -> FilmError {
        FilmError::FrameCount {
            found: self.frames,
            expected: self.settings.frames,
        }
    }
}

/// An error with the file that it is about.
fn named(path: Option<&Path>, error: WriteError) -> WriteError {
    match (error, path) {
        (WriteError::Stream(source), Some(path)) => io_error(path, source),
        (error, _) => error,
    }
}

fn of(path: Option<&Path>, error: FilmError) -> FilmError {
    match error {
        FilmError::Write(error) => named(path, error).into(),
        error => error,
    }
}

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::File(growing) => growing.file().write(bytes),
            Self::Stream(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Self::File(growing) => growing.file().flush(),
            Self::Stream(stream) => stream.flush(),
        }
    }
}
