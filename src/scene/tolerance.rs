//! How far a photosurface may be from the true one.

use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

/// How far, at most, a mesh is to be from the true photosurface.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "ToleranceForm")]
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
    /// Zero, negative or not finite.
    #[error("the tolerance is {0}, expected a finite number > 0")]
    Number(f64),
    /// An angle that says nothing.
    #[error("the tolerance is {0} degrees, expected an angle from 0 to 90 degrees")]
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
            _ if !(number > 0.0 && number.is_finite()) => Err(ToleranceError::Number(number)),
            Self::Angle(degrees) if degrees > 90.0 => Err(ToleranceError::Angle(degrees)),
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

impl std::fmt::Display for Tolerance {
    /// As the command line takes it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Absolute(length) => write!(f, "abs:{length:.3e}"),
            Self::Relative(fraction) => write!(f, "{fraction:.3e}"),
            Self::Angle(degrees) => write!(f, "deg:{degrees:.3e}"),
        }
    }
}

/// A tolerance, given in exactly one of three ways.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum ToleranceForm {
    /// A length in the observer's frame, > 0.
    Absolute(f64),
    /// A fraction of the diagonal of the box around the object's photosurface, at each step, > 0.
    Relative(f64),
    /// An angle seen by the observer, in degrees, from 0 to 90.
    AngleDeg(f64),
}

impl TryFrom<ToleranceForm> for Tolerance {
    type Error = ToleranceError;

    fn try_from(form: ToleranceForm) -> Result<Self, ToleranceError> {
        match form {
            ToleranceForm::Absolute(length) => Self::Absolute(length),
            ToleranceForm::Relative(fraction) => Self::Relative(fraction),
            ToleranceForm::AngleDeg(degrees) => Self::Angle(degrees),
        }
        .checked()
    }
}
