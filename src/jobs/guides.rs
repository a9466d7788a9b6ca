//! Guides that help to read a picture from outside: ghosts, axes, a scale bar, labels.

use glam::{DAffine3, DVec2, DVec3};

use super::framing::OutsideCamera;
use crate::light_cone::View;
use crate::mesh::Mesh;
use crate::pipeline::PlacedScene;
use crate::render::{Picture, Scenery, Strokes, Viewpoint, lettering_width};
use crate::shape::Color;

/// An edge of a ghost is drawn if the normals of its two faces differ by more than this angle, in radians.
const SHARP: f64 = 0.5;

/// Height of letters as a fraction of the picture's height; at least 8 pixels are used.
const LETTERS: f64 = 1.0 / 30.0;

const RED: Color = Color([0xe7, 0x4c, 0x3c]);
const GREEN: Color = Color([0x2e, 0xa8, 0x5a]);
const BLUE: Color = Color([0x3d, 0x8b, 0xe8]);

/// Marks in pictures from outside that help to read them; the default is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Guides {
    /// Other shapes of each object that are drawn as ghosts; a ghost that is listed twice is drawn twice.
    pub ghosts: Vec<Ghost>,
    /// Whether the observer's axes are drawn at the observer: x red, y green, z blue.
    pub axes: bool,
    /// Whether a bar is drawn that shows a round length, in scene units, at the distance of the camera's target.
    /// Pictures of the whole sky have no scale and no bar.
    pub scale_bar: bool,
    /// Whether the edges of all triangles of photosurfaces are drawn, also in the observer's pictures of them.
    pub wireframe: bool,
}

/// Another shape of an object, shown beside its photosurface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ghost {
    /// The object as it is in its rest frame, around the point where its middle is seen (blue).
    Rest,
    /// The object where it is in the observer's frame at the moment of observation, with Lorentz contraction (orange).
    Contracted,
}

impl Ghost {
    fn color(self) -> Color {
        match self {
            Self::Rest => Color([0x5d, 0xad, 0xe2]),
            Self::Contracted => Color([0xf0, 0x9a, 0x2a]),
        }
    }

    /// The map from the rest frame of an object to the observer's frame, where the ghost is shown; the middle of the object
    /// is at `middle_rest`.
    fn rest_to_shown(self, view: &View, middle_rest: DVec3) -> DAffine3 {
        match self {
            Self::Contracted => view.rest_to_now(),
            Self::Rest => {
                let turned = DAffine3::from_quat(view.rotation());
                let offset = view.seen_position(middle_rest) - turned.transform_point3(middle_rest);
                DAffine3::from_translation(offset) * turned
            }
        }
    }
}

impl Guides {
    /// The ghosts of one step of a scene, in the observer's frame, each with its edges.
    pub(super) fn ghosts(&self, placed: &PlacedScene, step: usize) -> Vec<(Mesh, Strokes<DVec3>)> {
        let mut ghosts = Vec::new();
        if self.ghosts.is_empty() {
            return ghosts;
        }
        for (object, parts) in placed.objects() {
            let Some(view) = placed.view(object, step) else {
                return ghosts;
            };
            let bounds = parts.iter().filter_map(|(_, part)| part.mesh().bounds());
            let (low, high) = bounds.fold(
                (DVec3::INFINITY, DVec3::NEG_INFINITY),
                |(low, high), (a, b)| (low.min(a), high.max(b)),
            );
            for ghost in &self.ghosts {
                let shown = ghost.rest_to_shown(&view, (low + high) / 2.0);
                for (_, part) in parts {
                    let mesh = part.clone().transformed(&shown).mesh().clone();
                    let edges = Strokes {
                        lines: mesh.sharp_edges(SHARP),
                        color: ghost.color(),
                        width_px: 1.5,
                    };
                    ghosts.push((mesh, edges));
                }
            }
        }
        ghosts
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

/// Draws the axes of the observer, each with its name at its end.
fn draw_axes(picture: &mut Picture, outside: &OutsideCamera, scenery: &Scenery) {
    let length = round_below(outside.height / 5.0);
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
fn round_below(limit: f64) -> f64 {
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
