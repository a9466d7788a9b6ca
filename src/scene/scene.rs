//! A scene: an observer, objects and steps.

use std::collections::HashSet;

use schemars::JsonSchema;
use serde::Deserialize;

use super::forms::{FromObject, Keyed, Steps};
use super::lamp_form::LampFields;
use super::observer::{self, ObserverFields};
use super::{
    Attributes, Carrier, Effects, InvalidScene, Lamp, LampSource, Measure, Object, Observer,
    Source, Tolerance, Units,
};
use crate::material::Normals;
use crate::spacetime::{Flight, Moment, ViewModel};

/// A scene: an observer, objects, and the steps at which the observer looks.
///
/// Everything is given in the scene frame: c = 1, y up, lengths and times in one unit.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "FromObject<SceneFields>")]
#[schemars(with = "SceneFields")]
pub struct Scene {
    title: Option<String>,
    units: Option<Units>,
    observer: Observer,
    flight: Flight,
    objects: Vec<Object>,
    steps: Vec<f64>,
    tolerance: Tolerance,
    attributes: Attributes,
    lamps: Vec<Lamp>,
    effects: Effects,
}

impl Scene {
    /// A scene of `objects` seen by `observer` at the observation event alone.
    ///
    /// # Errors
    ///
    /// No objects, two of one name, or an observer whose flight is not possible.
    pub fn new(observer: Observer, objects: Vec<Object>) -> Result<Self, InvalidScene> {
        if objects.is_empty() {
            return Err(InvalidScene::NoObjects);
        }
        let mut names = HashSet::with_capacity(objects.len());
        for (index, object) in objects.iter().enumerate() {
            if object.name.is_empty() {
                return Err(InvalidScene::EmptyName(index));
            }
            if !names.insert(&object.name) {
                return Err(InvalidScene::RepeatedName(object.name.clone()));
            }
        }
        Ok(Self {
            title: None,
            units: None,
            flight: observer.to_flight()?,
            observer,
            objects,
            steps: vec![0.0],
            tolerance: Tolerance::default(),
            attributes: Attributes::default(),
            lamps: vec![],
            effects: Effects::default(),
        })
    }

    /// The scene at these proper times of the observer, counted from the observation event.
    ///
    /// # Errors
    ///
    /// No steps, or one that is not finite.
    pub fn with_steps(mut self, steps: Vec<f64>) -> Result<Self, InvalidScene> {
        if steps.is_empty() {
            return Err(InvalidScene::NoSteps);
        }
        if let Some(index) = steps.iter().position(|step| !step.is_finite()) {
            return Err(InvalidScene::Step(index, steps[index]));
        }
        self.steps = steps;
        Ok(self)
    }

    /// The same scene seen by another observer.
    ///
    /// # Errors
    ///
    /// The observer's flight is not possible: see [`Flight::new`].
    pub fn with_observer(mut self, observer: Observer) -> Result<Self, InvalidScene> {
        self.flight = observer.to_flight()?;
        self.observer = observer;
        Ok(self)
    }

    /// The scene with units that say what its numbers are in everyday units; no number changes.
    #[must_use]
    pub fn with_units(mut self, units: Units) -> Self {
        self.units = Some(units);
        self
    }

    /// The scene with another tolerance, for all objects that have none of their own.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: Tolerance) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// The scene with this tolerance for all objects, whatever they had.
    #[must_use]
    pub fn with_tolerance_for_all(mut self, tolerance: Tolerance) -> Self {
        self.tolerance = tolerance;
        for object in &mut self.objects {
            object.tolerance = None;
        }
        self
    }

    /// The scene with this measure for all objects, whatever they had.
    #[must_use]
    pub fn with_measure_for_all(mut self, measure: Measure) -> Self {
        for object in &mut self.objects {
            object.measure = Some(measure);
        }
        self
    }

    /// The scene with all objects shown under this model, whatever they had.
    #[must_use]
    pub fn with_model_for_all(mut self, model: ViewModel) -> Self {
        for object in &mut self.objects {
            object.model = Some(model);
        }
        self
    }

    /// The scene with all objects under each of these models, whatever they had, one model after the other; each object has
    /// the name of the model behind its own, as `ball_delayed`.
    ///
    /// # Errors
    ///
    /// No model, a model that is given twice, or an object that has such a name already.
    pub fn with_each_model(self, models: &[ViewModel]) -> Result<Self, InvalidScene> {
        let of_model = |&model: &ViewModel| {
            self.objects.iter().map(move |object| Object {
                name: format!("{}_{model}", object.name),
                model: Some(model),
                ..object.clone()
            })
        };
        let objects: Vec<Object> = models.iter().flat_map(of_model).collect();
        let checked = Self::new(self.observer.clone(), objects)?;
        Ok(Self {
            objects: checked.objects,
            ..self
        })
    }

    /// The scene with these attributes asked for, and no others.
    #[must_use]
    pub fn with_attributes(mut self, attributes: Attributes) -> Self {
        self.attributes = attributes;
        self
    }

    /// The scene with these normals asked for of every object that comes from a file.
    #[must_use]
    pub fn with_normals(mut self, normals: Normals) -> Self {
        for object in &mut self.objects {
            if let Source::File(_) = object.source {
                object.normals = Some(normals);
            }
        }
        self
    }

