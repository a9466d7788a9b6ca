//! The photosurface map without a branch, for points that are neither tiny nor huge: many at a time.

use glam::DVec3;

use crate::spacetime::exact::{Product, cross_by};
use crate::spacetime::{Velocity, heading};

/// Up to here offsets and what velocities stretch may be, and down to the inverse, so that no square overflows and none
/// vanishes that counts.
const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);
const SMALLEST: f64 = 1.0 / LARGEST;

/// One observer's map, ready for points from which all products can be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SafeRangeMap {
    direction: DVec3,
    /// The same as it was given, its largest component from 1 up to 2.
    heading: DVec3,
    /// Of the heading's length.
    inverse_length: f64,
    /// `exp(eta)`
    stretch: f64,
    /// `exp(-eta)`
    squeeze: f64,
    gamma_beta: f64,
}

/// How a point is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenPoint {
    pub(super) position: DVec3,
    /// How far away: `|position|`.
    pub(super) distance: f64,
    /// From 0 straight behind to 2 straight ahead: see [`forwardness`].
    pub(super) lean: f64,
    /// At rest: the part of the offset across the motion, and its length.
    pub(super) across: DVec3,
    pub(super) distance_at_rest: f64,
}

impl SafeRangeMap {
    /// `None` where the velocity is none to take all products with, or there is none.
    pub(super) fn new(observer: &Velocity) -> Option<Self> {
        let heading = heading(observer.heading())?;
        let stretch = observer.stretch();
        (stretch <= LARGEST).then(|| Self {
            direction: observer.direction(),
            heading,
            inverse_length: heading.length().recip(),
            stretch,
            squeeze: stretch.recip(),
            gamma_beta: observer.gamma_beta(),
        })
    }

    /// Where and how the point at `offset` from the observer is seen.
    ///
    /// # Derivation
    ///
    /// In `u = r - d_par` and `w = r + d_par` the map only multiplies. The smaller of the two comes from
    /// `u w = |across|^2`, and the part across from error-free products with the heading as it was given: close behind a
    /// fast observer all of what is seen depends on it.
    #[inline(always)]
    pub(super) fn see<P: Product>(&self, offset: DVec3) -> SeenPoint {
        let sideways = cross_by::<P>(self.heading, offset) * self.inverse_length;
        let across = sideways.cross(self.heading) * self.inverse_length;
        let across_squared = sideways.length_squared();
        let parallel = self.direction.dot(offset);
        let distance_at_rest = (parallel * parallel + across_squared).sqrt();
        let larger = distance_at_rest + parallel.abs();
        let inverse = larger.recip();
        let smaller = across_squared * inverse;
        let ratio = smaller * inverse;
        let ahead = parallel > 0.0;
        let (w, u) = if ahead {
            (larger, smaller)
        } else {
            (smaller, larger)
        };
        let (seen_w, seen_u) = (w * self.stretch, u * self.squeeze);
        let position = across + self.direction * (0.5 * (seen_w - seen_u));
        SeenPoint {
            // At rest everything is where it is, to the last bit.
            position: if self.stretch == 1.0 {
                offset
            } else {
                position
            },
            distance: 0.5 * (seen_w + seen_u),
            lean: if ahead { 2.0 - ratio } else { ratio },
            across,
            distance_at_rest,
        }
    }

    /// The unit normal where a point is seen, of a surface with this normal at rest, neither tiny nor huge; zero where
    /// that is zero.
    ///
    /// # Derivation
    ///
    /// That of [`PhotosurfaceMap::seen_normal`](super::PhotosurfaceMap::seen_normal).
    #[inline(always)]
    pub(super) fn seen_normal(&self, seen_point: &SeenPoint, normal_rest: DVec3) -> DVec3 {
        let inverse_distance = seen_point.distance_at_rest.recip();
        let doppler_factor = seen_point.distance * inverse_distance;
        let toward_across = seen_point.across * inverse_distance;
        let along = self.direction.dot(normal_rest);
        let across = normal_rest - self.direction * along;
        let normal =
            across * doppler_factor + (self.direction - toward_across * self.gamma_beta) * along;
        let square = normal.length_squared();
        // A zero vector times a finite number stays zero.
        let square = if square > 0.0 { square } else { 1.0 };
        normal * square.sqrt().recip()
    }
}

/// `sqrt(w / u)`, the cotangent of half the angle from the direction of motion, from `w / u` below 1 and `2 - u / w`
/// above: they grow together, and no digit is lost near straight behind, where stretching depends on it.
pub(super) fn forwardness(lean: f64) -> f64 {
    if lean <= 1.0 {
        lean.sqrt()
    } else {
        (2.0 - lean).sqrt().recip()
    }
}

/// Whether all products can be taken with what is this size: the sum of its coordinates' sizes. Not with NaN.
#[inline(always)]
pub(super) fn is_in_safe_range(size: f64) -> bool {
    (SMALLEST..=LARGEST).contains(&size)
}

/// The sum of the sizes of the coordinates; NaN if one is.
#[inline(always)]
pub(super) fn size(vector: DVec3) -> f64 {
    vector.x.abs() + vector.y.abs() + vector.z.abs()
}
