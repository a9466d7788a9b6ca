//! How one object becomes photosurfaces at one step: what is allowed, what that takes, and the doing.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use super::{Placed, Wanted, seen_mesh};
use crate::light_cone::View;
use crate::mesh::{Mesh, Part};
use crate::scene::Tolerance;
use crate::tessellate::{
    Allowance, Bounds, Certificate, Counts, local_stretch, minimum_triangles, predicted_pieces,
    refine, rounding_bound, triangle_gap,
};

/// What part of the tolerance of a curved shape its facets may use; the rest is for the gap between them.
///
/// Facets small enough for the curvature have small gaps already: less would make more facets, more would
/// leave the few near the observer too little.
const CURVATURE_SHARE: f64 = 0.7;

/// What is left of a tolerance for the gap, for the sums of its certificate.
const ROOM: f64 = 0.999;

/// Where an angle is the tolerance of a curved shape, it is one at this part of the shape's size at least: an
/// observer who touches it sees any facet under a large angle.
const NEAREST: f64 = 0.01;

/// Where an angle is the tolerance, no triangle is made smaller than this part of the mesh: where the observer
/// touches a surface, any gap is seen under the same angle.
const LEAST_OF_ANGLE: f64 = 1e-6;

/// How one object is seen at one step, and what its tolerance allows.
pub(super) struct Plan<'a> {
    view: View,
    tolerance: Tolerance,
    /// The tolerance as a length; of an angle, at the nearest vertex.
    length: f64,
    /// In the object's rest frame, with names in files; those of a curved shape fine enough for the tolerance.
    parts: Cow<'a, [(String, Part)]>,
    /// Of facets from a curved surface, at rest; zero for what is flat.
    deviation: f64,
    /// The same as seen, at most.
    curvature: f64,
    /// For each part: the seen mesh without refinement, its rounding, and what is allowed.
    drafts: Vec<Draft>,
}

struct Draft {
    seen: Mesh,
    /// What gap is left by curvature and rounding.
    allowance: Allowance,
    /// What gap the whole tolerance would allow.
    whole: Allowance,
}

/// A part of the object, refined and seen.
pub(super) struct Surface {
    pub(super) name: String,
    pub(super) part: Part,
    pub(super) seen: Mesh,
    pub(super) certificate: Certificate,
}

impl<'a> Plan<'a> {
    pub(super) fn new(
        placed: &'a Placed,
        view: View,
        tolerance: Tolerance,
        wanted: Wanted,
    ) -> Self {
        let mut plan = Self {
            view,
            tolerance,
            length: 0.0,
            parts: Cow::Borrowed(&placed.parts),
            deviation: 0.0,
            curvature: 0.0,
            drafts: vec![],
        };
        let seen: Vec<Mesh> = plan.seen_meshes();
        let (center, radius) = ball(placed.parts.iter().map(|(_, part)| part.mesh()));
        let stretch = view.stretch_bound(center, radius);
        let aimed = tolerance.times(wanted.loosening);
        plan.length = length_of(tolerance, &seen);
        let aimed_length = length_of(aimed, &seen);

        if let Some(shaped) = &placed.shaped {
            let rounding = rounding_bound(
                &view,
                placed.parts[0].1.mesh(),
                &seen[0],
                stretch,
                wanted.precision,
            );
            let mesh = placed.parts[0].1.mesh();
            let target =
                CURVATURE_SHARE * plan.deviation_allowed(aimed, aimed_length, rounding, mesh);
            let shape = match wanted.subdivide {
                true => shaped.shape.within(target / shaped.largest_scale),
                false => shaped.shape.clone(),
            };
            plan.deviation = shape.deviation() * shaped.largest_scale;
            if shape != shaped.shape {
                plan.parts = Cow::Owned(shaped.parts_like(&shape, &placed.parts));
            }
        }
        let seen = if plan.parts.len() == seen.len() && matches!(plan.parts, Cow::Borrowed(_)) {
            seen
        } else {
            plan.seen_meshes()
        };
        if plan.deviation > 0.0 {
            let stretches = plan.parts[0].1.mesh().triangles().par_iter();
            let stretches = stretches.map(|corners| {
                local_stretch(
                    &view,
                    corners.map(|corner| plan.parts[0].1.mesh().positions()[corner as usize]),
                )
            });
            plan.curvature = plan.deviation * stretches.reduce(|| 0.0, f64::max);
        }
        // One allowance for all parts, so that those that share an edge divide it alike.
        let rounding = (seen.iter().zip(plan.parts.iter()))
            .map(|(seen, (_, part))| {
                rounding_bound(&view, part.mesh(), seen, stretch, wanted.precision)
            })
            .fold(0.0, f64::max);
        let allowance = plan.allowance(aimed, aimed_length, plan.curvature, rounding, &seen);
        let whole = plan.allowance(tolerance, plan.length, 0.0, 0.0, &seen);
        let drafts = seen.into_iter().map(|seen| Draft {
            allowance,
            whole,
            seen,
        });
        plan.drafts = drafts.collect();
        plan
    }

