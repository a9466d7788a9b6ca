//! Measures: in which sense a mesh is close to the true photosurface.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// The sense in which a mesh is close to the true photosurface: which distance a tolerance limits.
///
/// A flat output triangle lies beside the photosurface along the direction of motion. Where that direction lies in the
/// surface, points of the mesh have slid along it, but the mesh is still on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Measure {
    /// Every point of the mesh is close to the place where that point is seen. This is the measure for whatever is
    /// drawn on a surface: texture, colours, data.
    Points,
    /// Every point of the mesh is close to some point of the photosurface, and every point of the photosurface to some
    /// point of the mesh. This is the measure for shape alone; it never needs more triangles.
    Surface,
}

/// A name that is none of a [`Measure`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown measure \"{0}\", expected points or surface")]
pub struct UnknownMeasure(String);

impl Measure {
    /// Both measures.
    pub const ALL: [Self; 2] = [Self::Points, Self::Surface];

    /// The name in scenes and flags.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Surface => "surface",
        }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Measure {
    type Err = UnknownMeasure;

    fn from_str(name: &str) -> Result<Self, UnknownMeasure> {
        let known = Self::ALL.into_iter().find(|measure| measure.name() == name);
        known.ok_or_else(|| UnknownMeasure(name.to_owned()))
    }
}

impl<'de> Deserialize<'de> for Measure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = Measure;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a measure: \"points\" or \"surface\"")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Measure, E> {
                name.parse().map_err(E::custom)
            }
        }

        deserializer.deserialize_str(Name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_written_and_others_are_refused() {
        for measure in Measure::ALL {
            let text = serde_json::to_string(&measure).unwrap();
            assert_eq!(text, format!("\"{measure}\""));
            assert_eq!(serde_json::from_str::<Measure>(&text).unwrap(), measure);
            assert_eq!(measure.name().parse(), Ok(measure));
        }
        let error = serde_json::from_str::<Measure>("\"surfaces\"").unwrap_err();
        assert!(
            error.to_string().contains("expected points or surface"),
            "{error}"
        );
    }
}
