//! Settings and errors of an export.

use std::ops::Range;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::framing::{CameraSettings, FramingError};
use super::vertex_colors::VertexColors;
use super::{DEFAULT_MAX_TRIANGLES, OutputError};
use crate::pipeline::PlacedScene;
use crate::render::Textures;
use crate::scene::Tolerance;
use crate::write::{
    FRAMES_PER_SECOND, Fingerprint, Format, Playback, Provenance, StageTime, WriteError,
};

/// Settings for the export of a placed scene.
#[derive(Clone, Debug)]
pub struct ExportSettings {
    /// Whether each step has a file of its own: `out_step000.glb`, `out_step001.glb`, ...
    pub split: bool,
    /// Which steps are written, counted from 0, with the names and numbers that they have among all: with `None` all of
    /// them. Triangles are shared out among all steps all the same.
    pub only: Option<Range<usize>>,
    /// The fingerprint of the files that the scene was read from, if files that an earlier run finished are to stay: a file
    /// that is whole, and was made of the same scene, files and settings by the same version. Files that are made get a
    /// [`Seal`](crate::write::Seal) by which a later run knows them. With `None` all files are made, without seals.
    pub resume: Option<Fingerprint>,
    /// How the steps of one file follow each other as an animation; with `None` all steps are visible at once.
    pub playback: Option<Playback>,
    /// What the observer's camera in a glTF file shows of the sky; `None` for a file without a camera.
    pub camera: Option<CameraSettings>,
    /// Levels of detail: tolerances for all objects, each with files of its own, `out_lod0.glb`, `out_lod1.glb`, ...;
    /// if there are none, the tolerances of the scene are used.
    pub levels: Vec<Tolerance>,
    /// Whether meshes are refined until they are within the tolerance; if not, no vertex is added, and the certificates
    /// state the resulting bounds.
    pub subdivide: bool,
    /// Limit on the triangles of all photosurfaces of one level together. If a tolerance needs more, the largest gaps
    /// are closed first and the result is not certified. The triangles of a source are always kept, even if they exceed
    /// the limit. With `u64::MAX` there is none, and nothing is predicted before the first step is made.
    pub max_triangles: u64,
    /// The file of a JSON [`Report`](crate::write::Report), if one is to be written; each level has its own.
    pub report: Option<PathBuf>,
    /// Whether [`Exported`](super::Exported) holds the facts about every photosurface. Their memory grows with the number of
    /// photosurfaces.
    pub keep_facts: bool,
    /// Whether the report has the times of the stages; without them it is the same on every run.
    pub report_times: bool,
    /// What the report says of files read and of the command.
    pub provenance: Provenance,
    /// Stages that the caller has finished before the export, with their times, for the report.
    pub stages_before: Vec<StageTime>,
    /// The textures whose colours become those of vertices if the scene calls for the Doppler effect.
    pub textures: Textures,
}

impl Default for ExportSettings {
    /// All steps in one file, refined to the tolerances of the scene, with at most [`DEFAULT_MAX_TRIANGLES`].
    fn default() -> Self {
        Self {
            split: false,
            only: None,
            resume: None,
            playback: None,
            camera: None,
            levels: vec![],
            subdivide: true,
            max_triangles: DEFAULT_MAX_TRIANGLES,
            report: None,
            keep_facts: true,
            report_times: true,
            provenance: Provenance::default(),
            stages_before: vec![],
            textures: Textures::default(),
        }
    }
}

