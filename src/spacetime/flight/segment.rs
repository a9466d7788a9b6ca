//! A part of a flight during which the engines do the same.

use glam::DVec3;

use super::SegmentError;
use super::error::MAX_TURN;
use crate::spacetime::length;

/// How an observer turns during a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steering {
    /// At a constant rate, about axes that turn along with the observer. The turn rate of zero carries the axes along
    /// without turning them (Fermi and Walker).
    Free {
        /// The turn rate in the observer's own axes, in radians per unit of proper time, by the right-hand rule.
        turn_rate: DVec3,
    },
    /// Like an airplane: so that the direction of motion keeps its place in the observer's own axes. At rest, below
    /// a rapidity of `1e-12`, there is no turn. A turn that comes to rest is an error, as its rate would be infinite.
    Coordinated,
}

/// A part of a flight: so much proper time of constant proper acceleration.
///
/// Accelerations are in the observer's own axes and in units of `c^2` per unit of length: 1.03 per light year is that of
/// a falling stone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    proper_time: f64,
    acceleration: DVec3,
    steering: Steering,
}

impl Segment {
    /// A segment with a constant turn rate; see [`Steering::Free`].
    ///
    /// # Errors
    ///
    /// A duration that is not above zero, a number that is not finite, or a turn by more than `1e12` radians.
    pub fn free(
        proper_time: f64,
        acceleration: DVec3,
        turn_rate: DVec3,
    ) -> Result<Self, SegmentError> {
        if !turn_rate.is_finite() {
            return Err(SegmentError::TurnRate(turn_rate));
        }
        let turn = length(turn_rate) * proper_time;
        if turn > MAX_TURN {
            return Err(SegmentError::Turn(turn));
        }
        Self::checked(proper_time, acceleration, Steering::Free { turn_rate })
    }

    /// A segment of a coordinated turn; see [`Steering::Coordinated`].
    ///
    /// # Errors
    ///
    /// A duration that is not above zero, or a number that is not finite.
    pub fn coordinated(proper_time: f64, acceleration: DVec3) -> Result<Self, SegmentError> {
        Self::checked(proper_time, acceleration, Steering::Coordinated)
    }

    fn checked(
        proper_time: f64,
        acceleration: DVec3,
        steering: Steering,
    ) -> Result<Self, SegmentError> {
        if !(proper_time > 0.0 && proper_time.is_finite()) {
            return Err(SegmentError::ProperTime(proper_time));
        }
        if !acceleration.is_finite() {
            return Err(SegmentError::Acceleration(acceleration));
        }
        Ok(Self {
            proper_time,
            acceleration,
            steering,
        })
    }

    /// The same segment with its acceleration multiplied.
    ///
    /// # Errors
    ///
    /// A product that is beyond `f64`.
    pub(crate) fn with_acceleration_times(self, factor: f64) -> Result<Self, SegmentError> {
        Self::checked(self.proper_time, self.acceleration * factor, self.steering)
    }

    /// How long the segment lasts, in the observer's proper time.
    pub fn proper_time(&self) -> f64 {
        self.proper_time
    }

    /// The proper acceleration in the observer's own axes.
    pub fn acceleration(&self) -> DVec3 {
        self.acceleration
    }

    /// How the observer turns.
    pub fn steering(&self) -> Steering {
        self.steering
    }
}
