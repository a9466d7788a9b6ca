//! `photosurface flight`: the observer's worldline, as a table and as a Minkowski diagram.

use std::path::PathBuf;

use anyhow::{Context, anyhow, ensure};
use photosurface::jobs::{DiagramError, DiagramPoint, DiagramSettings, WorldlineDiagram};
use photosurface::pipeline::MomentFacts;
use photosurface::scene::{Place, even_steps};
use photosurface::study::PlotSize;
use photosurface::{DVec3, Scene};
use serde::Serialize;

use super::args::{InputArgs, ObserverArgs};
use super::drawing::{DrawingFormat, plot_size};
use super::flight_tables::{csv_of_moments, table_of};
use super::input::Input;
use super::messages::{Verbosity, print_if_open};
use super::output::{check_destinations, shows_table, write_result};
use super::values::{number, vector};

/// Rows of the table of a flight whose scene has no steps.
const ROWS: usize = 11;

/// List the observer's worldline: time, position, speed, axes and acceleration; draw it as a Minkowski diagram
///
/// One row for each step of the scene; if the scene has a flight and no steps but the observation itself, 11 rows at even
/// proper times over the flight. All numbers are of the scene frame, in scene units, the speed of light being 1; times in
/// seconds and accelerations in g are added where the scene says what its units are. Where a segment of the flight ends, the
/// acceleration is that of the next one, or none.
///
/// A table goes to stdout.
#[derive(Debug, clap::Args)]
pub(super) struct FlightArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    diagram: DiagramArgs,
    #[command(flatten)]
    output: OutputArgs,
    /// Print only the table, without notes on the input
    #[arg(short, long, help_heading = "Messages")]
    quiet: bool,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Diagram")]
