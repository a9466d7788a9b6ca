//! The surfaces of a round shape whose resolution follows from the tolerance: triangles with vertices on the exact surface,
//! certified against its photosurface.

use std::borrow::Cow;

use glam::DAffine3;

use super::certifying::of_curved;
use super::limits::{Aim, MIN_GAP_SHARE, StepTolerance, bounds};
use super::making::Surface;
use super::mapped_mesh::MappedMesh;
use super::placed_object::{PlacedObject, Shaped};
use super::plan::Plan;
use super::predicting::Predicted;
use super::shared_mesh::SharedMesh;
use crate::material::Part;
use crate::mesh::Mesh;
use crate::tessellate::{
    Allowed, Counts, Sight, Triangulated, needed, triangulate, triangulate_within,
};

/// Carries out the plan of a round shape, with the mesh of others if that is good enough; `None` if facets are better, as not
/// every triangle could be proven.
pub(super) fn make_curved<'a>(plan: &Plan<'a>, shared: Option<&SharedMesh>) -> Option<Surface<'a>> {
    let shaped = plan.placed_object.curved()?;
    let (name, placed) = &plan.placed_object.parts[0];
    let sight = sight_of(plan, shaped, Aim::Scene);
    let most = plan.max_triangles(plan.granted);
    let fits = |made: &Triangulated| made.mesh.triangle_count() as u64 <= most;
    let shared = shared.and_then(|shared| shared.seen_by(&sight));
    let made = match shared.filter(fits) {
        Some(made) => made,
        None => {
            let sights = std::slice::from_ref(&sight);
            made_for(
                std::slice::from_ref(plan),
                shaped,
                sights,
                most.min(plan.worth()),
            )?
        }
    };
    let itself = plan.itself.and_then(|itself| itself.shaped.as_ref());
    let at_rest = itself.map(|itself| itself.part_of(made.mesh.clone(), placed).mesh().clone());
    let part = shaped.part_of(made.mesh, placed);
    let seen = MappedMesh::new(plan.view(), part.mesh());
    let around = plan.tolerance.box_around([&seen]);
    let counts = counts_of(shaped, &plan.tolerance, &seen);
    let certificate = of_curved(
        &plan.tolerance,
        part.mesh(),
        &seen,
        around,
        &made.bounds[0],
        counts,
    );
    Some(Surface {
        name: name.clone(),
        part: Cow::Owned(part),
        at_rest,
        seen,
        around: around.unwrap_or_default(),
        certificate,
    })
}

/// A mesh for the plan of a round shape with a tolerance that is smaller by this factor, for others to share; `None` if it is
/// not planned as an exact surface, or not every triangle could be proven.
pub(super) fn shared_mesh(plan: &Plan<'_>, tightened: f64) -> Option<SharedMesh> {
    plan.as_curved?;
    let shaped = plan.placed_object.curved()?;
    let sight = sight_of(plan, shaped, Aim::Scene).loosened(tightened);
    SharedMesh::new(&shaped.shape, sight, plan.tolerance.about())
}

/// Carries out the plans of a round shape for all steps with one mesh at rest; its surfaces at all steps, `None` if not
/// every triangle could be proven.
pub(super) fn make_curved_together<'a>(
    placed_object: &PlacedObject,
    plans: &mut [Plan<'a>],
) -> Option<Vec<Surface<'a>>> {
    let shaped = placed_object.curved()?;
    let (name, placed) = &placed_object.parts[0];
    let most = placed_object
        .source_triangles
        .saturating_add(placed_object.granted_together());
    // The offset of all steps in a file is known only with the mesh: with it the bounds of rounding change little.
    let shown = |plans: &[Plan<'a>], part: &Part| -> Vec<(Part, MappedMesh)> {
        let parts = plans.iter().map(|plan| {
            let stand_in = match plan.shown.rest_to_stand_in() {
                Some(to_stand_in) => part.clone().transformed(&to_stand_in),
                None => part.clone(),
            };
            let seen = MappedMesh::new(plan.view(), stand_in.mesh());
            (stand_in, seen)
        });
        parts.collect()
    };
    let set_box = |plans: &mut [Plan<'a>], all: &[(Part, MappedMesh)]| {
        let around = bounds(all.iter().map(|(_, seen)| seen));
        for plan in plans {
            plan.tolerance.box_of_all_steps = around;
        }
        around
    };
    let before = shown(plans, placed);
    set_box(plans, &before);
    let sights: Vec<Sight> = plans
        .iter()
        .map(|plan| match &plan.placed_object.shaped {
            Some(stand_in) => sight_of(plan, stand_in, Aim::Scene),
            None => sight_of(plan, shaped, Aim::Scene),
        })
        .collect();
    let made = made_for(plans, shaped, &sights, most)?;
    let part = shaped.part_of(made.mesh, placed);
    let after = shown(plans, &part);
    let around = set_box(plans, &after);
    let steps = plans.iter().zip(after).zip(&made.bounds);
    let surfaces = steps.map(|((plan, (stand_in, seen)), bounds)| {
        let counts = counts_of(shaped, &plan.tolerance, &seen);
        Surface {
            name: name.clone(),
            certificate: of_curved(
                &plan.tolerance,
                stand_in.mesh(),
                &seen,
                around,
                bounds,
                counts,
            ),
            around: around.unwrap_or_default(),
            seen,
            part: Cow::Owned(stand_in),
            at_rest: plan.itself.map(|_| part.mesh().clone()),
        }
    });
    Some(surfaces.collect())
}

