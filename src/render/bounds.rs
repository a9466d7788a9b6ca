//! Boxes along the axes.

use glam::DVec3;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Bounds {
    pub(super) const NOTHING: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    pub(super) fn around(places: impl Iterator<Item = DVec3>) -> Self {
        places.fold(Self::NOTHING, |bounds, place| Self {
            low: bounds.low.min(place),
            high: bounds.high.max(place),
        })
    }

    pub(super) fn of_all(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::NOTHING, Self::with)
    }

    pub(super) fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    pub(super) fn middle(&self) -> DVec3 {
        // Halves first: the sum of two large numbers may be none.
        self.low / 2.0 + self.high / 2.0
    }

    /// Centre and radius of a ball around it.
    pub(super) fn ball(&self) -> (DVec3, f64) {
        (self.middle(), self.low.distance(self.high) / 2.0)
    }

    /// Half of its surface; of what is flat, its area.
    pub(super) fn half_area(&self) -> f64 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    pub(super) fn holds(&self, place: DVec3) -> bool {
        place.cmpge(self.low).all() && place.cmple(self.high).all()
    }
}
