//! `photosurface cost`: what accuracy costs in time.

use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;

use anyhow::{anyhow, ensure};
use photosurface::jobs::{Aim, CameraSettings, FieldOfView, FramingError, with_suffix};
use photosurface::render::{CameraError, PictureSize};
use photosurface::scene::Measure;
use photosurface::study::{IntegratorSettings, IntegratorStudy, Made, RaySettings, StudyError};
use photosurface::{CostSettings, CostStudy, DVec3, PlacedScene, Tolerance};

use super::accuracy::tolerance;
use super::args::{Given, InputArgs, ObserverArgs, refuse};
use super::camera::{samples, size};
use super::cost_output::CostOutputArgs;
use super::cost_tables::{
    csv_of_integrators, csv_of_meshes, csv_of_rays, table_of_integrators, tables_of,
};
use super::drawing::DrawingFormat;
use super::input::{Input, tell_of_missing};
use super::messages::{Verbosity, grouped, print_if_open};
use super::models::ModelArgs;
use super::output::{Bar, check_destinations, is_stdout, write_result};
use super::values::{count, number, vector, whole_number};

/// Show what accuracy costs: triangles, bytes, time and memory of meshes over tolerances, rays and time of pictures
///
/// Meshes: for each tolerance, exports all photosurfaces to a temporary file, and lists the triangles made, the least
/// number by theory and the number that uniform subdivision needs; file size, time and memory; the proven bound and the
/// error measured at random places.
///
/// Pictures: for each number of rays per pixel, draws the observer's view at every step by rays of light, and lists the time
/// and the difference from a reference picture with many more, random rays.
///
/// Flights (--integrators): for each integrator and number of steps, lists the time and the error at the end of the
/// observer's flight, against a reference of 30 digits.
///
/// A table of each goes to stdout.
#[derive(Debug, clap::Args)]
pub(super) struct CostArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    meshes: MeshArgs,
    #[command(flatten)]
    pictures: PictureArgs,
    #[command(flatten)]
    output: CostOutputArgs,
    /// Print only the tables, without notes
    #[arg(short, long, help_heading = "Messages")]
    quiet: bool,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Study")]
