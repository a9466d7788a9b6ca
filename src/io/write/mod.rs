//! Photosurfaces as files: glTF, GLB, PLY, and the JSON report.

mod animation;
mod convert;
mod document;
mod error;
mod file;
mod glb;
mod gltf;
mod layer;
mod materials;
mod output;
mod pack;
mod pair;
mod ply;
mod range;
mod report;
mod size;
mod text;

pub use error::WriteError;
pub use file::{Target, abandon_writes, destination, write_whole, write_whole_target};
pub use gltf::{GltfFile, write_glb, write_gltf};
pub use output::GltfOutput;
pub use pair::{replaced_data, write_whole_gltf};
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
    /// One object of the file each, or one for each part where they are morph targets: all with the same of what
    /// may be asked for of vertices.
    pub photosurfaces: &'a [Photosurface],
    /// How steps follow each other, where the format has time; `None` for all at once.
    pub playback: Option<Playback>,
}

/// How the steps of a scene are shown one after another, in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Playback {
    /// Each photosurface is a node, which is there during its frame: its scale is 1, and 0 else.
    Frames {
        /// Steps in a second, > 0.
        frames_per_second: f64,
    },
    /// Each part is one node whose mesh has a morph target for every step after the first. All steps must have the
    /// same triangles, part by part, as [`Stage::morphing`](crate::Stage::morphing) makes them.
    Morph {
        /// Steps in a second, > 0.
        frames_per_second: f64,
    },
}

impl Playback {
    /// Steps in a second.
    pub fn frames_per_second(self) -> f64 {
        match self {
            Self::Frames { frames_per_second } | Self::Morph { frames_per_second } => {
                frames_per_second
            }
        }
    }
}
