//! What a user asks for: the observer, the objects, the steps; read from JSON and checked.
//!
//! A scene is text and numbers only. Files that it names are read by the room `jobs`.

mod attributes;
mod built_in;
mod forms;
mod json;
mod marker;
mod place;
mod scale;
mod tolerance;

pub use attributes::{Attribute, Attributes, UnknownAttribute};
pub use built_in::{BUILT_IN_SCENES, BuiltInScene};
pub use json::SceneError;
pub use marker::{MarkerRadius, MarkerRadiusError};
pub use place::{Place, PlaceError, Time, TimeError};
pub use scale::Scale;
pub use tolerance::{Tolerance, ToleranceError, Unit};

use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use crate::material::Model;
use crate::shape::{Appearance, Color, Shape};
use crate::spacetime::{Event, Moment, Velocity, WorldLine};
pub use crate::spacetime::{Rotation, RotationError};
use forms::{FromObject, Steps, VelocityForm};

/// Most evenly spaced steps one scene may have: a guard against slips of the pen.
const MAX_STEPS: usize = 100_000;

/// An observer and what there is to see.
///
/// Everything is given in the scene frame: c = 1, y up, lengths and times in one unit.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "FromObject<SceneFields>")]
#[schemars(with = "SceneFields")]
pub struct Scene {
    title: Option<String>,
    observer: Observer,
    objects: Vec<Object>,
    steps: Vec<f64>,
    tolerance: Tolerance,
    attributes: Attributes,
}

/// Who sees the scene.
#[derive(Clone, Copy, Debug, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Observer {
    /// Scene time of the observation.
    #[schemars(with = "f64")]
    pub time: Time,
    /// Place of the observation in the scene frame.
    #[schemars(with = "[f64; 3]")]
    pub position: Place,
    /// The observer's velocity in the scene frame.
    #[serde(deserialize_with = "forms::velocity")]
    #[schemars(with = "VelocityForm")]
    pub velocity: Velocity,
    /// Radius of a small sphere that marks the observer in the output; no marker without it.
    pub marker: Option<MarkerRadius>,
}

/// A thing in uniform motion.
///
/// Its origin is at `position` at scene time 0 and moves with `velocity`; `rotation` and `scale` act in
/// its rest frame, whose axes are those of the scene under a pure boost.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "FromObject<ObjectFields>")]
#[schemars(with = "ObjectFields")]
pub struct Object {
    /// Names the object in the output; unique in the scene.
    pub name: String,
    /// Where its geometry comes from.
    pub source: Source,
    /// Where its origin is at scene time 0, in the scene frame.
    pub position: Place,
    /// Turns its geometry, after `scale`, in the rest frame.
    pub rotation: Rotation,
    /// Stretches its geometry along its own axes.
    pub scale: Scale,
    /// Its velocity in the scene frame.
    pub velocity: Velocity,
    /// How far its photosurface may be from the true one, if not as far as the scene says.
    pub tolerance: Option<Tolerance>,
}

/// Where the geometry of an object comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A glTF, GLB or OBJ file.
    File(PathBuf),
    /// A shape that the program makes itself.
    Shape(Shape, Appearance),
    /// Geometry that is at hand already; only from Rust.
    Model(Arc<Model>),
}

/// Why well-formed values do not make a scene.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum InvalidScene {
    /// Nothing to see.
    #[error("the scene has no objects, expected at least one")]
    NoObjects,
    /// An object without a name.
    #[error("objects[{0}] has an empty name, expected a name to call it by in the output")]
    EmptyName(usize),
    /// Two objects of one name.
    #[error("two objects are named \"{0}\", expected a name of its own for each")]
    RepeatedName(String),
    /// No source or two.
    #[error("object \"{name}\" has {found}, expected either \"file\" or \"shape\"")]
    Source {
        /// Which object.
        name: String,
        /// What it has.
        found: &'static str,
    },
    /// Looks given for something that brings its own.
    #[error(
        "object \"{name}\" comes from a file, which has its own colours; \"{field}\" is for shapes"
    )]
    LooksOfFile {
        /// Which object.
        name: String,
        /// The key that does not belong.
        field: &'static str,
    },
    /// No steps at all.
    #[error("the list of steps is empty, expected at least one proper time")]
    NoSteps,
    /// Too many or too few evenly spaced steps.
    #[error("count is {0}, expected 1 to {MAX_STEPS} steps")]
    StepCount(usize),
    /// A step that is not a number.
    #[error("step {0} is {1}, expected a finite proper time")]
    Step(usize, f64),
}

