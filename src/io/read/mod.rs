//! Models in: glTF, GLB and OBJ files as parts with attributes and materials.
//!
//! What is read is read as the format defines it; what cannot be is an error that says where; what is left
//! out is a note.

mod access;
mod accessor;
mod bytes;
mod deform;
mod document;
mod error;
mod extensions;
mod extras;
mod find;
mod gltf_model;
mod instances;
mod materials;
mod mend;
mod mtl;
mod mtl_map;
mod mtl_pack;
mod names;
mod nodes;
mod normals;
mod note;
mod obj;
mod obj_lines;
mod obj_plain;
mod picture;
mod polygon;
mod primitive;
mod quota;
mod run;
mod text;
mod uri;

use std::path::{Path, PathBuf};

pub(super) use access::Reach;
pub use access::{Access, read_whole};
pub use error::{AccessorProblem, DocumentProblem, NodeProblem, ObjProblem, ReadError, UriProblem};
pub use note::Note;

use glam::DVec3;

use crate::mesh::Model;
use bytes::Bytes;
use document::is_glb;
use gltf_model::read_gltf;
use note::unique;
use obj::read_obj_bytes;
use uri::Folder;

/// What there is to know about a model beside the model.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Findings {
    /// What was left out, replaced or chosen.
    pub notes: Vec<Note>,
    /// Every file that belongs to it: the file itself, its buffers, images and material libraries. One file
    /// may be named several times, and an image that is not there.
    pub files: Vec<PathBuf>,
}

impl Findings {
    /// The notes as lines of text, in their order. What is said of several meshes, nodes, materials or images alike is
    /// said once, with how many there are.
    pub fn lines(&self) -> Vec<String> {
        note::lines(&self.notes)
    }
}

/// The largest coordinate of a source: its square times the exponential of any rapidity is within `f64`.
const FARTHEST: f64 = 1e75;

/// The model, if nothing in it is so far away that computing with it would overflow.
fn checked(model: Model) -> Result<Model, ReadError> {
    let largest = |position: &DVec3| position.abs().max_element();
    for part in &model.parts {
        // Its bounds are wanted sooner or later, and one look at all vertices is enough.
        let (low, high) = part.mesh().bounds().unwrap_or_default();
        if largest(&low) <= FARTHEST && largest(&high) <= FARTHEST {
            continue;
        }
        let positions = part.mesh().positions();
        if let Some(vertex) = positions.iter().position(|p| largest(p) > FARTHEST) {
            return Err(ReadError::TooFar {
                part: part.name.clone(),
                vertex,
                coordinate: largest(&positions[vertex]),
                limit: FARTHEST,
            });
        }
    }
    Ok(model)
}

/// Reads the model in a GLB, glTF or OBJ file, and says what of it was left out and which files were read.
///
/// glTF 2.0: all triangles of the default scene, with the transforms of their nodes, in the default pose of
/// skins and morph targets. OBJ: all faces. Either with normals, texture coordinates, colours and
/// materials; those of glTF with everything that they say. Of the files that it names, those are read that
/// [`Access::default`] allows.
///
/// # Errors
///
/// A file that cannot be read, that is not as its format defines it, that needs an extension which is
/// not known, or that has no triangles.
pub fn read_model(path: &Path) -> Result<(Model, Findings), ReadError> {
    Access::default().read_model(path)
}

/// Reads the bytes of a GLB or glTF file.
///
/// Files that it refers to are looked for in `folder`. [`read_model`] says what is read of it.
///
/// # Errors
///
/// Anything that keeps a part of the surface from being read as glTF 2.0 defines it.
pub fn read_gltf_bytes(bytes: &[u8], folder: &Path) -> Result<(Model, Findings), ReadError> {
    Access::default().read_gltf_bytes(bytes, folder)
}

impl Access {
    /// As [`read_model`]; `path` itself may be anywhere.
    ///
    /// # Errors
    ///
    /// As [`read_model`], and a buffer that may not be read. Libraries and images that may not be read are left out with
    /// a note.
    pub fn read_model(&self, path: &Path) -> Result<(Model, Findings), ReadError> {
        let reach = self.reach(path.parent().unwrap_or(Path::new("")));
        read_bytes(Bytes::open(path, u64::MAX)?, path, reach)
    }

    /// As [`read_gltf_bytes`].
    ///
    /// # Errors
    ///
    /// As [`read_gltf_bytes`], and a buffer that may not be read.
    pub fn read_gltf_bytes(
        &self,
        bytes: &[u8],
        folder: &Path,
    ) -> Result<(Model, Findings), ReadError> {
        let bytes = Bytes::Held(bytes.into());
        read_gltf(bytes, Folder::within(folder, self.reach(folder)))
    }
}

/// Reads the model in a file that another one names.
pub(super) fn read_named_model(path: &Path, reach: &Reach) -> Result<(Model, Findings), ReadError> {
    let bytes = Bytes::open_in(reach, path, u64::MAX)?;
    read_bytes(bytes, path, reach.clone())
}

fn read_bytes(bytes: Bytes, path: &Path, reach: Reach) -> Result<(Model, Findings), ReadError> {
    let extension = path.extension().unwrap_or_default();
    let extension = extension.to_string_lossy().to_lowercase();
    let folder = Folder::within(path.parent().unwrap_or(Path::new("")), reach);
    let is_gltf = match extension.as_str() {
        "glb" | "gltf" => true,
        "obj" => false,
        _ if is_glb(&bytes)? => true,
        _ => return Err(ReadError::UnknownExtension { extension }),
    };
    let (model, mut findings) = if is_gltf {
        read_gltf(bytes, folder)?
    } else {
        let stem = path.file_stem().unwrap_or_default();
        read_obj_bytes(&bytes.into_vec()?, folder, &stem.to_string_lossy())?
    };
    findings.files.insert(0, path.to_owned());
    findings.notes = unique(findings.notes);
    Ok((model, findings))
}
