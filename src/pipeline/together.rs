//! One mesh for all steps, within the tolerance at each.

use std::borrow::Cow;

use super::SurfaceOptions;
use super::certifying::{Measured, certificate};
use super::limits::{Limits, bounds};
use super::making::{Surface, refine_parts};
use super::mapped_mesh::MappedMesh;
use super::placed_object::triangle_count;
use super::plan::{Plan, seen_parts};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::tessellate::{Counts, largest_gap, shares, survey};

/// Carries out the plans of one object for all steps with one mesh at rest, which is refined for one step after the
/// other; for each part its surfaces at all steps.
///
/// A mesh within the tolerance at one step stays so when it is refined for another: the gap of a triangle is how far a
/// chord plane is above the convex `r`, and that of a piece of it is below that of the whole.
///
/// Each step may use a share of the `granted` triangles beyond the source that the steps before it have left, in
/// proportion to the triangles granted to it and to the later steps where each has a mesh of its own.
pub(super) fn make_together(
    mut plans: Vec<Plan<'_>>,
    wanted: SurfaceOptions,
    granted: u64,
) -> Vec<Vec<Surface<'_>>> {
    share_finest_shape(&mut plans);
    let Some(first) = plans.first_mut() else {
        return vec![];
    };
    let before: Vec<(String, Part)> = first.draft().parts.into_owned();
    let limits = seen_at_all_steps(&mut plans, &before);
    let limits: Vec<Limits> = limits.into_iter().map(|(_, limits)| limits).collect();
    let parts = refined_for_all(&plans, &before, &limits, wanted, granted);
    let mut seen = seen_at_all_steps(&mut plans, &parts);
    let mut surfaces = vec![];
    for (index, ((name, part), (_, before))) in parts.iter().zip(&before).enumerate() {
        let steps = plans.iter().zip(&mut seen).map(|(plan, (seen, limits))| {
            let (mesh, seen) = (part.mesh(), seen[index].clone());
            let tolerance = &plan.tolerance;
            let observer = tolerance.view.observer_rest();
            let before = before.mesh();
            let minimum = survey(before, observer, f64::INFINITY, &limits.whole);
            let measured = Measured {
                gap: largest_gap(mesh, observer),
                counts: Counts {
                    triangles_in: before.triangles().len(),
                    triangles_out: mesh.triangles().len(),
                    minimum_triangles: minimum.minimum_triangles,
                },
            };
            let around = tolerance.box_of_all_steps;
            Surface {
                name: name.clone(),
                part: Cow::Owned(part.clone()),
                certificate: certificate(tolerance, limits, mesh, &seen, around, measured),
                around: around.unwrap_or_default(),
                seen,
            }
        });
        surfaces.push(steps.collect());
    }
    surfaces
}

/// Gives every step the shape of the step that asks for the largest number of facets.
fn share_finest_shape(plans: &mut [Plan<'_>]) {
    let shapes = plans
        .iter()
        .filter_map(|plan| Some((plan.shape.clone()?, plan.tolerance.deviation)));
    if let Some((shape, deviation)) = shapes.max_by_key(|(shape, _)| shape.triangle_count()) {
        for plan in plans {
            (plan.shape, plan.tolerance.deviation) = (Some(shape.clone()), deviation);
        }
    }
}

/// The parts at rest, refined for one step after the other.
fn refined_for_all(
    plans: &[Plan<'_>],
    before: &[(String, Part)],
    limits: &[Limits],
    wanted: SurfaceOptions,
    granted: u64,
) -> Vec<(String, Part)> {
    let mut parts = before.to_vec();
    for (step, (plan, limits)) in plans.iter().zip(limits).enumerate() {
        if !plan.refines(wanted) {
            continue;
        }
        let source = plan.placed_object.source_triangles;
        let used = triangle_count(&parts).saturating_sub(source);
        let weights: Vec<f64> = plans[step..]
            .iter()
            .map(|plan| plan.granted as f64 + 1.0)
            .collect();
        let share = shares(granted.saturating_sub(used), &weights)[0];
        let meshes: Vec<&Mesh> = parts.iter().map(|(_, part)| part.mesh()).collect();
        let refined = refine_parts(plan, &meshes, limits, used.saturating_add(share));
        for ((_, part), refined) in parts.iter_mut().zip(refined) {
            *part = part.with_mesh(refined.mesh);
        }
    }
    parts
}

/// For each step the parts in the observer's frame and their limits, with one offset in a file for all steps.
fn seen_at_all_steps(
    plans: &mut [Plan<'_>],
    parts: &[(String, Part)],
) -> Vec<(Vec<MappedMesh>, Limits)> {
    let seen: Vec<Vec<MappedMesh>> = plans
        .iter()
        .map(|plan| seen_parts(plan.view(), parts))
        .collect();
    let box_of_all_steps = bounds(seen.iter().flatten());
    let limits = plans.iter_mut().zip(&seen).map(|(plan, seen)| {
        plan.tolerance.box_of_all_steps = box_of_all_steps;
        plan.tolerance.limits(parts, seen, 1.0)
    });
    let limits: Vec<Limits> = limits.collect();
    seen.into_iter().zip(limits).collect()
}
