//! The certificate: a proven bound on the distance between a mesh and the true photosurface.

use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::minimum::MINIMUM_ERROR;
use super::stretch::local_stretch;
use super::{nearest_point, triangle_gap};
use crate::light_cone::{Extremes, View};
use crate::mesh::Mesh;
use crate::scene::{Measure, Unit};

/// Room for the rounding errors of a short product of bounds.
const UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A proven bound on the distance between a mesh and the true photosurface, with its parts.
///
/// Lengths are in the observer's frame; where the tolerance is an angle, `tolerance`, `gap`, `surface_gap`,
/// `curvature`, `rounding` and `total` are angles seen by the observer, in degrees.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Certificate {
    /// Unit of the tolerance and of all bounds: a length in the observer's frame, or degrees.
    #[serde(serialize_with = "name")]
    #[schemars(with = "String", extend("enum" = ["length", "fraction", "degrees"]))]
    pub unit: Unit,
    /// The tolerance that was asked for.
    pub tolerance: f64,
    /// The measure that was asked for: which of the two gaps the total contains and the tolerance limits.
    pub measure: Measure,
    /// Proven bound on the distance between a point of a mapped flat triangle and the place where the same point of the
    /// flat triangle at rest is seen; of a round shape without a resolution the place where the point of its true surface
    /// with the same coordinates is seen.
    pub gap: f64,
    /// Proven bound on the distance between the mapped flat triangles and the photosurface of the flat triangles at
    /// rest, as surfaces: from each point of one to the nearest point of the other; of a round shape without a resolution the
    /// photosurface of its true surface. Never more than `gap`.
    pub surface_gap: f64,
    /// Proven bound on the distance between the photosurface of the triangles at rest and that of the curved surface
    /// that they stand for; zero where `gap` is about the curved surface itself.
    pub curvature: f64,
    /// Proven bound on the distance that rounding adds, in the computation and in the numbers of the file.
    pub rounding: f64,
    /// Sum of the gap of the measure, the curvature and the rounding.
    pub total: f64,
    /// Whether the total is within the tolerance.
    pub complete: bool,
    /// Number of triangles of the mesh at rest; of a round shape without a resolution those of its coarsest form.
    pub triangles_in: usize,
    /// Number of triangles of the photosurface.
    pub triangles_out: usize,
    /// The fewest triangles with vertices on the photosurface with which the gap of the measure can be within the
    /// tolerance, for a small tolerance, whatever the triangles of the source: an integral over the photosurface. Edges,
    /// rims and creases are not counted; where nothing bends, the number is 0. Of a round shape without a resolution: with
    /// corners on its true surface.
    pub minimum_triangles: f64,
    /// The same with at least one triangle for each triangle of the source, and as many as the pieces into which its
    /// sides have to be divided ask for.
    pub minimum_with_source: f64,
    /// Relative numerical error of both minima, at most.
    pub minimum_error: f64,
    /// The ratio `triangles_out / minimum_with_source`.
    pub ratio: f64,
}

/// The precision of the positions in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Precision {
    /// `f32`, relative to an offset in the middle of the mesh, as in glTF.
    #[default]
    Single,
    /// `f64`, as in PLY.
    Double,
}

/// An upper bound on the distance, in the observer's frame, by which rounding moves any vertex of a mesh.
///
/// # Derivation
///
/// The position in the rest frame has an error of a few units in the last place of the coordinates from which it is
/// computed: the object's position, the terms whose sum is the observer's position, and the interpolation of new
/// vertices. This error is at most 8 epsilon of their size, and the map stretches it by at most `stretch`. The map
/// itself adds at most 16 epsilon of the seen distance. A composed velocity is known to its last digit; its error moves
/// the vertex by at most 4 epsilon of `stretch r`, with `r` the distance in the rest frame. In a file with `f32` each
/// coordinate is rounded relative to the offset; it is at most half the extent plus a thirty-second of the largest
/// extent. A morph target adds a difference that is at most twice as large, so that a coordinate is rounded three
/// times.
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

