//! What a scene calls for beside shapes: numbers at every vertex.

use std::str::FromStr;

use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

/// Something to be computed and written for every vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Attribute {
    /// Frequency seen over frequency emitted, `_DOPPLER` in glTF.
    Doppler,
    /// The time in the observer's frame at which the light left that is seen now, counted from now and so not
    /// positive: `_EMISSION_TIME` in glTF.
    EmissionTime,
    /// The place in the object's rest frame: `_REST_X`, `_REST_Y` and `_REST_Z` in glTF.
    RestPosition,
}

/// A name that is none of an [`Attribute`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown attribute \"{0}\", expected one of doppler, emission_time, rest_position")]
pub struct UnknownAttribute(String);

impl FromStr for Attribute {
    type Err = UnknownAttribute;

    fn from_str(name: &str) -> Result<Self, UnknownAttribute> {
        match name {
            "doppler" => Ok(Self::Doppler),
            "emission_time" => Ok(Self::EmissionTime),
            "rest_position" => Ok(Self::RestPosition),
            _ => Err(UnknownAttribute(name.to_owned())),
        }
    }
}

/// A set of attributes; what is not in it is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(from = "Vec<Attribute>")]
#[schemars(with = "Vec<Attribute>")]
pub struct Attributes {
    /// See [`Attribute::Doppler`].
    pub doppler: bool,
    /// See [`Attribute::EmissionTime`].
    pub emission_time: bool,
    /// See [`Attribute::RestPosition`].
    pub rest_position: bool,
}

impl Attributes {
    /// How many numbers a vertex has of them.
    pub(crate) fn scalars(self) -> u64 {
        u64::from(self.doppler) + u64::from(self.emission_time) + 3 * u64::from(self.rest_position)
    }

    /// Whether nothing is asked for.
    pub fn is_empty(self) -> bool {
        self == Self::default()
    }
}

impl FromIterator<Attribute> for Attributes {
    fn from_iter<I: IntoIterator<Item = Attribute>>(attributes: I) -> Self {
        let mut set = Self::default();
        for attribute in attributes {
            match attribute {
                Attribute::Doppler => set.doppler = true,
                Attribute::EmissionTime => set.emission_time = true,
                Attribute::RestPosition => set.rest_position = true,
            }
        }
        set
    }
}

impl From<Vec<Attribute>> for Attributes {
    fn from(attributes: Vec<Attribute>) -> Self {
        attributes.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_same_in_scenes_and_on_the_command_line() {
        for name in ["doppler", "emission_time", "rest_position"] {
            let in_scene: Attribute = serde_json::from_str(&format!("\"{name}\"")).unwrap();
            assert_eq!(name.parse(), Ok(in_scene));
        }
        let error = "colour".parse::<Attribute>().unwrap_err().to_string();
        assert!(
            error.contains("\"colour\"") && error.contains("emission_time"),
            "{error}"
        );
        let set: Attributes =
            serde_json::from_str(r#"["doppler", "rest_position", "doppler"]"#).unwrap();
        assert!(set.doppler && set.rest_position && !set.emission_time && !set.is_empty());
    }
}
