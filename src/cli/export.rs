//! `photosurface export`: photosurfaces as meshes.

use std::fs;
use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use clap::ValueEnum;
use photosurface::{Attribute, Format, PlacedScene, Playback, Scene, replaced_data};

use super::Status;
use super::accuracy::{AccuracyArgs, DetailArgs, Tally};
use super::args::{InputArgs, ObserverArgs, number};
use super::input::Input;
use super::messages::{Verbosity, counted, size, stdout_is_closed};
use super::output::{
    FileFormat, check_destinations, check_range, extension, file_for_each, from_first_to_last,
    is_stdout, progress_bar, with_suffix,
};
use super::work::{Clock, Work, write_file, write_report};

/// Write photosurfaces as meshes
///
/// Every object, at every step, becomes a mesh of its own in the observer's frame, observer at the origin.
/// Without SCENE or MESH the built-in scene "sphere" is taken:
///
///     photosurface export
///     photosurface export scene.json -o out.glb
///     photosurface export bunny.obj --beta 0.9 --steps 0,1,2 -o flying.glb
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct ExportArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    #[command(flatten)]
    detail: DetailArgs,
    /// Write these numbers for every vertex: doppler, emission_time (from the moment of observation, so negative),
    /// rest_position (overrides the scene); not with --animate=morph, whose one mesh has one of each
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
    verbosity: Verbosity,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
struct OutputArgs {
    /// Where to write: .glb, .gltf (with its data beside it in NAME-DIGEST.bin) or .ply (double precision, all in one mesh, the
    /// Doppler factor as quality); - for stdout, to which a GLB goes unless --format says otherwise [default:
    /// NAME_photosurface.glb in this directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// What to write where no name of a file says it: to stdout glb or ply [default: glb]
    #[arg(long, value_enum)]
    format: Option<FileFormat>,
    /// Write a file for each step: out_step000.glb, out_step001.glb, ...
    #[arg(long)]
    split: bool,
    /// Show the steps one after another: "frames", a mesh for each step, there during its frame alone; "morph", one
    /// mesh for all steps, within the tolerance at each, that moves from one to the next (glTF; without --attributes,
    /// which differ from step to step)
    #[arg(
        long,
        value_name = "HOW",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "frames",
        conflicts_with = "split"
    )]
    animate: Option<Animate>,
    /// Steps in a second of an animation
    #[arg(
        long,
        value_name = "N",
        default_value_t = 24.0,
        value_parser = number,
        requires = "animate",
        allow_hyphen_values = true
    )]
    fps: f64,
    /// Write a JSON report of what was made and how long it took; - for stdout
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// How steps are shown one after another.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum Animate {
    Frames,
    Morph,
}

pub(super) fn run(args: &ExportArgs) -> anyhow::Result<Status> {
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

    let mut clock = Clock::default();
    let mut input = Input::read(&args.input, &args.observer, args.verbosity)?;
    if !args.attributes.is_empty() {
        let attributes = args.attributes.iter().copied().collect();
        input.scene = input.scene.with_attributes(attributes);
    }
    let playback = output.playback(format, &input.scene)?;
    let path = output.path(&input.name);
    let steps = input.scene.steps().len();
    let levels: Vec<Level> = args
        .detail
        .levels(&args.accuracy, input.scene)?
        .into_iter()
        .map(|(suffix, scene)| Level {
            scene,
            files: output.files(&with_suffix(&path, &suffix), steps),
            report: output
                .report
                .as_deref()
                .map(|report| with_suffix(report, &suffix)),
        })
        .collect();
    check_destinations(outputs(&levels, format), &input.files)?;
    clock.stop("read");

    let mut status = Status::Done;
    let (mut models, last) = (input.models, levels.len() - 1);
    for (index, level) in levels.into_iter().enumerate() {
        // The last may have them all for itself.
        let models = match index == last {
            true => std::mem::take(&mut models),
            false => models.clone(),
        };
        let placed = PlacedScene::new(level.scene, models)?;
        let of_file = || level.files[0].display().to_string();
        format
            .least_size(&placed, if output.split { 1 } else { steps })
            .with_context(of_file)?;
        check_range(format, &placed).with_context(of_file)?;
        if index == 0 && format != Format::Ply {
            tell_replaced_names(&placed, &path, args.verbosity);
        }
        let clock = clock.clone();
        let certified = export(
            args,
            format,
            placed,
            playback,
            &level.files,
            level.report.as_deref(),
            clock,
        )?;
        if !certified {
            status = Status::NotCertified;
        }
    }
    Ok(status)
}

/// One level of detail.
struct Level {
    scene: Scene,
    /// One for each step, or one for all.
    files: Vec<PathBuf>,
    report: Option<PathBuf>,
}

