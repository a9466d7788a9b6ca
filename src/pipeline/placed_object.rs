//! Objects in their rest frames, and the shapes that some of them are.

use glam::DAffine3;
use rayon::prelude::*;

use crate::material::Part;
use crate::mesh::Mesh;
use crate::scene::{Object, Source};
use crate::shape::{Appearance, Shape};

/// A shape of more facets than it may have is tried with so much larger ones, and again.
const COARSER: f64 = 1.1;

/// An object's parts in its rest frame.
#[derive(Clone, Debug)]
pub(super) struct PlacedObject {
    /// Each with its name in files.
    pub(super) parts: Vec<(String, Part)>,
    /// Where they are those of a shape.
    pub(super) shaped: Option<Shaped>,
    /// Aim at this many times the tolerance.
    pub(super) loosening: f64,
    /// How many triangles stay, whatever a budget says: those of meshes, or of the coarsest form of a shape.
    pub(super) source_triangles: u64,
    /// How many triangles there may be, if there is a limit.
    pub(super) granted: Option<Granted>,
}

/// A shape, to be made as fine as its tolerance asks for.
#[derive(Clone, Debug)]
pub(super) struct Shaped {
    pub(super) shape: Shape,
    pub(super) appearance: Appearance,
    pub(super) model_to_rest: DAffine3,
    pub(super) largest_scale: f64,
    /// Of its facets as they were placed, from the curved surface, at rest.
    pub(super) deviation: f64,
}

/// How many triangles an object may have beyond those of its source.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Granted {
    /// At each step.
    pub(super) steps: Vec<u64>,
    /// Of one mesh for all steps.
    pub(super) together: u64,
}

impl PlacedObject {
    /// How many more there may be at a step.
    pub(super) fn granted(&self, step: usize) -> u64 {
        let granted = self.granted.as_ref();
        granted.map_or(u64::MAX, |granted| granted.steps[step])
    }

    /// How many more there may be where all steps share one mesh.
    pub(super) fn granted_together(&self) -> u64 {
        self.granted
            .as_ref()
            .map_or(u64::MAX, |granted| granted.together)
    }

    /// A sample of about `most` triangles where there are more, and for each part of how many each is a sample.
    pub(super) fn sketch(&self, most: usize) -> Option<(Self, Vec<f64>)> {
        let count = |part: &Part| part.mesh().triangles().len();
        let all: usize = self.parts.iter().map(|(_, part)| count(part)).sum();
        if all <= most || self.shaped.is_some() {
            return None;
        }
        let share = most as f64 / all as f64;
        let parts = self.parts.iter().map(|(name, part)| {
            let triangles = part.mesh().triangles();
            let sampled = (triangles.len() as f64 * share).ceil() as usize;
            let weight = triangles.len() as f64 / sampled as f64;
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
            granted: None,
        };
        Some((sketch, weights))
    }
}

impl Shaped {
    pub(super) fn of(object: &Object) -> Option<Self> {
        match &object.source {
            Source::Shape(shape, appearance) => Some(Self {
                shape: shape.clone(),
                appearance: *appearance,
                model_to_rest: object.model_to_rest(),
                largest_scale: object.scale.largest(),
                deviation: shape.deviation() * object.scale.largest(),
            }),
            _ => None,
        }
    }

    /// Of how many triangles its coarsest form is made; `parts` are those of any.
    pub(super) fn min_triangles(&self, parts: &[(String, Part)]) -> u64 {
        let coarsest = self.shape.within(f64::INFINITY);
        if coarsest == self.shape {
            triangle_count(parts)
        } else if coarsest.deviation() > 0.0 {
            coarsest.triangle_count()
        } else {
            triangle_count(&self.parts_like(&coarsest, parts))
        }
    }

    /// The shape with the coarsest facets that are not farther off than `deviation` at rest, or the finest ones that are
    /// not more than `most`; the coarsest of all where that are more.
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
        let model = shape
            .model(&self.appearance)
            .expect("coarser than what a shape may have");
        let made = parts
            .iter()
            .zip(model.parts)
            .map(|((name, part), mut made)| {
                made.material = part.material.clone();
                (name.clone(), made.transformed(&self.model_to_rest))
            });
        made.collect()
    }
}

pub(super) fn triangle_count(parts: &[(String, Part)]) -> u64 {
    let triangles = parts.iter().map(|(_, part)| part.mesh().triangles().len());
    triangles.sum::<usize>() as u64
}

/// So many of `all` indices; fewer than all are spread by multiples of the golden ratio: in step with no pattern of rows.
pub(super) fn spread(all: usize, count: usize) -> impl IndexedParallelIterator<Item = usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    (0..count).into_par_iter().map(move |index| match count {
        _ if count == all => index,
        _ => (((index as f64 * GOLDEN).fract() * all as f64) as usize).min(all - 1),
    })
}

/// So many triangles of a mesh.
fn sample(mesh: &Mesh, triangles: usize) -> Mesh {
    let all = mesh.triangles();
    let corners = spread(all.len(), triangles).flat_map_iter(|index| all[index]);
    let positions: Vec<_> = corners
        .map(|corner| mesh.positions()[corner as usize])
        .collect();
    let indices = (0..positions.len() as u32).step_by(3);
    let sampled = Mesh::new(
        positions,
        indices.map(|i| [i, i + 1, i + 2]).collect::<Vec<_>>(),
    );
    let sampled = sampled.and_then(Mesh::with_flat_normals);
    sampled.expect("finite positions and indices in range, as in the mesh")
}
