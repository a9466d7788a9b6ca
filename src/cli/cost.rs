//! `photosurface cost`: what accuracy costs in time.

use std::io::{IsTerminal, Write, stderr};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use photosurface::{
    CostSettings, CostStudy, Made, MeshCost, PlotSize, StudyError, Tolerance, write_whole,
};
use serde_json::Value;

use super::accuracy::{grouped_number, tolerance};
use super::args::{InputArgs, ObserverArgs};
use super::input::Input;
use super::messages::{Verbosity, counted, grouped, print, size};
use super::output::{check_destinations, is_stdout};

/// Show what accuracy costs: triangles, bytes, time and memory for one tolerance after the other
///
/// Makes all photosurfaces at each tolerance, writes them to nowhere, and tells the triangles that were made, the least
/// that theory allows and those that uniform subdivision would take; how large the file is, how long it took, how much
/// memory was used; the error that is proven and the one that is measured at random places. The table goes to stdout.
#[derive(Debug, clap::Args)]
pub(super) struct CostArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    output: OutputArgs,
    /// Print the table alone, without notes
    #[arg(short, long, help_heading = "Messages")]
    quiet: bool,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Study")]
struct StudyArgs {
    /// Tolerances to compare, for all objects: fractions of the diagonal (1e-3), lengths in scene units (abs:0.01) or
    /// angles in degrees (deg:0.02), all of one kind [default: 1e-1,1e-2,1e-3,1e-4,1e-5,1e-6]
    #[arg(long, value_name = "T,T,...", value_delimiter = ',', value_parser = tolerance, allow_hyphen_values = true)]
    tolerances: Vec<Tolerance>,
    /// How often each tolerance is carried out, at least 1; times are medians
    #[arg(
        long,
        value_name = "N",
        default_value_t = CostSettings::default().repeats,
        allow_negative_numbers = true
    )]
    repeats: NonZeroUsize,
    /// Tolerances that would take more triangles, all photosurfaces together, are foretold and not carried out
    #[arg(
        long,
        value_name = "N",
        default_value_t = CostSettings::default().most_triangles,
        allow_negative_numbers = true
    )]
    max_triangles: u64,
    /// Number of random places at which the error of each tolerance is measured, at least 1; the same ones on every run
    #[arg(
        long,
        value_name = "N",
        default_value_t = CostSettings::default().samples,
        allow_negative_numbers = true
    )]
    samples: NonZeroUsize,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
struct OutputArgs {
    /// Write the study as JSON; - for stdout, in place of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the table with all digits as CSV, one tolerance a line; - for stdout, in place of the table
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw triangles and time over the tolerance, both logarithmic: .png or .svg
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Size of the plot in pixels, from 320x200 to 8192x8192
    #[arg(long, value_name = "WxH", value_parser = plot_size, default_value = "960x400")]
    plot_size: PlotSize,
}

/// What a plot is written as.
#[derive(Clone, Copy)]
enum Picture {
    Png,
    Svg,
}

