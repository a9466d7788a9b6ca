//! Lorentz transformations as a boost followed by a rotation.
//!
//! Two boosts compose as 2x2 complex matrices, SL(2,C): `exp(-eta/2 n.sigma)` for the passive boost
//! into a frame that moves with rapidity `eta` along `n`. Written out in `1` and `sigma` the product
//! of two is `alpha - v.sigma + i w.sigma` with real `alpha`, `v`, `w`; its polar decomposition is the
//! resulting boost and the Wigner rotation. [`compose_boosts`] evaluates `alpha`, `v`, `w` so that
//! nothing cancels, neither for opposite nor for nearly equal velocities.

use glam::DQuat;

use super::{Event, Velocity};

/// A proper orthochronous Lorentz transformation: a boost followed by a rotation.
///
/// Passive: it turns the coordinates of an event in one frame into those in another, whose origin
/// moves with [`Lorentz::boost_velocity`] and whose axes are then turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lorentz {
    boost: Velocity,
    rotation: DQuat,
}

impl Lorentz {
    /// The transformation that changes nothing.
    pub const IDENTITY: Self = Self {
        boost: Velocity::ZERO,
        rotation: DQuat::IDENTITY,
    };

    /// The pure boost into the frame that moves with `velocity`.
    pub fn boost(velocity: Velocity) -> Self {
        Self {
            boost: velocity,
            rotation: DQuat::IDENTITY,
        }
    }

    /// From the rest frame of something that moves with `from` to that of something that moves with
    /// `to`, both velocities and both frames' axes given in one common frame.
    pub fn between(from: Velocity, to: Velocity) -> Self {
        Self::boost(from.reversed()).then(&Self::boost(to))
    }

    /// This transformation, then `next`.
    ///
    /// # Accuracy
    ///
    /// Rapidity, direction and rotation to a few units in the last place, at any pair of velocities, but
    /// for what the rounding of the given directions does to them: where these are all but
    /// opposite, `cosh` of half the larger rapidity times as much (`tests/lorentz.rs`). Collinear
    /// boosts compose to the exact sum of their rapidities.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        // (R2 B2) (R1 B1) = R2 R1 (R1^-1 B2 R1) B1: the second boost as seen before the first rotation.
        let next_direction = self.rotation.inverse() * next.boost.direction();
        let next_boost = Velocity::from_parts(next.boost.rapidity(), next_direction);
        let (boost, wigner) = compose_boosts(&self.boost, &next_boost);
        Self {
            boost,
            rotation: (next.rotation * self.rotation * wigner).normalize(),
        }
    }

    /// The transformation back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let direction = -(self.rotation * self.boost.direction());
        Self {
            boost: Velocity::from_parts(self.boost.rapidity(), direction),
            rotation: self.rotation.inverse(),
        }
    }

    /// The velocity of the new frame's origin in the old frame.
    pub fn boost_velocity(&self) -> Velocity {
        self.boost
    }

    /// The rotation after the boost.
    pub fn rotation(&self) -> DQuat {
        self.rotation
    }

    /// The coordinates of `event` in the new frame.
    ///
    /// In light-cone coordinates `t + x`, `t - x` along the boost, which it only multiplies: near
    /// light speed nothing cancels but what `event` itself leaves uncertain.
    pub fn apply(&self, event: Event) -> Event {
        let direction = self.boost.direction();
        let parallel = direction.dot(event.position);
        let ahead = (event.time + parallel) * (-self.boost.rapidity()).exp();
        let behind = (event.time - parallel) * self.boost.rapidity().exp();
        let new_parallel = 0.5 * (ahead - behind);
        let across = event.position - direction * parallel;
        Event {
            time: 0.5 * (ahead + behind),
            position: self.rotation * (across + direction * new_parallel),
        }
    }
}

