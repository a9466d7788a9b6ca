//! What becomes of light on its way, beside the shapes that it shows.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};
use thiserror::Error;

use super::emission::kelvin;
use super::forms::Keyed;
use crate::effects::{Beyond, Doppler, Spectrum, Temperature};

/// Limits on an exposure, in stops.
const STOPS: std::ops::RangeInclusive<f64> = -64.0..=64.0;

/// Effects that a scene calls for beside shapes; nothing else is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Effects {
    /// The Doppler effect on colours, at the luminance that surfaces have at rest; none if absent.
    #[serde(deserialize_with = "doppler")]
    #[schemars(with = "DopplerForm")]
    pub doppler: Doppler,
    /// The searchlight effect on brightness: as the luminance of the shifted light is to that at rest, which is not the
    /// fourth power of the Doppler factor.
    pub searchlight: bool,
    /// The exposure of pictures: a number of stops from -64 to 64, each twice as bright as the one before, or "auto", by
    /// which 95 of 100 rays are within what a screen shows; 0 if absent.
    #[schemars(with = "ExposureForm")]
    pub exposure: Exposure,
}

/// How bright pictures are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// 2 to the power of this times as bright.
    Stops(Stops),
    /// As bright as a screen can show: the same for all pictures of a job.
    Auto,
}

/// A number of stops, each twice as bright as the one before: from -64 to 64.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stops(f64);

/// Why something is not an effect.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EffectsError {
    /// An exposure that is not a number of stops.
    #[error("the exposure is {0:?}, expected -64 to 64 stops or \"auto\"")]
    Stops(f64),
    /// An exposure that is not a number.
    #[error("the exposure is \"{0}\", expected a number of stops like -1.5 or \"auto\"")]
    Exposure(String),
    /// An unknown form of the Doppler effect.
    #[error("unknown Doppler effect \"{0}\", expected spectrum, ramp or none")]
    Doppler(String),
}

impl Effects {
    /// The effects that change what is shown: a ramp is a scale, whose colours no brightness changes.
    pub fn shown(self) -> Self {
        match self.doppler {
            Doppler::Ramp => Self {
                doppler: Doppler::Ramp,
                ..Self::default()
            },
            Doppler::None | Doppler::Spectrum(_) => self,
        }
    }

    /// Whether there are any.
    pub fn is_some(&self) -> bool {
        *self != Self::default()
    }

    /// Whether they give colours to the vertices of meshes.
    pub(crate) fn colors(self) -> bool {
        self.doppler != Doppler::None || self.searchlight
    }

    /// As scenes write them.
    pub(crate) fn to_value(self) -> Value {
        let edge = |beyond| match beyond {
            Beyond::Edge => "edge",
            Beyond::Dark => "dark",
        };
        let mut effects = json!({});
        match self.doppler {
            Doppler::None => {}
            Doppler::Ramp => effects["doppler"] = "ramp".into(),
            Doppler::Spectrum(spectrum) => {
                effects["doppler"] = json!({
                    "kelvin": spectrum.daylight.kelvin(),
                    "infrared": edge(spectrum.infrared),
                    "ultraviolet": edge(spectrum.ultraviolet),
                });
            }
        }
        if self.searchlight {
            effects["searchlight"] = true.into();
        }
        match self.exposure {
            Exposure::Auto => effects["exposure"] = "auto".into(),
            Exposure::Stops(Stops(0.0)) => {}
            Exposure::Stops(Stops(stops)) => effects["exposure"] = stops.into(),
        }
        effects
    }
}

impl Stops {
    /// So many stops.
    ///
    /// # Errors
    ///
    /// A number outside -64 to 64, or NaN.
    pub fn new(stops: f64) -> Result<Self, EffectsError> {
        match STOPS.contains(&stops) {
            true => Ok(Self(stops)),
            false => Err(EffectsError::Stops(stops)),
        }
    }

    /// The number that makes light of this luminance as bright as `wanted`, as nearly as stops can.
    pub fn between(luminance: f64, wanted: f64) -> Self {
        let stops = (wanted / luminance).log2();
        match stops.is_nan() {
            true => Self(0.0),
            false => Self(stops.clamp(*STOPS.start(), *STOPS.end())),
        }
    }

    /// The number.
    pub fn get(self) -> f64 {
        self.0
    }

    /// How many times as bright that is.
    pub fn factor(self) -> f64 {
        self.0.exp2()
    }
}

impl Default for Exposure {
    fn default() -> Self {
        Self::Stops(Stops::default())
    }
}

impl FromStr for Exposure {
    type Err = EffectsError;

    fn from_str(text: &str) -> Result<Self, EffectsError> {
        match text.trim() {
            "auto" => Ok(Self::Auto),
            text => match text.parse() {
                Ok(stops) => Stops::new(stops).map(Self::Stops),
                Err(_) => Err(EffectsError::Exposure(text.to_owned())),
            },
        }
    }
}

