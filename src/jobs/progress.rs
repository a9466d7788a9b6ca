//! The progress of a job, and its cancellation.

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
