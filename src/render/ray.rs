//! Rays, prepared for many boxes and triangles.
//!
//! The triangle test is that of Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection* (JCGT 2013): the
//! ray is sheared into an axis, and each edge is judged by the same product from both of its sides, so that no
//! ray slips through between two triangles.

use glam::DVec3;

/// What three divisions, subtractions and products may round by, twice over (Ize, *Robust BVH Ray Traversal*, JCGT
/// 2013).
const FAR_MARGIN: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A ray prepared for many boxes and triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// The axis closest to the direction, and the other two, so that handedness is kept.
    axes: [usize; 3],
    shear: DVec3,
}

impl Ray {
    /// `direction` need not be of unit length, distances are in units of it; it is not zero.
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Self {
        let z = direction.abs().max_position();
        let (x, y) = match direction[z] < 0.0 {
            true => ((z + 2) % 3, (z + 1) % 3),
            false => ((z + 1) % 3, (z + 2) % 3),
        };
        let along = direction[z];
        Self {
            origin,
            direction,
            axes: [x, y, z],
            shear: DVec3::new(direction[x] / along, direction[y] / along, 1.0 / along),
        }
    }

    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    pub(super) fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Distance and weights of the hit with a triangle, and whether it is seen from outside.
    pub(super) fn meets(&self, corners: [DVec3; 3]) -> Option<(f64, [f64; 3], bool)> {
        let [x, y, z] = self.axes;
        let sheared = corners.map(|corner| {
            let from_origin = corner - self.origin;
            DVec3::new(
                from_origin[x] - self.shear.x * from_origin[z],
                from_origin[y] - self.shear.y * from_origin[z],
                self.shear.z * from_origin[z],
            )
        });
        let [a, b, c] = sheared;
        let areas = [
            c.x * b.y - c.y * b.x,
            a.x * c.y - a.y * c.x,
            b.x * a.y - b.y * a.x,
        ];
        let negative = areas.iter().any(|&area| area < 0.0);
        let positive = areas.iter().any(|&area| area > 0.0);
        if negative && positive {
            return None;
        }
        let sum = areas[0] + areas[1] + areas[2];
        if sum == 0.0 {
            return None;
        }
        let weights = areas.map(|area| area / sum);
        let distance = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
        Some((distance, weights, sum > 0.0))
    }
}

/// A ray prepared for boxes that are all larger than they say by one length on all sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slabs {
    /// The origin moved by that length: what lower and upper sides are told by.
    origin_for_low: DVec3,
    origin_for_high: DVec3,
    inverse: DVec3,
}

impl Slabs {
    pub(super) fn new(origin: DVec3, direction: DVec3, margin: f64) -> Self {
        Self {
            origin_for_low: origin + margin,
            origin_for_high: origin - margin,
            inverse: direction.recip(),
        }
    }

    /// The distance at which the ray enters the box, if it does.
    pub(super) fn enters(&self, low: DVec3, high: DVec3) -> Option<f64> {
        let to_low = (low - self.origin_for_low) * self.inverse;
        let to_high = (high - self.origin_for_high) * self.inverse;
        // 0 * infinity, a ray within a face of the box, is NaN: both functions prefer the other number.
        let span = |axis: usize| {
            (
                to_low[axis].min(to_high[axis]),
                to_low[axis].max(to_high[axis]),
            )
        };
        let ((near_x, far_x), (near_y, far_y), (near_z, far_z)) = (span(0), span(1), span(2));
        let near = near_x.max(near_y).max(near_z).max(0.0);
        let far = far_x.min(far_y).min(far_z) * FAR_MARGIN;
        (near <= far).then_some(near)
    }
}
