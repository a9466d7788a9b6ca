//! `photosurface render`: pictures of what the observer sees, and of photosurfaces from anywhere.

use std::collections::BTreeMap;
use std::io::{IsTerminal, stdout};
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use photosurface::jobs::{
    EmptyView, Finished, FrameFacts, PassageError, RenderError, Rendered, Variant, ViewCost,
    overview, passage, render_side_by_side,
};
use photosurface::render::{Picture, Projection};
use photosurface::spacetime::ViewModel;
use photosurface::tessellate::Precision;
use photosurface::write::{Fingerprint, Seal, write_whole};
use photosurface::{Observer, PictureView, PlacedScene, Progress, Scene};

use super::accuracy::AccuracyArgs;
use super::args::{InputArgs, ObserverArgs, PASSAGE};
use super::camera::{CameraArgs, Method, View};
use super::effects::{EffectArgs, tell_of_ramp};
use super::film::{Film, FilmArgs};
use super::guides::GuideArgs;
use super::input::{Input, Loaded, tell_of_blurred, tell_of_inside, tell_of_missing};
use super::messages::{Verbosity, counted, grouped, print};
use super::models::ModelsArgs;
use super::outcome::Outcome;
use super::output::{check_destinations, extension, from_first_to_last, is_stdout};
use super::planned::PlannedOverview;
use super::status::Status;
use super::work::{Plan, PlannedFile, Told, WorkArgs, fingerprint_of_inputs};

/// Shown below the flags.
const EXAMPLES: &str = "\
Examples:
  photosurface render
  photosurface render --sheet --example cube -o cube.png
  photosurface render --example street --look 0,0,-1 -o street.png
  photosurface render --example cube --film cube.gif
  photosurface render --example cube --view outside --ghost rest,contracted --axes -o outside.png";

/// Make pictures of what the observer sees, or of photosurfaces from outside
///
/// The observer's view is made by following rays of light back into the rest frame of each object, exact at every
/// pixel, or with --method mesh by drawing the photosurfaces that export would write.
/// Without SCENE or MESH the built-in scene "sphere" is used.
#[derive(Debug, clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    models: ModelsArgs,
    #[command(flatten)]
    guides: GuideArgs,
    #[command(flatten)]
    effects: EffectArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    #[command(flatten)]
    film: FilmArgs,
    /// Where to write a .png; each step gets its own file: out_step000.png, out_step001.png, ..., and those that
    /// are finished stay when it is interrupted; - for stdout [default: NAME_VIEW.png or NAME_sheet.png in this directory]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Take what is found by looking at all steps from the plan in FILE, which --plan has printed for the same scene, files
    /// and flags (those of the part and of the output aside): a part with --only looks at no other steps then, and its pictures
    /// are the same, byte for byte
    #[arg(long, value_name = "FILE", help_heading = "Work", conflicts_with_all = ["plan", "sheet", "together"])]
    planned: Option<PathBuf>,
    #[command(flatten)]
    work: WorkArgs,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<Status> {
    made(args, &Loaded::default())?.told()
}

impl RenderArgs {
    /// The file that names all files, if it is given.
    pub(super) fn output_file(&self) -> Option<&Path> {
        self.film.path().or(self.output.as_deref())
    }
}

