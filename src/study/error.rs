//! Why there is nothing to study.

use thiserror::Error;

use crate::jobs::{Cancelled, ExportError};
use crate::pipeline::PlacedSceneError;
use crate::scene::Tolerance;
use crate::spacetime::{FlightError, IntegratorError};

/// Why a study has no result.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// No tolerance, and no number of rays.
    #[error("nothing to study, expected at least one tolerance or number of rays per pixel")]
    Nothing,
    /// One number of rays twice.
    #[error("{0} x {0} rays per pixel are given twice, expected each number once")]
    RepeatedSamples(u32),
    /// One tolerance twice.
    #[error("the tolerance {0} is given twice, expected each one once")]
    Repeated(Tolerance),
    /// Tolerances that cannot be put in order.
    #[error("the tolerances {0} and {1} have different units, expected one unit for all")]
    MixedUnits(Tolerance, Tolerance),
    /// Not one model for each object, or one that is nowhere.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
    /// Not one camera for each step.
    #[error("there are {cameras} cameras for {steps} steps, expected one for each")]
    Cameras {
        /// How many steps the scene has.
        steps: usize,
        /// How many cameras there are.
        cameras: usize,
    },
    /// Photosurfaces that no file can hold, or a file that cannot be written.
    #[error("at the tolerance {tolerance}")]
    Export {
        /// Which.
        tolerance: Tolerance,
        /// Why.
        source: ExportError,
    },
    /// No flight to integrate.
    #[error("the scene has no flight, expected an observer with at least one segment")]
    NoFlight,
    /// A flight that closed forms do not have, or with more steps than a flight may take.
    #[error(transparent)]
    Flight(#[from] FlightError),
    /// Steps that have no length.
    #[error(transparent)]
    Step(#[from] IntegratorError),
    /// A flight that takes too long by a reference of 30 digits, or leaves its numbers.
    #[error(
        "the flight is too long for the reference of 30 digits, expected at most about 10,000 segments, turns and \
         rapidities of less than about 7000 radians in all, and a Lorentz factor below 1e150"
    )]
    LongFlight,
    /// The caller ended the study.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