pub(super) fn run(args: &CostArgs) -> anyhow::Result<()> {
    let verbosity = Verbosity::new(args.quiet, false);
    let output = &args.output;
    let picture = output.picture()?;
    let to_stdout = |file: &Option<PathBuf>| file.as_deref().is_some_and(is_stdout);
    ensure!(
        !(to_stdout(&output.json) && to_stdout(&output.csv)),
        "--json and --csv cannot both go to stdout"
    );
    let input = Input::read(&args.input, &args.observer, verbosity)?;
    let files = [&output.json, &output.csv, &output.plot];
    check_destinations(files.into_iter().flatten().cloned(), &input.files)?;

    let mut settings = CostSettings {
        repeats: args.study.repeats,
        most_triangles: args.study.max_triangles,
        samples: args.study.samples,
        ..CostSettings::default()
    };
    if !args.study.tolerances.is_empty() {
        settings.tolerances.clone_from(&args.study.tolerances);
    }
    let progress = progress_bar(settings.tolerances.len(), verbosity);
    let study = CostStudy::new(&input.scene, &input.models, &settings, |_| progress.inc(1));
    progress.finish_and_clear();
    let study = study.map_err(|error| match error {
        StudyError::Write { .. } => anyhow::Error::new(error),
        _ => anyhow::Error::new(error).context("--tolerances"),
    })?;
    tell(&study, args.study.max_triangles, verbosity);

    // The plot may fail: nothing is written before it is there.
    let plot = picture.map(|(path, picture)| {
        let drawn = match picture {
            Picture::Png => study.plot_png(output.plot_size),
            Picture::Svg => study.plot_svg(output.plot_size).map(String::into_bytes),
        };
        drawn.context("--plot").map(|bytes| (path, bytes))
    });
    if let Some((path, bytes)) = plot.transpose()? {
        write(path, &bytes)?;
    }
    if let Some(path) = &output.json {
        write(path, (study.to_json() + "\n").as_bytes())?;
    }
    if let Some(path) = &output.csv {
        write(path, csv(&study).as_bytes())?;
    }
    if !to_stdout(&output.json) && !to_stdout(&output.csv) {
        print(|out| table(&study, out))?;
    }
    Ok(())
}

impl OutputArgs {
    fn picture(&self) -> anyhow::Result<Option<(&Path, Picture)>> {
        let Some(path) = self.plot.as_deref() else {
            return Ok(None);
        };
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Some((path, Picture::Png))),
            Some("svg") => Ok(Some((path, Picture::Svg))),
            _ => bail!(
                "--plot {}: unknown extension, expected .png or .svg",
                path.display()
            ),
        }
    }
}

/// What the numbers alone do not say.
fn tell(study: &CostStudy, max_triangles: u64, verbosity: Verbosity) {
    let made: Vec<&Made> = study
        .meshes
        .iter()
        .filter_map(|cost| cost.made.as_ref())
        .collect();
    let left_out = study.meshes.len() - made.len();
    if left_out > 0 {
        let are = if left_out == 1 { "is" } else { "are" };
        verbosity.note(format_args!(
            "{} would take more than --max-triangles {} and {are} foretold alone",
            if left_out == 1 {
                "1 tolerance".to_owned()
            } else {
                format!("{left_out} tolerances")
            },
            grouped(max_triangles as usize)
        ));
    }
    if made.iter().any(|made| made.peak_memory_bytes.is_none()) {
        verbosity.note("this system does not tell how much memory is used at most");
    }
    if made.iter().any(|made| !made.certified) {
        verbosity.note("where the bound is above the tolerance, no number of triangles keeps that");
    }
}

fn progress_bar(tolerances: usize, verbosity: Verbosity) -> ProgressBar {
    if verbosity.is_quiet() || !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} tolerances {elapsed}")
        .expect("the template is well-formed");
    let bar = ProgressBar::new(tolerances as u64).with_style(style);
    bar.enable_steady_tick(std::time::Duration::from_millis(200));
    bar
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if is_stdout(path) {
        return print(|out| Ok(out.write_all(bytes)?));
    }
    Ok(write_whole(path, |writer| Ok(writer.write_all(bytes)?))?)
}

const HEADINGS: [&str; 13] = [
    "tolerance",
    "foretold",
    "triangles",
    "least",
    "ratio",
    "uniform",
    "bound",
    "error",
    "size",
    "predict s",
    "surface s",
    "write s",
    "memory",
];

fn table(study: &CostStudy, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut rows = vec![HEADINGS.map(str::to_owned)];
    rows.extend(study.meshes.iter().map(cells));
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let widths: [usize; HEADINGS.len()] = std::array::from_fn(width);
    for row in &rows {
        let cells = row.iter().zip(widths);
        let cells: Vec<String> = cells
            .map(|(cell, width)| format!("{cell:>width$}"))
            .collect();
        writeln!(out, "{}", cells.join("  "))?;
    }
    let unit = match study.unit {
        "relative" => "relative to the diagonal of each photosurface",
        "absolute" => "lengths",
        _ => "degrees",
    };
    writeln!(
        out,
        "tolerance (asked), bound (proven) and error (measured) are {unit}; times are medians of {}, {}",
        counted(study.repeats, "run"),
        counted(study.threads, "thread"),
    )?;
    Ok(())
}

