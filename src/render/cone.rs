//! Which part of the sky a ball takes up, so that rays beside it are told at once.

use glam::{DMat3, DVec3};

/// A body is within this part of the ball that is looked for.
const RADIUS_MARGIN: f64 = 1.0 + 1e-9;

/// What roundings may do to one side of the inequality, relative to its terms: a unit vector is known to
/// `1e-16`.
const ROUNDING: f64 = 1e-12;

/// A circle on the sky: all unit directions `s` with `s . axis >= least`.
///
/// Not a unit axis: a moving observer sees a circle wherever one at rest does (Penrose 1959), and so the
/// inequality stays linear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    axis: DVec3,
    least: f64,
}

impl Cone {
    /// All directions from `eye` to the ball; the whole sky from within it.
    pub(super) fn of_ball(eye: DVec3, center: DVec3, radius: f64) -> Self {
        let to_center = center - eye;
        let distance = to_center.length();
        let sine = radius * RADIUS_MARGIN / distance;
        if !(sine < 1.0) {
            return Self {
                axis: DVec3::ZERO,
                least: -1.0,
            };
        }
        Self {
            axis: to_center / distance,
            least: ((1.0 - sine) * (1.0 + sine)).sqrt(),
        }
    }

    /// The same for an observer who moves along `along` with `rapidity`, and whose axes are then turned.
    ///
    /// A direction `s` in motion is `v / r` at rest, `v = s_across + n (gamma n.s - gamma beta)`,
    /// `r = gamma - gamma beta n.s` (see [`super::sight::Sight`]): `v . axis >= r least` is linear in `s`.
    pub(super) fn aberrated(
        &self,
        along: DVec3,
        rapidity: f64,
        boosted_to_observer: DMat3,
    ) -> Self {
        let (sinh, cosh) = (rapidity.sinh(), rapidity.cosh());
        let axis_along = along.dot(self.axis);
        let axis_across = self.axis - along * axis_along;
        let boosted = axis_across + along * (cosh * axis_along + sinh * self.least);
        Self {
            axis: boosted_to_observer * boosted,
            least: sinh * axis_along + cosh * self.least,
        }
    }

    /// Whether the unit vector `direction` may be within; if not, it is not.
    pub(super) fn may_hold(&self, direction: DVec3) -> bool {
        let excess = direction.dot(self.axis) - self.least;
        // Also where very fast motion makes infinities, and no number of their difference.
        !(excess < -ROUNDING * (self.axis.abs().element_sum() + self.least.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_held_and_what_is_beside_it_is_not() {
        let cone = Cone::of_ball(DVec3::X, DVec3::new(1.0, 0.0, 10.0), 1.0);
        let at = |angle: f64| cone.may_hold(DVec3::new(angle.sin(), 0.0, angle.cos()));
        let edge = 0.1f64.asin();
        assert!(at(0.0) && at(edge) && at(-edge));
        assert!(!at(edge + 1e-7) && !at(3.0));
        let inside = Cone::of_ball(DVec3::ZERO, DVec3::X, 2.0);
        assert!(inside.may_hold(DVec3::NEG_X));
    }

    #[test]
    fn moving_circles_are_aberrated_by_the_half_angle() {
        for rapidity in [0.0_f64, 0.5, 3.0, 10.0] {
            let cone = Cone::of_ball(DVec3::ZERO, DVec3::new(6.0, 0.0, 8.0), 2.0);
            let moving = cone.aberrated(DVec3::Z, rapidity, DMat3::IDENTITY);
            let (center, half) = (0.6f64.asin(), 0.2f64.asin());
            for (angle, held) in [
                (center - 1.001 * half, false),
                (center - 0.999 * half, true),
                (center + 0.999 * half, true),
                (center + 1.001 * half, false),
            ] {
                let seen = 2.0 * ((angle / 2.0).tan() * (-rapidity).exp()).atan();
                let direction = DVec3::new(seen.sin(), 0.0, seen.cos());
                let may = moving.may_hold(direction);
                // Faster, the whole circle is as small as the margin for roundings.
                let sure = rapidity <= 3.0;
                assert!(may == held || may && !sure, "{rapidity} {angle}");
            }
        }
        let cone = Cone::of_ball(DVec3::ZERO, DVec3::X, 0.5);
        let fastest = cone.aberrated(DVec3::Z, 700.0, DMat3::IDENTITY);
        assert!(fastest.may_hold(DVec3::Z), "what lies beside is seen ahead");
    }
}
