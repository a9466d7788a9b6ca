//! Lamps as a scene file writes them.

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::emission::kelvin;
use super::forms::{self, FromObject, Keyed, VelocityForm};
use super::lamp::{Carrier, Flash, Lamp, LampError};
use super::{Place, Time};
use crate::effects::Temperature;
use crate::shape::Color;
use crate::spacetime::Velocity;

/// A lamp as a file writes it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Lamp")]
#[schemars(extend(
    "oneOf" = [{ "required": ["point"] }, { "required": ["sun"] }, { "required": ["ambient"] }],
    "dependentRequired" = { "velocity": ["point"], "object": ["point"], "flash": ["point"] },
    "not" = { "anyOf": [{ "required": ["kelvin", "color"] }, { "required": ["velocity", "object"] }] },
))]
pub(super) struct LampFields {
    /// A lamp that is a point, as bright in all directions.
    #[serde(default)]
    #[schemars(with = "PointFields")]
    point: Option<FromObject<PointFields>>,
    /// A sun at rest in the scene frame, infinitely far away.
    #[serde(default)]
    #[schemars(with = "SunFields")]
    sun: Option<FromObject<SunFields>>,
    /// Light from all around, the same in all directions in the scene frame.
    #[serde(default)]
    #[schemars(with = "AmbientFields")]
    ambient: Option<FromObject<AmbientFields>>,
    /// The temperature of the light at rest with the lamp, in kelvin, from 500 to 1e12; 6504, daylight, if absent.
    #[serde(default, deserialize_with = "some_kelvin")]
    #[schemars(with = "f64", range(min = 500, max = 1e12))]
    kelvin: Option<Temperature>,
    /// The colour of a filter before daylight, "#rrggbb"; either this or `kelvin`.
    color: Option<Color>,
    /// The velocity of a point in the scene frame; at rest if absent.
    #[serde(default, deserialize_with = "some_velocity")]
    #[schemars(with = "VelocityForm")]
    velocity: Option<Velocity>,
    /// The name of the object on which a point rides: its position is then one in the rest frame of the object, and the
    /// object casts no shadow in its light.
    object: Option<String>,
    /// The times between which a point shines, in its own proper time: that is 0 at scene time 0 where its position says,
    /// or that of the object on which it rides. Always if absent.
    #[serde(default, deserialize_with = "some_flash")]
    #[schemars(with = "FlashFields")]
    flash: Option<Flash>,
}

/// A lamp that is a point, as bright in all directions.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PointFields {
    /// Where it is at scene time 0 in the scene frame, or in the rest frame of the object on which it rides.
    #[schemars(with = "[f64; 3]")]
    position: Place,
    /// The luminance of a white matte surface at distance 1 that faces the lamp, at rest with it: 0 or more.
    #[schemars(range(min = 0))]
    intensity: f64,
}

/// A sun at rest in the scene frame, infinitely far away.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SunFields {
    /// The direction in which its light travels, of any length.
    direction: [f64; 3],
    /// The luminance of a white matte surface that faces it, at rest in the scene frame: 0 or more.
    #[schemars(range(min = 0))]
    irradiance: f64,
}

/// Light from all around, the same in all directions in the scene frame.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AmbientFields {
    /// The luminance of a white matte surface at rest in the scene frame: 0 or more.
    #[schemars(range(min = 0))]
    irradiance: f64,
}

/// The times between which a lamp shines.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Flash")]
struct FlashFields {
    /// The lamp's proper time when it begins to shine.
    #[schemars(with = "f64")]
    from: Time,
    /// The lamp's proper time when it ends.
    #[schemars(with = "f64")]
    to: Time,
}

impl<'de> Deserialize<'de> for Lamp {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let FromObject(fields) = FromObject::<LampFields>::deserialize(deserializer)?;
        fields.lamp().map_err(D::Error::custom)
    }
}

