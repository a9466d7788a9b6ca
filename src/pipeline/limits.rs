//! The errors that the tolerance of one object allows at one step: its shares for curvature, rounding and gap.
//!
//! All lengths are in the unit of the scene. The tolerance, curvature and rounding are lengths in the observer's frame;
//! the deviation of facets from a curved surface, and the gap `e` of an [`Allowance`], are lengths in the object's rest
//! frame. A certificate adds up, in the observer's frame, `gamma beta e`, curvature and rounding.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::mapped_mesh::MappedMesh;
use super::placed_object::PlacedObject;
use crate::light_cone::{Extremes, View};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::scene::{Measure, Tolerance, Unit};
use crate::shape::Shape;
use crate::spacetime::length;
use crate::tessellate::{
    About, Allowance, Allowed, Motion, Precision, Sight, Singles, largest_gap, largest_stretch,
    local_stretch, nearest_point, needed, rounding_bound,
};

/// The fraction of a curved shape's tolerance that its facets may take by their distance from the curved surface; the
/// rest is for the gap.
///
/// Facets small enough for the curvature have small gaps already: a smaller fraction would make more facets, a larger
/// one would leave too little for the gap of the few facets near the observer.
const CURVATURE_SHARE: f64 = 0.7;

/// The factor on the gap's share of a tolerance; the missing thousandth is room for the roundings in the sums of a
/// certificate.
const ROOM: f64 = 0.999;

/// The fraction of a tolerance that the gap gets where curvature and rounding take more than the whole; the certificate
/// then says that the tolerance is exceeded.
pub(super) const MIN_GAP_SHARE: f64 = 0.1;

/// The smallest seen distance at which a tolerance in degrees becomes a length in the observer's frame, as a fraction of
/// the diagonal of the object as seen. An observer who touches a curved shape sees every facet under a large angle.
const MIN_DISTANCE: f64 = 0.01;

/// The same fraction for the facets of a curved shape that the observer does not touch: a smaller distance is as good
/// as touching.
const MIN_DISTANCE_UNTOUCHED: f64 = 1e-5;

/// The same fraction for the gap: where the observer touches a surface, every gap is seen under the same angle, and
/// without a smallest distance triangles would be divided without end.
const MIN_DISTANCE_OF_GAP: f64 = 1e-6;

/// The rounding at corners, as a fraction of the tolerance aimed at, up to which the rounding of vertices that
/// refinement adds is not computed: even ten times as much would fit into [`ROOM`].
const LITTLE_ROUNDING: f64 = 1e-4;

/// The rounding to `f32`, as a fraction of the tolerance aimed at, up to which round shapes leave room for it in files of
/// all formats, so that all hold the same mesh.
const SHARED_ROUNDING: f64 = 1e-2;

/// The tolerance of one object at one step, with all that decides how it is divided.
pub(super) struct StepTolerance {
    pub(super) view: View,
    /// The tolerance of the scene: certificates are about it.
    pub(super) tolerance: Tolerance,
    /// Which distance the tolerance limits.
    pub(super) measure: Measure,
    /// The same as a length in the observer's frame; an angle at the nearest vertex.
    pub(super) length: f64,
    /// The tolerance that refinement aims at: that of the scene, or a looser one where triangles are limited.
    pub(super) aimed: Tolerance,
    /// The same as a length in the observer's frame; an angle at the nearest vertex.
    pub(super) aimed_length: f64,
    /// The largest distance of facets from their curved surface, a length at rest; zero for a flat object.
    pub(super) deviation: f64,
    /// The same distance for the shape as it was placed, whatever resolution it gets.
    placed_deviation: f64,
    /// The digits of the numbers in the file.
    precision: Precision,
    /// A round shape whose resolution follows from the tolerance, and the way from its own frame to that of the parts.
    exact: Option<(Shape, DAffine3)>,
    /// Low and high corner, in the observer's frame, of the box around all steps, where all steps share one mesh in a
    /// file as morph targets.
    pub(super) box_of_all_steps: Option<(DVec3, DVec3)>,
}

/// Which of two tolerances.
#[derive(Clone, Copy)]
pub(super) enum Aim {
    /// That of the scene.
    Scene,
    /// A looser one where triangles are limited.
    Loosened,
}

/// The division of a tolerance: one for all parts of an object, so that parts that share an edge divide it alike.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// A bound of the distance between the photosurfaces of the facets and of their curved surface, a length in the
    /// observer's frame.
    pub(super) curvature: f64,
    /// A bound of the rounding of every vertex, a length in the observer's frame.
    pub(super) rounding: f64,
    /// The length aimed at minus curvature and rounding, in the observer's frame; negative where these take more.
    pub(super) left: f64,
    /// The gap `e` at rest that curvature and rounding leave of the tolerance aimed at.
    pub(super) allowance: Allowance,
    /// The gap `e` at rest that the whole tolerance of the scene would allow.
    pub(super) whole: Allowance,
}

