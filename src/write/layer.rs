//! What goes into a file, mesh by mesh: the observer's marker and the photosurfaces alike.

use std::sync::Arc;

use glam::DVec3;

use super::pack::first_beyond_f32;
use super::{Export, WriteError};
use crate::material::{Material, Part};
use crate::mesh::Mesh;
use crate::pipeline::{Facts, Photosurface, VertexData};
use crate::scene::Attributes;

/// One mesh of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<'a> {
    pub(super) name: &'a str,
    pub(super) mesh: &'a Mesh,
    pub(super) material: Option<&'a Arc<Material>>,
    /// The box around all that shares corners with it, if that is more.
    pub(super) around: Option<(DVec3, DVec3)>,
    /// `None` for the observer's own marker: nothing moves.
    pub(super) facts: Option<&'a Facts>,
    pub(super) vertex_data: Option<&'a VertexData>,
}

/// A number at every vertex.
#[derive(Debug)]
pub(super) struct Scalar<'a> {
    /// In lower case; glTF writes it in upper case behind an underscore.
    pub(super) name: &'static str,
    values: Values<'a>,
}

/// Where the numbers come from.
#[derive(Clone, Copy, Debug)]
enum Values<'a> {
    Known(&'a [f64]),
    /// Those of what is at rest, each the same.
    One,
    /// When what is at rest is seen.
    AtRest(&'a [DVec3]),
    /// One coordinate.
    Axis(&'a [DVec3], usize),
}

/// What numbers of a file may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    /// `f32` only.
    Single,
    /// `f64` where `f32` is not enough.
    Any,
}

impl Values<'_> {
    /// How many there are; `None` where there are as many as are asked for.
    fn count(&self) -> Option<usize> {
        match self {
            Self::Known(values) => Some(values.len()),
            Self::One => None,
            Self::AtRest(positions) | Self::Axis(positions, _) => Some(positions.len()),
        }
    }
}

impl Scalar<'_> {
    /// Whether `f32` holds all of them, none too large and none too small, as those of so many vertices.
    pub(super) fn is_single(&self, vertices: usize) -> bool {
        let holds = |value: f64| {
            let size = value.abs();
            size == 0.0 || (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&size)
        };
        (0..vertices).all(|vertex| holds(self.at(vertex)))
    }

    /// The number at a vertex.
    pub(super) fn at(&self, vertex: usize) -> f64 {
        match self.values {
            Values::Known(values) => values[vertex],
            Values::One => 1.0,
            Values::AtRest(positions) => -positions[vertex].length(),
            Values::Axis(positions, axis) => positions[vertex][axis],
        }
    }
}

/// The marker, if there is one, and all photosurfaces.
pub(super) fn layers<'a>(export: &'a Export<'_>) -> impl Iterator<Item = Layer<'a>> {
    let marker = export.marker.map(Layer::from);
    marker
        .into_iter()
        .chain(export.photosurfaces.iter().map(Layer::from))
}

impl<'a> From<&'a Part> for Layer<'a> {
    fn from(marker: &'a Part) -> Self {
        Self {
            name: &marker.name,
            mesh: marker.mesh(),
            material: marker.material.as_ref(),
            around: None,
            facts: None,
            vertex_data: None,
        }
    }
}

impl<'a> From<&'a Photosurface> for Layer<'a> {
    fn from(photosurface: &'a Photosurface) -> Self {
        Self {
            name: &photosurface.facts.name,
            mesh: &photosurface.mesh,
            material: photosurface.material.as_ref(),
            around: Some(photosurface.around),
            facts: Some(&photosurface.facts),
            vertex_data: Some(&photosurface.vertex_data),
        }
    }
}

impl<'a> Layer<'a> {
    /// The numbers at every vertex that are asked for; the marker, at rest and seen where it is, has them too,
    /// for programs drop what not every mesh has.
    ///
    /// # Errors
    ///
    /// Numbers that are not one for each vertex, as those of a photosurface that has none, or one that the file cannot hold.
    pub(super) fn scalars(
        &self,
        asked_for: Attributes,
        numbers: Numbers,
    ) -> Result<Vec<Scalar<'a>>, WriteError> {
        let positions = self.mesh.positions();
        let mut scalars = vec![];
        let mut add = |name, words, values: Values<'a>| {
            if let Some(found) = values.count().filter(|&found| found != positions.len()) {
                return Err(WriteError::Attribute {
                    name: self.name.to_owned(),
                    attribute: name,
                    found,
                    vertices: positions.len(),
                });
            }
            let scalar = Scalar { name, values };
            match first_beyond_f32(positions.len(), |vertex| scalar.at(vertex)) {
                Some(vertex) if numbers == Numbers::Any => {
                    let is_none = |vertex: &usize| !scalar.at(*vertex).is_finite();
                    match (vertex..positions.len()).find(is_none) {
                        Some(vertex) => Err(WriteError::Overflow {
                            name: self.name.to_owned(),
                            vertex,
                        }),
                        None => {
                            scalars.push(scalar);
                            Ok(())
                        }
                    }
                }
                Some(vertex) => Err(WriteError::Range {
                    name: self.name.to_owned(),
                    quantity: words,
                    vertex,
                    value: scalar.at(vertex),
                    limit: f64::from(f32::MAX),
                }),
                None => {
                    scalars.push(scalar);
                    Ok(())
                }
            }
        };
        let own = |of: fn(&VertexData) -> Option<&Vec<f64>>| {
            let data = self.vertex_data?;
            Some(Values::Known(of(data).map_or(&[], Vec::as_slice)))
        };
        if asked_for.doppler {
            let factors = own(|data| data.doppler_factors.as_ref());
            add(
                "doppler",
                "the Doppler factor",
                factors.unwrap_or(Values::One),
            )?;
        }
        if asked_for.emission_time {
            let times = own(|data| data.emission_times.as_ref());
            let times = times.unwrap_or(Values::AtRest(positions));
            add("emission_time", "the emission time", times)?;
        }
        if asked_for.rest_position {
            let places = match self.vertex_data {
                Some(data) => data.rest_positions.as_deref().unwrap_or_default(),
                None => positions,
            };
            for (axis, name) in ["rest_x", "rest_y", "rest_z"].into_iter().enumerate() {
                add(name, "the place at rest", Values::Axis(places, axis))?;
            }
        }
        Ok(scalars)
    }
}
