//! How commands end: exit statuses, and errors in one line.

use std::process::ExitCode;

use photosurface::Cancelled;
use photosurface::jobs::{ExportError, RenderError};
use photosurface::write::{WriteError, writes_are_abandoned};

use super::messages;

/// How a command ended, if not with an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// All that was asked for.
    Done,
    /// Written, or to be written, but not proven to be within the tolerance.
    NotCertified,
}

/// Exit status where something is not certified.
const NOT_CERTIFIED: u8 = 1;

/// Exit status of an error: nothing was written.
const ERROR: u8 = 2;

/// Exit status after Ctrl-C or a signal that ends the program, as shells have it.
pub(super) const INTERRUPTED: u8 = 130;

/// Exit status where nobody reads our stdout any more, as shells have it; there is nobody to tell why, either.
const BROKEN_PIPE: u8 = 141;

/// Says why there is no result, if there is none; the exit status.
pub(super) fn ended(done: anyhow::Result<Status>) -> ExitCode {
    match done {
        Ok(Status::Done) => ExitCode::SUCCESS,
        Ok(Status::NotCertified) => ExitCode::from(NOT_CERTIFIED),
        Err(error) if is_broken_pipe(&error) => ExitCode::from(BROKEN_PIPE),
        // Whoever interrupted the program need not be told.
        Err(error) if is_cancelled(&error) || writes_are_abandoned() => ExitCode::from(INTERRUPTED),
        Err(error) => {
            messages::error(&error);
            ExitCode::from(ERROR)
        }
    }
}

/// Whoever read our stdout has seen enough (`photosurface example sphere | head`).
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let io = cause.downcast_ref::<std::io::Error>();
        io.is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
    })
}

/// A signal has come, and its handler ends the program.
fn is_cancelled(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        matches!(cause.downcast_ref(), Some(WriteError::Cancelled))
            || matches!(cause.downcast_ref(), Some(ExportError::Cancelled))
            || matches!(cause.downcast_ref(), Some(RenderError::Cancelled))
            || cause.is::<Cancelled>()
    })
}
