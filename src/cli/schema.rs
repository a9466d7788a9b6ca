//! `photosurface schema`: the JSON Schema of the scene file.

use photosurface::Scene;

use super::messages::print;

/// Print the JSON Schema of the scene file
#[derive(Debug, clap::Args)]
pub(super) struct SchemaArgs {}

pub(super) fn run(_args: &SchemaArgs) -> anyhow::Result<()> {
    let schema = serde_json::to_string_pretty(&Scene::json_schema())?;
    print(|out| Ok(writeln!(out, "{schema}")?))
}
