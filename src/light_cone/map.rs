//! The photosurface map: where one moving observer sees a point at rest.
//!
//! This file uses two frames. In the *rest frame* of the object, `offset` is the vector from the observer's position at
//! the moment of observation to the point. The *observer's frame* has the observer at its origin and axes that a pure
//! boost makes from those of the rest frame.
//!
//! Let `d` be the offset, `r` its length, `d_par` its component along the direction of motion, and `eta` the observer's
//! rapidity. The map only multiplies the light-cone coordinates `u = r - d_par` and `w = r + d_par`, by `exp(-eta)` and
//! `exp(eta)`. All results are computed from `u` and `w`, because nothing cancels in them near the speed of light.
//!
//! Sources: Rau, Weiskopf, Ruder, *Special Relativity in Virtual Reality* (1998), sections 3.1 and 4.1
//! (their Eq. (7) with the opposite sign of beta); Terrell, Phys. Rev. 116 (1959), 1041.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::safe_range::{SafeRangeMap, is_in_safe_range, size};
use crate::spacetime::exact::Split;
use crate::spacetime::{Velocity, exact, harmless_scale, heading, length, unit};

/// The map from points in the rest frame to the positions, in the observer's frame, where one moving observer sees
/// them.
///
/// The map is homogeneous of degree 1, one-to-one, linear along every ray from the observer, and smooth except at the
/// observer. An offset that is not finite gives results that are not finite, and never a panic.
///
/// # Example
///
/// ```
/// use photosurface::light_cone::PhotosurfaceMap;
/// use photosurface::{DVec3, Velocity};
///
/// // A point 3 ahead of an observer who moves towards it at 0.8 c is seen 9 ahead.
/// let observer = Velocity::from_beta(0.8, DVec3::X)?;
/// let seen = PhotosurfaceMap::new(&observer).seen_position(DVec3::new(3.0, 0.0, 0.0));
/// assert!((seen - DVec3::new(9.0, 0.0, 0.0)).length() < 1e-14);
/// # Ok::<(), photosurface::spacetime::VelocityError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotosurfaceMap {
    /// Unit vector along which the observer moves through the rest frame, rounded.
    direction: DVec3,
    /// The same direction as the caller gave it, of any length and not rounded.
    heading: DVec3,
    heading_length: f64,
    /// `exp(eta)`
    stretch: f64,
    /// `exp(-eta)`
    squeeze: f64,
    gamma: f64,
    gamma_beta: f64,
    /// The map for points that are neither tiny nor huge.
    safe_map: Option<SafeRangeMap>,
}

/// Offsets larger than this are divided by [`BACK`], because their squares and sums might overflow.
const HUGE: f64 = 1e140;
const BACK: f64 = f64::from_bits((1023 + 600) << 52);

/// An offset in light-cone coordinates along the direction of motion, `u = r - d_par` and `w = r + d_par`.
struct LightCone {
    /// The part of the offset across the direction of motion, and the length of this part.
    across: DVec3,
    distance_across: f64,
    /// Whether the point is ahead of the observer; then `w` is the larger of the two coordinates.
    ahead: bool,
    larger: f64,
    /// The smaller coordinate divided by `distance_across`.
    ratio: f64,
}

impl LightCone {
    /// `factor u`
    fn u_times(&self, factor: f64) -> f64 {
        self.times(factor, !self.ahead)
    }

    /// `factor w`
    fn w_times(&self, factor: f64) -> f64 {
        self.times(factor, self.ahead)
    }

    fn times(&self, factor: f64, larger: bool) -> f64 {
        if larger {
            factor * self.larger
        } else {
            // The product `ratio * distance_across` is `u` and must not be computed first, because it may underflow:
            // for a point 1e152 ahead and 1 aside `u` is 1e-152, and for an observer at rapidity 700, twice the largest
            // that may be given, the seen `u` underflows.
            (factor * self.ratio) * self.distance_across
        }
    }

    /// The distance from the observer in the rest frame.
    fn distance(&self) -> f64 {
        0.5 * self.larger + 0.5 * self.times(1.0, false)
    }
}

