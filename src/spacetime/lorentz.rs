//! Lorentz transformations as a boost followed by a rotation.
//!
//! Two boosts compose as 2x2 complex matrices, SL(2,C): `exp(-eta/2 n.sigma)` for the passive boost
//! into a frame that moves with rapidity `eta` along `n`. Written out in `1` and `sigma` the product
//! of two is `alpha - v.sigma + i w.sigma` with real `alpha`, `v`, `w`; its polar decomposition is the
//! resulting boost and the Wigner rotation. [`compose_boosts`] evaluates `alpha`, `v`, `w` so that
//! nothing cancels, neither for opposite nor for nearly equal velocities.

use glam::{DQuat, DVec3};

use super::{Event, Rotation, Velocity, exact, harmless_scale, length, unit};

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
    /// The rapidity of a composition is at most 700, twice [`MAX_RAPIDITY`](crate::spacetime::MAX_RAPIDITY), which no two
    /// velocities that were given exceed: a larger one is held there, for its `gamma` would be beyond `f64`.
    ///
    /// # Accuracy
    ///
    /// Rapidity, direction and rotation of two boosts to a few units in the last place, at any pair of velocities, also
    /// all but equal and all but opposite ones (`tests/it/physics/lorentz.rs`). Collinear boosts compose to the exact
    /// sum of their rapidities. After a rotation the direction of the next boost is one more rounded number, of which
    /// all but opposite velocities make `cosh` of half the larger rapidity times as much.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        // (R2 B2) (R1 B1) = R2 R1 (R1^-1 B2 R1) B1: the second boost as seen before the first rotation.
        let next_boost = next.boost.turned(self.rotation.inverse());
        let (boost, wigner) = compose_boosts(&self.boost, &next_boost);
        Self {
            boost,
            rotation: (next.rotation * self.rotation * wigner).normalize(),
        }
    }

    /// This transformation, after which `rotation` turns the coordinates.
    #[must_use]
    pub fn turned(&self, rotation: Rotation) -> Self {
        self.turned_by(rotation.get())
    }

    /// The same with a unit quaternion.
    pub(crate) fn turned_by(&self, rotation: DQuat) -> Self {
        Self {
            boost: self.boost,
            rotation: (rotation * self.rotation).normalize(),
        }
    }

    /// The transformation back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            boost: self.boost.reversed().turned(self.rotation),
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
    /// In light-cone coordinates `t + x`, `t - x` along the boost, which it only multiplies. These are taken with twice
    /// the digits: what cancels in them, as for something that keeps up with light for a long time, leaves all digits
    /// of what remains.
    ///
    /// # Accuracy
    ///
    /// A few units in the last place of the larger of the new time and the new distance
    /// (`tests/it/physics/lorentz.rs`). A coordinate that is not finite makes others that are not.
    pub fn apply(&self, event: Event) -> Event {
        let direction = self.boost.direction();
        let heading = self.boost.heading();
        let scale = harmless_scale(event.position.abs().max(DVec3::splat(event.time.abs())));
        let (time, position) = (event.time * scale, event.position * scale);
        let (parallel, parallel_low) = exact::along(heading, position);
        let cone = |sign: f64| {
            let (sum, rounded) = exact::two_sum(time, sign * parallel);
            sum + (rounded + sign * parallel_low)
        };
        let ahead = cone(1.0) / self.boost.stretch();
        let behind = cone(-1.0) * self.boost.stretch();
        let across = exact::cross(heading, position).cross(heading) / heading.length_squared();
        Event {
            time: (0.5 * ahead + 0.5 * behind) / scale,
            position: self.rotation * ((across + direction * (0.5 * ahead - 0.5 * behind)) / scale),
        }
    }
}

