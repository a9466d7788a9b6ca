//! Which triangles of the meshes of one object share an edge: by the positions of its ends, whatever vertices it has.

use std::cmp::Ordering;

use glam::DVec3;
use rayon::prelude::*;

use super::across::Facet;
use super::edges::{canonical, sides};
use super::survey::Survey;
use super::{Motion, edge_gap, triangle_gap};
use crate::mesh::Mesh;

/// The distance of a vertex from the plane of a facet, relative to the distances of the corners from the origin, up to
/// which both count as parts of one plane: rounding of coordinates.
const IN_PLANE: f64 = 32.0 * f64::EPSILON;

/// A triangle of a survey's list `above`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Looked {
    pub(super) mesh: u32,
    /// Index of the triangle in its mesh.
    pub(super) index: u32,
    /// The gap of the triangle, in the rest frame.
    pub(super) gap: f64,
    /// The side with the largest gap.
    pub(super) largest_side: u8,
    /// For each side whether the surface goes on in the same plane beyond it.
    pub(super) is_free: [bool; 3],
}

/// A side of a triangle that is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    /// Index of the triangle in the list `looked`.
    pub(super) looked: u32,
    pub(super) side: u8,
    /// The two vertices in [`canonical`] order.
    pub(super) pair: [u32; 2],
}

/// An edge whose gap is not small, and the triangles that share it.
#[derive(Clone, Debug)]
pub(super) struct SharedEdge {
    /// The positions of its ends, in canonical order.
    pub(super) ends: [DVec3; 2],
    /// The gap of the edge, in the rest frame.
    pub(super) gap: f64,
    pub(super) members: Vec<Member>,
    pub(super) is_free: bool,
}

/// The triangles that may have to be divided, and their edges.
pub(super) struct Adjacency {
    /// All triangles of the surveys' lists, in the order of the meshes and of their lists.
    pub(super) looked: Vec<Looked>,
    /// The index in `looked` of the first triangle of each mesh, and the number of all.
    pub(super) firsts: Vec<usize>,
    /// For each triangle in `looked` its facet as the surface measure needs it, if that has a certain normal; empty for
    /// points.
    facets: Vec<Option<Facet>>,
    /// In the order of their ends.
    pub(super) edges: Vec<SharedEdge>,
}

/// The key of a position: zeros of either sign are one position.
type Key = [u64; 3];

/// A side with the keys of its ends.
type KeyedMember = (Key, Key, Member);

impl Adjacency {
    /// The triangles that the surveys found, and their edges whose gap is larger than `small` says for the offsets of its
    /// ends from the observer.
    pub(super) fn new(
        meshes: &[&Mesh],
        found: &[Survey],
        observer: DVec3,
        motion: Option<&Motion>,
        small: impl Fn(&[DVec3]) -> f64 + Sync,
    ) -> Self {
        let all: Vec<(u32, u32)> = found
            .iter()
            .zip(0..)
            .flat_map(|(found, mesh)| found.above.iter().map(move |&index| (mesh, index)))
            .collect();
        let mut firsts = vec![0];
        for found in found {
            firsts.push(firsts.last().unwrap_or(&0) + found.above.len());
        }
        let offsets_of = |mesh: u32, index: u32| {
            let of_mesh = meshes[mesh as usize];
            let corners = of_mesh.triangles()[index as usize];
            corners.map(|corner| of_mesh.positions()[corner as usize] - observer)
        };
        let mut looked: Vec<Looked> = all
            .par_iter()
            .map(|&(mesh, index)| {
                let offsets = offsets_of(mesh, index);
                let gaps = gaps_of_sides(offsets);
                let largest_side =
                    (0..3).fold(0, |l: usize, i| if gaps[i] > gaps[l] { i } else { l });
                Looked {
                    mesh,
                    index,
                    gap: triangle_gap(offsets[0], offsets[1], offsets[2]),
                    largest_side: largest_side as u8,
                    is_free: [false; 3],
                }
            })
            .collect();
        let facets: Vec<Option<Facet>> = match motion {
            Some(motion) => all
                .par_iter()
                .map(|&(mesh, index)| Facet::new(motion, offsets_of(mesh, index)))
                .collect(),
            None => vec![],
        };
        let small = &small;
        let members_of = |(number, &(mesh, index)): (usize, &(u32, u32))| {
            let positions = meshes[mesh as usize].positions();
            let corners = meshes[mesh as usize].triangles()[index as usize];
            let gaps = gaps_of_sides(offsets_of(mesh, index));
            let members = sides(corners).into_iter().zip(gaps).zip(0..);
            members.filter_map(move |((side, gap), number_of_side)| {
                let ends = side.map(|vertex| positions[vertex as usize] - observer);
                let pair = canonical(side, positions);
                let [from, to] = pair.map(|vertex| key(positions[vertex as usize]));
                let member = Member {
                    looked: number as u32,
                    side: number_of_side,
                    pair,
                };
                (gap > small(&ends)).then_some((from, to, member))
            })
        };
        let members = all.par_iter().enumerate().flat_map_iter(members_of);
        let mut members: Vec<KeyedMember> = members.collect();
        // Members with equal keys are ordered as well, so that the result is the same for any number of threads.
        members
            .par_sort_unstable_by_key(|&(from, to, member)| (from, to, member.looked, member.side));
        let position = |member: &Member, end: usize| {
            let mesh = looked[member.looked as usize].mesh as usize;
            meshes[mesh].positions()[member.pair[end] as usize]
        };
        let edges: Vec<SharedEdge> = members
            .par_chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .map(|equal| {
                let members: Vec<Member> = equal.iter().map(|&(_, _, member)| member).collect();
                let ends = [0, 1].map(|end| position(&members[0], end));
                SharedEdge {
                    ends,
                    gap: edge_gap(ends[0] - observer, ends[1] - observer),
                    is_free: is_free(meshes, &looked, &facets, &members),
                    members,
                }
            })
            .collect();
        for edge in edges.iter().filter(|edge| edge.is_free) {
            for member in &edge.members {
                looked[member.looked as usize].is_free[member.side as usize] = true;
            }
        }
        Self {
            looked,
            firsts,
            facets,
            edges,
        }
    }

