//! Where a shape without facets stands, and what rays meet of it.

use glam::{DAffine3, DVec2, DVec3};

/// How a shape that is given in coordinates of its own is turned, stretched and moved.
pub(super) struct ShapePlacement {
    to_model: DAffine3,
    /// Centre and radius of a ball around it.
    around: (DVec3, f64),
}

/// Where a ray meets a surface that has no facets.
pub(super) struct SmoothHit {
    pub(super) distance: f64,
    /// Outwards, of any length.
    pub(super) normal: DVec3,
    pub(super) texture: DVec2,
}

impl ShapePlacement {
    /// A shape that is within `radius` of its origin.
    pub(super) fn new(radius: f64, model_to_rest: DAffine3) -> Self {
        let stretch = model_to_rest.matrix3;
        // Axes stay at right angles: nothing is stretched by more than the longest of them.
        let longest = [stretch.x_axis, stretch.y_axis, stretch.z_axis].map(DVec3::length);
        let longest = longest.into_iter().fold(0.0, f64::max);
        Self {
            to_model: model_to_rest.inverse(),
            around: (model_to_rest.translation, radius * longest),
        }
    }

    pub(super) fn around(&self) -> (DVec3, f64) {
        self.around
    }

    /// Origin and direction of a ray in the shape's own coordinates; distances in units of the direction stay.
    pub(super) fn ray_to_model(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        let direction_model = self.to_model.matrix3 * direction;
        (self.to_model.transform_point3(origin), direction_model)
    }

    /// What a normal in the shape's own coordinates is, of any length.
    pub(super) fn normal_to_rest(&self, normal_model: DVec3) -> DVec3 {
        self.to_model.matrix3.transpose() * normal_model
    }
}
