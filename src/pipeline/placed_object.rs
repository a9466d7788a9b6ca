//! Objects in their rest frames, and the shapes of those that have one.

use std::borrow::Cow;

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::sampler::Sampler;
use super::standing_in::stretched;
use crate::light_cone::{Extremes, ModelView, View};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::scene::{Object, Source};
use crate::shape::Shape;
use crate::spacetime::length;

/// If a shape has more facets than it may have, its allowed deviation is multiplied by this factor until it fits.
const COARSER: f64 = 1.1;

/// An object's parts in its rest frame.
#[derive(Clone, Debug)]
pub(super) struct PlacedObject {
    /// The parts in the rest frame, each with its name in files.
    pub(super) parts: Vec<(String, Part)>,
    /// The shape from which the parts are made; `None` if they come from a file.
    pub(super) shaped: Option<Shaped>,
    /// The aim of the object divided by its tolerance.
    pub(super) loosening: f64,
    /// Number of triangles that are kept whatever the budget: those of the object's meshes, or those of the coarsest
    /// form of its shape.
    pub(super) source_triangles: u64,
    /// How far files move the object, in the observer's frame, so that it stands beside others.
    pub(super) beside: DVec3,
    /// How many triangles refinement may add; `None` if there is no limit.
    pub(super) granted: Option<Granted>,
}

/// A shape, which can be made as fine as its tolerance asks for.
#[derive(Clone, Debug)]
pub(super) struct Shaped {
    /// The shape as the scene has it.
    pub(super) shape: Shape,
    /// The form of the shape that the parts as placed have: the coarsest one if the shape is flat and has no resolution
    /// of its own, otherwise the shape as the scene has it.
    pub(super) placed: Shape,
    model_to_rest: DAffine3,
    /// From the rest frame to that of a stand-in, if the parts are those of one.
    rest_to_stand_in: Option<DAffine3>,
    pub(super) largest_scale: f64,
    /// Bound on the distance between the facets of the placed parts and the curved surface, in the rest frame.
    pub(super) deviation: f64,
}

/// How many triangles an object may have beyond those of its source.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Granted {
    /// The number at each step.
    pub(super) steps: Vec<u64>,
    /// The number if all steps share one mesh.
    pub(super) together: u64,
}

impl PlacedObject {
    /// How many triangles refinement may add at a step.
    pub(super) fn granted(&self, step: usize) -> u64 {
        let granted = self.granted.as_ref();
        granted.map_or(u64::MAX, |granted| granted.steps[step])
    }

    /// How many triangles refinement may add if all steps share one mesh.
    pub(super) fn granted_together(&self) -> u64 {
        self.granted
            .as_ref()
            .map_or(u64::MAX, |granted| granted.together)
    }

    /// Low and high corner of the box around all parts, in the rest frame; `None` if there are no vertices.
    pub(super) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let boxes = self
            .parts
            .iter()
            .filter_map(|(_, part)| part.mesh().bounds());
        boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
    }

    /// What stands for the object under the model of `shown`, and the view of it.
    pub(super) fn stand_in(&self, shown: &ModelView) -> (Cow<'_, Self>, View) {
        let Some(to_stand_in) = shown.rest_to_stand_in() else {
            return (Cow::Borrowed(self), shown.of_stand_in(0.0));
        };
        // Deviations stay those at rest: the stretch of facets counts the elongation.
        let shaped = self.shaped.as_ref().map(|shaped| Shaped {
            rest_to_stand_in: Some(to_stand_in),
            ..shaped.clone()
        });
        let parts = match &shaped {
            Some(shaped) if shaped.is_sampled() => shaped.parts_like(&shaped.placed, &self.parts),
            _ => stretched(&self.parts, &to_stand_in),
        };
        let stand_in = Self {
            parts,
            shaped,
            loosening: self.loosening,
            source_triangles: self.source_triangles,
            beside: self.beside,
            granted: self.granted.clone(),
        };
        let reach = self.reach(shown.view().observer_rest());
        (Cow::Owned(stand_in), shown.of_stand_in(reach))
    }

    /// The largest distance of any vertex from `place_rest`, or somewhat more.
    pub(super) fn reach(&self, place_rest: DVec3) -> f64 {
        let reach = |(low, high): (DVec3, DVec3)| {
            let [low, high] = [low, high].map(|corner| (corner - place_rest).abs());
            length(low.max(high))
        };
        self.bounds().map_or(0.0, reach)
    }

    /// A sample of about `most` triangles, and for each part how many triangles each sampled one stands for. `None` if
    /// the object has no more than `most` triangles or has a shape.
    pub(super) fn sketch(&self, most: usize) -> Option<(Self, Vec<f64>)> {
        let count = |part: &Part| part.mesh().triangle_count();
        let all: usize = self.parts.iter().map(|(_, part)| count(part)).sum();
        if all <= most || self.shaped.is_some() {
            return None;
        }
        let share = most as f64 / all as f64;
        let parts = self.parts.iter().map(|(name, part)| {
            let triangles = count(part);
            let sampled = (triangles as f64 * share).ceil() as usize;
            let weight = triangles as f64 / sampled as f64;
            (
                (name.clone(), part.with_mesh(sample(part.mesh(), sampled))),
                weight,
            )
        });
        let (parts, weights) = parts.unzip();
        let sketch = Self {
            parts,
            shaped: None,
            loosening: self.loosening,
            source_triangles: self.source_triangles,
            beside: self.beside,
            granted: None,
        };
        Some((sketch, weights))
    }
}

