//! The model in a file of any of the formats.

use std::path::Path;

use super::bytes::Bytes;
use super::gltf::read_gltf;
use super::kind::Kind;
use super::notes::unique;
use super::obj::read_obj_bytes;
use super::off::read_off;
use super::ply::read_ply;
use super::stl::read_stl;
use super::uri::Folder;
use super::{Access, Findings, Reach, ReadError};
use crate::material::Model;

/// Reads the model in a GLB, glTF, OBJ, PLY, STL or OFF file, and says what of it was left out and which files were read.
///
/// glTF 2.0: all triangles of the default scene, with the transforms of their nodes, in the default pose of
/// skins and morph targets. OBJ: all faces. Either with normals, texture coordinates, colours and
/// materials; those of glTF with everything that they say. PLY, STL and OFF: all faces, with coordinates as they stand, for
/// these formats state neither axes nor units; PLY and OFF with normals, colours and texture coordinates of vertices, STL
/// with vertices of equal positions joined and without its normals, which the corners give. Of the files that it names, those are read that
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

/// Reads the bytes of a GLB, glTF, PLY, STL or OFF file, which the content tells apart.
///
/// As [`read_gltf_bytes`] otherwise; a part without a name is called `mesh`.
///
/// # Errors
///
/// As [`read_model`].
pub fn read_model_bytes(bytes: &[u8], folder: &Path) -> Result<(Model, Findings), ReadError> {
    Access::default().read_model_bytes(bytes, folder)
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

    /// As [`read_model_bytes`].
    ///
    /// # Errors
    ///
    /// As [`read_model_bytes`], and a buffer that may not be read.
    pub fn read_model_bytes(
        &self,
        bytes: &[u8],
        folder: &Path,
    ) -> Result<(Model, Findings), ReadError> {
        let bytes = Bytes::Held(bytes.into());
        let kind = Kind::of_content(&bytes)?.unwrap_or(Kind::Gltf);
        let folder = Folder::within(folder, self.reach(folder));
        read_kind(kind, bytes, folder, "mesh")
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
    let kind = match Kind::of_extension(&extension) {
        Some(kind) => kind,
        None => Kind::of_content(&bytes)?.ok_or(ReadError::UnknownExtension { extension })?,
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let (model, mut findings) = read_kind(kind, bytes, folder, &stem)?;
    findings.files.insert(0, path.to_owned());
    findings.notes = unique(findings.notes);
    Ok((model, findings))
}

/// Reads a file of this format; parts that have no name there get that of the file.
fn read_kind(
    kind: Kind,
    bytes: Bytes,
    folder: Folder,
    name: &str,
) -> Result<(Model, Findings), ReadError> {
    match kind {
        Kind::Gltf => read_gltf(bytes, folder),
        Kind::Obj => read_obj_bytes(&bytes.into_vec()?, folder, name),
        Kind::Ply => read_ply(&bytes.into_vec()?, name),
        Kind::Stl => read_stl(&bytes.into_vec()?, name),
        Kind::Off => read_off(&bytes.into_vec()?, name),
    }
}