impl LampFields {
    fn lamp(self) -> Result<Lamp, LampError> {
        let fields = self;
        let mut lamp = match (fields.point, fields.sun, fields.ambient) {
            (Some(FromObject(point)), None, None) => Lamp::point(point.position, point.intensity)?,
            (None, Some(FromObject(sun)), None) => Lamp::sun(sun.direction.into(), sun.irradiance)?,
            (None, None, Some(FromObject(ambient))) => Lamp::ambient(ambient.irradiance)?,
            (None, None, None) => return Err(LampError::Sources("no source")),
            _ => return Err(LampError::Sources("several sources")),
        };
        lamp = match (fields.kelvin, fields.color) {
            (Some(_), Some(_)) => return Err(LampError::TwoColors),
            (Some(kelvin), None) => lamp.with_temperature(kelvin),
            (None, Some(color)) => lamp.with_color(color),
            (None, None) => lamp,
        };
        lamp = match (fields.velocity, fields.object) {
            (Some(_), Some(_)) => return Err(LampError::TwoMotions),
            (Some(velocity), None) => lamp.carried(Carrier::Own(velocity))?,
            (None, Some(name)) => lamp.carried(Carrier::Object(name))?,
            (None, None) => lamp,
        };
        match fields.flash {
            Some(flash) => lamp.flashing(flash),
            None => Ok(lamp),
        }
    }
}

fn some_flash<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Flash>, D::Error> {
    let FromObject(fields) = FromObject::<FlashFields>::deserialize(deserializer)?;
    let flash = Flash::new(fields.from.get(), fields.to.get());
    flash.map(Some).map_err(D::Error::custom)
}

fn some_kelvin<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Temperature>, D::Error> {
    kelvin(deserializer).map(Some)
}

fn some_velocity<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Velocity>, D::Error> {
    forms::velocity(deserializer).map(Some)
}

impl Keyed for LampFields {
    const EXPECTED: &'static str =
        "a lamp like { \"point\": { \"position\": [0, 3, 0], \"intensity\": 4 } }";
}

impl Keyed for PointFields {
    const EXPECTED: &'static str = "a point like { \"position\": [0, 3, 0], \"intensity\": 4 }";
}

impl Keyed for SunFields {
    const EXPECTED: &'static str = "a sun like { \"direction\": [0, -1, 0], \"irradiance\": 1 }";
}

impl Keyed for AmbientFields {
    const EXPECTED: &'static str = "light like { \"irradiance\": 0.2 }";
}

impl Keyed for FlashFields {
    const EXPECTED: &'static str = "a flash like { \"from\": 0, \"to\": 1 }";
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{LampSource, Scene, SceneError};
    use super::*;

    fn scene(lamps: &str) -> Result<Scene, SceneError> {
        let sphere = r#"{ "name": "s", "shape": { "sphere": { "radius": 1 } } }"#;
        Scene::from_json(&format!(
            "{{ \"objects\": [ {sphere} ],\n\"lamps\": {lamps} }}"
        ))
    }

