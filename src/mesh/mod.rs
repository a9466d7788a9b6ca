//! Triangle meshes at rest: geometry, and the attributes that travel with it.

mod alike;
mod edges;
mod extent;
mod mesh;
mod smooth;
mod triangles;
mod vectors;
mod vertices;
mod winding;

pub(crate) use extent::Extent;
pub use mesh::{Mesh, MeshError};
pub(crate) use mesh::{VALUES_PER_JOB, check_triangles, unit_or_zero};
pub(crate) use triangles::Triangles;
pub(crate) use vectors::{Places, Vectors};
pub(crate) use vertices::{MANY_VERTICES, VERTICES_AT_ONCE};
