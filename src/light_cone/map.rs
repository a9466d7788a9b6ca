//! The photosurface map: where a point at rest is seen by one moving observer.
//!
//! Everything here is written in two frames. In the *rest frame* of the object, `offset` is a point
//! minus the observer's position at the moment of observation. The *observer's frame* has the
//! observer at its origin and axes that are related to those of the rest frame by a pure boost.
//!
//! In the light-cone coordinates `u = r - d_par`, `w = r + d_par` along the direction of motion the map
//! only multiplies, by `exp(-eta)` and `exp(eta)`; all results are written in terms of them because
//! there nothing cancels near light speed.
//!
//! Sources: Rau, Weiskopf, Ruder, *Special Relativity in Virtual Reality* (1998), sections 3.1 and 4.1
//! (their Eq. (7) with the opposite sign of beta); Terrell, Phys. Rev. 116 (1959), 1041.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::safe_range::{SafeRangeMap, is_in_safe_range, size};
use crate::spacetime::exact::Split;
use crate::spacetime::{Velocity, exact, harmless_scale, heading, length, unit};

/// The map from points at rest to the places where one moving observer sees them.
///
/// Homogeneous of degree 1, one-to-one, linear along every ray from the observer, smooth except at the
/// observer itself. An offset that is not finite gives results that are not finite, and never a panic.
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
    /// Direction in which the observer moves through the rest frame.
    direction: DVec3,
    /// The same as it was given, of any length: `direction` is rounded.
    heading: DVec3,
    heading_length: f64,
    /// `exp(eta)`
    stretch: f64,
    /// `exp(-eta)`
    squeeze: f64,
    gamma: f64,
    gamma_beta: f64,
    /// For points that are neither tiny nor huge.
    safe_map: Option<SafeRangeMap>,
}

/// Offsets larger than this are divided by [`BACK`], lest their squares and sums overflow.
const HUGE: f64 = 1e140;
const BACK: f64 = f64::from_bits((1023 + 600) << 52);

/// An offset in light-cone coordinates along the direction of motion, `u = r - d_par` and `w = r + d_par`.
struct LightCone {
    /// The part across the direction of motion, and its length.
    across: DVec3,
    distance_across: f64,
    /// Whether it is ahead of the observer: then `w` is the larger of the two.
    ahead: bool,
    larger: f64,
    /// What the distance across has to be multiplied by to give the smaller one.
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
            // Not the product first: 1e152 ahead and 1 aside `u` is 1e-152, and seen from twice as fast it vanishes.
            (factor * self.ratio) * self.distance_across
        }
    }

    /// The distance at rest.
    fn distance(&self) -> f64 {
        0.5 * self.larger + 0.5 * self.times(1.0, false)
    }
}

impl PhotosurfaceMap {
    /// The map for an observer who moves with velocity `observer` through the rest frame.
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

    /// The map without a branch, where the velocity allows that: the same results, bit for bit, for all points that are
    /// neither tiny nor huge.
    pub(super) fn safe_range_map(&self) -> Option<&SafeRangeMap> {
        self.safe_map.as_ref()
    }

    /// The place, in the observer's frame, where a point is seen: that of the emission event.
    ///
    /// # Derivation
    ///
    /// Light seen now left the point a time `r = |d|` ago, at the event `(-r, d)`. In the light-cone
    /// coordinates `(r - d_par, r + d_par)` the boost only multiplies, by `exp(-eta)` and `exp(eta)`.
    ///
    /// # Accuracy
    ///
    /// At most 8 units in the last place of `|result|`, in any direction and at any rapidity, also straight behind
    /// and next to it, where all but `exp(-2 eta)` of a distance cancels (measured: 2.8 in
    /// `tests/it/physics/accuracy.rs` and `tests/it/physics/hard_cases.rs`). The direction of motion counts as it was
    /// given, brought to unit length exactly. Continuous everywhere; the observer's own place maps to zero. Beyond what
    /// `f64` holds a coordinate becomes infinite, never NaN.
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

    /// The point at rest, relative to the observer, that is seen at `seen`: the inverse of
    /// [`PhotosurfaceMap::seen_position`].
    pub fn rest_offset(&self, seen: DVec3) -> DVec3 {
        self.map(seen, self.stretch, self.squeeze)
    }

