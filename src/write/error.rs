//! Why photosurfaces do not make a file.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::pipeline::PlacedSceneError;

/// Why photosurfaces do not make a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// A mesh without vertices or triangles.
    #[error("the photosurface \"{0}\" has no triangles, expected at least one")]
    Empty(String),
    /// A number beyond the range of the file's `f32`.
    #[error(
        "{quantity} of vertex {vertex} of the photosurface \"{name}\" is {value:e}, beyond what 32-bit \
         numbers of a file hold ({limit:e}); choose a smaller rapidity or, for lengths and times, a larger unit"
    )]
    Range {
        /// Which photosurface.
        name: String,
        /// Which number.
        quantity: &'static str,
        /// Which vertex, from 0.
        vertex: usize,
        /// The number.
        value: f64,
        /// The limit that it is beyond.
        limit: f64,
    },
    /// A number that would be beyond it at any speed.
    #[error(
        "{quantity} of vertex {vertex} of the photosurface \"{name}\" is {value:e}, beyond what 32-bit numbers of a \
         file hold ({limit:e}): it is too far away; choose a smaller distance or a larger unit"
    )]
    TooFar {
        /// Which photosurface.
        name: String,
        /// Which number.
        quantity: &'static str,
        /// Which vertex, from 0.
        vertex: usize,
        /// The number.
        value: f64,
        /// The limit that it is beyond.
        limit: f64,
    },
    /// A vertex that is not a number: the scene is too large, or too fast, to compute with.
    #[error(
        "vertex {vertex} of the photosurface \"{name}\" overflows 64-bit numbers: lengths, times \
         or the rapidity are too large"
    )]
    Overflow {
        /// Which photosurface.
        name: String,
        /// Which vertex, from 0.
        vertex: usize,
    },
    /// An extent that vanishes in the file's `f32`.
    #[error(
        "the photosurface \"{name}\" is only {extent:e} across, too small for the 32-bit numbers of a file \
         ({limit:e}); scale the scene up, so that it has larger numbers"
    )]
    TooSmall {
        /// Which photosurface.
        name: String,
        /// Its largest extent along an axis.
        extent: f64,
        /// The least that can be written.
        limit: f64,
    },
    /// Numbers at vertices that are not one for each.
    #[error(
        "the photosurface \"{name}\" has {found} numbers \"{attribute}\", expected one for each of {vertices} vertices"
    )]
    Attribute {
        /// Which photosurface.
        name: String,
        /// Which numbers, as a file calls them.
        attribute: &'static str,
        /// How many there are.
        found: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Steps that cannot be morph targets of one mesh.
    #[error(
        "step {step} of \"{name}\" has other triangles or vectors than the first one, expected the same at all steps, as \
         `PlacedScene::morphing` makes them"
    )]
    Morph {
        /// Which part.
        name: String,
        /// Which step, from 0.
        step: usize,
    },
    /// A frame rate that no animation has.
    #[error("{0} frames per second, expected a number from 0.001 to 1000")]
    FramesPerSecond(f64),
    /// More bytes than the format can say.
    #[error(
        "the file would have at least {bytes} bytes, {format} can have at most {limit}; write the steps to files \
         of their own, as --split does"
    )]
    TooLarge {
        /// Which format.
        format: &'static str,
        /// How many bytes it would have.
        bytes: u64,
        /// How many it can have.
        limit: u64,
    },
    /// More vertices in one file than a `u32` index can tell apart.
    #[error("the file would have {0} vertices, expected at most {max}; write the steps to files of their own, as --split does", max = u32::MAX)]
    TooManyVertices(usize),
    /// A `.gltf` whose name its data cannot be named after.
    #[error("{}: a .gltf refers to its .bin by name, which has to be UTF-8", .0.display())]
    NotText(PathBuf),
    /// The operating system says no.
    #[error("cannot write {}", path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// What it says.
        source: io::Error,
    },
    /// There are no photosurfaces.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
    /// Whoever asked for the file has ended the work, or all writing: see [`abandon_writes`](crate::write::abandon_writes).
    #[error("cancelled")]
    Cancelled,
    /// The operating system says no to a stream.
    #[error("cannot write")]
    Stream(#[from] io::Error),
}
