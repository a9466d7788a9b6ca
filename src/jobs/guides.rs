//! Guides that help to read a picture: ghosts, axes, a scale bar, labels.

use std::collections::HashSet;

use glam::{DAffine3, DVec2, DVec3};

use super::outside_camera::OutsideCamera;
use crate::light_cone::View;
use crate::mesh::Mesh;
use crate::pipeline::{PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::render::{Picture, Scenery, Strokes, Viewpoint, lettering_width};
use crate::shape::Color;
use crate::spacetime::ViewModel;

/// An edge of a ghost is drawn if the normals of its two faces differ by more than this angle, in radians.
const SHARP: f64 = 0.5;

/// Height of letters as a fraction of the picture's height; at least 8 pixels are used.
const LETTERS: f64 = 1.0 / 30.0;

const RED: Color = Color([0xe7, 0x4c, 0x3c]);
const GREEN: Color = Color([0x2e, 0xa8, 0x5a]);
const BLUE: Color = Color([0x3d, 0x8b, 0xe8]);

/// Marks in pictures that help to read them; the default is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Guides {
    /// Models under which each object is hinted at beside what is shown of it: the photosurface green, delayed violet,
    /// contracted orange, at rest blue. A model that is listed twice is drawn twice.
    ///
    /// An object has no ghost under the model that it is shown under. A ghost at rest is moved to the place where the object's middle is seen.
    pub ghosts: Vec<ViewModel>,
    /// Whether the observer's axes are drawn at the observer in views from outside: x red, y green, z blue.
    pub axes: bool,
    /// Whether a bar is drawn in views from outside that shows a round length, in scene units, at the distance of the camera's target.
    /// Pictures of the whole sky have no scale and no bar.
    pub scale_bar: bool,
    /// Whether the edges of all triangles of photosurfaces are drawn, also in the observer's pictures of them.
    pub wireframe: bool,
}

/// The colour of a ghost.
fn ghost_color(model: ViewModel) -> Color {
    match model {
        ViewModel::Seen => Color([0x48, 0xc9, 0x8b]),
        ViewModel::Delayed => Color([0xb5, 0x7e, 0xdc]),
        ViewModel::Contracted => Color([0xf0, 0x9a, 0x2a]),
        ViewModel::Rest => Color([0x5d, 0xad, 0xe2]),
    }
}

/// The map from the rest frame of an object to the observer's frame at rest, moved so that the object's middle, at
/// `middle_rest`, is where it is seen.
fn rest_to_seen_middle(view: &View, middle_rest: DVec3) -> DAffine3 {
    let turned = DAffine3::from_quat(view.rotation());
    let offset = view.seen_position(middle_rest) - turned.transform_point3(middle_rest);
    DAffine3::from_translation(offset) * turned
}

/// A ghost in the observer's frame, with its edges.
pub(super) type Ghost = (Mesh, Strokes<DVec3>);

impl Guides {
    /// The ghosts of one step of a scene; those whose edges bend are made with `options`.
    pub(super) fn ghosts(
        &self,
        placed: &PlacedScene,
        step: usize,
        options: SurfaceOptions,
    ) -> Result<Vec<Ghost>, PlacedSceneError> {
        let mut ghosts = Vec::new();
        for &model in &self.ghosts {
            // Nothing is a ghost of itself.
            let objects = placed.scene().objects().iter();
            let shown = objects.filter(|object| object.view_model() == model);
            let shown: HashSet<String> = shown.map(|object| object.name.clone()).collect();
            let meshes = match model.has_delay() {
                true => {
                    let placed = placed.clone().with_model_for_all(model)?;
                    let surfaces = placed.photosurfaces(step, options)?;
                    let surfaces =
                        surfaces.filter(|surface| !shown.contains(&surface.facts.object));
                    surfaces.map(|surface| surface.mesh).collect()
                }
                false => straight_ghosts(placed, model, step),
            };
            ghosts.extend(meshes.into_iter().map(|mesh| {
                let edges = Strokes {
                    lines: mesh.sharp_edges(SHARP),
                    color: ghost_color(model),
                    width_px: 1.5,
                };
                (mesh, edges)
            }));
        }
        Ok(ghosts)
    }

