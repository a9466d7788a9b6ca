//! `photosurface export`: photosurfaces as meshes.

use std::fs;
use std::io::{IsTerminal, Write, stdout};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, ensure};
use clap::ValueEnum;
use photosurface::jobs::{CameraSettings, ExportError, ExportLevel, export_levels, write_report};
use photosurface::pipeline::Facts;
use photosurface::scene::Attribute;
use photosurface::write::{Format, Playback, Report, StageTime, WriteError};
use photosurface::{ExportSettings, Exported, PlacedScene, Textures};

use super::accuracy::{AccuracyArgs, DetailArgs};
use super::args::{InputArgs, ObserverArgs};
use super::effects::{EffectArgs, tell_of_ramp};
use super::file_camera::FileCameraArgs;
use super::input::{Input, Loaded, tell_of_inside, tell_of_missing};
use super::messages::{Verbosity, counted, print, size, stdout_is_closed};
use super::models::ModelsArgs;
use super::outcome::Outcome;
use super::output::{FileFormat, check_destinations, from_first_to_last, is_stdout};
use super::provenance::provenance;
use super::status::Status;
use super::values::{number, part};
use super::wording::{in_words_of_flags, or_ply};
use super::work::{Plan, PlannedFile, WorkArgs};

/// Shown below the flags.
const EXAMPLES: &str = "\
Examples:
  photosurface export
  photosurface export scene.json -o out.glb
  photosurface export bunny.obj --beta 0.9 --steps 0,1,2 -o flying.glb";

/// Write photosurfaces as meshes
///
/// Every object, at every step, becomes a mesh of its own in the observer's frame, observer at the origin.
/// Without SCENE or MESH the built-in scene "sphere" is used.
#[derive(Debug, clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub(super) struct ExportArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    effects: EffectArgs,
    #[command(flatten)]
    models: ModelsArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    #[command(flatten)]
    detail: DetailArgs,
    /// Write these numbers for every vertex: doppler, emission_time (from the moment of observation, so negative),
    /// rest_position, radiance (overrides the scene); not with --animate=morph, which has only one value per vertex
    #[arg(
        long,
        value_name = "A,A,...",
        value_delimiter = ',',
        help_heading = "Output"
    )]
    attributes: Vec<Attribute>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    camera: FileCameraArgs,
    #[command(flatten)]
    work: WorkArgs,
    #[command(flatten)]
    verbosity: Verbosity,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
struct OutputArgs {
    /// Where to write: .glb, .gltf (with its data beside it in NAME-DIGEST.bin) or .ply (double precision, all in one mesh, the
    /// Doppler factor as quality); - for stdout (GLB, unless --format is given) [default: NAME_photosurface.glb in this
    /// directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format, if no file name determines it; to stdout: glb or ply [default: glb]
    #[arg(long, value_enum)]
    format: Option<FileFormat>,
    /// Write a file for each step: out_step000.glb, out_step001.glb, ...
    #[arg(long)]
    split: bool,
    /// Write only the steps from A up to B, B not included, counted from 0: names and numbers are those of the whole, and
    /// --max-triangles is shared out among all steps; not with --animate
    #[arg(long, value_name = "A..B", value_parser = part)]
    only: Option<Range<usize>>,
    /// Show the steps one after another (glTF): "frames", a mesh for each step, shown only during its frame; "morph", one
    /// mesh with the steps as morph targets, within the tolerance at each step (without --attributes, which differ
    /// from step to step)
    #[arg(
        long,
        value_name = "HOW",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "frames",
        conflicts_with = "split"
    )]
    animate: Option<Animate>,
    /// Steps per second of an animation
    #[arg(
        long,
        value_name = "N",
        default_value_t = 24.0,
        value_parser = number,
        requires = "animate",
        allow_hyphen_values = true
    )]
    fps: f64,
    /// Write a JSON report of what was made, of what, and how long it took; - for stdout; photosurface schema --report prints
    /// its schema
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Leave out of the report how long each stage took, so that it is the same on every run
    #[arg(long, requires = "report")]
    no_times: bool,
}

