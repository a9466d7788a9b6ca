//! The check: what a scene holds and what an export of it would make, without making it.

use schemars::{JsonSchema, Schema};
use serde::Serialize;

use super::EffectCost;
use super::budget::Fitted;
use super::picture_settings::{PictureMethod, PictureSettings, PictureView};
use crate::pipeline::{Bounds, PlacedScene, PlacedSceneError};
use crate::scene::Measure;
use crate::spacetime::ViewModel;
use crate::write::{Provenance, schema_of};

/// What a scene holds, and what an export of it would make.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Check {
    /// What was read, and by which command.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// The format of the export: `glb`, `gltf` or `ply`.
    pub format: String,
    /// Whether all steps fit into one file, as far as that is known before they are made.
    pub fits_into_one_file: bool,
    /// Proper times of the observer at the steps, counted from the observation event, in scene units.
    pub steps: Vec<f64>,
    /// The objects, in the order of the scene.
    pub objects: Vec<CheckedObject>,
    /// The predictions: one for the tolerances of the scene, or one for each level of detail.
    pub levels: Vec<CheckedLevel>,
    /// Whether the export will end with all photosurfaces certified and in one file.
    pub certified: bool,
    /// What there is to know about the input and the export, in words.
    pub notes: Vec<String>,
}

/// Where an object is, and how fast.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckedObject {
    /// Its name in the scene.
    pub name: String,
    /// Which effects of special relativity it is shown with.
    pub model: ViewModel,
    /// Which distance its tolerance limits.
    pub measure: Measure,
    /// How many parts it has.
    pub parts: usize,
    /// Number of vertices at rest; a flat shape without a resolution has its coarsest form.
    pub vertices: usize,
    /// The largest Lorentz factor of the observer's velocity in the object's rest frame, over all steps.
    pub relative_gamma: f64,
    /// The rapidity of the same velocity.
    pub relative_rapidity: f64,
    /// The box around its vertices at rest, with the object's origin at its position: for an object at rest in the scene,
    /// its place there; for a moving object, in the axes of its rest frame. Absent if the object has no vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_rest: Option<Bounds>,
    /// The box around the places where these vertices, and of a flat shape many places between them, are seen at the steps
    /// that were looked at, in the observer's frame. Between them a photosurface may reach beyond.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub photosurface: Option<Bounds>,
    /// The same at each of these steps: at all, or at so many as together have some million vertices, evenly spread from the
    /// first to the last.
    pub photosurface_at_steps: Vec<CheckedStep>,
}

/// Where an object is seen at one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckedStep {
    /// The step, counted from 0.
    pub step: usize,
    /// Proper time of the observer at this step, in scene units.
    pub proper_time: f64,
    /// The box around the places where the vertices are seen, in the observer's frame.
    #[serde(flatten)]
    pub bounds: Bounds,
}

/// The prediction for all objects at one level of detail.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckedLevel {
    /// The prediction for each object, in the order of the scene.
    pub objects: Vec<CheckedTriangles>,
    /// How many photosurfaces there will be.
    pub photosurfaces: usize,
    /// About how many triangles they will have together.
    pub triangles: f64,
    /// Whether all will be certified.
    pub certified: bool,
    /// What each effect of the scene will cost on this computer.
    pub effects: Vec<CheckedEffect>,
}

/// The prediction for one object, all steps together.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckedTriangles {
    /// The name of the object in the scene.
    pub name: String,
    /// Its tolerance, as flags write it: `0.001`, `abs:0.01`, `deg:0.02`.
    pub tolerance: String,
    /// Number of triangles before refinement.
    pub triangles_in: f64,
    /// About how many triangles its photosurfaces will have.
    pub triangles: f64,
    /// Whether they will be certified.
    pub certified: bool,
}

/// What one effect costs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckedEffect {
    /// Its name in scenes.
    pub effect: String,
    /// Time for the colours of the vertices of the export, in seconds; absent for an effect without colours of vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub export_seconds: Option<f64>,
    /// About how many vertices the export will have.
    pub export_vertices: f64,
    /// Time for a picture of the default size all of whose rays meet surfaces, in seconds.
    pub picture_seconds: f64,
    /// Width and height of that picture, in pixels.
    pub picture_size: [u32; 2],
}

impl Check {
    /// The check as JSON text.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a check is names and numbers")
    }

    /// The JSON Schema of [`Check::to_json`].
    pub fn json_schema() -> Schema {
        schema_of::<Self>()
    }
}

