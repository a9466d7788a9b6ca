//! How far a job has got, and whether it goes on.

use thiserror::Error;

/// The caller's ear and hand in a job that takes long: it hears how far the job has got, and may end it.
///
/// A job calls it from several threads. `()` hears nothing and ends nothing.
pub trait Progress: Sync {
    /// The job has `pieces` pieces of work before it: photosurfaces of an export, rows of pictures.
    fn begin(&self, pieces: usize);

    /// `pieces` more pieces of work are done.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] ends the job: it does no piece that it has not begun, leaves no half-written file, and returns an
    /// error that says so.
    fn advance(&self, pieces: usize) -> Result<(), Cancelled>;
}

impl Progress for () {
    fn begin(&self, _: usize) {}

    fn advance(&self, _: usize) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// The caller of a job has ended it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("cancelled")]
pub struct Cancelled;
