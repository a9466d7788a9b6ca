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
pub(super) struct PlainMap {
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
pub(super) struct Sighting {
    pub(super) position: DVec3,
    /// How far away: `|position|`.
    pub(super) distance: f64,
    /// `w / u`, the square of the cotangent of half the angle from the direction of motion.
    pub(super) forwardness_squared: f64,
    /// The part across the motion of the direction in which the point is at rest.
    pub(super) toward_across: DVec3,
    pub(super) doppler_factor: f64,
}

impl PlainMap {
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
    pub(super) fn see<P: Product>(&self, offset: DVec3) -> Sighting {
        let sideways = cross_by::<P>(self.heading, offset) * self.inverse_length;
        let across = sideways.cross(self.heading) * self.inverse_length;
        let across_squared = sideways.length_squared();
        let parallel = self.direction.dot(offset);
        let distance_at_rest = (parallel * parallel + across_squared).sqrt();
        let larger = distance_at_rest + parallel.abs();
        let smaller = across_squared / larger;
        let ahead = parallel > 0.0;
        let (w, u) = if ahead {
            (larger, smaller)
        } else {
            (smaller, larger)
        };
        let (seen_w, seen_u) = (w * self.stretch, u * self.squeeze);
        let distance = 0.5 * (seen_w + seen_u);
        let inverse_distance = distance_at_rest.recip();
        let position = across + self.direction * (0.5 * (seen_w - seen_u));
        Sighting {
            // At rest everything is where it is, to the last bit.
            position: if self.stretch == 1.0 {
                offset
            } else {
                position
            },
            distance,
            forwardness_squared: w / u,
            toward_across: across * inverse_distance,
            doppler_factor: distance * inverse_distance,
        }
    }

    /// The unit normal where a point is seen, of a surface with this normal at rest, neither tiny nor huge; zero where
    /// that is zero.
    ///
    /// # Derivation
    ///
    /// That of [`PhotosurfaceMap::seen_normal`](super::PhotosurfaceMap::seen_normal).
    #[inline(always)]
    pub(super) fn seen_normal(
        &self,
        toward_across: DVec3,
        doppler_factor: f64,
        normal_rest: DVec3,
    ) -> DVec3 {
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

/// Whether all products can be taken with what is this size: the sum of its coordinates' sizes. Not with NaN.
#[inline(always)]
pub(super) fn is_plain(size: f64) -> bool {
    (SMALLEST..=LARGEST).contains(&size)
}

/// The sum of the sizes of the coordinates; NaN if one is.
#[inline(always)]
pub(super) fn size(vector: DVec3) -> f64 {
    vector.x.abs() + vector.y.abs() + vector.z.abs()
}
