//! The pipeline: a scene and its models in, the photosurface of every part at every step out.

mod facts;
mod plan;

use std::collections::HashSet;
use std::sync::Arc;

use glam::{DAffine3, DVec4};
use rayon::prelude::*;

use crate::light_cone::View;
use crate::mesh::{Appearance, Color, Material, Mesh, Model, Part, Shape};
use crate::scene::{Object, Scene, Source};
use crate::spacetime::Velocity;
use crate::tessellate::Precision;
use plan::{Plan, Surface};

pub use facts::{Facts, SceneFacts};

/// Vertices a thread takes at a time: enough to outweigh handing them over.
const VERTICES_PER_JOB: usize = 4096;

/// The observer's marker in files.
const MARKER_NAME: &str = "observer";
const MARKER_RESOLUTION: u32 = 24;

/// A scene with the geometry of its objects, placed in their rest frames: all that photosurfaces need.
///
/// # Example
///
/// ```
/// use photosurface::{Scene, Stage, Wanted, load_models};
///
/// let scene = Scene::from_json(
///     r#"{ "observer": { "velocity": { "beta": 0.8 } },
///          "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] } ] }"#,
/// )?;
/// let (models, _) = load_models(&scene, ".".as_ref())?;
/// let stage = Stage::new(scene, models);
/// let ball = stage.photosurfaces(0, Wanted::default()).next().expect("one object, one photosurface");
/// // Its centre, 5 ahead, is seen exp(atanh(0.8)) = 3 times as far away.
/// let (low, high) = ball.mesh.bounds().expect("a sphere has vertices");
/// assert!(low.z < -15.0 && high.z > -15.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stage {
    scene: Scene,
    marker: Option<Part>,
    /// For every object of the scene.
    objects: Vec<Placed>,
}

/// The photosurface of one part of one object at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Photosurface {
    /// What it is and how it came about.
    pub facts: Facts,
    /// Its geometry in the observer's frame, observer at the origin: the vertices of the part at rest, in
    /// the same order, then those that were added.
    pub mesh: Mesh,
    /// Frequency seen over frequency emitted, at each vertex; only where it was asked for.
    pub doppler_factors: Option<Vec<f64>>,
    /// What it is made of.
    pub material: Option<Arc<Material>>,
}

/// What is wanted of photosurfaces beside their shape, and how much may be spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Frequency seen over frequency emitted, at each vertex.
    pub doppler_factors: bool,
    /// Whether meshes are refined until they are within the tolerance; if not, every vertex stays what it is and
    /// the certificate tells how far off the mesh is.
    pub subdivide: bool,
    /// Aim at this many times the tolerance; certificates are still against the tolerance itself.
    pub loosening: f64,
    /// How many digits the file will have.
    pub precision: Precision,
}

impl Default for Wanted {
    /// Meshes within the tolerance, for glTF, and nothing else.
    fn default() -> Self {
        Self {
            doppler_factors: false,
            subdivide: true,
            loosening: 1.0,
            precision: Precision::Single,
        }
    }
}

/// An object's parts in its rest frame.
#[derive(Clone, Debug)]
struct Placed {
    /// Each with its name in files.
    parts: Vec<(String, Part)>,
    /// Where they are those of a shape.
    shaped: Option<Shaped>,
}

/// A shape, to be made as fine as its tolerance asks for.
#[derive(Clone, Debug)]
struct Shaped {
    shape: Shape,
    appearance: Appearance,
    model_to_rest: DAffine3,
    largest_scale: f64,
}

