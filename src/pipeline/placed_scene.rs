//! A scene with the geometry of its objects, and the photosurfaces that are made from it.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use serde_json::Value;

use super::Bounds;
use super::batches::Batches;
use super::company_meshes::CompanyMeshes;
use super::curved::shared_mesh;
use super::facts::{Facts, SceneFacts};
use super::making::{Surface, make};
use super::names::{self, UniqueNames, step_label};
use super::placed_object::PlacedObject;
use super::placing::Placing;
use super::plan::{Plan, Unrefined};
use super::shared_mesh::SharedMesh;
use super::vertex_data::VertexData;
use super::{MomentFacts, Photosurface, PlacedSceneError, SurfaceOptions};
use crate::light_cone::{MAX_DELAYED_RAPIDITY, ModelView, View};
use crate::material::{Model, Part};
use crate::scene::{
    Attribute, Emission, MarkerRadius, Measure, Object, Scene, Source, Tolerance, Unit,
};
use crate::shape::{Appearance, Color, Shape};
use crate::spacetime::{MAX_RAPIDITY, Velocity, ViewModel};

/// Name of the observer's marker in files.
const MARKER_NAME: &str = "observer";
const MARKER_RESOLUTION: u32 = 24;

/// The largest distance from the observer, in scene units, of anything that stands for an object: its square is in `f64`.
const MAX_REACH: f64 = 1e150;

const A_STEP: &str = "whoever asks for a plan asks for a step of the scene";

/// A scene with the geometry of its objects, placed in their rest frames. Photosurfaces are made from it.
///
/// # Example
///
/// ```
/// use photosurface::{PlacedScene, Scene, SurfaceOptions, load_models};
///
/// let scene = Scene::from_json(
///     r#"{ "observer": { "velocity": { "beta": 0.8 } },
///          "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] } ] }"#,
/// )?;
/// let (models, _) = load_models(&scene, ".".as_ref())?;
/// let placed = PlacedScene::new(scene, models)?;
/// let ball = placed.photosurfaces(0, SurfaceOptions::default())?.next().expect("one object, one photosurface");
/// // Its centre, 5 ahead, is seen exp(atanh(0.8)) = 3 times as far away.
/// let (low, high) = ball.mesh.bounds().expect("a sphere has vertices");
/// assert!(low.z < -15.0 && high.z > -15.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PlacedScene {
    pub(super) scene: Scene,
    pub(super) marker: Option<Part>,
    /// One placed object for each object of the scene, in the same order.
    pub(super) objects: Vec<PlacedObject>,
    /// The copyright and `extras` of each object's source.
    pub(super) origins: Vec<Option<Arc<Value>>>,
}

