//! `photosurface schema`: the JSON Schemas of the files that the program reads and writes.

use photosurface::Scene;
use photosurface::jobs::Check;
use photosurface::write::Report;

use super::messages::print;

/// Print the JSON Schema of the scene file, or of what the program writes
#[derive(Debug, clap::Args)]
pub(super) struct SchemaArgs {
    /// Print the schema of the reports of export --report instead
    #[arg(long, conflicts_with = "check")]
    report: bool,
    /// Print the schema of the document of check --json instead
    #[arg(long)]
    check: bool,
}

pub(super) fn run(args: &SchemaArgs) -> anyhow::Result<()> {
    let schema = match (args.report, args.check) {
        (true, _) => Report::json_schema(),
        (_, true) => Check::json_schema(),
        _ => Scene::json_schema(),
    };
    let schema = serde_json::to_string_pretty(&schema)?;
    print(|out| Ok(writeln!(out, "{schema}")?))
}
