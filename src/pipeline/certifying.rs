//! The certificate of one mesh at one step: its bounds against the tolerance of the scene.

use glam::DVec3;

use super::limits::{Limits, StepTolerance};
use super::mapped_mesh::MappedMesh;
use crate::mesh::Mesh;
use crate::scene::Unit;
use crate::spacetime::length;
use crate::tessellate::{Bounds, Certificate, Counts, survey};

/// The measured gap of a mesh, and its numbers of triangles.
pub(super) struct Measured {
    /// The largest gap `e`, a length in the rest frame before the factor `gamma beta`.
    pub(super) gap: f64,
    /// A bound on the same as surfaces, as a gap.
    pub(super) surface_gap: f64,
    pub(super) counts: Counts,
}

impl Measured {
    /// The measures of a mesh at rest that stays as it is.
    pub(super) fn of_unrefined(tolerance: &StepTolerance, limits: &Limits, mesh: &Mesh) -> Self {
        let observer = tolerance.view.observer_rest();
        let found = survey(
            mesh,
            observer,
            f64::INFINITY,
            &limits.whole,
            tolerance.motion().as_ref(),
        );
        Self {
            gap: found.gap,
            surface_gap: f64::INFINITY,
            counts: Counts {
                triangles_in: mesh.triangle_count(),
                triangles_out: mesh.triangle_count(),
                minimum_triangles: found.minimum_triangles,
                minimum_with_source: found.minimum_with_source,
            },
        }
    }
}

/// The certificate of a mesh at rest, refined or not, that is `seen` like this.
///
/// `around` is the box, in the observer's frame, around all parts that share an offset in a file with this one.
pub(super) fn certificate(
    tolerance: &StepTolerance,
    limits: &Limits,
    mesh: &Mesh,
    seen: &MappedMesh,
    around: Option<(DVec3, DVec3)>,
    measured: Measured,
) -> Certificate {
    let Measured {
        gap,
        surface_gap,
        mut counts,
    } = measured;
    if let Some(least) = tolerance.least_of_round(seen.extremes.nearest) {
        counts.minimum_triangles = least;
        counts.minimum_with_source = least;
    }
    let gamma_beta = tolerance.view.relative_velocity().gamma_beta();
    let gap = gamma_beta * gap * (1.0 + 4.0 * f64::EPSILON);
    let bounds = Bounds {
        gap,
        // No surface is farther from another than its points are from their places.
        surface_gap: (gamma_beta * surface_gap * (1.0 + 4.0 * f64::EPSILON)).min(gap),
        deviation: tolerance.deviation,
        curvature: limits.curvature,
        rounding: tolerance.rounding(mesh, &seen.extremes, around, 0.0),
    };
    let measure = tolerance.measure;
    match (tolerance.tolerance.unit(), tolerance.tolerance.number()) {
        (Unit::Degrees, degrees) => {
            Certificate::of_angles(degrees, measure, &tolerance.view, mesh, bounds, counts)
        }
        _ => Certificate::of_lengths(tolerance.length, measure, bounds, counts),
    }
}

/// The certificate of a round shape with vertices on the exact surface: each triangle has two bounds on its distance from the
/// photosurface, as surfaces and between points, lengths in the observer's frame.
pub(super) fn of_curved(
    tolerance: &StepTolerance,
    mesh: &Mesh,
    seen: &MappedMesh,
    around: Option<(DVec3, DVec3)>,
    bounds: &[[f64; 2]],
    counts: Counts,
) -> Certificate {
    let rounding = tolerance.rounding(mesh, &seen.extremes, around, 0.0);
    let measure = tolerance.measure;
    match (tolerance.tolerance.unit(), tolerance.tolerance.number()) {
        (Unit::Degrees, degrees) => {
            Certificate::of_seen_angles(degrees, measure, &seen.mesh, bounds, rounding, counts)
        }
        _ => {
            let largest = |k: usize| bounds.iter().map(|of| of[k]).fold(0.0, f64::max);
            let surface_gap = largest(0);
            // Where nothing else is known of points: all of the mesh is in the box around its vertices, and no place of
            // the photosurface is farther than the other bound from it.
            let across = seen.extremes.bounds().map(|(low, high)| length(high - low));
            let across = across.map_or(f64::INFINITY, |across| across + 4.0 * surface_gap);
            let bounds = Bounds {
                gap: largest(1).min(across),
                surface_gap,
                deviation: 0.0,
                curvature: 0.0,
                rounding,
            };
            Certificate::of_lengths(tolerance.length, measure, bounds, counts)
        }
    }
}
