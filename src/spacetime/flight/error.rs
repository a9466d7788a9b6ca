//! Why numbers do not make a flight.

use glam::DVec3;
use thiserror::Error;

use crate::spacetime::MAX_RAPIDITY;

/// The largest angle, in radians, by which one segment turns: rounding leaves about four digits of its last turn.
pub(super) const MAX_TURN: f64 = 1e12;

/// The largest angle, in radians, of a coordinated turn at changing speed, whose integral takes time in proportion.
pub(super) const MAX_TURN_AT_CHANGING_SPEED: f64 = 1e5;

/// The largest number of steps of an integrator in one flight.
pub(super) const MAX_STEPS: f64 = 1e7;

/// Why numbers do not make a [`Segment`](super::Segment).
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SegmentError {
    /// No duration.
    #[error("the proper time is {0}, expected a finite duration > 0")]
    ProperTime(f64),
    /// An acceleration that is not finite.
    #[error("the acceleration is {0}, expected three finite numbers")]
    Acceleration(DVec3),
    /// A turn rate that is not finite.
    #[error("the turn rate is {0}, expected three finite numbers")]
    TurnRate(DVec3),
    /// So many turns that rounding leaves nothing of the last one.
    #[error("the segment turns by {0:e} radians, expected at most {MAX_TURN:e}")]
    Turn(f64),
}

/// Why segments do not make a [`Flight`](super::Flight).
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FlightError {
    /// A segment that ends too near the speed of light.
    #[error(
        "flight[{segment}] ends at rapidity {rapidity}, expected at most {MAX_RAPIDITY} (1 - beta = 2e-304)"
    )]
    TooFast {
        /// Which segment, counted from 0.
        segment: usize,
        /// The rapidity in the scene frame.
        rapidity: f64,
    },
    /// Without speed a coordinated turn has no turn rate.
    #[error(
        "flight[{segment}] is steered \"coordinated\" and comes to rest while it turns, where its turn rate would be \
         infinite; expected a segment that stays in motion, or \"free\""
    )]
    StopsInTurn {
        /// Which segment, counted from 0.
        segment: usize,
    },
    /// Too many turns at a changing speed.
    #[error(
        "flight[{segment}] is steered \"coordinated\" and turns by {turn:e} radians while its speed changes, expected at \
         most {limit:e}",
        limit = MAX_TURN_AT_CHANGING_SPEED
    )]
    TooManyTurns {
        /// Which segment, counted from 0.
        segment: usize,
        /// The angle.
        turn: f64,
    },
    /// A flight of which the end is beyond `f64`.
    #[error("the flight lasts longer than any number says, expected a finite proper time")]
    Endless,
    /// Too small a step for so long a flight.
    #[error(
        "the integrator would take {steps:e} steps, expected at most {limit:e}: choose a longer step",
        limit = MAX_STEPS
    )]
    Steps {
        /// How many steps.
        steps: f64,
    },
}
