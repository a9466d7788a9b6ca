//! What all points of a mesh have in common.

use glam::DVec3;

/// What all points of a mesh have in common, at rest and as seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extremes {
    /// The box around all places where they are seen; upside down where there are none.
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// The distances at which the nearest and the farthest are seen.
    pub(crate) nearest: f64,
    pub(crate) farthest: f64,
    /// The largest distance from the origin of the rest frame.
    pub(crate) farthest_rest: f64,
    /// The largest: see [`View::stretch_toward`].
    pub(crate) forwardness: f64,
}

impl Extremes {
    /// Of no points.
    pub(crate) const NONE: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        nearest: f64::INFINITY,
        farthest: 0.0,
        farthest_rest: 0.0,
        forwardness: 0.0,
    };

    /// Of the points of both.
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

    /// The box around what is seen; `None` where nothing is.
    pub(crate) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        // Of places beyond f64 there is one, too.
        (self.nearest <= self.farthest || self.farthest > 0.0).then_some((self.low, self.high))
    }
}
