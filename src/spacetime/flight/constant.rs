//! Flight with constant acceleration and turn rate in the observer's own axes, by closed forms.
//!
//! # Derivation
//!
//! In units in which `a` and `w` are of size 1 and the proper time is `T`: the four-velocity is `exp(K T) e_0` with
//! `K (t, v) = (a.v, a t + w x v)`, whose eigenvalues are `+-alpha` and `+-i omega`; `alpha^2 - omega^2 = -S` and
//! `alpha omega = |P|`, where `S = w^2 - a^2` and `P = a.w`. With `A = alpha T`, `B = omega T`, `N = A^2 + B^2` and
//! `f[A, B] = (f(A^2) - f(-B^2)) / N` an entire function of `K T` is a polynomial of degree 3:
//!
//! ```text
//! u = (cosh A + q T^2 C,    a T E + (w x a) T^2 C + w P T^3 D),     q = a^2 - alpha^2 = 2 |a x w|^2 / (a^2 + w^2 + R)
//! X = (sinhc A + q T^2 D,   a T C + (w x a) T^2 D + w P T^3 G) tau,  R = alpha^2 + omega^2
//! C = (cosh A - cos B) / N   = 2 (sinh^2(A/2) + sin^2(B/2)) / N
//! D = (sinhc A - sinc B) / N = ((sinhc A - 1) + (1 - sinc B)) / N
//! E = (A sinh A + B sin B) / N
//! G = (sinhc^2(A/2) - sinc^2(B/2)) / (2 N)
//! ```
//!
//! The forms on the right are sums of numbers that are not negative. They hold for all four types of flight, linear
//! (`B = 0`), rotational (`A = 0`), general and null (`A = B = 0`), and lose no digits between them: no type is asked
//! for. The axes follow from the matrix of SL(2,C), `exp(T (a - i w).sigma / 2) = cosh z + T (a - i w).sigma sinhc z / 2`
//! with `z = (A -+ i B) / 2`: its polar decomposition is the boost to `u` after the rotation whose quaternion is the real
//! part of `cosh z` and the imaginary part of the vector.
//!
//! # Reference
//!
//! The four types: J. L. Synge, *Time-like helices in flat space-time*, Proc. R. Ir. Acad. A 65 (1967), 27.

use glam::{DQuat, DVec3};

use super::smooth::{cosh_above_sinhc, sinc_above_cos, sinc_below_1, sinhc, sinhc_above_1};
use crate::spacetime::{Event, Lorentz, Rotation, Velocity, exact, heading, length};

/// Below this size of `N` all functions have their values at 0 to all digits.
const LEAST: f64 = 1e-100;

/// Constant acceleration and turn rate in the observer's own axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ConstantMotion {
    /// Acceleration and turn rate over the unit, a power of two; the larger one is about 1.
    acceleration: DVec3,
    turn_rate: DVec3,
    unit: f64,
    /// `w x a`, of which zero says that the motion is straight.
    across: DVec3,
    /// `a.w`
    product: f64,
    /// Rates of the boost and of the turn, over the unit.
    alpha: f64,
    omega: f64,
    /// `a^2 - alpha^2`
    excess: f64,
}

impl ConstantMotion {
    /// `None` for an observer who coasts.
    pub(super) fn new(acceleration: DVec3, turn_rate: DVec3) -> Option<Self> {
        let largest = acceleration.abs().max(turn_rate.abs());
        // The heading of a vector is the vector over a power of two.
        let unit = largest.max_element() / heading(largest)?.max_element();
        let (acceleration, turn_rate) = (acceleration / unit, turn_rate / unit);
        let (aa, aa_low) = exact::dot(acceleration, acceleration);
        let (ww, ww_low) = exact::dot(turn_rate, turn_rate);
        let (product, product_low) = exact::dot(acceleration, turn_rate);
        let product = product + product_low;
        let (difference, rounded) = exact::two_sum(ww, -aa);
        // S, with all digits that `a` and `w` give it.
        let invariant = difference + (rounded + (ww_low - aa_low));
        let radius = invariant.hypot(2.0 * product);
        let larger = (0.5 * (radius + invariant.abs())).sqrt();
        let smaller = match larger {
            0.0 => 0.0,
            larger => product.abs() / larger,
        };
        let (alpha, omega) = match invariant < 0.0 {
            true => (larger, smaller),
            false => (smaller, larger),
        };
        let across = exact::cross(turn_rate, acceleration);
        Some(Self {
            acceleration,
            turn_rate,
            unit,
            across,
            product,
            alpha,
            omega,
            excess: 2.0 * across.length_squared() / (aa + ww + radius),
        })
    }

