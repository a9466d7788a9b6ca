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
        let sides = [0, 1, 2].map(|axis| [[low[axis]], [high[axis]]]);
        let [near] = self.enters_each(&sides);
        (!near.is_nan()).then_some(near)
    }

    /// The distances at which the ray enters boxes whose lower and upper sides are given for each axis; NaN for those that
    /// it does not enter.
    #[inline(always)]
    pub(super) fn enters_each<const N: usize>(&self, sides: &[[[f64; N]; 2]; 3]) -> [f64; N] {
        let (mut near, mut far) = ([0.0; N], [f64::INFINITY; N]);
        for (axis, sides) in sides.iter().enumerate() {
            let inverse = self.inverse[axis];
            let origins = [self.origin_for_low[axis], self.origin_for_high[axis]];
            let first = usize::from(inverse < 0.0);
            let last = 1 - first;
            let (firsts, lasts) = (&sides[first], &sides[last]);
            for k in 0..N {
                // 0 * infinity, a ray within a face of the box, is NaN, and no limit.
                let enters = (firsts[k] - origins[first]) * inverse;
                let leaves = (lasts[k] - origins[last]) * inverse;
                near[k] = if enters > near[k] { enters } else { near[k] };
                far[k] = if leaves < far[k] { leaves } else { far[k] };
            }
        }
        for k in 0..N {
            let is_entered = near[k] <= far[k] * FAR_MARGIN;
            near[k] = if is_entered { near[k] } else { f64::NAN };
        }
        near
    }
}
