//! Which part of the sky a ball takes up, so that rays beside it are told at once.

use glam::DVec3;

use super::bounds::Bounds;
use crate::spacetime::unit;

/// A body is within this part of the ball that is looked for.
const RADIUS_MARGIN: f64 = 1.0 + 1e-9;

/// What roundings of places may do to a ball, relative to how far they are from where they are measured.
const PLACE_MARGIN: f64 = 8.0 * f64::EPSILON;

/// How far roundings of unit vectors may move what is seen, in radians.
const SKY_MARGIN: f64 = 1e-14;

/// A circle on the sky and what it holds, or the whole sky: unit vectors that are not farther than `chord` from `middle`.
///
/// The chord, not the cosine, which knows nothing of circles smaller than 1e-8.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    middle: DVec3,
    chord: f64,
}

impl Cone {
    const WHOLE_SKY: Self = Self {
        middle: DVec3::ZERO,
        chord: 2.0,
    };

    /// All directions from `eye` to the ball; the whole sky from within it.
    pub(super) fn of_ball(eye: DVec3, center: DVec3, radius: f64) -> Self {
        let half = half_angle(eye, center, radius);
        match (half, unit(center - eye)) {
            (Some(half), Some(middle)) => Self::new(middle, half),
            _ => Self::WHOLE_SKY,
        }
    }

    /// The same for an observer at `eye` who moves along the unit vector `along` with `rapidity`, in axes that are not
    /// turned.
    ///
    /// # Derivation
    ///
    /// A moving observer sees a circle wherever one at rest does (Penrose 1959), and the tangent of half the angle from the
    /// direction of motion is `exp(-rapidity)` times what it is at rest. So the circle's ends on the great circle through
    /// the direction of motion are the ends of what is seen. Angles are measured from ahead or from behind, whichever
    /// is closer: behind, what is seen magnifies all roundings of an angle that is measured from ahead.
    pub(super) fn of_moving(
        eye: DVec3,
        along: DVec3,
        rapidity: f64,
        (center, radius): (DVec3, f64),
    ) -> Self {
        let Some(half) = half_angle(eye, center, radius) else {
            return Self::WHOLE_SKY;
        };
        let to_center = center - eye;
        let is_ahead = to_center.dot(along) >= 0.0;
        let (pole, shrink) = match is_ahead {
            true => (along, (-rapidity).exp()),
            false => (-along, rapidity.exp()),
        };
        let across = pole.cross(to_center).cross(pole);
        let from_pole = across.length().atan2(to_center.dot(pole));
        // From -pi/2 to pi, whose halves have no sense to lose.
        let seen = |angle: f64| 2.0 * ((angle / 2.0).sin() * shrink).atan2((angle / 2.0).cos());
        let half = half + from_pole * PLACE_MARGIN;
        let ends = [seen(from_pole - half), seen(from_pole + half)];
        let (sin, cos) = ((ends[0] + ends[1]) / 2.0).sin_cos();
        // A ball that is straight ahead has its middle there.
        let side = unit(across).unwrap_or(DVec3::ZERO);
        Self::new(pole * cos + side * sin, (ends[1] - ends[0]) / 2.0)
    }

    fn new(middle: DVec3, half: f64) -> Self {
        let half = half + SKY_MARGIN;
        Self {
            middle,
            chord: 2.0 * (half / 2.0).min(1.6).sin(),
        }
    }

    /// The same on a sky that `turn` turns.
    pub(super) fn turned(self, turn: impl Fn(DVec3) -> DVec3) -> Self {
        Self {
            middle: turn(self.middle),
            ..self
        }
    }

    /// Whether the unit vector `direction` may be within; if not, it is not.
    pub(super) fn may_hold(&self, direction: DVec3) -> bool {
        // Also where very fast motion makes infinities, and no number of their difference.
        !(direction.distance_squared(self.middle) > self.chord * self.chord)
    }

    /// A box around all unit vectors within.
    pub(super) fn bounds(&self) -> Bounds {
        let chord = if self.chord.is_finite() && self.middle.is_finite() {
            self.chord
        } else {
            return Self::WHOLE_SKY.bounds();
        };
        Bounds {
            low: self.middle - chord * RADIUS_MARGIN,
            high: self.middle + chord * RADIUS_MARGIN,
        }
    }
}

/// Half the angle that a ball takes up; none from within it.
fn half_angle(eye: DVec3, center: DVec3, radius: f64) -> Option<f64> {
    let rounded = (center.abs() + eye.abs()).element_sum() * PLACE_MARGIN;
    let sine = (radius * RADIUS_MARGIN + rounded) / (center - eye).length();
    (sine < 1.0).then(|| sine.asin())
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

    /// Rays that meet a ball at its rim, and beside it, at all speeds, ahead and behind: the rim is held, and of what is
    /// beside it no more than the margins.
    #[test]
    fn moving_circles_are_aberrated_by_the_half_angle() {
        let balls = [
            (DVec3::new(6.0, 0.0, 8.0), 2.0),
            (DVec3::new(6.0, 0.0, -8.0), 2.0),
            (DVec3::new(3e-9, 0.0, -10.0), 2e-9),
            (DVec3::new(0.0, 0.0, 10.0), 3.0),
            (DVec3::new(0.0, 0.0, -10.0), 3.0),
            (DVec3::new(1e-3, 0.0, 10.0), 9.0),
        ];
        for (rapidity, (center, radius)) in [0.0_f64, 0.5, 3.0, 10.0, 18.0, 30.0, 350.0]
            .into_iter()
            .flat_map(|rapidity| balls.map(|ball| (rapidity, ball)))
        {
            let moving = Cone::of_moving(DVec3::ZERO, DVec3::Z, rapidity, (center, radius));
            let distance = center.length();
            let half = (radius / distance).asin();
            // From behind where that is closer, so that the test knows small angles as well.
            let sign = center.z.signum();
            let middle = center.x.atan2(sign * center.z);
            for (part, held) in [
                (-1.001, false),
                (-0.999, true),
                (0.999, true),
                (1.001, false),
            ] {
                let seen = |part: f64| {
                    let angle = middle + part * half;
                    2.0 * ((angle / 2.0).tan() * (-sign * rapidity).exp()).atan()
                };
                let direction = DVec3::new(seen(part).sin(), 0.0, sign * seen(part).cos());
                // Not where what is seen of a thousandth of the circle is no more than the roundings, and not where the
                // circle is all but the whole sky: there a chord knows nothing of angles.
                let seen_half = (seen(1.0) - seen(-1.0)) / 2.0;
                let is_told = (seen(part) - seen(part * 0.999)).abs() > 1e-12 && seen_half < 3.0;
                let sure = held || is_told;
                assert!(
                    moving.may_hold(direction) == held || !sure,
                    "{rapidity} {center} {part}"
                );
                let bounds = moving.bounds();
                let inside =
                    direction.cmpge(bounds.low).all() && direction.cmple(bounds.high).all();
                assert!(inside || !held, "{rapidity} {center} {part}");
            }
        }
        let fastest = Cone::of_moving(DVec3::ZERO, DVec3::Z, 700.0, (DVec3::X, 0.5));
        assert!(fastest.may_hold(DVec3::Z), "what lies beside is seen ahead");
    }
}
