//! One mesh for all steps, within the tolerance at each.

use std::borrow::Cow;

use super::SurfaceOptions;
use super::certifying::{Measured, certificate};
use super::curved::make_curved_together;
use super::limits::{Limits, bounds};
use super::making::{Surface, refine_parts};
use super::mapped_mesh::MappedMesh;
use super::placed_object::{PlacedObject, triangle_count};
use super::plan::{Plan, seen_parts};
use super::standing_in::{back_at_rest, stretched};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::scene::Measure;
use crate::shape::Shape;
use crate::tessellate::{Counts, largest_gap, shares, survey};

/// Carries out the plans of one object for all steps with one mesh at rest, which is refined for one step after the
/// other; for each part its surfaces at all steps.
///
/// A mesh within the tolerance at one step stays so when it is refined for another: the gap of a triangle is how far a
/// chord plane is above the convex `r`, and that of a piece of it is below that of the whole.
///
/// Each step may use a share of the `granted` triangles beyond the source that the steps before it have left, in
/// proportion to the triangles granted to it and to the later steps where each has a mesh of its own.
///
/// What stands for the object under its model may differ from step to step: the shared mesh is that of the object itself.
pub(super) fn make_together<'a>(
    placed_object: &'a PlacedObject,
    mut plans: Vec<Plan<'a>>,
    wanted: SurfaceOptions,
) -> Vec<Vec<Surface<'a>>> {
    if plans.iter().any(|plan| plan.as_curved.is_some()) {
        match make_curved_together(placed_object, &mut plans) {
            Some(surfaces) => return vec![surfaces],
            None => plans.iter_mut().for_each(|plan| plan.take_facets(wanted)),
        }
    }
    share_finest_shape(&mut plans);
    let Some(first) = plans.first() else {
        return vec![];
    };
    let before = match first.shape.as_ref().zip(placed_object.shaped.as_ref()) {
        Some((shape, shaped)) => shaped.parts_like(shape, &placed_object.parts),
        None => placed_object.parts.clone(),
    };
    let granted = placed_object.granted_together();
    let drafts = at_all_steps(&mut plans, &before);
    let parts = refined_for_all(&plans, &before, &drafts, wanted, granted);
    let after = at_all_steps(&mut plans, &parts);
    let mut surfaces = vec![];
    for (index, (name, _)) in parts.iter().enumerate() {
        let steps = plans.iter().zip(drafts.iter().zip(&after));
        let steps = steps.map(|(plan, (draft, after))| {
            let (_, part) = &after.stand_ins[index];
            let (mesh, seen, limits) = (part.mesh(), after.seen[index].clone(), &after.limits);
            let tolerance = &plan.tolerance;
            let observer = tolerance.view.observer_rest();
            let before = draft.stand_ins[index].1.mesh();
            let minimum = survey(
                before,
                observer,
                f64::INFINITY,
                &limits.whole,
                tolerance.motion().as_ref(),
            );
            let measured = Measured {
                gap: largest_gap(mesh, observer),
                surface_gap: f64::INFINITY,
                counts: Counts {
                    triangles_in: before.triangles().len(),
                    triangles_out: mesh.triangles().len(),
                    minimum_triangles: minimum.minimum_triangles,
                    minimum_with_source: minimum.minimum_with_source,
                },
            };
            let around = tolerance.box_of_all_steps;
            Surface {
                name: name.clone(),
                certificate: certificate(tolerance, limits, mesh, &seen, around, measured),
                around: around.unwrap_or_default(),
                seen,
                part: Cow::Owned(part.clone()),
                at_rest: plan.itself.map(|_| parts[index].1.mesh().clone()),
            }
        });
        surfaces.push(steps.collect());
    }
    surfaces
}

/// Gives every step the shape of the step that asks for the largest number of facets.
fn share_finest_shape(plans: &mut [Plan<'_>]) {
    let shapes = plans.iter().filter_map(|plan| plan.shape.clone());
    if let Some(shape) = shapes.max_by_key(Shape::triangle_count) {
        for plan in plans {
            if let Some(shaped) = &plan.placed_object.shaped {
                plan.tolerance.deviation = shape.deviation() * shaped.largest_scale;
            }
            plan.shape = Some(shape.clone());
        }
    }
}

/// The parts of an object at one step.
struct AtStep {
    /// What stands for them, each with its name in files.
    stand_ins: Vec<(String, Part)>,
    /// In the observer's frame.
    seen: Vec<MappedMesh>,
    limits: Limits,
}

/// What stands for parts at rest at the step of a plan.
fn standing_in(plan: &Plan<'_>, parts: &[(String, Part)]) -> Vec<(String, Part)> {
    match plan.shown.rest_to_stand_in() {
        Some(to_stand_in) => stretched(parts, &to_stand_in),
        None => parts.to_vec(),
    }
}

/// The parts at rest, refined for one step after the other.
fn refined_for_all(
    plans: &[Plan<'_>],
    before: &[(String, Part)],
    drafts: &[AtStep],
    wanted: SurfaceOptions,
    granted: u64,
) -> Vec<(String, Part)> {
    let mut parts = before.to_vec();
    for (step, (plan, draft)) in plans.iter().zip(drafts).enumerate() {
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
        let standing_in = standing_in(plan, &parts);
        let meshes: Vec<&Mesh> = standing_in.iter().map(|(_, part)| part.mesh()).collect();
        let refined = refine_parts(plan, &meshes, &draft.limits, used.saturating_add(share));
        for ((_, part), refined) in parts.iter_mut().zip(refined) {
            *part = part.with_mesh(back_at_rest(&plan.shown, part.mesh(), refined.mesh));
        }
    }
    parts
}

/// The parts at each step, with one offset in a file for all steps.
fn at_all_steps(plans: &mut [Plan<'_>], parts: &[(String, Part)]) -> Vec<AtStep> {
    let shown: Vec<_> = plans
        .iter()
        .map(|plan| {
            let stand_ins = standing_in(plan, parts);
            let seen = seen_parts(plan.view(), &stand_ins);
            (stand_ins, seen)
        })
        .collect();
    let box_of_all_steps = bounds(shown.iter().flat_map(|(_, seen)| seen));
    let steps = plans.iter_mut().zip(shown);
    let steps = steps.map(|(plan, (stand_ins, seen))| {
        plan.tolerance.box_of_all_steps = box_of_all_steps;
        // A mesh that is refined for several steps has no facets that a bound for surfaces could start from.
        plan.tolerance.measure = Measure::Points;
        AtStep {
            limits: plan.tolerance.limits(&stand_ins, &seen, 1.0),
            stand_ins,
            seen,
        }
    });
    steps.collect()
}