/// How steps are shown one after another.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum Animate {
    Frames,
    Morph,
}

pub(super) fn run(args: &ExportArgs) -> anyhow::Result<Status> {
    made(args, &Loaded::default())?.told()
}

/// Makes what the flags say, of models that may have been read before.
pub(super) fn made(args: &ExportArgs, loaded: &Loaded) -> anyhow::Result<Outcome> {
    let output = &args.output;
    let format = output.format()?;
    output.check_streams(args.detail.level_count())?;
    if let (Some(_), Some(input)) = (output.animate, &args.input.input) {
        let is_how = input
            .to_str()
            .is_some_and(|how| Animate::from_str(how, false).is_ok());
        ensure!(
            !is_how || input.exists(),
            "{how}: no such file; for an animation write --animate={how}",
            how = input.display()
        );
    }

    let start = Instant::now();
    let mut input = Input::read_with(&args.input, &args.observer, loaded, args.verbosity)?;
    if !args.attributes.is_empty() {
        let attributes = args.attributes.iter().copied().collect();
        input.scene = input.scene.with_attributes(attributes);
    }
    let path = output.path(&input.name);
    let scene = args.effects.scene(args.accuracy.scene(input.scene.clone()));
    tell_of_ramp(&scene, args.verbosity);
    let outputs = [Some(path.clone()), output.report.clone()];
    let outputs: Vec<PathBuf> = outputs.into_iter().flatten().collect();
    let resume = args.work.fingerprint(&args.input, &input, &outputs)?;
    let of = scene.steps().len();
    let placed = args.models.placed(scene, input.models.clone())?;
    tell_of_inside(&placed, args.verbosity);
    let is_side_by_side = !args.models.side_by_side()?.is_empty();
    let camera = args.camera.settings(is_side_by_side)?;
    let settings = ExportSettings {
        resume: resume.map(|files| files.with("models", &args.models.side_by_side().ok())),
        provenance: provenance(&args.input, &input.files),
        ..args.settings(camera, start, &input.textures)
    };
    let levels = export_levels(&placed, &settings, format, &path).map_err(in_words_of_flags)?;
    check_destinations(levels.iter().flat_map(ExportLevel::outputs), &input.files)?;
    if args.work.plans() {
        let planned = levels.iter().flat_map(planned).collect();
        let plan = Plan::new(&args.input, &input, planned, of);
        return Ok(Outcome::planned(plan));
    }
    if format != Format::Ply {
        tell_replaced_names(&placed, &path, args.verbosity);
    }
    for level in &levels {
        level.check().map_err(|error| match error {
            ExportError::File { file, source } => {
                or_ply(source, level.placed()).context(file.display().to_string())
            }
            error => error.into(),
        })?;
    }
    if let Some(level) = levels.first().filter(|level| level.marker().is_none())
        && placed.marker().is_some()
    {
        args.verbosity.note(format_args!(
            "{}: without the observer's marker, which would hide objects from the camera: they are as near as ten of its radii",
            level.files()[0].display()
        ));
    }
    let mut outcome = Outcome::default();
    for (number, level) in levels.into_iter().enumerate() {
        let (is_certified, exported) = export(args, level)?;
        if !is_certified {
            outcome.status = Status::NotCertified;
        }
        let Exported {
            files,
            data_files,
            notes,
            ..
        } = exported;
        outcome.resumed += exported.resumed.len();
        outcome.files.extend(files);
        outcome.files.extend(data_files);
        outcome.tally.merge(exported.tally);
        // Of all levels of detail the same is to be said.
        for note in notes.iter().filter(|_| number == 0) {
            args.verbosity.note(note);
        }
    }
    tell_of_missing(&input.textures, placed.scene(), args.verbosity);
    Ok(outcome)
}