impl Scene {
    /// A scene of `objects` seen by `observer` at the observation event alone.
    ///
    /// # Errors
    ///
    /// No objects, or two of one name.
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
            observer,
            objects,
            steps: vec![0.0],
            tolerance: Tolerance::default(),
            attributes: Attributes::default(),
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
    #[must_use]
    pub fn with_observer(mut self, observer: Observer) -> Self {
        self.observer = observer;
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

    /// The scene with these attributes asked for, and no others.
    #[must_use]
    pub fn with_attributes(mut self, attributes: Attributes) -> Self {
        self.attributes = attributes;
        self
    }

    /// What is asked for at every vertex.
    pub fn attributes(&self) -> Attributes {
        self.attributes
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
        Some(self.observer.moment(*proper_time))
    }
}

/// `count` evenly spaced proper times, the first `from`, the last `to`; `from` alone if `count` is 1.
///
/// # Errors
///
/// `count` is zero or above a hundred thousand, or an end is not finite.
pub fn even_steps(from: f64, to: f64, count: usize) -> Result<Vec<f64>, InvalidScene> {
    if count == 0 || count > MAX_STEPS {
        return Err(InvalidScene::StepCount(count));
    }
    for (index, end) in [(0, from), (count - 1, to)] {
        if !end.is_finite() {
            return Err(InvalidScene::Step(index, end));
        }
    }
    let intervals = (count - 1).max(1) as f64;
    let step = |index: usize| {
        let part = index as f64 / intervals;
        match index {
            0 => from,
            _ if index == count - 1 => to,
            // The difference of two numbers of a scene may be beyond f64.
            _ if !(to - from).is_finite() => from * (1.0 - part) + to * part,
            _ => from + (to - from) * part,
        }
    };
    Ok((0..count).map(step).collect())
}

impl Observer {
    /// What the observer is at `proper_time` after the observation event.
    pub fn moment(&self, proper_time: f64) -> Moment {
        let line = WorldLine {
            origin: Event::new(self.time.get(), self.position.get()),
            velocity: self.velocity,
        };
        line.moment(proper_time)
    }
}

impl Object {
    /// An object at rest at the origin of the scene.
    pub fn new(name: impl Into<String>, source: Source) -> Self {
        Self {
            name: name.into(),
            source,
            position: Place::ORIGIN,
            rotation: Rotation::IDENTITY,
            scale: Scale::default(),
            velocity: Velocity::ZERO,
            tolerance: None,
        }
    }

    /// The worldline of the object's origin.
    pub fn world_line(&self) -> WorldLine {
        WorldLine {
            origin: Event::new(0.0, self.position.get()),
            velocity: self.velocity,
        }
    }

    /// From the coordinates of the model to the rest frame, origin at the object's origin.
    pub fn model_to_rest(&self) -> DAffine3 {
        let (scale, rotation) = (self.scale.get(), self.rotation.get());
        DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::ZERO)
    }
}

