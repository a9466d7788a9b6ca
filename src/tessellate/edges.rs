//! Division of the edges of a mesh: each edge once, so that all its triangles agree.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::Allowance;
use super::edge::{division, needs_division};
use crate::mesh::Mesh;

/// The source of a new vertex: corners of the old mesh, and weights that interpolate them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin {
    pub(super) corners: [u32; 3],
    pub(super) weights: DVec3,
}

/// The divided edges of a mesh, and the new vertices on them.
pub(super) struct Edges {
    /// For each divided edge, named by its two vertices in [`canonical`] order: the parameters that divide it, and the
    /// index of its first new vertex.
    pub(super) divisions: HashMap<[u32; 2], (Vec<f64>, u32)>,
    pub(super) origins: Vec<Origin>,
}

/// A count to which many threads add and which must not exceed a limit.
///
/// Whether the sum exceeds the limit does not depend on the number of threads; which thread notices it first does.
pub(super) struct Count {
    sum: AtomicU64,
    most: u64,
}

impl Count {
    pub(super) fn up_to(most: u64) -> Self {
        Self {
            sum: AtomicU64::new(0),
            most,
        }
    }

    /// The remainder up to the limit.
    pub(super) fn left(&self) -> u64 {
        self.most.saturating_sub(self.sum.load(Ordering::Relaxed))
    }

    /// Adds to the count; whether the sum is within the limit.
    #[must_use]
    fn add(&self, count: u64) -> bool {
        let before = self.sum.fetch_add(count, Ordering::Relaxed);
        before.saturating_add(count) <= self.most
    }
}

/// The two vertices of an edge in an order that depends on their positions, so that both sides of a seam have the same
/// order.
pub(super) fn canonical([a, b]: [u32; 2], positions: &[DVec3]) -> [u32; 2] {
    // Adding zero turns -0 into 0, because both are the same position.
    let key = |vertex: u32| positions[vertex as usize].to_array().map(|x| x + 0.0);
    let order = |p: [f64; 3], q: [f64; 3]| {
        p.iter()
            .zip(q)
            .map(|(p, q)| p.total_cmp(&q))
            .find(|order| order.is_ne())
    };
    match order(key(a), key(b)) {
        Some(std::cmp::Ordering::Greater) => [b, a],
        None if a > b => [b, a],
        _ => [a, b],
    }
}

pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Divides the edges of some triangles where the edge rule asks for it. Each new vertex adds one triangle for each
/// triangle that shares the edge. `more` counts these additional triangles; the result is `None` if the count exceeds
/// its limit.
pub(super) fn divided_edges(
    mesh: &Mesh,
    looked_at: &[u32],
    observer: DVec3,
    allowance: &Allowance,
    more: &Count,
) -> Option<Edges> {
    if looked_at.is_empty() {
        return Some(Edges {
            divisions: HashMap::new(),
            origins: vec![],
        });
    }
    let positions = mesh.positions();
    let needs_division = |[a, b]: [u32; 2]| {
        let offset = |vertex: u32| positions[vertex as usize] - observer;
        needs_division(offset(a), offset(b), allowance)
    };
    let mut sides: Vec<[u32; 2]> = looked_at
        .par_iter()
        .flat_map_iter(|&index| sides(mesh.triangles()[index as usize]))
        .filter(|&side| needs_division(side))
        .map(|side| canonical(side, positions))
        .collect();
    sides.par_sort_unstable();
    let edges: Vec<([u32; 2], u64)> = sides
        .chunk_by(|a, b| a == b)
        .map(|equal| (equal[0], equal.len() as u64))
        .collect();
    let divisions: Option<Vec<Vec<f64>>> = edges
        .par_iter()
        .map(|&([a, b], triangles)| {
            let parameters = division(
                positions[a as usize],
                positions[b as usize],
                observer,
                allowance,
                (more.left() / triangles) as usize,
            )?;
            let room = more.add(triangles * parameters.len() as u64);
            room.then_some(parameters)
        })
        .collect();

    let mut result = Edges {
        divisions: HashMap::with_capacity(edges.len()),
        origins: vec![],
    };
    for (([a, b], _), parameters) in edges.into_iter().zip(divisions?) {
        let first = (positions.len() + result.origins.len()) as u32;
        result
            .origins
            .extend(parameters.iter().map(|&parameter| Origin {
                corners: [a, b, b],
                weights: DVec3::new(1.0 - parameter, parameter, 0.0),
            }));
        result.divisions.insert([a, b], (parameters, first));
    }
    Some(result)
}
