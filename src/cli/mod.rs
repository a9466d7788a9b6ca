//! The command line: one file per command, and what they share.

mod accuracy;
mod args;
mod camera;
mod check;
mod cost;
mod cost_tables;
mod example;
mod export;
mod guides;
mod input;
mod messages;
mod output;
mod render;
mod schema;
mod studio;

use std::process::ExitCode;

use anyhow::Context;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Parser, Subcommand, ValueEnum};
use photosurface::WriteError;

/// How a command ended, if not with an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Status {
    /// All that was asked for.
    Done,
    /// Written, or to be written, but not proven to be within the tolerance.
    NotCertified,
}

/// Exit status where something is not certified.
const NOT_CERTIFIED: u8 = 1;

/// Exit status of an error: nothing was written.
const ERROR: u8 = 2;

/// The apparent shape of fast-moving objects as real geometry.
///
/// An observer who moves near the speed of light receives light now. The places where that light was
/// emitted, in the observer's frame, form a virtual object: the photosurface. photosurface computes it from
/// ordinary meshes and writes it as glTF for Blender, MeshLab, three.js, trimesh and pyvista.
///
/// Units: the speed of light is 1; lengths and times share one unit. Coordinates are right-handed, y up.
/// Results go to files, or to stdout with -o -; everything else goes to stderr.
/// Exit status: 0 done and certified, 1 written but not certified (budget reached, subdivision off), for check that
/// it would be, 2 an error, nothing written, 130 interrupted. Of several files, those that are finished stay.
#[derive(Debug, Parser)]
#[command(name = "photosurface", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Export(export::ExportArgs),
    Render(render::RenderArgs),
    Check(check::CheckArgs),
    Cost(cost::CostArgs),
    Example(example::ExampleArgs),
    Schema(schema::SchemaArgs),
}

/// Exit status after Ctrl-C or a signal that ends the program, as shells have it.
const INTERRUPTED: u8 = 130;

/// Exit status where nobody reads our stdout any more, as shells have it; there is nobody to tell why, either.
const BROKEN_PIPE: u8 = 141;

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
        photosurface::abandon_writes();
        std::process::exit(INTERRUPTED.into());
    });
    let done = match cli.command {
        Command::Export(args) => export::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Cost(args) => cost::run(&args).map(|()| Status::Done),
        Command::Example(args) => example::run(&args).map(|()| Status::Done),
        Command::Schema(args) => schema::run(&args).map(|()| Status::Done),
    };
    ended(done)
}

/// Prints what was asked for in place of a command.
fn print_help(help: &clap::Error) -> anyhow::Result<Status> {
    messages::print(|_| help.print().context("stdout"))?;
    Ok(Status::Done)
}

/// Says why there is no result, if there is none; the exit status.
fn ended(done: anyhow::Result<Status>) -> ExitCode {
    match done {
        Ok(Status::Done) => ExitCode::SUCCESS,
        Ok(Status::NotCertified) => ExitCode::from(NOT_CERTIFIED),
        Err(error) if is_broken_pipe(&error) => ExitCode::from(BROKEN_PIPE),
        // Whoever interrupted the program need not be told.
        Err(error) if is_cancelled(&error) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            messages::error(&error);
            ExitCode::from(ERROR)
        }
    }
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

/// Whoever read our stdout has seen enough (`photosurface example sphere | head`).
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let io = cause.downcast_ref::<std::io::Error>();
        io.is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
    })
}

/// A signal has come, and its handler ends the program.
fn is_cancelled(error: &anyhow::Error) -> bool {
    let mut causes = error.chain();
    causes.any(|cause| matches!(cause.downcast_ref(), Some(WriteError::Cancelled)))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
