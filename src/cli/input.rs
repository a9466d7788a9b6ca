//! From the command line's input to a scene with its models: files, stdin, built-in scenes, bare meshes.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use photosurface::jobs::{
    FileFindings, MAX_SCENE_BYTES, fly_by, passing_observer, scene_from_bytes,
};
use photosurface::material::Normals;
use photosurface::pipeline::{Around, Blurred};
use photosurface::read::{
    Access, EXPECTED_MODEL, Findings, ReadError, is_model_extension, is_model_of_one_file,
    read_whole, with_normals,
};
use photosurface::scene::BUILT_IN_SCENES;
use photosurface::{Model, Object, Observer, PlacedScene, Scene, Source, Textures};

use super::args::{InputArgs, ObserverArgs};
use super::example::built_in;
use super::messages::Verbosity;
use super::output::extension;

/// How many bytes a mesh from stdin has at most: as many as a GLB, since its header says so in 32 bits.
const MAX_MESH_BYTES: u64 = u32::MAX as u64;

/// A scene with its models and where they came from.
#[derive(Debug)]
pub(super) struct Input {
    /// What to call it: `bunny` of `bunny.obj`.
    pub(super) name: String,
    /// The file, as messages name it.
    pub(super) place: String,
    /// Whether it is a mesh without a scene.
    pub(super) is_mesh: bool,
    /// The scene with everything that the flags say.
    pub(super) scene: Scene,
    /// One for each object of the scene.
    pub(super) models: Vec<Model>,
    /// The files it was read from, for they must not be written over: also buffers, images and libraries.
    pub(super) files: Vec<PathBuf>,
    /// For pictures of it: none is decoded so far.
    pub(super) textures: Textures,
}

/// Models that were read before in this process, for runs that share them.
#[derive(Debug, Default)]
pub(super) struct Loaded {
    /// By everything that reading depends on.
    known: RefCell<HashMap<String, (Vec<Model>, FileFindings)>>,
    textures: RefCell<Option<Textures>>,
}

impl Loaded {
    /// What was read before with this key, or what `read` reads now; and whether it was read before.
    fn models(
        &self,
        key: String,
        read: impl FnOnce() -> anyhow::Result<(Vec<Model>, FileFindings)>,
    ) -> anyhow::Result<(Vec<Model>, FileFindings, bool)> {
        if let Some((models, found)) = self.known.borrow().get(&key) {
            return Ok((models.clone(), found.clone(), true));
        }
        let (models, found) = read()?;
        let kept = (models.clone(), found.clone());
        self.known.borrow_mut().insert(key, kept);
        Ok((models, found, false))
    }

    /// Textures that are decoded once for all runs.
    fn textures(&self, max_pixels: u64) -> Textures {
        let mut textures = self.textures.borrow_mut();
        let textures = textures.get_or_insert_with(|| Textures::new(max_pixels));
        textures.clone()
    }
}

/// What is read, for whom, and how much is said about it.
struct Reading<'a> {
    access: Access,
    normals: Option<Normals>,
    observer: &'a ObserverArgs,
    loaded: &'a Loaded,
    verbosity: Verbosity,
}

impl Input {
    /// Reads what the command line names, and tells the user what there is to know about it.
    pub(super) fn read(
        input: &InputArgs,
        observer: &ObserverArgs,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        Self::read_with(input, observer, &Loaded::default(), verbosity)
    }

    /// As [`Input::read`], with models that were read before.
    pub(super) fn read_with(
        input: &InputArgs,
        observer: &ObserverArgs,
        loaded: &Loaded,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        observer.refuse_speeds()?;
        Self::read_for_speeds(input, observer, loaded, verbosity)
    }

    /// As [`Input::read_with`]; of several speeds the scene has the first one.
    pub(super) fn read_for_speeds(
        input: &InputArgs,
        observer: &ObserverArgs,
        loaded: &Loaded,
        verbosity: Verbosity,
    ) -> anyhow::Result<Self> {
        let reading = Reading {
            loaded,
            access: input.access(),
            normals: input.normals,
            observer,
            verbosity,
        };
        match input.input.as_deref().map(Path::new) {
            None => {
                let name = input.example.as_deref().unwrap_or(BUILT_IN_SCENES[0].name);
                let scene =
                    Scene::from_json(built_in(name)?.json).expect("built-in scenes are tested");
                reading.scene(name, scene, None)
            }
            Some(path) if path == Path::new("-") => {
                let bytes = from_stdin()?;
                if is_model_of_one_file(&bytes) {
                    let read = || {
                        let read = reading.access.read_model_bytes(&bytes, Path::new(""));
                        read.context("stdin")
                    };
                    return reading.mesh("mesh", read, None);
                }
                let scene = scene_from_stdin(&bytes)?;
                reading.scene("stdin", scene, None)
            }
            Some(path) => reading.path(path),
        }
    }
}

