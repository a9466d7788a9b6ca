//! `photosurface render`: pictures of what the observer sees, and of photosurfaces from anywhere.

use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, bail, ensure};
use photosurface::{
    Camera, Color, DVec3, Facts, Picture, PictureOptions, PictureSize, Precision, Projection,
    Scenery, Stage, Viewpoint, Wanted, write_whole,
};

use super::Status;
use super::accuracy::AccuracyArgs;
use super::args::{InputArgs, ObserverArgs, vector};
use super::input::Input;
use super::messages::{Verbosity, counted, print};
use super::output::{
    check_destinations, extension, file_for_each, from_first_to_last, is_stdout, progress_bar,
};

/// From where everything is looked at if nothing else is said: from above, ahead of the middle and to the right.
const FROM: DVec3 = DVec3::new(0.5, 0.45, 1.0);

/// Room around what is framed.
const FRAME: f64 = 1.1;

/// The narrowest camera that frames something by itself: closer ones would go ever farther away.
const NARROWEST_DEG: f64 = 1.0;

/// Make pictures of what the observer sees, or of photosurfaces from outside
///
/// The observer's view is made by following rays of light back into the rest frame of each object, exact at every
/// pixel, or with --method mesh by looking at the photosurfaces that export would write.
/// Without SCENE or MESH the built-in scene "sphere" is taken:
///
///     photosurface render
///     photosurface render --example street --look 0,0,-1 -o street.png
///     photosurface render --example cube --view outside -o cube.png
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    /// Where to write a .png; of several steps each has a file: out_step000.png, out_step001.png, ...; - for
    /// stdout [default: NAME_VIEW.png in this directory]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    #[command(flatten)]
    verbosity: Verbosity,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Camera (places and directions are in the observer's frame)")]
struct CameraArgs {
    /// What the observer sees, or photosurfaces from any other place
    #[arg(long, value_enum, default_value_t = View::Observer)]
    view: View,
    /// How the observer's view is made; from outside there are photosurfaces only
    /// [default: rays for the observer, mesh from outside]
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1280x720")]
    size: PictureSize,
    /// Field of view from the lower to the upper edge, in degrees, above 0 and below 180
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 60.0,
        allow_negative_numbers = true
    )]
    fov: f64,
    /// Show the whole sky in longitude and latitude instead
    #[arg(long, conflicts_with = "fov")]
    full_sky: bool,
    /// Direction in which the camera looks, of any length [default: to the middle of what is there]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, conflicts_with = "target")]
    look: Option<DVec3>,
    /// Place at which the camera looks, in scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Place of an outside camera, in scene units; the observer is at 0,0,0 [default: so that all of every step
    /// is in the picture]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    from: Option<DVec3>,
    /// Rays a pixel along each side: N for N x N of them, from 1 to 16
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=16))]
    samples: u32,
    /// Colour where nothing is seen, #rrggbb
    #[arg(long, value_name = "COLOR", value_parser = color, default_value = "#14171c")]
    background: Color,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum View {
    /// From the observer's place, with the light that arrives there
    Observer,
    /// From any other place
    Outside,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Follow light back to where it came from
    Rays,
    /// Look at the photosurfaces
    Mesh,
}

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<Status> {
    let camera = &args.camera;
    let method = camera.method()?;
    check_output(args.output.as_deref())?;
    ensure!(
        args.accuracy.level_count() == 1,
        "--lod is for several meshes; render takes one --tolerance"
    );
    let input = Input::read(&args.input, &args.observer, args.verbosity)?;
    let view = match camera.view {
        View::Observer => "observer",
        View::Outside => "outside",
    };
    let path = match &args.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}_{view}.png", input.name)),
    };
    let steps = input.scene.steps().len();
    ensure!(
        steps == 1 || !is_stdout(&path),
        "{steps} steps are as many pictures, they cannot all go to stdout; choose one with --steps"
    );
    let files = match steps {
        1 => vec![path],
        _ => file_for_each(&path, steps),
    };
    check_destinations(files.iter().cloned(), &input.files)?;
    let mut levels = args.accuracy.levels(input.scene)?;
    let (_, scene) = levels.pop().expect("one level was made sure of");
    let stage = Stage::new(scene, input.models);
    render(args, method, stage, &files)
}