impl PhotosurfaceMap {
    /// The map for an observer who moves with the velocity `observer` in the rest frame.
    pub fn new(observer: &Velocity) -> Self {
        Self {
            direction: observer.direction(),
            heading: observer.heading(),
            heading_length: observer.heading().length(),
            stretch: observer.stretch(),
            squeeze: 1.0 / observer.stretch(),
            gamma: observer.gamma(),
            gamma_beta: observer.gamma_beta(),
            safe_map: SafeRangeMap::new(observer),
        }
    }

    /// The map without branches, if the velocity allows it. The results are the same, bit for bit, for all points that
    /// are neither tiny nor huge.
    pub(super) fn safe_range_map(&self) -> Option<&SafeRangeMap> {
        self.safe_map.as_ref()
    }

    /// Where a point is seen: the position of the emission event in the observer's frame.
    ///
    /// # Derivation
    ///
    /// In the rest frame the light seen now left the point a time `r = |d|` ago, at the event `(-r, d)`. The boost to
    /// the observer's frame only multiplies the light-cone coordinates `(r - d_par, r + d_par)` by `exp(-eta)` and
    /// `exp(eta)`.
    ///
    /// # Accuracy
    ///
    /// The error is at most 8 units in the last place of `|result|`, in any direction and at any rapidity, also
    /// straight behind the observer and near that direction, where all but `exp(-2 eta)` of a distance cancels
    /// (measured: 2.8 in `tests/it/physics/accuracy.rs` and `tests/it/physics/hard_cases.rs`). The error is relative to
    /// a direction of motion as the caller gave it, brought to unit length exactly. The map is continuous everywhere
    /// and sends the observer's position to zero. A coordinate beyond `f64` becomes infinite, never NaN.
    ///
    /// # Reference
    ///
    /// Rau, Weiskopf, Ruder (1998), section 3.1.
    pub fn seen_position(&self, offset_rest: DVec3) -> DVec3 {
        match self.scaled_to_safe_range(offset_rest) {
            Some((safe_map, offset, scale)) => safe_map.see::<Split>(offset).position * scale,
            None => self.map(offset_rest, self.squeeze, self.stretch),
        }
    }

    /// The offset, in the rest frame, of the point that is seen at the position `seen` in the observer's frame: the
    /// inverse of [`PhotosurfaceMap::seen_position`].
    pub fn rest_offset(&self, seen: DVec3) -> DVec3 {
        self.map(seen, self.stretch, self.squeeze)
    }

    /// The map without branches, the offset divided by a power of two that brings it into the safe range, and that
    /// power; `None` if the velocity or the offset does not allow it.
    fn scaled_to_safe_range(&self, offset: DVec3) -> Option<(&SafeRangeMap, DVec3, f64)> {
        let safe_map = self.safe_map.as_ref()?;
        if is_in_safe_range(size(offset)) {
            return Some((safe_map, offset, 1.0));
        }
        let largest = offset.abs().max_element();
        let is_normal = offset.is_finite() && largest >= f64::MIN_POSITIVE;
        let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
        is_normal.then(|| (safe_map, offset / power, power))
    }

    fn map(&self, offset: DVec3, factor_u: f64, factor_w: f64) -> DVec3 {
        if factor_u == factor_w {
            // For an observer at rest a point is seen exactly where it is, to the last bit.
            return offset;
        }
        let (cone, back) = self.light_cone(offset);
        let along = 0.5 * (cone.w_times(factor_w) - cone.u_times(factor_u));
        // A result beyond f64 has to overflow to infinity, not to the NaN of zero times infinity.
        let along = along.clamp(f64::MIN, f64::MAX);
        (cone.across + self.direction * along) * back
    }

    /// The time of the emission event in the observer's frame, counted from the observation. It equals the distance at
    /// which the point is seen, with a minus sign: zero at the observer, negative elsewhere.
    pub fn emission_time(&self, offset_rest: DVec3) -> f64 {
        let (cone, back) = self.light_cone(offset_rest);
        -0.5 * (cone.w_times(self.stretch) + cone.u_times(self.squeeze)) * back
    }