impl PlacedScene {
    /// Places one model for each object of `scene`, in their order, in the objects' rest frames.
    ///
    /// # Errors
    ///
    /// An error is returned if the numbers of models and objects differ, if a mesh has a vertex that is not finite, if
    /// a model is not the one that [`load_models`](crate::load_models) makes from its object's shape, or if a composed
    /// velocity has a rapidity above [`MAX_RAPIDITY`].
    pub fn new(scene: Scene, models: Vec<Model>) -> Result<Self, PlacedSceneError> {
        let objects = scene.objects();
        if objects.len() != models.len() {
            return Err(PlacedSceneError::Models {
                objects: objects.len(),
                models: models.len(),
            });
        }
        check_rapidity("the observer", scene.observer().velocity)?;
        if !scene.observer().flight.is_empty() {
            for &proper_time in scene.steps() {
                let velocity = scene.flight().moment(proper_time).velocity();
                check_rapidity(
                    &format!("the observer at proper time {proper_time}"),
                    velocity,
                )?;
            }
        }
        for (object, model) in objects.iter().zip(&models) {
            check_rapidity(&format!("object \"{}\"", object.name), object.velocity)?;
            if !is_of_its_shape(object, model) {
                let object = object.name.clone();
                return Err(PlacedSceneError::Shape { object });
            }
            if let Some(part) = model.parts.iter().find(|part| !part.mesh().is_finite()) {
                return Err(PlacedSceneError::NotFinite {
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
        let mut placing = Placing::new(names);
        let models = scene.objects().iter().zip(models);
        let objects = models.map(|(object, model)| placing.placed(object, model));
        let objects = objects.collect();
        let placed = Self {
            scene,
            marker,
            objects,
            origins,
        };
        placed.check_stand_ins()?;
        Ok(placed)
    }

    /// The same placed scene with all objects shown under one model; aims that a budget has loosened are reset.
    ///
    /// # Errors
    ///
    /// An error is returned if an object without contraction would be too large for `f64`.
    pub fn with_model_for_all(mut self, model: ViewModel) -> Result<Self, PlacedSceneError> {
        self.scene = self.scene.with_model_for_all(model);
        for placed_object in &mut self.objects {
            placed_object.loosening = 1.0;
            placed_object.granted = None;
        }
        self.check_stand_ins()?;
        Ok(self)
    }

    /// Checks that everything that stands for an object under its model has room in `f64`.
    fn check_stand_ins(&self) -> Result<(), PlacedSceneError> {
        for (object, placed_object) in self.scene.objects().iter().zip(&self.objects) {
            if object.view_model() != ViewModel::Delayed {
                continue;
            }
            for step in 0..self.scene.steps().len() {
                let shown = self.model_view(object, step).expect(A_STEP);
                let rapidity = shown.view().relative_velocity().rapidity();
                if rapidity > MAX_DELAYED_RAPIDITY {
                    let object = object.name.clone();
                    return Err(PlacedSceneError::Delayed { object, rapidity });
                }
                let reach = placed_object.reach(shown.view().observer_rest());
                let reach = reach * shown.stretch();
                if !(reach <= MAX_REACH) {
                    let object = object.name.clone();
                    return Err(PlacedSceneError::Reach { object, reach });
                }
            }
        }
        Ok(())
    }

    /// The same placed scene with one tolerance for all objects; aims that a budget has loosened are reset.
    #[must_use]
    pub fn with_tolerance_for_all(mut self, tolerance: Tolerance) -> Self {
        self.scene = self.scene.with_tolerance_for_all(tolerance);
        for placed_object in &mut self.objects {
            placed_object.loosening = 1.0;
            placed_object.granted = None;
        }
        self
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
        self.scene.objects().iter().zip(
            self.objects
                .iter()
                .map(|placed_object| placed_object.parts.as_slice()),
        )
    }

    /// The names of parts that contain characters which reading programs replace, each with its name in files.
    pub fn replaced_names(&self) -> impl Iterator<Item = (String, &str)> {
        let all = self.objects().flat_map(|(object, parts)| {
            let wanted = |part| wanted_name(object, part, parts.len());
            parts
                .iter()
                .map(move |(name, part)| (wanted(part), name.as_str()))
        });
        all.filter(|(wanted, _)| names::safe_name(wanted) != *wanted)
    }

    /// How the observer sees everything that moves along with an object, at one step, counted from 0; `None` if the
    /// scene has no such step.
    pub fn view(&self, object: &Object, step: usize) -> Option<View> {
        let moment = self.scene.moment(step)?;
        Some(View::new(&moment, &object.world_line()))
    }

    /// How the observer is shown an object under its model at one step, counted from 0; `None` if the scene has no such
    /// step.
    pub fn model_view(&self, object: &Object, step: usize) -> Option<ModelView> {
        Some(ModelView::new(
            self.view(object, step)?,
            object.view_model(),
        ))
    }

    /// The observer's velocity in the rest frame of an object, at the step at which it is fastest.
    pub fn fastest_relative_velocity(&self, object: &Object) -> Velocity {
        let steps = 0..self.scene.steps().len();
        let views = steps.filter_map(|step| self.view(object, step));
        let velocities = views.map(|view| view.relative_velocity());
        let faster = |a: Velocity, b: Velocity| if b.rapidity() > a.rapidity() { b } else { a };
        velocities.reduce(faster).unwrap_or_default()
    }

    /// The photosurfaces of all parts at one step, in the order of the scene.
    ///
    /// # Errors
    ///
    /// An error is returned if the scene has no such step.
    pub fn photosurfaces(
        &self,
        step: usize,
        wanted: SurfaceOptions,
    ) -> Result<impl Iterator<Item = Photosurface>, PlacedSceneError> {
        self.check_step(step)?;
        let mut batches = Batches::of(self.objects.len());
        let mut meshes = CompanyMeshes::new(self, step, wanted);
        let next_batch = move || {
            let batch = batches.next()?;
            meshes.prepare(&batch, |leader, tightened| {
                shared_mesh(&self.plan_of(leader, step, wanted), tightened)
            });
            let made = |object| self.made(object, step, wanted, meshes.of(object));
            let made: Vec<Made<'_>> = match batch.len() {
                1 => vec![made(batch.start)],
                _ => batch.into_par_iter().map(made).collect(),
            };
            batches.made(made.iter().map(Made::triangles).max().unwrap_or(0));
            Some(made)
        };
        let made = std::iter::from_fn(next_batch).flatten();
        Ok(made.flat_map(move |made| {
            let object = &self.scene.objects()[made.object];
            let beside = self.objects[made.object].beside;
            let surfaces = made.surfaces.into_iter();
            surfaces.map(move |surface| {
                self.photosurface(object, (step, beside), &made.shown, surface, wanted)
            })
        }))
    }

    /// Makes the surfaces of one object, by its number, at one step; a round shape may have a mesh that others share.
    fn made(
        &self,
        number: usize,
        step: usize,
        wanted: SurfaceOptions,
        shared: Option<&SharedMesh>,
    ) -> Made<'_> {
        let plan = self.plan_of(number, step, wanted);
        Made {
            object: number,
            shown: plan.shown,
            surfaces: make(plan, wanted, shared),
        }
    }

    /// The plan of one object, by its number, at one step.
    fn plan_of(&self, number: usize, step: usize, wanted: SurfaceOptions) -> Plan<'_> {
        let (object, placed_object) = (&self.scene.objects()[number], &self.objects[number]);
        self.plan(object, placed_object, step, wanted)
    }

    /// Whether the scene has a step.
    pub(super) fn check_step(&self, step: usize) -> Result<(), PlacedSceneError> {
        let steps = self.scene.steps().len();
        match step < steps {
            true => Ok(()),
            false => Err(PlacedSceneError::Step { step, steps }),
        }
    }

    /// The state before refinement at one step, for each object.
    pub(crate) fn unrefined(
        &self,
        step: usize,
        wanted: SurfaceOptions,
    ) -> impl Iterator<Item = Unrefined<'_>> {
        let objects = self.scene.objects().iter().zip(&self.objects);
        objects.map(move |(object, placed_object)| {
            let shown = self.model_view(object, step).expect(A_STEP);
            let measure = self.measure(object, &placed_object.parts);
            let tolerance = (self.scene.tolerance(object), measure);
            Plan::of_facets(placed_object, shown, tolerance, wanted).unrefined()
        })
    }

