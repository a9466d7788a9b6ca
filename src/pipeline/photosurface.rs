//! A photosurface, the result of the pipeline.

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
    /// The facts about the photosurface, with its certificate.
    pub facts: Facts,
    /// The geometry in the observer's frame, with the observer at the origin: first the vertices of the part at rest,
    /// in the same order, then those that refinement added.
    pub mesh: Mesh,
    /// The smallest and the largest coordinates, in the observer's frame, of all parts of the object at this step, or
    /// at all steps if they share one mesh. Files with `f32` store positions relative to the middle of this box, so
    /// that parts with a common corner have the same numbers there.
    pub around: (DVec3, DVec3),
    /// How far files move the mesh, in the observer's frame, so that it stands beside others; zero unless asked for.
    pub beside: DVec3,
    /// The requested attributes of the vertices.
    pub vertex_data: VertexData,
    /// The material of the part; `None` if the source has none.
    pub material: Option<Arc<Material>>,
}

impl Photosurface {
    /// Which attributes the vertices have.
    pub fn attributes(&self) -> Attributes {
        self.vertex_data.attributes()
    }
}