/// Makes what the flags say, of models that may have been read before.
pub(super) fn made(args: &RenderArgs, loaded: &Loaded) -> anyhow::Result<Outcome> {
    let (camera, guides, verbosity) = (&args.camera, &args.guides, args.verbosity);
    let method = camera.method()?;
    ensure!(
        camera.sheet || camera.view == View::Outside || !guides.are_for_outside(),
        "--axes and --scale-bar are for --view outside and --sheet"
    );
    ensure!(
        camera.shows_meshes(method) || !guides.wireframe,
        "--wireframe shows triangles, which rays do not have; add --method mesh or --view outside"
    );
    camera.refuse_unused(method, &args.accuracy.given())?;
    check_output(args.output.as_deref())?;
    let film = args.film.film()?;
    let input = Input::read_for_speeds(&args.input, &args.observer, loaded, verbosity)?;
    let mut settings = camera.settings(method)?;
    let tells_time = camera.sheet || film.is_some();
    settings.guides = guides.guides(camera.shows_full_sky(), tells_time)?;
    let kind = match settings.view {
        PictureView::Sheet { .. } => "sheet",
        PictureView::Observer(_) => "observer",
        PictureView::Outside { .. } => "outside",
    };
    let path = match &args.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}_{kind}.png", input.name)),
    };
    let scenes = scenes(args, &input, film.as_ref())?;
    let steps = scenes[0].1.steps().len();
    let models = args.models.side_by_side()?;
    let columns = models.len().max(1);
    let size = settings.side_by_side_size(scenes.len(), columns, steps);
    let size = size.context(match (scenes.len(), columns) {
        (1, 1) => "--sheet: all steps on one picture; choose fewer --steps or a smaller --size",
        (1, _) => "--models: all models side by side; choose fewer, or a smaller --size",
        _ => "all speeds and models on one picture; choose fewer of them, or a smaller --size",
    })?;
    ensure!(
        film.is_some() || settings.drawn(steps).len() == 1 || !is_stdout(&path),
        "{steps} steps are as many pictures, they cannot all go to stdout; choose one with --steps"
    );
    let drawn = settings.drawn(steps);
    if let Some(only) = &settings.only {
        ensure!(
            only.end <= settings.picture_count(steps),
            "--only is {}..{}, expected a part of {}",
            only.start,
            only.end,
            counted(settings.picture_count(steps), "picture")
        );
    }
    let files = match &film {
        Some(film) => vec![film.path.to_owned()],
        None if is_stdout(&path) => vec![path; settings.picture_count(steps)],
        None => settings.files(&path, steps),
    };
    let made = match &film {
        Some(_) => &files[..],
        None => &files[drawn.clone()],
    };
    let read: Vec<PathBuf> = input.files.iter().chain(&args.planned).cloned().collect();
    check_destinations(made.iter().cloned(), &read)?;
    let resume = match &film {
        Some(_) => None,
        None => args.work.fingerprint(&args.input, &input, made)?,
    };
    let scene = &scenes[0].1;
    settings.background = camera.background(scene, settings.background);
    settings.surface_options = args.accuracy.wanted(Precision::Double);
    let budget = args.accuracy.max_triangles();
    let of_scenes = |files: Fingerprint| files.with("scenes", &(&scenes, models, budget));
    let resume = resume.map(of_scenes);
    // Of an overview, if there is one or is to be one.
    let whole = match args.planned.is_some() || args.work.plans_all() && settings.has_overview() {
        true => fingerprint_of_inputs(&args.input, &input)?,
        false => None,
    };
    let whole = whole.map(|files| settings.fingerprint_of_all(of_scenes(files)));
    if let Some(path) = &args.planned {
        let whole = whole.context(
            "--planned compares files, and the mesh comes from stdin; give its file name instead of -",
        )?;
        settings.overview = Some(PlannedOverview::read(path, whole).context("--planned")?);
    }
    let seal = |number| {
        let fingerprint = settings.fingerprint(resume?, number);
        Seal::of_file(&files[number], fingerprint)
    };
    let resumed: BTreeMap<usize, Seal> = match &film {
        Some(_) => BTreeMap::new(),
        None => drawn
            .clone()
            .filter_map(|number| Some((number, seal(number)?)))
            .collect(),
    };
    let fits_budget =
        camera.shows_meshes(method) && settings.surface_options.subdivide && budget < u64::MAX;
    let wanted = settings.surface_options;
    let fitted = |placed| match fits_budget {
        true => {
            args.accuracy
                .within_budget(placed, wanted, verbosity)
                .placed
        }
        false => placed,
    };
    let textures = &input.textures;
    let placed = |scene: &Scene| PlacedScene::new(scene.clone(), input.models.clone());
    let rows = || -> anyhow::Result<Vec<Vec<Variant>>> {
        let rows = scenes.iter();
        rows.map(|(label, scene)| row(label, placed(scene)?, models, fitted))
            .collect()
    };
    let progress = args.work.told(0, "rows", verbosity);
    let progress = match film {
        Some(_) => progress,
        None => progress.awaiting_files(),
    };
    let of = settings.picture_count(steps);
    if args.work.plans() {
        let planned = match &film {
            Some(film) => vec![PlannedFile::new(film.path, drawn.clone(), None)],
            None => drawn
                .clone()
                .map(|number| {
                    let steps = if of == 1 {
                        0..steps
                    } else {
                        number..number + 1
                    };
                    PlannedFile::new(&files[number], steps, resumed.get(&number).copied())
                })
                .collect(),
        };
        let mut plan = Plan::new(&args.input, &input, planned, of);
        if let Some(whole) = whole {
            let found = overview(&rows()?, textures, &settings, &progress);
            let found = found.map_err(|error| camera.flagged(error))?;
            plan.overview = Some(PlannedOverview::new(found, whole));
        }
        return Ok(Outcome::planned(plan));
    }
    settings.skipped = resumed.keys().copied().collect();
    tell_of_ramp(scene, verbosity);
    let first = PlacedScene::new(scene.clone(), input.models.clone())?;
    tell_of_inside(&first, verbosity);
    if method == Method::Rays {
        tell_of_blurred(&first, verbosity);
    }
    for (&number, seal) in &resumed {
        let bytes = std::fs::metadata(&files[number]).map_or(0, |data| data.len());
        progress.finished(&Finished {
            steps: number..number + 1,
            of,
            seconds: 0.0,
            is_certified: seal.is_certified,
            file: Some((&files[number], bytes)),
            is_resumed: true,
        });
    }
    let draw = |finished: &mut dyn FnMut(usize, &Picture) -> anyhow::Result<()>| match (
        scenes.as_slice(),
        models,
    ) {
        ([(_, scene)], []) => {
            let placed = fitted(placed(scene)?);
            photosurface::render(&placed, textures, &settings, &progress, finished)
        }
        _ => render_side_by_side(&rows()?, textures, &settings, &progress, finished),
    };
    let seal = |number| {
        Some(Seal {
            fingerprint: settings.fingerprint(resume?, number),
            is_certified: progress.last_is_certified(),
        })
    };
    let rendered = match &film {
        Some(film) => film.record(size, drawn.len(), draw),
        None if resumed.len() == drawn.len() => Ok(Rendered::default()),
        None => draw(&mut |number, picture| {
            let bytes = write(&files[number], picture, seal(number))?;
            progress.wrote(&files[number], bytes);
            Ok(())
        }),
    };
    let rendered = rendered.map_err(|error| match error.downcast::<RenderError>() {
        Ok(error) => camera.flagged(error),
        Err(error) => error,
    })?;
    progress.finish();
    if let Some(film) = &film {
        tell_of_film(
            film,
            drawn.clone(),
            of,
            rendered.tally.is_certified(),
            &progress,
        );
    }
    tell_of_costs(&rendered.costs, verbosity);
    let shown = if camera.sheet || camera.together {
        steps
    } else {
        drawn.len() - resumed.len()
    };
    let views = shown * columns * scenes.len();
    tell_of_frame(rendered.frame, camera, verbosity);
    tell_of_empty(&rendered.empty, views, camera, method, verbosity);
    tell_of_missing(&input.textures, &scenes[0].1, verbosity);
    if !is_stdout(&files[0]) {
        let pictures = match &film {
            Some(film) => format!(
                "{}, {}",
                counted(drawn.len(), "frame"),
                film.length(drawn.len())
            ),
            None => counted(made.len(), "picture"),
        };
        let before = match resumed.len() {
            0 => String::new(),
            some => format!(", {} of them finished before", grouped(some)),
        };
        verbosity.result(format_args!(
            "{}: {pictures}{before}{}",
            from_first_to_last(made),
            legend(args)
        ));
    }
    let mut is_certified = args.accuracy.is_kept(&rendered.tally, verbosity);
    if !resumed.values().all(|seal| seal.is_certified) {
        verbosity
            .note("of the pictures that were finished before, not all are within their tolerance");
        is_certified = false;
    }
    Ok(Outcome {
        status: match is_certified {
            true => Status::Done,
            false => Status::NotCertified,
        },
        files: made.to_vec(),
        resumed: resumed.len(),
        tally: rendered.tally,
        plan: None,
    })
}

