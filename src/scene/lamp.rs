//! Lamps that light a scene.

use std::fmt;

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::emission::kelvin;
use super::forms::{self, FromObject, Keyed, VelocityForm};
use super::{Place, Time};
use crate::effects::Temperature;
use crate::shape::Color;
use crate::spacetime::{Velocity, unit};

/// A lamp: a point, a sun infinitely far away, or light from all around.
///
/// Its light travels with the speed of light from where the lamp was; a surface in motion has it from an aberrated direction
/// and, where a scene asks for the Doppler or the searchlight effect, shifted.
///
/// # Units
///
/// A white matte surface at rest with the lamp, facing it, has the luminance 1 at distance 1 from a point of intensity 1, and
/// in the light of a sun or of surroundings of irradiance 1: pi is divided out.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "FromObject<LampFields>")]
#[schemars(with = "LampFields")]
pub struct Lamp {
    source: LampSource,
    temperature: Temperature,
    color: Option<Color>,
}

/// Where the light of a lamp comes from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LampSource {
    /// A point.
    Point(PointLamp),
    /// A sun at rest in the scene frame, infinitely far away.
    Sun {
        /// The unit direction in which its light travels, in the scene frame.
        direction: DVec3,
        /// Irradiance of a surface that faces it, at rest in the scene frame.
        irradiance: f64,
    },
    /// Surroundings at rest in the scene frame, the same in all directions there.
    Ambient {
        /// Irradiance of a surface at rest in the scene frame.
        irradiance: f64,
    },
}

/// A lamp that is a point, as bright in all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLamp {
    position: Place,
    intensity: f64,
    carrier: Carrier,
    flash: Option<Flash>,
}

/// How a lamp moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Carrier {
    /// By itself: where its position says at scene time 0.
    Own(Velocity),
    /// With the object of this name: where its position says in the object's rest frame.
    Object(String),
}

/// The times between which a lamp shines, in its own proper time: that is 0 at scene time 0, or as that of the object on
/// which it rides.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "FromObject<FlashFields>")]
#[schemars(with = "FlashFields")]
pub struct Flash {
    from: f64,
    to: f64,
}

/// Why numbers do not make a lamp.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LampError {
    /// No source or several.
    #[error("a lamp has {0}, expected exactly one of \"point\", \"sun\" and \"ambient\"")]
    Sources(&'static str),
    /// A strength that is negative or not finite.
    #[error("the {0} is {1:?}, expected a finite number >= 0")]
    Strength(&'static str, f64),
    /// A direction without direction.
    #[error("the direction is {0}, expected a finite vector that is not zero")]
    Direction(DVec3),
    /// A flash that does not begin before it ends.
    #[error(
        "the flash is from {0:?} to {1:?}, expected finite proper times, the first one before the second"
    )]
    Flash(f64, f64),
    /// Two colours.
    #[error("a lamp has both \"kelvin\" and \"color\", expected at most one of them")]
    TwoColors,
    /// Two motions.
    #[error("a lamp has both \"velocity\" and \"object\", expected at most one of them")]
    TwoMotions,
    /// Something that only a point has.
    #[error("\"{0}\" is for lamps that are a \"point\"")]
    OnlyOfPoints(&'static str),
}

impl Lamp {
    fn of(source: LampSource) -> Self {
        Self {
            source,
            temperature: Temperature::DAYLIGHT,
            color: None,
        }
    }

    /// A point of daylight at `position` in the scene, at rest.
    ///
    /// # Errors
    ///
    /// An intensity that is negative or not finite.
    pub fn point(position: Place, intensity: f64) -> Result<Self, LampError> {
        let point = PointLamp {
            position,
            intensity: strength("intensity", intensity)?,
            carrier: Carrier::Own(Velocity::ZERO),
            flash: None,
        };
        Ok(Self::of(LampSource::Point(point)))
    }

    /// Daylight that travels in one direction, of any length, everywhere.
    ///
    /// # Errors
    ///
    /// No direction, or an irradiance that is negative or not finite.
    pub fn sun(direction: DVec3, irradiance: f64) -> Result<Self, LampError> {
        Ok(Self::of(LampSource::Sun {
            direction: unit(direction).ok_or(LampError::Direction(direction))?,
            irradiance: strength("irradiance", irradiance)?,
        }))
    }

    /// Daylight from all around.
    ///
    /// # Errors
    ///
    /// An irradiance that is negative or not finite.
    pub fn ambient(irradiance: f64) -> Result<Self, LampError> {
        let irradiance = strength("irradiance", irradiance)?;
        Ok(Self::of(LampSource::Ambient { irradiance }))
    }

    /// The same with the light of a black body of this temperature.
    #[must_use]
    pub fn with_temperature(mut self, temperature: Temperature) -> Self {
        (self.temperature, self.color) = (temperature, None);
        self
    }

    /// The same with daylight behind a filter of this colour.
    #[must_use]
    pub fn with_color(mut self, color: Color) -> Self {
        (self.temperature, self.color) = (Temperature::DAYLIGHT, Some(color));
        self
    }

    /// The same in motion.
    ///
    /// # Errors
    ///
    /// A lamp that is no point.
    pub fn carried(mut self, carrier: Carrier) -> Result<Self, LampError> {
        match &mut self.source {
            LampSource::Point(point) => point.carrier = carrier,
            _ if matches!(carrier, Carrier::Own(_)) => {
                return Err(LampError::OnlyOfPoints("velocity"));
            }
            _ => return Err(LampError::OnlyOfPoints("object")),
        }
        Ok(self)
    }

