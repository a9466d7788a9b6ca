//! Division of the edges of a mesh: each edge once, so that all its triangles agree.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::across::Facet;
use super::adjacency::{Adjacency, Member, SharedEdge};
use super::count::Count;
use super::edge::{EDGE_SHARE, EdgeRule, SPARED, division};
use super::{Allowance, Motion};
use crate::mesh::Mesh;

/// A triangle whose gap is at most so many times the allowed one needs few pieces.
const FEW_PIECES: f64 = 2.0;

/// The largest side of a triangle with too large a gap is not divided if its own gap is less than this fraction of the
/// allowed one: a point inside is better then.
pub(super) const LARGEST: f64 = 0.9;

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

/// Divides the edges for which the edge rule or one of its triangles asks. Each new vertex adds one triangle for each
/// triangle that shares the edge. `more` counts these additional triangles; the result is `None` if the count exceeds
/// its limit.
///
/// An edge is divided if its gap is more than the rule allows, or [`SPARED`] times that where all of its triangles need
/// few pieces; and if a triangle with too large a gap, which no other of its sides would divide, has no larger side.
pub(super) fn divided_edges(
    meshes: &[&Mesh],
    adjacency: &Adjacency,
    observer: DVec3,
    allowance: &Allowance,
    motion: Option<&Motion>,
    more: &Count,
) -> Option<Vec<Edges>> {
    let gaps: Vec<f64> = adjacency
        .looked
        .par_iter()
        .map(|looked| {
            let mesh = meshes[looked.mesh as usize];
            let corners = mesh.triangles()[looked.index as usize];
            let offsets = corners.map(|corner| mesh.positions()[corner as usize] - observer);
            looked.gap / allowance.between(&offsets)
        })
        .collect();
    let division = |edge: &SharedEdge| -> Option<Vec<f64>> {
        let facets: Vec<Option<Facet>> = (edge.members.iter())
            .map(|member| adjacency.facet(member.looked as usize))
            .collect();
        let rule = EdgeRule {
            allowance,
            motion,
            facets: &facets,
            is_free: edge.is_free,
        };
        let [a, b] = edge.ends;
        let offsets = [a - observer, b - observer];
        let allowed = rule.allowed(&offsets, (b - a).normalize_or_zero());
        let times = edge.gap / allowed;
        let gap = |member: &Member| gaps[member.looked as usize];
        let is_of_points = allowed <= EDGE_SHARE * allowance.between(&offsets);
        let few = edge.members.iter().all(|member| gap(member) <= FEW_PIECES);
        let spared = match is_of_points && few {
            true => SPARED,
            false => 1.0,
        };
        let is_largest = |member: &Member| {
            let looked = &adjacency.looked[member.looked as usize];
            gap(member) > 1.0 && looked.largest_side == member.side
        };
        let is_wanted = || times > LARGEST && edge.members.iter().any(is_largest);
        if !(times > spared || is_wanted()) {
            return Some(vec![]);
        }
        let triangles = edge.members.len() as u64;
        let parameters = division(a, b, observer, &rule, (more.left() / triangles) as usize)?;
        let room = more.add(triangles * parameters.len() as u64);
        room.then_some(parameters)
    };
    let divisions: Option<Vec<Vec<f64>>> = adjacency.edges.par_iter().map(division).collect();

    let mut pairs: Vec<Vec<([u32; 2], Vec<f64>)>> = vec![vec![]; meshes.len()];
    for (edge, parameters) in adjacency.edges.iter().zip(divisions?) {
        if parameters.is_empty() {
            continue;
        }
        for member in &edge.members {
            let mesh = adjacency.looked[member.looked as usize].mesh as usize;
            pairs[mesh].push((member.pair, parameters.clone()));
        }
    }
    let edges = meshes.iter().zip(pairs);
    let edges = edges.map(|(mesh, mut pairs)| {
        pairs.sort_by_key(|&(pair, _)| pair);
        pairs.dedup_by_key(|&mut (pair, _)| pair);
        let mut result = Edges {
            divisions: HashMap::with_capacity(pairs.len()),
            origins: vec![],
        };
        for ([a, b], parameters) in pairs {
            let first = (mesh.positions().len() + result.origins.len()) as u32;
            result
                .origins
                .extend(parameters.iter().map(|&parameter| Origin {
                    corners: [a, b, b],
                    weights: DVec3::new(1.0 - parameter, parameter, 0.0),
                }));
            result.divisions.insert([a, b], (parameters, first));
        }
        result
    });
    Some(edges.collect())
}
