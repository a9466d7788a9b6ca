//! How one object becomes photosurfaces at one step: what is allowed, what that takes, and the doing.

mod predict;
mod together;

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use super::SurfaceOptions;
use super::mapped_mesh::MappedMesh;
use super::placed_object::PlacedObject;
use crate::light_cone::{Extremes, View};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::scene::{Tolerance, Unit};
use crate::shape::Shape;
use crate::spacetime::length;
use crate::tessellate::{
    Allowance, Bounds, Certificate, Counts, Precision, Refined, Singles, largest_gap,
    local_stretch, nearest_point, refine, rounding_bound, survey,
};

pub(super) use predict::Predicted;

/// What part of the tolerance of a curved shape its facets may use; the rest is for the gap between them.
///
/// Facets small enough for the curvature have small gaps already: less would make more facets, more would
/// leave the few near the observer too little.
const CURVATURE_SHARE: f64 = 0.7;

/// What is left of a tolerance for the gap, for the sums of its certificate.
const ROOM: f64 = 0.999;

/// What part of a tolerance the gap gets where curvature and rounding take more than there is; the certificate
/// tells.
const MIN_FOR_GAP: f64 = 0.1;

/// Where an angle is the tolerance of a curved shape, it is one at this part of the shape's size at least: an
/// observer who touches it sees any facet under a large angle.
const NEAREST: f64 = 0.01;

/// And this for one who does not: nearer than that is as good as touching.
const NEAREST_OF_ALL: f64 = 1e-5;

/// Where an angle is the tolerance, no triangle is made smaller than this part of the mesh: where the observer
/// touches a surface, any gap is seen under the same angle.
const MIN_OF_ANGLE: f64 = 1e-6;

/// Where rounding is less than this part of a tolerance, what there is of it beyond the corners of facets goes into
/// [`ROOM`]: ten times as much would.
const LITTLE_ROUNDING: f64 = 1e-4;

/// Round shapes of more facets are not made to predict what refinement will do to them, nor are more looked at.
const FACETS_MADE_TO_PREDICT: u64 = 20_000;

/// How one object is seen at one step, and what its tolerance allows.
pub(super) struct Plan<'a> {
    view: View,
    placed_object: &'a PlacedObject,
    tolerance: Tolerance,
    /// The tolerance as a length; of an angle, at the nearest vertex.
    length: f64,
    /// What to aim at: the tolerance, or a looser one.
    aimed: Tolerance,
    aimed_length: f64,
    /// A shape as fine as the tolerance asks for; `None` where the parts are what they are.
    shape: Option<Shape>,
    /// Of facets from a curved surface, at rest; zero for what is flat.
    deviation: f64,
    /// The parts as they were placed, as seen.
    seen: Vec<MappedMesh>,
    precision: Precision,
    /// The box around all steps where they share one mesh in a file, as morph targets.
    travel: Option<(DVec3, DVec3)>,
    /// How many triangles there may be beyond those of the source.
    granted: u64,
}

/// Parts of the object at rest and as seen, before any refinement, and what is allowed for that.
struct Draft<'a> {
    /// With names in files.
    parts: Cow<'a, [(String, Part)]>,
    seen: Vec<MappedMesh>,
    limits: Limits,
}

/// What a tolerance allows. One for all parts, so that those that share an edge divide it alike.
#[derive(Clone, Copy)]
struct Limits {
    /// Of the photosurface of the facets from that of a curved surface, at most.
    curvature: f64,
    /// What gap is left by curvature and rounding.
    allowance: Allowance,
    /// What gap the whole tolerance would allow.
    whole: Allowance,
    /// What curvature and rounding leave of the length aimed at; negative where they take more.
    left: f64,
    rounding: f64,
}

/// Parts of one object at rest before any refinement, how they are seen at one step, and the gap that is allowed.
pub(crate) struct Unrefined<'a> {
    pub(crate) view: View,
    /// With names in files; those of a shape as fine as the tolerance asks for.
    pub(crate) parts: Cow<'a, [(String, Part)]>,
    /// Before the factor `gamma beta`.
    pub(crate) allowance: Allowance,
}

