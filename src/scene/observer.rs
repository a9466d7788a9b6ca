//! The observer of a scene.

use schemars::JsonSchema;
use serde::Deserialize;

use super::forms::{self, Keyed, VelocityForm};
use super::{MarkerRadius, Place, Time};
use crate::spacetime::{Event, Moment, Velocity, WorldLine};

/// The observer: the event of the observation and a velocity.
#[derive(Clone, Copy, Debug, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Observer {
    /// Scene time of the observation.
    #[schemars(with = "f64")]
    pub time: Time,
    /// Place of the observation in the scene frame.
    #[schemars(with = "[f64; 3]")]
    pub position: Place,
    /// The observer's velocity in the scene frame.
    #[serde(deserialize_with = "forms::velocity")]
    #[schemars(with = "VelocityForm")]
    pub velocity: Velocity,
    /// Radius of a small sphere that marks the observer in the output; no marker without it.
    pub marker: Option<MarkerRadius>,
}

impl Observer {
    /// What the observer is at `proper_time` after the observation event.
    pub fn moment(&self, proper_time: f64) -> Moment {
        let line = WorldLine {
            origin: Event::new(self.time.get(), self.position.get()),
            velocity: self.velocity,
        };
        line.moment(proper_time)
    }
}

impl Keyed for Observer {
    const EXPECTED: &'static str = "an observer like { \"velocity\": { \"beta\": 0.9 } }";
}
