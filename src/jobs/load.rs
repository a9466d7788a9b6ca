//! The geometry of a scene's objects: this file reads model files and makes shapes.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use thiserror::Error;

use crate::material::{Material, Model, Part};
use crate::mesh::Mesh;
use crate::read::{Access, Findings, ReadError, read_named_model, with_normals};
use crate::scene::{Scene, Source};
use crate::shape::{Appearance, Shape, ShapeError};

/// Reasons why an object has no geometry.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file of the object cannot be read.
    #[error("object \"{object}\"{}", in_file(path, source))]
    File {
        /// The name of the object.
        object: String,
        /// The file.
        path: PathBuf,
        /// The error.
        source: Box<ReadError>,
    },
    /// The shape of the object cannot be made.
    #[error("object \"{object}\"")]
    Shape {
        /// The name of the object.
        object: String,
        /// The error.
        source: ShapeError,
    },
}

/// The name of the file for an error message, unless the error already contains it.
fn in_file(path: &Path, source: &ReadError) -> String {
    match source.file() {
        Some(named) if named == path => String::new(),
        _ => format!(": {}", path.display()),
    }
}

/// The path of a file, with all links in the path of its folder resolved.
fn place_of(path: &Path) -> PathBuf {
    let folder = path
        .parent()
        .and_then(|folder| fs::canonicalize(folder).ok());
    match (folder, path.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

/// The findings about each of the files that objects name.
pub type FileFindings = Vec<(PathBuf, Findings)>;

/// One model for each object of a scene, in the order of the objects, and the findings about the files. File names are
/// relative to `directory`, and a file is read only if [`Access::default`] allows it. A file that several objects use
/// is read once, and a shape that several objects have is made once. A box, grid or lattice without a resolution has its
/// coarsest form.
///
/// # Errors
///
/// An error names the first file that cannot be read or the first shape that cannot be made.
pub fn load_models(
    scene: &Scene,
    directory: &Path,
) -> Result<(Vec<Model>, FileFindings), LoadError> {
    Access::default().load_models(scene, directory)
}

impl Access {
    /// The same as [`load_models`], with this access; `directory` is the folder of the scene.
    ///
    /// # Errors
    ///
    /// The errors of [`load_models`], and the error of a file that may not be read.
    pub fn load_models(
        &self,
        scene: &Scene,
        directory: &Path,
    ) -> Result<(Vec<Model>, FileFindings), LoadError> {
        let reach = self.reach(directory);
        // Models by folder and file name; links to the folder are resolved.
        let mut known: HashMap<PathBuf, Model> = HashMap::new();
        // The same with normals: objects that ask for the same share them.
        let mut shaded: HashMap<(PathBuf, String), Model> = HashMap::new();
        let mut shapes = Shapes::default();
        let mut files = Vec::new();
        let mut models = Vec::with_capacity(scene.objects().len());
        for object in scene.objects() {
            let model = match &object.source {
                Source::File(file) => {
                    let path = directory.join(file);
                    let wrong = |source| LoadError::File {
                        object: object.name.clone(),
                        path: path.clone(),
                        source: Box::new(source),
                    };
                    let place = place_of(&path);
                    if !known.contains_key(&place) {
                        let (model, found) = read_named_model(&path, &reach).map_err(wrong)?;
                        files.push((path.clone(), found));
                        known.insert(place.clone(), model);
                    }
                    let normals = object.normals.unwrap_or_default();
                    let key = (place.clone(), normals.to_string());
                    if !shaded.contains_key(&key) {
                        let read = (known[&place].clone(), Findings::default());
                        let (model, found) = with_normals(read, normals).map_err(wrong)?;
                        let of_file = files.iter_mut().find(|(file, _)| place_of(file) == place);
                        if let Some((_, findings)) = of_file {
                            findings.notes.extend(found.notes);
                        }
                        // Once for all who share the model: a clone knows what its original knows.
                        model.bounds();
                        shaded.insert(key.clone(), model);
                    }
                    shaded[&key].clone()
                }
                Source::Shape(shape, appearance) => {
                    shapes
                        .model(shape, appearance)
                        .map_err(|source| LoadError::Shape {
                            object: object.name.clone(),
                            source,
                        })?
                }
                Source::Model(model) => Model::clone(model),
            };
            models.push(model);
        }
        Ok((models, files))
    }
}

/// The models of shapes, each made once.
#[derive(Default)]
struct Shapes {
    /// Meshes by the shape in JSON.
    meshes: HashMap<String, Mesh>,
    /// Materials by what determines them, in JSON.
    materials: HashMap<String, Arc<Material>>,
}

impl Shapes {
    /// The model of a shape. A flat shape whose facets only the tolerance determines has its coarsest form.
    fn model(&mut self, shape: &Shape, appearance: &Appearance) -> Result<Model, ShapeError> {
        // Without refinement the shape gets its default resolution after all.
        shape.check_flat_size()?;
        let coarsest = shape.coarsest_flat();
        let shape = coarsest.as_ref().unwrap_or(shape);
        let key = json(shape);
        let mesh = match self.meshes.get(&key) {
            Some(mesh) => mesh.clone(),
            None => {
                let mesh = shape.mesh()?;
                self.meshes.insert(key, mesh.clone());
                mesh
            }
        };
        let key = json(&(appearance, shape.checker_cells()));
        let material = self.materials.entry(key);
        let material = material.or_insert_with(|| Arc::new(shape.material(appearance)));
        Ok(Model {
            parts: vec![Part::new("", mesh, Some(material.clone()))?],
            origin: None,
        })
    }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("shapes and colours are names and numbers")
}
