//! Files in and out: the one room of the library that touches them.

mod load;
mod read;
mod write;

pub use load::{FileFindings, LoadError, load_models};
pub use read::{
    Access, AccessorProblem, DocumentProblem, Findings, NodeProblem, Note, ObjProblem, ReadError,
    UriProblem, read_gltf_bytes, read_model, read_whole,
};
pub use write::{
    Export, Format, GltfFile, GltfOutput, Playback, Report, StageTime, Target, WriteError,
    abandon_writes, destination, replaced_data, write_glb, write_gltf, write_ply, write_whole,
    write_whole_gltf, write_whole_target,
};
