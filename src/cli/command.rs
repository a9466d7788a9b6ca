//! The command line as a whole: which commands there are, and what they have in common.

use std::num::NonZeroUsize;
use std::process::ExitCode;
use std::thread::available_parallelism;

use anyhow::{Context, ensure};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser, Subcommand, ValueEnum};
use rayon::ThreadPoolBuilder;

use super::hints::meant;
use super::status::{INTERRUPTED, Status, ended};
use super::{
    check, cost, example, export, flight, join, messages, page, render, schema, sweep, values,
};

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
pub(super) struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Compute with N threads at once [default: one for each core, or RAYON_NUM_THREADS of the environment]
    #[arg(long, value_name = "N", global = true, value_parser = values::count, allow_hyphen_values = true, help_heading = "Work")]
    threads: Option<NonZeroUsize>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Export(export::ExportArgs),
    Render(render::RenderArgs),
    Sweep(sweep::SweepArgs),
    Join(join::JoinArgs),
    Page(page::PageArgs),
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
            Self::Sweep(args) => sweep::run(args),
            Self::Join(args) => join::run(args),
            Self::Page(args) => page::run(args),
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
    let flags = match export::Animate::from_str(argument, false) {
        Ok(_) => vec![format!("--animate={argument}")],
        Err(_) => meant(&Cli::command(), argument, command_of_process().as_deref()),
    };
    let similar = match error.get(ContextKind::SuggestedArg) {
        Some(ContextValue::String(similar)) => vec![similar.clone()],
        _ => vec![],
    };
    let flags = if flags.is_empty() { similar } else { flags };
    // To pass a flag "as a value, use '-- --flag'" would make a file name of it.
    error.remove(ContextKind::Suggested);
    error.remove(ContextKind::SuggestedArg);
    if !flags.is_empty() {
        let tip = format!("did you mean {}?", flags.join(" or "));
        let tip = ContextValue::StyledStrs(vec![tip.into()]);
        error.insert(ContextKind::Suggested, tip);
    }
    error
}

/// The command that this process was asked for, if it is one.
fn command_of_process() -> Option<String> {
    let cli = Cli::command();
    let words = std::env::args_os().skip(1);
    let mut words = words.filter_map(|word| word.into_string().ok());
    words.find(|word| cli.find_subcommand(word).is_some())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Cli::command().debug_assert();
    }

    /// Every text that help shows, at two widths of a terminal.
    fn helps() -> Vec<(usize, String)> {
        let mut all = vec![];
        for width in [80, 100] {
            let mut cli = super::Cli::command().term_width(width);
            cli.build();
            let each = cli.get_subcommands().cloned().collect::<Vec<_>>();
            for command in each.into_iter().chain([cli]) {
                let mut command = command.term_width(width);
                for help in [command.render_help(), command.render_long_help()] {
                    all.push((width, help.to_string()));
                }
            }
        }
        all
    }

    /// A line that ends although the next word had room, in the middle of a sentence, was broken by hand.
    #[test]
    fn help_breaks_sentences_only_where_the_terminal_ends() {
        let indent = |line: &str| line.len() - line.trim_start().len();
        for (width, help) in helps() {
            let lines: Vec<&str> = help.lines().collect();
            for pair in lines.windows(2) {
                let Some(word) = pair[1].split_whitespace().next() else {
                    continue;
                };
                let same_text = indent(pair[0]) == indent(pair[1]) && !pair[0].trim().is_empty();
                let had_room = pair[0].chars().count() + 1 + word.chars().count() < width;
                let goes_on = word.starts_with(|c: char| c.is_lowercase());
                // Commands of examples, and the list of commands.
                let is_list = word == "photosurface" || pair[1].trim().contains("   ");
                assert!(
                    !(same_text && had_room && goes_on && !is_list),
                    "{width} columns:\n{}\n{}",
                    pair[0],
                    pair[1]
                );
            }
        }
    }
}