    /// What is asked for at every vertex.
    pub fn attributes(&self) -> Attributes {
        self.attributes
    }

    /// The scene lit by these lamps, and by no others; without any, pictures have a lamp at the eye.
    ///
    /// # Errors
    ///
    /// A lamp on an object that the scene does not have.
    pub fn with_lamps(mut self, lamps: Vec<Lamp>) -> Result<Self, InvalidScene> {
        for (number, lamp) in lamps.iter().enumerate() {
            if let LampSource::Point(point) = lamp.source()
                && let Carrier::Object(name) = point.carrier()
                && !self.objects.iter().any(|object| object.name == *name)
            {
                return Err(InvalidScene::LampObject(number, name.clone()));
            }
        }
        self.lamps = lamps;
        Ok(self)
    }

    /// The lamps that light the scene in pictures.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The scene with these effects asked for, and no others.
    #[must_use]
    pub fn with_effects(mut self, effects: Effects) -> Self {
        self.effects = effects;
        self
    }

    /// What becomes of light on its way, beside shapes.
    pub fn effects(&self) -> Effects {
        self.effects
    }

    /// How far the photosurface of an object may be from the true one.
    pub fn tolerance(&self, object: &Object) -> Tolerance {
        object.tolerance.unwrap_or(self.tolerance)
    }

    /// The scene's title.
    pub fn title(&self) -> Option<&str> {
        self.title.as_deref()
    }

    /// Who sees the scene.
    pub fn observer(&self) -> &Observer {
        &self.observer
    }

    /// What the observer is at any proper time.
    pub fn flight(&self) -> &Flight {
        &self.flight
    }

    /// The scene's units in everyday units, if the scene says what they are.
    pub fn units(&self) -> Option<Units> {
        self.units
    }

    /// What there is to see; at least one, with names of their own.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Proper times of the observer at which the scene is seen; at least one.
    pub fn steps(&self) -> &[f64] {
        &self.steps
    }

    /// Event, velocity and axes of the observer at one step, counted from 0; `None` where the scene has no such step.
    pub fn moment(&self, step: usize) -> Option<Moment> {
        let proper_time = self.steps.get(step)?;
        Some(self.flight.moment(*proper_time))
    }
}

/// A scene as a file writes it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "photosurface scene")]
struct SceneFields {
    /// What the scene shows, for people.
    title: Option<String>,
    /// The scene's units in everyday units; only accelerations in g need them.
    #[serde(default)]
    #[schemars(with = "Option<Units>")]
    units: Option<FromObject<Units>>,
    /// The observer; at rest at the origin at time 0 if absent.
    #[serde(default, deserialize_with = "observer::observer")]
    #[schemars(with = "ObserverFields")]
    observer: ObserverFields,
    /// The objects.
    #[schemars(length(min = 1))]
    objects: Vec<Object>,
    /// Proper times of the observer after the observation event: a list, or `from`, `to` and `count`.
    /// The observation event alone if absent.
    #[serde(default)]
    steps: Steps,
    /// How far photosurfaces may be from the true ones; a thousandth of their diagonal if absent.
    #[serde(default)]
    tolerance: Tolerance,
    /// Which distance tolerances limit: "points", between where each point is drawn and where it is seen, or "surface",
    /// between meshes and photosurfaces as surfaces. If absent, "points" for objects with a texture, a checker, colours of
    /// vertices, attributes or effects of colour, else "surface".
    measure: Option<Measure>,
    /// Which effects of special relativity shapes are shown with; both, as `seen`, if absent.
    #[serde(default)]
    model: ViewModel,
    /// What is computed and written for every vertex beside its place; nothing if absent.
    #[serde(default)]
    attributes: Attributes,
    /// The lamps by which pictures of the scene are lit; without any, a lamp at the eye and a little light from above.
    #[serde(default)]
    #[schemars(with = "Vec<LampFields>")]
    lamps: Vec<Lamp>,
    /// What becomes of light on its way, beside shapes; nothing if absent.
    #[serde(default)]
    #[schemars(with = "Effects")]
    effects: Option<FromObject<Effects>>,
}

impl TryFrom<FromObject<SceneFields>> for Scene {
    type Error = InvalidScene;

    fn try_from(FromObject(fields): FromObject<SceneFields>) -> Result<Self, InvalidScene> {
        let units = fields.units.map(|FromObject(units)| units);
        let observer = fields.observer.observer(units)?;
        let mut objects = fields.objects;
        for object in &mut objects {
            object.model.get_or_insert(fields.model);
            object.measure = object.measure.or(fields.measure);
        }
        let scene = Self::new(observer, objects)?
            .with_steps(fields.steps.0)?
            .with_lamps(fields.lamps)?;
        Ok(Self {
            title: fields.title,
            units,
            tolerance: fields.tolerance,
            attributes: fields.attributes,
            effects: fields
                .effects
                .map_or(Effects::default(), |FromObject(effects)| effects),
            ..scene
        })
    }
}

impl Keyed for SceneFields {
    const EXPECTED: &'static str = "a scene like { \"objects\": [...] }";
}
