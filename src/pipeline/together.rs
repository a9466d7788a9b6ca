//! One mesh for all steps, within the tolerance at each.

use std::borrow::Cow;

use super::SurfaceOptions;
use super::certifying::{Measured, certificate};
use super::limits::{Limits, bounds};
use super::making::{Surface, refine_parts};
use super::mapped_mesh::MappedMesh;
use super::placed_object::{PlacedObject, triangle_count};
use super::plan::{Plan, seen_parts};
use crate::material::Part;
use crate::mesh::Mesh;
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
    share_finest_shape(&mut plans);
    let Some(first) = plans.first() else {
        return vec![];
    };
    let before = match first.shape.as_ref().zip(placed_object.shaped.as_ref()) {
        Some((shape, shaped)) => shaped.parts_like(shape, &placed_object.parts),
        None => placed_object.parts.clone(),
    };
    let granted = placed_object.granted_together();
    let limits = seen_at_all_steps(&mut plans, &before);
    let limits: Vec<Limits> = limits.into_iter().map(|(_, limits)| limits).collect();
    let parts = refined_for_all(&plans, &before, &limits, wanted, granted);
    let mut seen = seen_at_all_steps(&mut plans, &parts);
    let mut surfaces = vec![];
    for (index, ((name, part), (_, before))) in parts.iter().zip(&before).enumerate() {
        let steps = plans.iter().zip(&mut seen).map(|(plan, (seen, limits))| {
            let (part, before) = (standing_in(plan, part), standing_in(plan, before));
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
                certificate: certificate(tolerance, limits, mesh, &seen, around, measured),
                around: around.unwrap_or_default(),
                seen,
                part: Cow::Owned(part),
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

/// What stands for a part at rest at the step of a plan.
fn standing_in(plan: &Plan<'_>, part: &Part) -> Part {
    match plan.shown.rest_to_stand_in() {
        Some(to_stand_in) => part.clone().transformed(&to_stand_in),
        None => part.clone(),
    }
}

/// What stands for all parts.
fn all_standing_in(plan: &Plan<'_>, parts: &[(String, Part)]) -> Vec<(String, Part)> {
    let parts = parts.iter();
    parts
        .map(|(name, part)| (name.clone(), standing_in(plan, part)))
        .collect()
}

/// The mesh at rest of a refined stand-in. The vertices of `before`, the mesh at rest that has been refined, stay as they
/// are; those that are new are taken back.
fn back_at_rest(plan: &Plan<'_>, before: &Mesh, refined: Mesh) -> Mesh {
    let Some(to_rest) = plan.shown.stand_in_to_rest() else {
        return refined;
    };
    fn kept<T: Copy>(old: Option<&[T]>, new: Option<&[T]>) -> Option<Vec<T>> {
        let (old, new) = old.zip(new)?;
        Some([old, &new[old.len()..]].concat())
    }
    let back = refined.transformed(&to_rest);
    let positions = kept(Some(before.positions()), Some(back.positions()));
    back.with_geometry(
        positions.unwrap_or_default(),
        kept(before.normals(), back.normals()),
        kept(before.tangents(), back.tangents()),
    )
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
        let standing_in = all_standing_in(plan, &parts);
        let meshes: Vec<&Mesh> = standing_in.iter().map(|(_, part)| part.mesh()).collect();
        let refined = refine_parts(plan, &meshes, limits, used.saturating_add(share));
        for ((_, part), refined) in parts.iter_mut().zip(refined) {
            *part = part.with_mesh(back_at_rest(plan, part.mesh(), refined.mesh));
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
        .map(|plan| seen_parts(plan.view(), &all_standing_in(plan, parts)))
        .collect();
    let box_of_all_steps = bounds(seen.iter().flatten());
    let limits = plans.iter_mut().zip(&seen).map(|(plan, seen)| {
        plan.tolerance.box_of_all_steps = box_of_all_steps;
        plan.tolerance
            .limits(&all_standing_in(plan, parts), seen, 1.0)
    });
    let limits: Vec<Limits> = limits.collect();
    seen.into_iter().zip(limits).collect()
}
