//! The photosurface map without branches, for many points at a time; the points must be in the safe range, neither tiny
//! nor huge.

use glam::DVec3;

use crate::spacetime::exact::{Product, cross_by};
use crate::spacetime::{Velocity, heading};

/// Largest and smallest size of an offset in the safe range, and largest stretch `exp(eta)` of a velocity. In this
/// range no square overflows, and none that affects the result vanishes.
const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);
const SMALLEST: f64 = 1.0 / LARGEST;

/// The map of one observer for points in the safe range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SafeRangeMap {
    direction: DVec3,
    /// The direction of motion as the caller gave it, not rounded to unit length, scaled by a power of two so that its
    /// largest component is from 1 up to 2.
    heading: DVec3,
    /// Inverse of the length of `heading`.
    inverse_length: f64,
    /// `exp(eta)`
    stretch: f64,
    /// `exp(-eta)`
    squeeze: f64,
    gamma_beta: f64,
}

/// How the observer sees a point, before the rotation of the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenPoint {
    pub(super) position: DVec3,
    /// The distance `|position|` at which the point is seen.
    pub(super) distance: f64,
    /// A measure of the angle from the direction of motion, from 0 straight behind to 2 straight ahead; see
    /// [`forwardness`].
    pub(super) lean: f64,
    /// The part of the offset across the motion, and the length of the whole offset, both in the rest frame.
    pub(super) across: DVec3,
    pub(super) distance_at_rest: f64,
}

impl SafeRangeMap {
    /// `None` if the velocity has no direction or is too fast for the safe range.
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

    /// How the observer sees the point with this `offset` from the observer, in the rest frame.
    ///
    /// # Derivation
    ///
    /// The map only multiplies `u = r - d_par` and `w = r + d_par`. The smaller of the two is computed from
    /// `u w = |across|^2`. The part across the motion is computed by error-free products with the heading as the caller
    /// gave it, because close behind a fast observer the result depends on that part alone.
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
            // For an observer at rest a point is seen exactly where it is, to the last bit.
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

    /// The unit normal of the photosurface where the point is seen, from the surface's normal `normal_rest` in the rest
    /// frame, which must be in the safe range. A zero normal stays zero.
    ///
    /// # Derivation
    ///
    /// See [`PhotosurfaceMap::seen_normal`](super::PhotosurfaceMap::seen_normal).
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

/// `sqrt(w / u)`, the cotangent of half the angle from the direction of motion. The argument `lean` is `w / u` where
/// that is below 1, and `2 - u / w` elsewhere, so that it grows with `w / u`. It loses no digits near straight behind,
/// where the stretch depends on them.
pub(super) fn forwardness(lean: f64) -> f64 {
    if lean <= 1.0 {
        lean.sqrt()
    } else {
        (2.0 - lean).sqrt().recip()
    }
}

/// Whether a vector of this [`size`] is in the safe range; false for NaN.
#[inline(always)]
pub(super) fn is_in_safe_range(size: f64) -> bool {
    (SMALLEST..=LARGEST).contains(&size)
}

/// The size of a vector: the sum of the absolute values of its coordinates; NaN if one of them is NaN.
#[inline(always)]
pub(super) fn size(vector: DVec3) -> f64 {
    vector.x.abs() + vector.y.abs() + vector.z.abs()
}
