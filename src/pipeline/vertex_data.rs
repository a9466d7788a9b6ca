//! Attributes of the vertices of a photosurface.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::light_cone::ModelView;
use crate::mesh::Mesh;
use crate::scene::{Attribute, Attributes};

/// The requested attributes, with a value at every vertex.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct VertexData(BTreeMap<Attribute, VertexValues>);

/// The values of one attribute, one for each vertex.
#[derive(Clone, Debug, PartialEq)]
pub enum VertexValues {
    /// One number at each vertex.
    Numbers(Vec<f64>),
    /// One vector at each vertex.
    Vectors(Vec<DVec3>),
}

impl VertexData {
    /// The attributes of the vertices of a mesh that stands for an object, whose own mesh is `at_rest` if that is another.
    pub(super) fn new(
        shown: &ModelView,
        stand_in: &Mesh,
        at_rest: Option<&Mesh>,
        wanted: Attributes,
    ) -> Self {
        let numbers = |value: &(dyn Fn(DVec3) -> f64 + Sync)| {
            VertexValues::Numbers(stand_in.of_each_position(value))
        };
        let values = |attribute| match attribute {
            Attribute::Doppler => numbers(&|position| shown.stand_in_doppler_factor(position)),
            Attribute::EmissionTime => numbers(&|position| shown.stand_in_emission_time(position)),
            Attribute::RestPosition => {
                let at_rest = at_rest.unwrap_or(stand_in);
                VertexValues::Vectors(at_rest.of_each_position(|position| position))
            }
            Attribute::Radiance => {
                numbers(&|position| shown.stand_in_doppler_factor(position).powi(4))
            }
        };
        let columns = wanted
            .iter()
            .map(|attribute| (attribute, values(attribute)));
        Self(columns.collect())
    }

    /// The attributes that have values.
    pub fn attributes(&self) -> Attributes {
        self.0.keys().copied().collect()
    }

    /// The values of an attribute; `None` if the attribute was not requested.
    pub fn values(&self, attribute: Attribute) -> Option<&VertexValues> {
        self.0.get(&attribute)
    }

    /// The Doppler factor at each vertex: the frequency seen divided by the frequency emitted.
    pub fn doppler_factors(&self) -> Option<&[f64]> {
        self.numbers(Attribute::Doppler)
    }

    /// The time, in the observer's frame, at which the light seen now left each vertex, counted from the observation;
    /// never positive.
    pub fn emission_times(&self) -> Option<&[f64]> {
        self.numbers(Attribute::EmissionTime)
    }

    /// The position of each vertex in the object's rest frame, whose origin is the object's origin.
    pub fn rest_positions(&self) -> Option<&[DVec3]> {
        match self.values(Attribute::RestPosition)? {
            VertexValues::Vectors(vectors) => Some(vectors),
            VertexValues::Numbers(_) => None,
        }
    }

    /// The radiance seen divided by the radiance emitted, of all wavelengths together, at each vertex.
    pub fn radiances(&self) -> Option<&[f64]> {
        self.numbers(Attribute::Radiance)
    }

    /// Sets the values of an attribute, or removes them if `values` is `None`.
    pub fn set(&mut self, attribute: Attribute, values: Option<VertexValues>) {
        match values {
            Some(values) => self.0.insert(attribute, values),
            None => self.0.remove(&attribute),
        };
    }

    fn numbers(&self, attribute: Attribute) -> Option<&[f64]> {
        match self.values(attribute)? {
            VertexValues::Numbers(numbers) => Some(numbers),
            VertexValues::Vectors(_) => None,
        }
    }
}

impl VertexValues {
    /// The number of vertices, if each value has `columns` numbers; otherwise zero.
    pub(crate) fn count(&self, columns: usize) -> usize {
        match (self, columns) {
            (Self::Numbers(numbers), 1) => numbers.len(),
            (Self::Vectors(vectors), 3) => vectors.len(),
            _ => 0,
        }
    }

    /// The number `column` of the value at a vertex.
    pub(crate) fn at(&self, vertex: usize, column: usize) -> f64 {
        match self {
            Self::Numbers(numbers) => numbers[vertex],
            Self::Vectors(vectors) => vectors[vertex][column],
        }
    }
}
