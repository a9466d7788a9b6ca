//! `photosurface page`: an interactive page that flies through a scene.

use std::path::PathBuf;

use photosurface::PlacedScene;
use photosurface::jobs::{PageSettings, page};
use photosurface::write::write_page;

use super::args::{InputArgs, ObserverArgs};
use super::effects::{EffectArgs, tell_of_ramp};
use super::input::{Input, tell_of_missing};
use super::messages::{Verbosity, size};
use super::models::ModelArgs;
use super::output::{Bar, check_destinations, is_stdout, write_result};
use super::quoting::quoted;
use super::status::Status;

/// Shown below the flags.
const EXAMPLES: &str = "\
Examples:
  photosurface page
  photosurface page scene.json -o scene.html
  photosurface page bunny.obj --beta 0.9 -o flying.html";

/// The scene of a page that names none: one to fly through.
const BUILT_IN: &str = "flight";

/// Write an interactive page: fly through the scene in a browser
///
/// The page is one HTML file that opens by double-click, without a network. It shows what the observer sees and the
/// photosurface from outside, side by side, at every moment of a flight by keyboard, gamepad or touch.
/// Without SCENE or MESH the built-in scene "flight" is used.
#[derive(Debug, clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub(super) struct PageArgs {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    observer: ObserverArgs,
    #[command(flatten)]
    effects: EffectArgs,
    #[command(flatten)]
    model: ModelArgs,
    /// Where to write the page (.html); - for stdout [default: NAME_page.html in this directory]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &PageArgs) -> anyhow::Result<Status> {
    let mut input_args = args.input.clone();
    if input_args.input.is_none() && input_args.example.is_none() {
        input_args.example = Some(BUILT_IN.to_owned());
    }
    let input = Input::read(&input_args, &args.observer, args.verbosity)?;
    let path = match &args.output {
        Some(path) => path.clone(),
        None => format!("{}_page.html", input.name).into(),
    };
    check_destinations([path.clone()], &input.files)?;
    let scene = args.model.scene(args.effects.scene(input.scene));
    tell_of_ramp(&scene, args.verbosity);
    let placed = PlacedScene::new(scene, input.models)?;
    let settings = PageSettings {
        input: words(&input_args),
        textures: input.textures.clone(),
    };
    let progress = Bar::new(0, "meshes", args.verbosity);
    let content = page(&placed, &settings, &progress)?;
    progress.finish();
    let mut html = Vec::new();
    write_page(&content, &mut html)?;
    write_result(&path, &html)?;
    if !is_stdout(&path) {
        let place = path.display();
        args.verbosity
            .result(format_args!("{place}: {}", size(html.len() as u64)));
    }
    tell_of_missing(&input.textures, placed.scene(), args.verbosity);
    Ok(Status::Done)
}

/// The words of a command line that name the same input.
fn words(input: &InputArgs) -> String {
    let mut words = Vec::new();
    match (&input.input, &input.example) {
        (Some(path), _) => words.push(quoted(&path.to_string_lossy())),
        (None, Some(example)) => words.push(format!("--example {}", quoted(example))),
        (None, None) => {}
    }
    for folder in input.folders() {
        words.push(format!(
            "--allow-read {}",
            quoted(&folder.to_string_lossy())
        ));
    }
    if let Some(normals) = input.normals {
        words.push(format!("--normals {normals}"));
    }
    words.join(" ")
}
