//! Segments and integrators of a flight, as scenes and files of flights write them.

use std::fmt;

use glam::DVec3;
use schemars::JsonSchema;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::forms::{self, Keyed};
use super::{InvalidScene, Units};
use crate::spacetime::{Integrator, Segment};

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
