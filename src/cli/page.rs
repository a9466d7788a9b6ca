//! `photosurface page`: an interactive page that flies through a scene.

use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use photosurface::PlacedScene;
use photosurface::jobs::{PageSettings, page};
use photosurface::write::write_page;

use super::args::{InputArgs, ObserverArgs};
use super::effects::{EffectArgs, tell_of_ramp};
use super::input::{Input, tell_of_missing};
use super::messages::{Verbosity, print, size};
use super::models::ModelArgs;
use super::output::{Bar, check_destinations, is_stdout, write_result};
use super::quoting::quoted;
use super::serve::Server;
use super::status::Status;

/// Shown below the flags.
const EXAMPLES: &str = "\
Examples:
  photosurface page
  photosurface page scene.json -o scene.html
  photosurface page bunny.obj --beta 0.9 -o flying.html
  photosurface page --serve";

/// The scene of a page that names none: one to fly through.
const BUILT_IN: &str = "flight";

/// Where browsers look for a page that is served, unless something else is there.
const PORTS: [u16; 2] = [8017, 0];

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
    /// Serve the page to browsers of this machine until Ctrl-C, in place of a file, and print its address; virtual reality needs
    /// this [default port: 8017, or a free one where that is taken]
    #[arg(
        long,
        value_name = "PORT",
        num_args = 0..=1,
        require_equals = true,
        conflicts_with = "output",
        help_heading = "Output"
    )]
    serve: Option<Option<u16>>,
    /// Serve the page at this address of the machine; 0.0.0.0 for all of them, where everyone in the network can see the page
    /// [default: 127.0.0.1]
    #[arg(
        long,
        value_name = "ADDRESS",
        requires = "serve",
        help_heading = "Output"
    )]
    host: Option<IpAddr>,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &PageArgs) -> anyhow::Result<Status> {
    ensure_port_has_its_sign(args)?;
    let mut input_args = args.input.clone();
    if input_args.input.is_none() && input_args.example.is_none() {
        input_args.example = Some(BUILT_IN.to_owned());
    }
    let input = Input::read(&input_args, &args.observer, args.verbosity)?;
    let path = match &args.output {
        Some(path) => path.clone(),
        None => format!("{}_page.html", input.name).into(),
    };
    let server = args.serve.map(|port| server(args.host, port)).transpose()?;
    if server.is_none() {
        check_destinations([path.clone()], &input.files)?;
    }
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
    tell_of_missing(&input.textures, placed.scene(), args.verbosity);
    if let Some(server) = server {
        print(|out| Ok(writeln!(out, "{}", server.url())?))?;
        args.verbosity.result("the page is there until Ctrl-C");
        server.run(&html)?;
        return Ok(Status::Done);
    }
    write_result(&path, &html)?;
    if !is_stdout(&path) {
        let place = path.display();
        args.verbosity
            .result(format_args!("{place}: {}", size(html.len() as u64)));
    }
    Ok(Status::Done)
}

/// A server at the address and the port that the flags say.
fn server(host: Option<IpAddr>, port: Option<u16>) -> anyhow::Result<Server> {
    let host = host.unwrap_or(Ipv4Addr::LOCALHOST.into());
    match port {
        Some(port) => Server::bind(host, &[port]).context("--serve"),
        None => Server::bind(host, &PORTS).context("--serve"),
    }
}

/// `--serve 8017` would be the page of a scene in a file `8017`.
fn ensure_port_has_its_sign(args: &PageArgs) -> anyhow::Result<()> {
    let input = args.input.input.as_deref().and_then(Path::to_str);
    let port: Option<u16> = input.and_then(|input| input.parse().ok());
    if let (Some(None), Some(port)) = (args.serve, port) {
        bail!("--serve takes its port after an equals sign: --serve={port}");
    }
    Ok(())
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