impl Stage {
    /// Places one model for each object of `scene`, in their order, in the objects' rest frames.
    ///
    /// # Panics
    ///
    /// If there are not as many models as objects.
    pub fn new(scene: Scene, models: Vec<Model>) -> Self {
        assert_eq!(
            scene.objects().len(),
            models.len(),
            "one model for each object"
        );
        let mut names = UniqueNames::default();
        let marker = scene
            .observer()
            .marker
            .map(|radius| marker(&names.unique(MARKER_NAME), radius.get()));
        let mut objects = Vec::with_capacity(models.len());
        for (object, model) in scene.objects().iter().zip(models) {
            let several = model.parts.len() > 1;
            let parts = model.parts.into_iter().map(|part| {
                let name = if several {
                    names.unique(&format!("{}_{}", object.name, part.name))
                } else {
                    names.unique(&object.name)
                };
                (name, part.transformed(&object.model_to_rest()))
            });
            objects.push(Placed {
                parts: parts.collect(),
                shaped: Shaped::of(object),
            });
        }
        Self {
            scene,
            marker,
            objects,
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The small sphere that marks the observer, if the scene has one; it is at rest in the observer's frame.
    pub fn marker(&self) -> Option<&Part> {
        self.marker.as_ref()
    }

    /// Each object with its parts in its rest frame and their names in files, in the order of the scene.
    pub fn objects(&self) -> impl Iterator<Item = (&Object, &[(String, Part)])> {
        self.scene
            .objects()
            .iter()
            .zip(self.objects.iter().map(|placed| placed.parts.as_slice()))
    }

    /// The observer's velocity in the rest frame of an object.
    pub fn relative_velocity(&self, object: &Object) -> Velocity {
        self.view(object, 0.0).relative_velocity()
    }

    /// About how many triangles the photosurfaces of each object will have at one step, in the order of the
    /// scene; known in a fraction of the time that it takes to make them.
    ///
    /// # Panics
    ///
    /// If the scene has no such step.
    pub fn predicted_triangles(&self, step: usize, wanted: Wanted) -> Vec<f64> {
        let objects = self.scene.objects().iter().zip(&self.objects);
        let plans = objects.map(|(object, placed)| self.plan(object, placed, step, wanted));
        plans
            .map(|plan| plan.predicted_triangles(wanted.subdivide))
            .collect()
    }

    /// The photosurfaces of all parts at one step, in the order of the scene.
    ///
    /// # Panics
    ///
    /// If the scene has no such step.
    pub fn photosurfaces(&self, step: usize, wanted: Wanted) -> impl Iterator<Item = Photosurface> {
        let objects = self.scene.objects().iter().zip(&self.objects);
        objects.flat_map(move |(object, placed)| {
            let view = self.view(object, self.scene.steps()[step]);
            let surfaces = self.plan(object, placed, step, wanted).carry_out(wanted);
            surfaces.into_iter().map(move |surface| Photosurface {
                doppler_factors: wanted
                    .doppler_factors
                    .then(|| doppler_factors(&view, surface.part.mesh())),
                material: surface.part.material.clone(),
                facts: self.part_facts(object, &surface, step, &view),
                mesh: surface.seen,
            })
        })
    }

    /// What the scene is, in words and numbers.
    pub fn facts(&self) -> SceneFacts {
        SceneFacts::new(&self.scene)
    }

    fn view(&self, object: &Object, proper_time: f64) -> View {
        View::new(
            &self.scene.observer().world_line(),
            &object.world_line(),
            proper_time,
        )
    }

    fn plan<'a>(
        &'a self,
        object: &Object,
        placed: &'a Placed,
        step: usize,
        wanted: Wanted,
    ) -> Plan<'a> {
        let view = self.view(object, self.scene.steps()[step]);
        Plan::new(placed, view, self.scene.tolerance(object), wanted)
    }

    fn part_facts(&self, object: &Object, surface: &Surface, step: usize, view: &View) -> Facts {
        let steps = self.scene.steps();
        let relative = view.relative_velocity();
        let name = &surface.name;
        Facts {
            name: match steps.len() {
                1 => name.to_owned(),
                _ => format!("{name}_{}", step_label(step)),
            },
            object: object.name.clone(),
            part: surface.part.name.clone(),
            step,
            proper_time: steps[step],
            relative_gamma: relative.gamma(),
            relative_rapidity: relative.rapidity(),
            vertices: surface.seen.positions().len(),
            triangles: surface.seen.triangles().len(),
            condition: condition(view, surface.part.mesh()),
            certificate: surface.certificate.clone(),
        }
    }
}

