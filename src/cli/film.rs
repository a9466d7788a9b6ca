//! Flags of films, and how pictures become one.

use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use photosurface::Scene;
use photosurface::jobs::Rendered;
use photosurface::render::{Picture, PictureSize};
use photosurface::scene::even_steps;
use photosurface::write::{FilmError, FilmFormat, FilmSettings, FilmWriter, FrameRate};

use super::args::refuse;
use super::messages::print;
use super::output::is_stdout;
use super::values::number;

/// Length of a film in seconds, if nothing else is said.
const SECONDS: f64 = 8.0;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Film")]
pub(super) struct FilmArgs {
    /// Write the pictures of all steps as one film instead of a file for each: .gif, .png (APNG), .webp, or .mp4, which needs
    /// the program ffmpeg; - for an APNG on stdout. Its frames are evenly spaced proper times from the scene's first step
    /// to its last one, or those of --steps
    #[arg(long, value_name = "FILE", conflicts_with_all = ["output", "sheet", "together"])]
    film: Option<PathBuf>,
    /// Frames per second, from 1 to 120, of a .gif at most 50 [default: 25]
    #[arg(long, value_name = "N", requires = "film", value_parser = frame_rate, allow_hyphen_values = true)]
    fps: Option<FrameRate>,
    /// Length of the film in seconds, without --steps [default: 8]
    #[arg(long, value_name = "S", requires = "film", value_parser = number, allow_hyphen_values = true)]
    seconds: Option<f64>,
    /// Show the film once; by default it begins anew when it has ended. Whether an .mp4 does is up to the player
    #[arg(long, requires = "film")]
    no_loop: bool,
}

/// A film that is asked for.
pub(super) struct Film<'a> {
    pub(super) path: &'a Path,
    format: FilmFormat,
    rate: FrameRate,
    seconds: Option<f64>,
    loops: bool,
}

impl FilmArgs {
    /// The file of the film, if there is to be one.
    pub(super) fn path(&self) -> Option<&Path> {
        self.film.as_deref()
    }

    /// The film, if one is asked for.
    pub(super) fn film(&self) -> anyhow::Result<Option<Film<'_>>> {
        let Some(path) = self.film.as_deref() else {
            return Ok(None);
        };
        let film = Film::new(path, self.fps, self.no_loop)?;
        Ok(Some(Film {
            seconds: self.seconds,
            ..film
        }))
    }
}

impl<'a> Film<'a> {
    /// A film in the format of its file, on stdout an APNG.
    pub(super) fn new(
        path: &'a Path,
        rate: Option<FrameRate>,
        is_shown_once: bool,
    ) -> anyhow::Result<Self> {
        let format = match is_stdout(path) {
            true => {
                ensure!(
                    !stdout().is_terminal(),
                    "a film is not text for a terminal; send stdout to a file or a pipe"
                );
                FilmFormat::Apng
            }
            false => FilmFormat::from_path(path)?,
        };
        if format == FilmFormat::Mp4 {
            let once = [("--no-loop", is_shown_once)];
            refuse(
                &once,
                "is for .gif, .png and .webp; whether an .mp4 begins anew is up to the player",
            )?;
        }
        Ok(Self {
            path,
            format,
            rate: rate.unwrap_or_default(),
            seconds: None,
            loops: !is_shown_once,
        })
    }
}

impl Film<'_> {
    /// The scene with a step for each frame; `are_given` is whether --steps says which.
    pub(super) fn scene(&self, scene: Scene, are_given: bool) -> anyhow::Result<Scene> {
        let steps = scene.steps();
        let (first, last) = (steps.first().copied(), steps.last().copied());
        let (Some(first), Some(last)) = (first, last) else {
            return Ok(scene);
        };
        if are_given {
            let given = [("--seconds", self.seconds.is_some())];
            refuse(
                &given,
                "is for a film without --steps, which says each frame; choose --fps",
            )?;
            ensure!(
                steps.len() > 1,
                "--film: --steps has one step, expected at least two, such as --steps=-6..6/200"
            );
            return Ok(scene);
        }
        ensure!(
            first != last,
            "--film: the scene has one step; give the proper times of the first and the last frame and the number of frames, \
             such as --steps=-6..6/200, or --steps=pass"
        );
        let seconds = self.seconds.unwrap_or(SECONDS);
        let frames = (seconds * self.rate.get()).round();
        ensure!(
            frames >= 2.0,
            "--seconds is {seconds:?}, {} frames a second; expected at least two frames",
            self.rate.get()
        );
        let steps = even_steps(first, last, frames as usize);
        let steps = steps.with_context(|| format!("--seconds is {seconds:?}, {frames} frames"))?;
        Ok(scene.with_steps(steps)?)
    }

    /// How long so many frames are shown.
    pub(super) fn length(&self, frames: usize) -> String {
        format!("{:.1} s", frames as f64 / self.rate.get())
    }

    /// Makes the film of the pictures that `draw` hands over one by one.
    pub(super) fn record(
        &self,
        size: PictureSize,
        frames: usize,
        draw: impl FnOnce(
            &mut dyn FnMut(usize, &Picture) -> anyhow::Result<()>,
        ) -> anyhow::Result<Rendered>,
    ) -> anyhow::Result<Rendered> {
        let settings = FilmSettings {
            format: self.format,
            size,
            frames,
            rate: self.rate,
            loops: self.loops,
        };
        let record = |mut film: FilmWriter<'_>| {
            let rendered = draw(&mut |_, picture| Ok(film.frame(picture)?))?;
            film.finish()?;
            Ok(rendered)
        };
        if !is_stdout(self.path) {
            return FilmWriter::create(self.path, settings)
                .map_err(anyhow::Error::new)
                .and_then(record)
                .map_err(|error| self.named(error));
        }
        let mut rendered = None;
        print(|out| {
            rendered = Some(record(FilmWriter::stream(out, settings)?)?);
            Ok(())
        })?;
        rendered.context("the film has been written")
    }

    /// An error of the film with the place that it is about.
    fn named(&self, error: anyhow::Error) -> anyhow::Error {
        match error.downcast_ref::<FilmError>() {
            Some(FilmError::GifRate(_)) => error.context("--fps"),
            // The file's own errors name it.
            None | Some(FilmError::Write(_)) => error,
            Some(_) => error.context(self.path.display().to_string()),
        }
    }
}

/// Frames per second.
pub(super) fn frame_rate(text: &str) -> anyhow::Result<FrameRate> {
    Ok(FrameRate::new(number(text)?)?)
}
