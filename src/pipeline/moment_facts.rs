//! The facts about an observer at one instant.

use schemars::JsonSchema;
use serde::Serialize;

use crate::spacetime::{Event, Flight};

/// What an observer is at one instant, in the scene frame: c = 1, lengths and times in scene units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MomentFacts {
    /// The observer's proper time, counted from the observation event.
    pub proper_time: f64,
    /// Scene time.
    pub time: f64,
    /// Position.
    pub position: [f64; 3],
    /// Velocity, in units of the speed of light.
    pub velocity: [f64; 3],
    /// Lorentz factor.
    pub gamma: f64,
    /// Rapidity, `atanh` of the speed; it has all digits also where the velocity rounds to 1.
    pub rapidity: f64,
    /// The observer's own axes x, y, z as four-vectors `[t, x, y, z]`.
    pub axes: [[f64; 4]; 3],
    /// Proper acceleration, in the observer's own axes; where a segment ends, that of the next one, or none.
    pub acceleration: [f64; 3],
}

impl MomentFacts {
    /// The facts about the observer of `flight` at `proper_time`.
    pub fn new(flight: &Flight, proper_time: f64) -> Self {
        let moment = flight.moment(proper_time);
        let (event, velocity) = (moment.event(), moment.velocity());
        let four = |Event { time, position }: Event| [time, position.x, position.y, position.z];
        Self {
            proper_time,
            time: event.time,
            position: event.position.to_array(),
            velocity: (velocity.direction() * velocity.beta()).to_array(),
            gamma: velocity.gamma(),
            rapidity: velocity.rapidity(),
            axes: moment.axes().map(four),
            acceleration: flight.acceleration(proper_time).to_array(),
        }
    }
}
