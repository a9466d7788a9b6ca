//! The largest and smallest values of a few quantities over all points of a mesh.

use glam::DVec3;

/// The largest and smallest values of a few quantities over all points of a mesh, at rest and as the observer sees
/// them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extremes {
    /// The corners of the box around all seen positions, in the observer's frame; `low` is above `high` if there are no
    /// points.
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// The distances, in the observer's frame, at which the nearest and the farthest point are seen.
    pub(crate) nearest: f64,
    pub(crate) farthest: f64,
    /// The largest distance of a point from the origin of the rest frame.
    pub(crate) farthest_rest: f64,
    /// The largest [`View::forwardness`](super::View::forwardness) of a point.
    pub(crate) forwardness: f64,
}

impl Extremes {
    /// The extremes of no points.
    pub(crate) const NONE: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        nearest: f64::INFINITY,
        farthest: 0.0,
        farthest_rest: 0.0,
        forwardness: 0.0,
    };

    /// The extremes of the points of both together.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            nearest: self.nearest.min(other.nearest),
            farthest: self.farthest.max(other.farthest),
            farthest_rest: self.farthest_rest.max(other.farthest_rest),
            forwardness: self.forwardness.max(other.forwardness),
        }
    }

    /// The lowest and the highest corner of the box around all seen positions; `None` if there are no points.
    pub(crate) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        // Positions beyond `f64` have a box, too.
        (self.nearest <= self.farthest || self.farthest > 0.0).then_some((self.low, self.high))
    }
}
