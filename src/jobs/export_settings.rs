//! What an export makes and how, and why it may have no result.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{DEFAULT_MAX_TRIANGLES, OutputError};
use crate::pipeline::PlacedScene;
use crate::scene::Tolerance;
use crate::write::{FRAMES_PER_SECOND, Format, Playback, StageTime, WriteError};

/// What an export makes of a placed scene.
#[derive(Clone, Debug)]
pub struct ExportSettings {
    /// Whether each step has a file of its own: `out_step000.glb`, `out_step001.glb`, ...
    pub split: bool,
    /// How the steps of one file follow each other; `None` for all at once.
    pub playback: Option<Playback>,
    /// Levels of detail: tolerances for all objects, each with files of its own, `out_lod0.glb`, `out_lod1.glb`, ...;
    /// none for the tolerances of the scene.
    pub levels: Vec<Tolerance>,
    /// Whether meshes are refined until they are within the tolerance; if not, every vertex of the source stays the only
    /// one, and certificates tell how far off the meshes are.
    pub subdivide: bool,
    /// How many triangles all photosurfaces of one level have together at most. If a tolerance needs more, the
    /// largest gaps are closed first and the result is not certified; triangles of a source stay, even if they are more.
    pub max_triangles: u64,
    /// Where a JSON [`Report`](crate::write::Report) goes, if there is to be one; each level has its own.
    pub report: Option<PathBuf>,
    /// Whether [`Exported`](super::Exported) has the facts of every photosurface: about a kilobyte of memory for each.
    pub keep_facts: bool,
    /// Stages that went before, with their times, for the report.
    pub stages_before: Vec<StageTime>,
}

impl Default for ExportSettings {
    /// All steps in one file, refined within the tolerances of the scene, by at most [`DEFAULT_MAX_TRIANGLES`].
    fn default() -> Self {
        Self {
            split: false,
            playback: None,
            levels: vec![],
            subdivide: true,
            max_triangles: DEFAULT_MAX_TRIANGLES,
            report: None,
            keep_facts: true,
            stages_before: vec![],
        }
    }
}

/// Why an export has no result.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The name of the file says no format.
    #[error("{}: unknown extension, expected .glb, .gltf or .ply", .0.display())]
    UnknownExtension(PathBuf),
    /// An animation in a format that has no time.
    #[error("a .ply has no time, expected .glb or .gltf for an animation")]
    NoTime,
    /// An animation of one step.
    #[error("the scene has one step, expected at least two for an animation")]
    OneStep,
    /// A number of frames a second that is out of range.
    #[error("{0:?} frames a second, expected a number from 0.001 to 1000")]
    FramesPerSecond(f64),
    /// Attributes, which differ from step to step, in one mesh for all steps.
    #[error(
        "an animation by morphing shows one mesh, and attributes differ from step to step; expected no attributes"
    )]
    MorphingAttributes,
    /// An animation and a file for each step.
    #[error("an animation is one file, expected it without a file for each step")]
    SplitPlayback,
    /// Two levels of detail of one tolerance.
    #[error("the tolerance {0} is given twice among the levels of detail, expected each one once")]
    RepeatedLevel(Tolerance),
    /// A file that must not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file that cannot hold the photosurfaces, or cannot be written.
    #[error("{}", file.display())]
    File {
        /// Which file.
        file: PathBuf,
        /// Why.
        source: WriteError,
    },
    /// The caller ended the export: whole files stay, nothing else does.
    #[error("cancelled")]
    Cancelled,
}

impl ExportError {
    /// The error of a file; errors that name a file do not name it twice.
    pub(crate) fn of_file(file: &Path, source: WriteError) -> Self {
        match source {
            WriteError::Cancelled => Self::Cancelled,
            WriteError::Io { .. } => Self::Output(source.into()),
            source => Self::File {
                file: file.to_owned(),
                source,
            },
        }
    }
}

impl ExportSettings {
    /// Whether the playback goes with the format, the scene and the other settings.
    pub(super) fn check(&self, placed: &PlacedScene, format: Format) -> Result<(), ExportError> {
        let Some(playback) = self.playback else {
            return Ok(());
        };
        let frames_per_second = playback.frames_per_second();
        if format == Format::Ply {
            Err(ExportError::NoTime)
        } else if self.split {
            Err(ExportError::SplitPlayback)
        } else if placed.scene().steps().len() < 2 {
            Err(ExportError::OneStep)
        } else if !FRAMES_PER_SECOND.contains(&frames_per_second) {
            Err(ExportError::FramesPerSecond(frames_per_second))
        } else if matches!(playback, Playback::Morph { .. })
            && !placed.scene().attributes().is_empty()
        {
            Err(ExportError::MorphingAttributes)
        } else {
            Ok(())
        }
    }
}