/// The Doppler effect by its name: `spectrum`, that of daylight; `ramp`; or `none`.
fn doppler_named(name: &str) -> Result<Doppler, EffectsError> {
    match name {
        "spectrum" => Ok(Doppler::Spectrum(Spectrum::default())),
        "ramp" => Ok(Doppler::Ramp),
        "none" => Ok(Doppler::None),
        _ => Err(EffectsError::Doppler(name.to_owned())),
    }
}

impl Keyed for Effects {
    const EXPECTED: &'static str =
        "effects like { \"doppler\": \"spectrum\", \"searchlight\": true }";
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only; `doppler` below does the reading.
enum DopplerForm {
    /// By name.
    Name(DopplerName),
    /// Shifted spectra, with what is known of them beyond colours.
    Spectrum(SpectrumForm),
}

#[derive(JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(dead_code)] // Read by the schema only.
enum DopplerName {
    /// No shift.
    None,
    /// Spectra are shifted: what an eye would see, in daylight of 6504 kelvin.
    Spectrum,
    /// The Doppler factor as a colour of its own, in place of colours and textures: blue above 1, red below, even steps for
    /// even steps of its logarithm, up to 8 and down to 1/8.
    Ramp,
}

/// Shifted spectra, with what is known of them beyond colours.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct SpectrumForm {
    /// The temperature of the daylight in which surfaces have their own colours, in kelvin; 6504 if absent.
    #[serde(deserialize_with = "kelvin")]
    #[schemars(with = "f64", range(min = 500, max = 1e12))]
    kelvin: Temperature,
    /// The reflectance above 730 nanometres: "edge", that at 730 nanometres, or "dark", none; "edge" if absent.
    infrared: BeyondForm,
    /// The reflectance below 380 nanometres: "edge", that at 380 nanometres, or "dark", none; "edge" if absent.
    ultraviolet: BeyondForm,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum BeyondForm {
    #[default]
    Edge,
    Dark,
}

impl Default for SpectrumForm {
    fn default() -> Self {
        Self {
            kelvin: Temperature::DAYLIGHT,
            infrared: BeyondForm::Edge,
            ultraviolet: BeyondForm::Edge,
        }
    }
}

impl From<BeyondForm> for Beyond {
    fn from(form: BeyondForm) -> Self {
        match form {
            BeyondForm::Edge => Self::Edge,
            BeyondForm::Dark => Self::Dark,
        }
    }
}

fn doppler<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Doppler, D::Error> {
    struct DopplerVisitor;
    impl<'de> Visitor<'de> for DopplerVisitor {
        type Value = Doppler;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("\"spectrum\", \"ramp\", \"none\" or a spectrum like { \"kelvin\": 6504 }")
        }

        fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Doppler, E> {
            doppler_named(name).map_err(E::custom)
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Doppler, A::Error> {
            let form = SpectrumForm::deserialize(MapAccessDeserializer::new(map))?;
            Ok(Doppler::Spectrum(Spectrum {
                daylight: form.kelvin,
                infrared: form.infrared.into(),
                ultraviolet: form.ultraviolet.into(),
            }))
        }
    }
    deserializer.deserialize_any(DopplerVisitor)
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[allow(dead_code)] // Read by the schema only.
enum ExposureForm {
    /// A number of stops, each twice as bright as the one before.
    Stops(#[schemars(range(min = -64, max = 64))] f64),
    /// By the brightness of what is seen.
    Auto(Auto),
}

#[derive(JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(dead_code)] // Read by the schema only.
enum Auto {
    Auto,
}

impl<'de> Deserialize<'de> for Exposure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ExposureVisitor;
        impl Visitor<'_> for ExposureVisitor {
            type Value = Exposure;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number of stops or \"auto\"")
            }

            fn visit_f64<E: serde::de::Error>(self, stops: f64) -> Result<Exposure, E> {
                Stops::new(stops).map(Exposure::Stops).map_err(E::custom)
            }

            fn visit_i64<E: serde::de::Error>(self, stops: i64) -> Result<Exposure, E> {
                self.visit_f64(stops as f64)
            }