    /// How far, in the rest frame, facets that count as parts of one plane may be from it: as far as rays lead, a few
    /// times as far as their corners.
    pub(super) fn off_plane(&self, meshes: &[&Mesh]) -> f64 {
        const FEW: f64 = 4.0;
        if !self.edges.iter().any(|edge| edge.is_free) {
            return 0.0;
        }
        let sizes = meshes.iter().flat_map(|mesh| mesh.positions());
        FEW * IN_PLANE * sizes.fold(0.0, |size: f64, place| size.max(place.length()))
    }

    /// Lets some triangles in the list `looked` count with their gaps from now on.
    pub(super) fn count_with_gaps(&mut self, numbers: &[usize]) {
        for &number in numbers {
            self.facets[number] = None;
        }
        for edge in self.edges.iter_mut().filter(|edge| edge.is_free) {
            let mut facets = edge.members.iter();
            if facets.any(|member| self.facets[member.looked as usize].is_none()) {
                edge.is_free = false;
                for member in &edge.members {
                    self.looked[member.looked as usize].is_free[member.side as usize] = false;
                }
            }
        }
    }

    /// The facet of a triangle in the list `looked`, as the surface measure needs it.
    pub(super) fn facet(&self, number: usize) -> Option<Facet> {
        self.facets.get(number).copied().flatten()
    }
}

fn gaps_of_sides(offsets: [DVec3; 3]) -> [f64; 3] {
    [(0, 1), (1, 2), (2, 0)].map(|(i, j)| edge_gap(offsets[i], offsets[j]))
}

fn key(position: DVec3) -> Key {
    // Adding zero turns -0 into 0.
    position.to_array().map(|x| (x + 0.0).to_bits())
}

/// Whether exactly two facets of one plane lie on either side of an edge, with the same side up.
fn is_free(
    meshes: &[&Mesh],
    looked: &[Looked],
    facets: &[Option<Facet>],
    members: &[Member],
) -> bool {
    let &[one, other] = members else {
        return false;
    };
    let of = |member: Member| {
        let facet = facets.get(member.looked as usize).copied().flatten()?;
        let looked = looked[member.looked as usize];
        let positions = meshes[looked.mesh as usize].positions();
        let corners = meshes[looked.mesh as usize].triangles()[looked.index as usize];
        let corners = corners.map(|corner| positions[corner as usize]);
        let side = member.side as usize;
        Some((
            facet,
            [side, (side + 1) % 3, (side + 2) % 3].map(|corner| corners[corner]),
        ))
    };
    let (Some((facet, [a, b, c])), Some((beyond, [p, q, r]))) = (of(one), of(other)) else {
        return false;
    };
    let size = [a, b, c, p, q, r]
        .iter()
        .fold(0.0f64, |size, corner| size.max(corner.length()));
    let in_plane = |normal: DVec3, offset: DVec3| normal.dot(offset).abs() <= IN_PLANE * size;
    // Neighbours with the same side up pass their common edge in opposite directions.
    let passes = key(a).cmp(&key(q)) == Ordering::Equal && key(b).cmp(&key(p)) == Ordering::Equal;
    passes
        && in_plane(facet.normal, r - a)
        && in_plane(beyond.normal, c - p)
        && facet.normal.dot(beyond.normal) > 0.5
}