impl Shaped {
    pub(super) fn of(object: &Object) -> Option<Self> {
        match &object.source {
            Source::Shape(shape, _) => Some(Self {
                placed: shape.coarsest_flat().unwrap_or_else(|| shape.clone()),
                shape: shape.clone(),
                model_to_rest: object.model_to_rest(),
                rest_to_stand_in: None,
                largest_scale: object.scale.largest(),
                deviation: shape.deviation() * object.scale.largest(),
            }),
            _ => None,
        }
    }

    /// Whether the parts as placed are coarser than the shape as the scene has it, so that places between their corners
    /// tell how large the photosurface is.
    pub(super) fn is_sampled(&self) -> bool {
        self.placed != self.shape
    }

    /// The extremes, as seen, of places all over a shape with flat faces: the vertices of its default resolution.
    pub(super) fn extremes(&self, view: &View) -> Extremes {
        let mut sampler = Sampler::new(view);
        let to_stand_in = self.rest_to_stand_in.unwrap_or(DAffine3::IDENTITY);
        match self.model_to_rest == DAffine3::IDENTITY && to_stand_in == DAffine3::IDENTITY {
            true => self.shape.places_on_faces(|place| sampler.add(place)),
            false => self.shape.places_on_faces(|place| {
                let place = self.model_to_rest.transform_point3(place);
                sampler.add(to_stand_in.transform_point3(place));
            }),
        }
        sampler.found()
    }

    /// Number of triangles of the shape's coarsest form; `parts` are the parts as placed.
    pub(super) fn min_triangles(&self, parts: &[(String, Part)]) -> u64 {
        let coarsest = self.shape.within(f64::INFINITY);
        if self.shape.is_curved() {
            self.shape.coarsest_curved() as u64
        } else if coarsest == self.placed {
            triangle_count(parts)
        } else {
            coarsest.triangle_count()
        }
    }

    /// The shape with the coarsest facets whose distance from the curved surface is at most `deviation`, in the rest
    /// frame. If that shape has more than `most` triangles, the result has the finest facets with at most `most`
    /// triangles, or the coarsest facets if even these are more.
    pub(super) fn within(&self, deviation: f64, most: u64) -> Shape {
        let mut shape = self.shape.within(deviation / self.largest_scale);
        let coarsest = self.shape.within(f64::INFINITY);
        let mut deviation = shape.deviation();
        while shape.triangle_count() > most && deviation < coarsest.deviation() {
            deviation *= COARSER;
            shape = self.shape.within(deviation);
        }
        shape
    }

    /// The parts of the same shape with another resolution; names and materials are those of `parts`.
    pub(super) fn parts_like(
        &self,
        shape: &Shape,
        parts: &[(String, Part)],
    ) -> Vec<(String, Part)> {
        let mesh = shape.mesh().expect("coarser than what a shape may have");
        let parts = parts.iter();
        parts
            .map(|(name, part)| (name.clone(), self.part_of(mesh.clone(), part)))
            .collect()
    }

    /// A mesh of the shape in the frame of the parts, with the material of one of them.
    pub(super) fn part_of(&self, mesh: Mesh, like: &Part) -> Part {
        let made = Part::new("", mesh, like.material.clone());
        let made = made.expect("a material that fitted the same shape");
        made.transformed(&self.to_frame())
    }

    /// From the shape's own frame to that of the parts.
    pub(super) fn to_frame(&self) -> DAffine3 {
        match &self.rest_to_stand_in {
            Some(to_stand_in) => *to_stand_in * self.model_to_rest,
            None => self.model_to_rest,
        }
    }
}

pub(super) fn triangle_count(parts: &[(String, Part)]) -> u64 {
    let triangles = parts.iter().map(|(_, part)| part.mesh().triangle_count());
    triangles.sum::<usize>() as u64
}

/// `count` of the indices below `all`. If they are fewer than `all`, multiples of the golden ratio spread them, so that
/// they do not follow a pattern of rows in the mesh.
pub(super) fn spread(all: usize, count: usize) -> impl IndexedParallelIterator<Item = usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    (0..count).into_par_iter().map(move |index| match count {
        _ if count == all => index,
        _ => (((index as f64 * GOLDEN).fract() * all as f64) as usize).min(all - 1),
    })
}

/// A sample of `triangles` triangles of a mesh.
fn sample(mesh: &Mesh, triangles: usize) -> Mesh {
    let (places, all) = mesh.facets();
    let corners = spread(all.len(), triangles).flat_map_iter(|index| all[index]);
    let positions: Vec<_> = corners.map(|corner| places.at(corner)).collect();
    let indices = (0..positions.len() as u32).step_by(3);
    let sampled = Mesh::new(
        positions,
        indices.map(|i| [i, i + 1, i + 2]).collect::<Vec<_>>(),
    );
    let sampled = sampled.and_then(Mesh::with_flat_normals);
    sampled.expect("finite positions and indices in range, as in the mesh")
}
