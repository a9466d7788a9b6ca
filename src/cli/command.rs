//! The command line as a whole: which commands there are, and what they have in common.

use std::num::NonZeroUsize;
use std::process::ExitCode;
use std::thread::available_parallelism;

use anyhow::{Context, ensure};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Parser, Subcommand, ValueEnum};
use rayon::ThreadPoolBuilder;

use super::status::{INTERRUPTED, Status, ended};
use super::{args, check, cost, example, export, flight, messages, render, schema};

/// More threads than so many for each core, and than so many on any machine, only wait for each other.
const THREADS_PER_CORE: usize = 4;
const MIN_MAX_THREADS: usize = 64;

/// The variable of the environment that says how many threads there are.
const OF_ENVIRONMENT: &str = "RAYON_NUM_THREADS";

/// The apparent shape of fast-moving objects as real geometry.
///
/// An observer who moves near the speed of light receives light now. The places where that light was
/// emitted, in the observer's frame, form a virtual object: the photosurface. photosurface computes it from
/// ordinary meshes and writes it as glTF for Blender, MeshLab, three.js, trimesh and pyvista.
///
/// Units: the speed of light is 1; lengths and times share one unit. Coordinates are right-handed, y up.
/// Results go to files, or to stdout with -o -; everything else goes to stderr.
/// Exit status: 0 done and certified, 1 written but not certified (budget reached, subdivision off; check: the export would
/// not be certified), 2 an error (nothing written), 130 interrupted, 141 stdout closed. Finished files stay after an error.
#[derive(Debug, Parser)]
#[command(name = "photosurface", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Compute with N threads at once [default: one for each core, or RAYON_NUM_THREADS of the environment]
    #[arg(long, value_name = "N", global = true, value_parser = args::count, allow_hyphen_values = true, help_heading = "Work")]
    threads: Option<NonZeroUsize>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Export(export::ExportArgs),
    Render(render::RenderArgs),
    Check(check::CheckArgs),
    Cost(cost::CostArgs),
    Flight(flight::FlightArgs),
    Example(example::ExampleArgs),
    Schema(schema::SchemaArgs),
}

/// Runs the command line of this process.
pub(crate) fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => advised(error).exit(),
        // Help and the version are results like any other.
        Err(asked_for) => return ended(print_help(&asked_for)),
    };
    // A handler that cannot be set leaves the system's own, which ends the program too.
    let _ = ctrlc::set_handler(|| {
        photosurface::write::abandon_writes();
        std::process::exit(INTERRUPTED.into());
    });
    let threads = compute_with(cli.threads);
    ended(threads.and_then(|()| cli.command.run()))
}

impl Command {
    fn run(&self) -> anyhow::Result<Status> {
        match self {
            Self::Export(args) => export::run(args),
            Self::Render(args) => render::run(args),
            Self::Check(args) => check::run(args),
            Self::Cost(args) => cost::run(args).map(|()| Status::Done),
            Self::Flight(args) => flight::run(args).map(|()| Status::Done),
            Self::Example(args) => example::run(args).map(|()| Status::Done),
            Self::Schema(args) => schema::run(args).map(|()| Status::Done),
        }
    }
}

/// Has all work of this process done by so many threads; without a number, by as many as the environment says.
fn compute_with(threads: Option<NonZeroUsize>) -> anyhow::Result<()> {
    let (name, threads) = match threads {
        Some(threads) => ("--threads", threads.get()),
        None => {
            let named = std::env::var(OF_ENVIRONMENT).ok();
            // As rayon has it, 0 and words that are no number are the same as nothing.
            let named = named.and_then(|threads| threads.parse().ok());
            (OF_ENVIRONMENT, named.unwrap_or(0))
        }
    };
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let max_threads = MIN_MAX_THREADS.max(THREADS_PER_CORE * cores);
    ensure!(
        threads <= max_threads,
        "{name} is {threads}, expected at most {max_threads} on this machine"
    );
    let pool = ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global().context(name)
}

/// Prints what was asked for in place of a command.
fn print_help(help: &clap::Error) -> anyhow::Result<Status> {
    messages::print(|_| help.print().context("stdout"))?;
    Ok(Status::Done)
}

/// An error of the command line with advice that helps.
fn advised(mut error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let Some(ContextValue::String(argument)) = error.get(ContextKind::InvalidArg) else {
        return error;
    };
    let animation = export::Animate::from_str(argument, false).is_ok();
    let tip = format!("a similar argument exists: '--animate={argument}'");
    // To pass a flag "as a value, use '-- --flag'" would make a file name of it.
    error.remove(ContextKind::Suggested);
    if animation {
        let tip = ContextValue::StyledStrs(vec![tip.into()]);
        error.insert(ContextKind::Suggested, tip);
    }
    error
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
