//! Which normals the parts of a file get.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::{Model, Part};
use crate::mesh::MeshError;

/// Which normals the parts of a file get: those of the file, or others in place of them.
///
/// A part without normals in the file is shaded flat under [`Normals::Source`], as glTF asks for. All others replace the
/// normals of every part, with the tangents that belong to them.
#[derive(Clone, Copy, Debug, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(try_from = "String")]
#[schemars(with = "String", extend("pattern" = "^(source|flat|none|smooth(:[0-9]+(\\.[0-9]+)?)?)$"))]
pub enum Normals {
    /// `source`: those of the file, and those of flat facets for a part that has none.
    #[default]
    Source,
    /// `smooth` or `smooth:60`: shared vertices, parted along creases of more than so many degrees.
    Smooth(Crease),
    /// `flat`: those of flat facets, each with three vertices of its own.
    Flat,
    /// `none`: no normals, so that vertices stay as the file has them and viewers shade flat facets.
    None,
}

/// The largest angle between facets that are shaded as one smooth surface, from 0 to 180 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease(f64);

impl Default for Crease {
    /// 60 degrees.
    fn default() -> Self {
        Self(60.0)
    }
}

impl Crease {
    /// The angle in degrees; `None` unless it is from 0 to 180.
    pub fn from_degrees(degrees: f64) -> Option<Self> {
        (0.0..=180.0).contains(&degrees).then_some(Self(degrees))
    }

    /// The angle in degrees.
    pub fn degrees(self) -> f64 {
        self.0
    }
}

/// A word that is none of [`Normals`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("normals are \"{0}\", expected source, smooth, smooth:DEGREES (0 to 180), flat or none")]
pub struct UnknownNormals(String);

impl FromStr for Normals {
    type Err = UnknownNormals;

    fn from_str(text: &str) -> Result<Self, UnknownNormals> {
        let unknown = || UnknownNormals(text.to_owned());
        match text.split_once(':') {
            None => match text {
                "source" => Ok(Self::Source),
                "smooth" => Ok(Self::Smooth(Crease::default())),
                "flat" => Ok(Self::Flat),
                "none" => Ok(Self::None),
                _ => Err(unknown()),
            },
            Some(("smooth", degrees)) => {
                let degrees = degrees.parse().ok().and_then(Crease::from_degrees);
                degrees.map(Self::Smooth).ok_or_else(unknown)
            }
            Some(_) => Err(unknown()),
        }
    }
}

impl TryFrom<String> for Normals {
    type Error = UnknownNormals;

    fn try_from(text: String) -> Result<Self, UnknownNormals> {
        text.parse()
    }
}

impl fmt::Display for Normals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Source => f.write_str("source"),
            Self::Smooth(crease) => write!(f, "smooth:{}", crease.degrees()),
            Self::Flat => f.write_str("flat"),
            Self::None => f.write_str("none"),
        }
    }
}

impl Model {
    /// The model with these normals.
    ///
    /// # Errors
    ///
    /// More corners than a `u32` index can tell apart.
    pub fn with_normals(self, normals: Normals) -> Result<Self, MeshError> {
        let parts = self.parts.into_iter();
        let parts = parts.map(|part| part.with_normals(normals));
        Ok(Self {
            parts: parts.collect::<Result<_, _>>()?,
            ..self
        })
    }

    /// How many bytes the vertices and triangles of a step have in a glTF file: of all parts that are shaded flat for want of
    /// normals, and of the same parts with shared vertices, with and without normals.
    pub(crate) fn bytes_for_want_of_normals(&self) -> [u64; 3] {
        let mut bytes = [0; 3];
        for part in &self.parts {
            let Some(source) = part.unshaded() else {
                continue;
            };
            let vertices = source.vertex_count() as u64;
            let corners = 3 * source.triangle_count() as u64;
            let sets = source.texture_coordinates().len() as u64;
            let colors = u64::from(source.colors().is_some());
            let of_vertex = 12 + 8 * sets + 4 * colors;
            let with = |vertices: u64, of_vertex: u64| vertices * of_vertex + corners * 4;
            bytes[0] += with(corners, of_vertex + 12);
            bytes[1] += with(vertices, of_vertex + 12);
            bytes[2] += with(vertices, of_vertex);
        }
        bytes
    }
}

impl Part {
    fn with_normals(self, normals: Normals) -> Result<Self, MeshError> {
        let was_flat = self.unshaded().is_some();
        let mesh = match normals {
            Normals::Source => self.mesh().clone(),
            Normals::Flat if was_flat => self.mesh().clone(),
            Normals::Flat => self.mesh().clone().without_normals().with_flat_normals()?,
            Normals::Smooth(crease) => {
                let source = self.unshaded().unwrap_or(self.mesh());
                source.with_smooth_normals(crease.degrees().to_radians())?
            }
            Normals::None => match self.unshaded() {
                Some(source) => source.clone(),
                None => self.mesh().clone().without_normals(),
            },
        };
        Ok(self.with_mesh(mesh))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_and_written() {
        for (text, shown) in [
            ("source", "source"),
            ("smooth", "smooth:60"),
            ("smooth:0.5", "smooth:0.5"),
            ("smooth:180", "smooth:180"),
            ("flat", "flat"),
            ("none", "none"),
        ] {
            assert_eq!(text.parse::<Normals>().unwrap().to_string(), shown);
        }
        for wrong in [
            "",
            "Smooth",
            "smooth:",
            "smooth:181",
            "smooth:-1",
            "smooth:nan",
            "flat:1",
            "round",
        ] {
            let error = wrong.parse::<Normals>().unwrap_err().to_string();
            assert!(error.contains("expected source, smooth"), "{error}");
        }
    }
}
