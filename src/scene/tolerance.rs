//! How far a photosurface may be from the true one.

use std::fmt;

use schemars::JsonSchema;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use thiserror::Error;

/// The smallest number greater than zero.
const MIN: f64 = f64::from_bits(1);

/// A point beside the observer can be off by no more.
const MAX_DEGREES: f64 = 90.0;

/// What the number of a [`Tolerance`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// A length in the observer's frame.
    Absolute,
    /// A fraction of the diagonal of the box around the object's photosurface, at each step.
    Relative,
    /// An angle seen by the observer, in degrees.
    #[serde(rename = "angle_deg")]
    Degrees,
}

/// How far, at most, a mesh is to be from the true photosurface.
///
/// # Units
///
/// A finite number greater than zero of some [`Unit`]; at most 90 degrees.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema)]
#[schemars(with = "ToleranceForm")]
pub struct Tolerance {
    number: f64,
    unit: Unit,
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

impl fmt::Display for Unit {
    /// What its numbers are.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Absolute => "length",
            Self::Relative => "fraction",
            Self::Degrees => "degrees",
        })
    }
}

impl Default for Tolerance {
    /// A thousandth of the diagonal.
    fn default() -> Self {
        Self {
            number: 1e-3,
            unit: Unit::Relative,
        }
    }
}

impl Tolerance {
    /// The tolerance as flags write it, with all digits: `0.001`, `abs:0.01`, `deg:0.02`.
    pub fn to_flag(self) -> String {
        let unit = match self.unit {
            Unit::Relative => "",
            Unit::Absolute => "abs:",
            Unit::Degrees => "deg:",
        };
        format!("{unit}{:?}", self.number)
    }

    /// So many of a unit.
    ///
    /// # Errors
    ///
    /// A number that is not finite and positive, or an angle above 90 degrees.
    pub fn new(number: f64, unit: Unit) -> Result<Self, ToleranceError> {
        match unit {
            Unit::Degrees if !(number > 0.0 && number <= MAX_DEGREES) => {
                Err(ToleranceError::Angle(number))
            }
            _ if !(number > 0.0 && number.is_finite()) => Err(ToleranceError::Number(number)),
            _ => Ok(Self { number, unit }),
        }
    }

    /// A length in the observer's frame.
    ///
    /// # Errors
    ///
    /// A number that is not finite and positive.
    pub fn absolute(length: f64) -> Result<Self, ToleranceError> {
        Self::new(length, Unit::Absolute)
    }

    /// A fraction of the diagonal of the box around the object's photosurface, at each step.
    ///
    /// # Errors
    ///
    /// A number that is not finite and positive.
    pub fn relative(fraction: f64) -> Result<Self, ToleranceError> {
        Self::new(fraction, Unit::Relative)
    }

    /// An angle seen by the observer.
    ///
    /// # Errors
    ///
    /// A number that is not positive and at most 90.
    pub fn degrees(degrees: f64) -> Result<Self, ToleranceError> {
        Self::new(degrees, Unit::Degrees)
    }

    /// The number, in its unit.
    pub fn number(self) -> f64 {
        self.number
    }

    /// What the number is.
    pub fn unit(self) -> Unit {
        self.unit
    }

    /// The tolerance `factor` times as large, or the nearest that is one.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let most = match self.unit {
            Unit::Degrees => MAX_DEGREES,
            _ => f64::MAX,
        };
        // Not `clamp`, which lets NaN through.
        let number = (self.number * factor).max(MIN).min(most);
        Self { number, ..self }
    }
}

impl fmt::Display for Tolerance {
    /// As the command line takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let prefix = match self.unit {
            Unit::Absolute => "abs:",
            Unit::Relative => "",
            Unit::Degrees => "deg:",
        };
        write!(f, "{prefix}{:.3e}", self.number)
    }
}

impl<'de> Deserialize<'de> for Tolerance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ToleranceVisitor;
        impl<'de> Visitor<'de> for ToleranceVisitor {
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
                    "absolute" => Tolerance::absolute,
                    "relative" => Tolerance::relative,
                    "angle_deg" => Tolerance::degrees,
                    _ => {
                        return Err(A::Error::custom(format_args!(
                            "unknown unit `{unit}` of a tolerance, expected {EXPECTED}"
                        )));
                    }
                };
                let tolerance = tolerance(map.next_value()?).map_err(A::Error::custom)?;
                match map.next_key::<String>()? {
                    None => Ok(tolerance),
                    Some(second) => Err(A::Error::custom(format_args!(
                        "both `{unit}` and `{second}` in a tolerance, expected {EXPECTED}"
                    ))),
                }
            }
        }
        deserializer.deserialize_any(ToleranceVisitor)
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
        for (text, tolerance) in [
            (r#"{"absolute": 2}"#, Tolerance::absolute(2.0)),
            (r#"{"relative": 1e-4}"#, Tolerance::relative(1e-4)),
            (r#"{"angle_deg": 90}"#, Tolerance::degrees(90.0)),
        ] {
            assert_eq!(read(text).unwrap(), tolerance.unwrap());
        }
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

    #[test]
    fn no_tolerance_holds_a_number_that_makes_no_sense() {
        let odd = [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        for unit in [Unit::Absolute, Unit::Relative, Unit::Degrees] {
            for number in odd {
                assert!(Tolerance::new(number, unit).is_err(), "{number} {unit}");
            }
            for number in [MIN, 1e-3, 90.0] {
                let tolerance = Tolerance::new(number, unit).unwrap();
                for factor in odd.into_iter().chain([1e-300, 1e300, f64::MAX]) {
                    let times = tolerance.times(factor);
                    assert_eq!(Tolerance::new(times.number(), unit), Ok(times));
                }
            }
        }
        assert!(Tolerance::degrees(90.1).is_err());
    }
}
