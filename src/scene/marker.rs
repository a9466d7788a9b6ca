//! The radius of the small sphere that marks the observer.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use thiserror::Error;

/// Every radius of which a sphere can be made.
const RANGE: RangeInclusive<f64> = 1e-60..=1e60;

/// The radius of the small sphere that marks the observer: a length from 1e-60 to 1e60.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Deserialize)]
#[serde(try_from = "f64")]
pub struct MarkerRadius(f64);

/// Why a number is not the radius of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the marker's radius is {0:?}, expected a length from 1e-60 to 1e60")]
pub struct MarkerRadiusError(f64);

impl MarkerRadius {
    /// The radius `value`.
    ///
    /// # Errors
    ///
    /// A number outside 1e-60 to 1e60, or NaN.
    pub fn new(value: f64) -> Result<Self, MarkerRadiusError> {
        if RANGE.contains(&value) {
            Ok(Self(value))
        } else {
            Err(MarkerRadiusError(value))
        }
    }

    /// The number.
    pub fn get(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for MarkerRadius {
    type Error = MarkerRadiusError;

    fn try_from(value: f64) -> Result<Self, MarkerRadiusError> {
        Self::new(value)
    }
}

impl JsonSchema for MarkerRadius {
    fn schema_name() -> Cow<'static, str> {
        "MarkerRadius".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "number", "minimum": RANGE.start(), "maximum": RANGE.end() })
    }
}
