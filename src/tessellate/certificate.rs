//! The certificate: a proof of how far a mesh is from the true photosurface.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Serialize, Serializer};

use super::triangle_gap;
use crate::light_cone::{Extremes, View};
use crate::mesh::Mesh;
use crate::scene::Unit;

/// Room for the few roundings of a product of bounds.
const UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// How far a mesh is, at most, from the true photosurface.
///
/// Lengths are in the observer's frame; where the tolerance is an angle, `tolerance`, `gap`, `curvature`,
/// `rounding` and `total` are angles seen by the observer, in degrees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// Of all these numbers: a length, or degrees.
    #[serde(serialize_with = "name")]
    pub unit: Unit,
    /// What was asked for.
    pub tolerance: f64,
    /// Proven: between the mapped flat triangles and the photosurface of the triangles at rest.
    pub gap: f64,
    /// Proven: between the photosurfaces of the triangles at rest and of the curved surface that they stand for.
    pub curvature: f64,
    /// Proven: by rounding, of the computation and of the numbers in the file.
    pub rounding: f64,
    /// Proven: the sum of the three.
    pub total: f64,
    /// Whether the total is within the tolerance.
    pub complete: bool,
    /// Triangles of the mesh at rest.
    pub triangles_in: usize,
    /// Triangles of the photosurface.
    pub triangles_out: usize,
    /// The fewest triangles, each inside one at rest, that theory allows for a gap as large as the tolerance.
    pub minimum_triangles: f64,
    /// `triangles_out / minimum_triangles`
    pub ratio: f64,
}

/// How many digits the numbers of a file have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Precision {
    /// `f32`, relative to an offset in the middle of the mesh: glTF.
    #[default]
    Single,
    /// `f64`: PLY.
    Double,
}

/// A bound of what rounding moves a vertex by, for every vertex of a mesh.
///
/// # Derivation
///
/// The place in the rest frame is off by a few units in the last place of the coordinates that it is computed
/// from (the object's place, the numbers that the observer's place is a sum of, the interpolation of new vertices): at
/// most 8 epsilon of their size, which the map stretches by at most `stretch`. The map itself adds at most 16 epsilon
/// of the place; what a composed velocity, known to its last place, makes of it is 4 epsilon of `stretch r`. In a file with `f32` each
/// coordinate relative to the offset, at most half the extent and a sixteenth of the largest extent, is
/// rounded; morph targets add a difference, at most twice as large, and so round it three times.
pub(crate) fn rounding_bound(
    view: &View,
    seen: &Extremes,
    stretch: f64,
    in_file: Option<Singles>,
) -> f64 {
    let size_rest = seen.farthest_rest + view.place_size();
    let double = f64::EPSILON * (16.0 * stretch * size_rest + 16.0 * seen.farthest);
    let Some(Singles { extent, roundings }) = in_file else {
        return double;
    };
    let largest_local = (0.5 * extent + extent.max_element() / 32.0).length();
    double + roundings * largest_local * (0.5 * f64::from(f32::EPSILON)) * 1.01
}

/// Positions as `f32` relative to an offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singles {
    /// Of all positions with that offset.
    pub(crate) extent: DVec3,
    /// How many times they are rounded.
    pub(crate) roundings: f64,
}

/// A bound of how much anything near a triangle is stretched: in the ball that reaches twice as far from its
/// middle as its corners, so that it holds a curved surface that passes through them.
pub(crate) fn local_stretch(view: &View, [a, b, c]: [DVec3; 3]) -> f64 {
    let middle = (a + b + c) / 3.0;
    let reach = [a, b, c]
        .map(|corner| corner.distance(middle))
        .into_iter()
        .fold(0.0, f64::max);
    view.stretch_bound(middle, 2.0 * reach)
}

/// What a certificate adds up, as lengths in the observer's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// `gamma beta e`, the largest of the mesh.
    pub(crate) gap: f64,
    /// The distance of facets from a curved surface, at rest.
    pub(crate) deviation: f64,
    /// The same as seen, at most.
    pub(crate) curvature: f64,
    /// See [`rounding_bound`].
    pub(crate) rounding: f64,
}

/// How many triangles there were, are, and have to be at least.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts {
    pub(crate) triangles_in: usize,
    pub(crate) triangles_out: usize,
    pub(crate) minimum_triangles: f64,
}

impl Certificate {
    /// With the tolerance and all bounds as lengths.
    pub(crate) fn of_lengths(tolerance: f64, bounds: Bounds, counts: Counts) -> Self {
        let total = bounds.gap + bounds.curvature + bounds.rounding;
        Self::new(
            Unit::Absolute,
            tolerance,
            [bounds.gap, bounds.curvature, bounds.rounding, total],
            counts,
        )
    }

