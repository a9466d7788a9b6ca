//! What is known of pictures that have been drawn, and why there may be none.

use glam::DVec3;
use thiserror::Error;

use super::files::OutputError;
use super::framing::FramingError;
use super::progress::Cancelled;
use super::tally::Tally;
use crate::pipeline::PlacedSceneError;
use crate::render::CameraError;
use crate::write::WriteError;

/// Why there are no pictures, or not all of them.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No camera frames what there is to be seen.
    #[error(transparent)]
    Framing(#[from] FramingError),
    /// A sheet of too many pixels.
    #[error("a sheet of {steps} steps side by side")]
    Sheet {
        /// Number of steps.
        steps: usize,
        /// The size of the sheet, which is beyond the limit.
        source: CameraError,
    },
    /// There are no photosurfaces.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
    /// A file that must not, or cannot, be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The caller has ended the job.
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

/// What is to be said of pictures that have been drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rendered {
    /// The photosurfaces in the pictures, in sum, each counted once; none where all was drawn by rays.
    pub tally: Tally,
    /// The observer's views that show nothing but the background.
    pub empty: Vec<EmptyView>,
    /// The cost of each view, in the order in which they were drawn; a sheet has two of each step.
    pub costs: Vec<ViewCost>,
}

/// A view of the observer that shows nothing but the background: everything is in another direction, or smaller than a
/// pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmptyView {
    /// The step, counted from 0.
    pub step: usize,
    /// The direction to the middle of the sky that everything takes up at that step: a unit vector in the observer's frame.
    pub look: DVec3,
}

/// What one view has cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCost {
    /// Number of rays that start at the camera.
    pub rays: u64,
    /// Wall-clock time for tracing them, in seconds.
    pub seconds: f64,
}
