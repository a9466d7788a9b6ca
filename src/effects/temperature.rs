//! Temperatures of black bodies.

use std::ops::RangeInclusive;

use thiserror::Error;

/// Limits on the temperature of a lamp, in kelvin: colder ones are black, to the eye.
const RANGE: RangeInclusive<f64> = 500.0..=1e12;

/// The temperature of a black body: from 500 to 1e12 kelvin.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Temperature(f64);

/// Why a number is not the temperature of a lamp.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the temperature is {0:?} kelvin, expected {low} to {high:e}", low = RANGE.start(), high = RANGE.end())]
pub struct TemperatureError(f64);

impl Temperature {
    /// White daylight: 6504 kelvin.
    pub const DAYLIGHT: Self = Self(6504.0);

    /// A temperature of so many kelvin.
    ///
    /// # Errors
    ///
    /// A temperature below 500 or above 1e12 kelvin.
    pub fn new(kelvin: f64) -> Result<Self, TemperatureError> {
        match RANGE.contains(&kelvin) {
            true => Ok(Self(kelvin)),
            false => Err(TemperatureError(kelvin)),
        }
    }

    /// The number of kelvin.
    pub fn kelvin(self) -> f64 {
        self.0
    }
}

impl Default for Temperature {
    fn default() -> Self {
        Self::DAYLIGHT
    }
}
