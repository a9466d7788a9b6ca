//! `photosurface example`: the scenes that the program carries with it.

use anyhow::Context;
use photosurface::scene::{BUILT_IN_SCENES, BuiltInScene};

use super::messages::print;

/// List the built-in scenes, or print one
///
/// A printed scene is a good start for one of your own:
///
///     photosurface example cube > mine.json
///     photosurface export mine.json -o mine.glb
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct ExampleArgs {
    /// Which scene to print; without it they are listed
    name: Option<String>,
}

pub(super) fn run(args: &ExampleArgs) -> anyhow::Result<()> {
    let text = match &args.name {
        Some(name) => built_in(name)?.json.to_owned(),
        None => BUILT_IN_SCENES
            .iter()
            .map(|scene| format!("{:<10} {}\n", scene.name, scene.summary))
            .collect(),
    };
    print(|out| Ok(out.write_all(text.as_bytes())?))
}

/// The built-in scene of that name, or an error that lists them.
pub(super) fn built_in(name: &str) -> anyhow::Result<&'static BuiltInScene> {
    BuiltInScene::named(name).with_context(|| {
        let names: Vec<_> = BUILT_IN_SCENES.iter().map(|scene| scene.name).collect();
        format!(
            "there is no built-in scene \"{name}\", expected one of {}",
            names.join(", ")
        )
    })
}
