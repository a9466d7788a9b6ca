//! The plan of one object at one step: the parts that refinement starts from, and how much it may spend on them.

use std::borrow::Cow;

use rayon::prelude::*;

use super::SurfaceOptions;
use super::curved::predicted_of_curved;
use super::limits::{Limits, StepTolerance};
use super::mapped_mesh::MappedMesh;
use super::placed_object::{PlacedObject, Shaped};
use crate::light_cone::{Extremes, ModelView, View};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::scene::{Attribute, Measure, Tolerance, Unit};
use crate::shape::Shape;
use crate::tessellate::Allowance;

/// The decisions for one object, or what stands for it under its model, at one step: division of the tolerance, resolution of a shape, number of triangles.
///
/// Nothing is refined or certified yet.
pub(super) struct Plan<'a> {
    /// What stands for the object under its model; the object itself where it is `seen`.
    pub(super) placed_object: Cow<'a, PlacedObject>,
    /// The object itself where something else stands for it and positions at rest are wanted.
    pub(super) itself: Option<&'a PlacedObject>,
    /// How the object is shown.
    pub(super) shown: ModelView,
    pub(super) tolerance: StepTolerance,
    /// The shape with the resolution that the tolerance asks for; `None` where the parts stay as they were placed.
    pub(super) shape: Option<Shape>,
    /// The number of triangles allowed beyond those of the source.
    pub(super) granted: u64,
    /// The parts as they were placed, as seen.
    seen: Vec<MappedMesh>,
    /// About how many triangles a round shape takes that is triangulated as an exact surface; `None` of all others.
    pub(super) as_curved: Option<f64>,
}

/// Parts of one object at rest and as seen, before any refinement, and the limits of their errors.
pub(super) struct Draft<'a> {
    /// Each with its name in files.
    pub(super) parts: Cow<'a, [(String, Part)]>,
    /// For each part, in the observer's frame.
    pub(super) seen: Vec<MappedMesh>,
    pub(super) limits: Limits,
}

/// Parts of one object at rest before any refinement, the view of them at one step, and the gap that is allowed.
pub(crate) struct Unrefined<'a> {
    pub(crate) view: View,
    /// Each with its name in files; a shape has the resolution that the tolerance asks for.
    pub(crate) parts: Cow<'a, [(String, Part)]>,
    /// A length in the rest frame, before the factor `gamma beta`.
    pub(crate) allowance: Allowance,
}

impl<'a> Plan<'a> {
    /// Divides the tolerance and chooses the resolution of a shape, with `granted` triangles beyond those of the source.
    pub(super) fn new(
        placed_object: &'a PlacedObject,
        shown: ModelView,
        tolerance: (Tolerance, Measure),
        wanted: SurfaceOptions,
        granted: u64,
    ) -> Self {
        let is_curved = wanted.subdivide && placed_object.curved().is_some();
        Self::with_form(placed_object, shown, tolerance, wanted, granted, is_curved)
    }

    /// The same with facets for a round shape too: all of one resolution.
    pub(super) fn of_facets(
        placed_object: &'a PlacedObject,
        shown: ModelView,
        tolerance: (Tolerance, Measure),
        wanted: SurfaceOptions,
    ) -> Self {
        Self::with_form(placed_object, shown, tolerance, wanted, u64::MAX, false)
    }

