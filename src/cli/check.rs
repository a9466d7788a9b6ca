//! `photosurface check`: validates, and says what an export would make, without computing it.

use std::io::Write;

use photosurface::jobs::{Check, CheckedLevel, CheckedObject};
use photosurface::pipeline::Bounds;
use photosurface::spacetime::ViewModel;
use photosurface::write::Format;

use super::accuracy::{AccuracyArgs, DetailArgs, grouped_number, predicted, triangles};
use super::args::{InputArgs, ObserverArgs};
use super::effects::EffectArgs;
use super::input::{Input, tell_of_inside};
use super::messages::{Verbosity, counted, notes_so_far, print_if_open, shown};
use super::models::ModelsArgs;
use super::output::FileFormat;
use super::provenance::provenance;
use super::status::Status;
use super::tables::table;
use super::wording::or_ply;

/// Validate a scene or a mesh, and predict the export
///
/// Reads everything that an export would read, and writes nothing. For each object it prints: the number of parts; the
/// highest speed relative to the observer; the tolerance and the distance that it limits (--measure); the triangles
/// before refinement and, predicted, after it, summed over all steps; and whether every photosurface will be certified.
/// Then the models, effects and lamps that the scene calls for, and about how long each effect will take, as measured on a
/// small sample: for the vertices of the export, and for a picture of the default size all of whose rays meet surfaces.
/// Last, the middle and the size of the box around each object at rest, and of the
/// box around the places where its vertices are seen at all steps, in the observer's frame. An export with --animate=morph is not predicted: it has the triangles
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
    /// Print everything as one JSON document in place of the tables; photosurface schema --check prints its schema
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Print only the tables, without notes on the input
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Messages")]
    quiet: bool,
    /// Say more: every part of every object
    #[arg(short, long, help_heading = "Messages")]
    verbose: bool,
}

pub(super) fn run(args: &CheckArgs) -> anyhow::Result<Status> {
    let format = Format::from(args.format);
    let verbosity = Verbosity::new(args.quiet, args.verbose);
    let input = Input::read(&args.input, &args.observer, verbosity)?;
    let provenance = provenance(&args.input, &input.files);
    let scene = args.effects.scene(args.accuracy.scene(input.scene));
    let placed = args.models.placed(scene, input.models)?;
    tell_of_inside(&placed, verbosity);
    for (name, part) in placed.objects().flat_map(|(_, parts)| parts) {
        verbosity.detail(format_args!(
            "{name}: {}, {}",
            counted(part.mesh().vertex_count(), "vertex"),
            counted(part.mesh().triangle_count(), "triangle")
        ));
    }
    let fits = format.min_size(&placed, placed.scene().steps().len());
    if let Err(error) = &fits {
        verbosity.note(format_args!("{}: {error}", input.place));
    }
    let range = format.check_range(&placed);
    range.map_err(|error| or_ply(error, &placed).context(input.place.clone()))?;
    let objects = CheckedObject::of_scene(&placed)?;
    let steps = placed.scene().steps().to_vec();
    let mut levels = vec![];
    for placed in args.detail.levels(placed)? {
        let wanted = args.accuracy.wanted_in(format, placed.scene());
        let fitted = args.accuracy.within_budget(placed, wanted, verbosity);
        let level = CheckedLevel::new(&fitted);
        if !args.json {
            print_if_open(|out| tell_level(&level, &objects, steps.len(), out))?;
        }
        args.accuracy
            .tell_beyond_budget(predicted(&fitted.predictions), verbosity);
        levels.push(level);
    }
    let certified = fits.is_ok() && levels.iter().all(|level| level.certified);
    let check = Check {
        provenance,
        format: format.extension().to_owned(),
        fits_into_one_file: fits.is_ok(),
        steps,
        objects,
        levels,
        certified,
        notes: notes_so_far(),
    };
    print_if_open(|out| match args.json {
        true => Ok(writeln!(out, "{}", check.to_json())?),
        false => tell_places(&check.objects, out),
    })?;
    Ok(match certified {
        true => Status::Done,
        false => Status::NotCertified,
    })
}

fn tell_level(
    level: &CheckedLevel,
    objects: &[CheckedObject],
    steps: usize,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    writeln!(
        out,
        "{:<20} {:>6} {:>12} {:>13} {:>10} {:>12} {:>8} {:>16} {:>9}",
        "object",
        "parts",
        "triangles in",
        "gamma",
        "rapidity",
        "tolerance",
        "measure",
        "triangles out",
        "certified"
    )?;
    for (object, prediction) in objects.iter().zip(&level.objects) {
        writeln!(
            out,
            "{:<20} {:>6} {:>12} {:>13.6e} {:>10.6} {:>12} {:>8} {:>16} {:>9}",
            shown(&object.name),
            object.parts,
            grouped_number(prediction.triangles_in),
            object.relative_gamma,
            object.relative_rapidity,
            prediction.tolerance,
            object.measure.name(),
            format!("about {}", grouped_number(prediction.triangles)),
            if prediction.certified { "yes" } else { "no" },
        )?;
    }
    writeln!(
        out,
        "{}: {}, about {}",
        counted(steps, "step"),
        counted(level.photosurfaces, "photosurface"),
        triangles(level.triangles)
    )?;
    for model in ViewModel::ALL {
        let count = objects
            .iter()
            .filter(|object| object.model == model)
            .count();
        if model != ViewModel::Seen && count > 0 {
            writeln!(out, "model {model}: {}", counted(count, "object"))?;
        }
    }
    for cost in &level.effects {
        let in_export = cost.export_seconds.map_or(String::new(), |seconds| {
            format!(
                "about {seconds:.3} s for the colours of about {} vertices, ",
                grouped_number(cost.export_vertices)
            )
        });
        let [width, height] = cost.picture_size;
        writeln!(
            out,
            "effect {}: {in_export}about {:.3} s for a picture of {width} x {height} pixels",
            cost.effect, cost.picture_seconds,
        )?;
    }
    Ok(())
}

/// Where objects are and how large, at rest and as they are seen at all steps.
fn tell_places(objects: &[CheckedObject], out: &mut dyn Write) -> anyhow::Result<()> {
    let cells = |bounds: Option<&Bounds>| match bounds {
        Some(Bounds { centre, size, .. }) => [centre, size].map(vector),
        None => Default::default(),
    };
    let rows = objects.iter().map(|object| {
        let [middle, size] = cells(object.at_rest.as_ref());
        let [seen_middle, seen_size] = cells(object.photosurface.as_ref());
        let name = shown(&object.name);
        [name, middle, size, seen_middle, seen_size]
    });
    writeln!(out)?;
    let headings = [
        "object",
        "middle at rest",
        "size at rest",
        "middle seen",
        "size seen",
    ];
    table(headings, rows, out)
}

/// Three numbers of four digits.
fn vector(numbers: &[f64; 3]) -> String {
    let digits = |number: f64| match number.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-3..1e6).contains(&size) => format!("{number:.3e}"),
        size => {
            let places = (3 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{number:.places$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
    };
    numbers.map(digits).join(",")
}

#[cfg(test)]
mod tests {
    #[test]
    fn vectors_have_four_digits() {
        for (numbers, text) in [
            ([0.0, -1.5, 1.0 / 3.0], "0,-1.5,0.3333"),
            ([1234.56, 100.0, 0.001], "1235,100,0.001"),
            ([1e-9, -2.5e30, 99.996], "1.000e-9,-2.500e30,100"),
        ] {
            assert_eq!(super::vector(&numbers), text);
        }
    }
}
