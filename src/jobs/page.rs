//! The interactive page of a scene: what the viewer is told of it, and its meshes at rest.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

use super::page_data::PageData;
use super::{ExportError, ExportSettings, Progress, RenderError, export_levels};
use crate::effects::{Doppler, ShaderTable};
use crate::material::{Model, Part};
use crate::pipeline::{PlacedScene, PlacedSceneError};
use crate::render::Textures;
use crate::scene::{
    Attributes, Effects, InvalidScene, Object, Observer, Place, Rotation, Scale, Scene, Source,
};
use crate::shape::{Shape, ShapeError};
use crate::spacetime::{Velocity, ViewModel};
use crate::write::{Format, PageContent, WriteError, write_page, write_whole};

/// Segments around a full turn of round shapes: the viewer draws what lies between them on the true surface.
const SEGMENTS: u32 = 32;
const SEGMENTS_OF_SPHERE: u32 = 24;
const SEGMENTS_OF_TUBE: f64 = 8.0;

/// Settings of a page.
#[derive(Clone, Debug, Default)]
pub struct PageSettings {
    /// The words of the command line that name the scene, quoted for a shell, for the commands that the page offers to copy:
    /// `scene.json`, or `--example cube`.
    pub input: String,
    /// The textures of pictures, where the exposure is to be found by pictures.
    pub textures: Textures,
}

/// Reasons why there is no page.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PageError {
    /// The meshes cannot be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The objects cannot be placed at rest.
    #[error(transparent)]
    Placed(#[from] PlacedSceneError),
    /// The scene cannot be held at rest.
    #[error(transparent)]
    Scene(#[from] InvalidScene),
    /// A shape cannot be made.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The picture of the first moment cannot be framed.
    #[error(transparent)]
    Picture(#[from] RenderError),
    /// The page cannot be written.
    #[error("{}", .file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The error.
        source: WriteError,
    },
}

/// Makes the interactive page of a scene, which flies through it in a browser.
///
/// The page holds the meshes at rest, unrefined, in `f32`, and everything else in `f64`. It needs no other file and sends no
/// request.
///
/// # Errors
///
/// An error is returned if a mesh does not fit a GLB, or if `progress` cancels the work.
///
/// # Example
///
/// ```
/// use photosurface::jobs::{PageSettings, page};
/// use photosurface::{PlacedScene, Scene};
///
/// let scene = Scene::from_json(r#"{ "objects": [{ "name": "ball", "shape": { "sphere": { "radius": 1 } } }] }"#)?;
/// let (models, _) = photosurface::load_models(&scene, std::path::Path::new("."))?;
/// let placed = PlacedScene::new(scene, models)?;
/// let content = page(&placed, &PageSettings::default(), &())?;
/// assert!(content.meshes.starts_with(b"glTF"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn page(
    placed: &PlacedScene,
    settings: &PageSettings,
    progress: &dyn Progress,
) -> Result<PageContent, PageError> {
    let at_rest = at_rest(placed)?;
    let meshes = meshes(&at_rest, progress)?;
    let scene = placed.scene();
    let spectrum = match scene.effects().doppler {
        Doppler::Spectrum(spectrum) => spectrum,
        Doppler::None | Doppler::Ramp => Default::default(),
    };
    let table = ShaderTable::new(spectrum);
    let data = PageData::new(placed, &at_rest, &table, settings)?;
    Ok(PageContent {
        title: data.title().to_owned(),
        scene: data.to_json(),
        meshes,
        colors: table.rest,
    })
}

/// Makes a page and writes it to a file, which appears whole or not at all.
///
/// # Errors
///
/// As [`page`], and if the file cannot be written.
pub fn page_to_file(
    placed: &PlacedScene,
    settings: &PageSettings,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), PageError> {
    let content = page(placed, settings, progress)?;
    write_whole(path, |out| write_page(&content, out)).map_err(|source| PageError::File {
        file: path.to_owned(),
        source,
    })
}

/// The objects of a scene as they are in their rest frames, each beside where its origin is at scene time 0; nothing moves.
fn at_rest(placed: &PlacedScene) -> Result<PlacedScene, PageError> {
    let mut objects = Vec::new();
    let mut models = Vec::new();
    for (object, parts) in placed.objects() {
        let (still, model) = still(object, parts)?;
        objects.push(still);
        models.push(model);
    }
    let observer = Observer {
        time: Default::default(),
        position: Place::ORIGIN,
        velocity: Velocity::ZERO,
        orientation: Rotation::IDENTITY,
        flight: vec![],
        marker: None,
        ..placed.scene().observer().clone()
    };
    let scene = Scene::new(observer, objects)?
        .with_steps(vec![0.0])?
        .with_attributes(Attributes::default())
        .with_effects(Effects::default());
    Ok(PlacedScene::new(scene, models)?)
}

fn still(object: &Object, parts: &[(String, Part)]) -> Result<(Object, Model), PageError> {
    let still = Object {
        velocity: Velocity::ZERO,
        model: Some(ViewModel::Rest),
        emission: None,
        tolerance: None,
        ..object.clone()
    };
    if let Source::Shape(shape, appearance) = &object.source {
        let shape = coarse(shape)?;
        let model = shape.model(appearance)?;
        let source = Source::Shape(shape, *appearance);
        return Ok((Object { source, ..still }, model));
    }
    let parts = parts.iter().map(|(_, part)| part.clone()).collect();
    let model = Model {
        parts,
        origin: None,
    };
    let still = Object {
        source: Source::Model(Arc::new(model.clone())),
        // The parts have been turned and stretched already.
        rotation: Rotation::IDENTITY,
        scale: Scale::default(),
        ..still
    };
    Ok((still, model))
}

/// A shape of few triangles, unless the scene says how many: the viewer draws all of them finer where that shows.
fn coarse(shape: &Shape) -> Result<Shape, ShapeError> {
    if shape.resolution().is_some() {
        return Ok(shape.clone());
    }
    let segments = match shape {
        Shape::Cuboid(_) | Shape::Grid(_) | Shape::Lattice(_) => 1,
        Shape::Sphere(_) => SEGMENTS_OF_SPHERE,
        Shape::Cylinder(_) | Shape::Cone(_) | Shape::Rod(_) => SEGMENTS,
        Shape::Torus(torus) => {
            let ratio = torus.major_radius().get() / torus.minor_radius().get();
            // A float becomes the nearest integer that there is.
            ((SEGMENTS_OF_TUBE * ratio).round() as u32).clamp(SEGMENTS_OF_SPHERE, 1024)
        }
    };
    shape.clone().with_resolution(segments)
}

/// All meshes as they are, without a vertex more, as a GLB.
fn meshes(at_rest: &PlacedScene, progress: &dyn Progress) -> Result<Vec<u8>, PageError> {
    let settings = ExportSettings {
        subdivide: false,
        keep_facts: false,
        ..ExportSettings::default()
    };
    let name = Path::new("meshes.glb");
    let levels = export_levels(at_rest, &settings, Format::Glb, name)?;
    let mut meshes = Vec::new();
    for level in levels {
        level.check()?;
        progress.begin(level.pieces());
        let written = level.fit().write_to(&mut meshes, progress);
        written.map_err(|error| ExportError::of_file(name, error))?;
    }
    Ok(meshes)
}
