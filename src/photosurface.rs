//! The pipeline: a scene and its models in, the photosurface of every part at every step out.

use std::collections::HashSet;
use std::sync::Arc;

use glam::DVec4;
use rayon::prelude::*;
use serde::Serialize;

use crate::light_cone::View;
use crate::mesh::{Appearance, Color, Material, Mesh, Model, Part, Shape};
use crate::scene::{Object, Scene};
use crate::spacetime::Velocity;

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
    /// For every object its parts in its rest frame, each with its name in files.
    objects: Vec<Vec<(String, Part)>>,
}

/// The photosurface of one part of one object at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Photosurface {
    /// What it is and how it came about.
    pub facts: Facts,
    /// Its geometry in the observer's frame, observer at the origin: the vertices and triangles of the part
    /// at rest, in the same order.
    pub mesh: Mesh,
    /// Frequency seen over frequency emitted, at each vertex; only where it was asked for.
    pub doppler_factors: Option<Vec<f64>>,
    /// What it is made of.
    pub material: Option<Arc<Material>>,
}

/// What a photosurface is, in words and numbers: the same in files and in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// Names it in files: unique there, ASCII letters, digits, `_` and `-` only.
    pub name: String,
    /// The object in the scene.
    pub object: String,
    /// The part of the object's model; empty where there is only one and it has no name.
    pub part: String,
    /// Which step, from 0.
    pub step: usize,
    /// Proper time of the observer at this step, from the observation event.
    pub proper_time: f64,
    /// Lorentz factor between object and observer.
    pub relative_gamma: f64,
    /// Rapidity between object and observer.
    pub relative_rapidity: f64,
    /// How many vertices it has.
    pub vertices: usize,
    /// How many triangles it has.
    pub triangles: usize,
}

/// What the scene is, in words and numbers: the same in files and in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneFacts {
    /// The scene's title.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The program that made the file.
    pub generator: &'static str,
    /// Scene time of the observation event.
    pub observer_time: f64,
    /// Place of the observation event in the scene frame.
    pub observer_position: [f64; 3],
    /// Direction of the observer's motion in the scene frame.
    pub observer_direction: [f64; 3],
    /// The observer's speed in the scene frame.
    pub observer_beta: f64,
    /// The observer's Lorentz factor in the scene frame.
    pub observer_gamma: f64,
    /// The observer's rapidity in the scene frame.
    pub observer_rapidity: f64,
    /// Proper times of the steps, from the observation event.
    pub steps: Vec<f64>,
}

/// Which quantities are computed beside the shape; none unless asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Wanted {
    /// Frequency seen over frequency emitted, at each vertex.
    pub doppler_factors: bool,
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
            objects.push(parts.collect());
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
            .zip(self.objects.iter().map(Vec::as_slice))
    }

    /// The observer's velocity in the rest frame of an object.
    pub fn relative_velocity(&self, object: &Object) -> Velocity {
        self.view(object, 0.0).relative_velocity()
    }

    /// The photosurfaces of all parts at one step, in the order of the scene.
    ///
    /// # Panics
    ///
    /// If the scene has no such step.
    pub fn photosurfaces(&self, step: usize, wanted: Wanted) -> impl Iterator<Item = Photosurface> {
        let proper_time = self.scene.steps()[step];
        self.objects().flat_map(move |(object, parts)| {
            let view = self.view(object, proper_time);
            parts.iter().map(move |(name, part)| Photosurface {
                facts: self.part_facts(object, name, part, step, &view),
                mesh: seen_mesh(&view, part.mesh()),
                doppler_factors: wanted
                    .doppler_factors
                    .then(|| doppler_factors(&view, part.mesh())),
                material: part.material.clone(),
            })
        })
    }

    /// What the scene is, in words and numbers.
    pub fn facts(&self) -> SceneFacts {
        let observer = self.scene.observer();
        SceneFacts {
            title: self.scene.title().map(str::to_owned),
            generator: concat!("photosurface ", env!("CARGO_PKG_VERSION")),
            observer_time: observer.time,
            observer_position: observer.position.to_array(),
            observer_direction: observer.velocity.direction().to_array(),
            observer_beta: observer.velocity.beta(),
            observer_gamma: observer.velocity.gamma(),
            observer_rapidity: observer.velocity.rapidity(),
            steps: self.scene.steps().to_vec(),
        }
    }

    fn view(&self, object: &Object, proper_time: f64) -> View {
        View::new(
            &self.scene.observer().world_line(),
            &object.world_line(),
            proper_time,
        )
    }

    fn part_facts(
        &self,
        object: &Object,
        name: &str,
        part: &Part,
        step: usize,
        view: &View,
    ) -> Facts {
        let steps = self.scene.steps();
        let relative = view.relative_velocity();
        Facts {
            name: match steps.len() {
                1 => name.to_owned(),
                _ => format!("{name}_{}", step_label(step)),
            },
            object: object.name.clone(),
            part: part.name.clone(),
            step,
            proper_time: steps[step],
            relative_gamma: relative.gamma(),
            relative_rapidity: relative.rapidity(),
            vertices: part.mesh().positions().len(),
            triangles: part.mesh().triangles().len(),
        }
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
