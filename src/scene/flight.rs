//! A flight as a scene or a file of its own writes it.

use std::fmt;

use glam::DVec3;
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::forms::{self, FromObject, Keyed};
use super::{InvalidScene, Scene, SceneError, Units, json};
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

/// A segment that may have its acceleration in g.
#[derive(Clone, Copy, Debug)]
pub(super) struct SegmentForm {
    segment: Segment,
    is_in_g: bool,
}

/// The segments with all accelerations in units of the scene.
pub(super) fn segments(
    forms: Vec<SegmentForm>,
    units: Option<Units>,
) -> Result<Vec<Segment>, InvalidScene> {
    let segment = |(index, form): (usize, SegmentForm)| match (form.is_in_g, units) {
        (false, _) => Ok(form.segment),
        (true, None) => Err(InvalidScene::NoUnits(index)),
        (true, Some(units)) => {
            let segment = form.segment.with_acceleration_times(units.gravity());
            segment.map_err(|error| InvalidScene::Segment(index, error))
        }
    };
    forms.into_iter().enumerate().map(segment).collect()
}

/// A part of a flight during which engines and rudders stay as they are.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["acceleration", "acceleration_g"] }))]
pub(super) struct SegmentFields {
    /// How long the segment lasts, in proper time of the observer, above 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    proper_time: f64,
    /// Proper acceleration in the observer's own axes (x right, y up, looking along -z), in c^2 per unit of length; none
    /// if absent.
    acceleration: Option<[f64; 3]>,
    /// The same in g (9.80665 m/s^2); needs the scene's `units`.
    acceleration_g: Option<[f64; 3]>,
    /// Rate and axis of the turn in the observer's own axes, in radians per unit of proper time, by the right-hand rule;
    /// none if absent.
    turn_rate: Option<[f64; 3]>,
    /// "free": the observer turns as `turn_rate` says; "coordinated": like an airplane, so that the direction of motion
    /// keeps its place in the observer's own axes; without `turn_rate`. "free" if absent.
    steer: Option<Steer>,
}

#[derive(Clone, Copy, JsonSchema, PartialEq, Eq)]
#[schemars(rename_all = "lowercase")]
enum Steer {
    Free,
    Coordinated,
}

impl<'de> Deserialize<'de> for Steer {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match String::deserialize(deserializer)?.as_str() {
            "free" => Ok(Self::Free),
            "coordinated" => Ok(Self::Coordinated),
            other => Err(D::Error::custom(format_args!(
                "found \"{other}\", expected \"free\" or \"coordinated\""
            ))),
        }
    }
}

impl Keyed for SegmentFields {
    const EXPECTED: &'static str =
        "a segment like { \"proper_time\": 2, \"acceleration\": [0, 0, -0.5] }";
}

impl JsonSchema for SegmentForm {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Segment".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        SegmentFields::json_schema(generator)
    }
}

impl<'de> Deserialize<'de> for SegmentForm {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fields: SegmentFields = forms::from_object(deserializer)?;
        let acceleration = match (fields.acceleration, fields.acceleration_g) {
            (Some(_), Some(_)) => {
                return Err(D::Error::custom(
                    "found both \"acceleration\" and \"acceleration_g\", expected one of them",
                ));
            }
            (acceleration, acceleration_g) => acceleration.or(acceleration_g).unwrap_or_default(),
        };
        let (proper_time, acceleration) = (fields.proper_time, DVec3::from(acceleration));
        let segment = match (fields.steer, fields.turn_rate) {
            (Some(Steer::Coordinated), Some(_)) => {
                return Err(D::Error::custom(
                    "found \"turn_rate\" beside \"steer\": \"coordinated\", whose turn rate follows from the acceleration; \
                     expected one of them",
                ));
            }
            (Some(Steer::Coordinated), None) => Segment::coordinated(proper_time, acceleration),
            (_, turn_rate) => {
                let turn_rate = turn_rate.unwrap_or_default().into();
                Segment::free(proper_time, acceleration, turn_rate)
            }
        };
        Ok(Self {
            segment: segment.map_err(D::Error::custom)?,
            is_in_g: fields.acceleration_g.is_some(),
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

/// How a flight is computed: a method with its step.
#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only; `integrator` below does the reading.
pub(super) enum IntegratorForm {
    /// By closed forms, to rounding.
    Exact(ExactForm),
    /// By a method that takes steps, to show what accuracy costs.
    Stepped(SteppedForm),
}

#[derive(JsonSchema)]
#[serde(rename_all = "lowercase")]
#[allow(dead_code)] // Read by the schema only.
pub(super) enum ExactForm {
    Exact,
}

/// A method, with the proper time of its steps.
#[derive(JsonSchema)]
#[serde(rename_all = "lowercase")]
#[allow(dead_code)] // Read by the schema only.
pub(super) enum SteppedForm {
    /// Euler's method: errors as the step.
    Euler(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// The classical method of Runge and Kutta: errors as the fourth power of the step.
    Rk4(#[schemars(extend("exclusiveMinimum" = 0))] f64),
}

pub(super) fn integrator<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Integrator, D::Error> {
    struct IntegratorVisitor;
    impl<'de> Visitor<'de> for IntegratorVisitor {
        type Value = Integrator;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("\"exact\", { \"euler\": STEP } or { \"rk4\": STEP }")
        }

        fn visit_str<E: Error>(self, name: &str) -> Result<Integrator, E> {
            match name {
                "exact" => Ok(Integrator::Exact),
                _ => Err(E::invalid_value(serde::de::Unexpected::Str(name), &self)),
            }
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Integrator, A::Error> {
            let Some(method) = map.next_key::<String>()? else {
                return Err(A::Error::invalid_value(serde::de::Unexpected::Map, &self));
            };
            let integrator = match method.as_str() {
                "euler" => Integrator::euler(map.next_value()?),
                "rk4" => Integrator::runge_kutta_4(map.next_value()?),
                "exact" => {
                    return Err(A::Error::custom(
                        "\"exact\" takes no step, expected \"exact\" alone",
                    ));
                }
                _ => {
                    return Err(A::Error::custom(format_args!(
                        "unknown integrator `{method}`, expected \"exact\", {{ \"euler\": STEP }} or {{ \"rk4\": STEP }}"
                    )));
                }
            };
            match map.next_key::<String>()? {
                None => integrator.map_err(A::Error::custom),
                Some(second) => Err(A::Error::custom(format_args!(
                    "both `{method}` and `{second}`, expected exactly one integrator"
                ))),
            }
        }
    }
    deserializer.deserialize_any(IntegratorVisitor)
}

fn some_integrator<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Integrator>, D::Error> {
    integrator(deserializer).map(Some)
}
