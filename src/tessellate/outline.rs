//! The decisions before any triangle is divided: how much the allowance is loosened, which edges are divided, and what
//! each triangle needs.

use glam::DVec3;
use rayon::prelude::*;

use super::adjacency::{Adjacency, Looked};
use super::along::{PlanePoint, gap_along};
use super::chart::Plane;
use super::count::Count;
use super::edges::{Edges, canonical, divided_edges, sides};
use super::predicted::{of_points, pieces_inside};
use super::rims::{Judge, Rims};
use super::survey::Survey;
use super::{Allowance, Motion, minimum_triangles};
use crate::mesh::Mesh;

/// Limit on the points inside one triangle, in units of the number of triangles that theory asks for (a few more are
/// allowed).
const MAX_TIMES_MINIMUM: f64 = 16.0;

/// Absolute limit on the points inside one triangle: a tolerance that needs more cannot be intended. Behind a fast
/// observer the fewest triangles that theory allows are proportional to `gamma`.
const MAX_POINTS: f64 = 4_194_304.0;

/// If the limit on triangles is too small for the allowance, the allowance is multiplied by this factor; if that does
/// not suffice, by a factor twice as large, and so on.
const LOOSER: f64 = 4.0;

/// Beyond this factor edges are not divided at all.
const LOOSEST: f64 = 1e300;

/// After that the factor shrinks again by halving of its logarithm, until this fraction of the limit is used, or for at
/// most `MAX_HALVINGS` times.
const USED: f64 = 0.7;
const MAX_HALVINGS: usize = 8;

/// The decisions before any triangle is divided.
pub(super) struct Outline {
    /// The factor by which the caller's allowance was multiplied; 1 if the limit leaves enough.
    pub(super) looser: f64,
    pub(super) allowance: Allowance,
    /// The divided edges of each mesh.
    pub(super) edges: Vec<Edges>,
    /// For each mesh the needs of the triangles in its survey's list `above`.
    pub(super) needs: Vec<Vec<Need>>,
    pub(super) rims: Rims,
    /// How many additional triangles the points inside may make.
    pub(super) more: u64,
    /// How many additional triangles are predicted from points inside.
    inside: f64,
}

impl Outline {
    /// The outline for the allowance, or for a larger one with which the divided edges and the predicted points inside
    /// make at most `most_more` additional triangles. The allowance is hardly larger than necessary.
    pub(super) fn within(
        meshes: &[&Mesh],
        adjacency: &Adjacency,
        observer: DVec3,
        (allowance, motion): (&Allowance, Option<&Motion>),
        most_more: u64,
    ) -> Self {
        let measure = (allowance, motion);
        let aiming = |looser| Self::aiming(looser, meshes, adjacency, observer, measure, most_more);
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
            // The roots are taken first, because the product might overflow.
            let between = too_tight.sqrt() * outline.looser.sqrt();
            match aiming(between) {
                Some(tighter) => outline = tighter,
                None => too_tight = between,
            }
        }
        outline
    }

    /// The outline for the allowance multiplied by `looser`; `None` if it exceeds the limit.
    fn aiming(
        looser: f64,
        meshes: &[&Mesh],
        adjacency: &Adjacency,
        observer: DVec3,
        (allowance, motion): (&Allowance, Option<&Motion>),
        most_more: u64,
    ) -> Option<Self> {
        let aimed = match looser {
            1.0 => *allowance,
            _ if looser > LOOSEST => Allowance::Everywhere(f64::INFINITY),
            _ => allowance.times(looser),
        };
        let more = Count::up_to(most_more);
        let edges = divided_edges(meshes, adjacency, observer, &aimed, motion, &more)?;
        let rims = Rims::new(meshes, adjacency, &edges, observer, motion);
        let all = adjacency.looked.par_iter().enumerate();
        let all: Vec<Need> = all
            .map(|(number, looked)| {
                let mesh = meshes[looked.mesh as usize];
                let edges = &edges[looked.mesh as usize];
                Need::of(
                    looked,
                    mesh,
                    observer,
                    edges,
                    (&aimed, motion),
                    rims.judge(number),
                )
            })
            .collect();
        let needs = adjacency.firsts.windows(2);
        let needs: Vec<Vec<Need>> = needs.map(|ends| all[ends[0]..ends[1]].to_vec()).collect();
        let inside = needs.iter().flatten().map(|need| need.inside).sum::<f64>();
        let is_within = inside <= more.left() as f64 || looser > LOOSEST;
        is_within.then(|| Self {
            looser,
            allowance: aimed,
            edges,
            needs,
            rims,
            more: more.left(),
            inside,
        })
    }

    /// How many additional triangles are predicted, from points on edges and inside.
    fn used(&self, most_more: u64) -> f64 {
        (most_more - self.more) as f64 + self.inside
    }

    /// The triangles of all meshes that have to be divided, in the order of the meshes and of their triangles.
    pub(super) fn divided(&self, found: &[Survey]) -> Vec<Divided> {
        let meshes = self.needs.iter().zip(found).enumerate();
        let all = meshes.flat_map(|(mesh, (needs, found))| {
            let looked_at = needs.iter().zip(&found.above);
            looked_at.map(move |(&need, &index)| (mesh, index, need))
        });
        let divided = all.enumerate().filter_map(|(number, (mesh, index, need))| {
            need.is_divided.then_some(Divided {
                mesh,
                index,
                need,
                number,
            })
        });
        divided.collect()
    }
}

