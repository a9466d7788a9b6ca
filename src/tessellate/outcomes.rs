//! Division of all triangles of the meshes of one object, in rounds: what the surface measure cannot prove counts with
//! its gap.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::adjacency::Adjacency;
use super::edge::point_between;
use super::edges::{Edges, canonical, sides};
use super::outline::{Divided, Outline};
use super::pieces::{Corner, Pieces};
use super::rims::Judge;
use super::room::Room;
use super::sky::{Grant, divide};
use super::survey::Survey;
use super::{Allowance, Motion, predicted_pieces};
use crate::mesh::Mesh;

/// After so many rounds everything counts with its gap, so that the last one proves as much as the measure of points.
/// Each round leaves about a third of the unproven triangles of the one before: those of a mesh of thousands of triangles
/// near a fast observer took five to six, but each takes as long as points do.
const MAX_ROUNDS: usize = 3;

/// A divided triangle.
pub(super) struct Outcome {
    /// Indices of the vertices on the boundary, counter-clockwise from the first corner on.
    pub(super) boundary: Vec<u32>,
    pub(super) pieces: Pieces,
    /// The bound as surfaces, as a gap, with what other triangles of the same plane add.
    pub(super) surface: f64,
    /// The boundary's points; empty for points.
    points: Vec<Corner>,
    judge: Option<Judge>,
}

/// The decisions, and the triangles that were divided as they say, in the order of [`Outline::divided`].
pub(super) struct Made {
    pub(super) outline: Outline,
    pub(super) outcomes: Vec<Outcome>,
}

/// Up to so many triangles the measure of surfaces tries that of points too, and keeps what has fewer triangles.
const FEW: usize = 10_000;

impl Made {
    /// How many triangles are made of all that are looked at.
    fn count(&self) -> usize {
        let whole = self.outline.needs.iter().flatten();
        let whole = whole.filter(|need| !need.is_divided).count();
        let pieces = self.outcomes.iter();
        whole
            + pieces
                .map(|outcome| outcome.pieces.triangles.len())
                .sum::<usize>()
    }

    /// The largest bound as surfaces, as a gap.
    fn bound(&self) -> f64 {
        let whole = self.outline.needs.iter().flatten();
        let whole = whole.filter(|need| !need.is_divided);
        let whole = whole.map(|need| need.surface);
        let pieces = self.outcomes.iter().map(|outcome| outcome.surface);
        whole.chain(pieces).fold(0.0, f64::max)
    }
}

/// What is divided, for whom and how finely.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    pub(super) meshes: &'a [&'a Mesh],
    pub(super) found: &'a [Survey],
    /// In the rest frame.
    pub(super) observer: DVec3,
    pub(super) allowance: &'a Allowance,
    /// The observer's motion, for the measure of surfaces.
    pub(super) motion: Option<&'a Motion>,
    /// How many triangles may be made beyond those that there are.
    pub(super) most_more: u64,
}

/// Divides all triangles for which the outline asks.
///
/// What the measure of surfaces makes of few triangles depends on a triangle more here and there: it is compared with what
/// that of points makes.
pub(super) fn make(wanted: Wanted<'_>, adjacency: &mut Adjacency) -> Made {
    let made = rounds(wanted, adjacency);
    if wanted.motion.is_none() || made.count() > FEW {
        return made;
    }
    let all: Vec<usize> = (0..adjacency.looked.len()).collect();
    adjacency.count_with_gaps(&all);
    let plain = rounds(wanted, adjacency);
    let allowed = wanted.allowance.between(&[DVec3::ZERO]);
    let is_as_good = plain.bound() <= allowed.max(made.bound());
    let is_better = plain.count() < made.count() || made.bound() > allowed;
    match is_as_good && is_better {
        true => plain,
        false => made,
    }
}

