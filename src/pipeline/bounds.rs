//! A box with edges along the axes, as files and reports tell it.

use glam::DVec3;
use schemars::JsonSchema;
use serde::Serialize;

/// The box around some vertices, in scene units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Bounds {
    /// The smallest coordinates.
    pub low: [f64; 3],
    /// The largest coordinates.
    pub high: [f64; 3],
    /// The middle of the box.
    pub centre: [f64; 3],
    /// The lengths of the edges of the box.
    pub size: [f64; 3],
}

impl Bounds {
    /// The box between two corners.
    pub fn new((low, high): (DVec3, DVec3)) -> Self {
        Self {
            low: low.to_array(),
            high: high.to_array(),
            // Each number is halved first, because the sum of two large numbers may overflow.
            centre: (low / 2.0 + high / 2.0).to_array(),
            size: (high - low).min(DVec3::MAX).to_array(),
        }
    }

    /// The box around both.
    pub fn joined(self, other: Self) -> Self {
        let corners = |bounds: Self| (DVec3::from(bounds.low), DVec3::from(bounds.high));
        let ((low, high), (other_low, other_high)) = (corners(self), corners(other));
        Self::new((low.min(other_low), high.max(other_high)))
    }
}