struct StudyArgs {
    /// Study only meshes or only pictures [default: both]
    #[arg(long, value_enum)]
    only: Option<Half>,
    /// Study the observer's flight instead: the errors of event, velocity and axes at its end, and the time, by closed
    /// forms, by the method of Runge and Kutta and by Euler's, each with 10 to 10,000 steps
    #[arg(long)]
    integrators: bool,
    /// Runs of each tolerance, picture and integrator, at least 1; times are medians
    #[arg(
        long,
        value_name = "N",
        default_value_t = CostSettings::default().repeats,
        value_parser = count,
        allow_hyphen_values = true
    )]
    repeats: NonZeroUsize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Half {
    /// Photosurfaces as meshes, over tolerances
    Meshes,
    /// Pictures by rays of light, over the number of rays per pixel
    Rays,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Meshes")]
struct MeshArgs {
    /// Tolerances to compare, for all objects: fractions of the diagonal (1e-3), lengths in scene units (abs:0.01) or
    /// angles in degrees (deg:0.02), all of one kind [default: 1e-1,1e-2,1e-3,1e-4,1e-5,1e-6]
    #[arg(long, value_name = "T,T,...", value_delimiter = ',', value_parser = tolerance, allow_hyphen_values = true)]
    tolerances: Vec<Tolerance>,
    /// Which distance tolerances limit: points or surface, as in export [default: that of the scene]
    #[arg(long, value_name = "points|surface")]
    measure: Option<Measure>,
    /// Tolerances that need more triangles than this, summed over all photosurfaces, are only predicted [default: 3000000]
    #[arg(long, value_name = "N", value_parser = whole_number, allow_hyphen_values = true)]
    max_triangles: Option<u64>,
    /// Number of random places at which the error of each tolerance is measured, at least 1; the same ones on every run
    /// [default: 200000]
    #[arg(long, value_name = "N", value_parser = count, allow_hyphen_values = true)]
    places: Option<NonZeroUsize>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Pictures (directions are in the observer's frame)")]
struct PictureArgs {
    /// Numbers of rays to compare: N stands for N x N rays per pixel, as in render --samples, from 1 to 16; the reference
    /// has 8 times as many as the largest of them [default: 1,2,4,8]
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', value_parser = samples, allow_hyphen_values = true)]
    pixel_samples: Vec<NonZeroU32>,
    /// Width and height of the pictures in pixels [default: 320x180]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<PictureSize>,
    /// Field of view from the lower to the upper edge, in degrees, above 0 and below 180 [default: that of render]
    #[arg(long, value_name = "DEG", value_parser = number, allow_hyphen_values = true)]
    fov: Option<f64>,
    /// Direction in which the observer looks, of any length [default: that of render for several pictures]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    look: Option<DVec3>,
}

pub(super) fn run(args: &CostArgs) -> anyhow::Result<()> {
    let verbosity = Verbosity::new(args.quiet, false);
    let (output, only) = (&args.output, args.study.only);
    if args.study.integrators {
        return integrators(args, verbosity);
    }
    let drawing = output.drawing()?;
    let shows_tables = output.shows_tables()?;
    ensure!(
        !(output.csv.as_deref().is_some_and(is_stdout) && only.is_none()),
        "--csv: two tables cannot both go to stdout; choose one with --only meshes or --only rays"
    );
    match only {
        Some(Half::Meshes) => refuse(
            &args.pictures.given(),
            "is for pictures, which --only meshes leaves out",
        )?,
        Some(Half::Rays) => refuse(
            &args.meshes.given(),
            "is for meshes, which --only rays leaves out",
        )?,
        None => {}
    }
    let tables = tables(output.csv.as_ref(), only);
    let mut input = Input::read(&args.input, &args.observer, verbosity)?;
    input.scene = args.model.scene(input.scene);
    if let Some(measure) = args.meshes.measure {
        input.scene = input.scene.with_measure_for_all(measure);
    }
    let files = [&output.json, &output.plot].into_iter().flatten();
    let files = files.chain(tables.iter().map(|(path, _)| path));
    check_destinations(files.cloned(), &input.files)?;

    let settings = args.settings(&input)?;
    if !settings.tolerances.is_empty() {
        tell_of_rest(&input, verbosity)?;
    }
    let progress = Bar::new(settings.pieces(), "runs", verbosity);
    let study = CostStudy::new(&input.scene, &input.models, &settings, &progress);
    progress.finish();
    if let Some(rays) = &settings.rays {
        tell_of_missing(&rays.textures, &input.scene, verbosity);
    }
    let mut study = study.map_err(|error| match error {
        StudyError::Export { .. } => anyhow::Error::new(error),
        StudyError::RepeatedSamples(_) => anyhow::Error::new(error).context("--pixel-samples"),
        _ => anyhow::Error::new(error).context("--tolerances"),
    })?;
    if input.is_mesh {
        // It has no title, and plots of two meshes have to be told apart.
        study.scene.title.get_or_insert(input.name.clone());
    }
    tell(&study, settings.max_triangles, verbosity);

    if shows_tables {
        print_if_open(|out| tables_of(&study, out))?;
    }
    // The plot may fail: no file is written before it is there.
    let height = if only.is_none() { 780 } else { 480 };
    output.write_plot(drawing, height, |format, size| match format {
        DrawingFormat::Png => study.plot_png(size),
        DrawingFormat::Svg => study.plot_svg(size).map(String::into_bytes),
    })?;
    if let Some(path) = &output.json {
        write_result(path, (study.to_json() + "\n").as_bytes())?;
    }
    for (path, half) in &tables {
        let csv = match half {
            Half::Meshes => csv_of_meshes(&study.meshes),
            Half::Rays => csv_of_rays(&study.rays),
        };
        write_result(path, csv.as_bytes())?;
    }
    Ok(())
}

/// The study of the scene's flight.
fn integrators(args: &CostArgs, verbosity: Verbosity) -> anyhow::Result<()> {
    let output = &args.output;
    let drawing = output.drawing()?;
    let shows_tables = output.shows_tables()?;
    let others = "is for meshes and pictures, which --integrators leaves out";
    refuse(&[("--only", args.study.only.is_some())], others)?;
    refuse(&args.meshes.given(), others)?;
    refuse(&args.pictures.given(), others)?;
    refuse(&args.model.given(), others)?;
    refuse(
        &args.observer.beside_the_flight(),
        "changes nothing for --integrators, which compares all integrators at the end of the flight",
    )?;
    let input = Input::read(&args.input, &args.observer, verbosity)?;
    let files = [&output.json, &output.csv, &output.plot];
    check_destinations(files.into_iter().flatten().cloned(), &input.files)?;

    let settings = IntegratorSettings {
        repeats: args.study.repeats,
        ..IntegratorSettings::default()
    };
    let study = IntegratorStudy::new(&input.scene, &settings);
    let study = study.map_err(|error| match error {
        StudyError::NoFlight => anyhow!(
            "--integrators: {} has no flight; give one with --flight, or study a scene that has one, such as the \
             built-in scenes flight, takeoff, turn and orbit",
            input.name
        ),
        _ => anyhow::Error::new(error).context("--integrators"),
    })?;
    if shows_tables {
        print_if_open(|out| table_of_integrators(&study, out))?;
    }
    output.write_plot(drawing, 480, |format, size| match format {
        DrawingFormat::Png => study.plot_png(size),
        DrawingFormat::Svg => study.plot_svg(size).map(String::into_bytes),
    })?;
    if let Some(path) = &output.json {
        write_result(path, (study.to_json() + "\n").as_bytes())?;
    }
    if let Some(path) = &output.csv {
        write_result(path, csv_of_integrators(&study.rows).as_bytes())?;
    }
    Ok(())
}

impl CostArgs {
    fn settings(&self, input: &Input) -> anyhow::Result<CostSettings> {
        let only = self.study.only;
        let default = CostSettings::default();
        let tolerances = match self.meshes.tolerances.as_slice() {
            _ if only == Some(Half::Rays) => vec![],
            [] => default.tolerances,
            tolerances => tolerances.to_vec(),
        };
        let rays = match only {
            Some(Half::Meshes) => None,
            _ => Some(self.pictures.settings(input)?),
        };
        Ok(CostSettings {
            tolerances,
            rays,
            repeats: self.study.repeats,
            max_triangles: self.meshes.max_triangles.unwrap_or(default.max_triangles),
            samples: self.meshes.places.unwrap_or(default.samples),
            ..default
        })
    }
}

impl MeshArgs {
    fn given(&self) -> [Given; 4] {
        [
            ("--measure", self.measure.is_some()),
            ("--tolerances", !self.tolerances.is_empty()),
            ("--max-triangles", self.max_triangles.is_some()),
            ("--places", self.places.is_some()),
        ]
    }
}

impl PictureArgs {
    fn given(&self) -> [Given; 4] {
        [
            ("--pixel-samples", !self.pixel_samples.is_empty()),
            ("--size", self.size.is_some()),
            ("--fov", self.fov.is_some()),
            ("--look", self.look.is_some()),
        ]
    }

    /// With the cameras that `render` has for the observer.
    fn settings(&self, input: &Input) -> anyhow::Result<RaySettings> {
        let placed = PlacedScene::new(input.scene.clone(), input.models.clone())?;
        let size = match self.size {
            Some(size) => size,
            None => PictureSize::new(320, 180)?,
        };
        let camera = CameraSettings {
            field_of_view: self.fov.map_or(FieldOfView::Fitting, FieldOfView::Degrees),
            aim: self.look.map_or(Aim::Usual, Aim::Look),
            ..CameraSettings::new(size)
        };
        let cameras = camera.observer_cameras(&placed);
        let cameras = cameras.map_err(|error| match error {
            FramingError::Camera(CameraError::FieldOfView { .. }) => {
                anyhow::Error::new(error).context("--fov")
            }
            _ => anyhow::Error::new(error).context("--look"),
        })?;
        let mut settings = RaySettings::new(cameras);
        settings.textures = input.textures.clone();
        if !self.pixel_samples.is_empty() {
            settings.samples.clone_from(&self.pixel_samples);
        }
        Ok(settings)
    }
}

/// A file for each table.
fn tables(csv: Option<&PathBuf>, only: Option<Half>) -> Vec<(PathBuf, Half)> {
    let Some(path) = csv else {
        return vec![];
    };
    match only {
        Some(half) => vec![(path.clone(), half)],
        None => vec![
            (path.clone(), Half::Meshes),
            (with_suffix(path, "_rays"), Half::Rays),
        ],
    }
}

/// Without a speed there is little to study.
fn tell_of_rest(input: &Input, verbosity: Verbosity) -> anyhow::Result<()> {
    let placed = PlacedScene::new(input.scene.clone(), input.models.clone())?;
    let is_at_rest = |object| placed.fastest_relative_velocity(object).rapidity() == 0.0;
    if input.scene.objects().iter().all(is_at_rest) {
        verbosity.note(
            "nothing moves relative to the observer: each photosurface is the shape itself; give a speed, such as \
             --beta 0.9, to study its cost",
        );
    }
    Ok(())
}

/// What the numbers alone do not say.
fn tell(study: &CostStudy, max_triangles: u64, verbosity: Verbosity) {
    let made: Vec<&Made> = study
        .meshes
        .iter()
        .filter_map(|cost| cost.made.as_ref())
        .collect();
    let left_out = study.meshes.len() - made.len();
    if left_out > 0 {
        let are = if left_out == 1 { "is" } else { "are" };
        verbosity.note(format_args!(
            "{} would take more than --max-triangles {} and {are} only predicted",
            if left_out == 1 {
                "1 tolerance".to_owned()
            } else {
                format!("{left_out} tolerances")
            },
            grouped(max_triangles as usize)
        ));
    }
    if made.iter().any(|made| made.peak_memory_bytes.is_none()) {
        verbosity.note("this system does not report peak memory");
    }
    if made.iter().any(|made| !made.certified) {
        verbosity.note(
            "where the bound is above the tolerance, no number of triangles can keep the tolerance",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Those whose flags tell whether they are there cannot have clap say them.
    #[test]
    fn help_says_the_defaults() {
        use clap::Args;
        let help = CostArgs::augment_args(clap::Command::new("cost"))
            .render_long_help()
            .to_string();
        let default = CostSettings::default();
        for number in [default.max_triangles, default.samples.get() as u64] {
            assert!(help.contains(&format!("[default: {number}]")), "{help}");
        }
    }
}