/// Positions that a file stores as `f32`, relative to an offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singles {
    /// Extent of all positions with the same offset, in the observer's frame.
    pub(crate) extent: DVec3,
    /// How many times each position is rounded.
    pub(crate) roundings: f64,
}

/// The bounds that a certificate adds up: lengths in the observer's frame, unless stated otherwise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// The largest `gamma beta e` of the mesh's triangles.
    pub(crate) gap: f64,
    /// The same as surfaces.
    pub(crate) surface_gap: f64,
    /// Bound on the distance of the facets from the curved surface, in the rest frame.
    pub(crate) deviation: f64,
    /// Bound on the same distance on the photosurface, in the observer's frame.
    pub(crate) curvature: f64,
    /// The result of [`rounding_bound`].
    pub(crate) rounding: f64,
}

/// Numbers of triangles before and after refinement, and the fewest that theory allows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts {
    pub(crate) triangles_in: usize,
    pub(crate) triangles_out: usize,
    pub(crate) minimum_triangles: f64,
    pub(crate) minimum_with_source: f64,
}

impl Certificate {
    /// A certificate whose tolerance and bounds are lengths in the observer's frame.
    pub(crate) fn of_lengths(
        tolerance: f64,
        measure: Measure,
        bounds: Bounds,
        counts: Counts,
    ) -> Self {
        let gap = match measure {
            Measure::Points => bounds.gap,
            Measure::Surface => bounds.surface_gap,
        };
        let total = gap + bounds.curvature + bounds.rounding;
        let of_surface = bounds.surface_gap;
        Self::new(
            Unit::Absolute,
            tolerance,
            measure,
            [
                bounds.gap,
                of_surface,
                bounds.curvature,
                bounds.rounding,
                total,
            ],
            counts,
        )
    }

