//! What a file or a shape gives: named meshes with their materials.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use serde_json::Value;

use super::Material;
use crate::mesh::{Mesh, MeshError};

/// A mesh with its name and material; becomes one photosurface for every step.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// As the source names it; empty where there is only one and it needs no name.
    pub name: String,
    /// The geometry; with normals unless [`Normals::None`](super::Normals::None) was asked for.
    mesh: Mesh,
    /// The geometry as the source has it where it has no normals, until it is known which ones it should get.
    unshaded: Option<Mesh>,
    /// What it is made of; shared by all parts made of the same.
    pub material: Option<Arc<Material>>,
    /// What else the source says of it, which means nothing here: the `extras` of glTF, of the `node`, the
    /// `mesh` and the `primitive`.
    pub extras: Option<Arc<Value>>,
}

impl Part {
    /// A part; a mesh without normals gets those of its flat triangles.
    ///
    /// # Errors
    ///
    /// As [`Mesh::with_flat_normals`].
    pub fn new(
        name: impl Into<String>,
        mesh: Mesh,
        material: Option<Arc<Material>>,
    ) -> Result<Self, MeshError> {
        let unshaded = (!mesh.has_normals()).then(|| mesh.clone());
        let mesh = match &unshaded {
            None => mesh,
            Some(_) => mesh.with_flat_normals()?,
        };
        Ok(Self {
            name: name.into(),
            mesh,
            unshaded,
            material,
            extras: None,
        })
    }

    /// The part moved, turned, scaled or mirrored.
    #[must_use]
    pub fn transformed(self, transform: &DAffine3) -> Self {
        Self {
            mesh: self.mesh.transformed(transform),
            unshaded: self.unshaded.map(|mesh| mesh.transformed(transform)),
            ..self
        }
    }

    /// The same part with other geometry, which has the normals that it should have.
    pub(crate) fn with_mesh(&self, mesh: Mesh) -> Self {
        Self {
            name: self.name.clone(),
            mesh,
            unshaded: None,
            material: self.material.clone(),
            extras: self.extras.clone(),
        }
    }

    /// The geometry without normals, if the source has none and nobody has said yet which ones it should get.
    pub(super) fn unshaded(&self) -> Option<&Mesh> {
        self.unshaded.as_ref()
    }

    /// The geometry.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }
}

/// Everything one source gives, at rest, in the coordinates of the object.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Model {
    /// In the order of the source.
    pub parts: Vec<Part>,
    /// What the source says of itself as a whole: its `copyright`, and the `extras` of glTF of its `asset`, its `scene`
    /// and the `file`.
    pub origin: Option<Arc<Value>>,
}

impl Model {
    /// How many triangles all parts have together.
    pub fn triangle_count(&self) -> usize {
        self.parts
            .iter()
            .map(|part| part.mesh.triangle_count())
            .sum()
    }

    /// The smallest and the largest corner of the box around all vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let bounds = self.parts.iter().filter_map(|part| part.mesh.bounds());
        bounds.reduce(|(low, high), (other_low, other_high)| {
            (low.min(other_low), high.max(other_high))
        })
    }

    /// How many vertices all parts have together.
    pub fn vertex_count(&self) -> usize {
        self.parts.iter().map(|part| part.mesh.vertex_count()).sum()
    }
}