impl Reading<'_> {
    fn path(&self, path: &Path) -> anyhow::Result<Input> {
        let place = path.display().to_string();
        let name = path
            .file_stem()
            .map_or("scene".into(), |stem| stem.to_string_lossy().into_owned());
        let wrong = |error: ReadError| match &error {
            ReadError::NotOrdinary { found, .. } => {
                anyhow!("{place}: {}", not_a_file(found))
            }
            // The error names the file itself.
            _ if error.file() == Some(path) => error.into(),
            _ => anyhow::Error::new(error).context(place.clone()),
        };
        match extension(path).as_deref() {
            Some("json") => {
                let bytes = read_whole(path, MAX_SCENE_BYTES).map_err(wrong)?;
                let scene = scene_from_bytes(&bytes).with_context(|| place)?;
                self.scene(&name, scene, Some(path))
            }
            Some(extension) if is_model_extension(extension) => self.mesh(
                &name,
                || self.access.read_model(path).map_err(wrong),
                Some(path),
            ),
            // Such as what a shell makes of `<(photosurface example cube)`.
            _ if path.exists() && !path.is_file() && !path.is_dir() => {
                bail!("{place}: {}", not_a_file("a pipe or a device"))
            }
            _ => bail!(
                "{place}: unknown extension, expected a scene (.json) or a mesh: {EXPECTED_MODEL}"
            ),
        }
    }

    fn scene(&self, name: &str, scene: Scene, path: Option<&Path>) -> anyhow::Result<Input> {
        let mut scene = self.observer.apply(scene)?;
        if let Some(normals) = self.normals {
            let is_file = |object: &Object| matches!(object.source, Source::File(_));
            ensure!(
                scene.objects().iter().any(is_file),
                "--normals is for meshes from files, and no object of the scene comes from a file"
            );
            scene = scene.with_normals(normals);
        }
        let directory = path.and_then(Path::parent).unwrap_or(Path::new(""));
        let place = path.map_or(name.to_string(), |path| path.display().to_string());
        let sources = scene.objects().iter();
        let sources: Vec<_> = sources.map(|o| (&o.name, &o.source, &o.normals)).collect();
        let key = format!("{directory:?} {:?} {sources:?}", self.access);
        let (models, found, is_known) = self.loaded.models(key, || {
            let read = self.access.load_models(&scene, directory);
            read.with_context(|| place.clone())
        })?;
        let scene = self.observer.stepped(scene, &models)?;
        let named = path.into_iter().chain(self.observer.file());
        let mut files: Vec<PathBuf> = named.map(Path::to_owned).collect();
        for (file, findings) in found {
            for note in findings.lines().into_iter().filter(|_| !is_known) {
                self.verbosity
                    .note(format_args!("{}: {note}", file.display()));
            }
            files.extend(findings.files);
        }
        Ok(Input {
            name: name.to_owned(),
            place,
            is_mesh: false,
            files,
            models,
            scene,
            textures: self.loaded.textures(self.access.max_texture_pixels),
        })
    }

    /// A bare mesh, at rest at the origin; the observer, unless placed, flies by.
    fn mesh(
        &self,
        name: &str,
        read: impl FnOnce() -> anyhow::Result<(Model, Findings)>,
        path: Option<&Path>,
    ) -> anyhow::Result<Input> {
        let place = path.map_or("stdin".into(), |path| path.display().to_string());
        let key = format!("{path:?} {:?} {:?}", self.access, self.normals);
        let (models, mut found, is_known) = self.loaded.models(key, || {
            let read = with_normals(read()?, self.normals.unwrap_or_default());
            let (model, findings) = read.with_context(|| place.clone())?;
            Ok((vec![model], vec![(PathBuf::from(&place), findings)]))
        })?;
        let findings = found
            .pop()
            .map(|(_, findings)| findings)
            .unwrap_or_default();
        for note in findings.lines().into_iter().filter(|_| !is_known) {
            self.verbosity.note(format_args!("{place}: {note}"));
        }
        let source = Source::File(path.unwrap_or(Path::new("-")).to_owned());
        let observer = match self.observer.has_place() {
            true => Observer::default(),
            false => passing_observer(),
        };
        let scene = Scene::new(observer, vec![Object::new(name, source)])?;
        let mut scene = self.observer.apply(scene)?;
        if !self.observer.has_place() {
            scene = fly_by(scene, &models[0])?;
        }
        let scene = self.observer.stepped(scene, &models)?;
        let mut files = findings.files;
        files.extend(self.observer.file().map(Path::to_owned));
        Ok(Input {
            name: name.to_owned(),
            place,
            is_mesh: true,
            scene,
            models,
            files,
            textures: self.loaded.textures(self.access.max_texture_pixels),
        })
    }
}