impl StepTolerance {
    /// The tolerance of an object whose parts are seen with these extremes; its facets are taken for flat until `deviation`
    /// is set.
    pub(super) fn new(
        placed_object: &PlacedObject,
        view: View,
        (tolerance, measure): (Tolerance, Measure),
        precision: Precision,
        seen: &[Extremes],
    ) -> Self {
        let shaped = placed_object.shaped.as_ref();
        let aimed = tolerance.times(placed_object.loosening);
        Self {
            view,
            tolerance,
            measure,
            length: length_of(tolerance, seen),
            aimed,
            aimed_length: length_of(aimed, seen),
            deviation: 0.0,
            placed_deviation: shaped.map_or(0.0, |shaped| shaped.deviation)
                * view.elongation().max(1.0),
            precision,
            exact: shaped
                .filter(|shaped| shaped.shape.is_curved())
                .map(|shaped| (shaped.shape.clone(), shaped.to_frame())),
            box_of_all_steps: None,
        }
    }

    /// What the measure asks of the triangles of a round shape.
    pub(super) fn about(&self) -> About {
        match self.measure {
            Measure::Points => About::Points,
            Measure::Surface => About::Surface,
        }
    }

    /// The observer's motion, where the tolerance limits the distance of flat facets as surfaces.
    pub(super) fn motion(&self) -> Option<Motion> {
        let velocity = self.view.relative_velocity();
        let is_of_surface =
            self.measure == Measure::Surface && self.exact.is_none() && velocity.rapidity() > 0.0;
        is_of_surface.then(|| Motion::new(velocity))
    }

    /// The fewest triangles by theory for the tolerance of the scene, with corners on the true surface of a round shape
    /// whose resolution follows from the tolerance; `None` of any other object. `nearest` is the smallest seen distance.
    pub(super) fn least_of_round(&self, nearest: f64) -> Option<f64> {
        let (shape, to_frame) = self.exact.as_ref()?;
        let to_offset = DAffine3::from_translation(-self.view.observer_rest()) * *to_frame;
        let allowed = match (self.tolerance.unit(), self.tolerance.number()) {
            (Unit::Degrees, degrees) => {
                let sine = degrees.to_radians().sin();
                let share = sine / (1.0 + sine);
                let least = share * nearest.max(MIN_DISTANCE_UNTOUCHED * self.length / sine);
                Allowed::Share {
                    share,
                    less: 0.0,
                    least,
                }
            }
            _ => Allowed::Length(self.length),
        };
        let sight = Sight::new(&self.view.relative_velocity(), to_offset, allowed);
        Some(needed(shape, &sight, self.about()).least)
    }

    /// The limits of these parts, each of whose facets stands for `each` smaller ones.
    pub(super) fn limits(
        &self,
        parts: &[(String, Part)],
        seen: &[MappedMesh],
        each: f64,
    ) -> Limits {
        let mut curvature = 0.0;
        if self.deviation > 0.0 {
            let mesh = parts[0].1.mesh();
            let facet = |index| shrunk(mesh.corners_of(index), each);
            let count = mesh.triangles().len();
            curvature = self.deviation * largest_stretch(&self.view, count, facet);
        }
        let rounding = self.rounding_of_all(parts, seen);
        let left = self.aimed_length - curvature - rounding;
        let extremes: Vec<Extremes> = seen.iter().map(|seen| seen.extremes).collect();
        Limits {
            curvature,
            rounding,
            left,
            allowance: self.allowance(self.aimed, left, curvature, rounding, &extremes),
            whole: self.allowance(self.tolerance, self.length, 0.0, 0.0, &extremes),
        }
    }