/// Makes and writes the photosurfaces of a placed; whether all of them are certified.
fn export(
    args: &ExportArgs,
    format: Format,
    placed: PlacedScene,
    playback: Option<Playback>,
    files: &[PathBuf],
    report: Option<&Path>,
    mut clock: Clock,
) -> anyhow::Result<bool> {
    let verbosity = args.verbosity;
    let wanted = args.accuracy.wanted_in(format, placed.scene());
    let placed = match wanted.subdivide {
        true => args.accuracy.within_budget(placed, wanted, verbosity).0,
        false => placed,
    };
    clock.stop("predict");

    let parts: usize = placed.objects().map(|(_, parts)| parts.len()).sum();
    let all = parts * placed.scene().steps().len();
    let mut work = Work {
        progress: progress_bar(all, "photosurfaces", verbosity),
        placed: &placed,
        wanted,
        playback,
        verbosity,
        clock,
        tally: Tally::default(),
        reported: report.map(|_| vec![]),
        data_files: vec![],
    };
    let finish = |work: &Work<'_>| match (report, &work.reported) {
        (Some(path), Some(made)) => write_report(path, &placed, made, &work.clock),
        _ => Ok(()),
    };
    if args.output.split {
        for (step, file) in files.iter().enumerate() {
            write_file(file, format, &mut work, step..step + 1, |_| Ok(()))?;
        }
        finish(&work)?;
    } else {
        // Before the mesh appears: where the report fails, nothing is written.
        let steps = 0..placed.scene().steps().len();
        write_file(&files[0], format, &mut work, steps, finish)?;
    }
    work.progress.finish_and_clear();

    for (name, seconds) in &work.clock.stages {
        verbosity.detail(format_args!("{name}: {seconds:.3} s"));
    }
    if !is_stdout(&files[0]) {
        verbosity.result(summary(files, &work.data_files, &placed, &work.tally));
    }
    Ok(args.accuracy.is_kept(&work.tally, verbosity))
}

impl OutputArgs {
    fn format(&self) -> anyhow::Result<Format> {
        let wanted = self.format.unwrap_or(FileFormat::Glb);
        let Some(path) = &self.output else {
            return Ok(wanted.into());
        };
        if is_stdout(path) {
            ensure!(
                wanted != FileFormat::Gltf,
                "--format gltf: the data of a .gltf is a file beside it, which stdout has no place for; expected glb or ply"
            );
            return Ok(wanted.into());
        }
        let of_name = extension(path);
        let of_name = of_name.and_then(|extension| FileFormat::of_extension(&extension));
        let Some(of_name) = of_name else {
            bail!(
                "{}: unknown extension, expected .glb, .gltf or .ply",
                path.display()
            );
        };
        ensure!(
            self.format.is_none_or(|format| format == of_name),
            "{}: is .{} by its name and .{} by --format; leave out --format, or give the name that extension",
            path.display(),
            of_name.extension(),
            wanted.extension()
        );
        Ok(of_name.into())
    }

    /// How the steps are shown one after another, if that is asked for and there is something to show.
    fn playback(&self, format: Format, scene: &Scene) -> anyhow::Result<Option<Playback>> {
        let Some(animate) = self.animate else {
            return Ok(None);
        };
        ensure!(
            format != Format::Ply,
            "--animate: a .ply has no time, expected .glb or .gltf"
        );
        ensure!(
            scene.steps().len() > 1,
            "--animate: the scene has one step, expected at least two, such as --steps -6..6/7"
        );
        let frames_per_second = self.fps;
        ensure!(
            (1e-3..=1e3).contains(&frames_per_second),
            "--fps is {frames_per_second:?}, expected a number from 0.001 to 1000"
        );
        Ok(Some(match animate {
            Animate::Frames => Playback::Frames { frames_per_second },
            Animate::Morph => {
                ensure!(
                    scene.attributes().is_empty(),
                    "--animate=morph shows one mesh, and attributes differ from step to step; use --animate=frames"
                );
                Playback::Morph { frames_per_second }
            }
        }))
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
                let format = self.format.unwrap_or(FileFormat::Glb);
                PathBuf::from(format!("{name}_photosurface.{}", format.extension()))
            }
        }
    }

    /// The files that will be written, one for each step or one for all.
    fn files(&self, path: &Path, steps: usize) -> Vec<PathBuf> {
        if !self.split {
            return vec![path.to_owned()];
        }
        file_for_each(path, steps)
    }
}

/// Every file of every level that is written over or removed. The data of a `.gltf` has a new name, made of what is in
/// it; that of the one which is replaced goes.
fn outputs(levels: &[Level], format: Format) -> impl Iterator<Item = PathBuf> {
    levels.iter().flat_map(move |level| {
        let gltf = level.files.iter().filter(move |_| format == Format::Gltf);
        let files = level.files.iter().cloned();
        let files = files.chain(gltf.filter_map(|file| replaced_data(file)));
        files.chain(level.report.clone())
    })
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
        "{}: some programs break white space, control characters and . : / [ ] in names, which become _: \"{}\" is \"{name}\"{others}",
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

fn summary(
    files: &[PathBuf],
    data_files: &[PathBuf],
    placed: &PlacedScene,
    made: &Tally,
) -> String {
    let sizes = files.iter().chain(data_files);
    let sizes = sizes.map(|file| fs::metadata(file).map_or(0, |data| data.len()));
    let bytes = sizes.sum();
    let place = from_first_to_last(files);
    let marker = if placed.marker().is_some() {
        " and the marker"
    } else {
        ""
    };
    format!(
        "{place}: {}, {}{marker}, {}",
        counted(made.photosurfaces, "photosurface"),
        counted(made.triangles, "triangle"),
        size(bytes)
    )
}
