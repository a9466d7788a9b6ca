//! Which format a file has, by its name or else by its content.

use super::ReadError;
use super::bytes::Bytes;
use super::gltf::is_glb;
use super::off::is_off;
use super::ply::is_ply;
use super::stl::is_stl;

/// A format that models are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// glTF or GLB.
    Gltf,
    Obj,
    Ply,
    Stl,
    Off,
}

/// The extensions of files that hold a model, in words, and what becomes of other files.
pub const EXPECTED_MODEL: &str =
    ".glb, .gltf, .obj, .ply, .stl or .off; Blender or MeshLab convert other formats";

/// Bytes at the start of a file that tell what it is, except of a binary STL file, which its length tells.
const TELLING: usize = 512;

impl Kind {
    /// The format of an extension in lower case.
    pub(super) fn of_extension(extension: &str) -> Option<Self> {
        match extension {
            "glb" | "gltf" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" => Some(Self::Off),
            _ => None,
        }
    }

    /// The format that the content of a file tells; an OBJ file and the JSON of glTF do not tell.
    pub(super) fn of_content(bytes: &Bytes) -> Result<Option<Self>, ReadError> {
        if is_glb(bytes)? {
            return Ok(Some(Self::Gltf));
        }
        let mut buffer = vec![];
        let start = bytes.part(0..bytes.len().min(TELLING), &mut buffer)?;
        Ok(match start {
            _ if is_ply(start) => Some(Self::Ply),
            _ if is_stl(start, bytes.len()) => Some(Self::Stl),
            _ if is_off(start) => Some(Self::Off),
            _ => None,
        })
    }
}

/// Whether files with this extension, in lower case and without a dot, hold a model.
pub fn is_model_extension(extension: &str) -> bool {
    Kind::of_extension(extension).is_some()
}

/// Whether these bytes are a GLB, PLY, STL or OFF file, which are complete without a name and without other files.
pub fn is_model_of_one_file(bytes: &[u8]) -> bool {
    matches!(Kind::of_content(&Bytes::Held(bytes.into())), Ok(Some(_)))
}
