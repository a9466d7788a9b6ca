//! Attributes that a scene calls for beside shapes: numbers at every vertex.

use std::str::FromStr;

use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

/// Something to be computed and written for every vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Attribute {
    /// Frequency seen over frequency emitted, `_DOPPLER` in glTF.
    Doppler,
    /// The time in the observer's frame at which the light left that is seen now, counted from now and so not
    /// positive: `_EMISSION_TIME` in glTF.
    EmissionTime,
    /// The place in the object's rest frame: `_REST_X`, `_REST_Y` and `_REST_Z` in glTF.
    RestPosition,
    /// Radiance seen over radiance emitted, of all wavelengths together: the fourth power of the Doppler factor, `_RADIANCE`
    /// in glTF. It is the searchlight effect; the eye, which sees some wavelengths alone, sees another.
    Radiance,
}

/// How an attribute is called by users, in files and in messages.
struct Row {
    attribute: Attribute,
    /// In scenes and flags.
    name: &'static str,
    /// In messages.
    quantity: &'static str,
    /// In files: one name for each number of a vertex, in lower case. glTF has it in upper case behind an underscore.
    columns: &'static [&'static str],
}

/// All attributes, in the order in which files have them.
const TABLE: [Row; 4] = [
    Row {
        attribute: Attribute::Doppler,
        name: "doppler",
        quantity: "the Doppler factor",
        columns: &["doppler"],
    },
    Row {
        attribute: Attribute::EmissionTime,
        name: "emission_time",
        quantity: "the emission time",
        columns: &["emission_time"],
    },
    Row {
        attribute: Attribute::RestPosition,
        name: "rest_position",
        quantity: "the place at rest",
        columns: &["rest_x", "rest_y", "rest_z"],
    },
    Row {
        attribute: Attribute::Radiance,
        name: "radiance",
        quantity: "the radiance",
        columns: &["radiance"],
    },
];

impl Attribute {
    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The name of the attribute in scenes and flags.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The quantity, in words.
    pub(crate) fn quantity(self) -> &'static str {
        self.row().quantity
    }

    /// The names of the numbers that a vertex has of it in files, in lower case.
    pub(crate) fn columns(self) -> &'static [&'static str] {
        self.row().columns
    }
}

/// A name that is none of an [`Attribute`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown attribute \"{0}\", expected one of {names}", names = TABLE.map(|row| row.name).join(", "))]
pub struct UnknownAttribute(String);

impl FromStr for Attribute {
    type Err = UnknownAttribute;

    fn from_str(name: &str) -> Result<Self, UnknownAttribute> {
        let row = TABLE.iter().find(|row| row.name == name);
        row.map(|row| row.attribute)
            .ok_or_else(|| UnknownAttribute(name.to_owned()))
    }
}

/// A set of attributes; an attribute that is not in it is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(from = "Vec<Attribute>")]
#[schemars(with = "Vec<Attribute>")]
pub struct Attributes {
    /// One bit for each row of the table.
    bits: u8,
}

impl Attributes {
    /// The set with one attribute more.
    #[must_use]
    pub fn with(self, attribute: Attribute) -> Self {
        Self {
            bits: self.bits | 1 << attribute as u8,
        }
    }

    /// Whether the attribute is in the set.
    pub fn contains(self, attribute: Attribute) -> bool {
        self.bits & (1 << attribute as u8) != 0
    }

    /// Whether no attribute is in the set.
    pub fn is_empty(self) -> bool {
        self.bits == 0
    }

    /// The attributes of the set, in the order in which files have them.
    pub fn iter(self) -> impl Iterator<Item = Attribute> {
        let all = TABLE.iter().map(|row| row.attribute);
        all.filter(move |&attribute| self.contains(attribute))
    }

    /// How many numbers a vertex has of them.
    pub(crate) fn scalars(self) -> u64 {
        self.iter()
            .map(|attribute| attribute.columns().len() as u64)
            .sum()
    }
}

impl FromIterator<Attribute> for Attributes {
    fn from_iter<I: IntoIterator<Item = Attribute>>(attributes: I) -> Self {
        attributes.into_iter().fold(Self::default(), Self::with)
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
    fn each_row_of_the_table_is_in_its_place() {
        for (place, row) in TABLE.iter().enumerate() {
            assert_eq!(row.attribute as usize, place);
            assert!(
                Attributes::default()
                    .with(row.attribute)
                    .contains(row.attribute)
            );
        }
    }

    #[test]
    fn names_are_the_same_in_scenes_and_on_the_command_line() {
        for name in ["doppler", "emission_time", "rest_position", "radiance"] {
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
        assert_eq!(
            set.iter().collect::<Vec<_>>(),
            [Attribute::Doppler, Attribute::RestPosition]
        );
        assert!(!set.is_empty() && Attributes::default().is_empty());
        assert_eq!(set.scalars(), 4);
    }
}