/// About how many triangles a round shape takes as an exact surface; `None` of any other object.
pub(super) fn predicted_of_curved(plan: &Plan<'_>) -> Option<f64> {
    let shaped = plan.placed_object.curved()?;
    let sight = sight_of(plan, shaped, Aim::Loosened);
    let needed = needed(&shaped.shape, &sight, plan.tolerance.about());
    Some(needed.predicted.max(shaped.shape.coarsest_curved() as f64))
}

/// The prediction for a round shape that is planned as an exact surface.
pub(super) fn predict_curved(plan: &Plan<'_>) -> Option<Predicted> {
    let triangles = plan.as_curved?;
    let shaped = plan.placed_object.curved()?;
    let placed = plan.placed_object.parts[0].1.mesh();
    Some(Predicted {
        triangles,
        before: shaped.shape.coarsest_curved() as f64,
        reachable: is_reachable(
            &plan.tolerance,
            &sight_of(plan, shaped, Aim::Loosened),
            placed,
        ),
    })
}

/// The triangles of a round shape for the sights of these plans, at most `most` of them or those of its coarsest form: within
/// the tolerance of the scene if so many are enough, otherwise within a looser one. `None` if not every triangle could be
/// proven, though nothing limits their number.
fn made_for(
    plans: &[Plan<'_>],
    shaped: &Shaped,
    sights: &[Sight],
    most: u64,
) -> Option<Triangulated> {
    let shape = &shaped.shape;
    let about = plans.first()?.tolerance.about();
    triangulate(shape, sights, about, most).or_else(|| {
        let loosening = plans.iter().map(Plan::loosening).fold(1.0, f64::max);
        let is_limited = plans.iter().any(Plan::is_limited);
        is_limited.then(|| triangulate_within(shape, sights, about, most, loosening))
    })
}

/// How the observer sees the shape, with the distance that rounding leaves of a tolerance.
fn sight_of(plan: &Plan<'_>, shaped: &Shaped, aim: Aim) -> Sight {
    let tolerance = &plan.tolerance;
    let view = plan.view();
    let to_observer = DAffine3::from_translation(-view.observer_rest());
    let allowed = tolerance.allowed_of_curved(
        aim,
        plan.placed_object.parts[0].1.mesh(),
        plan.extremes_as_placed(),
    );
    Sight::new(
        &view.relative_velocity(),
        to_observer * shaped.to_frame(),
        allowed,
    )
}

/// The numbers of triangles, the fewest for the tolerance of the scene.
fn counts_of(shaped: &Shaped, tolerance: &StepTolerance, seen: &MappedMesh) -> Counts {
    let least = tolerance.least_of_round(seen.extremes.nearest);
    let least = least.unwrap_or_default();
    Counts {
        triangles_in: shaped.shape.coarsest_curved(),
        triangles_out: seen.mesh.triangle_count(),
        minimum_triangles: least,
        minimum_with_source: least,
    }
}

/// Whether rounding leaves enough of the tolerance, everywhere.
fn is_reachable(tolerance: &StepTolerance, sight: &Sight, placed: &Mesh) -> bool {
    match sight.allowed {
        Allowed::Length(length) => length > 2.0 * MIN_GAP_SHARE * tolerance.aimed_length,
        Allowed::Share { share, less, least } => {
            share * tolerance.nearest_of_curved(placed) - less > least
        }
    }
}

impl PlacedObject {
    /// The shape, if it is round and has the resolution that a tolerance asks for.
    pub(super) fn curved(&self) -> Option<&Shaped> {
        let shaped = self.shaped.as_ref()?;
        shaped.shape.is_curved().then_some(shaped)
    }
}
