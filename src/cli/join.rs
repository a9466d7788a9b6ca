//! `photosurface join`: pictures that were made one by one become a film.

use std::path::PathBuf;

use anyhow::{Context, anyhow, ensure};
use photosurface::Progress;
use photosurface::jobs::Rendered;
use photosurface::read::read_whole;
use photosurface::render::Picture;
use photosurface::write::FrameRate;

use super::film::{Film, frame_rate};
use super::messages::{Verbosity, counted};
use super::output::{Bar, check_destinations, is_stdout};
use super::status::Status;

/// No picture is longer than so many bytes.
const MAX_PICTURE_BYTES: u64 = 1 << 31;

/// Join pictures to a film
///
/// The pictures, .png files of one size such as render writes, become the frames of a film in the order in which they are
/// named, without loss in an APNG or a WebP. So a film may be made in parts, on several machines.
#[derive(Debug, clap::Args)]
pub(super) struct JoinArgs {
    /// The pictures (.png), such as frame_step*.png
    #[arg(value_name = "PICTURE", required = true)]
    pictures: Vec<PathBuf>,
    /// The film: .gif, .png (APNG), .webp, or .mp4, which needs the program ffmpeg; - for an APNG on stdout
    #[arg(short, long, value_name = "FILE", help_heading = "Film")]
    output: PathBuf,
    /// Frames per second, from 1 to 120, of a .gif at most 50 [default: 25]
    #[arg(long, value_name = "N", value_parser = frame_rate, allow_hyphen_values = true, help_heading = "Film")]
    fps: Option<FrameRate>,
    /// Show the film once; by default it begins anew when it has ended. Whether an .mp4 does is up to the player
    #[arg(long, help_heading = "Film")]
    no_loop: bool,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &JoinArgs) -> anyhow::Result<Status> {
    let film = Film::new(&args.output, args.fps, args.no_loop)?;
    ensure!(
        args.pictures.len() > 1,
        "a film has at least two frames, and there is one picture"
    );
    if !is_stdout(film.path) {
        check_destinations([film.path.to_owned()], &args.pictures)?;
    }
    let read = |path: &PathBuf| -> anyhow::Result<Picture> {
        let place = || path.display().to_string();
        let bytes = read_whole(path, MAX_PICTURE_BYTES)?;
        let picture = Picture::from_png(&bytes).map_err(|error| anyhow!(error));
        picture.with_context(place)
    };
    let first = read(&args.pictures[0])?;
    let size = first.size();
    let bar = Bar::new(args.pictures.len(), "frames", args.verbosity);
    let count = args.pictures.len();
    let joined = film.record(size, count, |frame| {
        for (number, path) in args.pictures.iter().enumerate() {
            let picture = match number {
                0 => first.clone(),
                _ => read(path)?,
            };
            ensure!(
                picture.size() == size,
                "{}: has {}x{} pixels, expected {}x{}, as the first picture has",
                path.display(),
                picture.size().width(),
                picture.size().height(),
                size.width(),
                size.height()
            );
            frame(number, &picture)?;
            bar.advance(1)?;
        }
        Ok(Rendered::default())
    });
    bar.finish();
    joined?;
    if !is_stdout(film.path) {
        args.verbosity.result(format_args!(
            "{}: {}, {}",
            film.path.display(),
            counted(count, "frame"),
            film.length(count)
        ));
    }
    Ok(Status::Done)
}