/// The files of a level of detail.
fn planned(level: &ExportLevel) -> Vec<PlannedFile> {
    let files = level.files().iter().zip(level.finished()).enumerate();
    let planned =
        files.map(|(number, (file, seal))| PlannedFile::new(file, level.steps_of(number), seal));
    planned.collect()
}

/// Makes and writes the photosurfaces of one level of detail; whether all of them are certified, and what was made.
fn export(args: &ExportArgs, level: ExportLevel) -> anyhow::Result<(bool, Exported)> {
    let verbosity = args.verbosity;
    let has_marker = level.marker().is_some();
    let to_stdout = is_stdout(&level.files()[0]);
    let report_path = level.report().map(Path::to_owned);
    let pieces = level.pieces();
    let progress = args.work.told(pieces, "photosurfaces", verbosity);
    let fitted = level.fit();
    if let Some(fitted) = fitted.fitted() {
        args.accuracy.tell_fitted(fitted, verbosity);
    }
    let report = |made: &Report| match &report_path {
        Some(path) if is_stdout(path) => report_to_stdout(made),
        Some(path) => write_report(path, made),
        None => Ok(()),
    };
    let exported = match to_stdout {
        true => {
            let mut exported = None;
            print(|out| {
                exported = Some(fitted.write_to(out, &progress)?);
                Ok(())
            })?;
            let exported = exported.context("stdout")?;
            report(&exported.report)?;
            exported
        }
        false => fitted.write(&progress, report).map_err(in_words_of_flags)?,
    };
    progress.finish();
    for facts in &exported.report.objects {
        verbosity.detail(describe(facts));
    }
    for StageTime { name, seconds } in &exported.report.stages {
        verbosity.detail(format_args!("{name}: {seconds:.3} s"));
    }
    if !to_stdout {
        verbosity.result(summary(&exported, has_marker));
    }
    let mut is_certified = args.accuracy.is_kept(&exported.tally, verbosity);
    if !exported.resumed_are_certified {
        verbosity
            .note("of the files that were finished before, not all are within their tolerance");
        is_certified = false;
    }
    Ok((is_certified, exported))
}

impl ExportArgs {
    /// The file that names all files, if it is given.
    pub(super) fn output_file(&self) -> Option<&Path> {
        self.output.output.as_deref()
    }

    /// The file of the report, if it is given.
    pub(super) fn report_file(&self) -> Option<&Path> {
        self.output.report.as_deref()
    }

    /// The settings of the job; the input was read from `start` to now.
    fn settings(
        &self,
        camera: Option<CameraSettings>,
        start: Instant,
        textures: &Textures,
    ) -> ExportSettings {
        let frames_per_second = self.output.fps;
        ExportSettings {
            split: self.output.split,
            only: self.output.only.clone(),
            playback: self.output.animate.map(|animate| match animate {
                Animate::Frames => Playback::Frames { frames_per_second },
                Animate::Morph => Playback::Morph { frames_per_second },
            }),
            camera,
            levels: self.detail.tolerances().to_vec(),
            subdivide: self.accuracy.subdivides(),
            max_triangles: self.accuracy.max_triangles(),
            report: self.output.report.clone(),
            report_times: !self.output.no_times,
            keep_facts: self.verbosity.is_verbose(),
            stages_before: vec![StageTime {
                name: "read",
                seconds: start.elapsed().as_secs_f64(),
            }],
            textures: textures.clone(),
            ..ExportSettings::default()
        }
    }
}

impl OutputArgs {
    fn format(&self) -> anyhow::Result<Format> {
        let wanted = self.format.map_or(Format::Glb, Format::from);
        let Some(path) = &self.output else {
            return Ok(wanted);
        };
        if is_stdout(path) {
            ensure!(
                wanted != Format::Gltf,
                "--format gltf: the data of a .gltf is a file beside it, which stdout has no place for; expected glb or ply"
            );
            return Ok(wanted);
        }
        let Some(of_name) = Format::of_path(path) else {
            return Err(ExportError::UnknownExtension(path.clone()).into());
        };
        ensure!(
            self.format.is_none() || wanted == of_name,
            "{}: is .{} by its name and .{} by --format; leave out --format, or give the name that extension",
            path.display(),
            of_name.extension(),
            wanted.extension()
        );
        Ok(of_name)
    }

