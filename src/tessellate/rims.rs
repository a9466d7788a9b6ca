//! What it costs, in the surface measure, that the photosurface of a plane ends at rims.

use glam::DVec3;

use super::Motion;
use super::across::{Across, Facet, rim_cost};
use super::adjacency::Adjacency;
use super::along::{Along, PlanePoint};
use super::edge::point_between;
use super::edges::{Edges, canonical, sides};
use crate::mesh::Mesh;

/// The share of a gap below which the allowed gap no longer grows.
const MIN_SHARE: f64 = 1e-3;

/// The smallest fraction of a tolerance that a rim may leave.
const MIN_LEFT: f64 = 0.05;

/// The facet of a triangle with its rims: judges how far output triangles are from the photosurface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Judge {
    facet: Facet,
    /// For each side the largest rim cost of all rims that a ray across this side may reach, as a gap.
    beyond: [f64; 3],
    /// For each side the distance of the opposite corner, in the rest frame.
    heights: [f64; 3],
}

impl Judge {
    /// The bounds for an output triangle; `None` if it has to count with its gap.
    pub(super) fn across(&self, along: &Along, corners: [&PlanePoint; 3]) -> Option<Across> {
        self.facet.across(along, corners)
    }

    /// The largest rim cost that a ray may meet which leads so far from an output triangle, whose corners have these
    /// weights of the source triangle's corners.
    pub(super) fn met(&self, reach: f64, weights: &[DVec3]) -> f64 {
        (0..3).fold(0.0, |met: f64, side| {
            let nearest = weights.iter().fold(f64::INFINITY, |near, weights| {
                near.min(weights[(side + 2) % 3])
            });
            // Weights are rounded.
            let is_met = !((nearest - 1e-12) * self.heights[side] > reach);
            if is_met {
                met.max(self.beyond[side])
            } else {
                met
            }
        })
    }

    /// The bound for an output triangle, as a gap; infinity if it has to count with its gap.
    pub(super) fn bound(
        &self,
        along: &Along,
        corners: [&PlanePoint; 3],
        weights: [DVec3; 3],
    ) -> f64 {
        match self.across(along, corners) {
            Some(Across { ray, reach }) => ray + self.met(reach, &weights),
            None => f64::INFINITY,
        }
    }

    /// The gap that a triangle near this place may have, where a gap of `allowed` is allowed to points.
    pub(super) fn allowed(&self, allowed: f64, offset: DVec3, weights: DVec3) -> f64 {
        let met = self.met(self.facet.reach_of(allowed), &[weights]);
        let left = (1.0 - met / allowed).max(MIN_LEFT);
        allowed * (left / self.facet.share(offset).max(MIN_SHARE)).max(1.0)
    }

    /// The largest rim cost of the sides of an output triangle: what it costs that rays must not pass it.
    pub(super) fn cut(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        let motion = self.facet.motion();
        let costs = [(a, b), (b, c), (c, a)].map(|(from, to)| rim_cost(motion, from, to));
        costs.into_iter().fold(0.0, f64::max)
    }
}

/// The judges of all triangles that are looked at.
pub(super) struct Rims {
    /// In the order of [`Adjacency::looked`]; `None` for a triangle that counts with its gap, and no list for points.
    judges: Vec<Option<Judge>>,
    /// For each triangle the number of the plane's piece to which it belongs; empty for points.
    pub(super) regions: Vec<u32>,
}

impl Rims {
    /// The judges for the edges as they are divided.
    pub(super) fn new(
        meshes: &[&Mesh],
        adjacency: &Adjacency,
        edges: &[Edges],
        observer: DVec3,
        motion: Option<&Motion>,
    ) -> Self {
        let Some(motion) = motion else {
            return Self {
                judges: vec![],
                regions: vec![],
            };
        };
        let regions = regions(adjacency);
        let costs: Vec<[f64; 3]> = adjacency
            .looked
            .iter()
            .map(|looked| {
                let mesh = meshes[looked.mesh as usize];
                let corners = mesh.triangles()[looked.index as usize];
                let number = [0, 1, 2];
                number.map(|side| match looked.is_free[side] {
                    true => 0.0,
                    false => side_cost(
                        sides(corners)[side],
                        mesh.positions(),
                        &edges[looked.mesh as usize],
                        observer,
                        motion,
                    ),
                })
            })
            .collect();
        let mut of_regions = vec![0.0f64; regions.len()];
        for (costs, &region) in costs.iter().zip(&regions) {
            let cost = costs.iter().fold(0.0, |l: f64, &cost| l.max(cost));
            let of_region = &mut of_regions[region as usize];
            *of_region = of_region.max(cost);
        }
        let judges = adjacency.looked.iter().enumerate().zip(costs).zip(&regions);
        let judges = judges.map(|(((number, looked), costs), &region)| {
            let mesh = meshes[looked.mesh as usize];
            let corners = mesh.triangles()[looked.index as usize];
            let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize]);
            let area = (b - a).cross(c - a).length();
            Some(Judge {
                facet: adjacency.facet(number)?,
                beyond: [0, 1, 2].map(|side| match looked.is_free[side] {
                    true => of_regions[region as usize],
                    false => costs[side],
                }),
                heights: [b - a, c - b, a - c].map(|side| area / side.length() * (1.0 - 1e-12)),
            })
        });
        Self {
            judges: judges.collect(),
            regions,
        }
    }

    /// The judge of a triangle in the list [`Adjacency::looked`].
    pub(super) fn judge(&self, number: usize) -> Option<&Judge> {
        self.judges.get(number)?.as_ref()
    }
}

/// The largest rim cost of the output edges on a side.
fn side_cost(
    side: [u32; 2],
    positions: &[DVec3],
    edges: &Edges,
    observer: DVec3,
    motion: &Motion,
) -> f64 {
    let key = canonical(side, positions);
    let [a, b] = key.map(|vertex| positions[vertex as usize]);
    let parameters = edges
        .divisions
        .get(&key)
        .map_or(&[][..], |(parameters, _)| parameters);
    let mut from = a - observer;
    let mut largest = 0.0f64;
    for &parameter in parameters.iter().chain([&1.0]) {
        let to = point_between(a, b, parameter) - observer;
        largest = largest.max(rim_cost(motion, from, to));
        from = to;
    }
    largest
}

/// For each triangle the least number of all triangles that free edges connect with it.
fn regions(adjacency: &Adjacency) -> Vec<u32> {
    fn root(of: &mut [u32], mut at: u32) -> u32 {
        while of[at as usize] != at {
            of[at as usize] = of[of[at as usize] as usize];
            at = of[at as usize];
        }
        at
    }
    let mut of: Vec<u32> = (0..adjacency.looked.len() as u32).collect();
    for edge in adjacency.edges.iter().filter(|edge| edge.is_free) {
        if let &[one, other] = &edge.members[..] {
            let (one, other) = (root(&mut of, one.looked), root(&mut of, other.looked));
            of[one.max(other) as usize] = one.min(other);
        }
    }
    (0..of.len() as u32).map(|at| root(&mut of, at)).collect()
}