    /// A bound on the rapidity at any instant of `proper_time` of this motion, relative to its beginning: that of the
    /// path, or `cosh(eta) <= exp(A) (1 + 2 q / (alpha^2 + omega^2))`.
    pub(super) fn max_rapidity(&self, proper_time: f64) -> f64 {
        let path = length(self.acceleration) * (proper_time * self.unit);
        let swing = 2.0 * self.excess / (self.alpha.powi(2) + self.omega.powi(2));
        // Of the null type the second bound is not a number.
        path.min(self.boost_rapidity(proper_time) + (2.0 * (1.0 + swing)).ln())
    }

    /// The rapidity that the boost alone amounts to after `proper_time`.
    pub(super) fn boost_rapidity(&self, proper_time: f64) -> f64 {
        self.alpha * (proper_time * self.unit)
    }

    /// The displacement after `proper_time`, and the transformation from the observer's frame at the beginning to that
    /// at the end.
    ///
    /// # Accuracy
    ///
    /// A few units in the last place of the time of the displacement, of the Lorentz factor and of 1, times one more
    /// than the angle of the turn and the rapidity of the boost (`tests/it/flights/exact.rs`).
    pub(super) fn after(&self, proper_time: f64) -> (Event, Lorentz) {
        let t = proper_time * self.unit;
        let (boost, turn) = (self.alpha * t, self.omega * t);
        let square = boost * boost + turn * turn;
        let over_square = |number: f64, at_zero: f64| match square < LEAST {
            true => at_zero,
            false => number / square,
        };
        let (half_boost, half_turn) = (0.5 * boost, 0.5 * turn);
        let cosh_gap = 2.0 * (half_boost.sinh().powi(2) + half_turn.sin().powi(2));
        let sinhc_gap = sinhc_above_1(boost) + sinc_below_1(turn);
        let half_gap = sinhc_above_1(half_boost) + sinc_below_1(half_turn);
        let half_sum = sinhc(half_boost) + (1.0 - sinc_below_1(half_turn));
        let c = over_square(cosh_gap, 0.5);
        let d = over_square(sinhc_gap, 1.0 / 6.0);
        let e = over_square(boost * boost.sinh() + turn * turn.sin(), 1.0);
        let g = over_square(0.5 * half_gap * half_sum, 1.0 / 24.0);

        // Factors are multiplied where they stay in range: t alone may be large while the rates are small.
        let ahead = self.acceleration * t;
        let aside = self.across * t * t;
        let around = self.turn_rate * (self.product * t * t) * t;
        let excess = self.excess * t * t;
        let way = Event::new(
            (sinhc(boost) + excess * d) * proper_time,
            (ahead * c + aside * d + around * g) * proper_time,
        );
        let celerity = ahead * e + aside * c + around * d;
        (
            way,
            Lorentz::boost(self.velocity(boost, celerity)).turned(self.turned(t)),
        )
    }

    /// The velocity at the end, of which `celerity` is the space part of the four-velocity.
    fn velocity(&self, boost: f64, celerity: DVec3) -> Velocity {
        if self.across == DVec3::ZERO {
            // Straight ahead rapidities add up, and the direction is the one that was given.
            let ahead = Velocity::from_rapidity(1.0, self.acceleration).unwrap_or_default();
            return ahead.with_signed_rapidity(boost, boost.exp());
        }
        Velocity::of_celerity(celerity)
    }

    /// How coordinates turn after the boost: against the turn of the axes.
    fn turned(&self, t: f64) -> Rotation {
        let (x, y) = (0.5 * self.alpha * t, 0.5 * self.omega * t);
        let square = x * x + y * y;
        let sign = if self.product < 0.0 { -1.0 } else { 1.0 };
        let sinc = 1.0 - sinc_below_1(y);
        let (real, imaginary) = match square < LEAST {
            true => (1.0, 0.0),
            false => {
                let real = x * x * sinhc(x) * y.cos() + y * y * x.cosh() * sinc;
                let imaginary = cosh_above_sinhc(x) * sinc + sinhc(x) * sinc_above_cos(y);
                (real / square, -sign * (x * y / square) * imaginary)
            }
        };
        let vector = (self.turn_rate * real - self.acceleration * imaginary) * (0.5 * t);
        let scalar = x.cosh() * y.cos();
        let [x, y, z] = (-vector).to_array();
        Rotation::of_any_length(DQuat::from_xyzw(x, y, z, scalar))
    }
}