/// Tells of the textures that pictures went without, and in which file they are.
pub(super) fn tell_of_missing(textures: &Textures, scene: &Scene, verbosity: Verbosity) {
    for missing in textures.missing() {
        let object = scene.objects().iter().find(|o| o.name == missing.object);
        let file = match object.map(|object| &object.source) {
            Some(Source::File(file)) if file == Path::new("-") => "stdin: ".to_owned(),
            Some(Source::File(file)) => format!("{}: ", file.display()),
            _ => String::new(),
        };
        let reason = &missing.source;
        let cause = std::error::Error::source(reason);
        let cause = cause.map_or(String::new(), |cause| format!(": {cause}"));
        verbosity.note(format_args!("{file}{missing}: {reason}{cause}"));
    }
}

/// Tells of the objects that the observer is inside of, which are seen from within.
pub(super) fn tell_of_inside(placed: &PlacedScene, verbosity: Verbosity) {
    for Around { object, step } in placed.around_observer() {
        let proper_time = placed.scene().steps()[step];
        verbosity.note(format_args!(
            "the observer is inside of \"{object}\" at step {step} (proper time {proper_time}), and sees it from within"
        ));
    }
}

/// Tells of the objects whose surfaces rays cannot show, as the observer's place has too few digits.
pub(super) fn tell_of_blurred(placed: &PlacedScene, verbosity: Verbosity) {
    for Blurred {
        object,
        step,
        error,
    } in placed.blurred()
    {
        verbosity.note(format_args!(
            "at step {step} the observer's place relative to \"{object}\" has an error of about {error:.0e} of its size, since the \
             way there takes all digits of a number: its outline is right, its pattern is not; choose a lower speed or earlier steps"
        ));
    }
}

/// What to do about an input that is no ordinary file.
fn not_a_file(found: &str) -> String {
    match found {
        "a folder" => "is a folder, expected a file".to_owned(),
        _ => format!("is {found}, expected an ordinary file; write - and send it to stdin"),
    }
}

/// All of stdin, if it is no more than a scene or a mesh can be.
fn from_stdin() -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut stdin = std::io::stdin().lock();
    let mut read_to = |limit: u64, bytes: &mut Vec<u8>| -> anyhow::Result<bool> {
        let more = (limit + 1).saturating_sub(bytes.len() as u64);
        stdin
            .by_ref()
            .take(more)
            .read_to_end(bytes)
            .context("stdin")?;
        Ok(bytes.len() as u64 > limit)
    };
    let mut limit = MAX_SCENE_BYTES;
    let mut is_more = read_to(limit, &mut bytes)?;
    if is_more && !text_of(&bytes).starts_with(b"{") {
        limit = MAX_MESH_BYTES;
        is_more = read_to(limit, &mut bytes)?;
    }
    ensure!(
        !is_more,
        "stdin: too long, expected at most {MAX_SCENE_BYTES} bytes of a scene (JSON), or {MAX_MESH_BYTES} of a mesh"
    );
    Ok(bytes)
}

/// Bytes without what may be before the first letter of a text.
fn text_of(bytes: &[u8]) -> &[u8] {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    text.trim_ascii_start()
}

/// Stdin has no name that says what it holds.
fn scene_from_stdin(bytes: &[u8]) -> anyhow::Result<Scene> {
    const EXPECTED: &str = "stdin must be a scene (JSON), or a GLB, PLY, STL or OFF";
    let text = text_of(bytes);
    ensure!(
        !text.is_empty(),
        "stdin is empty, expected a scene (JSON), or a GLB, PLY, STL or OFF"
    );
    ensure!(
        text.starts_with(b"{") || text.starts_with(b"["),
        "{EXPECTED}, this is neither; to read an .obj or a .gltf, give its file name instead of -"
    );
    let json = serde_json::from_slice::<serde_json::Value>(text);
    let is_gltf = json.is_ok_and(|json| json.get("asset").is_some());
    ensure!(
        !is_gltf,
        "{EXPECTED}, this is a .gltf, which refers to other files: give its file name instead of -"
    );
    scene_from_bytes(bytes).context("stdin")
}
