//! `photosurface check`: validates, and says what an export would make, without computing it.

use std::io::Write;

use photosurface::{Format, Precision, Prediction, Stage};

use super::accuracy::{AccuracyArgs, grouped_number, total};
use super::args::{InputArgs, ObserverArgs};
use super::input::Input;
use super::messages::{Verbosity, counted, grouped, print};

/// Validate a scene or a mesh, and say what an export would make
///
/// Reads everything that an export would read and prints, for every object, its parts and triangles, how fast
/// it moves relative to the observer, about how many triangles its photosurfaces take, all steps together, and
/// whether they will be certified to be within the tolerance.
/// Makes and writes nothing.
#[derive(Debug, clap::Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    /// Print the table alone, without notes on what is read
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Messages")]
    quiet: bool,
    /// Say more: every part of every object
    #[arg(short, long, help_heading = "Messages")]
    verbose: bool,
}

pub(super) fn run(args: &CheckArgs) -> anyhow::Result<()> {
    let verbosity = Verbosity::new(args.quiet, args.verbose);
    let input = Input::read(&args.input, &args.observer, verbosity)?;
    for (_, scene) in args.accuracy.levels(input.scene)? {
        let stage = Stage::new(scene, input.models.clone());
        for (name, part) in stage.objects().flat_map(|(_, parts)| parts) {
            verbosity.detail(format_args!(
                "{name}: {}, {}",
                counted(part.mesh().positions().len(), "vertex"),
                counted(part.mesh().triangles().len(), "triangle")
            ));
        }
        if let Err(error) = Format::Glb.least_size(&stage, stage.scene().steps().len()) {
            verbosity.note(error);
        }
        Format::Glb.check_range(&stage)?;
        let wanted = args.accuracy.wanted(Precision::Single);
        let (stage, predictions) = args.accuracy.within_budget(stage, wanted, verbosity);
        print(|out| table(&stage, &predictions, out))?;
    }
    Ok(())
}

fn table(stage: &Stage, predictions: &[Prediction], out: &mut dyn Write) -> anyhow::Result<()> {
    let scene = stage.scene();
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
    for ((object, parts), prediction) in stage.objects().zip(predictions) {
        let triangles: usize = parts
            .iter()
            .map(|(_, part)| part.mesh().triangles().len())
            .sum();
        let relative = stage.relative_velocity(object);
        writeln!(
            out,
            "{:<20} {:>6} {:>12} {:>13.6e} {:>10.6} {:>12} {:>16} {:>9}",
            object.name,
            parts.len(),
            grouped(triangles),
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
