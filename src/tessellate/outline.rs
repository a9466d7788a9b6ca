//! What is decided before any triangle is looked into: how loose the aim has to be, which edges are divided, and what
//! each triangle needs.

use glam::DVec3;
use rayon::prelude::*;

use super::edges::{Count, Edges, canonical, divided_edges, sides};
use super::minimum::pieces_inside;
use super::survey::Survey;
use super::{Allowance, minimum_triangles, triangle_gap};
use crate::mesh::Mesh;

/// A single triangle is never given more points than this many times what theory asks for, and a few.
const MAX_TIMES_MINIMUM: f64 = 16.0;

/// More points than this inside one triangle are a tolerance that cannot be meant: behind a fast observer the fewest
/// triangles that theory allows go with `gamma`.
const MAX_POINTS: f64 = 4_194_304.0;

/// Where a limit leaves too little for what is allowed, so many times as much is; then twice that factor, and so on.
const LOOSER: f64 = 4.0;

/// Where that has gone so far, edges stay whole.
const LOOSEST: f64 = 1e300;

/// Then it goes back by halves of its logarithm, until so much of the limit is used, or so many times.
const USED: f64 = 0.7;
const MAX_HALVINGS: usize = 8;

/// What is decided before any triangle is looked into.
pub(super) struct Outline {
    /// What is aimed at: so many times what is allowed.
    pub(super) looser: f64,
    pub(super) allowance: Allowance,
    /// Of each mesh.
    pub(super) edges: Vec<Edges>,
    /// Of each of the triangles of each mesh that were looked at.
    pub(super) needs: Vec<Vec<Need>>,
    /// How many triangles more there may be inside.
    pub(super) more: u64,
    /// How many more are predicted inside.
    inside: f64,
}

impl Outline {
    /// With the allowance, or one so much larger that edges and what is predicted inside are within the limit, and hardly
    /// larger than that takes.
    pub(super) fn within(
        meshes: &[&Mesh],
        found: &[Survey],
        observer: DVec3,
        allowance: &Allowance,
        most_more: u64,
    ) -> Self {
        let aiming = |looser| Self::aiming(looser, meshes, found, observer, allowance, most_more);
        let (mut too_tight, mut looser, mut step) = (1.0, 1.0, LOOSER);
        let mut outline = loop {
            if let Some(outline) = aiming(looser) {
                break outline;
            }
            too_tight = looser;
            looser = (looser * step).min(f64::MAX);
            step *= 2.0;
        };
        for _ in 0..MAX_HALVINGS {
            if outline.looser == 1.0 || outline.used(most_more) >= USED * most_more as f64 {
                break;
            }
            // The roots first: the product might overflow.
            let between = too_tight.sqrt() * outline.looser.sqrt();
            match aiming(between) {
                Some(tighter) => outline = tighter,
                None => too_tight = between,
            }
        }
        outline
    }

    /// With so many times the allowance; `None` where that is beyond the limit.
    fn aiming(
        looser: f64,
        meshes: &[&Mesh],
        found: &[Survey],
        observer: DVec3,
        allowance: &Allowance,
        most_more: u64,
    ) -> Option<Self> {
        let aimed = match looser {
            1.0 => *allowance,
            _ if looser > LOOSEST => Allowance::Everywhere(f64::INFINITY),
            _ => allowance.times(looser),
        };
        let more = Count::up_to(most_more);
        let edges: Option<Vec<Edges>> = meshes
            .par_iter()
            .zip(found)
            .map(|(mesh, found)| divided_edges(mesh, &found.above, observer, &aimed, &more))
            .collect();
        let edges = edges?;
        let needs = meshes.par_iter().zip(found).zip(&edges);
        let needs: Vec<Vec<Need>> = needs
            .map(|((mesh, found), edges)| {
                let corners = found
                    .above
                    .par_iter()
                    .map(|&index| mesh.triangles()[index as usize]);
                let need = |corners| Need::of(corners, mesh.positions(), observer, edges, &aimed);
                corners.map(need).collect()
            })
            .collect();
        let inside = needs.iter().flatten().map(|need| need.inside).sum::<f64>();
        let is_within = inside <= more.left() as f64 || looser > LOOSEST;
        is_within.then(|| Self {
            looser,
            allowance: aimed,
            edges,
            needs,
            more: more.left(),
            inside,
        })
    }

    /// How many triangles more are predicted, on edges and inside.
    fn used(&self, most_more: u64) -> f64 {
        (most_more - self.more) as f64 + self.inside
    }

    /// The triangles of all meshes that have to be divided, in their order.
    pub(super) fn divided(&self, found: &[Survey]) -> Vec<Divided> {
        let meshes = self.needs.iter().zip(found).enumerate();
        meshes
            .flat_map(|(mesh, (needs, found))| {
                let looked_at = needs.iter().zip(&found.above);
                let divided = looked_at.filter(|(need, _)| need.is_divided);
                divided.map(move |(&need, &index)| Divided { mesh, index, need })
            })
            .collect()
    }
}

/// A triangle that has to be divided.
#[derive(Clone, Copy)]
pub(super) struct Divided {
    pub(super) mesh: usize,
    pub(super) index: u32,
    pub(super) need: Need,
}

/// What a triangle needs.
#[derive(Clone, Copy)]
pub(super) struct Need {
    /// Whether it has to be divided at all.
    pub(super) is_divided: bool,
    /// Its gap as it is.
    pub(super) gap: f64,
    /// The fewest triangles by theory.
    minimum: f64,
    /// About how many triangles more there will be of points inside.
    pub(super) inside: f64,
}

impl Need {
    fn of(
        corners: [u32; 3],
        positions: &[DVec3],
        observer: DVec3,
        edges: &Edges,
        allowance: &Allowance,
    ) -> Self {
        let offsets = corners.map(|corner| positions[corner as usize] - observer);
        let [a, b, c] = offsets;
        let gap = triangle_gap(a, b, c);
        let fits = gap <= allowance.between(&offsets);
        let is_cut = |side: [u32; 2]| edges.divisions.contains_key(&canonical(side, positions));
        let is_divided = !fits || sides(corners).into_iter().any(is_cut);
        let minimum = match is_divided {
            true => minimum_triangles(offsets, allowance),
            false => 0.0,
        };
        let inside = match fits {
            true => 0.0,
            false => pieces_inside(offsets, minimum, allowance),
        };
        Self {
            is_divided,
            gap,
            minimum,
            inside,
        }
    }

    /// Of points inside that are spent on it, even without any limit.
    pub(super) fn max_points(&self, boundary: usize) -> usize {
        let most = MAX_TIMES_MINIMUM * (self.minimum + boundary as f64) + 64.0;
        most.min(MAX_POINTS) as usize
    }
}
