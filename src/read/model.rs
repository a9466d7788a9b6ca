//! The model in a file of any of the formats.

use std::path::Path;

use super::bytes::Bytes;
use super::gltf::{is_glb, read_gltf};
use super::notes::unique;
use super::obj::read_obj_bytes;
use super::uri::Folder;
use super::{Access, Findings, Reach, ReadError};
use crate::material::Model;

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
pub(crate) fn read_named_model(path: &Path, reach: &Reach) -> Result<(Model, Findings), ReadError> {
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
