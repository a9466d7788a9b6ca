//! `photosurface render`: pictures of what the observer sees, and of photosurfaces from anywhere.

use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use photosurface::jobs::{
    Column, EmptyView, RenderError, ViewCost, render_side_by_side, side_by_side_size,
};
use photosurface::render::Picture;
use photosurface::spacetime::ViewModel;
use photosurface::tessellate::Precision;
use photosurface::write::write_whole;
use photosurface::{DVec3, PictureView, PlacedScene};

use super::accuracy::AccuracyArgs;
use super::args::{InputArgs, ObserverArgs};
use super::camera::{CameraArgs, Method, View};
use super::effects::{EffectArgs, tell_of_ramp};
use super::film::FilmArgs;
use super::guides::GuideArgs;
use super::input::{Input, tell_of_missing};
use super::messages::{Verbosity, counted, print};
use super::models::ModelsArgs;
use super::output::{Bar, check_destinations, extension, from_first_to_last, is_stdout};
use super::status::Status;

/// Make pictures of what the observer sees, or of photosurfaces from outside
///
/// The observer's view is made by following rays of light back into the rest frame of each object, exact at every
/// pixel, or with --method mesh by drawing the photosurfaces that export would write.
/// Without SCENE or MESH the built-in scene "sphere" is used:
///
///     photosurface render
///     photosurface render --sheet --example cube -o cube.png
///     photosurface render --example street --look 0,0,-1 -o street.png
///     photosurface render --example cube --film cube.gif
///     photosurface render --example cube --view outside --ghost rest,contracted --axes -o outside.png
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
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<Status> {
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
    let mut input = Input::read(&args.input, &args.observer, verbosity)?;
    if let Some(film) = &film {
        input.scene = film.scene(input.scene, args.observer.has_steps())?;
    }
    let mut settings = camera.settings(method, input.is_mesh);
    let kind = match settings.view {
        PictureView::Sheet { .. } => "sheet",
        PictureView::Observer(_) => "observer",
        PictureView::Outside { .. } => "outside",
    };
    let path = match &args.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}_{kind}.png", input.name)),
    };
    let steps = input.scene.steps().len();
    let models = args.models.side_by_side()?;
    let size = match models.len() {
        0 => settings
            .picture_size(steps)
            .context("--sheet: all steps side by side; choose fewer --steps or a smaller --size")?,
        columns => side_by_side_size(&settings, columns, steps)
            .context("--models: all models side by side; choose fewer, or a smaller --size")?,
    };
    ensure!(
        film.is_some() || settings.picture_count(steps) == 1 || !is_stdout(&path),
        "{steps} steps are as many pictures, they cannot all go to stdout; choose one with --steps"
    );
    let files = match &film {
        Some(film) => vec![film.path.to_owned()],
        None => settings.files(&path, steps),
    };
    check_destinations(files.iter().cloned(), &input.files)?;
    let scene = args.models.scene(args.accuracy.scene(input.scene));
    let scene = args.effects.scene(scene);
    let placed = PlacedScene::new(scene.clone(), input.models)?;
    tell_of_ramp(&scene, verbosity);
    settings.background = camera.background(&scene, settings.background);
    settings.guides = guides.into();
    settings.surface_options = args.accuracy.wanted(Precision::Double);
    let fits_budget = camera.shows_meshes(method) && settings.surface_options.subdivide;
    let fitted = |placed| match fits_budget {
        true => {
            let wanted = settings.surface_options;
            args.accuracy
                .within_budget(placed, wanted, verbosity)
                .placed
        }
        false => placed,
    };
    let progress = Bar::new(0, "rows", verbosity);
    let textures = &input.textures;
    let draw = |finished: &mut dyn FnMut(usize, &Picture) -> anyhow::Result<()>| match models {
        [] => {
            let placed = fitted(placed);
            photosurface::render(&placed, textures, &settings, &progress, finished)
        }
        models => {
            let columns = columns(placed, models, fitted)?;
            render_side_by_side(&columns, textures, &settings, &progress, finished)
        }
    };
    let rendered = match &film {
        Some(film) => film.record(size, steps, draw),
        None => draw(&mut |number, picture| write(&files[number], picture)),
    };
    let rendered = rendered.map_err(|error| match error.downcast::<RenderError>() {
        Ok(error) => camera.flagged(error),
        Err(error) => error,
    })?;
    progress.finish();
    tell_of_costs(&rendered.costs, verbosity);
    let views = steps * models.len().max(1);
    tell_of_empty(&rendered.empty, views, camera, method, verbosity);
    tell_of_missing(&input.textures, &scene, verbosity);
    if !is_stdout(&files[0]) {
        let pictures = match &film {
            Some(_) => counted(steps, "frame"),
            None => counted(files.len(), "picture"),
        };
        verbosity.result(format_args!(
            "{}: {pictures}{}",
            from_first_to_last(&files),
            legend(args)
        ));
    }
    Ok(match args.accuracy.is_kept(&rendered.tally, verbosity) {
        true => Status::Done,
        false => Status::NotCertified,
    })
}

/// The scene under each of these models.
fn columns(
    placed: PlacedScene,
    models: &[ViewModel],
    fitted: impl Fn(PlacedScene) -> PlacedScene,
) -> anyhow::Result<Vec<Column>> {
    let column = |&model: &ViewModel| {
        Ok(Column {
            label: model.to_string(),
            placed: fitted(placed.clone().with_model_for_all(model)?),
        })
    };
    models.iter().map(column).collect()
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
    let DVec3 { x, y, z } = first.look;
    let which = match views {
        1 => "nothing is to be seen in the picture".to_owned(),
        _ => format!(
            "nothing is to be seen in {} of {views} observer's views",
            empty.len()
        ),
    };
    let sky = if camera.full_sky {
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
        "{which}: every object is in another direction, smaller than a pixel{coarse}; try {advice}"
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

fn write(path: &Path, picture: &Picture) -> anyhow::Result<()> {
    if is_stdout(path) {
        return print(|out| Ok(picture.write_png(out)?));
    }
    write_whole(path, |writer| Ok(picture.write_png(writer)?))
        .with_context(|| path.display().to_string())
}
