//! From a file to a placed scene: a scene with its models, or a mesh by itself.

use std::path::{Path, PathBuf};

use glam::DVec3;
use thiserror::Error;

use super::{FileFindings, LoadError};
use crate::material::Model;
use crate::pipeline::{PlacedScene, PlacedSceneError};
use crate::read::{Access, ReadError, read_whole};
use crate::scene::{InvalidScene, Object, Observer, Place, PlaceError, Scene, SceneError, Source};

/// How many bytes the text of a scene has at most: some hundred thousand objects.
pub const MAX_SCENE_BYTES: u64 = 100_000_000;

/// Beyond the centre of a mesh by itself, by how many diagonals of its bounds the observer stands off.
const STAND_OFF: f64 = 2.0;

/// Why bytes are not the text of a scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneTextError {
    /// A byte that UTF-8 does not have in this place.
    #[error("not text in UTF-8: byte {offset}, counted from 0, is {byte:#04x}")]
    NotText {
        /// Which byte, from 0.
        offset: usize,
        /// Its value.
        byte: u8,
    },
    /// Text that is no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Why a file makes no placed scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InputError {
    /// A name that says neither a scene nor a mesh.
    #[error("{}: unknown extension, expected a scene (.json) or a mesh (.glb, .gltf, .obj)", .0.display())]
    UnknownExtension(PathBuf),
    /// The file cannot be read.
    #[error("{}", file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        source: ReadError,
    },
    /// The text of the file is no scene.
    #[error("{}", file.display())]
    Text {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        source: SceneTextError,
    },
    /// An object of the scene has no geometry.
    #[error("{}", file.display())]
    Load {
        /// Which scene.
        file: PathBuf,
        /// Which object, and why.
        source: LoadError,
    },
    /// A mesh that makes no scene by itself.
    #[error(transparent)]
    Scene(#[from] InvalidScene),
    /// A mesh so large that no observer can stand off from it.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// Geometry that cannot be placed.
    #[error(transparent)]
    Placed(#[from] PlacedSceneError),
}

impl PlacedScene {
    /// Reads a scene (.json) with the models of its objects, or a mesh by itself (.glb, .gltf, .obj), and says what there
    /// is to know about each file. Of the files that others name, those are read that [`Access::default`] allows.
    ///
    /// A mesh by itself is at rest at the origin, and the observer two diagonals of its bounds before its centre, at rest,
    /// looking along -z: [`Scene::with_observer`] and [`PlacedScene::new`] say otherwise.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or is not as its format defines it, or geometry that cannot be placed.
    pub fn load(path: &Path) -> Result<(Self, FileFindings), InputError> {
        Access::default().load(path)
    }
}

impl Access {
    /// As [`PlacedScene::load`].
    ///
    /// # Errors
    ///
    /// As [`PlacedScene::load`], and a file that may not be read.
    pub fn load(&self, path: &Path) -> Result<(PlacedScene, FileFindings), InputError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let wrong = |source| InputError::Read {
            file: path.to_owned(),
            source,
        };
        if extension == "json" {
            let bytes = read_whole(path, MAX_SCENE_BYTES).map_err(wrong)?;
            let scene = scene_from_bytes(&bytes).map_err(|source| InputError::Text {
                file: path.to_owned(),
                source,
            })?;
            let folder = path.parent().unwrap_or(Path::new(""));
            let models = self.load_models(&scene, folder);
            let (models, findings) = models.map_err(|source| InputError::Load {
                file: path.to_owned(),
                source,
            })?;
            return Ok((PlacedScene::new(scene, models)?, findings));
        }
        if !["glb", "gltf", "obj"]
            .iter()
            .any(|known| extension == *known)
        {
            return Err(InputError::UnknownExtension(path.to_owned()));
        }
        let (model, findings) = self.read_model(path).map_err(wrong)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let object = Object::new(name, Source::File(path.to_owned()));
        let scene = Scene::new(Observer::default(), vec![object])?;
        let scene = stand_off(scene, &model)?;
        let placed = PlacedScene::new(scene, vec![model])?;
        Ok((placed, vec![(path.to_owned(), findings)]))
    }
}

/// The scene in these bytes, which are JSON in UTF-8.
///
/// # Errors
///
/// Bytes that are not text, or text that is no scene.
pub fn scene_from_bytes(bytes: &[u8]) -> Result<Scene, SceneTextError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        SceneTextError::NotText {
            offset,
            byte: bytes[offset],
        }
    })?;
    Ok(Scene::from_json(text)?)
}

/// The scene with its observer two diagonals of a model's bounds before the centre of the model, which stands at the
/// origin, so that the observer moves towards it.
///
/// # Errors
///
/// A place that is beyond the range of places.
pub fn stand_off(scene: Scene, model: &Model) -> Result<Scene, PlaceError> {
    let observer = *scene.observer();
    let position = match model.bounds() {
        None => DVec3::ZERO,
        Some((low, high)) => {
            let away = STAND_OFF * (high - low).length();
            0.5 * (low + high) - observer.velocity.direction() * away
        }
    };
    Ok(scene.with_observer(Observer {
        position: Place::new(position)?,
        ..observer
    }))
}
