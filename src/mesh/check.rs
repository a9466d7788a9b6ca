//! What keeps data from making a mesh.

use rayon::prelude::*;
use thiserror::Error;

use super::values::VALUES_PER_JOB;

/// Why data does not make a [`Mesh`](super::Mesh).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// More vertices than a `u32` index can tell apart.
    #[error("{0} vertices, expected at most {max}", max = u32::MAX)]
    TooManyVertices(usize),
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} uses vertex {index}, expected an index below {vertices}")]
    Index {
        /// Which triangle, from 0.
        triangle: usize,
        /// What it says.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// An attribute with too many or too few values.
    #[error("{attribute} has {found} values, expected one for each of {vertices} vertices")]
    Count {
        /// Which attribute.
        attribute: &'static str,
        /// How many values it has.
        found: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// NaN or infinity.
    #[error("{attribute} of vertex {vertex} is {value}, expected finite numbers")]
    NotFinite {
        /// Which attribute.
        attribute: &'static str,
        /// Which vertex, from 0.
        vertex: usize,
        /// The offending value.
        value: String,
    },
}

/// Whether triangles use nothing but the vertices that there are.
pub(crate) fn check_triangles(triangles: &[[u32; 3]], vertices: usize) -> Result<(), MeshError> {
    if vertices > u32::MAX as usize {
        return Err(MeshError::TooManyVertices(vertices));
    }
    let is_wrong = |corners: &[u32; 3]| corners.iter().any(|&i| i as usize >= vertices);
    let Some(triangle) = first_of(triangles, is_wrong) else {
        return Ok(());
    };
    let mut corners = triangles[triangle].into_iter();
    let index = corners.find(|&i| i as usize >= vertices);
    Err(MeshError::Index {
        triangle,
        index: index.expect("one of them is"),
        vertices,
    })
}

/// The first value that something holds of. Nearly always there is none, and no number is looked for where there is none.
fn first_of<T: Sync>(values: &[T], holds: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let jobs = values.par_chunks(VALUES_PER_JOB);
    let holds_of_any = |job: &[T]| job.iter().fold(false, |any, value| any | holds(value));
    let job = jobs.position_first(holds_of_any)?;
    values[job * VALUES_PER_JOB..]
        .iter()
        .position(holds)
        .map(|index| job * VALUES_PER_JOB + index)
}

/// Whether an attribute has one value for each vertex, and all are finite.
pub(super) fn check<T: std::fmt::Display + Sync>(
    attribute: &'static str,
    values: &[T],
    vertices: usize,
    is_finite: impl Fn(&T) -> bool + Sync,
) -> Result<(), MeshError> {
    if values.len() != vertices {
        return Err(MeshError::Count {
            attribute,
            found: values.len(),
            vertices,
        });
    }
    match first_of(values, |value| !is_finite(value)) {
        Some(vertex) => Err(MeshError::NotFinite {
            attribute,
            vertex,
            value: values[vertex].to_string(),
        }),
        None => Ok(()),
    }
}