impl CheckedObject {
    /// All objects of a scene.
    ///
    /// # Errors
    ///
    /// An error is returned if the scene has no photosurfaces at a step.
    pub fn of_scene(placed: &PlacedScene) -> Result<Vec<Self>, PlacedSceneError> {
        let joined = |boxes: Option<Bounds>, other: Option<Bounds>| match (boxes, other) {
            (Some(boxes), Some(other)) => Some(boxes.joined(other)),
            (boxes, other) => boxes.or(other),
        };
        let mut objects: Vec<Self> = placed
            .objects()
            .map(|(object, parts)| {
                let meshes = || parts.iter().map(|(_, part)| part.mesh());
                let relative = placed.fastest_relative_velocity(object);
                Self {
                    name: object.name.clone(),
                    model: object.view_model(),
                    measure: placed.measure(object, parts),
                    parts: parts.len(),
                    vertices: meshes().map(|mesh| mesh.vertex_count()).sum(),
                    relative_gamma: relative.gamma(),
                    relative_rapidity: relative.rapidity(),
                    at_rest: meshes()
                        .map(|mesh| {
                            let (low, high) = mesh.bounds()?;
                            let position = object.position.get();
                            Some(Bounds::new((low + position, high + position)))
                        })
                        .fold(None, joined),
                    photosurface: None,
                    photosurface_at_steps: vec![],
                }
            })
            .collect();
        let steps = placed.scene().steps();
        for step in steps_looked_at(steps.len(), placed.vertices_at_rest()) {
            let proper_time = steps[step];
            for (object, extremes) in objects.iter_mut().zip(placed.seen_extremes(step)?) {
                let bounds = extremes.bounds().map(Bounds::new);
                object.photosurface = joined(object.photosurface, bounds);
                object
                    .photosurface_at_steps
                    .extend(bounds.map(|bounds| CheckedStep {
                        step,
                        proper_time,
                        bounds,
                    }));
            }
        }
        Ok(objects)
    }
}

/// At most so many vertices are looked at, unless one step has more.
const MAX_VERTICES: usize = 5_000_000;

/// Steps of which bounds are told: all if they are few, else evenly spread, the first and the last among them.
fn steps_looked_at(steps: usize, vertices: usize) -> Vec<usize> {
    let count = (MAX_VERTICES / vertices.max(1)).clamp(2, steps.max(2));
    match count >= steps {
        true => (0..steps).collect(),
        false => (0..count)
            .map(|number| number * (steps - 1) / (count - 1))
            .collect(),
    }
}

impl CheckedLevel {
    /// The predictions of one level of detail.
    pub fn new(fitted: &Fitted) -> Self {
        let placed = &fitted.placed;
        let scene = placed.scene();
        let objects = placed.objects().zip(&fitted.predictions);
        let objects: Vec<_> = objects
            .map(|((object, _), prediction)| CheckedTriangles {
                name: object.name.clone(),
                tolerance: scene.tolerance(object).to_flag(),
                triangles_in: prediction.triangles_in,
                triangles: prediction.triangles,
                certified: prediction.reachable,
            })
            .collect();
        let parts: usize = placed.objects().map(|(_, parts)| parts.len()).sum();
        Self {
            photosurfaces: parts * scene.steps().len(),
            triangles: objects.iter().map(|object| object.triangles).sum(),
            certified: objects.iter().all(|object| object.certified),
            effects: CheckedEffect::of(fitted),
            objects,
        }
    }
}

impl CheckedEffect {
    /// All effects of a scene.
    fn of(fitted: &Fitted) -> Vec<Self> {
        let placed = &fitted.placed;
        let costs = EffectCost::of(placed);
        // As many vertices for a triangle as there are at rest, and half a vertex for each triangle that refinement adds:
        // a vertex inside a facet adds two.
        let vertices = placed.objects().zip(&fitted.predictions);
        let vertices = vertices.map(|((_, parts), prediction)| {
            let meshes = || parts.iter().map(|(_, part)| part.mesh());
            let vertices: usize = meshes().map(|mesh| mesh.vertex_count()).sum();
            let triangles: usize = meshes().map(|mesh| mesh.triangle_count()).sum();
            let for_each = vertices as f64 / triangles.max(1) as f64;
            let before = prediction.triangles_in;
            before * for_each + 0.5 * (prediction.triangles - before)
        });
        let vertices: f64 = vertices.sum();
        let picture = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
        let (size, samples) = (picture.camera.size, f64::from(picture.samples.get()));
        let rays = f64::from(size.width()) * f64::from(size.height()) * samples * samples;
        let costs = costs.into_iter().map(|cost| {
            let colors = matches!(cost.effect, "doppler" | "emission");
            Self {
                effect: cost.effect.to_owned(),
                export_seconds: colors.then(|| cost.seconds(vertices)),
                export_vertices: vertices,
                picture_seconds: cost.seconds(rays),
                picture_size: [size.width(), size.height()],
            }
        });
        costs.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_of_many_steps_are_looked_at() {
        assert_eq!(steps_looked_at(7, 1000), Vec::from_iter(0..7));
        assert_eq!(steps_looked_at(0, 0), [0; 0]);
        assert_eq!(steps_looked_at(1, usize::MAX), [0]);
        assert_eq!(steps_looked_at(100, 10_000_000), [0, 99]);
        let some = steps_looked_at(100_000, 5000);
        assert_eq!((some.len(), some[0], some[999]), (1000, 0, 99_999));
        assert!(some.is_sorted());
    }
}
