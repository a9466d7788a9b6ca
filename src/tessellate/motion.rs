//! How the photosurface of a flat facet is inclined to the motion, and so how far a gap leads away from it.
//!
//! Notation of this file: `n` is the direction of the observer's motion in the rest frame, `s` the unit normal of a facet
//! there, `c = n.s`, and `q` the direction in which a point of the facet lies from the observer. The photosurface has the
//! normal `N = D s - c a` where the point is seen, with the Doppler factor `D = gamma (1 + beta q.n)` and
//! `a = (gamma - 1) n + gamma beta q` (`light_cone`). In components along and across the motion nothing of this cancels:
//!
//! ```text
//! N = c n + gamma (s - c n) + gamma beta n x (s x q),        N.n = c.
//! ```
//!
//! A gap `g` along the motion leads away from the surface by `g |n.N| / |N| = g |c| / |N|`. This file calls
//! `|c| / |N|`, a number from 0 to 1, the *share* of the gap.

use glam::DVec3;

use crate::spacetime::Velocity;

const EPSILON: f64 = f64::EPSILON;

/// The observer's motion in the rest frame of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Unit vector.
    pub(super) direction: DVec3,
    pub(super) gamma: f64,
    pub(super) gamma_beta: f64,
}

impl Motion {
    /// The motion with the observer's velocity relative to an object.
    pub(crate) fn new(velocity: Velocity) -> Self {
        Self {
            direction: velocity.direction(),
            gamma: velocity.gamma(),
            gamma_beta: velocity.gamma_beta(),
        }
    }

    /// A bound, as a gap, on how far places are seen apart that are so far from each other in the rest frame.
    pub(super) fn as_gap(&self, distance: f64) -> f64 {
        // No stretch is larger than gamma (1 + beta).
        2.0 * distance * (self.gamma / self.gamma_beta)
    }

    /// The normal `N` of the photosurface for the normal `s` of a facet, in the direction `q`. The result is as long as
    /// `s` times `N` of a unit normal; `q` may be shorter than 1.
    #[inline(always)]
    pub(super) fn seen_normal(&self, s: DVec3, q: DVec3) -> DVec3 {
        let n = self.direction;
        let c = n.dot(s);
        // n x (s x q) = s (n.q) - q (n.s), here without its part along `n`, which is zero.
        n * c + (s - n * c) * self.gamma + (s * n.dot(q) - q * c) * self.gamma_beta
    }

    /// The share of the gap for a facet with a normal `s` of any length, in the direction `q`: not rounded up.
    #[inline(always)]
    pub(super) fn share(&self, s: DVec3, q: DVec3) -> f64 {
        let c = self.direction.dot(s).abs();
        let share = c / self.seen_normal(s, q).length();
        // What is not a number counts as the whole.
        if share < 1.0 { share } else { 1.0 }
    }

    /// Upper bound on the share of the gap of an edge with the unit direction `along` that leads away from the seen
    /// edge, where the interpolated or the true distance from the observer grows along the edge by `slopes.0` to
    /// `slopes.1`.
    ///
    /// # Derivation
    ///
    /// The seen edge has the tangent `along + ((gamma - 1) n.along + gamma beta q.along) n`: its part along the motion is
    /// `k = gamma n.along + gamma beta slope`. The part of a unit step along the motion across this tangent is the part
    /// of `along` across the motion, divided by the tangent's length.
    pub(super) fn edge_share(&self, along: DVec3, slopes: (f64, f64)) -> f64 {
        let across = along.cross(self.direction).length() * (1.0 + 8.0 * EPSILON) + 2.0 * EPSILON;
        let (low, high) = (
            self.edge_part(along, slopes.0),
            self.edge_part(along, slopes.1),
        );
        let least = match low <= 0.0 && high >= 0.0 {
            true => 0.0,
            false => low.abs().min(high.abs()),
        };
        let least = (least - 16.0 * EPSILON * self.gamma).max(0.0);
        let share = across / across.hypot(least);
        if share < 1.0 { share } else { 1.0 }
    }

    /// The part `k` of a seen edge's tangent that is along the motion.
    pub(super) fn edge_part(&self, along: DVec3, slope: f64) -> f64 {
        self.gamma * along.dot(self.direction) + self.gamma_beta * slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light_cone::PhotosurfaceMap;

    #[test]
    fn shares_are_those_of_normals_and_tangents_of_the_map() {
        for step in 1..500 {
            let wave = |factor: f64| (f64::from(step) * factor).sin();
            let vector = |f: f64| DVec3::new(wave(f), wave(f + 0.37), wave(1.3 * f + 0.1));
            let velocity =
                Velocity::from_rapidity(0.1 + 4.0 * wave(0.77).abs(), vector(2.1)).unwrap();
            let motion = Motion::new(velocity);
            let map = PhotosurfaceMap::new(&velocity);
            let (offset, normal) = (vector(0.9), vector(1.7).normalize());
            let expected = map.seen_normal(offset, normal).dot(motion.direction).abs();
            let found = motion.share(normal * 3.0, offset.normalize());
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");

            let along = vector(0.53).normalize();
            let tangent = map.seen_tangent(offset, along);
            let expected = tangent.cross(motion.direction).length();
            let slope = along.dot(offset.normalize());
            let found = motion.edge_share(along, (slope, slope));
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            let wider = motion.edge_share(along, (slope - 0.1, slope + 0.1));
            assert!(wider >= found);
        }
    }
}
