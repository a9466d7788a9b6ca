//! A point of spacetime.

use std::ops::{Add, Mul, Sub};

use glam::DVec3;

use super::exact::two_sum;

/// A point of spacetime in the coordinates of some frame, or the difference of two.
///
/// Time and position share one unit (c = 1). Events are plain numbers that nothing checks: sums and products of numbers
/// that are not finite are not finite either.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Event {
    /// Coordinate time.
    pub time: f64,
    /// Place.
    pub position: DVec3,
}

impl Event {
    /// The event at `time` and `position`.
    pub fn new(time: f64, position: DVec3) -> Self {
        Self { time, position }
    }

    /// The Minkowski interval `-t^2 + |x|^2` of a difference of events; zero on the light cone.
    pub fn interval(&self) -> f64 {
        let distance = self.position.length();
        (distance - self.time) * (distance + self.time)
    }

    /// `self - other` rounded, and what was rounded away.
    pub(crate) fn exact_difference(&self, other: &Self) -> (Self, Self) {
        let (time, time_low) = two_sum(self.time, -other.time);
        let (x, x_low) = two_sum(self.position.x, -other.position.x);
        let (y, y_low) = two_sum(self.position.y, -other.position.y);
        let (z, z_low) = two_sum(self.position.z, -other.position.z);
        (
            Self::new(time, DVec3::new(x, y, z)),
            Self::new(time_low, DVec3::new(x_low, y_low, z_low)),
        )
    }
}

impl Add for Event {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.time + other.time, self.position + other.position)
    }
}

impl Sub for Event {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.time - other.time, self.position - other.position)
    }
}

impl Mul<f64> for Event {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.time * factor, self.position * factor)
    }
}
