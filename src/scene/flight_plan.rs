//! A flight in a file of its own.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::flight::{self, SegmentForm, segments};
use super::forms::FromObject;
use super::{Scene, SceneError, Units, json};
use crate::spacetime::{Integrator, Segment};

/// A flight by itself, as in a file of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightPlan {
    /// The segments of the flight, in their order.
    pub segments: Vec<Segment>,
    /// How the flight is computed; as the scene says if the file does not.
    pub integrator: Option<Integrator>,
    /// The units of all numbers, those of the scene if it says what they are.
    pub units: Option<Units>,
}

impl FlightPlan {
    /// Reads a flight from JSON text: the list of its segments, or an object like `{ "flight": [...], "integrator":
    /// "exact" }`. Accelerations in g need units, its own or those of the scene, `scene_units`.
    ///
    /// # Errors
    ///
    /// Malformed JSON, unknown keys, wrong types, impossible values, other units than those of the scene: line, column,
    /// place and what was expected.
    pub fn from_json(text: &str, scene_units: Option<Units>) -> Result<Self, SceneError> {
        let at_end = |message: String| json::at_end(text, message);
        let form: FlightForm = json::read(text, "flight").map_err(|error| {
            match Scene::from_json(text) {
                Ok(_) => at_end(
                    "this is a scene, expected its flight alone: a list of segments like [{ \"proper_time\": 2, \
                     \"acceleration\": [0, 0, -0.5] }]"
                        .to_owned(),
                ),
                Err(_) => error,
            }
        })?;
        if let (Some(own), Some(scene)) = (form.units, scene_units)
            && own != scene
        {
            return Err(at_end(format!(
                "units: length_m is {:?}, expected that of the scene, {:?}, or no units",
                own.length_m(),
                scene.length_m()
            )));
        }
        let units = form.units.or(scene_units);
        let segments = segments(form.flight, units);
        Ok(Self {
            segments: segments.map_err(|error| at_end(error.to_string()))?,
            integrator: form.integrator,
            units,
        })
    }
}

/// The flight of a file: a list of segments, or an object with them.
#[derive(Default)]
struct FlightForm {
    flight: Vec<SegmentForm>,
    integrator: Option<Integrator>,
    units: Option<Units>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FlightFields {
    flight: Vec<SegmentForm>,
    #[serde(default, deserialize_with = "some_integrator")]
    integrator: Option<Integrator>,
    units: Option<FromObject<Units>>,
}

impl<'de> Deserialize<'de> for FlightForm {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FlightVisitor;
        impl<'de> Visitor<'de> for FlightVisitor {
            type Value = FlightForm;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a list of segments or { \"flight\": [{ \"proper_time\": 2, \"acceleration\": [0, 0, -0.5] }] }",
                )
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<FlightForm, A::Error> {
                Ok(FlightForm {
                    flight: Vec::deserialize(SeqAccessDeserializer::new(seq))?,
                    ..FlightForm::default()
                })
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FlightForm, A::Error> {
                let fields = FlightFields::deserialize(MapAccessDeserializer::new(map))?;
                Ok(FlightForm {
                    flight: fields.flight,
                    integrator: fields.integrator,
                    units: fields.units.map(|FromObject(units)| units),
                })
            }
        }
        deserializer.deserialize_any(FlightVisitor)
    }
}

fn some_integrator<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Integrator>, D::Error> {
    flight::integrator(deserializer).map(Some)
}