    /// The same, shining for a while only.
    ///
    /// # Errors
    ///
    /// A lamp that is no point.
    pub fn flashing(mut self, flash: Flash) -> Result<Self, LampError> {
        match &mut self.source {
            LampSource::Point(point) => point.flash = Some(flash),
            _ => return Err(LampError::OnlyOfPoints("flash")),
        }
        Ok(self)
    }

    /// Where its light comes from.
    pub fn source(&self) -> &LampSource {
        &self.source
    }

    /// The temperature of its light at rest.
    pub fn temperature(&self) -> Temperature {
        self.temperature
    }

    /// The colour of the filter before it, if it has one.
    pub fn color(&self) -> Option<Color> {
        self.color
    }
}

impl PointLamp {
    /// In the scene frame at scene time 0, or in the rest frame of the object on which it rides.
    pub fn position(&self) -> Place {
        self.position
    }

    /// Luminance, at distance 1, of a white matte surface that faces the lamp and is at rest with it.
    pub fn intensity(&self) -> f64 {
        self.intensity
    }

    /// How it moves.
    pub fn carrier(&self) -> &Carrier {
        &self.carrier
    }

    /// When it shines, if not always.
    pub fn flash(&self) -> Option<Flash> {
        self.flash
    }
}

impl Flash {
    /// A flash between two proper times of the lamp.
    ///
    /// # Errors
    ///
    /// Times that are not finite, or not one before the other.
    pub fn new(from: f64, to: f64) -> Result<Self, LampError> {
        match from.is_finite() && to.is_finite() && from < to {
            true => Ok(Self { from, to }),
            false => Err(LampError::Flash(from, to)),
        }
    }

    /// Whether the lamp shines at its proper time `time`.
    pub fn is_on(&self, time: f64) -> bool {
        (self.from..self.to).contains(&time)
    }
}

/// Such as "a point of intensity 3 and 4000 kelvin on \"car\"".
impl fmt::Display for Lamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.source {
            LampSource::Point(point) => write!(f, "a point of intensity {}", point.intensity)?,
            LampSource::Sun { irradiance, .. } => write!(f, "a sun of irradiance {irradiance}")?,
            LampSource::Ambient { irradiance } => {
                write!(f, "light from all around of irradiance {irradiance}")?;
            }
        }
        match self.color {
            Some(Color([red, green, blue])) => {
                write!(f, " and colour #{red:02x}{green:02x}{blue:02x}")?
            }
            None => write!(f, " and {} kelvin", self.temperature.kelvin())?,
        }
        match &self.source {
            LampSource::Point(PointLamp {
                carrier: Carrier::Object(name),
                ..
            }) => write!(f, " on \"{name}\""),
            _ => Ok(()),
        }
    }
}

fn strength(name: &'static str, value: f64) -> Result<f64, LampError> {
    match value >= 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(LampError::Strength(name, value)),
    }
}

/// A lamp as a file writes it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [{ "required": ["point"] }, { "required": ["sun"] }, { "required": ["ambient"] }],
    "dependentRequired" = { "velocity": ["point"], "object": ["point"], "flash": ["point"] },
    "not" = { "anyOf": [{ "required": ["kelvin", "color"] }, { "required": ["velocity", "object"] }] },
))]
struct LampFields {
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
struct FlashFields {
    /// The lamp's proper time when it begins to shine.
    #[schemars(with = "f64")]
    from: Time,
    /// The lamp's proper time when it ends.
    #[schemars(with = "f64")]
    to: Time,
}

impl TryFrom<FromObject<LampFields>> for Lamp {
    type Error = LampError;

    fn try_from(FromObject(fields): FromObject<LampFields>) -> Result<Self, LampError> {
        let mut lamp = match (fields.point, fields.sun, fields.ambient) {
            (Some(FromObject(point)), None, None) => Self::point(point.position, point.intensity)?,
            (None, Some(FromObject(sun)), None) => Self::sun(sun.direction.into(), sun.irradiance)?,
            (None, None, Some(FromObject(ambient))) => Self::ambient(ambient.irradiance)?,
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

impl TryFrom<FromObject<FlashFields>> for Flash {
    type Error = LampError;

    fn try_from(FromObject(fields): FromObject<FlashFields>) -> Result<Self, LampError> {
        Self::new(fields.from.get(), fields.to.get())
    }
}

fn some_kelvin<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Temperature>, D::Error> {
    kelvin(deserializer).map(Some)
}

fn some_velocity<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Velocity>, D::Error> {
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
    use super::super::{Scene, SceneError};
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
        assert_eq!(
            rider.to_string(),
            "a point of intensity 0 and colour #ff8000 on \"s\""
        );
        assert!(
            matches!(sun.source(), LampSource::Sun { direction, .. } if *direction == DVec3::NEG_Y)
        );
        assert_eq!(sun.to_string(), "a sun of irradiance 0.5 and 6504 kelvin");
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

    #[test]
    fn only_points_move_and_flash() {
        let sun = Lamp::sun(DVec3::X, 1.0).unwrap();
        let flash = Flash::new(0.0, 1.0).unwrap();
        assert_eq!(
            sun.clone().flashing(flash),
            Err(LampError::OnlyOfPoints("flash"))
        );
        let own = Carrier::Own(Velocity::ZERO);
        assert_eq!(sun.carried(own), Err(LampError::OnlyOfPoints("velocity")));
        assert!(Flash::new(0.0, f64::INFINITY).is_err() && Flash::new(1.0, 0.0).is_err());
        assert!(Lamp::ambient(f64::NAN).is_err());
    }
}
