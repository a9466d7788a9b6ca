//! How things and axes are turned.

use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{exact, unit};

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

/// Why two directions do not make a [`Rotation`].
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "look is {look} and up is {up}, expected two finite directions that are not along one line"
)]
pub struct LookingError {
    look: DVec3,
    up: DVec3,
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

    /// The rotation of a quaternion of any length but zero.
    pub(super) fn of_any_length(quaternion: DQuat) -> Self {
        Self(quaternion.normalize())
    }

    /// The rotation of an observer who looks in the direction `look`, with `up` above: its own -z axis is along `look`, its
    /// own y axis in the plane of both.
    ///
    /// # Errors
    ///
    /// A direction that is zero or not finite, or two along one line.
    pub fn looking(look: DVec3, up: DVec3) -> Result<Self, LookingError> {
        let (Some(ahead), Some(above)) = (unit(look), unit(up)) else {
            return Err(LookingError { look, up });
        };
        let right = unit(exact::cross(ahead, above)).ok_or(LookingError { look, up })?;
        let axes = DMat3::from_cols(right, right.cross(ahead), -ahead);
        Ok(Self::of_any_length(DQuat::from_mat3(&axes)))
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
