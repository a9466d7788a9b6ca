//! Models in: glTF, GLB and OBJ files as parts with attributes and materials.
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
mod model;
mod names;
mod normals;
mod note;
mod notes;
mod obj;
mod picture;
mod quota;
mod run;
mod text;
mod uri;

pub(crate) use access::Reach;
pub use access::{Access, read_whole};
pub use error::{AccessorProblem, DocumentProblem, NodeProblem, ObjProblem, ReadError, UriProblem};
pub use findings::Findings;
pub(crate) use model::read_named_model;
pub use model::{read_gltf_bytes, read_model};
pub use note::Note;
