//! Lines of a given width in pixels, drawn onto a finished picture.

use glam::{DVec2, DVec3, Vec3};

use super::Camera;
use super::picture::{Picture, encoded};
use crate::shape::Color;

/// How strong a line is behind something.
const BEHIND: f32 = 0.3;

/// A line counts as in front of a surface that it touches: it may be this part of its distance behind it.
const TOUCHING: f64 = 2e-3;

/// Pieces of a line that is straight in space take up this much of the sky: so short that they are straight on any
/// picture, and that one that ends behind the camera is not missed.
const PIECE: f64 = 0.02;

/// Lines of one colour and width.
#[derive(Clone, Debug, PartialEq)]
pub struct Strokes<Place> {
    /// Both ends of each.
    pub lines: Vec<[Place; 2]>,
    /// Their colour.
    pub color: Color,
    /// Their width in pixels.
    pub width_px: f64,
}

/// A piece of a line on a picture, with the distances of its ends from the eye.
struct Piece {
    ends: [DVec2; 2],
    distances: [f64; 2],
}

impl Picture {
    /// Draws lines whose places are in pixels, as [`Camera::place`] has them.
    pub fn draw(&mut self, strokes: &Strokes<DVec2>) {
        let pieces = strokes.lines.iter().map(|&ends| Piece {
            ends,
            distances: [0.0; 2],
        });
        self.cover(pieces, strokes.width_px, strokes.color, |_, _| false);
    }

    /// Draws lines in space as a camera at `eye` sees them; `hidden` says whether something is nearer than so far
    /// in a direction, and what is hidden is drawn faintly.
    pub(super) fn draw_in_space(
        &mut self,
        strokes: &Strokes<DVec3>,
        camera: &Camera,
        eye: DVec3,
        hidden: impl Fn(DVec3, f64) -> bool,
    ) {
        let widest = f64::from(self.size().width()) / 2.0;
        let pieces = strokes.lines.iter().flat_map(|&[start, end]| {
            let (start, end) = (start - eye, end - eye);
            let angle = start.angle_between(end);
            let count = (angle / PIECE).ceil().clamp(1.0, 200.0) as u32;
            let place = move |part: u32| {
                let offset = start.lerp(end, f64::from(part) / f64::from(count));
                Some((camera.place(offset)?, offset.length()))
            };
            let piece = move |part| {
                let ((start, near), (end, far)) = (place(part)?, place(part + 1)?);
                // On a picture of the whole sky, once around.
                (start.distance(end) < widest).then_some(Piece {
                    ends: [start, end],
                    distances: [near, far],
                })
            };
            (0..count).filter_map(piece)
        });
        let is_hidden = |place: DVec2, distance: f64| {
            hidden(camera.direction(place), distance * (1.0 - TOUCHING))
        };
        self.cover(pieces, strokes.width_px, strokes.color, is_hidden);
    }

    /// Blends `color` in, once at each pixel however many pieces meet there.
    fn cover(
        &mut self,
        pieces: impl Iterator<Item = Piece>,
        width_px: f64,
        color: Color,
        is_hidden: impl Fn(DVec2, f64) -> bool,
    ) {
        let (width, height) = (self.size().width() as usize, self.size().height() as usize);
        let mut opacity = vec![0.0_f32; width * height];
        let reach = width_px / 2.0 + 0.5;
        for Piece { ends, distances } in pieces {
            let [low, high] = [ends[0].min(ends[1]) - reach, ends[0].max(ends[1]) + reach];
            let range = |low: f64, high: f64, length: usize| {
                let last = length as f64;
                low.floor().clamp(0.0, last) as usize..high.ceil().clamp(0.0, last) as usize
            };
            for y in range(low.y, high.y, height) {
                for x in range(low.x, high.x, width) {
                    let place = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let along = ends[1] - ends[0];
                    let part = (place - ends[0]).dot(along) / along.length_squared();
                    let part = if part > 0.0 { part.min(1.0) } else { 0.0 };
                    let away = place.distance(ends[0].lerp(ends[1], part));
                    let covered = (reach - away).clamp(0.0, 1.0) as f32;
                    let seen = &mut opacity[y * width + x];
                    if covered <= *seen {
                        continue;
                    }
                    let distance = distances[0] + part * (distances[1] - distances[0]);
                    let strength = match is_hidden(place, distance) {
                        true => BEHIND,
                        false => 1.0,
                    };
                    *seen = seen.max(covered * strength);
                }
            }
        }
        self.blend(&opacity, color);
    }

    /// Blends `color` in, with an opacity for each pixel.
    pub(super) fn blend(&mut self, opacity: &[f32], color: Color) {
        let color = Vec3::from(color.linear());
        for (pixel, &opacity) in self.pixels_mut().zip(opacity) {
            if opacity > 0.0 {
                let below = Vec3::from(Color(*pixel).linear());
                *pixel = encoded(below.lerp(color, opacity));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PictureSize, Projection};
    use super::*;

    const WHITE: Color = Color([255; 3]);

    fn black(width: u32, height: u32) -> Picture {
        Picture::filled(PictureSize::new(width, height).unwrap(), Color([0; 3]))
    }

    #[test]
    fn a_line_covers_its_width() {
        let mut picture = black(20, 20);
        picture.draw(&Strokes {
            lines: vec![[DVec2::new(-5.0, 10.0), DVec2::new(25.0, 10.0)]],
            color: WHITE,
            width_px: 2.0,
        });
        let column: Vec<_> = (0..20).map(|y| picture.pixel(7, y)[0]).collect();
        assert_eq!(column[8..12], [0, 255, 255, 0]);
        let lit = column.iter().filter(|&&level| level > 0).count();
        assert_eq!(lit, 2);
    }

    #[test]
    fn what_is_hidden_is_faint_and_what_is_behind_the_camera_is_not_there() {
        let size = PictureSize::new(40, 40).unwrap();
        let projection = Projection::Perspective {
            vertical_fov_deg: 90.0,
        };
        let camera = Camera::new(size, projection, DVec3::NEG_Z).unwrap();
        let draw = |ends: [DVec3; 2], hidden: bool| {
            let mut picture = black(40, 40);
            let strokes = Strokes {
                lines: vec![ends],
                color: WHITE,
                width_px: 2.0,
            };
            picture.draw_in_space(&strokes, &camera, DVec3::ZERO, |_, distance| {
                assert!(distance > 1.9);
                hidden
            });
            let linear = |x, y| Color(picture.pixel(x, y)).linear()[0];
            [linear(20, 20), linear(0, 20), linear(20, 0)]
        };
        let across = [DVec3::new(-9.0, 0.0, -2.0), DVec3::new(9.0, 0.0, -2.0)];
        assert_eq!(draw(across, false), [1.0, 1.0, 0.0]);
        let [faint, ..] = draw(across, true);
        // To half a step of 8 bits, which there is 0.003 of white.
        assert!((faint - BEHIND).abs() < 0.003, "{faint}");
        let behind = across.map(|end| -end);
        assert_eq!(draw(behind, false), [0.0; 3]);
    }
}
