//! One mesh for all steps, within the tolerance at each.

use std::borrow::Cow;

use super::{Limits, Plan, Surface, bounds, seen_parts};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::pipeline::SurfaceOptions;
use crate::pipeline::mapped_mesh::MappedMesh;
use crate::tessellate::{Counts, shares, survey};

impl<'a> Plan<'a> {
    /// Carries out the plans of one object for all steps with one mesh at rest, which is refined for one step after
    /// the other; for each part its surfaces at all steps.
    ///
    /// What is within the tolerance at one step stays so when it is refined for another: the gap of a triangle is
    /// how far a chord plane is above the convex `r`, and that of a piece of it is below that of the whole.
    ///
    /// Of what is `granted` beyond the triangles of the source, each step has a share of what those before it have left,
    /// in proportion to what is granted for it and those behind it where each has a mesh of its own.
    pub(in crate::pipeline) fn carry_out_together(
        mut plans: Vec<Self>,
        wanted: SurfaceOptions,
        granted: u64,
    ) -> Vec<Vec<Surface<'a>>> {
        let shapes = plans
            .iter()
            .filter_map(|plan| Some((plan.shape.clone()?, plan.deviation)));
        if let Some((shape, deviation)) = shapes.max_by_key(|(shape, _)| shape.triangle_count()) {
            for plan in &mut plans {
                (plan.shape, plan.deviation) = (Some(shape.clone()), deviation);
            }
        }
        let Some(first) = plans.first_mut() else {
            return vec![];
        };
        let before: Vec<(String, Part)> = first.draft().parts.into_owned();
        let mut parts: Vec<(String, Part)> = before.clone();
        let limits = Self::travelling(&mut plans, &parts);
        let triangles = |parts: &[(String, Part)]| {
            let triangles = parts.iter().map(|(_, part)| part.mesh().triangles().len());
            triangles.sum::<usize>() as u64
        };
        for (step, (plan, (_, limits))) in plans.iter().zip(&limits).enumerate() {
            if !wanted.subdivide || plan.view.relative_velocity().rapidity() == 0.0 {
                continue;
            }
            let source = plan.placed_object.source_triangles;
            let used = triangles(&parts).saturating_sub(source);
            let weights: Vec<f64> = plans[step..]
                .iter()
                .map(|plan| plan.granted as f64 + 1.0)
                .collect();
            let share = shares(granted.saturating_sub(used), &weights)[0];
            let meshes: Vec<&Mesh> = parts.iter().map(|(_, part)| part.mesh()).collect();
            let refined = plan.refine(&meshes, limits, used.saturating_add(share));
            for ((_, part), refined) in parts.iter_mut().zip(refined) {
                *part = part.with_mesh(refined.mesh);
            }
        }
        let mut seen = Self::travelling(&mut plans, &parts);
        let mut surfaces = vec![];
        for (index, ((name, part), (_, before))) in parts.iter().zip(&before).enumerate() {
            let steps = plans.iter().zip(&mut seen).map(|(plan, (seen, limits))| {
                let (mesh, seen) = (part.mesh(), seen[index].clone());
                let gap = plan.largest_gap(mesh);
                let before = before.mesh();
                let observer = plan.view.observer_rest();
                let minimum = survey(before, observer, f64::INFINITY, &limits.whole);
                let counts = Counts {
                    triangles_in: before.triangles().len(),
                    triangles_out: mesh.triangles().len(),
                    minimum_triangles: minimum.minimum_triangles,
                };
                Surface {
                    name: name.clone(),
                    part: Cow::Owned(part.clone()),
                    certificate: plan.certificate(limits, mesh, &seen, plan.travel, gap, counts),
                    around: plan.travel.unwrap_or_default(),
                    seen,
                }
            });
            surfaces.push(steps.collect());
        }
        surfaces
    }

    /// Parts as they are seen at each step, with what is allowed there when all steps share one offset in a file.
    fn travelling(plans: &mut [Self], parts: &[(String, Part)]) -> Vec<(Vec<MappedMesh>, Limits)> {
        let seen: Vec<Vec<MappedMesh>> = plans
            .iter()
            .map(|plan| seen_parts(&plan.view, parts))
            .collect();
        let travel = bounds(seen.iter().flatten());
        let limits = plans.iter_mut().zip(&seen).map(|(plan, seen)| {
            plan.travel = travel;
            plan.limits(parts, seen, 1.0)
        });
        let limits: Vec<Limits> = limits.collect();
        seen.into_iter().zip(limits).collect()
    }
}
