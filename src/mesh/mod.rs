//! Triangle meshes at rest: geometry, and the attributes that travel with it.

mod alike;
mod check;
mod edges;
mod extent;
mod flat;
mod mesh;
mod smooth;
mod triangles;
mod values;
mod vectors;
mod vertices;
mod winding;

pub use check::MeshError;
pub(crate) use check::check_triangles;
pub(crate) use extent::Extent;
pub use mesh::Mesh;
pub(crate) use mesh::MeshIdentity;
pub(crate) use triangles::Triangles;
pub(crate) use values::{VALUES_PER_JOB, flattened, unit_or_zero};
pub(crate) use vectors::{Places, Vectors};
pub(crate) use vertices::{MANY_VERTICES, VERTICES_AT_ONCE};
