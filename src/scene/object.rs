//! An object of a scene, and where its geometry comes from.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;

use super::forms::{self, FromObject, Keyed, VelocityForm};
use super::{Emission, InvalidScene, Measure, Place, Scale, Tolerance};
use crate::material::{Model, Normals};
use crate::shape::{Appearance, Color, Shape};
use crate::spacetime::{Event, Rotation, Velocity, ViewModel, WorldLine};

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
    /// Which distance the tolerance limits; if absent, that of surfaces for round shapes without checker in scenes without
    /// attributes and effects of colour, else that of points.
    pub measure: Option<Measure>,
    /// Which effects of special relativity its shape is shown with; if absent, those that the scene file says, or both.
    pub model: Option<ViewModel>,
    /// Which normals the parts of its file get; if absent, those of the file.
    pub normals: Option<Normals>,
    /// Its own light, if it is a black body; pictures and colours of vertices show it in place of its material.
    pub emission: Option<Emission>,
}

/// Where the geometry of an object comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A glTF, GLB, OBJ, PLY, STL or OFF file.
    File(PathBuf),
    /// A shape that the program makes itself.
    Shape(Shape, Appearance),
    /// Geometry that is at hand already; only from Rust.
    Model(Arc<Model>),
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
            measure: None,
            model: None,
            normals: None,
            emission: None,
        }
    }

    /// The worldline of the object's origin.
    pub fn world_line(&self) -> WorldLine {
        WorldLine {
            origin: Event::new(0.0, self.position.get()),
            velocity: self.velocity,
        }
    }

    /// Which effects of special relativity its shape is shown with.
    pub fn view_model(&self) -> ViewModel {
        self.model.unwrap_or_default()
    }

    /// From the coordinates of the model to the rest frame, origin at the object's origin.
    pub fn model_to_rest(&self) -> DAffine3 {
        let (scale, rotation) = (self.scale.get(), self.rotation.get());
        DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::ZERO)
    }
}

/// An object as a file writes it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [{ "required": ["file"] }, { "required": ["shape"] }],
    "dependentRequired" = { "color": ["shape"], "checker": ["shape"], "normals": ["file"] },
))]
struct ObjectFields {
    /// Names the object in the output; unique in the scene.
    #[schemars(length(min = 1))]
    name: String,
    /// A glTF, GLB, OBJ, PLY, STL or OFF file, relative to the scene file. Either this or `shape`.
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
    /// Which distance the tolerance of this object limits: "points", between where each point is drawn and where it is seen,
    /// or "surface", between the mesh and the photosurface as surfaces. What the scene says if absent.
    measure: Option<Measure>,
    /// Which effects of special relativity this object's shape is shown with; those that the scene says if absent.
    model: Option<ViewModel>,
    /// Which normals the parts of a file get: "source", those of the file, and of flat facets for a part without any; "smooth",
    /// with shared vertices, parted along creases of more than 60 degrees, or of so many in "smooth:30"; "flat"; or "none".
    /// All but "source" replace the normals of the file.
    #[serde(default)]
    #[schemars(with = "Normals")]
    normals: Option<Normals>,
    /// Makes the object a black body, which needs no lamp; its material then has no say.
    #[serde(default)]
    #[schemars(with = "Option<Emission>")]
    emission: Option<FromObject<Emission>>,
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
                let default = Appearance::default();
                let appearance = Appearance {
                    color: fields.color.unwrap_or(default.color),
                    checker: fields.checker,
                };
                Source::Shape(shape, appearance)
            }
            (file, _) => {
                let found = if file.is_some() { "both" } else { "neither of" };
                return Err(InvalidScene::Source { name, found });
            }
        };
        if fields.normals.is_some() && !matches!(source, Source::File(_)) {
            return Err(InvalidScene::NormalsOfShape(name));
        }
        Ok(Self {
            name,
            source,
            position: fields.position,
            rotation: fields.rotation,
            scale: fields.scale,
            velocity: fields.velocity,
            tolerance: fields.tolerance,
            measure: fields.measure,
            model: fields.model,
            normals: fields.normals,
            emission: fields.emission.map(|FromObject(emission)| emission),
        })
    }
}

impl Keyed for ObjectFields {
    const EXPECTED: &'static str =
        "an object like { \"name\": \"ball\", \"shape\": { \"sphere\": { \"radius\": 1 } } }";
}
