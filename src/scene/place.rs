//! Where and when things are in the scene frame.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A place in the scene frame; every coordinate is a finite number.
#[derive(Clone, Copy, Debug, PartialEq, Default, Deserialize, Serialize)]
#[serde(try_from = "DVec3")]
pub struct Place(DVec3);

/// Why a vector is not a [`Place`].
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the place is {0}, expected finite coordinates")]
pub struct PlaceError(DVec3);

/// A time in the scene frame: a finite number.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default, Deserialize, Serialize)]
#[serde(try_from = "f64")]
pub struct Time(f64);

/// Why a number is not a [`Time`].
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the time is {0}, expected a finite number")]
pub struct TimeError(f64);

impl Place {
    /// The origin of the scene.
    pub const ORIGIN: Self = Self(DVec3::ZERO);

    /// The place with these coordinates.
    ///
    /// # Errors
    ///
    /// A coordinate that is infinite or NaN.
    pub fn new(coordinates: DVec3) -> Result<Self, PlaceError> {
        match coordinates.is_finite() {
            true => Ok(Self(coordinates)),
            false => Err(PlaceError(coordinates)),
        }
    }

    /// The coordinates.
    pub fn get(self) -> DVec3 {
        self.0
    }
}

impl TryFrom<DVec3> for Place {
    type Error = PlaceError;

    fn try_from(coordinates: DVec3) -> Result<Self, PlaceError> {
        Self::new(coordinates)
    }
}

impl Time {
    /// The time `value`.
    ///
    /// # Errors
    ///
    /// Infinity or NaN.
    pub fn new(value: f64) -> Result<Self, TimeError> {
        match value.is_finite() {
            true => Ok(Self(value)),
            false => Err(TimeError(value)),
        }
    }

    /// The number.
    pub fn get(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Time {
    type Error = TimeError;

    fn try_from(value: f64) -> Result<Self, TimeError> {
        Self::new(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_times_are_finite() {
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(Time::new(odd).is_err(), "{odd}");
            let places = [
                DVec3::new(odd, 0.0, 0.0),
                DVec3::new(0.0, odd, 0.0),
                DVec3::new(0.0, 0.0, odd),
            ];
            for place in places {
                assert!(Place::new(place).is_err(), "{place}");
            }
        }
        for fine in [0.0, -0.0, -5e-324, f64::MAX, f64::MIN] {
            assert_eq!(Time::new(fine).unwrap().get(), fine);
            assert_eq!(
                Place::new(DVec3::splat(fine)).unwrap().get(),
                DVec3::splat(fine)
            );
        }
    }
}
