//! How an object is stretched along its own axes.

use std::fmt;

use glam::DVec3;
use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::shape::{Length, ShapeError};

/// Stretches along the three axes: one factor for all, or one for each.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema)]
#[schemars(with = "ScaleForm")]
pub struct Scale([Factor; 3]);

/// A finite factor greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
struct Factor(f64);

impl TryFrom<f64> for Factor {
    type Error = ShapeError;

    fn try_from(value: f64) -> Result<Self, ShapeError> {
        match value > 0.0 && value.is_finite() {
            true => Ok(Self(value)),
            false => Err(ShapeError::Factor { value }),
        }
    }
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only.
enum ScaleForm {
    /// One factor for all axes.
    Uniform(Length),
    /// A factor for each axis.
    PerAxis([Length; 3]),
}

impl Scale {
    /// One factor for each axis.
    ///
    /// # Errors
    ///
    /// A factor that is not finite and positive.
    pub fn new(factors: DVec3) -> Result<Self, ShapeError> {
        let [x, y, z] = factors.to_array().map(Factor::try_from);
        Ok(Self([x?, y?, z?]))
    }

    /// One factor for all axes.
    ///
    /// # Errors
    ///
    /// A factor that is not finite and positive.
    pub fn uniform(factor: f64) -> Result<Self, ShapeError> {
        Self::new(DVec3::splat(factor))
    }

    /// The factors.
    pub fn get(self) -> DVec3 {
        self.0.map(|Factor(factor)| factor).into()
    }

    /// The largest factor: nothing is stretched more.
    pub(crate) fn largest(self) -> f64 {
        self.get().max_element()
    }
}

impl Default for Scale {
    /// As it is.
    fn default() -> Self {
        Self([Factor(1.0); 3])
    }
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScaleVisitor;
        impl<'de> Visitor<'de> for ScaleVisitor {
            type Value = Scale;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a factor > 0 or three, one for each axis")
            }

            fn visit_f64<E: Error>(self, factor: f64) -> Result<Scale, E> {
                Scale::uniform(factor).map_err(E::custom)
            }

            fn visit_i64<E: Error>(self, factor: i64) -> Result<Scale, E> {
                self.visit_f64(factor as f64)
            }

            fn visit_u64<E: Error>(self, factor: u64) -> Result<Scale, E> {
                self.visit_f64(factor as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Scale, A::Error> {
                Deserialize::deserialize(SeqAccessDeserializer::new(seq)).map(Scale)
            }
        }
        deserializer.deserialize_any(ScaleVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_factor_is_finite_and_positive() {
        for odd in [0.0, -0.0, -5.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(Scale::uniform(odd).is_err(), "{odd}");
            for axis in DVec3::AXES {
                let there = axis.cmpgt(DVec3::ZERO);
                let factors = DVec3::select(there, DVec3::splat(odd), DVec3::ONE);
                assert!(Scale::new(factors).is_err(), "{factors}");
            }
        }
        let scale = Scale::new(DVec3::new(5e-324, 2.0, 1.0)).unwrap();
        assert_eq!(scale.get(), DVec3::new(5e-324, 2.0, 1.0));
        assert_eq!(scale.largest(), 2.0);
        assert_eq!(Scale::default(), Scale::uniform(1.0).unwrap());
        let error = serde_json::from_str::<Scale>("[1, -1, 1]")
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("factor is -1, expected a finite factor > 0"),
            "{error}"
        );
    }
}