    #[test]
    fn lamps_are_read_as_written() {
        assert!(scene("[]").unwrap().lamps().is_empty());
        let text = r##"[
            { "point": { "position": [1, 2, 3], "intensity": 4 }, "kelvin": 3000, "velocity": [0.5, 0, 0] },
            { "point": { "position": [0, 1, 0], "intensity": 0 }, "color": "#ff8000", "object": "s",
              "flash": { "from": -1, "to": 2 } },
            { "sun": { "direction": [0, -2, 0], "irradiance": 0.5 } },
            { "ambient": { "irradiance": 0.25 } } ]"##;
        let scene = scene(text).unwrap();
        let [point, rider, sun, ambient] = scene.lamps() else {
            panic!("four lamps")
        };
        let LampSource::Point(own) = point.source() else {
            panic!("a point")
        };
        assert_eq!(own.position().get(), DVec3::new(1.0, 2.0, 3.0));
        assert!(matches!(own.carrier(), Carrier::Own(velocity) if velocity.beta() > 0.49));
        assert_eq!(point.temperature().kelvin(), 3000.0);
        let LampSource::Point(riding) = rider.source() else {
            panic!("a point")
        };
        assert_eq!(riding.carrier(), &Carrier::Object("s".to_owned()));
        let flash = riding.flash().unwrap();
        assert_eq!(
            [-1.1, -1.0, 1.9, 2.0].map(|time| flash.is_on(time)),
            [false, true, true, false]
        );
        assert_eq!(rider.color(), Some(Color([0xff, 0x80, 0x00])));
        assert!(
            matches!(sun.source(), LampSource::Sun { direction, .. } if *direction == DVec3::NEG_Y)
        );
        assert_eq!(sun.temperature(), Temperature::DAYLIGHT);
        assert!(matches!(
            ambient.source(),
            LampSource::Ambient { irradiance: 0.25 }
        ));
    }

    #[test]
    fn mistakes_are_told_with_number_place_and_expectation() {
        let point = r#""point": { "position": [0, 0, 0], "intensity": 1 }"#;
        let of_point = |more: &str| format!("{{ {point}, {more} }}");
        for (lamp, at, words) in [
            (
                "[]".into(),
                "lamps[1]",
                "found a list, expected a lamp like {",
            ),
            (
                "{}".into(),
                "lamps[1]",
                "no source, expected exactly one of \"point\", \"sun\"",
            ),
            (
                of_point(r#""ambient": { "irradiance": 1 }"#),
                "lamps[1]",
                "several sources",
            ),
            (
                of_point(r##""kelvin": 3000, "color": "#ffffff""##),
                "lamps[1]",
                "both \"kelvin\" and \"color\"",
            ),
            (
                of_point(r#""object": "s", "velocity": [0, 0, 0]"#),
                "lamps[1]",
                "both \"velocity\" and \"object\"",
            ),
            (
                of_point(r#""kelvin": 20"#),
                "lamps[1].kelvin",
                "the temperature is 20.0 kelvin, expected 500",
            ),
            (
                of_point(r#""flash": { "from": 2, "to": 2 }"#),
                "lamps[1].flash",
                "the flash is from 2.0 to 2.0",
            ),
            (
                of_point(r#""flash": 2"#),
                "lamps[1].flash",
                "expected a flash like",
            ),
            (
                of_point(r#""velocity": [1, 0, 0]"#),
                "lamps[1].velocity",
                "below the speed of light",
            ),
            (
                of_point(r#""colour": 1"#),
                "lamps[1].colour",
                "unknown key `colour`",
            ),
            (
                r#"{ "point": { "position": [0, 0, 0], "intensity": -1 } }"#.into(),
                "lamps[1]",
                "the intensity is -1.0",
            ),
            (
                r#"{ "point": { "intensity": 1 } }"#.into(),
                "lamps[1].point",
                "missing key `position`",
            ),
            (
                r#"{ "sun": { "direction": [0, 0, 0], "irradiance": 1 } }"#.into(),
                "lamps[1]",
                "the direction is [0, 0, 0]",
            ),
            (
                r#"{ "sun": { "direction": [0, 1, 0], "irradiance": 1 }, "object": "s" }"#.into(),
                "lamps[1]",
                "\"object\" is for lamps that are a \"point\"",
            ),
            (
                r#"{ "ambient": { "irradiance": -0.5 } }"#.into(),
                "lamps[1]",
                "the irradiance is -0.5",
            ),
            (
                of_point(r#""object": "t""#),
                "",
                "lamps[1] rides on \"t\", expected the name of an object",
            ),
        ] {
            let error = scene(&format!("[ {{ {point} }}, {lamp} ]")).expect_err(&lamp);
            assert_eq!(error.at, at, "{lamp}\n{error}");
            assert!(error.message.contains(words), "{lamp}\n{error}");
        }
    }
}
