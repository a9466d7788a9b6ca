//! The number of triangles that an object will take, known in a fraction of the time.

use glam::DVec3;
use rayon::prelude::*;

use super::SurfaceOptions;
use super::certifying::{Measured, certificate};
use super::curved::predict_curved;
use super::limits::{Limits, MIN_GAP_SHARE, StepTolerance, shrunk};
use super::mapped_mesh::MappedMesh;
use super::placed_object::spread;
use super::plan::{Draft, Plan};
use crate::material::Part;
use crate::scene::Unit;
use crate::shape::Shape;
use crate::tessellate::{local_stretch, predicted_pieces};

/// The number of facets up to which a round shape is made to predict its refinement, and up to which its facets are all
/// looked at.
const MAX_FACETS_MADE: u64 = 20_000;

/// The predicted triangles of an object, and whether its tolerance can be kept at all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predicted {
    /// The number of triangles of its photosurface.
    pub(super) triangles: f64,
    /// The number of triangles before any refinement, part of the former.
    pub(super) before: f64,
    /// True where so many triangles will be within the tolerance.
    pub(super) reachable: bool,
}

/// A facet, or a sample of several: how many it stands for, and the offsets of its corners from the observer in the rest
/// frame.
type Facet = (f64, [DVec3; 3]);

/// Predicts the number of triangles of an object at one step, and whether they will be within the tolerance.
///
/// A shape with more facets than [`MAX_FACETS_MADE`] is not made: each facet of the shape as placed stands for several,
/// smaller ones.
///
/// `weights` holds for each part the number of triangles that each of its own is a sample of.
pub(super) fn predict(mut plan: Plan<'_>, wanted: SurfaceOptions, weights: &[f64]) -> Predicted {
    if let Some(predicted) = predict_curved(&plan) {
        return predicted;
    }
    let facets = plan.shape.as_ref().map_or(0, Shape::triangle_count);
    let (draft, each) = if facets > MAX_FACETS_MADE {
        let as_placed = plan.placed_object.parts[0].1.mesh().triangles().len();
        let each = facets as f64 / as_placed as f64;
        (plan.draft_as_placed(each), each)
    } else {
        (plan.draft(), 1.0)
    };
    let facets = facets_of(&draft, plan.view().observer_rest(), weights, each);
    let before = facets.iter().map(|(weight, _)| weight).sum();
    if !plan.refines(wanted) {
        return Predicted {
            triangles: before,
            before,
            reachable: is_complete(&plan.tolerance, &draft),
        };
    }
    let looked_at = match &plan.placed_object.shaped {
        Some(_) => facets.len().min(MAX_FACETS_MADE as usize),
        None => facets.len(),
    };
    let each = facets.len() as f64 / looked_at.max(1) as f64;
    let motion = plan.tolerance.motion();
    let pieces = spread(facets.len(), looked_at).map(|index| {
        let (weight, offsets) = facets[index];
        let pieces = |motion| predicted_pieces(offsets, &draft.limits.allowance, motion);
        // As surfaces, triangles count as points where that makes fewer.
        let of_surfaces = motion
            .as_ref()
            .map_or(f64::INFINITY, |motion| pieces(Some(motion)));
        weight * each * of_surfaces.min(pieces(None))
    });
    Predicted {
        // Added up in their order: the same sum for any number of threads.
        triangles: pieces.collect::<Vec<f64>>().iter().sum(),
        before,
        reachable: is_reachable(&plan.tolerance, &draft.limits, &facets),
    }
}

/// The facets of all parts, each shrunk to one of the `each` smaller ones that it stands for.
fn facets_of(draft: &Draft<'_>, observer: DVec3, weights: &[f64], each: f64) -> Vec<Facet> {
    let parts = draft.parts.iter().zip(weights);
    let facets = parts.flat_map(|((_, part), weight)| {
        let mesh = part.mesh();
        let (places, triangles) = mesh.facets();
        triangles.iter().map(move |corners| {
            let positions = corners.map(|corner| places.at(corner));
            let offsets = shrunk(positions, each).map(|position| position - observer);
            (weight * each, offsets)
        })
    });
    facets.collect()
}

/// True where the parts are within the tolerance of the scene as they were drafted.
fn is_complete(tolerance: &StepTolerance, draft: &Draft<'_>) -> bool {
    let limits = &draft.limits;
    let around = tolerance.box_around(&draft.seen);
    let complete = |((_, part), seen): (&(String, Part), &MappedMesh)| {
        let mesh = part.mesh();
        let measured = Measured::of_unrefined(tolerance, limits, mesh);
        certificate(tolerance, limits, mesh, seen, around, measured).complete
    };
    draft.parts.iter().zip(&draft.seen).all(complete)
}

/// True where curvature and rounding leave the gap at least [`MIN_GAP_SHARE`] of the tolerance aimed at: as a length for
/// the whole object, as an angle at every facet.
fn is_reachable(tolerance: &StepTolerance, limits: &Limits, facets: &[Facet]) -> bool {
    let view = &tolerance.view;
    match (tolerance.aimed.unit(), tolerance.aimed.number()) {
        (Unit::Degrees, degrees) => {
            let max_share = (1.0 - MIN_GAP_SHARE) * degrees.to_radians().sin();
            facets.par_iter().all(|(_, offsets)| {
                let nearest = tolerance.nearest(*offsets);
                let stretch = || local_stretch(view, offsets.map(|o| o + view.observer_rest()));
                let taken = match tolerance.deviation {
                    0.0 => limits.rounding,
                    deviation => limits.rounding + deviation * stretch(),
                };
                !limits.allowance.is_at_its_least(&[nearest])
                    && taken <= max_share * view.seen_distance(nearest)
            })
        }
        _ => limits.left >= MIN_GAP_SHARE * tolerance.aimed_length,
    }
}
