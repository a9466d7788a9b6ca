//! Files in.

mod read;

pub use read::{
    AccessorProblem, DocumentProblem, NodeProblem, Note, ObjProblem, ReadError, UriProblem,
    read_gltf_bytes, read_model,
};
