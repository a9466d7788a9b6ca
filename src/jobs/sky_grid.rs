//! A grid on the observer's sky, with the direction of motion: what a picture of the whole sky is read by.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use super::contrast::ink;
use super::guides::letters;
use crate::render::{Camera, Picture, Scenery, Strokes, Viewpoint, lettering_width};
use crate::shape::Color;

/// Between two lines of longitude or of latitude there are 30 degrees.
const LINES: u32 = 6;

/// So many straight pieces are half a circle of longitude.
const PIECES: u32 = 60;

/// The distance of the grid: behind everything.
const FAR: f64 = 1e100;

/// Draws the grid where nothing else is seen: longitude and latitude in the axes of the observer, with y up.
pub(super) fn draw_sky_grid(
    picture: &mut Picture,
    camera: &Camera,
    viewpoint: Viewpoint,
    scenery: &Scenery,
    background: Color,
) {
    let direction = |longitude: f64, latitude: f64| {
        let (sin, cos) = longitude.sin_cos();
        let (height, across) = latitude.sin_cos();
        DVec3::new(across * sin, height, -across * cos) * FAR
    };
    let mut lines = vec![];
    let piece = |index: u32| f64::from(index) * PI / f64::from(PIECES);
    for line in 0..2 * LINES {
        let longitude = f64::from(line) * PI / f64::from(LINES);
        lines.extend((0..PIECES).map(|index| {
            [index, index + 1].map(|index| direction(longitude, piece(index) - FRAC_PI_2))
        }));
    }
    for line in 1..LINES {
        let latitude = f64::from(line) * PI / f64::from(LINES) - FRAC_PI_2;
        lines.extend((0..2 * PIECES).map(|index| {
            [index, index + 1]
                .map(|index| direction(piece(index % (2 * PIECES)).min(TAU), latitude))
        }));
    }
    let strokes = Strokes {
        lines,
        color: faint(background),
        width_px: 1.0,
    };
    scenery.draw(picture, camera, viewpoint, std::slice::from_ref(&strokes));
}

/// Marks the direction in which the observer moves by a cross, the opposite one by a circle, each with its name.
pub(super) fn draw_heading(
    picture: &mut Picture,
    camera: &Camera,
    heading: DVec3,
    background: Color,
) {
    let color = ink(background);
    let size = 0.6 * letters(picture);
    let cross = [[DVec2::NEG_X, DVec2::X], [DVec2::NEG_Y, DVec2::Y]];
    let corner = |part: u32| DVec2::from_angle(f64::from(part) * TAU / 24.0);
    let circle: Vec<_> = (0..24)
        .map(|part| [corner(part), corner(part + 1)])
        .collect();
    let marks = [
        (heading, cross.to_vec(), "motion"),
        (-heading, circle, "behind"),
    ];
    for (direction, lines, name) in marks {
        let Some(place) = camera.place(direction) else {
            continue;
        };
        picture.draw(&Strokes {
            lines: lines
                .into_iter()
                .map(|line| line.map(|end| place + end * size))
                .collect(),
            color,
            width_px: 1.5,
        });
        let height = letters(picture);
        let width = lettering_width(name, height);
        let most = f64::from(picture.size().width()) - width;
        let start = DVec2::new(
            (place.x - width / 2.0).clamp(0.0, most.max(0.0)),
            place.y - 1.5 * size,
        );
        picture.write(name, start, height, color);
    }
}

/// A colour for lines that are not to be in the way: a third of the way from the background to what stands out from it.
fn faint(background: Color) -> Color {
    let strong = ink(background).0;
    let mut mixed = background.0;
    for (level, strong) in mixed.iter_mut().zip(strong) {
        *level = ((2 * u16::from(*level) + u16::from(strong)) / 3) as u8;
    }
    Color(mixed)
}