    /// The Doppler factor, the frequency seen divided by the frequency emitted: `D = gamma (1 + beta cos)`, with the
    /// cosine of the angle between the offset and the direction of motion, in the rest frame.
    ///
    /// It is also `|seen_position| / |offset|` and the determinant of [`PhotosurfaceMap::jacobian`]. At the observer,
    /// where it depends on the direction, the result is its mean over all directions, `gamma`.
    pub fn doppler_factor(&self, offset_rest: DVec3) -> f64 {
        let (cone, _) = self.light_cone(offset_rest);
        if cone.larger == 0.0 {
            return self.gamma;
        }
        self.doppler_factor_of(&cone)
    }

    /// The derivative of [`PhotosurfaceMap::seen_position`]: the matrix `I + n a^T` with the direction of motion `n`
    /// and `a = (gamma - 1) n + gamma beta d / r`.
    ///
    /// It is computed as `(I - n n^T) + n (D n + gamma beta d_across / r)^T`. Behind the observer `n + a` cancels
    /// almost completely; the Doppler factor `D` preserves the digits of the remainder.
    ///
    /// At the observer, where the map has no derivative, the result is the matrix of the boost alone (`d / r` is set to
    /// 0).
    pub fn jacobian(&self, offset_rest: DVec3) -> DMat3 {
        let n = self.direction;
        let (toward_across, doppler_factor) = self.toward_across(offset_rest);
        let b = n * doppler_factor + toward_across * self.gamma_beta;
        let column = |axis: DVec3| (axis - n * n.dot(axis)) + n * b.dot(axis);
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }

    /// An upper bound on how many times the map stretches lengths in the ball of `radius` around `offset_rest`, both in
    /// the rest frame. It bounds the largest singular value of [`PhotosurfaceMap::jacobian`] in the ball, and therefore
    /// `|seen_position(a) - seen_position(b)| / |a - b|` for any two points `a` and `b` of the ball.
    ///
    /// The bound lies between 1, its value straight behind the observer, and `exp(eta)`, its value straight ahead and
    /// for balls that reach the observer.
    ///
    /// # Derivation
    ///
    /// One singular value is 1. The other two belong to the plane of `n` and `d`: their product is the determinant `D`,
    /// and the sum of their squares is `T`. At the angle `theta` from the direction of motion, with `C = cos(theta/2)`,
    /// `S = sin(theta/2)` and `E = exp(eta)`,
    ///
    /// ```text
    /// D = C^2 E + S^2 / E        T = C^2 E^2 + S^2 / E^2 + 1
    /// T + 2 D = C^2 (E + 1)^2 + S^2 (1 + 1/E)^2
    /// T - 2 D = C^2 (E - 1)^2 + S^2 (1 - 1/E)^2
    /// ```
    ///
    /// The larger singular value is half the sum of the square roots of `T + 2 D` and `T - 2 D`, in which nothing
    /// cancels. Both grow with `C`, so the largest value in the ball occurs at the smallest angle,
    /// `theta - asin(radius / distance)`. A ball is convex, so the mean value theorem holds in it.
    ///
    /// # Accuracy
    ///
    /// The bound is rounded up by at most 40 epsilon, relatively, at any rapidity (`tests/it/physics/accuracy.rs`). For
    /// a radius that is NaN or negative, the result is the bound that holds everywhere.
    pub fn stretch_bound(&self, offset_rest: DVec3, radius: f64) -> f64 {
        let everywhere = self.stretch * (1.0 + 4.0 * f64::EPSILON);
        let n = self.direction;
        // Only ratios matter, and scaling by a power of two loses no digits.
        let scale = harmless_scale(offset_rest);
        let offset = offset_rest * scale;
        let (cone, _) = self.light_cone(offset);
        // The angle is measured from straight behind, because the small angles occur there: they lose no digits.
        let from_behind = cone.distance_across.atan2(-n.dot(offset)) * (1.0 + 16.0 * f64::EPSILON);
        let sine = radius * scale / offset.length() * (1.0 + 8.0 * f64::EPSILON);
        let half_angle = 0.5 * (from_behind + sine.asin() * (1.0 + 4.0 * f64::EPSILON));
        // Written so that NaN, also from a sine above 1, gives the bound that holds everywhere.
        if !(half_angle < FRAC_PI_2 && sine >= 0.0) {
            return everywhere;
        }
        let (c, s) = half_angle.sin_cos();
        (self.larger_singular_value(c, s) * (1.0 + 16.0 * f64::EPSILON)).min(everywhere)
    }

