//! glTF 2.0 files, as GLB and as JSON with buffers beside it.

mod accessor;
mod deform;
mod document;
mod extensions;
mod extras;
mod instances;
mod material_lists;
mod materials;
mod mend;
mod model;
mod nodes;
mod primitive;

pub(super) use document::is_glb;
pub(super) use model::read_gltf;
