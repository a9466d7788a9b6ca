//! Runs the configurations of a sweep one after the other; models are read once.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{bail, ensure};
use photosurface::write::writes_are_abandoned;

use super::file::{Common, Configuration, Configured, configurations};
use super::rows::{Ended, Row, Table};
use crate::cli::export;
use crate::cli::input::Loaded;
use crate::cli::messages::{Verbosity, counted, notes_so_far, print_if_open, shown, size};
use crate::cli::outcome::Outcome;
use crate::cli::output::{check_destinations, shows_table, write_result};
use crate::cli::render;
use crate::cli::status::Status;
use crate::cli::values::part;
use crate::cli::work::{Line, Plan, PlannedFile, Telling, Told};

/// Shown below the flags.
const EXAMPLES: &str = "\
Examples:
  photosurface sweep speeds.json bunny.glb --csv speeds.csv
  photosurface sweep speeds.json bunny.glb --only 10..20 --resume

speeds.json: [ { \"name\": \"slow\", \"beta\": 0.5 }, { \"name\": \"fast\", \"gamma\": 5, \"steps\": [-1, 0, 1] } ]";

/// Run export or render many times with different flags
///
/// The runs are a JSON list; each is an object of flags of the command, as in { "beta": 0.9, "steps": [0, 1], "split": true },
/// and of a "name". Or they are in the "runs" of an object, beside "command" ("export" or "render"), "input" (the scene or the
/// mesh) and "all" (flags of all runs). Every run writes what the command alone would write, byte for byte; scene and meshes
/// are read once. A run that fails does not end the others. `photosurface schema --sweep` prints the JSON Schema.
/// Exit status: 0 if every run was certified; 1 if some run was not; 2 if some run failed, or the list has an error (nothing
/// written).
#[derive(Debug, clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub(in crate::cli) struct SweepArgs {
    /// The list of runs (.json), or - for stdin
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The scene or the mesh of all runs, in place of the "input" of FILE [default: the built-in scene "sphere"]
    #[arg(value_name = "SCENE|MESH")]
    input: Option<PathBuf>,
    /// The folder, which must exist, of the files that FILE does not name: DIR/NAME.glb, or DIR/NAME.png
    /// [default: this directory]
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Write the table of the runs as JSON; - for stdout, in place of the table
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    json: Option<PathBuf>,
    /// Write the table of the runs as CSV; - for stdout, in place of the table
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Leave out of the tables how long each run took, so that they are the same on every run
    #[arg(long, help_heading = "Output")]
    no_times: bool,
    /// Only the runs from A up to B, B not included, counted from 0; names are those of the whole
    #[arg(long, value_name = "A..B", value_parser = part, help_heading = "Work")]
    only: Option<Range<usize>>,
    /// Leave files that an earlier run with --resume finished, as export and render do
    #[arg(long, help_heading = "Work")]
    resume: bool,
    /// How progress is told on stderr: a bar on a terminal; or "json", a line with a JSON object for each file, in which step is
    /// the number of the run, and for each run that failed
    #[arg(long, value_enum, value_name = "HOW", default_value_t = Telling::Bar, help_heading = "Work")]
    progress: Telling,
    /// Make nothing: print as JSON which files would be read and written, and which are finished for --resume
    #[arg(long, help_heading = "Work")]
    plan: bool,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(in crate::cli) fn run(args: &SweepArgs) -> anyhow::Result<Status> {
    let shows_table = shows_table(args.json.as_deref(), args.csv.as_deref())?;
    let common = Common {
        input: args.input.as_deref(),
        folder: args.output.as_deref().unwrap_or(Path::new("")),
        resume: args.resume,
        plan: args.plan,
    };
    let configurations = configurations(&args.file, &common)?;
    let of = configurations.len();
    let only = args.only.clone().unwrap_or(0..of);
    ensure!(
        only.end <= of,
        "--only is {}..{}, expected a part of {}",
        only.start,
        only.end,
        counted(of, "run")
    );
    let tables = [&args.json, &args.csv].into_iter().flatten();
    check_destinations(tables.clone().cloned(), std::slice::from_ref(&args.file))?;
    for table in tables {
        let writes_it = |run: &&Configuration| run.command.files().contains(&table.as_path());
        if let Some(run) = configurations.iter().find(writes_it) {
            bail!(
                "the table would be {}, which the run \"{}\" writes; expected a file of its own",
                table.display(),
                run.name
            );
        }
    }
    let loaded = Loaded::default();
    let chosen = configurations.iter().enumerate();
    let chosen = chosen.skip(only.start).take(only.len());
    if args.plan {
        return plan(args, chosen, of, &loaded);
    }
    let told = Told::new(args.progress, only.len(), "runs", args.verbosity);
    let mut rows = vec![];
    for (number, configuration) in chosen {
        let row = row(args, number, configuration, &loaded);
        // Whoever told the program to end wants no further run.
        ensure!(!writes_are_abandoned(), "cancelled");
        for line in lines(&row, of) {
            told.say(&line);
        }
        told.one_more();
        for note in &row.notes {
            args.verbosity.retold(format_args!("{}: {note}", row.name));
        }
        match &row.error {
            Some(error) => args
                .verbosity
                .retold(format_args!("{} failed: {error}", row.name)),
            None => args.verbosity.detail(format_args!(
                "{}: {}, {}",
                row.name,
                counted(row.triangles, "triangle"),
                size(row.bytes)
            )),
        }
        rows.push(row);
    }
    told.finish();
    let table = Table {
        version: env!("CARGO_PKG_VERSION"),
        runs: &rows,
    };
    if let Some(path) = &args.json {
        write_result(path, (table.to_json() + "\n").as_bytes())?;
    }
    if let Some(path) = &args.csv {
        write_result(path, table.to_csv().as_bytes())?;
    }
    if shows_table && !args.verbosity.is_quiet() {
        print_if_open(|out| table.print(out))?;
    }
    let failed = rows.iter().filter(|row| row.ended == Ended::Failed);
    if let Some(first) = failed.clone().next() {
        bail!(
            "{} of {} failed; the first is \"{}\": {}",
            failed.count(),
            counted(rows.len(), "run"),
            shown(&first.name),
            first.error.as_deref().unwrap_or_default()
        );
    }
    let is_certified = |row: &Row| row.ended == Ended::Certified;
    Ok(match rows.iter().all(is_certified) {
        true => Status::Done,
        false => Status::NotCertified,
    })
}

fn made(configuration: &Configuration, loaded: &Loaded) -> anyhow::Result<Outcome> {
    match &configuration.command {
        Configured::Export(args) => export::made(args, loaded),
        Configured::Render(args) => render::made(args, loaded),
    }
}

fn row(args: &SweepArgs, run: usize, configuration: &Configuration, loaded: &Loaded) -> Row {
    let start = Instant::now();
    let notes_before = notes_so_far().len();
    let made = made(configuration, loaded);
    let seconds = start.elapsed().as_secs_f64();
    let ended = match &made {
        Ok(outcome) if outcome.status == Status::Done => Ended::Certified,
        Ok(_) => Ended::NotCertified,
        Err(_) => Ended::Failed,
    };
    let error = made.as_ref().err().map(|error| format!("{error:#}"));
    let outcome = made.unwrap_or_default();
    let length = |file: &PathBuf| std::fs::metadata(file).map_or(0, |data| data.len());
    Row {
        run,
        name: configuration.name.clone(),
        ended,
        seconds: (!args.no_times).then_some(seconds),
        photosurfaces: outcome.tally.photosurfaces,
        triangles: outcome.tally.triangles,
        uncertified: outcome.tally.uncertified,
        bytes: outcome.files.iter().map(length).sum(),
        files: outcome
            .files
            .iter()
            .map(|file| file.display().to_string())
            .collect(),
        resumed: outcome.resumed,
        notes: notes_so_far().split_off(notes_before),
        error,
    }
}

/// The lines of progress that a run becomes: one for each file, or one that says why there is none.
fn lines(row: &Row, of: usize) -> Vec<Line> {
    let line = |index: usize, file: Option<&String>| Line {
        step: row.run,
        steps: 1,
        of,
        // The time is that of all files of the run.
        seconds: row.seconds.filter(|_| index == 0).unwrap_or(0.0),
        bytes: file.map(|file| std::fs::metadata(Path::new(file)).map_or(0, |data| data.len())),
        file: file.cloned(),
        certified: row.ended == Ended::Certified,
        resumed: row.resumed > 0 && row.resumed == row.files.len(),
        error: row.error.clone(),
    };
    match row.files.is_empty() {
        true => vec![line(0, None)],
        false => {
            let files = row.files.iter().enumerate();
            files.map(|(index, file)| line(index, Some(file))).collect()
        }
    }
}

/// Prints what all runs would read and write.
fn plan<'a>(
    args: &SweepArgs,
    chosen: impl Iterator<Item = (usize, &'a Configuration)>,
    of: usize,
    loaded: &Loaded,
) -> anyhow::Result<Status> {
    let mut inputs = vec![args.file.display().to_string()];
    let mut outputs = vec![];
    for (number, configuration) in chosen {
        let steps = [number, number + 1];
        let plan = match made(configuration, loaded) {
            Ok(outcome) => outcome.plan,
            Err(error) => {
                outputs.push(PlannedFile {
                    file: None,
                    steps,
                    finished: false,
                    certified: None,
                    error: Some(format!("{error:#}")),
                });
                continue;
            }
        };
        let Some(plan) = plan else {
            continue;
        };
        for input in plan.inputs {
            if !inputs.contains(&input) {
                inputs.push(input);
            }
        }
        outputs.extend(
            plan.outputs
                .into_iter()
                .map(|file| PlannedFile { steps, ..file }),
        );
    }
    let plan = Plan {
        version: env!("CARGO_PKG_VERSION"),
        of,
        overview: None,
        inputs,
        outputs,
    };
    plan.print()?;
    Ok(Status::Done)
}