    /// An upper bound on how many times the map stretches lengths of something that is first made `elongation` times as long
    /// along the motion, about the observer, in the ball of `radius` around `offset`, both before that.
    ///
    /// # Derivation
    ///
    /// With `k` the elongation, the derivative of both together is `I - n n^T + n b^T`, with `b = k D n + gamma beta s_across`
    /// and the Doppler factor `D` and the direction `s` after the elongation. Its larger singular value is half the sum of
    /// the distances of `(k D, gamma beta |s_across|)` from `(1, 0)` and from `(-1, 0)`, which grows with both coordinates.
    /// Each of them is bounded over the cylinder around the ball.
    pub(super) fn elongated_stretch_bound(
        &self,
        elongation: f64,
        offset: DVec3,
        radius: f64,
    ) -> f64 {
        let up = 1.0 + 16.0 * f64::EPSILON;
        let n = self.direction;
        let par = n.dot(offset);
        let across = n.cross(offset).length();
        let radius = radius + 8.0 * f64::EPSILON * length(offset);
        let (low, high) = (par - radius, par + radius);
        let (nearest, farthest) = ((across - radius).max(0.0), across + radius);
        // The smallest angle from the direction of motion, measured from straight behind.
        let aside = if high > 0.0 { nearest } else { farthest };
        let from_behind = aside.atan2(-elongation * high) * up;
        let (sin, cos) = (0.5 * from_behind.min(std::f64::consts::PI)).sin_cos();
        let doppler = sin * sin * self.stretch + cos * cos * self.squeeze;
        let beside = match low < 0.0 && high > 0.0 {
            true => 1.0,
            false => farthest / farthest.hypot(elongation * low.abs().min(high.abs())),
        };
        let (along, slanted) = (elongation * doppler * up, self.gamma_beta * beside * up);
        let bound = 0.5 * ((along + 1.0).hypot(slanted) + (along - 1.0).hypot(slanted));
        match bound.is_nan() {
            true => f64::INFINITY,
            false => bound * up,
        }
    }

    /// The largest singular value of [`PhotosurfaceMap::jacobian`]: how many times a small error of an offset is
    /// magnified, at most. It ranges from 1 straight behind the observer to `exp(eta)` straight ahead and at the
    /// observer.
    ///
    /// # Accuracy
    ///
    /// The error is a few units in the last place at any rapidity. The result is never above
    /// [`PhotosurfaceMap::stretch_bound`] (`tests/it/physics/accuracy.rs`).
    pub fn stretch_at(&self, offset_rest: DVec3) -> f64 {
        self.stretch_toward(self.forwardness(offset_rest))
    }

    /// The cotangent of half the angle from the direction of motion, `sqrt(w / u)`. It grows with the stretch and is
    /// cheaper to compute. It is infinite straight ahead and at the observer.
    pub(crate) fn forwardness(&self, offset_rest: DVec3) -> f64 {
        let (cone, _) = self.light_cone(offset_rest);
        if cone.ahead || cone.larger == 0.0 {
            1.0 / cone.ratio
        } else {
            cone.ratio
        }
    }