    fn with_form(
        placed_object: &'a PlacedObject,
        shown: ModelView,
        tolerance: (Tolerance, Measure),
        wanted: SurfaceOptions,
        granted: u64,
        is_curved: bool,
    ) -> Self {
        let wants_rest = wanted.attributes.contains(Attribute::RestPosition);
        let itself = shown.rest_to_stand_in().filter(|_| wants_rest);
        let itself = itself.map(|_| placed_object);
        let (placed_object, view) = placed_object.stand_in(&shown);
        let seen = seen_parts(&view, &placed_object.parts);
        // An absolute tolerance does not depend on how large the object is seen.
        let is_sampled = tolerance.0.unit() != Unit::Absolute
            && (placed_object.shaped.as_ref()).is_some_and(Shaped::is_sampled);
        let extremes = match &placed_object.shaped {
            Some(shaped) if is_sampled => vec![shaped.extremes(&view)],
            _ => seen.iter().map(|seen| seen.extremes).collect(),
        };
        let tolerance =
            StepTolerance::new(&placed_object, view, tolerance, wanted.precision, &extremes);
        let mut plan = Self {
            placed_object,
            itself,
            shown,
            tolerance,
            shape: None,
            granted,
            seen,
            as_curved: None,
        };
        plan.as_curved = is_curved.then(|| plan.worth_curving()).flatten();
        if plan.as_curved.is_none() {
            plan.take_facets(wanted);
        }
        plan
    }

    /// About how many triangles a round shape takes as an exact surface, if it is to be one. As points it is: facets tell where
    /// the surface is, not where its points are. Otherwise it is if that takes clearly fewer triangles, as each takes about ten
    /// times as long, or if facets do not keep to the limit on triangles.
    fn worth_curving(&self) -> Option<f64> {
        /// Up to this fraction of the facets they are worth the time.
        const WORTH: f64 = 0.75;
        /// More would take minutes and gigabytes, mostly for a tolerance that no number of triangles reaches.
        const MOST: f64 = 4e6;
        let predicted = predicted_of_curved(self)?;
        let is_worth = self.tolerance.measure == Measure::Points || {
            let facets = self.facets_needed();
            self.is_limited_with(facets) || predicted <= WORTH * facets as f64
        };
        (is_worth && predicted <= MOST).then_some(predicted)
    }

    /// Whether a round shape has to be coarser than its tolerance asks for, or has more facets than triangles are granted.
    pub(super) fn is_limited(&self) -> bool {
        self.is_limited_with(self.facets_needed())
    }

    /// The same of a shape that needs so many facets.
    fn is_limited_with(&self, facets: u64) -> bool {
        self.loosening() > 1.0 || facets > self.max_triangles(self.granted)
    }

    /// How many triangles of an exact surface are worth their time: no more than the facets that would do, unless these are no
    /// choice.
    pub(super) fn worth(&self) -> u64 {
        /// So few are made in no time.
        const FEW: u64 = 1_000;
        let facets = self.facets_needed();
        match self.tolerance.measure {
            Measure::Surface if !self.is_limited_with(facets) => facets.max(FEW),
            _ => u64::MAX,
        }
    }

    /// About how many facets a shape takes.
    fn facets_needed(&self) -> u64 {
        /// So many facets as placed tell how many there would be.
        const LOOKS: usize = 500;
        let facets = self.facets(u64::MAX, LOOKS);
        facets.map_or(0, |shape| shape.triangle_count())
    }

    /// How many times as large as that of the scene the tolerance aimed at is.
    pub(super) fn loosening(&self) -> f64 {
        self.placed_object.loosening
    }

    /// Gives a shape, a round one too, facets of one resolution, as the tolerance asks for.
    pub(super) fn take_facets(&mut self, wanted: SurfaceOptions) {
        self.as_curved = None;
        if wanted.subdivide && self.placed_object.curved().is_some() {
            // Facets tell where the surface is, not where its points are.
            self.tolerance.measure = Measure::Surface;
        }
        let Some(shaped) = &self.placed_object.shaped else {
            return;
        };
        let shape = match wanted.subdivide {
            true => self.facets(self.max_triangles(self.granted), usize::MAX),
            false => Some(shaped.shape.clone()),
        };
        let shape = shape.filter(|shape| *shape != shaped.placed);
        let of_shape = shape.as_ref().unwrap_or(&shaped.placed);
        self.tolerance.deviation = of_shape.deviation() * shaped.largest_scale;
        self.shape = shape;
    }