    /// Whether all seen positions at one step are well within the range of `f32`, so that none can overflow or vanish.
    /// The test is quick and may be false although the positions are in range. `boxes` are boxes around the parts of
    /// each object in its rest frame.
    pub(crate) fn is_within_f32(&self, step: usize, boxes: &[Vec<(DVec3, DVec3)>]) -> bool {
        const RANGE: std::ops::Range<f64> = 1e-30..1e30;
        let mut objects = self.scene.objects().iter().zip(boxes);
        objects.all(|(object, boxes)| {
            let view = self.view(object, step).expect(A_STEP);
            let longest = view.relative_velocity().rapidity().exp();
            let stretch = match object.view_model() {
                ViewModel::Seen => longest,
                _ => longest * longest,
            };
            // The fourth power of a Doppler factor may be larger than any position.
            let is_bright = self.scene.attributes().contains(Attribute::Radiance)
                && stretch.powi(4) >= RANGE.end;
            !is_bright
                && boxes.iter().all(|&(low, high)| {
                    let away = (low - view.observer_rest()).length() + (high - low).length();
                    RANGE.contains(&(away * stretch))
                        && RANGE.contains(&((high - low).max_element() / stretch))
                })
        })
    }

    /// Which distance the tolerance of an object with these parts limits: what the scene says; else that of surfaces for a
    /// round shape on which nothing is drawn, in a scene without attributes of vertices and effects that colour them; else
    /// that of points. Near the observer flat facets take hardly fewer triangles as surfaces, but several times as long, and
    /// how many is hard to predict. For them tolerances that are angles limit the distance of points, whose bound holds for
    /// surfaces as well.
    pub fn measure(&self, object: &Object, parts: &[(String, Part)]) -> Measure {
        let is_round = match &object.source {
            Source::Shape(shape, _) => shape.is_curved(),
            Source::File(_) | Source::Model(_) => false,
        };
        if !is_round && self.scene.tolerance(object).unit() == Unit::Degrees {
            return Measure::Points;
        }
        let has_points = |part: &Part| {
            let material = part.material.as_ref();
            part.mesh().colors().is_some()
                || material.is_some_and(|material| !material.textures().is_empty())
        };
        object.measure.unwrap_or_else(|| {
            let of_scene = !self.scene.attributes().is_empty() || self.scene.effects().colors();
            match is_round && !of_scene && !parts.iter().any(|(_, part)| has_points(part)) {
                true => Measure::Surface,
                false => Measure::Points,
            }
        })
    }