    /// [`PhotosurfaceMap::stretch_at`] for a point with this [`PhotosurfaceMap::forwardness`].
    pub(crate) fn stretch_toward(&self, forwardness: f64) -> f64 {
        let (c, s) = if forwardness <= 1.0 {
            let s = forwardness.hypot(1.0).recip();
            (forwardness * s, s)
        } else {
            let c = forwardness.recip().hypot(1.0).recip();
            (c, c / forwardness)
        };
        self.larger_singular_value(c, s).min(self.stretch).max(1.0)
    }

    /// The larger singular value of the derivation of [`PhotosurfaceMap::stretch_bound`]; `c` and `s` are the cosine
    /// and the sine of half the angle from the direction of motion.
    fn larger_singular_value(&self, c: f64, s: f64) -> f64 {
        let sum = (c * (self.stretch + 1.0)).hypot(s * (1.0 + self.squeeze));
        let difference = (c * (self.stretch - 1.0)).hypot(s * (1.0 - self.squeeze));
        0.5 * (sum + difference)
    }

    /// The unit normal of the photosurface, in the observer's frame; the surface has the normal `normal_rest` at the
    /// offset `offset_rest` in the rest frame.
    ///
    /// # Derivation
    ///
    /// The inverse transpose of the Jacobian transforms normals: `N ~ n_rest - a (n.n_rest) / D`. Split into parts
    /// along and across the motion and multiplied by `D`, this is
    /// `D n_across + (n.n_rest) (n - gamma beta d_across / r)`, where `n_across` is the part of `n_rest` across the
    /// motion. Neither of the two terms loses digits by cancellation.
    ///
    /// A zero normal stays zero.
    pub fn seen_normal(&self, offset_rest: DVec3, normal_rest: DVec3) -> DVec3 {
        if let Some((safe_map, offset, _)) = self.scaled_to_safe_range(offset_rest)
            && is_in_safe_range(size(normal_rest))
        {
            return safe_map.seen_normal(&safe_map.see::<Split>(offset), normal_rest);
        }
        let n = self.direction;
        let (toward_across, doppler_factor) = self.toward_across(offset_rest);
        let Some(normal_rest) = heading(normal_rest) else {
            return DVec3::ZERO;
        };
        let normal_par = n.dot(normal_rest);
        let normal_across = normal_rest - n * normal_par;
        let normal =
            normal_across * doppler_factor + (n - toward_across * self.gamma_beta) * normal_par;
        unit(normal).unwrap_or(DVec3::ZERO)
    }

    /// The unit tangent of the photosurface, in the observer's frame; the surface has the tangent `tangent_rest` at the
    /// offset `offset_rest` in the rest frame. The Jacobian transforms tangents. A zero tangent stays zero.
    pub fn seen_tangent(&self, offset_rest: DVec3, tangent_rest: DVec3) -> DVec3 {
        let n = self.direction;
        let (toward_across, doppler_factor) = self.toward_across(offset_rest);
        let Some(tangent_rest) = heading(tangent_rest) else {
            return DVec3::ZERO;
        };
        let tangent_par = n.dot(tangent_rest);
        let tangent_across = tangent_rest - n * tangent_par;
        let seen_par =
            doppler_factor * tangent_par + self.gamma_beta * toward_across.dot(tangent_across);
        unit(tangent_across + n * seen_par).unwrap_or(DVec3::ZERO)
    }

    /// The part of `d / r` across the motion, and the Doppler factor. At the observer the results are zero and the mean
    /// Doppler factor.
    fn toward_across(&self, offset_rest: DVec3) -> (DVec3, f64) {
        let (cone, _) = self.light_cone(offset_rest);
        let r = cone.distance();
        if r > 0.0 {
            (cone.across / r, self.doppler_factor_of(&cone))
        } else {
            (DVec3::ZERO, self.gamma)
        }
    }

    /// With `q` the ratio of `|across|` to the larger of `u` and `w`, the ratio of the smaller one to the larger one is
    /// `q^2`.
    fn doppler_factor_of(&self, cone: &LightCone) -> f64 {
        let (of_larger, of_smaller) = if cone.ahead {
            (self.stretch, self.squeeze)
        } else {
            (self.squeeze, self.stretch)
        };
        // Only ratios are used, because `squeeze * u` is zero for a subnormal `u`.
        (of_larger + (of_smaller * cone.ratio) * cone.ratio) / (1.0 + cone.ratio * cone.ratio)
    }