    /// Stdout holds one thing.
    fn check_streams(&self, levels: usize) -> anyhow::Result<()> {
        let to_stdout = self.output.as_deref().is_some_and(is_stdout);
        ensure!(
            !(to_stdout && self.split),
            "--split writes several files, they cannot all go to stdout"
        );
        ensure!(
            !(to_stdout && levels > 1),
            "--lod writes several files, they cannot all go to stdout"
        );
        let report_to_stdout = self.report.as_deref().is_some_and(is_stdout);
        ensure!(
            !((to_stdout || report_to_stdout) && stdout_is_closed()),
            "stdout: it is closed, expected a file or a pipe"
        );
        ensure!(
            !(report_to_stdout && levels > 1),
            "--lod writes several reports, they cannot all go to stdout"
        );
        ensure!(
            !(to_stdout && report_to_stdout),
            "-o and --report cannot both go to stdout"
        );
        ensure!(
            !(to_stdout && stdout().is_terminal()),
            "a GLB or a PLY is not text for a terminal; send stdout to a file or a pipe"
        );
        Ok(())
    }

    fn path(&self, name: &str) -> PathBuf {
        match &self.output {
            Some(path) => path.clone(),
            None => {
                let format = self.format.map_or(Format::Glb, Format::from);
                PathBuf::from(format!("{name}_photosurface.{}", format.extension()))
            }
        }
    }
}

/// Tells which names of parts are not in the file as they are in the source.
fn tell_replaced_names(placed: &PlacedScene, path: &Path, verbosity: Verbosity) {
    let mut replaced = placed.replaced_names();
    let Some((wanted, name)) = replaced.next() else {
        return;
    };
    let others = match replaced.count() {
        0 => String::new(),
        others => format!(", and {} more", counted(others, "name")),
    };
    verbosity.note(format_args!(
        "{}: names changed, because some programs cannot handle white space, control characters and . : / [ ]: \"{}\" became \"{name}\"{others}",
        path.display(),
        shown_name(&wanted),
    ));
}

/// As much of a name as tells which it is.
fn shown_name(name: &str) -> String {
    match name.char_indices().nth(60) {
        Some((end, _)) => format!("{}...", &name[..end]),
        None => name.to_owned(),
    }
}

fn summary(exported: &Exported, has_marker: bool) -> String {
    let resumed = match (exported.resumed.len(), exported.files.len()) {
        (0, _) => String::new(),
        (some, all) if some == all => {
            let were = if all == 1 { "was" } else { "were" };
            let place = from_first_to_last(&exported.files);
            return format!("{place}: {were} finished before");
        }
        (some, _) => format!("; {} of them finished before", counted(some, "file")),
    };
    let files = exported.files.iter().chain(&exported.data_files);
    let sizes = files.map(|file| fs::metadata(file).map_or(0, |data| data.len()));
    let bytes = sizes.sum();
    let place = from_first_to_last(&exported.files);
    let marker = if has_marker { " and the marker" } else { "" };
    format!(
        "{place}: {}, {}{marker}, {}{resumed}",
        counted(exported.tally.photosurfaces, "photosurface"),
        counted(exported.tally.triangles, "triangle"),
        size(bytes)
    )
}

fn describe(facts: &Facts) -> String {
    format!(
        "{}: proper time {}, gamma {:.6}, {}",
        facts.name,
        facts.proper_time,
        facts.relative_gamma,
        counted(facts.triangles, "triangle")
    )
}

fn report_to_stdout(report: &Report) -> Result<(), WriteError> {
    let text = report.to_json() + "\n";
    let mut out = stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|source| WriteError::Io {
        path: "stdout".into(),
        source,
    })
}
