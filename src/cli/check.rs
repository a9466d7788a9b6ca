//! `photosurface check`: validates, and says what an export would make, without computing it.

use std::io::Write;

use photosurface::jobs::EffectCost;
use photosurface::pipeline::Prediction;
use photosurface::spacetime::ViewModel;
use photosurface::write::Format;
use photosurface::{PictureMethod, PictureSettings, PictureView, PlacedScene};

use super::accuracy::{AccuracyArgs, DetailArgs, grouped_number, predicted, total};
use super::args::{InputArgs, ObserverArgs};
use super::effects::EffectArgs;
use super::input::Input;
use super::messages::{Verbosity, counted, print_if_open, shown};
use super::models::ModelsArgs;
use super::output::FileFormat;
use super::status::Status;
use super::wording::or_ply;

/// Validate a scene or a mesh, and predict the export
///
/// Reads everything that an export would read, and writes nothing. For each object it prints: the number of parts; the
/// highest speed relative to the observer; the triangles before refinement and, predicted, after it, summed over all steps;
/// and whether every photosurface will be certified. Then the models, effects and lamps that the scene calls for, and about how long each effect
/// will take, as measured on a small sample: for the vertices of the export, and for a picture of the default size all of
/// whose rays meet surfaces. An export with --animate=morph is not predicted: it has the triangles
/// of all steps in one mesh.
/// Exit status: 0 if the export will end with 0; 1 if it will end with 1 (not certified), or if the steps do not fit into one
/// file but may fit into several (--split); 2 an error; 130 interrupted.
#[derive(Debug, clap::Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    models: ModelsArgs,
    #[command(flatten)]
    effects: EffectArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    #[command(flatten)]
    detail: DetailArgs,
    /// Format of the export: a .ply has double precision, so that it can hold distant or very small objects, and the
    /// Doppler factor
    #[arg(long, value_enum, default_value_t = FileFormat::Glb, help_heading = "Output")]
    format: FileFormat,
    /// Print only the table, without notes on the input
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Messages")]
    quiet: bool,
    /// Say more: every part of every object
    #[arg(short, long, help_heading = "Messages")]
    verbose: bool,
}

pub(super) fn run(args: &CheckArgs) -> anyhow::Result<Status> {
    let format = Format::from(args.format);
    let mut status = Status::Done;
    let verbosity = Verbosity::new(args.quiet, args.verbose);
    let input = Input::read(&args.input, &args.observer, verbosity)?;
    let scene = args.effects.scene(args.accuracy.scene(input.scene));
    let placed = args.models.placed(scene, input.models)?;
    for (name, part) in placed.objects().flat_map(|(_, parts)| parts) {
        verbosity.detail(format_args!(
            "{name}: {}, {}",
            counted(part.mesh().positions().len(), "vertex"),
            counted(part.mesh().triangles().len(), "triangle")
        ));
    }
    if let Err(error) = format.min_size(&placed, placed.scene().steps().len()) {
        verbosity.note(format_args!("{}: {error}", input.place));
        status = Status::NotCertified;
    }
    let range = format.check_range(&placed);
    range.map_err(|error| or_ply(error, &placed).context(input.place.clone()))?;
    for placed in args.detail.levels(placed)? {
        let wanted = args.accuracy.wanted_in(format, placed.scene());
        let fitted = args.accuracy.within_budget(placed, wanted, verbosity);
        let predictions = &fitted.predictions;
        print_if_open(|out| {
            table(&fitted.placed, predictions, out)?;
            effects(&fitted.placed, predictions, out)
        })?;
        args.accuracy
            .tell_beyond_budget(predicted(predictions), verbosity);
        if !predictions.iter().all(|prediction| prediction.reachable) {
            status = Status::NotCertified;
        }
    }
    Ok(status)
}

fn table(
    placed: &PlacedScene,
    predictions: &[Prediction],
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let scene = placed.scene();
    let steps = scene.steps().len();
    writeln!(
        out,
        "{:<20} {:>6} {:>12} {:>13} {:>10} {:>12} {:>16} {:>9}",
        "object",
        "parts",
        "triangles in",
        "gamma",
        "rapidity",
        "tolerance",
        "triangles out",
        "certified"
    )?;
    let mut parts_of_all = 0;
    for ((object, parts), prediction) in placed.objects().zip(predictions) {
        let relative = placed.fastest_relative_velocity(object);
        writeln!(
            out,
            "{:<20} {:>6} {:>12} {:>13.6e} {:>10.6} {:>12} {:>16} {:>9}",
            shown(&object.name),
            parts.len(),
            grouped_number(prediction.triangles_in),
            relative.gamma(),
            relative.rapidity(),
            scene.tolerance(object).to_string(),
            format!("about {}", grouped_number(prediction.triangles)),
            if prediction.reachable { "yes" } else { "no" },
        )?;
        parts_of_all += parts.len();
    }
    writeln!(
        out,
        "{}: {}, about {}",
        counted(steps, "step"),
        counted(parts_of_all * steps, "photosurface"),
        total(predictions)
    )?;
    Ok(())
}

/// The models and effects that the scene calls for, with what each effect will cost.
fn effects(
    placed: &PlacedScene,
    predictions: &[Prediction],
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    for model in ViewModel::ALL {
        let objects = placed.scene().objects().iter();
        let count = objects
            .filter(|object| object.view_model() == model)
            .count();
        if model != ViewModel::Seen && count > 0 {
            writeln!(out, "model {model}: {}", counted(count, "object"))?;
        }
    }
    let costs = EffectCost::of(placed);
    if costs.is_empty() {
        return Ok(());
    }
    // As many vertices for a triangle as there are at rest.
    let vertices = placed.objects().zip(predictions);
    let vertices = vertices.map(|((_, parts), prediction)| {
        let meshes = || parts.iter().map(|(_, part)| part.mesh());
        let vertices: usize = meshes().map(|mesh| mesh.positions().len()).sum();
        let triangles: usize = meshes().map(|mesh| mesh.triangles().len()).sum();
        prediction.triangles * vertices as f64 / triangles.max(1) as f64
    });
    let vertices: f64 = vertices.sum();
    let picture = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
    let (size, samples) = (picture.camera.size, f64::from(picture.samples.get()));
    let rays = f64::from(size.width()) * f64::from(size.height()) * samples * samples;
    for cost in costs {
        let in_export = match cost.effect {
            "doppler" | "emission" => format!(
                "about {:.3} s for the colours of about {} vertices, ",
                cost.seconds(vertices),
                grouped_number(vertices)
            ),
            _ => String::new(),
        };
        writeln!(
            out,
            "effect {}: {in_export}about {:.3} s for a picture of {} x {} pixels",
            cost.effect,
            cost.seconds(rays),
            size.width(),
            size.height()
        )?;
    }
    Ok(())
}
