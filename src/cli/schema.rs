//! `photosurface schema`: the JSON Schemas of the files that the program reads and writes.

use photosurface::Scene;
use photosurface::jobs::Check;
use photosurface::write::Report;

use super::messages::print;
use super::sweep::json_schema;

/// Print the JSON Schema of the scene file, or of what the program writes
#[derive(Debug, clap::Args)]
pub(super) struct SchemaArgs {
    /// Print the schema of the reports of export --report instead
    #[arg(long, group = "which")]
    report: bool,
    /// Print the schema of the document of check --json instead
    #[arg(long, group = "which")]
    check: bool,
    /// Print the schema of the list of sweep instead
    #[arg(long, group = "which")]
    sweep: bool,
}

pub(super) fn run(args: &SchemaArgs) -> anyhow::Result<()> {
    let schema = match (args.report, args.check, args.sweep) {
        (true, _, _) => Report::json_schema().to_value(),
        (_, true, _) => Check::json_schema().to_value(),
        (_, _, true) => json_schema(),
        _ => Scene::json_schema().to_value(),
    };
    let schema = serde_json::to_string_pretty(&schema)?;
    print(|out| Ok(writeln!(out, "{schema}")?))
}
