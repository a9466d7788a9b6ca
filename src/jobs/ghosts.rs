//! Ghosts: the outlines of objects under other models, beside what is shown of them.

use std::collections::HashSet;

use glam::{DAffine3, DVec3};

use super::contrast::legible;
use crate::light_cone::View;
use crate::mesh::Mesh;
use crate::pipeline::{PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::render::{Camera, Strokes};
use crate::shape::Color;
use crate::spacetime::ViewModel;

/// A crease is where the normals of two faces differ by more than this angle, in radians.
const SHARP: f64 = 0.5;

/// A mesh that is one thing with edges has few creases for its number of edges; a scan has them everywhere. Up to so many
/// for the square root of the number of edges they are drawn.
const CREASES: f64 = 12.0;

/// Creases of this mean length in pixels are lines whatever their number.
const LINE_PX: f64 = 4.0;

/// Of many creases so many are measured, spread over all.
const MEASURED: usize = 2000;

/// The colour of a ghost on a dark background.
pub(super) fn ghost_color(model: ViewModel) -> Color {
    match model {
        ViewModel::Seen => Color([0x48, 0xc9, 0x8b]),
        ViewModel::Delayed => Color([0xb5, 0x7e, 0xdc]),
        ViewModel::Contracted => Color([0xf0, 0x9a, 0x2a]),
        ViewModel::Rest => Color([0x5d, 0xad, 0xe2]),
    }
}

/// A ghost in the observer's frame.
pub(super) struct Ghost {
    pub(super) mesh: Mesh,
    model: ViewModel,
}

impl Ghost {
    /// The colour on this background.
    pub(super) fn color(&self, background: Color) -> Color {
        legible(ghost_color(self.model), background)
    }

    /// The lines of a drawing by a camera at `eye`: where the surface ends, where it turns away from the camera, and its
    /// creases where they are lines and not the roughness of a scan.
    pub(super) fn strokes(&self, camera: &Camera, eye: DVec3, background: Color) -> Strokes<DVec3> {
        let outline = self.mesh.outline(eye, SHARP);
        let mut lines = outline.lines;
        let few = CREASES * (outline.edges as f64).sqrt();
        if outline.creases.len() as f64 <= few || mean_px(&outline.creases, camera, eye) > LINE_PX {
            lines.extend(outline.creases);
        }
        Strokes {
            lines,
            color: self.color(background),
            width_px: 1.5,
        }
    }
}

/// The mean length of lines on a picture, in pixels; 0 if none of them is on it.
fn mean_px(lines: &[[DVec3; 2]], camera: &Camera, eye: DVec3) -> f64 {
    let every = lines.len().div_ceil(MEASURED).max(1);
    let lengths = lines.iter().step_by(every).filter_map(|[start, end]| {
        let (start, end) = (camera.place(*start - eye)?, camera.place(*end - eye)?);
        Some(start.distance(end))
    });
    let (count, sum) = lengths.fold((0, 0.0), |(count, sum), length| (count + 1, sum + length));
    sum / f64::from(count.max(1))
}

/// The ghosts of one step of a scene under these models; those whose edges bend are made with `options`.
pub(super) fn ghosts(
    models: &[ViewModel],
    placed: &PlacedScene,
    step: usize,
    options: SurfaceOptions,
) -> Result<Vec<Ghost>, PlacedSceneError> {
    let mut ghosts = Vec::new();
    for &model in models {
        // Nothing is a ghost of itself.
        let objects = placed.scene().objects().iter();
        let shown = objects.filter(|object| object.view_model() == model);
        let shown: HashSet<String> = shown.map(|object| object.name.clone()).collect();
        let meshes = match model.has_delay() {
            true => {
                let placed = placed.clone().with_model_for_all(model)?;
                let surfaces = placed.photosurfaces(step, options)?;
                let surfaces = surfaces.filter(|surface| !shown.contains(&surface.facts.object));
                surfaces.map(|surface| surface.mesh).collect()
            }
            false => straight_ghosts(placed, model, step),
        };
        ghosts.extend(meshes.into_iter().map(|mesh| Ghost { mesh, model }));
    }
    Ok(ghosts)
}

/// The map from the rest frame of an object to the observer's frame at rest, moved so that the object's middle, at
/// `middle_rest`, is where it is seen.
fn rest_to_seen_middle(view: &View, middle_rest: DVec3) -> DAffine3 {
    let turned = DAffine3::from_quat(view.rotation());
    let offset = view.seen_position(middle_rest) - turned.transform_point3(middle_rest);
    DAffine3::from_translation(offset) * turned
}

/// The meshes of all objects under a model without delay, whose edges stay straight.
fn straight_ghosts(placed: &PlacedScene, model: ViewModel, step: usize) -> Vec<Mesh> {
    let mut meshes = Vec::new();
    for (object, parts) in placed.looked_at() {
        if object.view_model() == model {
            continue;
        }
        let Some(view) = placed.view(object, step) else {
            return meshes;
        };
        let bounds = parts.iter().filter_map(|(_, part)| part.mesh().bounds());
        let (low, high) = bounds.fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), (a, b)| (low.min(a), high.max(b)),
        );
        let shown = match model.has_contraction() {
            true => view.rest_to_now(),
            false => rest_to_seen_middle(&view, (low + high) / 2.0),
        };
        let parts = parts.iter().map(|(_, part)| part.mesh().clone());
        meshes.extend(parts.map(|mesh| mesh.transformed(&shown)));
    }
    meshes
}
