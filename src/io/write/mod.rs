//! Photosurfaces as files: glTF, GLB, PLY, and the JSON report.

mod error;
mod file;
mod gltf;
mod materials;
mod pack;
mod ply;
mod report;
mod size;

pub use error::WriteError;
pub use file::{abandon_writes, destination, write_whole};
pub use gltf::{write_glb, write_gltf};
pub use ply::write_ply;
pub use report::{Report, StageTime};
pub use size::Format;

use crate::mesh::Part;
use crate::photosurface::{Photosurface, SceneFacts};

/// What goes into one file.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    /// The scene, in words and numbers.
    pub scene: &'a SceneFacts,
    /// The observer's marker, at rest in the observer's frame.
    pub marker: Option<&'a Part>,
    /// One object of the file each.
    pub photosurfaces: &'a [Photosurface],
}
