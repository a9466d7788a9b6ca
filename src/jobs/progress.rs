//! The progress of a job, and its cancellation.

use std::ops::Range;
use std::path::Path;

use thiserror::Error;

/// A long job reports its progress to the caller through this trait, and the caller may cancel the job.
///
/// A job calls the methods from several threads. `()` ignores all reports and never cancels.
pub trait Progress: Sync {
    /// The job is about to start and has `pieces` pieces of work: photosurfaces of an export, or rows of pixels of
    /// pictures.
    fn begin(&self, pieces: usize);

    /// `pieces` more pieces of work are done; 0 where a job only asks whether it is to go on.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] ends the job: the job begins no other piece, leaves no half-written file, and returns an error
    /// that says that it was cancelled.
    fn advance(&self, pieces: usize) -> Result<(), Cancelled>;

    /// The job has finished a file, or a step on its way into one.
    fn finished(&self, _: &Finished<'_>) {}
}

/// What a job has finished: a file, or the photosurfaces or the picture of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished<'a> {
    /// The steps, or pictures, as they are numbered in the whole.
    pub steps: Range<usize>,
    /// How many the whole has.
    pub of: usize,
    /// Wall-clock time since something else was finished before, in seconds.
    pub seconds: f64,
    /// Whether everything in it is certified.
    pub is_certified: bool,
    /// The file with its length; `None` for a step that goes into a file of several, or to the caller.
    pub file: Option<(&'a Path, u64)>,
    /// Whether the file was finished before, and was not made anew.
    pub is_resumed: bool,
}

impl Progress for () {
    fn begin(&self, _: usize) {}

    fn advance(&self, _: usize) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// The caller of a job has cancelled it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("cancelled")]
pub struct Cancelled;