/// A part of the object, refined and seen.
pub(super) struct Surface<'a> {
    pub(super) name: String,
    /// At rest; that of the placed scene where nothing was refined.
    pub(super) part: Cow<'a, Part>,
    pub(super) seen: MappedMesh,
    /// The box around all parts of the object that share an offset in a file with this one.
    pub(super) around: (DVec3, DVec3),
    pub(super) certificate: Certificate,
}

/// A part of the object that is what it will be, and not yet proven.
struct Unproven<'a> {
    name: String,
    part: Cow<'a, Part>,
    seen: MappedMesh,
    gap: f64,
    counts: Counts,
}

impl<'a> Plan<'a> {
    pub(super) fn new(
        placed_object: &'a PlacedObject,
        view: View,
        tolerance: Tolerance,
        wanted: SurfaceOptions,
        granted: u64,
    ) -> Self {
        let seen = seen_parts(&view, &placed_object.parts);
        let aimed = tolerance.times(placed_object.loosening);
        let mut plan = Self {
            view,
            placed_object,
            tolerance,
            length: length_of(tolerance, &seen),
            aimed,
            aimed_length: length_of(aimed, &seen),
            shape: None,
            deviation: 0.0,
            seen,
            precision: wanted.precision,
            travel: None,
            granted,
        };
        if let Some(shaped) = &placed_object.shaped {
            let mesh = placed_object.parts[0].1.mesh();
            let around = plan.around(&plan.seen);
            let rounding = plan.rounding(mesh, &plan.seen[0].extremes, around, 0.0);
            let target = CURVATURE_SHARE * plan.deviation_allowed(rounding, mesh);
            let shape = match wanted.subdivide {
                true => shaped.within(
                    target,
                    placed_object.source_triangles.saturating_add(granted),
                ),
                false => shaped.shape.clone(),
            };
            plan.deviation = shape.deviation() * shaped.largest_scale;
            plan.shape = Some(shape).filter(|shape| *shape != shaped.shape);
        }
        plan
    }

    /// How the object is seen.
    pub(super) fn view(&self) -> &View {
        &self.view
    }

