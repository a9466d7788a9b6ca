//! What an object will take, known in a fraction of the time.

use glam::DVec3;
use rayon::prelude::*;

use super::{FACETS_MADE_TO_PREDICT, MIN_FOR_GAP, Plan, shrunk};
use crate::material::Part;
use crate::pipeline::SurfaceOptions;
use crate::pipeline::mapped_mesh::MappedMesh;
use crate::pipeline::placed_object::spread;
use crate::scene::Unit;
use crate::shape::Shape;
use crate::tessellate::{local_stretch, predicted_pieces};

/// What an object will take, and whether its tolerance can be kept at all.
#[derive(Clone, Copy, Debug)]
pub(in crate::pipeline) struct Predicted {
    pub(in crate::pipeline) triangles: f64,
    /// Of those, how many there are before any refinement.
    pub(in crate::pipeline) before: f64,
    pub(in crate::pipeline) reachable: bool,
}

impl Plan<'_> {
    /// About how many triangles the object will have, and whether they will be within the tolerance.
    ///
    /// Of a finer round shape than is at hand each facet stands for several, smaller ones.
    ///
    /// `weights` says for each part of how many triangles each of its own is a sample.
    pub(in crate::pipeline) fn predict(
        mut self,
        wanted: SurfaceOptions,
        weights: &[f64],
    ) -> Predicted {
        let velocity = self.view.relative_velocity();
        let facets = self.shape.as_ref().map_or(0, Shape::triangle_count);
        let (draft, each) = if facets > FACETS_MADE_TO_PREDICT {
            let at_hand = self.placed_object.parts[0].1.mesh().triangles().len();
            let each = facets as f64 / at_hand as f64;
            (self.draft_as_placed(each), each)
        } else {
            (self.draft(), 1.0)
        };
        let observer = self.view.observer_rest();
        let facets = draft
            .parts
            .iter()
            .zip(weights)
            .flat_map(|((_, part), weight)| {
                let mesh = part.mesh();
                mesh.triangles().iter().map(move |corners| {
                    let positions = corners.map(|corner| mesh.positions()[corner as usize]);
                    let offsets = shrunk(positions, each).map(|position| position - observer);
                    (weight * each, offsets)
                })
            });
        let facets: Vec<(f64, [DVec3; 3])> = facets.collect();
        let before = facets.iter().map(|(weight, _)| weight).sum();
        if !wanted.subdivide || velocity.rapidity() == 0.0 {
            let around = self.around(&draft.seen);
            let prove = |((_, part), seen): (&(String, Part), &MappedMesh)| {
                self.certificate_of_unrefined(&draft.limits, part.mesh(), seen, around)
            };
            return Predicted {
                triangles: before,
                before,
                reachable: (draft.parts.iter().zip(&draft.seen).map(prove)).all(|c| c.complete),
            };
        }
        let looked_at = match &self.placed_object.shaped {
            Some(_) => facets.len().min(FACETS_MADE_TO_PREDICT as usize),
            None => facets.len(),
        };
        let each = facets.len() as f64 / looked_at.max(1) as f64;
        let pieces = spread(facets.len(), looked_at).map(|index| {
            let (weight, offsets) = facets[index];
            weight * each * predicted_pieces(offsets, &draft.limits.allowance)
        });
        let reachable = match (self.aimed.unit(), self.aimed.number()) {
            (Unit::Degrees, degrees) => {
                let least = (1.0 - MIN_FOR_GAP) * degrees.to_radians().sin();
                facets.par_iter().all(|(_, offsets)| {
                    let nearest = self.nearest(*offsets);
                    let stretch = || local_stretch(&self.view, offsets.map(|o| o + observer));
                    let taken = match self.deviation {
                        0.0 => draft.limits.rounding,
                        deviation => draft.limits.rounding + deviation * stretch(),
                    };
                    !draft.limits.allowance.is_at_its_least(&[nearest])
                        && taken <= least * self.view.seen_distance(nearest)
                })
            }
            _ => draft.limits.left >= MIN_FOR_GAP * self.aimed_length,
        };
        Predicted {
            // Added up in their order: the same sum for any number of threads.
            triangles: pieces.collect::<Vec<f64>>().iter().sum(),
            before,
            reachable,
        }
    }
}
