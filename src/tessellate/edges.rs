//! The edges of meshes that are divided, each once, so that all triangles of an edge agree.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::Allowance;
use super::edge::{division, needs_division};
use crate::mesh::Mesh;

/// Where a new vertex comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin {
    pub(super) corners: [u32; 3],
    pub(super) weights: DVec3,
}

/// The new vertices on the edges of a mesh.
pub(super) struct Edges {
    /// By the two vertices, in the order of the rule: where the edge is divided, and the first new vertex.
    pub(super) divisions: HashMap<[u32; 2], (Vec<f64>, u32)>,
    pub(super) origins: Vec<Origin>,
}

/// A count that many threads add to, and that must not go beyond a limit.
///
/// Whether it does is the same for any number of threads; where it does, who notices first is not.
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

    /// What is left before the limit.
    pub(super) fn left(&self) -> u64 {
        self.most.saturating_sub(self.sum.load(Ordering::Relaxed))
    }

    /// Whether there was room for so much.
    #[must_use]
    fn add(&self, count: u64) -> bool {
        let before = self.sum.fetch_add(count, Ordering::Relaxed);
        before.saturating_add(count) <= self.most
    }
}

/// The two vertices of an edge in an order that depends on their positions: both sides of a seam have the
/// same one.
pub(super) fn canonical([a, b]: [u32; 2], positions: &[DVec3]) -> [u32; 2] {
    // Adding zero makes one zero of the two: they are one place.
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

/// Divides those edges of some triangles that have to be. Each new vertex makes one triangle more of each of the
/// triangles that share the edge: these are counted; `None` where that is beyond the limit.
pub(super) fn divided_edges(
    mesh: &Mesh,
    looked_at: &[u32],
    observer: DVec3,
    allowance: &Allowance,
    more: &Count,
) -> Option<Edges> {
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