    /// The shape with the facets that the tolerance asks for, or as fine as at most `most` of them are, found by looking at up to
    /// `looks` of those as placed.
    fn facets(&self, most: u64, looks: usize) -> Option<Shape> {
        let shaped = self.placed_object.shaped.as_ref()?;
        let max_deviation = match shaped.deviation {
            // A flat shape has no other distance from itself.
            0.0 => f64::INFINITY,
            _ => {
                let mesh = self.placed_object.parts[0].1.mesh();
                self.tolerance.max_deviation(mesh, &self.seen, looks)
            }
        };
        Some(shaped.within(max_deviation, most))
    }

    /// The extremes, as seen, of the first part as it was placed.
    pub(super) fn extremes_as_placed(&self) -> &Extremes {
        &self.seen[0].extremes
    }

    /// The observer's view of what stands for the object at this step.
    pub(super) fn view(&self) -> &View {
        &self.tolerance.view
    }

    /// The number of triangles, all parts together, that the object may have with `granted` ones beyond its source.
    pub(super) fn max_triangles(&self, granted: u64) -> u64 {
        self.placed_object.source_triangles.saturating_add(granted)
    }

    /// True where refinement is wanted and the object moves: without motion there is no gap to close.
    pub(super) fn refines(&self, wanted: SurfaceOptions) -> bool {
        wanted.subdivide && self.view().relative_velocity().rapidity() > 0.0
    }

    /// The parts that refinement starts from, with the gap that it may leave.
    pub(super) fn unrefined(mut self) -> Unrefined<'a> {
        let Draft { parts, limits, .. } = self.draft();
        Unrefined {
            view: *self.view(),
            parts,
            allowance: limits.allowance,
        }
    }

    /// The meshes of all parts of the object itself before refinement, where something else stands for it and positions at
    /// rest are wanted; a shape has its planned resolution.
    pub(super) fn drafts_of_itself(&self) -> Option<Vec<Mesh>> {
        let itself = self.itself?;
        let meshes = |parts: &[(String, Part)]| {
            let parts = parts.iter();
            parts.map(|(_, part)| part.mesh().clone()).collect()
        };
        Some(match self.shape.as_ref().zip(itself.shaped.as_ref()) {
            Some((shape, shaped)) => meshes(&shaped.parts_like(shape, &itself.parts)),
            None => meshes(&itself.parts),
        })
    }

    /// The parts before refinement; a shape has its planned resolution.
    pub(super) fn draft(&mut self) -> Draft<'a> {
        let Some((shape, shaped)) = self.shape.as_ref().zip(self.placed_object.shaped.as_ref())
        else {
            return self.draft_as_placed(1.0);
        };
        let parts = shaped.parts_like(shape, &self.placed_object.parts);
        let seen = seen_parts(self.view(), &parts);
        Draft {
            limits: self.tolerance.limits(&parts, &seen, 1.0),
            parts: parts.into(),
            seen,
        }
    }

    /// The parts as they were placed, each of whose facets stands for `each` smaller ones.
    pub(super) fn draft_as_placed(&mut self, each: f64) -> Draft<'a> {
        let parts: Cow<'a, [(String, Part)]> = match &self.placed_object {
            Cow::Borrowed(placed_object) => (&placed_object.parts).into(),
            Cow::Owned(placed_object) => placed_object.parts.clone().into(),
        };
        let seen = std::mem::take(&mut self.seen);
        Draft {
            limits: self.tolerance.limits(&parts, &seen, each),
            parts,
            seen,
        }
    }
}

/// Every part at rest mapped into the observer's frame.
pub(super) fn seen_parts(view: &View, parts: &[(String, Part)]) -> Vec<MappedMesh> {
    let parts = parts.par_iter();
    parts
        .map(|(_, part)| MappedMesh::new(view, part.mesh()))
        .collect()
}
