//! The observer's camera, as a file holds it.

use glam::DQuat;

/// A perspective camera at the observer's place, which is the origin of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct ObserverCamera {
    /// The name of the camera: a name that no mesh of the file has.
    pub name: String,
    /// Angle from the lower to the upper edge of the picture, in radians, above 0 and below pi.
    pub vertical_fov_rad: f64,
    /// Width of the picture divided by its height.
    pub aspect: f64,
    /// The depths along the direction in which the camera looks, in scene units, between which it sees anything.
    pub depths: [f64; 2],
    /// For each step of the scene, the rotation from the camera's own axes (x right, y up, looking along -z) to the
    /// observer's.
    pub rotations: Vec<DQuat>,
}

impl ObserverCamera {
    /// Whether the camera looks in the same direction at every step.
    pub(super) fn holds(&self) -> bool {
        self.rotations.windows(2).all(|pair| pair[0] == pair[1])
    }
}
