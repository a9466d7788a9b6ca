//! The bounds of the triangles of a net: what is proven of each, for each sight.

use std::collections::HashMap;

use rayon::prelude::*;

use super::bent::Arc;
use super::net::Net;
use super::proof::Proof;
use super::sight::{About, Sight};
use crate::shape::{Piece, Spot};
use crate::tessellate::count::Count;

/// Room for the rounding of a bound.
const UP: f64 = 1.0 + 1e-9;

/// The bounds of each triangle, one for each sight: lengths in the observer's frame.
pub(super) type BoundsOf = HashMap<usize, Vec<f64>>;

/// The bounds of these triangles; `None` if their proofs take more looks at places than may still be counted.
pub(super) fn proven(net: &Net<'_>, triangles: &[usize], looks: &Count) -> Option<BoundsOf> {
    bounds_of(net, triangles, |triangle, number, sight| {
        let (bound, taken) = bound_of(net, triangle, number, sight);
        looks.add(taken).then_some(bound)
    })
}

/// Bounds on the distance of places with the same weights, whatever the task is about.
pub(super) fn points_of(net: &Net<'_>) -> BoundsOf {
    let alive = (0..net.triangles.len()).filter(|&t| net.alive[t]);
    match net.task.about {
        About::Points => BoundsOf::new(),
        About::Surface => {
            let bound =
                |triangle, number, sight: &Sight| Some(of_points(net, triangle, number, sight));
            bounds_of(net, &alive.collect::<Vec<_>>(), bound).expect("each triangle has a bound")
        }
    }
}

/// The bounds of these triangles, each found by `bound`; `None` if that finds none.
fn bounds_of(
    net: &Net<'_>,
    triangles: &[usize],
    bound: impl Fn(usize, usize, &Sight) -> Option<f64> + Sync,
) -> Option<BoundsOf> {
    let each = triangles.par_iter().map(|&triangle| {
        let sights = net.task.sights.iter().enumerate();
        let bounds = sights.map(|(number, sight)| Some(bound(triangle, number, sight)? * UP));
        Some((triangle, bounds.collect::<Option<_>>()?))
    });
    each.collect()
}

/// A bound on the distance of places with the same weights that is quickly found.
fn of_points(net: &Net<'_>, triangle: usize, number: usize, sight: &Sight) -> f64 {
    let (corners, of) = (net.triangles[triangle], net.of[triangle]);
    let (facet, seen) = (net.facet(corners, of), net.seen_by(number, corners));
    let (rims, beside) = net.arcs(triangle);
    match rims.iter().any(Option::is_some) {
        true => Proof::new(facet, About::Surface, sight, seen, rims).of_rim(beside, f64::INFINITY),
        false => Proof::new(facet, About::Points, sight, seen, rims).of_points(f64::INFINITY),
    }
}

/// A bound within what is allowed, or any number above that; and how many places were looked at for it.
fn bound_of(net: &Net<'_>, triangle: usize, number: usize, sight: &Sight) -> (f64, u64) {
    let (corners, of) = (net.triangles[triangle], net.of[triangle]);
    let seen = net.seen_by(number, corners);
    let limit = sight.allowed(seen) / UP;
    let about = net.task.about;
    let facet = net.facet(corners, of);
    let (rims, beside) = net.arcs(triangle);
    let is_at_rim = rims.iter().any(Option::is_some);
    let mut proof = Proof::new(facet, about, sight, seen, rims);
    let tip = facet.tip().filter(|_| sight.gamma_beta == 0.0);
    let bound = match (about, tip) {
        (About::Surface, Some(tip)) => proof.of_tip_at_rest(tip, limit),
        (About::Surface, None) if is_at_rim => proof.of_rim(beside, limit),
        (About::Surface, None) => {
            let mut normals = net.normals_by(number, corners, of);
            let piece = net.piece_of(triangle);
            let is_pole = |k: &usize| piece.is_pole(&net.vertices[corners[*k] as usize].spot);
            if let Some(pole) = (0..3).find(is_pole) {
                normals[pole] = normals[(pole + 1) % 3];
            }
            proof.of_surface(normals, limit)
        }
        (About::Points, _) => proof.of_points(limit),
    };
    let looks = proof.looks();
    if about == About::Points && is_at_rim && bound <= limit {
        // The arcs of a lid are covered too.
        let mut proof = Proof::new(facet, About::Surface, sight, seen, rims);
        return (
            bound.max(proof.of_rim(beside, limit)),
            looks + proof.looks(),
        );
    }
    (bound, looks)
}

impl Net<'_> {
    /// The largest of the bounds of a triangle, as fractions of what is allowed, and the number of its sight.
    pub(super) fn share(&self, triangle: usize, bounds: &[f64]) -> (usize, f64) {
        let corners = self.triangles[triangle];
        let sights = self.task.sights.iter().enumerate().zip(bounds);
        let shares = sights.map(|((number, sight), &bound)| {
            let share = bound / sight.allowed(self.seen_by(number, corners));
            (number, if share.is_nan() { f64::INFINITY } else { share })
        });
        shares.fold(
            (0, 0.0),
            |worst, share| if share.1 > worst.1 { share } else { worst },
        )
    }

    /// How the sides of a triangle, opposite each corner, follow the arcs of rims, and how far they may be from these.
    fn arcs(&self, triangle: usize) -> ([Option<Arc>; 3], f64) {
        let (corners, rims, piece) = (
            self.triangles[triangle],
            self.rims_of(triangle),
            self.piece_of(triangle),
        );
        let mut farthest: f64 = 0.0;
        let arcs = [0, 1, 2].map(|k| {
            let (from, to) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let Piece::Lid { radius, .. } = *piece else {
                return rims[k].then_some(Arc::OfFacet);
            };
            rims[k].then(|| {
                let parameters = |spot: &Spot| piece.parameters(spot);
                let [a, b] = [from, to].map(|v| parameters(&self.vertices[v as usize].spot));
                let moved = parameters(&self.middle_of_rim(from, to)) - 0.5 * (a + b);
                farthest = farthest.max(moved.length_squared() / (7.0 * radius));
                Arc::Moved(moved)
            })
        });
        (arcs, farthest)
    }
}
