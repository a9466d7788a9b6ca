//! Photosurfaces as files: glTF, GLB, PLY, and the JSON report; pictures as films.

mod camera;
mod child;
mod error;
mod export;
mod file;
mod film;
mod format;
mod gltf;
mod growing;
mod helper;
mod layer;
mod pack;
mod page;
mod ply;
mod range;
mod report;
mod seal;
mod size;
mod text;

pub use camera::ObserverCamera;
pub use error::WriteError;
pub(crate) use export::FRAMES_PER_SECOND;
pub use export::{Export, Playback};
pub(crate) use file::ScratchFolder;
pub use file::{
    Target, abandon_writes, destination, write_whole, write_whole_target, writes_are_abandoned,
};
pub use film::{
    FilmError, FilmFormat, FilmFormatError, FilmSettings, FilmWriter, FrameRate, FrameRateError,
};
pub use format::Format;
pub(crate) use gltf::write_sealed_gltf;
pub use gltf::{GltfFile, GltfOutput, replaced_data, write_glb, write_gltf, write_whole_gltf};
pub use page::{PageContent, write_page};
pub use ply::write_ply;
pub(crate) use ply::write_sealed_ply;
pub(crate) use report::schema_of;
pub use report::{OutputFile, Provenance, Report, StageTime};
pub use seal::{Fingerprint, Seal};
