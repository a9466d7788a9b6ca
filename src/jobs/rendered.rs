//! The facts about drawn pictures, and the errors of drawing.

use glam::DVec3;
use thiserror::Error;

use super::files::OutputError;
use super::framing::FramingError;
use super::observer_frame::FrameFacts;
use super::progress::Cancelled;
use super::tally::Tally;
use crate::pipeline::PlacedSceneError;
use crate::render::CameraError;
use crate::write::WriteError;

/// Reasons why there are no pictures, or not all of them.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No camera has all objects in the picture.
    #[error(transparent)]
    Framing(#[from] FramingError),
    /// A sheet has too many pixels.
    #[error("a sheet of {steps} steps side by side")]
    Sheet {
        /// Number of steps.
        steps: usize,
        /// The size of the sheet, which is beyond the limit.
        source: CameraError,
    },
    /// No scene is to stand side by side with others.
    #[error("there is no scene, expected at least one")]
    NoScene,
    /// Rows of scenes differ in their number of scenes.
    #[error("there are rows of different numbers of scenes, expected as many in each")]
    Rows,
    /// Scenes that are to stand side by side differ in their number of steps.
    #[error("\"{label}\" has {found} steps beside one with {steps}, expected as many")]
    Steps {
        /// The label of the scene.
        label: String,
        /// Number of its steps.
        found: usize,
        /// Number of steps of the first scene.
        steps: usize,
    },
    /// An overview is not of these scenes and settings.
    #[error("the overview is of other scenes or settings")]
    Overview,
    /// There are no photosurfaces.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
    /// A file must not or cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The caller has cancelled the job.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for RenderError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<WriteError> for RenderError {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Cancelled => Self::Cancelled,
            error => Self::Output(error.into()),
        }
    }
}

/// The facts about the pictures that have been drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Totals of the photosurfaces in the pictures, each counted once; zero if all views were drawn by rays.
    pub tally: Tally,
    /// The observer's views that show nothing but the background.
    pub empty: Vec<EmptyView>,
    /// The frame of the observer's views, if there are any.
    pub frame: Option<FrameFacts>,
    /// The cost of each view, in the order in which they were drawn; a sheet has two views for each step.
    pub costs: Vec<ViewCost>,
}

impl Rendered {
    /// The facts about these pictures and others.
    pub(super) fn with(mut self, other: Self) -> Self {
        self.tally.merge(other.tally);
        self.empty.extend(other.empty);
        self.costs.extend(other.costs);
        self.frame = self.frame.or(other.frame);
        self
    }
}

/// A view of the observer that shows only the background, because every object is in another direction or smaller than
/// a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmptyView {
    /// The step, counted from 0.
    pub step: usize,
    /// The direction to the middle of the part of the sky that the objects cover at that step: a unit vector in the
    /// observer's frame.
    pub look: DVec3,
}

/// The cost of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCost {
    /// Number of rays that start at the camera.
    pub rays: u64,
    /// Wall-clock time for tracing them, in seconds.
    pub seconds: f64,
}