    /// The map without a branch, an offset brought by a power of two to where it holds, and the power that makes up for
    /// that; `None` where velocity or offset are none for it.
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
            // At rest everything is where it is, to the last bit.
            return offset;
        }
        let (cone, back) = self.light_cone(offset);
        let along = 0.5 * (cone.w_times(factor_w) - cone.u_times(factor_u));
        // What is beyond f64 overflows to infinity, not to the NaN of zero times infinity.
        let along = along.clamp(f64::MIN, f64::MAX);
        (cone.across + self.direction * along) * back
    }

    /// The time of the emission event in the observer's frame, minus the distance at which the point
    /// is seen. Zero at the observer, else negative.
    pub fn emission_time(&self, offset_rest: DVec3) -> f64 {
        let (cone, back) = self.light_cone(offset_rest);
        -0.5 * (cone.w_times(self.stretch) + cone.u_times(self.squeeze)) * back
    }

    /// Frequency seen over frequency emitted, `D = gamma (1 + beta cos)`.
    ///
    /// It is also `|seen_position| / |offset|` and the determinant of [`PhotosurfaceMap::jacobian`]. At
    /// the observer itself, where it depends on the direction, its mean over all directions: `gamma`.
    pub fn doppler_factor(&self, offset_rest: DVec3) -> f64 {
        let (cone, _) = self.light_cone(offset_rest);
        if cone.larger == 0.0 {
            return self.gamma;
        }
        self.doppler_factor_of(&cone)
    }

    /// The derivative of [`PhotosurfaceMap::seen_position`]: `I + n a^T`,
    /// `a = (gamma - 1) n + gamma beta d / r`.
    ///
    /// Evaluated as `(I - n n^T) + n (D n + gamma beta d_across / r)^T`: behind the observer `a` all but
    /// cancels against `-n`, the Doppler factor `D` keeps what is left.
    ///
    /// At the observer itself, where there is none, that of the boost alone (`d / r` taken as 0).
    pub fn jacobian(&self, offset_rest: DVec3) -> DMat3 {
        let n = self.direction;
        let (toward_across, doppler_factor) = self.toward_across(offset_rest);
        let b = n * doppler_factor + toward_across * self.gamma_beta;
        let column = |axis: DVec3| (axis - n * n.dot(axis)) + n * b.dot(axis);
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }

    /// A bound of how much the map stretches anything in the ball of `radius` about `offset_rest`: of the
    /// largest singular value of [`PhotosurfaceMap::jacobian`] there, so also of
    /// `|seen_position(a) - seen_position(b)| / |a - b|` for any two points of the ball.
    ///
    /// At least 1, which it is straight behind the observer, and at most `exp(eta)`, which it is straight ahead
    /// and for balls that reach the observer.
    ///
    /// # Derivation
    ///
    /// Two singular values have the product `D`, the determinant, and the squares' sum `T` of the block
    /// along and across the motion; the third is 1. At the angle `theta` from the direction of motion,
    /// with `C = cos(theta/2)`, `S = sin(theta/2)` and `E = exp(eta)`,
    ///
    /// ```text
    /// D = C^2 E + S^2 / E        T = C^2 E^2 + S^2 / E^2 + 1
    /// T + 2 D = C^2 (E + 1)^2 + S^2 (1 + 1/E)^2
    /// T - 2 D = C^2 (E - 1)^2 + S^2 (1 - 1/E)^2
    /// ```
    ///
    /// and the larger one is half the sum of the roots of the last two, in which nothing cancels. Both grow
    /// with `C`, so the place of the ball at the smallest angle, `theta - asin(radius / distance)`, has the
    /// largest. A ball is convex, so that the mean value theorem holds on it.
    ///
    /// # Accuracy
    ///
    /// Rounded up, and by at most 40 epsilon, at any rapidity (`tests/it/physics/accuracy.rs`). NaN and negative radii
    /// get the bound that holds everywhere.
    pub fn stretch_bound(&self, offset_rest: DVec3, radius: f64) -> f64 {
        let everywhere = self.stretch * (1.0 + 4.0 * f64::EPSILON);
        let n = self.direction;
        // Only ratios count; powers of two lose no digits.
        let scale = harmless_scale(offset_rest);
        let offset = offset_rest * scale;
        let (cone, _) = self.light_cone(offset);
        // Angles from straight behind, where the small ones are: no digits are lost there.
        let from_behind = cone.distance_across.atan2(-n.dot(offset)) * (1.0 + 16.0 * f64::EPSILON);
        let sine = radius * scale / offset.length() * (1.0 + 8.0 * f64::EPSILON);
        let half_angle = 0.5 * (from_behind + sine.asin() * (1.0 + 4.0 * f64::EPSILON));
        // Written so that NaN, also from a sine above 1, is refused.
        if !(half_angle < FRAC_PI_2 && sine >= 0.0) {
            return everywhere;
        }
        let (c, s) = half_angle.sin_cos();
        (self.larger_singular_value(c, s) * (1.0 + 16.0 * f64::EPSILON)).min(everywhere)
    }

    /// The largest singular value of [`PhotosurfaceMap::jacobian`]: how many times a small error of an offset is
    /// magnified, at most. From 1 straight behind the observer to `exp(eta)` straight ahead and at the observer.
    ///
    /// # Accuracy
    ///
    /// A few units in the last place at any rapidity, never above [`PhotosurfaceMap::stretch_bound`]
    /// (`tests/it/physics/accuracy.rs`).
    pub fn stretch_at(&self, offset_rest: DVec3) -> f64 {
        self.stretch_toward(self.forwardness(offset_rest))
    }

    /// The cotangent of half the angle from the direction of motion, `sqrt(w / u)`: what grows with the stretch, and
    /// takes less to compute. Infinite straight ahead and at the observer.
    pub(crate) fn forwardness(&self, offset_rest: DVec3) -> f64 {
        let (cone, _) = self.light_cone(offset_rest);
        if cone.ahead || cone.larger == 0.0 {
            1.0 / cone.ratio
        } else {
            cone.ratio
        }
    }

    /// [`PhotosurfaceMap::stretch_at`] where [`PhotosurfaceMap::forwardness`] is this.
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

    /// With the cosine and the sine of half the angle from the direction of motion: see
    /// [`PhotosurfaceMap::stretch_bound`].
    fn larger_singular_value(&self, c: f64, s: f64) -> f64 {
        let sum = (c * (self.stretch + 1.0)).hypot(s * (1.0 + self.squeeze));
        let difference = (c * (self.stretch - 1.0)).hypot(s * (1.0 - self.squeeze));
        0.5 * (sum + difference)
    }

    /// The unit normal of the photosurface where the surface at rest has the normal `normal_rest`.
    ///
    /// # Derivation
    ///
    /// Normals go with the inverse transpose of the Jacobian, `N ~ n_rest - a (n.n_rest) / D`. Split
    /// along and across the motion and multiplied by `D` this is
    /// `D n_across + (n.n_rest) (n - gamma beta d_across / r)`: two terms, neither of which cancels in
    /// itself.
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

    /// The unit tangent of the photosurface where the surface at rest has the tangent `tangent_rest`:
    /// tangents go with the Jacobian. A zero tangent stays zero.
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

    /// The part across the motion of the direction in which a point is at rest, and the Doppler factor; at the observer
    /// itself zero and their mean.
    fn toward_across(&self, offset_rest: DVec3) -> (DVec3, f64) {
        let (cone, _) = self.light_cone(offset_rest);
        let r = cone.distance();
        if r > 0.0 {
            (cone.across / r, self.doppler_factor_of(&cone))
        } else {
            (DVec3::ZERO, self.gamma)
        }
    }

    /// With `q` the ratio of `|across|` to the larger of `u` and `w`, that of the smaller one is `q^2`.
    fn doppler_factor_of(&self, cone: &LightCone) -> f64 {
        let (of_larger, of_smaller) = if cone.ahead {
            (self.stretch, self.squeeze)
        } else {
            (self.squeeze, self.stretch)
        };
        // Ratios only: `squeeze * u` of a subnormal `u` is zero.
        (of_larger + (of_smaller * cone.ratio) * cone.ratio) / (1.0 + cone.ratio * cone.ratio)
    }

    /// Splits an offset into its part across the motion and its light-cone coordinates along it.
    ///
    /// The smaller of `u` and `w` comes from `u w = |across|^2`: as a difference it would be lost. Within 45
    /// degrees of the line of motion the part across is in danger, too: close behind a fast observer all of what is
    /// seen depends on it, and products with a rounded direction leave it only the digits of `r`.
    ///
    /// Huge offsets are made smaller on the way; the second result is what makes up for that.
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

    /// `s1 s2 = D` and `s1^2 + s2^2 = 2 + 2 n.a + |a|^2` of the plane of motion, where both have digits; the axes
    /// and the observer in closed form; below the bound and close to it everywhere.
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
                    // Terms of gamma^2 cancel in the trace.
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