/// A scene as a file writes it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "photosurface scene")]
struct SceneFields {
    /// What the scene shows, for people.
    title: Option<String>,
    /// Who sees the scene; at rest at the origin at time 0 if absent.
    #[serde(default, deserialize_with = "forms::from_object")]
    #[schemars(with = "Observer")]
    observer: Observer,
    /// What there is to see.
    #[schemars(length(min = 1))]
    objects: Vec<Object>,
    /// Proper times of the observer after the observation event: a list, or `from`, `to` and `count`.
    /// The observation event alone if absent.
    #[serde(default)]
    steps: Steps,
    /// How far photosurfaces may be from the true ones; a thousandth of their diagonal if absent.
    #[serde(default)]
    tolerance: Tolerance,
    /// What is computed and written for every vertex beside its place; nothing if absent.
    #[serde(default)]
    attributes: Attributes,
}

impl TryFrom<FromObject<SceneFields>> for Scene {
    type Error = InvalidScene;

    fn try_from(FromObject(fields): FromObject<SceneFields>) -> Result<Self, InvalidScene> {
        let scene = Self::new(fields.observer, fields.objects)?.with_steps(fields.steps.0)?;
        Ok(Self {
            title: fields.title,
            tolerance: fields.tolerance,
            attributes: fields.attributes,
            ..scene
        })
    }
}

/// An object as a file writes it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [{ "required": ["file"] }, { "required": ["shape"] }],
    "dependentRequired" = { "color": ["shape"], "checker": ["shape"] },
))]
struct ObjectFields {
    /// Names the object in the output; unique in the scene.
    #[schemars(length(min = 1))]
    name: String,
    /// A glTF, GLB or OBJ file, relative to the scene file. Either this or `shape`.
    #[serde(default, deserialize_with = "forms::file")]
    #[schemars(with = "String", length(min = 1))]
    file: Option<PathBuf>,
    /// A shape that the program makes itself. Either this or `file`.
    #[serde(default, deserialize_with = "forms::shape")]
    #[schemars(with = "Shape")]
    shape: Option<Shape>,
    /// Colour of a shape, "#rrggbb".
    color: Option<Color>,
    /// Second colour of a shape, "#rrggbb"; with it the shape is checkered.
    checker: Option<Color>,
    /// Where the object's origin is at scene time 0, in the scene frame; the scene's origin if absent.
    #[serde(default)]
    #[schemars(with = "[f64; 3]")]
    position: Place,
    /// Turns the geometry, after `scale`, in the rest frame: a unit quaternion [x, y, z, w].
    #[serde(default)]
    #[schemars(with = "[f64; 4]")]
    rotation: Rotation,
    /// Stretches the geometry along its own axes: one factor or three, positive; 1 if absent.
    #[serde(default)]
    scale: Scale,
    /// The object's velocity in the scene frame; at rest if absent.
    #[serde(default, deserialize_with = "forms::velocity")]
    #[schemars(with = "VelocityForm")]
    velocity: Velocity,
    /// How far this object's photosurface may be from the true one; as far as the scene says if absent.
    tolerance: Option<Tolerance>,
}

impl TryFrom<FromObject<ObjectFields>> for Object {
    type Error = InvalidScene;

    fn try_from(FromObject(fields): FromObject<ObjectFields>) -> Result<Self, InvalidScene> {
        let name = fields.name;
        let source = match (fields.file, fields.shape) {
            (Some(file), None) => {
                let looks = [("color", fields.color), ("checker", fields.checker)];
                if let Some((field, _)) = looks.iter().find(|(_, color)| color.is_some()) {
                    return Err(InvalidScene::LooksOfFile { name, field });
                }
                Source::File(file)
            }
            (None, Some(shape)) => {
                let plain = Appearance::default();
                let appearance = Appearance {
                    color: fields.color.unwrap_or(plain.color),
                    checker: fields.checker,
                };
                Source::Shape(shape, appearance)
            }
            (file, _) => {
                let found = if file.is_some() { "both" } else { "neither" };
                return Err(InvalidScene::Source { name, found });
            }
        };
        Ok(Self {
            name,
            source,
            position: fields.position,
            rotation: fields.rotation,
            scale: fields.scale,
            velocity: fields.velocity,
            tolerance: fields.tolerance,
        })
    }
}
