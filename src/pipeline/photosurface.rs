//! What comes out of the pipeline.

use std::sync::Arc;

use glam::DVec3;

use super::facts::Facts;
use super::vertex_data::VertexData;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::scene::Attributes;

/// The photosurface of one part of one object at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Photosurface {
    /// What it is and how it came about.
    pub facts: Facts,
    /// Its geometry in the observer's frame, observer at the origin: the vertices of the part at rest, in
    /// the same order, then those that were added.
    pub mesh: Mesh,
    /// The smallest and the largest coordinates of all parts of the object at this step, or at all steps where they
    /// share one mesh. Files with `f32` have positions relative to the middle of that: parts that share a corner have
    /// the same numbers there.
    pub around: (DVec3, DVec3),
    /// What else was asked for of its vertices.
    pub vertex_data: VertexData,
    /// What it is made of.
    pub material: Option<Arc<Material>>,
}

impl Photosurface {
    /// What was asked for of its vertices.
    pub fn attributes(&self) -> Attributes {
        self.vertex_data.attributes()
    }
}
