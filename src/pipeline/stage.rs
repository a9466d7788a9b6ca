//! A scene with the geometry of its objects, and what is made of them.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use serde_json::Value;

use super::StageError;
use super::budget::Granted;
use super::facts::{Facts, SceneFacts};
use super::names::{self, UniqueNames, step_label};
use super::plan::{Plan, Surface, Unrefined};
use super::seen::VertexData;
use crate::light_cone::View;
use crate::material::{Material, Model, Part};
use crate::mesh::Mesh;
use crate::scene::{Attributes, MarkerRadius, Object, Scene, Source};
use crate::shape::{Appearance, Color, Shape};
use crate::spacetime::Velocity;
use crate::tessellate::Precision;

/// The observer's marker in files.
const MARKER_NAME: &str = "observer";
const MARKER_RESOLUTION: u32 = 24;

/// A shape of more facets than it may have is tried with so much larger ones, and again.
const COARSER: f64 = 1.1;

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
/// let stage = Stage::new(scene, models)?;
/// let ball = stage.photosurfaces(0, Wanted::default())?.next().expect("one object, one photosurface");
/// // Its centre, 5 ahead, is seen exp(atanh(0.8)) = 3 times as far away.
/// let (low, high) = ball.mesh.bounds().expect("a sphere has vertices");
/// assert!(low.z < -15.0 && high.z > -15.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stage {
    pub(super) scene: Scene,
    pub(super) marker: Option<Part>,
    /// For every object of the scene.
    pub(super) objects: Vec<Placed>,
    /// What the source of each says of itself.
    pub(super) origins: Vec<Option<Arc<Value>>>,
}

/// The photosurface of one part of one object at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Photosurface {
    /// What it is and how it came about.
    pub facts: Facts,
    /// Its geometry in the observer's frame, observer at the origin: the vertices of the part at rest, in
    /// the same order, then those that were added.
    pub mesh: Mesh,
    /// The smallest and the largest coordinates of all parts of the object at this step, or at all steps where they
    /// share one mesh. Files with `f32` have positions relative to the middle of that: parts that share a corner have
    /// the same numbers there.
    pub around: (DVec3, DVec3),
    /// What else was asked for of its vertices.
    pub vertex_data: VertexData,
    /// What it is made of.
    pub material: Option<Arc<Material>>,
}

impl Photosurface {
    /// What was asked for of its vertices.
    pub fn attributes(&self) -> Attributes {
        Attributes {
            doppler: self.vertex_data.doppler_factors.is_some(),
            emission_time: self.vertex_data.emission_times.is_some(),
            rest_position: self.vertex_data.rest_positions.is_some(),
        }
    }
}

/// What is wanted of photosurfaces beside their shape, and how much may be spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// What is to be known of every vertex.
    pub attributes: Attributes,
    /// Whether meshes are refined until they are within the tolerance; if not, every vertex stays what it is and
    /// the certificate tells how far off the mesh is.
    pub subdivide: bool,
    /// How many digits the file will have.
    pub precision: Precision,
}

impl Default for Wanted {
    /// Meshes within the tolerance, for glTF, and nothing else.
    fn default() -> Self {
        Self {
            attributes: Attributes::default(),
            subdivide: true,
            precision: Precision::Single,
        }
    }
}

/// An object's parts in its rest frame.
#[derive(Clone, Debug)]
pub(super) struct Placed {
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
    /// Of its facets as they were placed from the curved surface, at rest.
    pub(super) deviation: f64,
}

impl Stage {
    /// Places one model for each object of `scene`, in their order, in the objects' rest frames.
    ///
    /// # Errors
    ///
    /// Not as many models as objects, or a mesh with a vertex that is not finite.
    pub fn new(scene: Scene, models: Vec<Model>) -> Result<Self, StageError> {
        let objects = scene.objects();
        if objects.len() != models.len() {
            return Err(StageError::Models {
                objects: objects.len(),
                models: models.len(),
            });
        }
        for (object, model) in objects.iter().zip(&models) {
            if let Some(part) = model.parts.iter().find(|part| !part.mesh().is_finite()) {
                return Err(StageError::NotFinite {
                    object: object.name.clone(),
                    part: part.name.clone(),
                });
            }
        }
        let mut names = UniqueNames::default();
        let marker = scene
            .observer()
            .marker
            .map(|radius| marker(&names.unique(MARKER_NAME), radius));
        let origins = models.iter().map(|model| model.origin.clone()).collect();
        let mut objects = Vec::with_capacity(models.len());
        for (object, model) in scene.objects().iter().zip(models) {
            let count = model.parts.len();
            let parts = model.parts.into_iter().map(|part| {
                let name = names.unique(&wanted_name(object, &part, count));
                (name, part.transformed(&object.model_to_rest()))
            });
            let parts: Vec<(String, Part)> = parts.collect();
            let shaped = Shaped::of(object);
            objects.push(Placed {
                source_triangles: match &shaped {
                    Some(shaped) => shaped.fewest_triangles(&parts),
                    None => triangle_count(&parts),
                },
                parts,
                shaped,
                loosening: 1.0,
                granted: None,
            });
        }
        Ok(Self {
            scene,
            marker,
            objects,
            origins,
        })
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

    /// The names of parts that have characters which programs that read files break, each with what it is in files.
    pub fn replaced_names(&self) -> impl Iterator<Item = (String, &str)> {
        let all = self.objects().flat_map(|(object, parts)| {
            let wanted = |part| wanted_name(object, part, parts.len());
            parts
                .iter()
                .map(move |(name, part)| (wanted(part), name.as_str()))
        });
        all.filter(|(wanted, _)| names::plain(wanted) != *wanted)
    }

    /// How the observer sees what moves along with an object, at one step.
    ///
    /// # Panics
    ///
    /// If the scene has no such step.
    pub fn view(&self, object: &Object, step: usize) -> View {
        View::new(&self.scene.moment(step), &object.world_line())
    }

    /// The observer's velocity in the rest frame of an object at the step, of all, at which it is fastest.
    pub fn fastest_relative_velocity(&self, object: &Object) -> Velocity {
        let steps = 0..self.scene.steps().len();
        let velocities = steps.map(|step| self.view(object, step).relative_velocity());
        let faster = |a: Velocity, b: Velocity| if b.rapidity() > a.rapidity() { b } else { a };
        velocities.reduce(faster).unwrap_or_default()
    }

    /// The photosurfaces of all parts at one step, in the order of the scene.
    ///
    /// # Errors
    ///
    /// The scene has no such step.
    pub fn photosurfaces(
        &self,
        step: usize,
        wanted: Wanted,
    ) -> Result<impl Iterator<Item = Photosurface>, StageError> {
        let steps = self.scene.steps().len();
        if step >= steps {
            return Err(StageError::Step { step, steps });
        }
        let objects = self.scene.objects().iter().zip(&self.objects);
        let made = objects.flat_map(move |(object, placed)| {
            let plan = self.plan(object, placed, step, wanted);
            let view = *plan.view();
            let surfaces = plan.carry_out(wanted);
            surfaces
                .into_iter()
                .map(move |surface| self.photosurface(object, step, &view, surface, wanted))
        });
        Ok(made)
    }

    /// What refinement starts from at one step, for each object.
    pub(crate) fn unrefined(
        &self,
        step: usize,
        wanted: Wanted,
    ) -> impl Iterator<Item = Unrefined<'_>> {
        let objects = self.scene.objects().iter().zip(&self.objects);
        objects.map(move |(object, placed)| self.plan(object, placed, step, wanted).unrefined())
    }