    /// Splits an offset into its part across the motion and its light-cone coordinates along it.
    ///
    /// The smaller of `u` and `w` is computed from `u w = |across|^2`, because a difference would lose its digits.
    /// Within 45 degrees of the line of motion the part across can lose digits as well: products with a rounded
    /// direction make its error relative to `r`, and close behind a fast observer the result depends on that part
    /// alone.
    ///
    /// Huge offsets are divided by a power of two; the second result is the factor that undoes this.
    fn light_cone(&self, offset: DVec3) -> (LightCone, f64) {
        let largest = offset.abs().max_element();
        if largest > HUGE && largest < f64::INFINITY {
            let (cone, _) = self.light_cone(offset / BACK);
            return (cone, BACK);
        }
        let n = self.direction;
        let parallel = n.dot(offset);
        let sideways = n.cross(offset);
        let distance_across = length(sideways);
        let cone = if parallel.abs() > distance_across {
            self.nearly_collinear(offset, parallel)
        } else {
            LightCone::new(sideways.cross(n), distance_across, parallel)
        };
        (cone, 1.0)
    }

    #[inline(never)]
    fn nearly_collinear(&self, offset: DVec3, parallel: f64) -> LightCone {
        let scale = harmless_scale(offset);
        let sideways = exact::cross(self.heading, offset * scale) / self.heading_length;
        let across = sideways.cross(self.heading) / (self.heading_length * scale);
        LightCone::new(across, length(sideways) / scale, parallel)
    }
}

