//! glTF 2.0, as GLB and in two files.

mod animation;
mod camera;
mod convert;
mod document;
mod file;
mod glb;
mod materials;
mod output;
mod pair;
mod step_nodes;
mod tracks;

pub use file::{GltfFile, write_glb, write_gltf};
pub use output::GltfOutput;
pub(crate) use pair::write_sealed_gltf;
pub use pair::{replaced_data, write_whole_gltf};