/// The scene with everything that the flags say, for each speed with its label.
fn scenes(
    args: &RenderArgs,
    input: &Input,
    film: Option<&Film<'_>>,
) -> anyhow::Result<Vec<(String, Scene)>> {
    let observer = input.scene.observer();
    let mut scenes = vec![];
    for (label, velocity) in args.observer.speeds(observer)? {
        let label = match observer.flight.is_empty() {
            true => label,
            // Later the speed is another.
            false => format!("{label} at first"),
        };
        let observer = Observer {
            velocity,
            ..observer.clone()
        };
        let scene = input.scene.clone().with_observer(observer)?;
        scenes.push((label, args.observer.stepped(scene, &input.models)?));
    }
    if scenes.is_empty() {
        scenes.push((String::new(), input.scene.clone()));
    }
    let shows_time = args.camera.sheet || film.is_some();
    let is_alone = scenes.len() == 1;
    let passes = input.is_mesh && shows_time && args.observer.flies_by();
    for (_, scene) in &mut scenes {
        let mut changed = args.accuracy.scene(scene.clone());
        if passes {
            let steps = match passage(&changed, &input.models, PASSAGE) {
                Ok(steps) => steps,
                // One picture, or as many as at other speeds.
                Err(PassageError::AtRest) if film.is_none() => {
                    changed.steps().repeat(if is_alone { 1 } else { PASSAGE })
                }
                Err(error) => return Err(error).context("--film"),
            };
            changed = changed.with_steps(steps)?;
        }
        if let Some(film) = film {
            changed = film.scene(changed, args.observer.has_frames())?;
        }
        *scene = args.effects.scene(args.models.scene(changed));
    }
    Ok(scenes)
}