/// The boost and the Wigner rotation after it that `first`, then `second` amount to.
///
/// # Derivation
///
/// With `c`, `s` the hyperbolic cosine and sine of half the rapidities, the product is
/// `alpha = c1 c2 + s1 s2 n1.n2`, `v = c1 s2 n2 + s1 c2 n1`, `w = s1 s2 n2 x n1`. Flip the first
/// direction (and the sign of its rapidity) where needed so that the angle between the two is at most
/// 90 degrees; then with `h = n2 - n1`
///
/// ```text
/// v = (n2 + n1)/2 sinh((eta2 + eta1)/2) + h/2 sinh((eta2 - eta1)/2)      two orthogonal parts
/// alpha = cosh((eta2 + eta1)/2) - s1 s2 |h|^2 / 2,      w = s1 s2 h x (n2 + n1) / 2
/// ```
///
/// and differences are taken of the given numbers only. `|v| = sinh(eta/2)` of the result, the rotation's
/// quaternion is `(alpha, -w)` normalised, and `v` is the boost's direction turned half way.
fn compose_boosts(first: &Velocity, second: &Velocity) -> (Velocity, DQuat) {
    let n2 = second.direction();
    let eta2 = second.rapidity();
    let flip = if first.direction().dot(n2) < 0.0 {
        -1.0
    } else {
        1.0
    };
    let n1 = first.direction() * flip;
    let eta1 = first.rapidity() * flip;

    if n1 == n2 || eta1 == 0.0 || eta2 == 0.0 {
        let (direction, rapidity) = if eta2 == 0.0 {
            (n1, eta1)
        } else {
            (n2, eta2 + eta1)
        };
        let velocity = Velocity::from_parts(rapidity.abs(), direction * rapidity.signum());
        return (velocity, DQuat::IDENTITY);
    }

    let (sum, difference) = (n2 + n1, n2 - n1);
    let s1_s2 = (0.5 * eta1).sinh() * (0.5 * eta2).sinh();
    let (sinh_plus, cosh_plus) = sinh_cosh_of_sum(0.5 * eta2, 0.5 * eta1);
    let (sinh_minus, _) = sinh_cosh_of_sum(0.5 * eta2, -0.5 * eta1);
    let v = 0.5 * (sum * sinh_plus + difference * sinh_minus);
    let alpha = cosh_plus - 0.5 * s1_s2 * difference.length_squared();
    let w = difference.cross(sum) * (0.5 * s1_s2);

    // |v| up to sinh(350) = 1e152: its square is within f64.
    let norm = alpha.hypot(w.length());
    let (alpha, w) = (alpha / norm, w / norm);
    let half_rapidity_sinh = v.length();
    if half_rapidity_sinh == 0.0 {
        return (Velocity::ZERO, DQuat::IDENTITY);
    }
    let half_turned = v / half_rapidity_sinh;
    let direction = half_turned * alpha + w.cross(half_turned);
    (
        Velocity::from_parts(2.0 * half_rapidity_sinh.asinh(), direction.normalize()),
        DQuat::from_xyzw(-w.x, -w.y, -w.z, alpha),
    )
}

/// The hyperbolic sine and cosine of `a + b`.
///
/// A large sum is not rounded before it is exponentiated: half a unit in the last place of 100 would be
/// 64 units of the result, which the rotation, a ratio of such results, has no reason to bear.
fn sinh_cosh_of_sum(a: f64, b: f64) -> (f64, f64) {
    if (a + b).abs() < 1.0 {
        return ((a + b).sinh(), (a + b).cosh());
    }
    let (grow, shrink) = (a.exp() * b.exp(), (-a).exp() * (-b).exp());
    (0.5 * (grow - shrink), 0.5 * (grow + shrink))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn velocity(beta: f64, direction: DVec3) -> Velocity {
        Velocity::from_beta(beta, direction).unwrap()
    }

    fn assert_close(a: Event, b: Event, allowed: f64) {
        let difference = a - b;
        let distance = difference.time.abs() + difference.position.length();
        assert!(
            distance <= allowed,
            "{a:?} and {b:?} differ by {distance:e} > {allowed:e}"
        );
    }

    #[test]
    fn a_composition_acts_like_its_parts() {
        let event = Event::new(0.7, DVec3::new(1.0, -2.0, 0.5));
        let velocities = [
            velocity(0.6, DVec3::X),
            velocity(0.8, DVec3::Y),
            velocity(0.9, DVec3::new(-1.0, 0.2, 0.3)),
            velocity(0.3, DVec3::new(-1.0, 1e-9, 0.0)),
            Velocity::ZERO,
        ];
        for a in velocities {
            for b in velocities {
                for c in velocities {
                    let (first, second, third) =
                        (Lorentz::boost(a), Lorentz::boost(b), Lorentz::boost(c));
                    let stepwise = third.apply(second.apply(first.apply(event)));
                    let at_once = first.then(&second).then(&third).apply(event);
                    // Each boost magnifies coordinates of size 3 by at most gamma (1 + beta) < 4.4.
                    assert_close(
                        at_once,
                        stepwise,
                        3.0 * 4.4f64.powi(3) * 16.0 * f64::EPSILON,
                    );
                    let back = first.then(&second).then(&third).inverse();
                    assert_close(
                        back.apply(at_once),
                        event,
                        3.0 * 4.4f64.powi(6) * 16.0 * f64::EPSILON,
                    );
                }
            }
        }
    }

    #[test]
    fn collinear_boosts_add_their_rapidities_exactly() {
        let direction = DVec3::new(0.3, -0.5, 0.6);
        let fast = Velocity::from_rapidity(300.25, direction).unwrap();
        let slow = Velocity::from_rapidity(0.5, direction).unwrap();
        let composed = Lorentz::boost(fast).then(&Lorentz::boost(slow));
        assert_eq!(composed.boost_velocity().rapidity(), 300.75);
        assert_eq!(composed.rotation(), DQuat::IDENTITY);
        let relative = Lorentz::between(fast, slow);
        assert_eq!(relative.boost_velocity().rapidity(), 299.75);
        assert_eq!(relative.boost_velocity().direction(), -fast.direction());
        assert_eq!(
            Lorentz::between(fast, fast).boost_velocity().rapidity(),
            0.0
        );
    }
}
