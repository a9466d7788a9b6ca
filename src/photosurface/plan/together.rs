//! One mesh for all steps, within the tolerance at each.

use std::borrow::Cow;

use super::{Limits, Plan, Surface, bounds, seen_parts};
use crate::mesh::Part;
use crate::photosurface::Wanted;
use crate::photosurface::seen::Seen;
use crate::tessellate::{Counts, refine, survey};

impl<'a> Plan<'a> {
    /// Carries out the plans of one object for all steps with one mesh at rest, which is refined for one step after
    /// the other; for each part its surfaces at all steps.
    ///
    /// What is within the tolerance at one step stays so when it is refined for another: the gap of a triangle is
    /// how far a chord plane is above the convex `r`, and that of a piece of it is below that of the whole.
    pub(in crate::photosurface) fn carry_out_together(
        mut plans: Vec<Self>,
        wanted: Wanted,
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
        for (plan, (_, limits)) in plans.iter().zip(&limits) {
            if !wanted.subdivide || plan.view.relative_velocity().rapidity() == 0.0 {
                continue;
            }
            for (_, part) in &mut parts {
                let observer = plan.view.observer_rest();
                let refined = refine(part.mesh(), observer, &limits.allowance, &limits.whole);
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
    fn travelling(plans: &mut [Self], parts: &[(String, Part)]) -> Vec<(Vec<Seen>, Limits)> {
        let seen: Vec<Vec<Seen>> = plans
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
