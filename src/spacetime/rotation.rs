//! How things and axes are turned.

use glam::DQuat;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Lengths that differ from 1 by more are no rounding.
const ROUNDING: f64 = 1e-3;

/// A rotation: a unit quaternion, as exact as numbers are.
#[derive(Clone, Copy, Debug, PartialEq, Default, Deserialize, Serialize)]
#[serde(try_from = "[f64; 4]")]
pub struct Rotation(DQuat);

/// Why a quaternion is not a [`Rotation`].
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the rotation {components:?} has length {length}, expected a unit quaternion [x, y, z, w]")]
pub struct RotationError {
    components: [f64; 4],
    length: f64,
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Self = Self(DQuat::IDENTITY);

    /// The rotation of a quaternion, which is brought to unit length.
    ///
    /// # Errors
    ///
    /// A length that differs from 1 by more than a thousandth, or is not a number.
    pub fn new(quaternion: DQuat) -> Result<Self, RotationError> {
        let length = quaternion.length();
        if (length - 1.0).abs() <= ROUNDING {
            Ok(Self(quaternion.normalize()))
        } else {
            Err(RotationError {
                components: quaternion.to_array(),
                length,
            })
        }
    }

    /// The unit quaternion.
    pub fn get(self) -> DQuat {
        self.0
    }
}

impl TryFrom<[f64; 4]> for Rotation {
    type Error = RotationError;

    fn try_from(components: [f64; 4]) -> Result<Self, RotationError> {
        Self::new(DQuat::from_array(components))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_stretches_nothing() {
        let turned = DQuat::from_xyzw(0.1, -0.7, 0.5, 0.5).normalize();
        for stretch in [0.9991, 1.0, 1.0009] {
            let rotation = Rotation::new(turned * stretch).unwrap().get();
            assert!((rotation.length() - 1.0).abs() < 1e-15);
        }
        for stretch in [2f64.sqrt(), 0.5, 0.0, 1e300, f64::INFINITY, f64::NAN] {
            assert!(Rotation::new(turned * stretch).is_err(), "{stretch}");
        }
    }
}
