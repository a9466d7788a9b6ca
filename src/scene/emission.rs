//! Objects that glow.

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};
use thiserror::Error;

use super::forms::Keyed;
use crate::effects::{Temperature, TemperatureError};

/// The light of an object that is a black body: it needs no lamp, and its material has no say.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Emission {
    /// The temperature in kelvin, from 500 to 1e12.
    #[serde(deserialize_with = "kelvin")]
    #[schemars(with = "f64", range(min = 500, max = 1e12))]
    kelvin: Temperature,
    /// The luminance at rest; that of a white surface lit by the lamp at the eye is 1, as if absent.
    #[serde(default = "of_white", deserialize_with = "luminance")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    luminance: f64,
}

/// Why numbers are not the light of a black body.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EmissionError {
    /// A temperature that no lamp has.
    #[error(transparent)]
    Temperature(#[from] TemperatureError),
    /// A luminance that is zero, negative or not finite.
    #[error("the luminance is {0:?}, expected a finite number > 0")]
    Luminance(f64),
}

impl Emission {
    /// A black body of so many kelvin and of a luminance at rest; that of a white surface is 1.
    ///
    /// # Errors
    ///
    /// A temperature below 500 or above 1e12 kelvin, or a luminance that is not finite and positive.
    pub fn new(kelvin: f64, luminance: f64) -> Result<Self, EmissionError> {
        Ok(Self {
            kelvin: Temperature::new(kelvin)?,
            luminance: checked(luminance)?,
        })
    }

    /// The temperature.
    pub fn temperature(&self) -> Temperature {
        self.kelvin
    }

    /// As scenes write it.
    pub(crate) fn to_value(self) -> Value {
        json!({ "kelvin": self.kelvin.kelvin(), "luminance": self.luminance })
    }

    /// The luminance at rest.
    pub fn luminance(&self) -> f64 {
        self.luminance
    }
}

fn checked(luminance: f64) -> Result<f64, EmissionError> {
    match luminance > 0.0 && luminance.is_finite() {
        true => Ok(luminance),
        false => Err(EmissionError::Luminance(luminance)),
    }
}

fn of_white() -> f64 {
    1.0
}

/// A temperature as a scene writes it: its number of kelvin.
pub(super) fn kelvin<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Temperature, D::Error> {
    Temperature::new(f64::deserialize(deserializer)?).map_err(D::Error::custom)
}

fn luminance<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    checked(f64::deserialize(deserializer)?).map_err(D::Error::custom)
}

impl Keyed for Emission {
    const EXPECTED: &'static str = "a black body like { \"kelvin\": 5778, \"luminance\": 1 }";
}
