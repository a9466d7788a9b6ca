//! An observer's axes as a scene writes them: two directions, or a quaternion.

use std::fmt;

use glam::DVec3;
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::spacetime::Rotation;

/// The observer's axes: a direction to look in, or a quaternion.
#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only; `orientation` below does the reading.
pub(super) enum OrientationForm {
    /// A unit quaternion [x, y, z, w] that turns the axes.
    Quaternion([f64; 4]),
    /// Where the observer looks.
    Looking(LookingForm),
}

/// Where the observer looks; both directions are of any length.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LookingForm {
    /// Direction of the observer's own -z axis.
    look: [f64; 3],
    /// Direction that is up for the observer; [0, 1, 0] if absent.
    up: Option<[f64; 3]>,
}

pub(super) fn orientation<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Rotation, D::Error> {
    struct OrientationVisitor;
    impl<'de> Visitor<'de> for OrientationVisitor {
        type Value = Rotation;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("axes like { \"look\": [1, 0, 0] } or a unit quaternion [x, y, z, w]")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Rotation, A::Error> {
            Rotation::deserialize(SeqAccessDeserializer::new(seq))
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Rotation, A::Error> {
            let form = LookingForm::deserialize(MapAccessDeserializer::new(map))?;
            let up = form.up.map_or(DVec3::Y, DVec3::from);
            Rotation::looking(form.look.into(), up).map_err(A::Error::custom)
        }
    }
    deserializer.deserialize_any(OrientationVisitor)
}
