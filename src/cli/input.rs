//! From the command line's input to a scene with its models: files, stdin, built-in scenes, bare meshes.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use photosurface::{
    BUILT_IN_SCENES, DVec3, Findings, Model, Object, Observer, ReadError, Scene, Source,
    load_models, read_gltf_bytes, read_model,
};

use super::args::{InputArgs, ObserverArgs};
use super::example::built_in;
use super::messages::Verbosity;
use super::output::extension;

/// Beyond its centre, by how many diagonals of a bare mesh's bounds the observer stands off.
const STAND_OFF: f64 = 2.0;

/// A scene with its models and where they came from.
#[derive(Debug)]
pub(super) struct Input {
    /// What to call it: `bunny` of `bunny.obj`.
    pub(super) name: String,
    /// Whether it is a mesh without a scene.
    pub(super) is_mesh: bool,
    /// The scene with everything that the flags say.
    pub(super) scene: Scene,
    /// One for each object of the scene.
    pub(super) models: Vec<Model>,
    /// The files it was read from, for they must not be written over: also buffers, images and libraries.
    pub(super) files: Vec<PathBuf>,
}

impl Input {
    /// Reads what the command line names, and tells the user what there is to know about it.
    pub(super) fn read(
        input: &InputArgs,
        observer: &ObserverArgs,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        match input.input.as_deref().map(Path::new) {
            None => {
                let name = input.example.as_deref().unwrap_or(BUILT_IN_SCENES[0].name);
                let scene =
                    Scene::from_json(built_in(name)?.json).expect("built-in scenes are tested");
                Self::from_scene(name, scene, None, observer, verbosity)
            }
            Some(path) if path == Path::new("-") => {
                let mut bytes = Vec::new();
                std::io::stdin()
                    .lock()
                    .read_to_end(&mut bytes)
                    .context("stdin")?;
                if bytes.starts_with(b"glTF") {
                    let read = read_gltf_bytes(&bytes, Path::new("")).context("stdin")?;
                    return Self::from_mesh("mesh", read, None, observer, verbosity);
                }
                let scene = scene_from_stdin(&bytes)?;
                Self::from_scene("stdin", scene, None, observer, verbosity)
            }
            Some(path) => Self::from_path(path, observer, verbosity),
        }
    }

    fn from_path(
        path: &Path,
        observer: &ObserverArgs,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        let place = path.display().to_string();
        let name = path
            .file_stem()
            .map_or("scene".into(), |stem| stem.to_string_lossy().into_owned());
        match extension(path).as_deref() {
            Some("json") => {
                let bytes = fs::read(path).with_context(|| place.clone())?;
                let scene = scene_from_bytes(&bytes).with_context(|| place)?;
                Self::from_scene(&name, scene, Some(path), observer, verbosity)
            }
            Some("glb" | "gltf" | "obj") => {
                let read = read_model(path).map_err(|error| match &error {
                    // It names the file itself.
                    ReadError::File { path: named, .. } if named == path => error.into(),
                    _ => anyhow::Error::new(error).context(place),
                })?;
                Self::from_mesh(&name, read, Some(path), observer, verbosity)
            }
            _ => bail!(
                "{place}: unknown extension, expected a scene (.json) or a mesh (.glb, .gltf, .obj)"
            ),
        }
    }

    fn from_scene(
        name: &str,
        scene: Scene,
        path: Option<&Path>,
        observer: &ObserverArgs,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        let scene = observer.apply(scene)?;
        let directory = path.and_then(Path::parent).unwrap_or(Path::new(""));
        let place = path.map_or(name.to_string(), |path| path.display().to_string());
        let (models, found) = load_models(&scene, directory).with_context(|| place)?;
        let mut files: Vec<PathBuf> = path.map(Path::to_owned).into_iter().collect();
        for (file, findings) in found {
            for note in findings.notes {
                verbosity.note(format_args!("{}: {note}", file.display()));
            }
            files.extend(findings.files);
        }
        Ok(Self {
            name: name.to_owned(),
            is_mesh: false,
            files,
            models,
            scene,
        })
    }

    /// A bare mesh, at rest at the origin; the observer, unless placed, moves towards it.
    fn from_mesh(
        name: &str,
        (model, findings): (Model, Findings),
        path: Option<&Path>,
        flags: &ObserverArgs,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        for note in &findings.notes {
            let place = path.map_or("stdin".into(), |path| path.display().to_string());
            verbosity.note(format_args!("{place}: {note}"));
        }
        let source = Source::File(path.unwrap_or(Path::new("-")).to_owned());
        let scene = Scene::new(Observer::default(), vec![Object::new(name, source)])?;
        let mut scene = flags.apply(scene)?;
        if !flags.has_place() {
            let observer = *scene.observer();
            let position = stand_off(&model, observer.velocity.direction());
            scene = scene.with_observer(Observer {
                position,
                ..observer
            });
        }
        Ok(Self {
            name: name.to_owned(),
            is_mesh: true,
            scene,
            models: vec![model],
            files: findings.files,
        })
    }
}

fn scene_from_bytes(bytes: &[u8]) -> anyhow::Result<Scene> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        anyhow!(
            "not text in UTF-8: byte {offset}, counted from 0, is {:#04x}",
            bytes[offset]
        )
    })?;
    Ok(Scene::from_json(text)?)
}

/// Stdin has no name that says what it holds.
fn scene_from_stdin(bytes: &[u8]) -> anyhow::Result<Scene> {
    const EXPECTED: &str = "stdin takes a scene (JSON) or a GLB";
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = text.trim_ascii_start();
    ensure!(
        text.starts_with(b"{") || text.starts_with(b"["),
        "{EXPECTED}, this is neither; name a file to read .obj or .gltf"
    );
    let json = serde_json::from_slice::<serde_json::Value>(text);
    let is_gltf = json.is_ok_and(|json| json.get("asset").is_some());
    ensure!(
        !is_gltf,
        "{EXPECTED}, this is a .gltf; name its file, for it refers to others"
    );
    scene_from_bytes(bytes).context("stdin")
}

/// Two diagonals of the bounds before the middle of the model.
fn stand_off(model: &Model, direction: DVec3) -> DVec3 {
    let Some((low, high)) = model.bounds() else {
        return DVec3::ZERO;
    };
    0.5 * (low + high) - direction * (STAND_OFF * (high - low).length())
}
