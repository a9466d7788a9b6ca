//! `photosurface schema`: the JSON Schema of the scene file.

use std::io::{Write, stdout};

use photosurface::Scene;

/// Print the JSON Schema of the scene file
#[derive(Debug, clap::Args)]
pub(super) struct SchemaArgs {}

pub(super) fn run(_args: &SchemaArgs) -> anyhow::Result<()> {
    let schema = serde_json::to_string_pretty(&Scene::json_schema())?;
    writeln!(stdout().lock(), "{schema}")?;
    Ok(())
}