/// A triangle that has to be divided.
#[derive(Clone, Copy)]
pub(super) struct Divided {
    pub(super) mesh: usize,
    pub(super) index: u32,
    pub(super) need: Need,
    /// Its number in the list [`Adjacency::looked`].
    pub(super) number: usize,
}

/// The needs of one triangle of the survey's list `above`.
#[derive(Clone, Copy)]
pub(super) struct Need {
    /// Whether the triangle has to be divided at all.
    pub(super) is_divided: bool,
    /// The gap of the undivided triangle, in the rest frame.
    pub(super) gap: f64,
    /// The same as surfaces, as a gap.
    pub(super) surface: f64,
    /// What it costs that no ray must pass the undivided triangle, as a gap; zero if rays may pass it.
    pub(super) cut: f64,
    /// The fewest triangles that theory allows for it.
    minimum: f64,
    /// About how many additional triangles the points inside will make.
    pub(super) inside: f64,
}

impl Need {
    fn of(
        looked: &Looked,
        mesh: &Mesh,
        observer: DVec3,
        edges: &Edges,
        (allowance, motion): (&Allowance, Option<&Motion>),
        judge: Option<&Judge>,
    ) -> Self {
        let (positions, corners) = (mesh.positions(), mesh.triangles()[looked.index as usize]);
        let offsets = corners.map(|corner| positions[corner as usize] - observer);
        let gap = looked.gap;
        let allowed = allowance.between(&offsets);
        let (mut surface, mut cut) = (gap, 0.0);
        if let Some(judge) = judge {
            let bound = Plane::new(offsets).map_or(f64::INFINITY, |plane| {
                let points = offsets.map(|offset| PlanePoint::new(&plane, offset));
                let [a, b, c] = &points;
                let along = gap_along(&plane, [a, b, c]);
                judge.bound(&along, [a, b, c], [DVec3::X, DVec3::Y, DVec3::Z])
            });
            surface = gap.min(bound);
            if bound == f64::INFINITY {
                cut = judge.cut(offsets);
            }
        }
        let fits = surface <= allowed;
        let is_cut = |side: [u32; 2]| edges.divisions.contains_key(&canonical(side, positions));
        let is_divided = !fits || sides(corners).into_iter().any(is_cut);
        let minimum = match is_divided {
            true => minimum_triangles(offsets, allowance, None),
            false => 0.0,
        };
        let inside = match fits {
            true => 0.0,
            false => {
                pieces_inside(offsets, minimum, allowance)
                    * of_points(offsets, minimum, allowance, motion)
            }
        };
        // Where surfaces cannot be proven with about so many points, points do not help at all.
        let minimum = match (judge, motion) {
            (Some(_), Some(_)) if is_divided => minimum_triangles(offsets, allowance, motion),
            _ => minimum,
        };
        Self {
            is_divided,
            gap,
            surface,
            cut,
            minimum,
            inside,
        }
    }

    /// Limit on the points inside the triangle if the number of all triangles is not limited; `boundary` is the number
    /// of points on its boundary.
    pub(super) fn max_points(&self, boundary: usize) -> usize {
        let most = MAX_TIMES_MINIMUM * (self.minimum + boundary as f64) + 64.0;
        most.min(MAX_POINTS) as usize
    }
}