/// The scene under each of these models, or under its own.
fn row(
    label: &str,
    placed: PlacedScene,
    models: &[ViewModel],
    fitted: impl Fn(PlacedScene) -> PlacedScene,
) -> anyhow::Result<Vec<Variant>> {
    if models.is_empty() {
        return Ok(vec![Variant {
            label: label.to_owned(),
            placed: fitted(placed),
        }]);
    }
    let variant = |&model: &ViewModel| {
        Ok(Variant {
            label: match label {
                "" => model.to_string(),
                label => format!("{label}, {model}"),
            },
            placed: fitted(placed.clone().with_model_for_all(model)?),
        })
    };
    models.iter().map(variant).collect()
}

/// Says which projection has been chosen, and that one in perspective stretches its edges.
fn tell_of_frame(frame: Option<FrameFacts>, camera: &CameraArgs, verbosity: Verbosity) {
    let Some(frame) = frame else {
        return;
    };
    let wide = frame.widest_deg;
    if frame.is_cut {
        verbosity.note(format_args!(
            "no picture is wide enough for everything that is to be seen; the camera looks in the direction of motion; \
             --projection full-sky shows all, --look and --fov choose a part"
        ));
    }
    match frame.projection {
        Projection::Perspective { .. } if wide > 90.0 => verbosity.note(format_args!(
            "the picture is {wide:.0} degrees wide in perspective, which stretches shapes near its edges; with \
             --projection stereographic circles stay circles"
        )),
        Projection::Stereographic { .. } if camera.chooses_projection() => {
            verbosity.note(format_args!(
                "everything together is {wide:.0} degrees wide, so the picture is stereographic: circles stay circles, \
                 straight lines bend; {}--projection perspective keeps lines straight",
                if camera.tracks() { "" } else { "--track follows the objects, " }
            ));
        }
        _ => {}
    }
}

