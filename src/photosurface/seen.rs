//! A mesh at rest as one observer sees it, and what else is known of its vertices.

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use crate::light_cone::View;
use crate::mesh::Mesh;
use crate::scene::Attributes;

/// Vertices a thread takes at a time: enough to outweigh handing them over.
const VERTICES_PER_JOB: usize = 4096;

/// Numbers at every vertex, those that were asked for.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct VertexData {
    /// Frequency seen over frequency emitted.
    pub doppler_factors: Option<Vec<f64>>,
    /// When the light left that is seen now, in the observer's frame, counted from now.
    pub emission_times: Option<Vec<f64>>,
    /// Where the vertex is in the object's rest frame, the object's origin at its origin.
    pub rest_positions: Option<Vec<DVec3>>,
}

impl VertexData {
    pub(super) fn new(view: &View, rest: &Mesh, wanted: Attributes) -> Self {
        let at_each = |value: &(dyn Fn(DVec3) -> f64 + Sync)| {
            let jobs = rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
            jobs.map(|&position| value(position)).collect()
        };
        Self {
            doppler_factors: (wanted.doppler)
                .then(|| at_each(&|position| view.doppler_factor(position))),
            emission_times: (wanted.emission_time)
                .then(|| at_each(&|position| view.emission_time(position))),
            rest_positions: wanted.rest_position.then(|| rest.positions().to_vec()),
        }
    }
}

/// The mesh as it is seen: every vertex mapped, with its normal and its tangent.
pub(super) fn seen_mesh(view: &View, rest: &Mesh) -> Mesh {
    let jobs = || rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
    let positions = jobs()
        .map(|&position| view.seen_position(position))
        .collect();
    let normals = rest.normals().map(|normals| {
        let pairs = jobs().zip(normals);
        pairs
            .map(|(&position, &normal)| view.seen_normal(position, normal))
            .collect()
    });
    let tangents = rest.tangents().map(|tangents| {
        let pairs = jobs().zip(tangents);
        // The map never turns orientation round: the bitangent keeps its sign.
        let seen = |(position, tangent): (&_, &DVec4)| {
            view.seen_tangent(*position, tangent.truncate())
                .extend(tangent.w)
        };
        pairs.map(seen).collect()
    });
    rest.with_geometry(positions, normals, tangents)
}

/// How many times, at most, a small error of a vertex is magnified.
pub(super) fn condition(view: &View, rest: &Mesh) -> f64 {
    let jobs = rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
    let forwardness = jobs
        .map(|&position| view.forwardness(position))
        .reduce(|| 0.0, f64::max);
    view.stretch_toward(forwardness)
}