/// Makes and writes a picture for every step.
fn render(
    args: &RenderArgs,
    method: Method,
    stage: Stage,
    files: &[PathBuf],
) -> anyhow::Result<Status> {
    let (camera_args, verbosity) = (&args.camera, args.verbosity);
    let wanted = args.accuracy.wanted(Precision::Double);
    let stage = match method {
        Method::Rays => stage,
        Method::Mesh => args.accuracy.within_budget(stage, wanted, verbosity).0,
    };
    let options = PictureOptions {
        samples: camera_args.samples,
        background: camera_args.background,
    };
    let at_rest = match method {
        Method::Rays => Some(at_rest(&stage)?),
        Method::Mesh => None,
    };
    let outside = match camera_args.view {
        View::Outside => Some(camera_args.outside(&stage)?),
        View::Observer => None,
    };
    let (width, height) = (camera_args.size.width(), camera_args.size.height());
    let progress = progress_bar(height as usize * files.len(), "rows", verbosity);
    let observer = stage.scene().observer().world_line();
    let rays = width as usize * height as usize * (options.samples * options.samples) as usize;
    let mut made = Vec::new();
    for (step, file) in files.iter().enumerate() {
        let mapped;
        let scenery = match &at_rest {
            Some(scenery) => scenery,
            None => {
                mapped = photosurfaces(&stage, step, wanted, camera_args.view, &mut made)?;
                &mapped
            }
        };
        let (camera, viewpoint) = match outside {
            Some((camera, place)) => (camera, Viewpoint::Outside(place)),
            None => {
                let proper_time = stage.scene().steps()[step];
                let camera = camera_args.at_observer(&stage, step)?;
                (camera, Viewpoint::Observer(&observer, proper_time))
            }
        };
        let start = Instant::now();
        let picture = scenery.picture(&camera, viewpoint, options, &|| progress.inc(1));
        verbosity.detail(format_args!(
            "{}: {} in {:.3} s",
            file.display(),
            counted(rays, "ray"),
            start.elapsed().as_secs_f64()
        ));
        write(file, &picture)?;
    }
    progress.finish_and_clear();
    if !is_stdout(&files[0]) {
        verbosity.result(format_args!(
            "{}: {}",
            from_first_to_last(files),
            counted(files.len(), "picture")
        ));
    }
    let triangles = made.iter().map(|facts| facts.triangles).sum();
    Ok(match args.accuracy.is_kept(&made, triangles, verbosity) {
        true => Status::Done,
        false => Status::NotCertified,
    })
}

/// All objects in their rest frames.
fn at_rest(stage: &Stage) -> anyhow::Result<Scenery> {
    let mut scenery = Scenery::new();
    for (object, parts) in stage.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part)?;
        }
    }
    Ok(scenery)
}

/// The photosurfaces of one step; from outside with the observer's marker, in which the observer itself would sit.
fn photosurfaces(
    stage: &Stage,
    step: usize,
    wanted: Wanted,
    view: View,
    made: &mut Vec<Facts>,
) -> anyhow::Result<Scenery> {
    let mut scenery = Scenery::new();
    if let (View::Outside, Some(marker)) = (view, stage.marker()) {
        scenery.add_plain(marker)?;
    }
    let objects = stage.scene().objects();
    for surface in stage.photosurfaces(step, wanted) {
        let object = objects
            .iter()
            .find(|object| object.name == surface.facts.object)
            .expect("a photosurface is of an object of its scene");
        scenery.add_photosurface(object, &surface.mesh, surface.material.as_ref())?;
        made.push(surface.facts);
    }
    Ok(scenery)
}

impl CameraArgs {
    fn method(&self) -> anyhow::Result<Method> {
        match (self.view, self.method) {
            (View::Outside, Some(Method::Rays)) => bail!(
                "--method rays is what the observer sees; from outside there are photosurfaces only (--method mesh)"
            ),
            (View::Observer, _) if self.from.is_some() => {
                bail!("--from is for --view outside; the observer is at 0,0,0")
            }
            (View::Outside, _) => Ok(Method::Mesh),
            (View::Observer, method) => Ok(method.unwrap_or(Method::Rays)),
        }
    }