    /// About how many triangles the object will have.
    pub(super) fn predicted_triangles(&self, subdivide: bool) -> f64 {
        let observer = self.view.observer_rest();
        let parts = self
            .parts
            .iter()
            .zip(&self.drafts)
            .map(|((_, part), draft)| {
                let triangles = part.mesh().triangles();
                if !subdivide {
                    return triangles.len() as f64;
                }
                let predict = |corners: &[u32; 3]| {
                    let position = |corner: u32| part.mesh().positions()[corner as usize];
                    predicted_pieces(
                        corners.map(|corner| position(corner) - observer),
                        &draft.allowance,
                    )
                };
                triangles
                    .par_iter()
                    .map(predict)
                    .collect::<Vec<f64>>()
                    .iter()
                    .sum::<f64>()
            });
        parts.sum()
    }

    /// Refines where that is wanted, maps, and proves.
    pub(super) fn carry_out(self, wanted: Wanted) -> Vec<Surface> {
        let observer = self.view.observer_rest();
        let velocity = self.view.relative_velocity();
        let drafts = self.parts.into_owned().into_iter().zip(self.drafts);
        let surface = |((name, part), draft): ((String, Part), Draft)| {
            let triangles_in = part.mesh().triangles().len();
            let minimum = part.mesh().triangles().par_iter().map(|corners| {
                let offsets =
                    corners.map(|corner| part.mesh().positions()[corner as usize] - observer);
                minimum_triangles(offsets, draft.whole.between(&offsets)).max(1.0)
            });
            // Added up in their order: the same sum for any number of threads.
            let minimum_triangles = minimum.collect::<Vec<f64>>().iter().sum();
            let (part, gap) = if wanted.subdivide && velocity.rapidity() > 0.0 {
                let refined = refine(part.mesh(), observer, &draft.allowance);
                (part.with_mesh(refined.mesh), refined.gap)
            } else {
                let gap = largest_gap(part.mesh(), observer);
                (part, gap)
            };
            let seen = if part.mesh().positions().len() == draft.seen.positions().len() {
                draft.seen
            } else {
                seen_mesh(&self.view, part.mesh())
            };
            let (center, radius) = ball([part.mesh()].into_iter());
            let stretch = self.view.stretch_bound(center, radius);
            let bounds = Bounds {
                gap: velocity.gamma_beta() * gap * (1.0 + 4.0 * f64::EPSILON),
                deviation: self.deviation,
                curvature: self.curvature,
                rounding: rounding_bound(&self.view, part.mesh(), &seen, stretch, wanted.precision),
            };
            let counts = Counts {
                triangles_in,
                triangles_out: part.mesh().triangles().len(),
                minimum_triangles,
            };
            let certificate = match self.tolerance {
                Tolerance::Angle(degrees) => {
                    Certificate::of_angles(degrees, &self.view, part.mesh(), bounds, counts)
                }
                _ => Certificate::of_lengths(self.length, bounds, counts),
            };
            Surface {
                name,
                part,
                seen,
                certificate,
            }
        };
        drafts.map(surface).collect()
    }