/// One line of the table.
fn cells(cost: &MeshCost) -> [String; HEADINGS.len()] {
    let mut cells: [String; HEADINGS.len()] = std::array::from_fn(|_| "-".to_owned());
    cells[0] = format!("{:.0e}", cost.tolerance);
    if cells[0].parse() != Ok(cost.tolerance) {
        cells[0] = format!("{:.3e}", cost.tolerance);
    }
    cells[1] = grouped_number(cost.predicted_triangles);
    let Some(made) = &cost.made else {
        return cells;
    };
    cells[2] = grouped(made.triangles);
    cells[3] = grouped_number(made.minimum_triangles);
    cells[4] = format!("{:.2}", made.ratio);
    cells[5] = grouped_number(made.uniform.triangles);
    cells[6] = format!("{:.2e}", made.bound);
    cells[7] = format!("{:.2e}", made.error);
    cells[8] = size(made.file_bytes);
    let seconds = [
        made.seconds.predict,
        made.seconds.photosurface,
        made.seconds.write,
    ];
    for (cell, seconds) in cells[9..].iter_mut().zip(seconds) {
        *cell = format!("{seconds:.4}");
    }
    if let Some(bytes) = made.peak_memory_bytes {
        cells[12] = size(bytes);
    }
    cells
}

/// Columns of the CSV, and where their numbers stand in the JSON of a tolerance.
const COLUMNS: [(&str, &str); 22] = [
    ("tolerance", "/tolerance"),
    ("predicted_triangles", "/predicted_triangles"),
    ("reachable", "/reachable"),
    ("triangles", "/made/triangles"),
    ("triangles_in", "/made/triangles_in"),
    ("minimum_triangles", "/made/minimum_triangles"),
    ("ratio", "/made/ratio"),
    ("file_bytes", "/made/file_bytes"),
    ("predict_seconds", "/made/seconds/predict"),
    ("photosurface_seconds", "/made/seconds/photosurface"),
    ("write_seconds", "/made/seconds/write"),
    ("peak_memory_bytes", "/made/peak_memory_bytes"),
    ("certified", "/made/certified"),
    ("gap", "/made/gap"),
    ("bound", "/made/bound"),
    ("bound_length", "/made/bound_length"),
    ("error", "/made/error"),
    ("error_length", "/made/error_length"),
    ("error_over_bound", "/made/error_over_bound"),
    ("uniform_levels", "/made/uniform/levels"),
    ("uniform_triangles", "/made/uniform/triangles"),
    ("uniform_gap_length", "/made/uniform/run/gap"),
];

/// Names of the columns in the first line; what is not known is empty.
fn csv(study: &CostStudy) -> String {
    let names = COLUMNS.map(|(name, _)| name);
    let mut lines = vec![names.join(",")];
    for cost in &study.meshes {
        let json = serde_json::to_value(cost).expect("names and numbers");
        let cells = COLUMNS.map(|(_, place)| match json.pointer(place) {
            None | Some(Value::Null) => String::new(),
            Some(value) => value.to_string(),
        });
        lines.push(cells.join(","));
    }
    lines.join("\n") + "\n"
}

/// `960x400`
fn plot_size(text: &str) -> anyhow::Result<PlotSize> {
    let sides = text
        .split_once('x')
        .context("expected WxH, such as 960x400")?;
    let pixels = |side: &str| {
        side.parse::<u32>()
            .with_context(|| format!("\"{side}\" is no number of pixels"))
    };
    Ok(PlotSize::new(pixels(sides.0)?, pixels(sides.1)?)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_plots_are_read_as_people_write_them() {
        assert_eq!(
            plot_size("960x400").unwrap(),
            PlotSize::new(960, 400).unwrap()
        );
        for wrong in [
            "",
            "960",
            "960x",
            "960x400x2",
            "0x0",
            "9.5x400",
            "10000x400",
        ] {
            assert!(plot_size(wrong).is_err(), "{wrong}");
        }
    }
}
