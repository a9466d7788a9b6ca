//! What goes into a file, mesh by mesh: the observer's marker and the photosurfaces alike.

use std::sync::Arc;

use glam::DVec3;

use super::pack::first_beyond_f32;
use super::{Export, WriteError};
use crate::material::{Material, Part};
use crate::mesh::Mesh;
use crate::pipeline::{Facts, Photosurface, VertexData, VertexValues};
use crate::scene::{Attribute, Attributes};

/// One mesh of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<'a> {
    pub(super) name: &'a str,
    pub(super) mesh: &'a Mesh,
    pub(super) material: Option<&'a Arc<Material>>,
    /// The box around all that shares corners with it, if that is more.
    pub(super) around: Option<(DVec3, DVec3)>,
    /// How far it is moved, so that it stands beside others.
    pub(super) beside: DVec3,
    /// `None` for the observer's own marker: nothing moves.
    pub(super) facts: Option<&'a Facts>,
    pub(super) vertex_data: Option<&'a VertexData>,
}

/// A number at every vertex.
#[derive(Debug)]
pub(super) struct Scalar<'a> {
    /// In lower case; glTF writes it in upper case behind an underscore.
    pub(super) name: &'static str,
    attribute: Attribute,
    /// Which number of the attribute.
    column: usize,
    values: Values<'a>,
}

/// Where the numbers come from.
#[derive(Clone, Copy, Debug)]
enum Values<'a> {
    /// A photosurface, which knows them.
    Known(&'a VertexValues),
    /// Vertices at rest in the observer's frame, at these positions.
    AtRest(&'a [DVec3]),
}

/// What numbers of a file may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    /// `f32` only.
    Single,
    /// `f64` where `f32` is not enough.
    Any,
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
            Values::Known(values) => values.at(vertex, self.column),
            Values::AtRest(positions) => match self.attribute {
                Attribute::Doppler | Attribute::Radiance => 1.0,
                Attribute::EmissionTime => -positions[vertex].length(),
                Attribute::RestPosition => positions[vertex][self.column],
            },
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
            beside: DVec3::ZERO,
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
            beside: photosurface.beside,
            facts: Some(&photosurface.facts),
            vertex_data: Some(&photosurface.vertex_data),
        }
    }
}

impl<'a> Layer<'a> {
    /// Where a place is after the mesh has been moved; a mesh that stays keeps the signs of its zeros.
    pub(super) fn moved(&self, place: DVec3) -> DVec3 {
        match self.beside == DVec3::ZERO {
            true => place,
            false => place + self.beside,
        }
    }

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
        let mut scalars = vec![];
        for attribute in asked_for.iter() {
            let values = self.values(attribute)?;
            for (column, &name) in attribute.columns().iter().enumerate() {
                let scalar = Scalar {
                    name,
                    attribute,
                    column,
                    values,
                };
                self.check(&scalar, numbers)?;
                scalars.push(scalar);
            }
        }
        Ok(scalars)
    }

    /// The values of an attribute, one for each vertex.
    fn values(&self, attribute: Attribute) -> Result<Values<'a>, WriteError> {
        let Some(data) = self.vertex_data else {
            return Ok(Values::AtRest(self.mesh.positions()));
        };
        let vertices = self.mesh.vertex_count();
        let columns = attribute.columns();
        let values = data.values(attribute);
        let found = values.map_or(0, |values| values.count(columns.len()));
        match values.filter(|_| found == vertices) {
            Some(values) => Ok(Values::Known(values)),
            None => Err(WriteError::Attribute {
                name: self.name.to_owned(),
                attribute: columns[0],
                found,
                vertices,
            }),
        }
    }

    /// Whether a file can hold the numbers.
    fn check(&self, scalar: &Scalar<'_>, numbers: Numbers) -> Result<(), WriteError> {
        let vertices = self.mesh.vertex_count();
        let Some(vertex) = first_beyond_f32(vertices, |vertex| scalar.at(vertex)) else {
            return Ok(());
        };
        let is_overflow = |vertex: &usize| !scalar.at(*vertex).is_finite();
        match (numbers, (vertex..vertices).find(is_overflow)) {
            (Numbers::Any, None) => Ok(()),
            (Numbers::Any, Some(vertex)) => Err(WriteError::Overflow {
                name: self.name.to_owned(),
                vertex,
            }),
            (Numbers::Single, _) => Err(WriteError::Range {
                name: self.name.to_owned(),
                quantity: scalar.attribute.quantity(),
                vertex,
                value: scalar.at(vertex),
                limit: f64::from(f32::MAX),
            }),
        }
    }
}
