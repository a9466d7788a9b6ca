//! How far a photosurface may be from the true one.

use std::fmt;

use schemars::JsonSchema;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use thiserror::Error;

/// How far, at most, a mesh is to be from the true photosurface.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema)]
#[schemars(with = "ToleranceForm")]
pub enum Tolerance {
    /// A length in the observer's frame.
    Absolute(f64),
    /// A fraction of the diagonal of the box around the object's photosurface, at each step.
    Relative(f64),
    /// An angle seen by the observer, in degrees.
    Angle(f64),
}

/// Why a number is no tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ToleranceError {
    /// A length or fraction that is zero, negative or not finite.
    #[error("the tolerance is {0}, expected a finite number > 0")]
    Number(f64),
    /// An angle that says nothing.
    #[error("the tolerance is {0} degrees, expected an angle > 0 and at most 90 degrees")]
    Angle(f64),
}

impl Default for Tolerance {
    /// A thousandth of the diagonal.
    fn default() -> Self {
        Self::Relative(1e-3)
    }
}

impl Tolerance {
    /// The same tolerance, if its number makes sense.
    ///
    /// # Errors
    ///
    /// A number that is not finite and positive, or an angle above 90 degrees.
    pub fn checked(self) -> Result<Self, ToleranceError> {
        let (Self::Absolute(number) | Self::Relative(number) | Self::Angle(number)) = self;
        match self {
            Self::Angle(degrees) if !(degrees > 0.0 && degrees <= 90.0) => {
                Err(ToleranceError::Angle(degrees))
            }
            _ if !(number > 0.0 && number.is_finite()) => Err(ToleranceError::Number(number)),
            _ => Ok(self),
        }
    }

    /// The tolerance `factor` times as large.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        match self {
            Self::Absolute(length) => Self::Absolute(length * factor),
            Self::Relative(fraction) => Self::Relative(fraction * factor),
            Self::Angle(degrees) => Self::Angle((degrees * factor).min(90.0)),
        }
    }
}

impl fmt::Display for Tolerance {
    /// As the command line takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absolute(length) => write!(f, "abs:{length:.3e}"),
            Self::Relative(fraction) => write!(f, "{fraction:.3e}"),
            Self::Angle(degrees) => write!(f, "deg:{degrees:.3e}"),
        }
    }
}

impl<'de> Deserialize<'de> for Tolerance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Form;
        impl<'de> Visitor<'de> for Form {
            type Value = Tolerance;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a tolerance like { \"relative\": 1e-3 }")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Tolerance, A::Error> {
                const EXPECTED: &str = "exactly one of absolute, relative, angle_deg";
                let Some(unit) = map.next_key::<String>()? else {
                    return Err(A::Error::custom(format_args!(
                        "the tolerance is empty, expected {EXPECTED}"
                    )));
                };
                let tolerance = match unit.as_str() {
                    "absolute" => Tolerance::Absolute,
                    "relative" => Tolerance::Relative,
                    "angle_deg" => Tolerance::Angle,
                    _ => {
                        return Err(A::Error::custom(format_args!(
                            "unknown unit `{unit}` of a tolerance, expected {EXPECTED}"
                        )));
                    }
                };
                let tolerance = tolerance(map.next_value()?).checked();
                let tolerance = tolerance.map_err(A::Error::custom)?;
                match map.next_key::<String>()? {
                    None => Ok(tolerance),
                    Some(second) => Err(A::Error::custom(format_args!(
                        "both `{unit}` and `{second}` in a tolerance, expected {EXPECTED}"
                    ))),
                }
            }
        }
        deserializer.deserialize_any(Form)
    }
}

/// A tolerance, given in exactly one of three ways.
#[derive(JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(dead_code, reason = "the JSON Schema is made from it")]
enum ToleranceForm {
    /// A length in the observer's frame, > 0.
    Absolute(f64),
    /// A fraction of the diagonal of the box around the object's photosurface, at each step, > 0.
    Relative(f64),
    /// An angle seen by the observer, in degrees, > 0 and at most 90.
    AngleDeg(f64),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_gives_exactly_one_unit_and_a_number_that_makes_sense() {
        let read = |text: &str| serde_json::from_str::<Tolerance>(text);
        assert_eq!(
            read(r#"{"absolute": 2}"#).unwrap(),
            Tolerance::Absolute(2.0)
        );
        assert_eq!(
            read(r#"{"relative": 1e-4}"#).unwrap(),
            Tolerance::Relative(1e-4)
        );
        assert_eq!(
            read(r#"{"angle_deg": 90}"#).unwrap(),
            Tolerance::Angle(90.0)
        );
        for (text, expected) in [
            (
                r#"{"absolute": 1, "relative": 1}"#,
                "both `absolute` and `relative`",
            ),
            (r#"{"degrees": 1}"#, "unknown unit `degrees`"),
            (r#"{}"#, "the tolerance is empty"),
            (r#"1e-3"#, "a tolerance like"),
            (
                r#"{"relative": 0}"#,
                "the tolerance is 0, expected a finite number > 0",
            ),
            (
                r#"{"angle_deg": 0}"#,
                "the tolerance is 0 degrees, expected an angle > 0",
            ),
            (r#"{"angle_deg": 91}"#, "the tolerance is 91 degrees"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