/// Says how many rays each view took, and how long.
fn tell_of_costs(costs: &[ViewCost], verbosity: Verbosity) {
    for &ViewCost { rays, seconds } in costs {
        verbosity.detail(format_args!(
            "{} in {seconds:.3} s, {:.2} million a second",
            counted(rays as usize, "ray"),
            rays as f64 / seconds / 1e6
        ));
    }
}

/// Says where nothing is to be seen, and where there would be something.
fn tell_of_empty(
    empty: &[EmptyView],
    views: usize,
    camera: &CameraArgs,
    method: Method,
    verbosity: Verbosity,
) {
    let Some(first) = empty.first() else {
        return;
    };
    // Three places, a zero without a sign.
    let [x, y, z] = first
        .look
        .to_array()
        .map(|part| (1000.0 * part).round() / 1000.0 + 0.0);
    let which = match views {
        1 => "nothing is to be seen in the picture".to_owned(),
        _ => format!(
            "nothing is to be seen in {} of {views} observer's views",
            empty.len()
        ),
    };
    let sky = if camera.shows_full_sky() {
        ""
    } else {
        ", or --full-sky"
    };
    let advice = format!("--look={x:.3},{y:.3},{z:.3} with a --fov{sky}");
    let advice = match camera.sheet {
        true => format!("a picture of its own without --sheet, with {advice}"),
        false => advice,
    };
    // A tolerance that is a part of the photosurface may be more than the way to it.
    let coarse = match method {
        Method::Mesh => ", or nearer than the tolerance (try --tolerance deg:0.05)",
        Method::Rays => "",
    };
    verbosity.note(format_args!(
        "{which}: every object is in another direction, or smaller than a pixel{coarse}; try {advice}"
    ));
}

/// What is where in a picture, and in which colour.
fn legend(args: &RenderArgs) -> String {
    let rows = args.camera.sheet.then_some(
        match args.models.side_by_side() {
            Ok([]) | Err(_) => "above, what the observer sees at each step (τ: its proper time); below, the photosurface from outside",
            Ok(_) => "a column for each model; above, what the observer sees, below, the same from outside; steps below each other",
        },
    );
    let legend = rows.into_iter().chain(args.guides.legend());
    legend.map(|words| format!("; {words}")).collect()
}

fn check_output(output: Option<&Path>) -> anyhow::Result<()> {
    let Some(path) = output else {
        return Ok(());
    };
    if is_stdout(path) {
        ensure!(
            !stdout().is_terminal(),
            "a PNG is not text for a terminal; send stdout to a file or a pipe"
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

/// Tells of a film as a whole.
fn tell_of_film(
    film: &Film<'_>,
    steps: Range<usize>,
    of: usize,
    is_certified: bool,
    progress: &Told,
) {
    let bytes = std::fs::metadata(film.path).map_or(0, |data| data.len());
    progress.finished(&Finished {
        steps,
        of,
        seconds: 0.0,
        is_certified,
        file: Some((film.path, bytes)),
        is_resumed: false,
    });
}

/// Writes a picture with its seal, if it gets one; the length of the file.
fn write(path: &Path, picture: &Picture, seal: Option<Seal>) -> anyhow::Result<u64> {
    let mut png = vec![];
    picture.write_png(&mut png)?;
    if let Some(seal) = seal {
        png = seal.sealed_png(&png);
    }
    match is_stdout(path) {
        true => print(|out| Ok(out.write_all(&png)?))?,
        false => write_whole(path, |writer| Ok(writer.write_all(&png)?))
            .with_context(|| path.display().to_string())?,
    }
    Ok(png.len() as u64)
}