/// Errors of an export.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The extension of the file is not that of a known format.
    #[error("{}: unknown extension, expected .glb, .gltf or .ply", .0.display())]
    UnknownExtension(PathBuf),
    /// An animation is asked for in a format that cannot hold one.
    #[error("a .ply has no time, expected .glb or .gltf for an animation")]
    NoTime,
    /// A camera is asked for in a format that cannot hold one.
    #[error("a .ply has no camera, expected .glb or .gltf for one")]
    NoCamera,
    /// No camera has the objects in its picture.
    #[error(transparent)]
    Framing(#[from] FramingError),
    /// An animation is asked for, but the scene has only one step.
    #[error("the scene has one step, expected at least two for an animation")]
    OneStep,
    /// The number of frames per second is out of range.
    #[error("{0:?} frames a second, expected a number from 0.001 to 1000")]
    FramesPerSecond(f64),
    /// Attributes, which differ from step to step, are asked for together with one mesh for all steps.
    #[error(
        "an animation by morphing shows one mesh, and attributes differ from step to step; expected no attributes"
    )]
    MorphingAttributes,
    /// Colours of vertices, which differ from step to step, are called for together with one mesh for all steps.
    #[error(
        "an animation by morphing shows one mesh, and colours as the observer sees them differ from step to step; expected \
         no Doppler effect and no black bodies"
    )]
    MorphingColors,
    /// An animation is asked for together with a file for each step.
    #[error("an animation is one file, expected it without a file for each step")]
    SplitPlayback,
    /// Steps are asked for that the scene does not have.
    #[error("the steps {}..{} are asked for, expected numbers up to {steps}", only.start, only.end)]
    Part {
        /// The steps that are asked for.
        only: Range<usize>,
        /// Number of steps of the scene.
        steps: usize,
    },
    /// A part of the steps is asked for together with an animation of them.
    #[error("an animation shows all steps, expected it without a part of them")]
    PartOfAnimation,
    /// Two levels of detail have the same tolerance.
    #[error("the tolerance {0} is given twice among the levels of detail, expected each one once")]
    RepeatedLevel(Tolerance),
    /// A file must not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file cannot hold the photosurfaces or cannot be written.
    #[error("{}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The reason.
        source: WriteError,
    },
    /// The caller cancelled the export: finished files stay, unfinished ones are removed.
    #[error("cancelled")]
    Cancelled,
}

impl ExportError {
    /// The error of a file. If `source` already names a file, the result does not name it twice.
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
    /// The steps that are written, of so many.
    pub(super) fn steps(&self, count: usize) -> Range<usize> {
        self.only.clone().unwrap_or(0..count)
    }

    /// The fingerprint of files of a placed scene, if there is one of its files: everything beside the steps of a file that
    /// their bytes depend on.
    pub(super) fn fingerprint(&self, placed: &PlacedScene, format: Format) -> Option<Fingerprint> {
        let playback_and_camera = (self.playback, &self.camera);
        let budget = (self.subdivide, self.max_triangles);
        Some(
            self.resume?
                .with("scene", placed.scene())
                .with("export", &(format, self.split, playback_and_camera, budget)),
        )
    }

    /// Checks that the playback is possible with the format, the scene and the other settings.
    pub(super) fn check(&self, placed: &PlacedScene, format: Format) -> Result<(), ExportError> {
        if self.camera.is_some() && format == Format::Ply {
            return Err(ExportError::NoCamera);
        }
        let steps = placed.scene().steps().len();
        if let Some(only) = self.only.clone()
            && (only.is_empty() || only.end > steps)
        {
            return Err(ExportError::Part { only, steps });
        }
        let Some(playback) = self.playback else {
            return Ok(());
        };
        let frames_per_second = playback.frames_per_second();
        if format == Format::Ply {
            Err(ExportError::NoTime)
        } else if self.split {
            Err(ExportError::SplitPlayback)
        } else if self.only.is_some() {
            Err(ExportError::PartOfAnimation)
        } else if placed.scene().steps().len() < 2 {
            Err(ExportError::OneStep)
        } else if !FRAMES_PER_SECOND.contains(&frames_per_second) {
            Err(ExportError::FramesPerSecond(frames_per_second))
        } else if matches!(playback, Playback::Morph { .. })
            && !placed.scene().attributes().is_empty()
        {
            Err(ExportError::MorphingAttributes)
        } else if matches!(playback, Playback::Morph { .. })
            && VertexColors::are_wanted(placed.scene())
        {
            Err(ExportError::MorphingColors)
        } else {
            Ok(())
        }
    }
}
