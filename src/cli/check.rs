//! `photosurface check`: validates, and says what an export would make, without computing it.

use std::io::Write;

use photosurface::Stage;

use super::args::{InputArgs, ObserverArgs};
use super::input::Input;
use super::messages::{Verbosity, grouped, print};

/// Validate a scene or a mesh, and say what an export would make
///
/// Reads everything that an export would read and prints, for every object, its parts and triangles and how
/// fast it moves relative to the observer. Computes and writes nothing.
#[derive(Debug, clap::Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &CheckArgs) -> anyhow::Result<()> {
    let input = Input::read(&args.input, &args.observer, args.verbosity)?;
    let stage = Stage::new(input.scene, input.models);
    print(|out| table(&stage, out))
}

fn table(stage: &Stage, out: &mut dyn Write) -> anyhow::Result<()> {
    let steps = stage.scene().steps().len();
    let (mut all_parts, mut all_vertices, mut all_triangles) = (0, 0, 0);
    writeln!(
        out,
        "{:<20} {:>6} {:>12} {:>12} {:>14} {:>10}",
        "object", "parts", "vertices", "triangles", "gamma", "rapidity"
    )?;
    for (object, parts) in stage.objects() {
        let vertices: usize = parts
            .iter()
            .map(|(_, part)| part.mesh().positions().len())
            .sum();
        let triangles: usize = parts
            .iter()
            .map(|(_, part)| part.mesh().triangles().len())
            .sum();
        let relative = stage.relative_velocity(object);
        writeln!(
            out,
            "{:<20} {:>6} {:>12} {:>12} {:>14.6e} {:>10.6}",
            object.name,
            parts.len(),
            grouped(vertices),
            grouped(triangles),
            relative.gamma(),
            relative.rapidity()
        )?;
        all_parts += parts.len();
        all_vertices += vertices;
        all_triangles += triangles;
    }
    writeln!(
        out,
        "{} step{}: {} photosurfaces, {} vertices, {} triangles",
        steps,
        if steps == 1 { "" } else { "s" },
        grouped(all_parts * steps),
        grouped(all_vertices * steps),
        grouped(all_triangles * steps)
    )?;
    Ok(())
}
