//! Guides that help to read a picture: ghosts, axes, a scale bar, labels.

use glam::{DVec2, DVec3};

use super::caption::Caption;
use super::contrast::{halo, ink, legible};
use super::extent::round_below;
use super::outside_camera::OutsideCamera;
use crate::render::{Picture, Scenery, Strokes, Viewpoint, lettering_width};
use crate::shape::Color;
use crate::spacetime::ViewModel;

/// Height of letters as a fraction of the picture's height; at least 8 pixels are used.
const LETTERS: f64 = 1.0 / 30.0;

/// The observer's axes: direction, name, colour on a dark background.
pub(super) const AXES: [(DVec3, &str, Color); 3] = [
    (DVec3::X, "x", Color([0xe7, 0x4c, 0x3c])),
    (DVec3::Y, "y", Color([0x2e, 0xa8, 0x5a])),
    (DVec3::Z, "z", Color([0x3d, 0x8b, 0xe8])),
];

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
    /// Whether a grid of longitude and latitude every 30 degrees, and the direction of motion, are drawn in the observer's
    /// pictures.
    pub sky_grid: bool,
    /// Whether the edges of all triangles of photosurfaces are drawn, also in the observer's pictures of them.
    pub wireframe: bool,
    /// Whether the name of each object stands beside it.
    pub labels: bool,
    /// The words in the upper left corner of a picture, or above a sheet.
    pub caption: Caption,
}

impl Guides {
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
            draw_axes(picture, outside, scenery, background);
        }
        if self.scale_bar && outside.has_scale {
            draw_scale_bar(picture, outside, background);
        }
    }
}

/// Draws the axes of the observer, each with its name at its end.
fn draw_axes(picture: &mut Picture, outside: &OutsideCamera, scenery: &Scenery, background: Color) {
    let length = outside.axes;
    for (axis, name, color) in AXES {
        let color = legible(color, background);
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
            write(picture, name, end + middle, color, background);
        }
    }
}

/// Draws a bar of a round length in the lower left corner, with that length above it.
fn draw_scale_bar(picture: &mut Picture, outside: &OutsideCamera, background: Color) {
    let color = ink(background);
    let (width, height) = (picture.size().width(), picture.size().height());
    let per_unit = f64::from(height) / outside.height;
    let length = round_below(0.2 * f64::from(width) / per_unit);
    let letters = letters(picture);
    let start = DVec2::new(letters, f64::from(height) - letters);
    let end = start + DVec2::X * (length * per_unit);
    let tick = DVec2::Y * (letters / 3.0);
    for (color, width_px) in [(halo(background), 4.0), (color, 2.0)] {
        picture.draw(&Strokes {
            lines: vec![[start, end], [start - tick, start], [end - tick, end]],
            color,
            width_px,
        });
    }
    write(
        picture,
        &length.to_string(),
        start - 2.0 * tick,
        color,
        background,
    );
}

/// Height of letters on a picture, in pixels.
pub(super) fn letters(picture: &Picture) -> f64 {
    (f64::from(picture.size().height()) * LETTERS).max(8.0)
}

fn write(picture: &mut Picture, text: &str, start: DVec2, color: Color, background: Color) {
    let height = letters(picture);
    picture.write_haloed(text, start, height, color, halo(background));
}