    /// Whether all that is seen at one step is well within the range of `f32`, so that nothing can overflow or
    /// vanish; a quick look that may say no without need. `boxes` are around the parts at rest, for each object.
    pub(crate) fn is_within_f32(&self, step: usize, boxes: &[Vec<(DVec3, DVec3)>]) -> bool {
        const RANGE: std::ops::Range<f64> = 1e-30..1e30;
        let mut objects = self.scene.objects().iter().zip(boxes);
        objects.all(|(object, boxes)| {
            let view = self.view(object, step);
            let stretch = view.relative_velocity().rapidity().exp();
            boxes.iter().all(|&(low, high)| {
                let away = (low - view.observer_rest()).length() + (high - low).length();
                RANGE.contains(&(away * stretch))
                    && RANGE.contains(&((high - low).max_element() / stretch))
            })
        })
    }

    /// What the scene is, in words and numbers.
    pub fn facts(&self) -> SceneFacts {
        SceneFacts::new(&self.scene, &self.origins)
    }

    pub(super) fn plan<'a>(
        &self,
        object: &Object,
        placed: &'a Placed,
        step: usize,
        wanted: Wanted,
    ) -> Plan<'a> {
        let view = self.view(object, step);
        let tolerance = self.scene.tolerance(object);
        Plan::new(placed, view, tolerance, wanted, placed.granted(step))
    }

    pub(super) fn photosurface(
        &self,
        object: &Object,
        step: usize,
        view: &View,
        surface: Surface<'_>,
        wanted: Wanted,
    ) -> Photosurface {
        let steps = self.scene.steps();
        let relative = view.relative_velocity();
        let name = surface.name;
        let facts = Facts {
            name: match steps.len() {
                1 => name,
                _ => format!("{name}_{}", step_label(step)),
            },
            object: object.name.clone(),
            part: surface.part.name.clone(),
            source: surface.part.extras.clone(),
            step,
            proper_time: steps[step],
            relative_gamma: relative.gamma(),
            relative_rapidity: relative.rapidity(),
            vertices: surface.seen.mesh.positions().len(),
            triangles: surface.seen.mesh.triangles().len(),
            condition: surface.seen.condition(view),
            certificate: surface.certificate,
        };
        Photosurface {
            facts,
            vertex_data: VertexData::new(view, surface.part.mesh(), wanted.attributes),
            material: surface.part.material.clone(),
            mesh: surface.seen.mesh,
            around: surface.around,
        }
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
    pub(super) fn fewest_triangles(&self, parts: &[(String, Part)]) -> u64 {
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

/// How a part of an object of so many parts would be called.
fn wanted_name(object: &Object, part: &Part, parts: usize) -> String {
    match parts {
        1 => object.name.clone(),
        _ => format!("{}_{}", object.name, part.name),
    }
}

pub(super) fn triangle_count(parts: &[(String, Part)]) -> u64 {
    let triangles = parts.iter().map(|(_, part)| part.mesh().triangles().len());
    triangles.sum::<usize>() as u64
}

fn marker(name: &str, radius: MarkerRadius) -> Part {
    let appearance = Appearance {
        color: Color([0xe7, 0x4c, 0x3c]),
        checker: None,
    };
    let mut model = Shape::sphere(radius.get())
        .and_then(|sphere| sphere.with_resolution(MARKER_RESOLUTION))
        .and_then(|sphere| sphere.model(&appearance))
        .expect("every radius from 1e-60 to 1e60 makes a sphere of this resolution");
    let mut part = model.parts.pop().expect("a sphere is one part");
    part.name = name.to_owned();
    part
}
