//! A mesh at rest as one observer sees it.

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use crate::light_cone::{Batch, Extremes, ModelView, View};
use crate::mesh::Mesh;

/// Smallest number of vertices that a thread processes at a time: enough to outweigh the cost of handing them over.
pub(super) const VERTICES_PER_JOB: usize = 4096;

/// Number of vertices in one array of results: few enough for the cache of a core.
const VERTICES_AT_ONCE: usize = 1024;

/// A mesh in the observer's frame, and the extremes of its vertices.
#[derive(Clone, Debug)]
pub(super) struct MappedMesh {
    pub(super) mesh: Mesh,
    pub(super) extremes: Extremes,
}

impl MappedMesh {
    /// Maps every vertex of a mesh at rest, with its normal and its tangent.
    pub(super) fn new(view: &View, rest: &Mesh) -> Self {
        let (positions, normals, extremes) = places(view, rest);
        let normals = rest.normals().map(|_| normals);
        let tangents = rest.tangents().map(|tangents| {
            let jobs = rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
            // The map preserves orientation, so the bitangent keeps its sign.
            let seen = |(position, tangent): (&_, &DVec4)| {
                view.seen_tangent(*position, tangent.truncate())
                    .extend(tangent.w)
            };
            jobs.zip(tangents).map(seen).collect()
        });
        Self {
            mesh: rest.with_geometry(positions, normals, tangents),
            extremes,
        }
    }

    /// How many times, at most, a small error of a vertex at rest is magnified.
    pub(super) fn condition(&self, shown: &ModelView) -> f64 {
        let of_stand_in = shown
            .of_stand_in(0.0)
            .stretch_toward(self.extremes.forwardness);
        of_stand_in * shown.stretch().max(1.0)
    }
}

/// The positions and normals of the vertices in the observer's frame, and their extremes. The normals have no meaning
/// if the mesh at rest has none.
fn places(view: &View, rest: &Mesh) -> (Vec<DVec3>, Vec<DVec3>, Extremes) {
    let vertices = rest.positions().len();
    let see = |first: usize, positions: &mut [DVec3], normals: &mut [DVec3]| {
        let part = first..first + positions.len();
        view.see(Batch {
            rest: &rest.positions()[part.clone()],
            seen: positions,
            normals: rest.normals().map(|rest| (&rest[part], normals)),
        })
    };
    if vertices <= VERTICES_AT_ONCE {
        let (mut positions, mut normals) =
            (vec![DVec3::ZERO; vertices], vec![DVec3::ZERO; vertices]);
        let extremes = see(0, &mut positions, &mut normals);
        return (positions, normals, extremes);
    }
    // Each array has a known index in the result, so all threads write directly to the result's memory.
    let jobs = (0..vertices.div_ceil(VERTICES_AT_ONCE)).into_par_iter();
    let arrays = jobs.map(|job| {
        let first = job * VERTICES_AT_ONCE;
        let count = VERTICES_AT_ONCE.min(vertices - first);
        let mut positions = [DVec3::ZERO; VERTICES_AT_ONCE];
        let mut normals = [DVec3::ZERO; VERTICES_AT_ONCE];
        let extremes = see(first, &mut positions[..count], &mut normals[..count]);
        (extremes, (positions, normals))
    });
    let (extremes, (positions, normals)): (Vec<_>, (Vec<_>, Vec<_>)) = arrays.unzip();
    let flattened = |arrays: Vec<[DVec3; VERTICES_AT_ONCE]>| {
        let mut vectors = arrays.into_flattened();
        vectors.truncate(vertices);
        vectors
    };
    let extremes = extremes.into_iter().fold(Extremes::NONE, Extremes::and);
    (flattened(positions), flattened(normals), extremes)
}