    /// What refinement starts from.
    pub(super) fn unrefined(mut self) -> Unrefined<'a> {
        let Draft { parts, limits, .. } = self.draft();
        Unrefined {
            view: self.view,
            parts,
            allowance: limits.allowance,
        }
    }

    /// Refines where that is wanted, maps, and proves.
    pub(super) fn carry_out(mut self, wanted: SurfaceOptions) -> Vec<Surface<'a>> {
        let Draft {
            parts,
            seen,
            limits,
        } = self.draft();
        let refining = wanted.subdivide && self.view.relative_velocity().rapidity() > 0.0;
        let refined = match refining {
            true => {
                let meshes: Vec<&Mesh> = parts.iter().map(|(_, part)| part.mesh()).collect();
                let made = self.refine(&meshes, &limits, self.granted);
                made.into_iter().map(Some).collect()
            }
            false => vec![None; parts.len()],
        };
        type Before<'a> = ((String, Cow<'a, Part>), MappedMesh);
        let made = |(((name, part), seen), refined): (Before<'a>, Option<Refined>)| {
            let mesh = part.mesh();
            let Some(refined) = refined else {
                let (gap, counts) = self.survey_of_unrefined(&limits, mesh);
                return Unproven {
                    name,
                    part,
                    seen,
                    gap,
                    counts,
                };
            };
            let seen = if refined.mesh.positions().len() == mesh.positions().len() {
                seen
            } else {
                MappedMesh::new(&self.view, &refined.mesh)
            };
            let counts = Counts {
                triangles_in: mesh.triangles().len(),
                triangles_out: refined.mesh.triangles().len(),
                minimum_triangles: refined.minimum_triangles,
            };
            Unproven {
                name,
                part: Cow::Owned(part.with_mesh(refined.mesh)),
                seen,
                gap: refined.gap,
                counts,
            }
        };
        let parts: Vec<(String, Cow<'a, Part>)> = match parts {
            Cow::Borrowed(parts) => {
                let parts = parts.iter();
                parts
                    .map(|(name, part)| (name.clone(), Cow::Borrowed(part)))
                    .collect()
            }
            Cow::Owned(parts) => {
                let parts = parts.into_iter();
                parts.map(|(name, part)| (name, Cow::Owned(part))).collect()
            }
        };
        let before = parts.into_par_iter().zip(seen);
        let made: Vec<Unproven<'a>> = before.zip(refined).map(made).collect();
        // Refinement reaches beyond the corners that there were.
        let around = self.around(made.iter().map(|made| &made.seen));
        let proven = |made: Unproven<'a>| Surface {
            certificate: self.certificate(
                &limits,
                made.part.mesh(),
                &made.seen,
                around,
                made.gap,
                made.counts,
            ),
            name: made.name,
            part: made.part,
            seen: made.seen,
            around: around.unwrap_or_default(),
        };
        made.into_par_iter().map(proven).collect()
    }

    /// The box whose middle is the offset of all these parts in a file: one for all, so that corners which parts share
    /// are the same numbers in each.
    fn around<'s>(&self, seen: impl IntoIterator<Item = &'s MappedMesh>) -> Option<(DVec3, DVec3)> {
        self.travel.or_else(|| bounds(seen))
    }

    /// Refines the meshes of all parts, within what is granted beyond the triangles of the source.
    fn refine(&self, meshes: &[&Mesh], limits: &Limits, granted: u64) -> Vec<Refined> {
        let most = self.placed_object.source_triangles.saturating_add(granted);
        let before: usize = meshes.iter().map(|mesh| mesh.triangles().len()).sum();
        let more = most.saturating_sub(before as u64);
        let observer = self.view.observer_rest();
        refine(meshes, observer, &limits.allowance, &limits.whole, more)
    }

    /// The certificate of a mesh that stays what it is.
    fn certificate_of_unrefined(
        &self,
        limits: &Limits,
        mesh: &Mesh,
        seen: &MappedMesh,
        around: Option<(DVec3, DVec3)>,
    ) -> Certificate {
        let (gap, counts) = self.survey_of_unrefined(limits, mesh);
        self.certificate(limits, mesh, seen, around, gap, counts)
    }

    /// The largest gap `e` of a mesh that stays what it is, at rest, and its numbers of triangles.
    fn survey_of_unrefined(&self, limits: &Limits, mesh: &Mesh) -> (f64, Counts) {
        let observer = self.view.observer_rest();
        let found = survey(mesh, observer, f64::INFINITY, &limits.whole);
        let counts = Counts {
            triangles_in: mesh.triangles().len(),
            triangles_out: mesh.triangles().len(),
            minimum_triangles: found.minimum_triangles,
        };
        (found.gap, counts)
    }

    /// The certificate of a mesh, refined or not, with the largest gap `e`.
    fn certificate(
        &self,
        limits: &Limits,
        mesh: &Mesh,
        seen: &MappedMesh,
        around: Option<(DVec3, DVec3)>,
        gap: f64,
        counts: Counts,
    ) -> Certificate {
        let bounds = Bounds {
            gap: self.view.relative_velocity().gamma_beta() * gap * (1.0 + 4.0 * f64::EPSILON),
            deviation: self.deviation,
            curvature: limits.curvature,
            rounding: self.rounding(mesh, &seen.extremes, around, 0.0),
        };
        match (self.tolerance.unit(), self.tolerance.number()) {
            (Unit::Degrees, degrees) => {
                Certificate::of_angles(degrees, &self.view, mesh, bounds, counts)
            }
            _ => Certificate::of_lengths(self.length, bounds, counts),
        }
    }

    /// The parts before refinement, those of a shape as fine as it has to be.
    fn draft(&mut self) -> Draft<'a> {
        let Some((shape, shaped)) = self.shape.as_ref().zip(self.placed_object.shaped.as_ref())
        else {
            return self.draft_as_placed(1.0);
        };
        let parts = shaped.parts_like(shape, &self.placed_object.parts);
        let seen = seen_parts(&self.view, &parts);
        Draft {
            limits: self.limits(&parts, &seen, 1.0),
            parts: parts.into(),
            seen,
        }
    }

    /// The parts as they were placed, each of whose facets stands for `each` smaller ones.
    fn draft_as_placed(&mut self, each: f64) -> Draft<'a> {
        let seen = std::mem::take(&mut self.seen);
        Draft {
            limits: self.limits(&self.placed_object.parts, &seen, each),
            parts: (&self.placed_object.parts).into(),
            seen,
        }
    }

    /// What is allowed for these parts, each of whose facets stands for `each` smaller ones.
    fn limits(&self, parts: &[(String, Part)], seen: &[MappedMesh], each: f64) -> Limits {
        let mut curvature = 0.0;
        if self.deviation > 0.0 {
            let mesh = parts[0].1.mesh();
            let stretches = mesh.triangles().par_iter().map(|corners| {
                let positions = corners.map(|corner| mesh.positions()[corner as usize]);
                local_stretch(&self.view, shrunk(positions, each))
            });
            curvature = self.deviation * stretches.reduce(|| 0.0, f64::max);
        }
        let around = self.around(seen);
        let rounding = |bulging: bool| {
            let bulge = match bulging {
                true => {
                    let gaps = parts.iter().map(|(_, part)| self.largest_gap(part.mesh()));
                    self.view.relative_velocity().gamma_beta() * gaps.fold(0.0, f64::max)
                }
                false => 0.0,
            };
            let of_each = seen
                .iter()
                .zip(parts)
                .map(|(seen, (_, part))| self.rounding(part.mesh(), &seen.extremes, around, bulge));
            of_each.fold(0.0, f64::max)
        };
        let of_corners = rounding(false);
        let rounding = match of_corners > LITTLE_ROUNDING * self.aimed_length {
            true => rounding(true),
            false => of_corners,
        };
        let left = self.aimed_length - curvature - rounding;
        Limits {
            allowance: self.allowance(self.aimed, left, curvature, rounding, seen),
            whole: self.allowance(self.tolerance, self.length, 0.0, 0.0, seen),
            curvature,
            left,
            rounding,
        }
    }

    /// What rounding moves vertices by, also those that refinement will add where the photosurface is beyond the flat
    /// triangles between the vertices that there are, by at most `bulge`. `around` is the box around all parts.
    fn rounding(
        &self,
        mesh: &Mesh,
        seen: &Extremes,
        around: Option<(DVec3, DVec3)>,
        bulge: f64,
    ) -> f64 {
        let (center, radius) = ball(mesh);
        let stretch = self.view.stretch_bound(center, radius);
        let in_file = match (self.precision, around) {
            (Precision::Single, Some((low, high))) => Some(Singles {
                extent: high - low + bulge,
                roundings: if self.travel.is_some() { 3.0 } else { 1.0 },
            }),
            _ => None,
        };
        rounding_bound(&self.view, seen, stretch, in_file) + 16.0 * f64::EPSILON * bulge
    }

    fn largest_gap(&self, mesh: &Mesh) -> f64 {
        largest_gap(mesh, self.view.observer_rest())
    }

    /// How far from a curved surface facets may be, at rest, if they were all that a tolerance is used for.
    fn deviation_allowed(&self, rounding: f64, mesh: &Mesh) -> f64 {
        let left = (self.aimed_length - rounding).max(0.5 * self.aimed_length);
        let corners_of = |corners: &[u32; 3]| {
            corners.map(|corner| mesh.positions()[corner as usize] - self.view.observer_rest())
        };
        let touched = || {
            let mut facets = mesh.triangles().iter().map(corners_of);
            facets.any(|offsets| self.nearest(offsets) == DVec3::ZERO)
        };
        let least = match (self.aimed.unit(), self.aimed.number()) {
            (Unit::Degrees, degrees) => {
                let share = if touched() { NEAREST } else { NEAREST_OF_ALL };
                share * diagonal(&self.seen) * degrees.to_radians().sin()
            }
            _ => 0.0,
        };
        let allowed = |corners: &[u32; 3]| {
            let positions = corners.map(|corner| mesh.positions()[corner as usize]);
            let here = match (self.aimed.unit(), self.aimed.number()) {
                (Unit::Degrees, degrees) => {
                    let nearest = self.view.seen_distance(self.nearest(corners_of(corners)));
                    // The facets that this leads to are other ones: a little room for their distances.
                    (0.9 * degrees.to_radians().sin() * nearest).max(least)
                }
                _ => left,
            };
            here / local_stretch(&self.view, positions)
        };
        let all = mesh.triangles().par_iter().map(allowed);
        all.reduce(|| f64::INFINITY, f64::min)
    }

    /// The place of a facet nearest to the observer, or one nearer than any of the curved surface that it stands for.
    fn nearest(&self, offsets: [DVec3; 3]) -> DVec3 {
        let nearest = nearest_point(offsets);
        let deviation = (self.placed_object.shaped.as_ref()).map_or(0.0, |shaped| shaped.deviation);
        nearest * (1.0 - deviation / nearest.length()).max(0.0)
    }

    /// The gap `e` that a tolerance allows when `curvature` and `rounding` leave `left` of its length.
    fn allowance(
        &self,
        tolerance: Tolerance,
        left: f64,
        curvature: f64,
        rounding: f64,
        seen: &[MappedMesh],
    ) -> Allowance {
        let velocity = self.view.relative_velocity();
        let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
        match (tolerance.unit(), tolerance.number()) {
            (Unit::Degrees, degrees) => {
                // (gamma beta e + rounding) / (distance - gamma e - rounding) <= s, solved for e. What curvature takes
                // goes with the distance.
                let s = degrees.to_radians().sin();
                let left = if curvature > 0.0 {
                    (1.0 - CURVATURE_SHARE * (1.0 + s)).max(MIN_FOR_GAP)
                } else {
                    1.0
                };
                let share = ROOM / (gamma_beta + gamma * s);
                Allowance::Angle {
                    view: self.view,
                    share: s * left * share,
                    less: (1.0 + s) * rounding * share,
                    least: MIN_OF_ANGLE * diagonal(seen) * s * share,
                }
            }
            _ => {
                let least = MIN_FOR_GAP * length_of(tolerance, seen);
                Allowance::Everywhere(ROOM * left.max(least) / gamma_beta)
            }
        }
    }
}

