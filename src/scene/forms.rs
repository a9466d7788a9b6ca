//! The several ways in which a scene may write one value, each read with errors of its own.
//!
//! `#[serde(untagged)]` alone would answer every mistake with "did not match any variant"; these visitors
//! look at what stands there first.

use std::fmt;
use std::marker::PhantomData;
use std::path::PathBuf;

use glam::DVec3;
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::steps::even_steps;
use crate::shape::{Cone, Cuboid, Cylinder, Grid, Lattice, Rod, Shape, Sphere, Torus};
use crate::spacetime::{Velocity, VelocityError};

/// A type that a scene writes as an object with keys.
pub(super) trait Keyed {
    /// What to expect, with an example.
    const EXPECTED: &'static str;
}

/// Reads a type from an object with keys only: what serde derives would take a list of the values too,
/// whose order nobody should have to know.
pub(super) struct FromObject<T>(pub(super) T);

impl<'de, T: Deserialize<'de> + Keyed> Deserialize<'de> for FromObject<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        from_object(deserializer).map(Self)
    }
}

/// The same as a function for `deserialize_with`.
pub(super) fn from_object<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + Keyed,
{
    struct TaggedVisitor<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de> + Keyed> Visitor<'de> for TaggedVisitor<T> {
        type Value = T;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(T::EXPECTED)
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
            T::deserialize(MapAccessDeserializer::new(map))
        }
    }
    deserializer.deserialize_any(TaggedVisitor(PhantomData))
}

macro_rules! keyed {
    ($($kind:ty: $expected:literal),* $(,)?) => {
        $(impl Keyed for $kind {
            const EXPECTED: &'static str = $expected;
        })*
    };
}

keyed! {
    Sphere: "a sphere like { \"radius\": 1 }",
    Cuboid: "a box like { \"size\": [1, 1, 1] }",
    Cylinder: "a cylinder like { \"radius\": 1, \"height\": 2 }",
    Cone: "a cone like { \"radius\": 1, \"height\": 2 }",
    Torus: "a torus like { \"major_radius\": 2, \"minor_radius\": 1 }",
    Rod: "a rod like { \"length\": 10, \"radius\": 0.1 }",
    Grid: "a grid like { \"size\": 10, \"cells\": 10 }",
    Lattice: "a lattice like { \"cells\": 4, \"spacing\": 1, \"thickness\": 0.1 }",
}

/// Names of shapes in a scene.
const SHAPES: &[&str] = &[
    "sphere", "box", "cylinder", "cone", "torus", "rod", "grid", "lattice",
];

/// Exactly one shape.
pub(super) fn shape<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Shape>, D::Error> {
    struct ShapeVisitor;
    impl<'de> Visitor<'de> for ShapeVisitor {
        type Value = Shape;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a shape like { \"sphere\": { \"radius\": 1 } }")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Shape, A::Error> {
            let Some(kind) = map.next_key::<String>()? else {
                return Err(A::Error::invalid_value(Unexpected::Map, &self));
            };
            let shape = match kind.as_str() {
                "sphere" => Shape::Sphere(map.next_value::<FromObject<_>>()?.0),
                "box" => Shape::Cuboid(map.next_value::<FromObject<_>>()?.0),
                "cylinder" => Shape::Cylinder(map.next_value::<FromObject<_>>()?.0),
                "cone" => Shape::Cone(map.next_value::<FromObject<_>>()?.0),
                "torus" => Shape::Torus(map.next_value::<FromObject<_>>()?.0),
                "rod" => Shape::Rod(map.next_value::<FromObject<_>>()?.0),
                "grid" => Shape::Grid(map.next_value::<FromObject<_>>()?.0),
                "lattice" => Shape::Lattice(map.next_value::<FromObject<_>>()?.0),
                _ => {
                    return Err(A::Error::custom(format_args!(
                        "unknown shape `{kind}`, expected one of {}",
                        SHAPES.join(", ")
                    )));
                }
            };
            match map.next_key::<String>()? {
                None => Ok(shape),
                Some(second) => Err(A::Error::custom(format_args!(
                    "both `{kind}` and `{second}`, expected exactly one shape"
                ))),
            }
        }
    }
    deserializer.deserialize_any(ShapeVisitor).map(Some)
}