    fn projection(&self) -> Projection {
        match self.full_sky {
            true => Projection::FullSky,
            false => Projection::Pinhole {
                vertical_fov_deg: self.fov,
            },
        }
    }

    /// The camera of the observer at one step.
    fn at_observer(&self, stage: &Stage, step: usize) -> anyhow::Result<Camera> {
        let look = match self.look.or(self.target) {
            Some(look) => look,
            // The middle of the sky that is taken up, not of space: an observer may be in the midst of things.
            None => {
                let directions = rough_places(stage, step).map(DVec3::normalize_or_zero);
                let middle: DVec3 = directions.sum();
                middle.try_normalize().unwrap_or(DVec3::NEG_Z)
            }
        };
        Ok(Camera::new(self.size, self.projection(), look)?)
    }

    /// The camera outside, and its place.
    fn outside(&self, stage: &Stage) -> anyhow::Result<(Camera, DVec3)> {
        let marker = stage
            .marker()
            .and_then(|marker| marker.mesh().bounds())
            .map_or([DVec3::ZERO; 2], |(low, high)| [low, high]);
        let steps = 0..stage.scene().steps().len();
        let places = steps
            .flat_map(|step| rough_places(stage, step))
            .chain(marker);
        let (low, high) = places.fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), place| (low.min(place), high.max(place)),
        );
        let target = self.target.unwrap_or((low + high) / 2.0);
        let radius = (low - target).abs().max((high - target).abs()).length();
        let from = match self.from {
            Some(from) => from,
            None => {
                let aspect = f64::from(self.size.width()) / f64::from(self.size.height());
                let half = self.fov.clamp(NARROWEST_DEG, 179.0).to_radians() / 2.0;
                let half = half.min((half.tan() * aspect).atan());
                let away = match self.look {
                    Some(look) => -look.normalize_or_zero(),
                    None => FROM.normalize(),
                };
                target + away * (FRAME * radius / half.sin())
            }
        };
        let look = self.look.unwrap_or(target - from);
        Ok((Camera::new(self.size, self.projection(), look)?, from))
    }
}

/// Where things are seen at one step, as far as their given vertices say.
fn rough_places(stage: &Stage, step: usize) -> impl Iterator<Item = DVec3> {
    let wanted = Wanted {
        subdivide: false,
        ..Wanted::default()
    };
    stage
        .photosurfaces(step, wanted)
        .flat_map(|surface| surface.mesh.positions().to_vec())
}

fn check_output(output: Option<&Path>) -> anyhow::Result<()> {
    let Some(path) = output else {
        return Ok(());
    };
    if is_stdout(path) {
        ensure!(
            !stdout().is_terminal(),
            "a PNG is no text for a terminal; send stdout to a file or a pipe"
        );
        return Ok(());
    }
    ensure!(
        extension(path).as_deref() == Some("png"),
        "{}: unknown extension, expected .png",
        path.display()
    );
    Ok(())
}

fn write(path: &Path, picture: &Picture) -> anyhow::Result<()> {
    if is_stdout(path) {
        return print(|out| Ok(picture.write_png(out)?));
    }
    write_whole(path, |writer| Ok(picture.write_png(writer)?))
        .with_context(|| path.display().to_string())
}

/// `WxH`
fn size(text: &str) -> anyhow::Result<PictureSize> {
    let (width, height) = text
        .split_once(['x', 'X'])
        .context("expected WxH like 1280x720")?;
    let number = |text: &str| {
        let text = text.trim();
        text.parse()
            .with_context(|| format!("\"{text}\" is no number of pixels, expected a whole number"))
    };
    Ok(PictureSize::new(number(width)?, number(height)?)?)
}

/// `#rrggbb`
fn color(text: &str) -> anyhow::Result<Color> {
    Ok(Color::try_from(text.to_owned())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_colours_are_read() {
        let read = size("640x480").unwrap();
        assert_eq!((read.width(), read.height()), (640, 480));
        for wrong in ["", "640", "0x480", "640x-1", "640x99999", "axb"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(color("#ff0080").unwrap(), Color([255, 0, 128]));
        assert!(color("red").is_err());
    }
}