    /// The facts about the scene.
    pub fn facts(&self) -> SceneFacts {
        SceneFacts::new(&self.scene, &self.origins)
    }

    pub(super) fn plan<'a>(
        &self,
        object: &Object,
        placed_object: &'a PlacedObject,
        step: usize,
        wanted: SurfaceOptions,
    ) -> Plan<'a> {
        let shown = self.model_view(object, step).expect(A_STEP);
        let tolerance = self.scene.tolerance(object);
        let measure = self.measure(object, &placed_object.parts);
        Plan::new(
            placed_object,
            shown,
            (tolerance, measure),
            wanted,
            placed_object.granted(step),
        )
    }

    pub(super) fn photosurface(
        &self,
        object: &Object,
        (step, beside): (usize, DVec3),
        shown: &ModelView,
        surface: Surface<'_>,
        wanted: SurfaceOptions,
    ) -> Photosurface {
        let steps = self.scene.steps();
        let relative = shown.view().relative_velocity();
        let name = surface.name;
        let facts = Facts {
            name: match steps.len() {
                1 => name,
                _ => format!("{name}_{}", step_label(step)),
            },
            object: object.name.clone(),
            model: Some(shown.model()).filter(|&model| model != ViewModel::Seen),
            part: surface.part.name.clone(),
            source: surface.part.extras.clone(),
            emission: object.emission.map(Emission::to_value),
            step,
            proper_time: steps[step],
            observer: (!self.scene.observer().flight.is_empty())
                .then(|| MomentFacts::new(self.scene.flight(), steps[step])),
            relative_gamma: relative.gamma(),
            relative_rapidity: relative.rapidity(),
            vertices: surface.seen.mesh.vertex_count(),
            triangles: surface.seen.mesh.triangle_count(),
            bounds: Bounds::new(surface.seen.mesh.bounds().unwrap_or_default()),
            tolerance: self.scene.tolerance(object).to_flag(),
            condition: surface.seen.condition(shown),
            beside: (beside != DVec3::ZERO).then(|| beside.to_array()),
            certificate: surface.certificate,
        };
        Photosurface {
            facts,
            vertex_data: VertexData::new(
                shown,
                surface.part.mesh(),
                surface.at_rest.as_ref(),
                wanted.attributes,
            ),
            material: surface.part.material.clone(),
            mesh: surface.seen.mesh,
            around: surface.around,
            beside,
        }
    }
}

/// The surfaces of one object at one step.
struct Made<'a> {
    /// Its number in the scene.
    object: usize,
    shown: ModelView,
    surfaces: Vec<Surface<'a>>,
}

impl Made<'_> {
    fn triangles(&self) -> usize {
        let meshes = self.surfaces.iter().map(|surface| &surface.seen.mesh);
        meshes.map(|mesh| mesh.triangle_count()).sum()
    }
}

/// Checks that a composed velocity does not exceed [`MAX_RAPIDITY`]. The relative velocity of two velocities with this
/// rapidity is still within `f64`.
fn check_rapidity(who: &str, velocity: Velocity) -> Result<(), PlacedSceneError> {
    match velocity.rapidity() {
        rapidity if rapidity <= MAX_RAPIDITY => Ok(()),
        rapidity => Err(PlacedSceneError::TooFast {
            who: who.to_owned(),
            rapidity,
        }),
    }
}

/// Whether the model of an object has the geometry of the object's shape, if the object has one. Certificates rely on
/// the known distance between the facets and the curved surface.
fn is_of_its_shape(object: &Object, model: &Model) -> bool {
    let Source::Shape(shape, appearance) = &object.source else {
        return true;
    };
    if let [part] = &model.parts[..]
        && let Some(maker) = part.mesh().maker()
        && (maker == shape || Some(maker) == shape.coarsest_flat().as_ref())
    {
        // Without refinement the shape gets its default resolution.
        return shape.check_flat_size().is_ok();
    }
    let Ok(made) = shape.model(appearance) else {
        return false;
    };
    let alike = |(given, made): (&Part, &Part)| {
        let (given, made) = (given.mesh(), made.mesh());
        given.positions() == made.positions() && given.triangles() == made.triangles()
    };
    model.parts.len() == made.parts.len() && model.parts.iter().zip(&made.parts).all(alike)
}

/// The wanted name of a part; `parts` is the number of parts of its object.
pub(super) fn wanted_name(object: &Object, part: &Part, parts: usize) -> String {
    match parts {
        1 => object.name.clone(),
        _ => format!("{}_{}", object.name, part.name),
    }
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