/// A tolerance as a length; an angle at the nearest vertex.
fn length_of(tolerance: Tolerance, seen: &[MappedMesh]) -> f64 {
    match (tolerance.unit(), tolerance.number()) {
        (Unit::Absolute, length) => length,
        (Unit::Relative, fraction) => fraction * diagonal(seen),
        (Unit::Degrees, degrees) => {
            let distances = seen.iter().map(|seen| seen.extremes.nearest);
            let nearest = distances.fold(f64::INFINITY, f64::min);
            degrees.to_radians().sin() * nearest.max(NEAREST * diagonal(seen))
        }
    }
}

/// Of the box around what is seen.
fn diagonal(seen: &[MappedMesh]) -> f64 {
    bounds(seen).map_or(0.0, |(low, high)| length(high - low))
}

fn seen_parts(view: &View, parts: &[(String, Part)]) -> Vec<MappedMesh> {
    let parts = parts.par_iter();
    parts
        .map(|(_, part)| MappedMesh::new(view, part.mesh()))
        .collect()
}

/// One of `parts` equal triangles that a triangle is made of, in its middle.
fn shrunk(corners: [DVec3; 3], parts: f64) -> [DVec3; 3] {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    corners.map(|corner| middle + (corner - middle) / parts.sqrt())
}

/// The box around what is seen.
fn bounds<'s>(seen: impl IntoIterator<Item = &'s MappedMesh>) -> Option<(DVec3, DVec3)> {
    let boxes = seen.into_iter().filter_map(|seen| seen.extremes.bounds());
    boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
}

/// A ball around a mesh.
fn ball(mesh: &Mesh) -> (DVec3, f64) {
    let (low, high) = mesh.bounds().unwrap_or_default();
    // Rounded up: the corners of the box are in it.
    (
        0.5 * low + 0.5 * high,
        0.5 * length(high - low) * (1.0 + 1e-12),
    )
}
