//! Parameters of shapes that cannot hold an impossible value: lengths and counts.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, Serialize};

use super::ShapeError;

/// A finite length greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Deserialize, Serialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Length(f64);

impl Length {
    /// The length `value`.
    ///
    /// # Errors
    ///
    /// Zero, a negative number, infinity, NaN.
    pub fn new(value: f64) -> Result<Self, ShapeError> {
        Self::named("length", value)
    }

    /// The length `value`, with the name that an error calls it by.
    pub(super) fn named(name: &'static str, value: f64) -> Result<Self, ShapeError> {
        if value > 0.0 && value.is_finite() {
            Ok(Self(value))
        } else {
            Err(ShapeError::Length { name, value })
        }
    }

    /// The number.
    pub fn get(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Length {
    type Error = ShapeError;

    fn try_from(value: f64) -> Result<Self, ShapeError> {
        Self::new(value)
    }
}

impl From<Length> for f64 {
    fn from(length: Length) -> f64 {
        length.0
    }
}

impl JsonSchema for Length {
    fn schema_name() -> Cow<'static, str> {
        "Length".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "number", "exclusiveMinimum": 0 })
    }
}

/// The largest [`Count`]. A full turn in as many segments is a tenth of a degree a segment.
pub(super) const MAX: u32 = 4096;

/// A whole number from `MIN` to 4096; `DEFAULT` where a field that may be absent is absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Count<const MIN: u32, const DEFAULT: u32>(u32);

impl<const MIN: u32, const DEFAULT: u32> Count<MIN, DEFAULT> {
    /// The count `value`.
    ///
    /// # Errors
    ///
    /// Less than `MIN` or more than 4096.
    pub fn new(value: u32) -> Result<Self, ShapeError> {
        Self::named("count", value)
    }

    /// The count `value`, with the name that an error calls it by.
    pub(super) fn named(name: &'static str, value: u32) -> Result<Self, ShapeError> {
        if (MIN..=MAX).contains(&value) {
            Ok(Self(value))
        } else {
            Err(ShapeError::Count {
                name,
                value,
                least: MIN,
                most: MAX,
            })
        }
    }

    /// The number.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl<const MIN: u32, const DEFAULT: u32> Default for Count<MIN, DEFAULT> {
    fn default() -> Self {
        const { assert!(MIN <= DEFAULT && DEFAULT <= MAX) };
        Self(DEFAULT)
    }
}

impl<'de, const MIN: u32, const DEFAULT: u32> Deserialize<'de> for Count<MIN, DEFAULT> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CountVisitor)
    }
}

/// Reads a [`Count`]; its own, so that an error names the limits for whatever is there instead.
struct CountVisitor<const MIN: u32, const DEFAULT: u32>;

impl<const MIN: u32, const DEFAULT: u32> Visitor<'_> for CountVisitor<MIN, DEFAULT> {
    type Value = Count<MIN, DEFAULT>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from {MIN} to {MAX}")
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
        u32::try_from(value)
            .ok()
            .and_then(|value| Count::new(value).ok())
            .ok_or_else(|| E::invalid_value(de::Unexpected::Unsigned(value), &self))
    }
}

impl<const MIN: u32, const DEFAULT: u32> JsonSchema for Count<MIN, DEFAULT> {
    fn schema_name() -> Cow<'static, str> {
        format!("Count{MIN}Default{DEFAULT}").into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "minimum": MIN, "maximum": MAX })
    }
}

/// Numbers of cells along x, y and z; in JSON one number for all three, or an array of three.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize)]
#[serde(untagged)]
pub enum Cells {
    /// As many along every axis.
    Same(Count<1, 1>),
    /// Along x, y and z.
    Each([Count<1, 1>; 3]),
}

impl Cells {
    /// Along x, y and z.
    pub fn get(self) -> [u32; 3] {
        match self {
            Self::Same(count) => [count.get(); 3],
            Self::Each(counts) => counts.map(Count::get),
        }
    }
}

impl<'de> Deserialize<'de> for Cells {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CellsVisitor)
    }
}

/// Reads [`Cells`]; serde's own errors for an untagged enum do not say what was expected.
struct CellsVisitor;

impl<'de> Visitor<'de> for CellsVisitor {
    type Value = Cells;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from 1 to {MAX} or three of them")
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Cells, E> {
        let same = CountVisitor::<1, 1>.visit_u64(value);
        same.map(Cells::Same)
    }

    fn visit_seq<A: de::SeqAccess<'de>>(self, sequence: A) -> Result<Cells, A::Error> {
        let counts = Deserialize::deserialize(de::value::SeqAccessDeserializer::new(sequence));
        counts.map(Cells::Each)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error<T: de::DeserializeOwned + fmt::Debug>(json: &str) -> String {
        serde_json::from_str::<T>(json).unwrap_err().to_string()
    }

    #[test]
    fn refuses_impossible_lengths() {
        for value in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert!(Length::new(value).is_err(), "{value}");
        }
        let message = Length::named("radius", -1.0).unwrap_err().to_string();
        assert_eq!(message, "radius is -1, expected a finite length > 0");
        let message = error::<Length>("-1");
        assert!(
            message.starts_with("length is -1, expected a finite length > 0"),
            "{message}"
        );
        assert_eq!(serde_json::from_str::<Length>("2").unwrap().get(), 2.0);
    }

    #[test]
    fn refuses_impossible_counts() {
        for json in ["2", "4097", "99999999999", "-4", "7.5", "\"7\"", "null"] {
            let message = error::<Count<3, 96>>(json);
            assert!(
                message.contains("expected a whole number from 3 to 4096"),
                "{json}: {message}"
            );
        }
        let count: Count<3, 96> = serde_json::from_str("3").unwrap();
        assert_eq!(count.get(), 3);
        assert_eq!(Count::<3, 96>::default().get(), 96);
    }

    #[test]
    fn cells_are_one_number_or_three() {
        let read = |json| serde_json::from_str::<Cells>(json).unwrap();
        assert_eq!(read("4").get(), [4, 4, 4]);
        assert_eq!(read("[1, 2, 3]").get(), [1, 2, 3]);
        for json in ["4", "[1,2,3]"] {
            assert_eq!(serde_json::to_string(&read(json)).unwrap(), json);
        }
        assert!(error::<Cells>("true").contains("from 1 to 4096 or three of them"));
        assert!(error::<Cells>("[1, 2]").contains("length 3"));
        assert!(error::<Cells>("0").contains("expected a whole number from 1 to 4096"));
    }
}
