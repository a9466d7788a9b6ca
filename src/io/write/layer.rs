//! What goes into a file, mesh by mesh: the observer's marker and the photosurfaces alike.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;

use super::{Export, WriteError};
use crate::mesh::{Material, Mesh, Part};
use crate::photosurface::{Facts, Photosurface, VertexData};
use crate::scene::Attributes;

/// One mesh of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<'a> {
    pub(super) name: &'a str,
    pub(super) mesh: &'a Mesh,
    pub(super) material: Option<&'a Arc<Material>>,
    /// `None` for the observer's own marker: nothing moves.
    pub(super) facts: Option<&'a Facts>,
    vertex_data: Option<&'a VertexData>,
}

/// A number at every vertex.
#[derive(Debug)]
pub(super) struct Scalar<'a> {
    /// In lower case; glTF writes it in upper case behind an underscore.
    pub(super) name: &'static str,
    pub(super) values: Cow<'a, [f64]>,
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
    /// A number that `f32` cannot hold.
    pub(super) fn scalars(&self, asked_for: Attributes) -> Result<Vec<Scalar<'a>>, WriteError> {
        let positions = self.mesh.positions();
        let mut scalars = vec![];
        let mut add = |name, words, values: Cow<'a, [f64]>| {
            let limit = f64::from(f32::MAX);
            match values.iter().position(|value| !(value.abs() <= limit)) {
                Some(vertex) => Err(WriteError::Range {
                    name: self.name.to_owned(),
                    quantity: words,
                    vertex,
                    value: values[vertex],
                    limit,
                }),
                None => {
                    scalars.push(Scalar { name, values });
                    Ok(())
                }
            }
        };
        let own = |of: fn(&VertexData) -> Option<&Vec<f64>>| {
            Some(Cow::Borrowed(of(self.vertex_data?)?.as_slice()))
        };
        if asked_for.doppler {
            let factors = own(|data| data.doppler_factors.as_ref());
            let factors = factors.unwrap_or_else(|| vec![1.0; positions.len()].into());
            add("doppler", "the Doppler factor", factors)?;
        }
        if asked_for.emission_time {
            let times = own(|data| data.emission_times.as_ref());
            let now = || positions.iter().map(|position| -position.length());
            let times = times.unwrap_or_else(|| now().collect());
            add("emission_time", "the emission time", times)?;
        }
        if asked_for.rest_position {
            let places = self
                .vertex_data
                .and_then(|data| data.rest_positions.as_ref());
            let places = places.map_or(positions, Vec::as_slice);
            let axis = |of: fn(&DVec3) -> f64| places.iter().map(of).collect();
            add("rest_x", "the place at rest", axis(|place| place.x))?;
            add("rest_y", "the place at rest", axis(|place| place.y))?;
            add("rest_z", "the place at rest", axis(|place| place.z))?;
        }
        Ok(scalars)
    }
}
