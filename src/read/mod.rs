//! Models in: glTF, GLB, OBJ, PLY, STL and OFF files as parts with attributes and materials.
//!
//! What is read is read as the format defines it; what cannot be is an error that says where; what is left
//! out is a note.

mod access;
mod bytes;
mod error;
mod far;
mod find;
mod findings;
mod fitted;
mod gltf;
mod kind;
mod model;
mod names;
mod normals;
mod note;
mod notes;
mod obj;
mod off;
mod picture;
mod ply;
mod polygon;
mod quota;
mod run;
mod shaded;
mod stl;
mod surface;
mod text;
mod uri;
mod vertex;

pub(crate) use access::Reach;
pub use access::{Access, read_whole};
pub use error::{
    AccessorProblem, DataProblem, DocumentProblem, NodeProblem, ObjProblem, ReadError, UriProblem,
};
pub use findings::Findings;
pub use kind::{EXPECTED_MODEL, is_model_extension, is_model_of_one_file};
pub(crate) use model::read_named_model;
pub use model::{read_gltf_bytes, read_model, read_model_bytes};
pub use note::Note;
pub use shaded::with_normals;
