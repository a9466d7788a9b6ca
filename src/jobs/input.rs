//! From a file to a placed scene: the file holds a scene with its models, or a mesh by itself.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::passage::{fly_by, passing_observer};
use super::{FileFindings, LoadError};
use crate::material::Normals;
use crate::pipeline::{PlacedScene, PlacedSceneError};
use crate::read::{
    Access, EXPECTED_MODEL, ReadError, is_model_extension, read_whole, with_normals,
};
use crate::scene::{InvalidScene, Object, PlaceError, Scene, SceneError, Source};

/// Limit on the bytes of a scene's text, enough for some hundred thousand objects.
pub const MAX_SCENE_BYTES: u64 = 100_000_000;

/// Reasons why bytes are not the text of a scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneTextError {
    /// A byte is not valid UTF-8 at its position.
    #[error("not text in UTF-8: byte {offset}, counted from 0, is {byte:#04x}")]
    NotText {
        /// Position of the byte, counted from 0.
        offset: usize,
        /// Value of the byte.
        byte: u8,
    },
    /// The text is not a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Errors of reading a placed scene from a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InputError {
    /// The extension is neither that of a scene nor that of a mesh.
    #[error("{}: unknown extension, expected a scene (.json) or a mesh: {EXPECTED_MODEL}", .0.display())]
    UnknownExtension(PathBuf),
    /// The file cannot be read.
    #[error("{}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The error.
        source: ReadError,
    },
    /// The text of the file is not a scene.
    #[error("{}", file.display())]
    Text {
        /// The file.
        file: PathBuf,
        /// The error.
        source: SceneTextError,
    },
    /// An object of the scene has no geometry.
    #[error("{}", file.display())]
    Load {
        /// The file of the scene.
        file: PathBuf,
        /// The error of the object.
        source: LoadError,
    },
    /// A mesh by itself does not make a valid scene.
    #[error(transparent)]
    Scene(#[from] InvalidScene),
    /// A mesh is so large that the observer's position would be out of range.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// The geometry cannot be placed.
    #[error(transparent)]
    Placed(#[from] PlacedSceneError),
}

impl PlacedScene {
    /// Reads a scene (.json) with the models of its objects, or a mesh by itself (.glb, .gltf, .obj, .ply, .stl,
    /// .off); returns the findings about each file as well. A file that another file names is read only if
    /// [`Access::default`] allows it.
    ///
    /// A mesh by itself is at rest at the origin. The observer is at rest where [`fly_by`](super::fly_by) has it for motion
    /// along -x, before the front of the mesh; [`Scene::with_observer`] and [`PlacedScene::new`] make a scene with another observer.
    ///
    /// # Errors
    ///
    /// An error is returned if a file cannot be read or does not follow its format, or if geometry cannot be placed.
    pub fn load(path: &Path) -> Result<(Self, FileFindings), InputError> {
        Access::default().load(path)
    }
}

impl Access {
    /// The same as [`PlacedScene::load`], with this access.
    ///
    /// # Errors
    ///
    /// The errors of [`PlacedScene::load`], and the error of a file that may not be read.
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
        if !is_model_extension(&extension.to_string_lossy()) {
            return Err(InputError::UnknownExtension(path.to_owned()));
        }
        let read = self.read_model(path);
        let read = read.and_then(|read| with_normals(read, Normals::Source));
        let (model, findings) = read.map_err(wrong)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let object = Object::new(name, Source::File(path.to_owned()));
        let scene = Scene::new(passing_observer(), vec![object])?;
        let scene = fly_by(scene, &model)?;
        let placed = PlacedScene::new(scene, vec![model])?;
        Ok((placed, vec![(path.to_owned(), findings)]))
    }
}

/// The scene in these bytes, which are JSON in UTF-8.
///
/// # Errors
///
/// An error is returned if the bytes are not text or the text is not a scene.
pub fn scene_from_bytes(bytes: &[u8]) -> Result<Scene, SceneTextError> {
    Ok(Scene::from_json(text_of(bytes)?)?)
}

/// The text of these bytes.
///
/// # Errors
///
/// An error names the first byte that is not part of text in UTF-8.
pub fn text_of(bytes: &[u8]) -> Result<&str, SceneTextError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        SceneTextError::NotText {
            offset,
            byte: bytes[offset],
        }
    })
}
