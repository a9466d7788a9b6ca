//! Triangle meshes at rest: geometry, and the attributes that travel with it.

mod edges;
mod mesh;
mod smooth;
mod winding;

pub use mesh::{Mesh, MeshError};
pub(crate) use mesh::{check_triangles, unit_or_zero};