impl Shaped {
    fn of(object: &Object) -> Option<Self> {
        match &object.source {
            Source::Shape(shape, appearance) => Some(Self {
                shape: shape.clone(),
                appearance: *appearance,
                model_to_rest: object.model_to_rest(),
                largest_scale: object.scale.max_element(),
            }),
            _ => None,
        }
    }

    /// The parts of the same shape with another resolution; names and materials are those of `parts`.
    fn parts_like(&self, shape: &Shape, parts: &[(String, Part)]) -> Vec<(String, Part)> {
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

/// How a step is called in names of files and of things in them: `step003`.
pub fn step_label(step: usize) -> String {
    format!("step{step:03}")
}

/// The mesh as it is seen: every vertex mapped, with its normal and its tangent.
fn seen_mesh(view: &View, rest: &Mesh) -> Mesh {
    let jobs = || rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
    let positions = jobs()
        .map(|&position| view.seen_position(position))
        .collect();
    let normals = rest.normals().map(|normals| {
        let pairs = jobs().zip(normals);
        pairs
            .map(|(&position, &normal)| view.seen_normal(position, normal))
            .collect()
    });
    let tangents = rest.tangents().map(|tangents| {
        let pairs = jobs().zip(tangents);
        // The map never turns orientation round: the bitangent keeps its sign.
        let seen = |(position, tangent): (&_, &DVec4)| {
            view.seen_tangent(*position, tangent.truncate())
                .extend(tangent.w)
        };
        pairs.map(seen).collect()
    });
    rest.with_geometry(positions, normals, tangents)
}

/// The largest stretch at a vertex.
fn condition(view: &View, rest: &Mesh) -> f64 {
    let jobs = rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
    jobs.map(|&position| view.stretch_bound(position, 0.0))
        .reduce(|| 1.0, f64::max)
}

fn doppler_factors(view: &View, rest: &Mesh) -> Vec<f64> {
    let jobs = rest.positions().par_iter().with_min_len(VERTICES_PER_JOB);
    jobs.map(|&position| view.doppler_factor(position))
        .collect()
}

fn marker(name: &str, radius: f64) -> Part {
    let appearance = Appearance {
        color: Color([0xe7, 0x4c, 0x3c]),
        checker: None,
    };
    let mut model = Shape::sphere(radius)
        .and_then(|sphere| sphere.with_resolution(MARKER_RESOLUTION))
        .and_then(|sphere| sphere.model(&appearance))
        .expect("a sphere of a checked radius and a fixed resolution");
    let mut part = model.parts.pop().expect("a sphere is one part");
    part.name = name.to_owned();
    part
}

/// Makes names that are unique and mean the same to every reader: ASCII letters, digits, `_` and `-`.
#[derive(Default)]
struct UniqueNames(HashSet<String>);

impl UniqueNames {
    /// `wanted` with other characters replaced by `_`, and with a number behind it if it was taken.
    fn unique(&mut self, wanted: &str) -> String {
        let plain: String = wanted
            .chars()
            .map(|c| {
                if c.is_ascii_alphanumeric() || c == '-' {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        let mut name = plain.clone();
        let mut number = 1;
        while !self.0.insert(name.clone()) {
            number += 1;
            name = format!("{plain}_{number}");
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_unique() {
        let mut names = UniqueNames::default();
        let made: Vec<_> = ["a b", "a.b", "a_b_2", "a_b", "Großes Rad", "-"]
            .iter()
            .map(|n| names.unique(n))
            .collect();
        assert_eq!(
            made,
            ["a_b", "a_b_2", "a_b_2_2", "a_b_3", "Gro_es_Rad", "-"]
        );
    }
}