/// The name of a file.
pub(super) fn file<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<PathBuf>, D::Error> {
    let name = String::deserialize(deserializer)?;
    if name.is_empty() {
        return Err(D::Error::custom(
            "the file name is empty, expected a glTF, GLB, OBJ, PLY, STL or OFF file",
        ));
    }
    Ok(Some(name.into()))
}

/// A velocity: the vector, or a speed and a direction.
#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only; `velocity` below does the reading.
pub(super) enum VelocityForm {
    /// The velocity vector [bx, by, bz] in units of the speed of light.
    Vector([f64; 3]),
    /// A speed with a direction.
    Speed(SpeedForm),
}

/// A speed, given in exactly one of four ways, with a direction.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "required": ["beta"] },
    { "required": ["one_minus_beta"] },
    { "required": ["gamma"] },
    { "required": ["rapidity"] },
]))]
pub(super) struct SpeedForm {
    /// Speed in units of the speed of light, 0 <= beta < 1.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1))]
    beta: Option<f64>,
    /// 1 - beta, for speeds that beta cannot say, 0 < one_minus_beta <= 1.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    one_minus_beta: Option<f64>,
    /// Lorentz factor, gamma >= 1.
    #[schemars(extend("minimum" = 1))]
    gamma: Option<f64>,
    /// atanh(beta), from 0 to 350.
    #[schemars(extend("minimum" = 0, "maximum" = 350))]
    rapidity: Option<f64>,
    /// Direction of motion, of any length; [0, 0, -1] if absent.
    direction: Option<[f64; 3]>,
}

pub(super) fn velocity<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Velocity, D::Error> {
    struct VelocityVisitor;
    impl<'de> Visitor<'de> for VelocityVisitor {
        type Value = Velocity;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(
                "a velocity [bx, by, bz] or a speed like { \"beta\": 0.9, \"direction\": [1, 0, 0] }",
            )
        }

        fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Velocity, A::Error> {
            let vector = <[f64; 3]>::deserialize(SeqAccessDeserializer::new(seq))?;
            Velocity::from_vector(vector.into()).map_err(A::Error::custom)
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Velocity, A::Error> {
            let form = SpeedForm::deserialize(MapAccessDeserializer::new(map))?;
            let direction = form.direction.map_or(DVec3::NEG_Z, DVec3::from);
            type FromNumber = fn(f64, DVec3) -> Result<Velocity, VelocityError>;
            let ways: [(Option<f64>, FromNumber); 4] = [
                (form.beta, Velocity::from_beta),
                (form.one_minus_beta, Velocity::from_one_minus_beta),
                (form.gamma, Velocity::from_gamma),
                (form.rapidity, Velocity::from_rapidity),
            ];
            let mut given = ways
                .iter()
                .filter_map(|(number, from)| Some((number.as_ref()?, from)));
            match (given.next(), given.next()) {
                (Some((&number, from)), None) => from(number, direction).map_err(A::Error::custom),
                _ => Err(A::Error::custom(
                    "a speed needs exactly one of beta, one_minus_beta, gamma, rapidity",
                )),
            }
        }
    }
    deserializer.deserialize_any(VelocityVisitor)
}

/// Proper times: a list, or evenly spaced ones.
#[derive(JsonSchema)]
#[schemars(with = "StepsForm")]
pub(super) struct Steps(pub(super) Vec<f64>);

#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only.
enum StepsForm {
    /// Proper times of the observer after the observation event.
    List(#[schemars(length(min = 1))] Vec<f64>),
    /// Evenly spaced proper times.
    Even(EvenSteps),
}

/// `count` evenly spaced proper times, the first `from`, the last `to`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct EvenSteps {
    /// The first.
    from: f64,
    /// The last.
    to: f64,
    /// How many, from 1 to 100000.
    #[schemars(range(min = 1, max = 100_000))]
    count: usize,
}

impl Default for Steps {
    fn default() -> Self {
        Self(vec![0.0])
    }
}

impl<'de> Deserialize<'de> for Steps {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct StepsVisitor;
        impl<'de> Visitor<'de> for StepsVisitor {
            type Value = Steps;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of proper times or { \"from\": -6, \"to\": 6, \"count\": 7 }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Steps, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Steps)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Steps, A::Error> {
                let even = EvenSteps::deserialize(MapAccessDeserializer::new(map))?;
                even_steps(even.from, even.to, even.count)
                    .map(Steps)
                    .map_err(A::Error::custom)
            }
        }
        deserializer.deserialize_any(StepsVisitor)
    }
}