    fn seen_meshes(&self) -> Vec<Mesh> {
        self.parts
            .iter()
            .map(|(_, part)| seen_mesh(&self.view, part.mesh()))
            .collect()
    }

    /// How far from a curved surface facets may be, at rest, if they were all that a tolerance is used for.
    fn deviation_allowed(
        &self,
        tolerance: Tolerance,
        length: f64,
        rounding: f64,
        mesh: &Mesh,
    ) -> f64 {
        let left = (length - rounding).max(0.5 * length);
        let allowed = |corners: &[u32; 3]| {
            let positions = corners.map(|corner| mesh.positions()[corner as usize]);
            let here = match tolerance {
                Tolerance::Angle(degrees) => {
                    let offsets = positions.map(|position| position - self.view.observer_rest());
                    let distances = offsets.map(|offset| self.view.seen_distance(offset));
                    let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
                    // The facets that this leads to are other ones: a little room for their distances.
                    (0.9 * degrees.to_radians().sin() * nearest).max(left)
                }
                _ => left,
            };
            here / local_stretch(&self.view, positions)
        };
        let all = mesh.triangles().par_iter().map(allowed);
        all.reduce(|| f64::INFINITY, f64::min)
    }

    /// The gap `e` that a tolerance allows when `curvature` and `rounding` use some of it.
    fn allowance(
        &self,
        tolerance: Tolerance,
        length: f64,
        curvature: f64,
        rounding: f64,
        seen: &[Mesh],
    ) -> Allowance {
        let velocity = self.view.relative_velocity();
        let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
        match tolerance {
            Tolerance::Angle(degrees) => {
                // (gamma beta e + rounding) / (distance - gamma e - rounding) <= s, solved for e. What curvature takes
                // goes with the distance.
                let s = degrees.to_radians().sin();
                let left = if curvature > 0.0 {
                    (1.0 - CURVATURE_SHARE * (1.0 + s)).max(0.1)
                } else {
                    1.0
                };
                let share = ROOM / (gamma_beta + gamma * s);
                let diagonal = length_of(Tolerance::Relative(1.0), seen);
                Allowance::Angle {
                    view: self.view,
                    share: s * left * share,
                    less: (1.0 + s) * rounding * share,
                    least: LEAST_OF_ANGLE * diagonal * s * share,
                }
            }
            // Where more is taken than there is, the gap gets a tenth all the same, and the certificate tells.
            _ => {
                let left = (length - curvature - rounding).max(0.1 * length);
                Allowance::Everywhere(ROOM * left / gamma_beta)
            }
        }
    }
}

/// A tolerance as a length; an angle at the nearest vertex.
fn length_of(tolerance: Tolerance, seen: &[Mesh]) -> f64 {
    let diagonal = || {
        let bounds = seen.iter().filter_map(Mesh::bounds);
        let all = bounds.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
        all.map_or(0.0, |(low, high)| low.distance(high))
    };
    match tolerance {
        Tolerance::Absolute(length) => length,
        Tolerance::Relative(fraction) => fraction * diagonal(),
        Tolerance::Angle(degrees) => {
            let distances = seen
                .iter()
                .flat_map(Mesh::positions)
                .map(|place| place.length());
            let nearest = distances.fold(f64::INFINITY, f64::min);
            degrees.to_radians().sin() * nearest.max(NEAREST * diagonal())
        }
    }
}

/// A ball around meshes.
fn ball<'m>(meshes: impl Iterator<Item = &'m Mesh>) -> (DVec3, f64) {
    let bounds = meshes
        .filter_map(Mesh::bounds)
        .reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
    let (low, high) = bounds.unwrap_or_default();
    // Rounded up: the corners of the box are in it.
    (
        0.5 * low + 0.5 * high,
        0.5 * low.distance(high) * (1.0 + 1e-12),
    )
}

fn largest_gap(mesh: &Mesh, observer: DVec3) -> f64 {
    let gaps = mesh.triangles().par_iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize] - observer);
        triangle_gap(a, b, c)
    });
    gaps.reduce(|| 0.0, f64::max)
}
