//! What a scene's unit of length is in everyday units.

use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use thiserror::Error as ThisError;

use super::forms::Keyed;

/// The speed of light in metres per second, and standard gravity in metres per second squared, both exact: *The
/// International System of Units*, 9th edition (2019), and the 3rd General Conference on Weights and Measures (1901).
const SPEED_OF_LIGHT: f64 = 299_792_458.0;
const STANDARD_GRAVITY: f64 = 9.806_65;

/// The scene's units in everyday units. The unit of time is the time in which light travels the unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// The unit of length in metres, from 1e-60 to 1e60; 299792458 makes the unit of time one second.
    #[serde(deserialize_with = "length_m")]
    #[schemars(range(min = 1e-60, max = 1e60))]
    length_m: f64,
}

/// Why a number is not the unit of length.
#[derive(Clone, Copy, Debug, PartialEq, ThisError)]
#[error("length_m is {0:?}, expected a length from 1e-60 to 1e60 metres")]
pub struct UnitsError(f64);

impl Units {
    /// Units whose unit of length is so many metres.
    ///
    /// # Errors
    ///
    /// A length that is not from 1e-60 to 1e60 metres.
    pub fn of_length_m(length_m: f64) -> Result<Self, UnitsError> {
        match (1e-60..=1e60).contains(&length_m) {
            true => Ok(Self { length_m }),
            false => Err(UnitsError(length_m)),
        }
    }

    /// The unit of length in metres.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Standard gravity, 9.80665 m/s^2, in units of the scene: `c^2` per unit of length.
    pub fn gravity(&self) -> f64 {
        STANDARD_GRAVITY / SPEED_OF_LIGHT / SPEED_OF_LIGHT * self.length_m
    }

    /// The unit of time in seconds.
    pub fn time_s(&self) -> f64 {
        self.length_m / SPEED_OF_LIGHT
    }
}

fn length_m<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let units = Units::of_length_m(f64::deserialize(deserializer)?);
    Ok(units.map_err(D::Error::custom)?.length_m)
}

impl Keyed for Units {
    const EXPECTED: &'static str = "units like { \"length_m\": 299792458 }";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In light years of Julian years a falling stone has 1.03.
    #[test]
    fn gravity_is_about_one_per_light_year() {
        let units = Units::of_length_m(299_792_458.0 * 365.25 * 86_400.0).unwrap();
        assert!((units.gravity() - 1.032_295_275_553_596_5).abs() < 4e-16);
        assert!((units.time_s() - 31_557_600.0).abs() < 1e-8);
        for wrong in [0.0, -1.0, 1e-61, 1e61, f64::NAN, f64::INFINITY] {
            assert!(Units::of_length_m(wrong).is_err(), "{wrong}");
        }
    }
}