            fn visit_u64<E: serde::de::Error>(self, stops: u64) -> Result<Exposure, E> {
                self.visit_f64(stops as f64)
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Exposure, E> {
                match name {
                    "auto" => Ok(Exposure::Auto),
                    _ => Err(E::custom(EffectsError::Exposure(name.to_owned()))),
                }
            }
        }
        deserializer.deserialize_any(ExposureVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::*;

    const SPHERE: &str = r#""name": "s", "shape": { "sphere": { "radius": 1 } }"#;

    fn effects(text: &str) -> Effects {
        let scene = format!("{{ \"effects\": {text}, \"objects\": [ {{ {SPHERE} }} ] }}");
        Scene::from_json(&scene).expect(text).effects()
    }

    #[test]
    fn effects_are_read_as_written() {
        assert!(!effects("{}").is_some());
        let both = effects(r#"{ "doppler": "spectrum", "searchlight": true, "exposure": -2 }"#);
        assert_eq!(both.doppler, Doppler::Spectrum(Spectrum::default()));
        assert_eq!(both.exposure, Exposure::Stops(Stops(-2.0)));
        assert!(both.searchlight && both.is_some());
        let ramp = effects(r#"{ "doppler": "ramp", "exposure": "auto" }"#);
        assert_eq!(
            (ramp.doppler, ramp.exposure),
            (Doppler::Ramp, Exposure::Auto)
        );
        for written in [both, ramp] {
            assert_eq!(effects(&written.to_value().to_string()), written);
        }
        let dark = effects(r#"{ "doppler": { "kelvin": 3000, "infrared": "dark" } }"#);
        let expected = Spectrum {
            daylight: Temperature::new(3000.0).unwrap(),
            infrared: Beyond::Dark,
            ultraviolet: Beyond::Edge,
        };
        assert_eq!(dark.doppler, Doppler::Spectrum(expected));
        assert_eq!(effects(r#"{ "doppler": {} }"#).doppler, both.doppler);
        for (text, exposure) in [
            ("1.5", Exposure::Stops(Stops(1.5))),
            ("auto", Exposure::Auto),
        ] {
            assert_eq!(text.parse(), Ok(exposure));
        }
        for wrong in ["", "65", "nan", "bright"] {
            assert!(wrong.parse::<Exposure>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn mistakes_are_told_with_place_and_expectation() {
        for (text, at, words) in [
            ("\"spectrum\"", "effects", "expected effects like {"),
            (
                r#"{ "dopler": "ramp" }"#,
                "effects.dopler",
                "unknown key `dopler`, expected one of `doppler`",
            ),
            (
                r#"{ "doppler": true }"#,
                "effects.doppler",
                "expected \"spectrum\", \"ramp\"",
            ),
            (
                r#"{ "doppler": "rainbow" }"#,
                "effects.doppler",
                "unknown Doppler effect \"rainbow\", expected spectrum, ramp",
            ),
            (
                r#"{ "doppler": { "kelvin": 200 } }"#,
                "effects.doppler.kelvin",
                "the temperature is 200.0 kelvin, expected 500 to 1e12",
            ),
            (
                r#"{ "doppler": { "infrared": "black" } }"#,
                "effects.doppler.infrared",
                "`edge` or `dark`",
            ),
            (
                r#"{ "searchlight": 1 }"#,
                "effects.searchlight",
                "expected a boolean",
            ),
            (
                r#"{ "exposure": 100 }"#,
                "effects.exposure",
                "the exposure is 100.0, expected -64 to 64 stops",
            ),
            (
                r#"{ "exposure": "bright" }"#,
                "effects.exposure",
                "the exposure is \"bright\"",
            ),
            (
                r#"{ "exposure": [] }"#,
                "effects.exposure",
                "expected a number of stops or \"auto\"",
            ),
        ] {
            let scene = format!("{{ \"objects\": [ {{ {SPHERE} }} ],\n\"effects\": {text} }}");
            let error = Scene::from_json(&scene).expect_err(text);
            assert_eq!((error.line, error.at.as_str()), (2, at), "{error}");
            assert!(error.message.contains(words), "{error}");
        }
    }

    #[test]
    fn objects_glow_as_they_say() {
        let object = |emission: &str| {
            Scene::from_json(&format!(
                "{{ \"objects\": [ {{ {SPHERE}, \"emission\": {emission} }} ] }}"
            ))
        };
        let sun = object(r#"{ "kelvin": 5778 }"#).unwrap().objects()[0]
            .emission
            .unwrap();
        assert_eq!((sun.temperature().kelvin(), sun.luminance()), (5778.0, 1.0));
        for (text, at, words) in [
            (
                r#"{ "kelvin": 5778, "luminance": 0 }"#,
                "objects[0].emission.luminance",
                "expected a finite number > 0",
            ),
            (
                r#"{ "kelvin": 1e13 }"#,
                "objects[0].emission.kelvin",
                "expected 500 to 1e12",
            ),
            (
                r#"{ "luminance": 1 }"#,
                "objects[0].emission",
                "missing key `kelvin`",
            ),
            (
                "5778",
                "objects[0].emission",
                "expected a black body like {",
            ),
        ] {
            let error = object(text).expect_err(text);
            assert_eq!(error.at, at, "{error}");
            assert!(error.message.contains(words), "{error}");
        }
    }
}