impl LightCone {
    fn new(across: DVec3, distance_across: f64, parallel: f64) -> Self {
        let larger = parallel.hypot(distance_across) + parallel.abs();
        Self {
            across,
            distance_across,
            ahead: parallel > 0.0,
            larger,
            ratio: if larger > 0.0 {
                distance_across / larger
            } else {
                0.0
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn observer(rapidity: f64, direction: DVec3) -> PhotosurfaceMap {
        PhotosurfaceMap::new(&Velocity::from_rapidity(rapidity, direction).unwrap())
    }

    #[test]
    fn an_observer_at_rest_sees_things_where_they_are() {
        let map = observer(0.0, DVec3::new(1.0, 2.0, -3.0));
        let d = DVec3::new(0.3, -4.0, 5.0);
        assert_eq!(map.seen_position(d), d);
        assert_eq!(map.rest_offset(d), d);
        assert!((map.seen_normal(d, DVec3::Y) - DVec3::Y).length() < 4e-16);
        assert_eq!(map.doppler_factor(d), 1.0);
    }

    #[test]
    fn the_place_of_the_observer_is_a_fixed_point() {
        let map = observer(3.0, DVec3::X);
        assert_eq!(map.seen_position(DVec3::ZERO), DVec3::ZERO);
        assert_eq!(map.emission_time(DVec3::ZERO), 0.0);
        assert_eq!(map.doppler_factor(DVec3::ZERO), 3f64.cosh());
        assert!(map.jacobian(DVec3::ZERO).is_finite());
        assert!((map.seen_normal(DVec3::ZERO, DVec3::Y).length() - 1.0).abs() < 4e-16);
    }

    #[test]
    fn collinear_points_are_stretched_by_the_doppler_factor() {
        let map = observer(2.0, DVec3::Z);
        let ahead = map.seen_position(DVec3::new(0.0, 0.0, 5.0));
        let behind = map.seen_position(DVec3::new(0.0, 0.0, -5.0));
        assert_eq!(ahead, DVec3::new(0.0, 0.0, 5.0 * 2f64.exp()));
        assert_eq!(behind, DVec3::new(0.0, 0.0, -5.0 * (-2f64).exp()));
    }

    #[test]
    fn stretching_is_known_ahead_behind_aside_and_around() {
        for rapidity in [0.0, 1e-17, 1e-9, 0.7, 20.0, 350.0] {
            for direction in [DVec3::X, DVec3::NEG_Y, DVec3::Z] {
                let map = observer(rapidity, direction);
                let all = rapidity.exp();
                let aside = direction.any_orthonormal_vector();
                for scale in [1e-310, 1e-200, 1.0, 1e150] {
                    let near = |found: f64, expected: f64| {
                        let case =
                            format!("{rapidity} {direction} {scale}: {found}, not {expected}");
                        assert!(found >= expected, "{case}");
                        assert!(found <= expected * (1.0 + 40.0 * f64::EPSILON), "{case}");
                    };
                    near(map.stretch_bound(direction * scale, 0.0), all);
                    near(map.stretch_bound(direction * -scale, 0.0), 1.0);
                    near(map.stretch_bound(aside * scale, scale), all);
                    near(map.stretch_bound(direction * -scale, 2.0 * scale), all);
                }
                for (offset, radius) in [
                    (DVec3::ZERO, 0.0),
                    (DVec3::NAN, 1.0),
                    (-direction, f64::NAN),
                    (-direction, -1.0),
                    (-direction, f64::INFINITY),
                ] {
                    assert!(
                        map.stretch_bound(offset, radius) >= all,
                        "{offset} {radius}"
                    );
                }
            }
        }
    }

    /// The two singular values in the plane of `n` and `d` satisfy `s1 s2 = D` and `s1^2 + s2^2 = 2 + 2 n.a + |a|^2`,
    /// which the test checks where both have digits. On the axis and at the observer it compares with closed forms.
    /// Everywhere the stretch has to be below the bound and close to it.
    #[test]
    fn the_stretch_at_a_place_is_the_larger_singular_value() {
        for rapidity in [0.0, 1e-9, 0.7, 3.0, 20.0, 350.0] {
            let direction = DVec3::new(1.0, 2.0, -3.0);
            let map = observer(rapidity, direction);
            assert_eq!(map.stretch_at(DVec3::ZERO), map.stretch);
            assert_eq!(map.stretch_at(-direction), 1.0);
            assert!((map.stretch_at(direction) / map.stretch - 1.0).abs() <= 2.0 * f64::EPSILON);
            for step in 0..=200 {
                let angle = f64::from(step) / 200.0 * std::f64::consts::PI;
                let aside = map.direction.any_orthonormal_vector();
                let offset = (map.direction * angle.cos() + aside * angle.sin()) * 7.0;
                let (found, bound) = (map.stretch_at(offset), map.stretch_bound(offset, 0.0));
                assert!(
                    (1.0..=map.stretch).contains(&found),
                    "{rapidity} {angle}: {found}"
                );
                assert!(found <= bound && bound <= found * (1.0 + 48.0 * f64::EPSILON));
                if rapidity <= 3.0 {
                    let a = map.direction * (map.gamma - 1.0)
                        + offset / offset.length() * map.gamma_beta;
                    let trace = 2.0 + 2.0 * map.direction.dot(a) + a.length_squared();
                    let determinant = map.doppler_factor(offset);
                    let expected = found * found + (determinant / found).powi(2);
                    // Terms of the size of gamma^2 cancel in the trace.
                    let limit = 16.0 * f64::EPSILON * (2.0 + map.stretch * map.stretch);
                    assert!(
                        (trace - expected).abs() <= limit,
                        "{rapidity} {angle}: {found}"
                    );
                }
            }
        }
    }

    #[test]
    fn tiny_and_huge_offsets_scale_like_any_other() {
        let map = observer(1.5, DVec3::new(1.0, 1.0, 0.5));
        let d = DVec3::new(0.25, -0.5, 0.125);
        let seen = map.seen_position(d);
        for exponent in [-1000, -700, 500, 900] {
            let scale = 2f64.powi(exponent);
            let error = map.seen_position(d * scale) / scale - seen;
            assert!(
                error.length() <= 4e-16 * seen.length(),
                "2^{exponent}: {error}"
            );
        }
    }
}