    /// Draws the edges of ghosts, and the axes and the bar if they are asked for, onto a picture from outside.
    pub(super) fn draw(
        &self,
        picture: &mut Picture,
        outside: &OutsideCamera,
        scenery: &Scenery,
        ghost_edges: &[Strokes<DVec3>],
        background: Color,
    ) {
        let viewpoint = Viewpoint::Outside(outside.place);
        scenery.draw(picture, &outside.camera, viewpoint, ghost_edges);
        if self.axes {
            draw_axes(picture, outside, scenery);
        }
        if self.scale_bar && outside.has_scale {
            draw_scale_bar(picture, outside, contrasting(background));
        }
    }
}

/// The meshes of all objects under a model without delay, whose edges stay straight.
fn straight_ghosts(placed: &PlacedScene, model: ViewModel, step: usize) -> Vec<Mesh> {
    let mut meshes = Vec::new();
    for (object, parts) in placed.objects() {
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

/// Draws the axes of the observer, each with its name at its end.
fn draw_axes(picture: &mut Picture, outside: &OutsideCamera, scenery: &Scenery) {
    let length = outside.axes;
    for (axis, name, color) in [
        (DVec3::X, "x", RED),
        (DVec3::Y, "y", GREEN),
        (DVec3::Z, "z", BLUE),
    ] {
        let line = Strokes {
            lines: vec![[DVec3::ZERO, axis * length]],
            color,
            width_px: 2.0,
        };
        let viewpoint = Viewpoint::Outside(outside.place);
        let lines = std::slice::from_ref(&line);
        scenery.draw(picture, &outside.camera, viewpoint, lines);
        let end = axis * (1.15 * length) - outside.place;
        if let Some(end) = outside.camera.place(end) {
            let height = letters(picture);
            let middle = DVec2::new(-lettering_width(name, height), height) / 2.0;
            write(picture, name, end + middle, color);
        }
    }
}

/// Draws a bar of a round length in the lower left corner, with that length above it.
fn draw_scale_bar(picture: &mut Picture, outside: &OutsideCamera, color: Color) {
    let (width, height) = (picture.size().width(), picture.size().height());
    let per_unit = f64::from(height) / outside.height;
    let length = round_below(0.2 * f64::from(width) / per_unit);
    let letters = letters(picture);
    let start = DVec2::new(letters, f64::from(height) - letters);
    let end = start + DVec2::X * (length * per_unit);
    let tick = DVec2::Y * (letters / 3.0);
    picture.draw(&Strokes {
        lines: vec![[start, end], [start - tick, start], [end - tick, end]],
        color,
        width_px: 2.0,
    });
    write(picture, &length.to_string(), start - 2.0 * tick, color);
}

/// Writes a label into the upper left corner of a picture.
pub(super) fn label(picture: &mut Picture, text: &str, background: Color) {
    let start = DVec2::new(0.8, 1.8) * letters(picture);
    write(picture, text, start, contrasting(background));
}

/// Height of letters on a picture, in pixels.
pub(super) fn letters(picture: &Picture) -> f64 {
    (f64::from(picture.size().height()) * LETTERS).max(8.0)
}

fn write(picture: &mut Picture, text: &str, start: DVec2, color: Color) {
    let height = letters(picture);
    picture.write(text, start, height, color);
}

/// A grey that stands out against the background, darker or lighter than it.
fn contrasting(background: Color) -> Color {
    let [red, green, blue] = background.linear();
    let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    Color(if luminance > 0.18 {
        [0x20; 3]
    } else {
        [0xd8; 3]
    })
}

/// The largest number up to `limit` that is 1, 2 or 5 times a power of ten.
pub(super) fn round_below(limit: f64) -> f64 {
    let exponent = limit.log10().floor();
    let power = 10f64.powi(exponent.abs() as i32);
    let round = |digit: f64| {
        if exponent < 0.0 {
            digit / power
        } else {
            digit * power
        }
    };
    let fitting = [5.0, 2.0].map(round).into_iter().find(|&n| n <= limit);
    fitting.unwrap_or(round(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_have_round_lengths() {
        for (limit, expected) in [
            (1.0, 1.0),
            (1.99, 1.0),
            (4.9, 2.0),
            (7.0, 5.0),
            (0.03, 0.02),
            (99.0, 50.0),
            (0.5, 0.5),
        ] {
            assert_eq!(round_below(limit), expected);
        }
    }

    #[test]
    fn lines_are_told_from_the_background() {
        assert_eq!(contrasting(Color([0; 3])), Color([0xd8; 3]));
        assert_eq!(contrasting(Color([255; 3])), Color([0x20; 3]));
    }
}