/// Rapidities below this add up like vectors: what relativity changes is smaller by their square.
const GALILEAN: f64 = 1e-100;

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
/// alpha = cosh((eta2 + eta1)/2) - s1 s2 |h|^2 / 2,      w = s1 s2 n2 x n1
/// ```
///
/// and `h = 2 (n1 x n2) x (n2 + n1) / |n2 + n1|^2` from the cross product of the directions as they were given,
/// which is exact. `|v| = sinh(eta/2)` of the result, the rotation's quaternion is `(alpha, -w)` normalised, and
/// `v` is the boost's direction turned half way.
fn compose_boosts(first: &Velocity, second: &Velocity) -> (Velocity, DQuat) {
    let flip = if first.direction().dot(second.direction()) < 0.0 {
        -1.0
    } else {
        1.0
    };
    let (n1, n2) = (first.direction() * flip, second.direction());
    let (eta1, eta2) = (first.rapidity() * flip, second.rapidity());
    let (h1, h2) = (first.heading() * flip, second.heading());
    let sine = exact::cross(h1, h2) / (h1.length() * h2.length());

    if sine == DVec3::ZERO || eta1 == 0.0 || eta2 == 0.0 {
        let stretch1 = signed_stretch(first, flip);
        let carrier = if eta2 == 0.0 { first } else { second };
        let flipped = if eta2 == 0.0 { flip } else { 1.0 };
        let (rapidity, stretch) = (eta2 + eta1, second.stretch() * stretch1);
        let velocity = if flipped < 0.0 {
            carrier.with_signed_rapidity(-rapidity, 1.0 / stretch)
        } else {
            carrier.with_signed_rapidity(rapidity, stretch)
        };
        return (velocity, DQuat::IDENTITY);
    }

    let sum = n2 + n1;
    let difference = 2.0 * sine.cross(sum) / sum.length_squared();
    if eta1.abs().max(eta2) < GALILEAN {
        // Not by halves: half of the smallest number is none.
        let scale = 2f64.powi(300);
        let (eta1, eta2) = (eta1 * scale, eta2 * scale);
        let vector = 0.5 * (sum * (eta2 + eta1) + difference * (eta2 - eta1));
        let rapidity = length(vector);
        let direction = unit(vector).unwrap_or(n2);
        let velocity = Velocity::from_parts(rapidity / scale, 1.0, direction);
        return (velocity, DQuat::IDENTITY);
    }

    let s1_s2 = (0.5 * eta1).sinh() * (0.5 * eta2).sinh();
    let (root1, root2) = (signed_stretch(first, flip).sqrt(), second.stretch().sqrt());
    let (sinh_plus, cosh_plus) = sinh_cosh(0.5 * (eta2 + eta1), root2 * root1);
    let (sinh_minus, _) = sinh_cosh(0.5 * (eta2 - eta1), root2 / root1);
    let v = 0.5 * (sum * sinh_plus + difference * sinh_minus);
    let alpha = cosh_plus - 0.5 * s1_s2 * difference.length_squared();
    let w = sine * -s1_s2;

    // |v| up to sinh(350) = 1e152: its square is within f64.
    let norm = alpha.hypot(length(w));
    let (alpha, w) = (alpha / norm, w / norm);
    let half_rapidity_sinh = length(v);
    let Some(half_turned) = unit(v) else {
        return (Velocity::ZERO, DQuat::IDENTITY);
    };
    let direction = half_turned * alpha + w.cross(half_turned);
    let root = half_rapidity_sinh + half_rapidity_sinh.hypot(1.0);
    (
        Velocity::from_parts(
            2.0 * half_rapidity_sinh.asinh(),
            root * root,
            direction.normalize(),
        ),
        DQuat::from_xyzw(-w.x, -w.y, -w.z, alpha),
    )
}

/// `exp` of the rapidity with the sign `flip`.
fn signed_stretch(velocity: &Velocity, flip: f64) -> f64 {
    if flip < 0.0 {
        1.0 / velocity.stretch()
    } else {
        velocity.stretch()
    }
}

/// The hyperbolic sine and cosine of a number of which the exponential is known better.
///
/// Half a unit in the last place of 100 would be 64 units of the result, which the rotation, a ratio of such
/// results, has no reason to bear.
fn sinh_cosh(number: f64, exponential: f64) -> (f64, f64) {
    if number.abs() < 1.0 {
        return (number.sinh(), number.cosh());
    }
    let inverse = 1.0 / exponential;
    (0.5 * (exponential - inverse), 0.5 * (exponential + inverse))
}

#[cfg(test)]
mod tests {
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