/// Divides all triangles in one measure.
///
/// In that of surfaces the boundary of a triangle may turn out too coarse for a proof. Then the triangle counts with
/// its gap, and all is decided anew; triangles for which that changes nothing keep their pieces.
fn rounds(wanted: Wanted<'_>, adjacency: &mut Adjacency) -> Made {
    let Wanted {
        meshes,
        found,
        observer,
        allowance,
        motion,
        most_more,
    } = wanted;
    let mut before = HashMap::new();
    let mut rounds = 0;
    if let Some(motion) = motion {
        adjacency.count_with_gaps(&no_thriftier(
            meshes, adjacency, observer, allowance, motion,
        ));
    }
    loop {
        let measure = (allowance, motion);
        let mut outline = Outline::within(meshes, adjacency, observer, measure, most_more);
        let divided = outline.divided(found);
        let mut outcomes = outcomes(meshes, &outline, &divided, observer, motion, &before);
        if motion.is_none() {
            return Made { outline, outcomes };
        }
        spread_cuts(&mut outline, &mut outcomes);
        rounds += 1;
        let mut unproven = unproven(meshes, adjacency, (&outline, &outcomes), observer, rounds);
        if unproven.is_empty() || rounds > MAX_ROUNDS {
            return Made { outline, outcomes };
        }
        if rounds == MAX_ROUNDS {
            unproven = (0..adjacency.looked.len()).collect();
        }
        adjacency.count_with_gaps(&unproven);
        let numbers = divided.into_iter().map(|divided| divided.number);
        before = numbers.zip(outcomes).collect();
    }
}

/// The triangles in the list `looked` of which the measure of surfaces would make no fewer pieces than that of points.
fn no_thriftier(
    meshes: &[&Mesh],
    adjacency: &Adjacency,
    observer: DVec3,
    allowance: &Allowance,
    motion: &Motion,
) -> Vec<usize> {
    let looked = adjacency.looked.par_iter().enumerate();
    let numbers = looked.filter_map(|(number, looked)| {
        let mesh = meshes[looked.mesh as usize];
        let corners = mesh.triangles()[looked.index as usize];
        let offsets = corners.map(|corner| mesh.positions()[corner as usize] - observer);
        let pieces = |motion| predicted_pieces(offsets, allowance, motion);
        (pieces(Some(motion)) >= pieces(None)).then_some(number)
    });
    numbers.collect()
}

/// The divided triangles; those of the round before whose boundary and judge are the same keep their pieces.
fn outcomes(
    meshes: &[&Mesh],
    outline: &Outline,
    divided: &[Divided],
    observer: DVec3,
    motion: Option<&Motion>,
    before: &HashMap<usize, Outcome>,
) -> Vec<Outcome> {
    let weights = divided.iter().map(|divided| divided.need.inside);
    let mut room = Room::new(weights.collect(), outline.more / 2);
    let mut outcomes: Vec<Option<Outcome>> = divided.iter().map(|_| None).collect();
    loop {
        let turn = room.turn();
        if turn.is_empty() {
            break;
        }
        let is_last = room.is_last_turn();
        let made: Vec<Outcome> = turn
            .par_iter()
            .map(|&(turned, granted)| {
                let Divided {
                    mesh,
                    index,
                    need,
                    number,
                } = divided[turned];
                let corners = meshes[mesh].triangles()[index as usize];
                let (positions, edges) = (meshes[mesh].positions(), &outline.edges[mesh]);
                let (boundary, points) = boundary(corners, positions, observer, edges);
                let judge = outline.rims.judge(number);
                let kept = before.get(&number).filter(|before| {
                    before.judge.as_ref() == judge
                        && before.points == points
                        && before.pieces.complete
                        && before.pieces.inside.len() <= granted
                });
                let pieces = match kept {
                    Some(before) => before.pieces.clone(),
                    None => divide(
                        corners.map(|corner| positions[corner as usize]),
                        observer,
                        &points,
                        (&outline.allowance, judge),
                        need.max_points(points.len()),
                        Grant { granted, is_last },
                    ),
                };
                Outcome {
                    boundary,
                    surface: pieces.surface.min(pieces.gap),
                    pieces,
                    points: match motion {
                        Some(_) => points,
                        None => vec![],
                    },
                    judge: judge.copied(),
                }
            })
            .collect();
        for ((turned, _), outcome) in turn.into_iter().zip(made) {
            room.used(turned, outcome.pieces.inside.len(), outcome.pieces.is_short);
            outcomes[turned] = Some(outcome);
        }
    }
    outcomes.into_iter().flatten().collect()
}

/// Adds to the bounds of the surface measure what it costs that rays must not pass some output triangles of the same
/// plane.
fn spread_cuts(outline: &mut Outline, outcomes: &mut [Outcome]) {
    let regions = &outline.rims.regions;
    let mut of_regions = vec![0.0f64; regions.len()];
    let mut of_divided = outcomes.iter();
    for (need, &region) in outline.needs.iter().flatten().zip(regions) {
        let cut = match need.is_divided {
            true => of_divided.next().map_or(0.0, |outcome| outcome.pieces.cut),
            false => need.cut,
        };
        let of_region = &mut of_regions[region as usize];
        *of_region = of_region.max(cut);
    }
    let mut of_divided = outcomes.iter_mut();
    for (need, &region) in outline.needs.iter_mut().flatten().zip(regions) {
        let cut = of_regions[region as usize];
        need.surface = (need.surface + cut).min(need.gap);
        if need.is_divided
            && let Some(outcome) = of_divided.next()
        {
            outcome.surface = (outcome.pieces.surface + cut).min(outcome.pieces.gap);
        }
    }
}

