//! Where and when an observer is, as a function of its own clock.

use super::{Event, Velocity};

/// The worldline of an observer or an object in uniform motion.
///
/// The origin is plain numbers, as any [`Event`]: one that is not finite is infinitely far from everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldLine {
    /// The event at proper time 0.
    pub origin: Event,
    /// The velocity, in the frame of `origin`.
    pub velocity: Velocity,
}

impl WorldLine {
    /// The event at `proper_time` after [`WorldLine::origin`].
    pub fn at(&self, proper_time: f64) -> Event {
        self.origin + self.velocity.four_velocity() * proper_time
    }
}