    /// Low and high corner, in the observer's frame, of the box whose middle is the offset of all these parts in a file:
    /// one for all, so that corners which parts share are the same numbers in each.
    pub(super) fn box_around<'s>(
        &self,
        seen: impl IntoIterator<Item = &'s MappedMesh>,
    ) -> Option<(DVec3, DVec3)> {
        self.box_of_all_steps.or_else(|| bounds(seen))
    }

    /// A bound of the distance, in the observer's frame, by which rounding moves any vertex of a mesh.
    ///
    /// Vertices that refinement will add are included where the photosurface is at most `bulge` beyond the flat
    /// triangles between the vertices of the mesh, a length in the observer's frame. `around` is the box around all
    /// parts.
    pub(super) fn rounding(
        &self,
        mesh: &Mesh,
        seen: &Extremes,
        around: Option<(DVec3, DVec3)>,
        bulge: f64,
    ) -> f64 {
        self.rounding_in(self.precision, mesh, seen, around, bulge)
    }

    /// The same bound for a file with these digits.
    fn rounding_in(
        &self,
        precision: Precision,
        mesh: &Mesh,
        seen: &Extremes,
        around: Option<(DVec3, DVec3)>,
        bulge: f64,
    ) -> f64 {
        let stretch = match self.view.elongation() {
            1.0 => {
                let (center, radius) = ball(mesh);
                self.view.stretch_bound(center, radius)
            }
            // A ball around something so long would reach to where it is not.
            _ => self.view.largest_stretch_at(mesh.positions()),
        };
        let in_file = match (precision, around) {
            (Precision::Single, Some((low, high))) => Some(Singles {
                extent: high - low + bulge,
                roundings: if self.box_of_all_steps.is_some() {
                    3.0
                } else {
                    1.0
                },
            }),
            _ => None,
        };
        rounding_bound(&self.view, seen, stretch, in_file) + 16.0 * f64::EPSILON * bulge
    }

    /// The same bound for all parts, also for vertices that refinement will add where these matter.
    fn rounding_of_all(&self, parts: &[(String, Part)], seen: &[MappedMesh]) -> f64 {
        let around = self.box_around(seen);
        let largest = |bulge: f64| {
            let of_each = seen
                .iter()
                .zip(parts)
                .map(|(seen, (_, part))| self.rounding(part.mesh(), &seen.extremes, around, bulge));
            of_each.fold(0.0, f64::max)
        };
        let of_corners = largest(0.0);
        if of_corners > LITTLE_ROUNDING * self.aimed_length {
            let observer = self.view.observer_rest();
            let gaps = parts
                .iter()
                .map(|(_, part)| largest_gap(part.mesh(), observer));
            largest(self.view.relative_velocity().gamma_beta() * gaps.fold(0.0, f64::max))
        } else {
            of_corners
        }
    }

    /// The largest distance from a curved surface, a length at rest, that the tolerance aimed at allows facets. `mesh` is
    /// the shape as it was placed; `seen` are all parts. Where the mesh has more than `most_looks` facets, so many of them are
    /// looked at.
    pub(super) fn max_deviation(&self, mesh: &Mesh, seen: &[MappedMesh], most_looks: usize) -> f64 {
        let rounding = self.rounding(mesh, &seen[0].extremes, self.box_around(seen), 0.0);
        let left = (self.aimed_length - rounding).max(0.5 * self.aimed_length);
        let all = mesh.triangle_count();
        let count = all.min(most_looks);
        let corners_of = |index: usize| mesh.corners_of(index * (all / count));
        let max_deviation = match (self.aimed.unit(), self.aimed.number()) {
            (Unit::Degrees, degrees) => {
                let nearest = |index| {
                    let corners = corners_of(index);
                    self.nearest(corners.map(|corner| corner - self.view.observer_rest()))
                };
                let share = match (0..count).any(|index| nearest(index) == DVec3::ZERO) {
                    true => MIN_DISTANCE,
                    false => MIN_DISTANCE_UNTOUCHED,
                };
                let extremes: Vec<Extremes> = seen.iter().map(|seen| seen.extremes).collect();
                let min_length = share * diagonal(&extremes) * degrees.to_radians().sin();
                let allowed = (0..count).into_par_iter().map(|index| {
                    let nearest = self.view.seen_distance(nearest(index));
                    // The facets that this leads to are other ones: a little room for their distances.
                    let here = (0.9 * degrees.to_radians().sin() * nearest).max(min_length);
                    here / local_stretch(&self.view, corners_of(index))
                });
                allowed.reduce(|| f64::INFINITY, f64::min)
            }
            _ => left / largest_stretch(&self.view, count, corners_of),
        };
        CURVATURE_SHARE * max_deviation
    }

    /// How far the triangles of a round shape may be from its photosurface: what rounding leaves of the tolerance of the
    /// scene, or of the one aimed at. `mesh` is the shape as it was placed, with these extremes.
    pub(super) fn allowed_of_curved(&self, aim: Aim, mesh: &Mesh, seen: &Extremes) -> Allowed {
        let (tolerance, whole) = match aim {
            Aim::Scene => (self.tolerance, self.length),
            Aim::Loosened => (self.aimed, self.aimed_length),
        };
        // The box around the exact shape is a little larger.
        let around = self.box_of_all_steps.or_else(|| seen.bounds());
        let rounding_in = |precision| 1.01 * self.rounding_in(precision, mesh, seen, around, 0.0);
        let of_singles = rounding_in(Precision::Single);
        let rounding = match of_singles <= SHARED_ROUNDING * whole {
            true => of_singles,
            false => rounding_in(self.precision),
        };
        match (tolerance.unit(), tolerance.number()) {
            (Unit::Degrees, degrees) => {
                // (bound + rounding) / (distance - bound - rounding) <= s, solved for the bound.
                let s = degrees.to_radians().sin();
                Allowed::Share {
                    share: ROOM * s / (1.0 + s),
                    less: rounding,
                    least: s * MIN_DISTANCE_UNTOUCHED * diagonal(std::slice::from_ref(seen)),
                }
            }
            _ => {
                let left = whole - rounding;
                Allowed::Length(ROOM * left.max(MIN_GAP_SHARE * whole))
            }
        }
    }

    /// The smallest distance at which any place of a round shape is seen, or less; `mesh` is the shape as it was placed.
    pub(super) fn nearest_of_curved(&self, mesh: &Mesh) -> f64 {
        let observer = self.view.observer_rest();
        let distances = (0..mesh.triangle_count()).map(|index| {
            let offsets = mesh.corners_of(index).map(|corner| corner - observer);
            self.view.seen_distance(self.nearest(offsets))
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The place of a facet nearest to the observer, or a place nearer than any of the curved surface that the facet
    /// stands for; like the `offsets` of its corners, in the rest frame and relative to the observer.
    pub(super) fn nearest(&self, offsets: [DVec3; 3]) -> DVec3 {
        let nearest = nearest_point(offsets);
        nearest * (1.0 - self.placed_deviation / nearest.length()).max(0.0)
    }

    /// The gap `e` at rest that a tolerance allows when `curvature` and `rounding` leave `left` of its length, all three
    /// in the observer's frame.
    fn allowance(
        &self,
        tolerance: Tolerance,
        left: f64,
        curvature: f64,
        rounding: f64,
        seen: &[Extremes],
    ) -> Allowance {
        let velocity = self.view.relative_velocity();
        let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
        match (tolerance.unit(), tolerance.number()) {
            (Unit::Degrees, degrees) => {
                // (gamma beta e + rounding) / (distance - gamma e - rounding) <= s, solved for e. The share of curvature
                // is in proportion to the distance.
                let s = degrees.to_radians().sin();
                let left = if curvature > 0.0 {
                    (1.0 - CURVATURE_SHARE * (1.0 + s)).max(MIN_GAP_SHARE)
                } else {
                    1.0
                };
                let share = ROOM / (gamma_beta + gamma * s);
                Allowance::Angle {
                    view: self.view,
                    share: s * left * share,
                    less: (1.0 + s) * rounding * share,
                    least: MIN_DISTANCE_OF_GAP * diagonal(seen) * s * share,
                }
            }
            _ => {
                let min_left = MIN_GAP_SHARE * length_of(tolerance, seen);
                Allowance::Everywhere(ROOM * left.max(min_left) / gamma_beta)
            }
        }
    }
}

/// A tolerance as a length in the observer's frame; an angle at the nearest vertex.
fn length_of(tolerance: Tolerance, seen: &[Extremes]) -> f64 {
    match (tolerance.unit(), tolerance.number()) {
        (Unit::Absolute, length) => length,
        (Unit::Relative, fraction) => fraction * diagonal(seen),
        (Unit::Degrees, degrees) => {
            let distances = seen.iter().map(|seen| seen.nearest);
            let nearest = distances.fold(f64::INFINITY, f64::min);
            degrees.to_radians().sin() * nearest.max(MIN_DISTANCE * diagonal(seen))
        }
    }
}

/// Low and high corner of the box around meshes as seen, in the observer's frame.
pub(super) fn bounds<'s>(seen: impl IntoIterator<Item = &'s MappedMesh>) -> Option<(DVec3, DVec3)> {
    box_of(seen.into_iter().map(|seen| &seen.extremes))
}

/// Low and high corner of the box around all that is seen with these extremes, in the observer's frame.
fn box_of<'s>(seen: impl IntoIterator<Item = &'s Extremes>) -> Option<(DVec3, DVec3)> {
    let boxes = seen.into_iter().filter_map(Extremes::bounds);
    boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
}

/// The length of the diagonal of that box.
fn diagonal(seen: &[Extremes]) -> f64 {
    box_of(seen).map_or(0.0, |(low, high)| length(high - low))
}

/// One of `parts` equal triangles that a triangle is made of, in its middle.
pub(super) fn shrunk(corners: [DVec3; 3], parts: f64) -> [DVec3; 3] {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    corners.map(|corner| middle + (corner - middle) / parts.sqrt())
}

/// Center and radius of a ball around a mesh at rest.
fn ball(mesh: &Mesh) -> (DVec3, f64) {
    let (low, high) = mesh.bounds().unwrap_or_default();
    // Rounded up: the corners of the box are in it.
    (
        0.5 * low + 0.5 * high,
        0.5 * length(high - low) * (1.0 + 1e-12),
    )
}