    /// A certificate whose tolerance and bounds are angles seen by the observer, in degrees.
    ///
    /// A point that is displaced by a length is seen displaced by an angle of at most `asin(length / distance)`, where
    /// the distance is that of the nearer of its two positions. On a triangle this distance is at least the smallest
    /// seen distance of a corner minus `gamma e`, minus the bounds of curvature and rounding. As a bound on the angle
    /// between the surfaces this is that between points.
    pub(crate) fn of_angles(
        degrees: f64,
        measure: Measure,
        view: &View,
        rest: &Mesh,
        bounds: Bounds,
        counts: Counts,
    ) -> Self {
        let velocity = view.relative_velocity();
        let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
        let (places, triangles) = rest.facets();
        let sines = triangles.par_iter().map(|corners| {
            let positions = corners.map(|corner| places.at(corner));
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
                    // A length of zero is seen under an angle of zero at any distance: a flat shape has no curvature.
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
        let [gap, curvature, rounding, total] = sines.map(angle);
        let bounds = [gap, gap, curvature, rounding, total];
        let certificate = Self::new(Unit::Degrees, degrees, measure, bounds, counts);
        Self {
            // No displacement on the sky is larger than 180 degrees.
            total: certificate.total.min(180.0),
            ..certificate
        }
    }

    /// The same for triangles as `seen`, each with two bounds on its distance from the photosurface, as surfaces and between
    /// points: lengths in the observer's frame.
    pub(crate) fn of_seen_angles(
        degrees: f64,
        measure: Measure,
        seen: &Mesh,
        bounds: &[[f64; 2]],
        rounding: f64,
        counts: Counts,
    ) -> Self {
        let of_each = bounds.par_iter().enumerate().map(|(index, bounds)| {
            let [of_surface, of_points] = *bounds;
            let measured = match measure {
                Measure::Points => of_points,
                Measure::Surface => of_surface,
            };
            let nearest = nearest_point(seen.corners_of(index)).length() * (1.0 - 1e-12);
            // A place of the file is away from the photosurface by a gap and by its rounding.
            let angle = |length: f64, gap: f64| angle_of(length, nearest - gap - rounding);
            [
                angle(of_points, of_points),
                angle(of_surface, of_surface),
                angle(rounding, measured),
                angle(measured + rounding, measured),
            ]
        });
        let larger = |a: [f64; 4], b: [f64; 4]| [0, 1, 2, 3].map(|k| a[k].max(b[k]));
        let [gap, surface_gap, rounding, total] = of_each.reduce(|| [0.0; 4], larger);
        let bounds = [gap, surface_gap, 0.0, rounding, total.min(180.0)];
        Self::new(Unit::Degrees, degrees, measure, bounds, counts)
    }

    /// The bound of the gap that the tolerance limits.
    pub fn measured_gap(&self) -> f64 {
        match self.measure {
            Measure::Points => self.gap,
            Measure::Surface => self.surface_gap,
        }
    }

    fn new(unit: Unit, tolerance: f64, measure: Measure, bounds: [f64; 5], counts: Counts) -> Self {
        let [gap, surface_gap, curvature, rounding, total] = bounds;
        let total = total * UP;
        // A computation that overflowed tells nothing.
        let fewest = |number: f64, at_least: f64| match number.is_nan() {
            true => at_least,
            false => finite(number),
        };
        let minimum_with_source = fewest(counts.minimum_with_source, 1.0);
        Self {
            unit,
            tolerance: finite(tolerance),
            measure,
            gap: finite(gap),
            surface_gap: finite(surface_gap),
            curvature: finite(curvature),
            rounding: finite(rounding),
            total: finite(total),
            complete: total <= tolerance && total.is_finite(),
            triangles_in: counts.triangles_in,
            triangles_out: counts.triangles_out,
            minimum_triangles: fewest(counts.minimum_triangles, 0.0),
            minimum_with_source,
            minimum_error: MINIMUM_ERROR,
            ratio: finite(counts.triangles_out as f64 / minimum_with_source),
        }
    }
}

/// The largest angle, in degrees, by which a displacement by a length is seen if both places are at least `nearest` away.
fn angle_of(length: f64, nearest: f64) -> f64 {
    match length {
        0.0 => 0.0,
        _ if length <= nearest => (length / nearest).asin().to_degrees() * UP,
        _ => 180.0,
    }
}

fn name<S: Serializer>(unit: &Unit, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(unit)
}

/// The number, or the largest `f64` in place of infinity or NaN. JSON has no infinity, and readers would find `null`
/// instead. A certificate with such a bound is not complete.
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
    fn no_part_of_seen_angles_is_larger_than_their_total() {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        let seen = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let counts = Counts {
            triangles_in: 1,
            triangles_out: 1,
            minimum_triangles: 1.0,
            minimum_with_source: 1.0,
        };
        let lengths = [0.0, 1e-13, 1e-6, 0.01, 0.2, 0.3, 10.0];
        for of_points in lengths {
            for of_surface in lengths.into_iter().filter(|&length| length <= of_points) {
                for rounding in lengths {
                    for measure in [Measure::Points, Measure::Surface] {
                        let certificate = Certificate::of_seen_angles(
                            1.0,
                            measure,
                            &seen,
                            &[[of_surface, of_points]],
                            rounding,
                            counts,
                        );
                        let parts = [certificate.measured_gap(), certificate.rounding];
                        assert!(
                            parts.iter().all(|&part| part <= certificate.total),
                            "{certificate:?}"
                        );
                        assert!(certificate.surface_gap <= certificate.gap);
                    }
                }
            }
        }
    }

    #[test]
    fn no_number_of_a_certificate_is_null() {
        let hard = [0.0, 1.0, 1e308, f64::MAX, f64::INFINITY, f64::NAN];
        for gap in hard {
            for minimum_triangles in hard {
                let bounds = Bounds {
                    gap,
                    surface_gap: gap,
                    deviation: 0.0,
                    curvature: 1.0,
                    rounding: 1e308,
                };
                let counts = Counts {
                    triangles_in: 1,
                    triangles_out: 1,
                    minimum_triangles,
                    minimum_with_source: minimum_triangles,
                };
                let certificate =
                    Certificate::of_lengths(f64::MAX, Measure::Points, bounds, counts);
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