    /// With the tolerance an angle seen by the observer, in degrees.
    ///
    /// A point displaced by a length is seen displaced by at most `asin(length / distance)`, the distance being
    /// that of the nearer one: on a triangle at least the smallest of a corner minus `gamma e`, and what
    /// curvature and rounding may take away.
    pub(crate) fn of_angles(
        degrees: f64,
        view: &View,
        rest: &Mesh,
        bounds: Bounds,
        counts: Counts,
    ) -> Self {
        let velocity = view.relative_velocity();
        let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
        let sines = rest.triangles().par_iter().map(|corners| {
            let positions = corners.map(|corner| rest.positions()[corner as usize]);
            let [a, b, c] = positions.map(|position| position - view.observer_rest());
            let e = triangle_gap(a, b, c);
            let gap = gamma_beta * e * UP;
            let curvature = match bounds.deviation {
                0.0 => 0.0,
                deviation => deviation * local_stretch(view, positions) * UP,
            };
            let distances = [a, b, c].map(|offset| view.seen_distance(offset));
            let nearest = distances.into_iter().fold(f64::INFINITY, f64::min)
                * (1.0 - 16.0 * f64::EPSILON)
                - gamma * e * UP
                - curvature
                - bounds.rounding;
            let sine = |length: f64| {
                match length {
                    // Nothing is nothing however near: a flat shape has no curvature.
                    0.0 => 0.0,
                    _ if length < nearest => length / nearest,
                    _ => 2.0,
                }
            };
            let total = gap + curvature + bounds.rounding;
            [gap, curvature, bounds.rounding, total].map(sine)
        });
        let larger = |a: [f64; 4], b: [f64; 4]| [0, 1, 2, 3].map(|i| a[i].max(b[i]));
        let sines = sines.reduce(|| [0.0; 4], larger);
        let angle = |sine: f64| {
            if sine <= 1.0 {
                sine.asin().to_degrees() * UP
            } else {
                180.0
            }
        };
        let certificate = Self::new(Unit::Degrees, degrees, sines.map(angle), counts);
        Self {
            // Nothing is seen farther off than on the other side of the sky.
            total: certificate.total.min(180.0),
            ..certificate
        }
    }

    fn new(unit: Unit, tolerance: f64, bounds: [f64; 4], counts: Counts) -> Self {
        let [gap, curvature, rounding, total] = bounds;
        let total = total * UP;
        // Some triangle there has to be, whatever overflowed on the way to their number.
        let minimum_triangles = match counts.minimum_triangles.is_nan() {
            true => 1.0,
            false => finite(counts.minimum_triangles),
        };
        Self {
            unit,
            tolerance: finite(tolerance),
            gap: finite(gap),
            curvature: finite(curvature),
            rounding: finite(rounding),
            total: finite(total),
            complete: total <= tolerance && total.is_finite(),
            triangles_in: counts.triangles_in,
            triangles_out: counts.triangles_out,
            minimum_triangles,
            ratio: finite(counts.triangles_out as f64 / minimum_triangles),
        }
    }
}

fn name<S: Serializer>(unit: &Unit, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(unit)
}

/// A number that a file can say: JSON has no infinity, and instead of one `null` would be read. What is beyond `f64`, or
/// unknown, is the largest there is; a certificate with such a bound is not complete.
fn finite(number: f64) -> f64 {
    if number.is_nan() {
        return f64::MAX;
    }
    number.clamp(-f64::MAX, f64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_of_a_certificate_is_null() {
        let hard = [0.0, 1.0, 1e308, f64::MAX, f64::INFINITY, f64::NAN];
        for gap in hard {
            for minimum_triangles in hard {
                let bounds = Bounds {
                    gap,
                    deviation: 0.0,
                    curvature: 1.0,
                    rounding: 1e308,
                };
                let counts = Counts {
                    triangles_in: 1,
                    triangles_out: 1,
                    minimum_triangles,
                };
                let certificate = Certificate::of_lengths(f64::MAX, bounds, counts);
                let text = serde_json::to_string(&certificate).unwrap();
                assert!(!text.contains("null"), "{text}");
                let sum = gap + 1.0 + 1e308;
                assert_eq!(
                    certificate.complete,
                    sum.is_finite() && sum * UP <= f64::MAX
                );
                assert!(certificate.gap >= gap || gap.is_nan() || gap.is_infinite());
            }
        }
    }
}