/// The triangles in the list `looked` that should count with their gaps because some bound is too large: those which no
/// ray may pass, if the piece of a plane has any, else those whose own bound it is; after the first of the `rounds` all of
/// that piece and what shares an edge with it.
fn unproven(
    meshes: &[&Mesh],
    adjacency: &Adjacency,
    (outline, outcomes): (&Outline, &[Outcome]),
    observer: DVec3,
    rounds: usize,
) -> Vec<usize> {
    let regions = &outline.rims.regions;
    let mut of_divided = outcomes.iter();
    // For each triangle whether its bound is too large, and what it costs that no ray may pass it.
    let all = outline.needs.iter().flatten().zip(&adjacency.looked);
    let all = all.enumerate().map(|(number, (need, looked))| {
        let (surface, cut, is_short) = match need.is_divided {
            true => of_divided.next().map_or((0.0, 0.0, true), |outcome| {
                let pieces = &outcome.pieces;
                (outcome.surface, pieces.cut, pieces.is_short)
            }),
            false => (need.surface, need.cut, false),
        };
        let mesh = meshes[looked.mesh as usize];
        let corners = mesh.triangles()[looked.index as usize];
        let offsets = corners.map(|corner| mesh.positions()[corner as usize] - observer);
        let is_too_large = surface > outline.allowance.between(&offsets);
        let is_judged = outline.rims.judge(number).is_some();
        (is_too_large && is_judged && !is_short, cut)
    });
    let all: Vec<(bool, f64)> = all.collect();
    let mut fails = vec![false; regions.len()];
    let mut is_cut = vec![false; regions.len()];
    for (&(is_too_large, cut), &region) in all.iter().zip(regions) {
        fails[region as usize] |= is_too_large;
        is_cut[region as usize] |= cut > 0.0;
    }
    let causes = all.iter().zip(regions);
    let mut causes: Vec<bool> = causes
        .map(|(&(is_too_large, cut), &region)| {
            let region = region as usize;
            fails[region] && (rounds > 1 || is_too_large && !is_cut[region] || cut > 0.0)
        })
        .collect();
    if rounds > 1 {
        let before = causes.clone();
        for edge in &adjacency.edges {
            let mut members = edge.members.iter();
            if members.any(|member| before[member.looked as usize]) {
                for member in &edge.members {
                    causes[member.looked as usize] = true;
                }
            }
        }
    }
    let judged = |&number: &usize| causes[number] && outline.rims.judge(number).is_some();
    (0..causes.len()).filter(judged).collect()
}

/// The boundary of a triangle, counter-clockwise from the first corner on: the vertices' indices, and the vertices as
/// [`Corner`]s.
fn boundary(
    corners: [u32; 3],
    positions: &[DVec3],
    observer: DVec3,
    edges: &Edges,
) -> (Vec<u32>, Vec<Corner>) {
    let corner_positions = corners.map(|corner| positions[corner as usize]);
    let mut boundary = vec![];
    let mut points = vec![];
    for (number, side) in sides(corners).into_iter().enumerate() {
        let (from, to) = (number, (number + 1) % 3);
        let at = |weights: DVec3, position: DVec3, sides: u8| Corner {
            weights,
            offset: position - observer,
            sides,
        };
        let unit =
            |corner: usize| DVec3::from_array([0, 1, 2].map(|i| f64::from(u8::from(i == corner))));
        boundary.push(side[0]);
        points.push(at(
            unit(from),
            corner_positions[from],
            1 << number | 1 << ((number + 2) % 3),
        ));
        let key = canonical(side, positions);
        let Some((parameters, first)) = edges.divisions.get(&key) else {
            continue;
        };
        let [p, q] = key.map(|vertex| positions[vertex as usize]);
        let forward = key == side;
        let mut order: Vec<usize> = (0..parameters.len()).collect();
        if !forward {
            order.reverse();
        }
        for index in order {
            let parameter = parameters[index];
            let from_weight = if forward { 1.0 - parameter } else { parameter };
            let weights = unit(from) * from_weight + unit(to) * (1.0 - from_weight);
            boundary.push(first + index as u32);
            points.push(at(weights, point_between(p, q, parameter), 1 << number));
        }
    }
    (boundary, points)
}
