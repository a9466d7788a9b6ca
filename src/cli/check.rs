//! `photosurface check`: validates, and says what an export would make, without computing it.

use std::io::Write;

use photosurface::{Precision, Stage, Wanted};

use super::accuracy::AccuracyArgs;
use super::args::{InputArgs, ObserverArgs};
use super::input::Input;
use super::messages::{Verbosity, grouped, print};

/// Validate a scene or a mesh, and say what an export would make
///
/// Reads everything that an export would read and prints, for every object, its parts and triangles, how fast
/// it moves relative to the observer, and about how many triangles its photosurfaces take, all steps together.
/// Makes and writes nothing.
#[derive(Debug, clap::Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &CheckArgs) -> anyhow::Result<()> {
    let input = Input::read(&args.input, &args.observer, args.verbosity)?;
    for (_, scene) in args.accuracy.levels(input.scene) {
        let stage = Stage::new(scene, input.models.clone());
        let wanted = args
            .accuracy
            .wanted(&stage, Precision::Single, args.verbosity);
        print(|out| table(&stage, wanted, out))?;
    }
    Ok(())
}

fn table(stage: &Stage, wanted: Wanted, out: &mut dyn Write) -> anyhow::Result<()> {
    let scene = stage.scene();
    let steps = scene.steps().len();
    let mut predicted = vec![0.0; scene.objects().len()];
    for step in 0..steps {
        for (sum, triangles) in predicted
            .iter_mut()
            .zip(stage.predicted_triangles(step, wanted))
        {
            *sum += triangles;
        }
    }
    writeln!(
        out,
        "{:<20} {:>6} {:>12} {:>13} {:>10} {:>12} {:>16}",
        "object", "parts", "triangles in", "gamma", "rapidity", "tolerance", "triangles out"
    )?;
    let mut parts_of_all = 0;
    for ((object, parts), triangles_out) in stage.objects().zip(&predicted) {
        let triangles: usize = parts
            .iter()
            .map(|(_, part)| part.mesh().triangles().len())
            .sum();
        let relative = stage.relative_velocity(object);
        writeln!(
            out,
            "{:<20} {:>6} {:>12} {:>13.6e} {:>10.6} {:>12} {:>16}",
            object.name,
            parts.len(),
            grouped(triangles),
            relative.gamma(),
            relative.rapidity(),
            scene.tolerance(object).to_string(),
            format!("about {}", grouped(triangles_out.round() as usize)),
        )?;
        parts_of_all += parts.len();
    }
    writeln!(
        out,
        "{} step{}: {} photosurfaces, about {} triangles",
        steps,
        if steps == 1 { "" } else { "s" },
        grouped(parts_of_all * steps),
        grouped(predicted.iter().sum::<f64>().round() as usize)
    )?;
    Ok(())
}