struct DiagramArgs {
    /// Draw a Minkowski diagram, time t upward and one direction of space to the right, both in scene units at one scale: the
    /// observer's worldline with ticks of proper time, worldlines of objects, and for each time of --at the light cone, the
    /// observer's own axes, and the events at which the light that is seen was emitted; a green square, on the own axis of
    /// space, is where that is seen: .png or .svg
    #[arg(long, value_name = "FILE")]
    diagram: Option<PathBuf>,
    /// Proper times of the observer, in scene units, with light cone, own axes and emission events
    /// [default: the first and the last row of the table]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', value_parser = number, allow_hyphen_values = true, requires = "diagram")]
    at: Vec<f64>,
    /// A point whose worldline and emission events are drawn: an object's origin, or a place in its rest frame, in scene
    /// units; may be given several times [default: the origins of all objects]
    #[arg(long, value_name = "OBJECT[:X,Y,Z]", value_parser = point, requires = "diagram")]
    point: Vec<DiagramPoint>,
    /// Direction of space in the diagram, in the scene frame, a vector of any length; what is beside the plane of this
    /// direction and time through the observer at proper time 0 is hollow or dashed [default: from the observer's first
    /// place in the diagram to the farthest one; if the observer stays, to the farthest emission event]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, requires = "diagram")]
    plane: Option<DVec3>,
    /// Size of the diagram in pixels, from 640x480 to 8192x8192 [default: 800x800]
    #[arg(long, value_name = "WxH", value_parser = plot_size, requires = "diagram")]
    diagram_size: Option<PlotSize>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
struct OutputArgs {
    /// Write the table with all digits as JSON, with the observer's axes as four-vectors t,x,y,z and the proper acceleration
    /// in these axes; - for stdout, in place of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// The same as CSV, one line for each row; - for stdout, in place of the table
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// The worldline as JSON.
#[derive(Serialize)]
struct Worldline<'a> {
    moments: &'a [MomentFacts],
}

pub(super) fn run(args: &FlightArgs) -> anyhow::Result<()> {
    let verbosity = Verbosity::new(args.quiet, false);
    let output = &args.output;
    let drawing = DrawingFormat::of_flag("--diagram", args.diagram.diagram.as_deref())?;
    let shows_table = shows_table(output.json.as_deref(), output.csv.as_deref())?;
    let input = Input::read(&args.input, &args.observer, verbosity)?;
    let files = [&output.json, &output.csv, &args.diagram.diagram];
    check_destinations(files.into_iter().flatten().cloned(), &input.files)?;

    let scene = &input.scene;
    let times = proper_times(scene)?;
    let facts = times
        .iter()
        .map(|&time| MomentFacts::new(scene.flight(), time));
    let moments: Vec<MomentFacts> = facts.collect();
    for moment in &moments {
        ensure!(
            is_finite(moment),
            "at proper time {:?} the observer is farther than any number says, expected a time nearer to the flight",
            moment.proper_time
        );
    }
    // The diagram may fail: nothing is written before it is there.
    let diagram = drawing.map(|(path, format)| {
        let bytes = args.diagram.draw(&input, &times, format)?;
        anyhow::Ok((path, bytes))
    });
    let diagram = diagram.transpose()?;

    if shows_table {
        print_if_open(|out| table_of(&moments, scene.units(), out))?;
    }
    if let Some((path, bytes)) = diagram {
        write_result(path, &bytes)?;
    }
    if let Some(path) = &output.json {
        let json = serde_json::to_string_pretty(&Worldline { moments: &moments });
        let json = json.expect("names and numbers") + "\n";
        write_result(path, json.as_bytes())?;
    }
    if let Some(path) = &output.csv {
        write_result(path, csv_of_moments(&moments).as_bytes())?;
    }
    Ok(())
}

impl DiagramArgs {
    fn draw(&self, input: &Input, rows: &[f64], format: DrawingFormat) -> anyhow::Result<Vec<u8>> {
        let (first, last) = rows.iter().fold((rows[0], rows[0]), |(first, last), &row| {
            (first.min(row), last.max(row))
        });
        let mut at = match self.at.as_slice() {
            [] => vec![first, last],
            at => at.to_vec(),
        };
        at.sort_by(f64::total_cmp);
        at.dedup();
        let settings = DiagramSettings {
            proper_times: first..=last,
            at,
            direction: self.plane,
            points: self.point.clone(),
        };
        let mut diagram =
            WorldlineDiagram::new(&input.scene, &settings).map_err(|error| match error {
                DiagramError::Object(..) => anyhow::Error::new(error).context("--point"),
                DiagramError::Direction(_) => anyhow::Error::new(error).context("--plane"),
                _ => anyhow::Error::new(error).context("--diagram"),
            })?;
        if input.is_mesh {
            // It has no title, and diagrams of two meshes have to be told apart.
            diagram.title.get_or_insert(input.name.clone());
        }
        let size = match self.diagram_size {
            Some(size) => size,
            None => PlotSize::new(800, 800)?,
        };
        let drawn = match format {
            DrawingFormat::Png => diagram.png(size),
            DrawingFormat::Svg => diagram.svg(size).map(String::into_bytes),
        };
        drawn.context("--diagram")
    }
}

/// The steps of the scene, or even times of the flight if it has no others than the observation.
fn proper_times(scene: &Scene) -> anyhow::Result<Vec<f64>> {
    let flight = scene.flight();
    match scene.steps() {
        [0.0] if flight.proper_time() > 0.0 => Ok(even_steps(0.0, flight.proper_time(), ROWS)?),
        steps => Ok(steps.to_vec()),
    }
}

fn is_finite(moment: &MomentFacts) -> bool {
    let axes = moment.axes.as_flattened().iter();
    let vectors = moment.position.iter().chain(&moment.velocity).chain(axes);
    let numbers = [&moment.time, &moment.gamma, &moment.rapidity];
    vectors.chain(numbers).all(|number| number.is_finite())
}

/// `OBJECT` or `OBJECT:X,Y,Z`
fn point(text: &str) -> anyhow::Result<DiagramPoint> {
    let parts = text.rsplit_once(':');
    let placed = parts.and_then(|(object, place)| Some((object, vector(place).ok()?)));
    let (object, position) = placed.unwrap_or((text, DVec3::ZERO));
    ensure!(
        !object.is_empty(),
        anyhow!("no name, expected OBJECT or OBJECT:X,Y,Z")
    );
    Ok(DiagramPoint {
        object: object.to_owned(),
        position_rest: Place::new(position)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_as_people_write_them() {
        let read = |text| {
            let point = point(text).expect("a point");
            (point.object, point.position_rest.get())
        };
        assert_eq!(read("cube"), ("cube".to_owned(), DVec3::ZERO));
        let expected = ("cube".to_owned(), DVec3::new(1.0, -0.5, 0.0));
        assert_eq!(read("cube:1,-.5,0"), expected);
        assert_eq!(read("a:b"), ("a:b".to_owned(), DVec3::ZERO));
        assert_eq!(read("a:b:0,0,1"), ("a:b".to_owned(), DVec3::Z));
        assert!(point(":1,2,3").is_err());
    }
}
