//! The observer of a scene.

use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::flight::{self, IntegratorForm, SegmentForm};
use super::forms::{self, Keyed, VelocityForm};
use super::orientation::{self, OrientationForm};
use super::{InvalidScene, MarkerRadius, Place, Time, Units};
use crate::spacetime::{
    Event, Flight, FlightError, Integrator, Lorentz, Moment, Rotation, Segment, Velocity,
};

/// The observer: the event of the observation, a velocity, axes, and a flight from there.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Observer {
    /// Scene time of the observation.
    pub time: Time,
    /// Place of the observation in the scene frame.
    pub position: Place,
    /// The observer's velocity in the scene frame, at the observation.
    pub velocity: Velocity,
    /// The observer's own axes at the observation: those of the scene under a pure boost, turned by this rotation.
    pub orientation: Rotation,
    /// What the observer does after the observation, segment by segment; afterwards, and before, the observer coasts.
    pub flight: Vec<Segment>,
    /// How the flight is computed.
    pub integrator: Integrator,
    /// Radius of a small sphere that marks the observer in the output; no marker without it.
    pub marker: Option<MarkerRadius>,
}

impl Observer {
    /// Whether the observer's own axes are other than those of the scene under a pure boost, at the observation or later.
    pub fn has_own_axes(&self) -> bool {
        !self.flight.is_empty() || self.orientation != Rotation::IDENTITY
    }

    /// What the observer is at the observation.
    pub fn start(&self) -> Moment {
        let event = Event::new(self.time.get(), self.position.get());
        let boosted = Moment::new(event, Lorentz::boost(self.velocity));
        match self.orientation == Rotation::IDENTITY {
            true => boosted,
            false => boosted.turned(self.orientation),
        }
    }

    /// What the observer is at any proper time after the observation.
    ///
    /// # Errors
    ///
    /// The flight is not possible: see [`Flight::new`].
    pub fn to_flight(&self) -> Result<Flight, FlightError> {
        Flight::new(self.start(), self.flight.clone(), self.integrator)
    }
}

/// The observer: the event of the observation, a velocity, axes, and a flight from there.
#[derive(Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(rename = "Observer")]
pub(super) struct ObserverFields {
    /// Scene time of the observation.
    #[schemars(with = "f64")]
    time: Time,
    /// Place of the observation in the scene frame.
    #[schemars(with = "[f64; 3]")]
    position: Place,
    /// The observer's velocity in the scene frame, at the observation.
    #[serde(deserialize_with = "forms::velocity")]
    #[schemars(with = "VelocityForm")]
    velocity: Velocity,
    /// The observer's own axes at the observation, x right, y up, looking along -z: in the observer's frame, whose axes a
    /// pure boost makes of those of the scene. Those of the frame if absent.
    #[serde(deserialize_with = "orientation::orientation")]
    #[schemars(with = "OrientationForm")]
    orientation: Rotation,
    /// What the observer does after the observation, segment by segment. Before the first segment and after the last one
    /// the observer coasts, axes unturned. Coasting alone if absent.
    flight: Vec<SegmentForm>,
    /// How the flight is computed: "exact", { "euler": STEP } or { "rk4": STEP }, steps in proper time; "exact" if absent.
    #[serde(deserialize_with = "flight::integrator")]
    #[schemars(with = "IntegratorForm")]
    integrator: Integrator,
    /// Radius of a small sphere that marks the observer in the output; no marker without it.
    marker: Option<MarkerRadius>,
}

impl ObserverFields {
    /// The observer, in a scene of these units.
    pub(super) fn observer(self, units: Option<Units>) -> Result<Observer, InvalidScene> {
        Ok(Observer {
            time: self.time,
            position: self.position,
            velocity: self.velocity,
            orientation: self.orientation,
            flight: flight::segments(self.flight, units)?,
            integrator: self.integrator,
            marker: self.marker,
        })
    }
}

/// Reads an observer, and checks there its flight, unless that needs units which may come later.
pub(super) fn observer<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<ObserverFields, D::Error> {
    let fields: ObserverFields = forms::from_object(deserializer)?;
    if let Ok(observer) = fields.clone().observer(None) {
        let flight = observer.to_flight().map_err(InvalidScene::from);
        flight.map_err(D::Error::custom)?;
    }
    Ok(fields)
}

impl Keyed for ObserverFields {
    const EXPECTED: &'static str = "an observer like { \"velocity\": { \"beta\": 0.9 } }";
}
