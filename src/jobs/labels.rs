//! Names of objects beside them.

use glam::{DVec2, DVec3};

use super::contrast::{halo, ink};
use crate::pipeline::PlacedScene;
use crate::render::{Camera, Picture, lettering_width};
use crate::shape::Color;

/// Height of capitals as a fraction of the picture's height, and the least in pixels.
const LETTERS: f64 = 1.0 / 36.0;
const LEAST_PX: f64 = 8.0;

/// Of an object so many vertices are looked at, spread over all.
const MEASURED: usize = 4000;

/// Of a name so many characters are shown.
const MAX_NAME: usize = 40;

/// Free space around a label, in heights of capitals.
const ROOM: f64 = 0.4;

/// Where a label is tried: so many heights of it above its place.
const TRIED: [f64; 9] = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0];

/// A part of a picture that is taken, in pixels.
#[derive(Clone, Copy)]
struct Taken {
    low: DVec2,
    high: DVec2,
}

impl Taken {
    fn meets(&self, other: &Self) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }
}

/// Writes the name of each object that a camera at `eye` has in the picture above the middle of what is seen of it. A label
/// that finds no room is left out; the upper left corner of this size is taken already.
pub(super) fn draw_labels(
    picture: &mut Picture,
    camera: &Camera,
    eye: DVec3,
    (placed, step): (&PlacedScene, usize),
    corner: DVec2,
    background: Color,
) {
    let (width, height) = (picture.size().width(), picture.size().height());
    let extent = DVec2::new(width.into(), height.into());
    let letter = (LETTERS * extent.y).max(LEAST_PX);
    let mut all = vec![Taken {
        low: DVec2::ZERO,
        high: corner,
    }];
    for (object, parts) in placed.looked_at() {
        let Some(view) = placed.model_view(object, step) else {
            continue;
        };
        let vertices: usize = parts
            .iter()
            .map(|(_, part)| part.mesh().vertex_count())
            .sum();
        let every = vertices.div_ceil(MEASURED).max(1);
        let positions = parts.iter().flat_map(|(_, part)| part.mesh().positions());
        let seen = positions.step_by(every).filter_map(|position| {
            let place = camera.place(view.shown_position(*position) - eye)?;
            (place.cmpge(DVec2::ZERO).all() && place.cmple(extent).all()).then_some(place)
        });
        let (low, high) = seen.fold(
            (DVec2::INFINITY, DVec2::NEG_INFINITY),
            |(low, high), place| (low.min(place), high.max(place)),
        );
        if !low.cmple(high).all() {
            continue;
        }
        let name = shown(&object.name);
        let size = DVec2::new(lettering_width(&name, letter), letter);
        let room = DVec2::splat(ROOM * letter);
        // Lower left corner of the letters, at the upper edge of what is seen.
        let wanted = DVec2::new((low.x + high.x - size.x) / 2.0, low.y - 0.6 * letter);
        let least = DVec2::new(room.x, size.y + room.y);
        let most = (extent - DVec2::new(size.x, 0.0) - room).max(least);
        let free = TRIED.iter().find_map(|up| {
            let up = DVec2::Y * (up * (size.y + 2.0 * room.y));
            let start = (wanted - up).clamp(least, most);
            let taken = Taken {
                low: start - DVec2::Y * size.y - room,
                high: start + DVec2::X * size.x + room,
            };
            (!all.iter().any(|other| other.meets(&taken))).then_some((start, taken))
        });
        if let Some((start, taken)) = free {
            picture.write_haloed(&name, start, letter, ink(background), halo(background));
            all.push(taken);
        }
    }
}

/// A name in one line.
fn shown(name: &str) -> String {
    let characters = name.chars().take(MAX_NAME);
    let mut text: String = characters
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if name.chars().nth(MAX_NAME).is_some() {
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{PictureSize, Projection};
    use crate::scene::Scene;

    fn labelled(json: &str) -> Picture {
        let scene = Scene::from_json(json).unwrap();
        let (models, _) = crate::jobs::load_models(&scene, ".".as_ref()).unwrap();
        let placed = PlacedScene::new(scene, models).unwrap();
        let size = PictureSize::new(200, 150).unwrap();
        let projection = Projection::Perspective {
            vertical_fov_deg: 60.0,
        };
        let camera = Camera::new(size, projection, DVec3::NEG_Z).unwrap();
        let mut picture = Picture::filled(size, Color([0; 3]));
        let (place, background) = ((&placed, 0), Color([0; 3]));
        draw_labels(
            &mut picture,
            &camera,
            DVec3::ZERO,
            place,
            DVec2::ZERO,
            background,
        );
        picture
    }

    fn written(picture: &Picture) -> Vec<(u32, u32)> {
        let all = (0..150).flat_map(|y| (0..200).map(move |x| (x, y)));
        all.filter(|&(x, y)| picture.pixel(x, y)[0] > 200).collect()
    }

    fn object(name: &str, x: f64) -> String {
        format!(
            r#"{{ "name": "{name}", "shape": {{ "sphere": {{ "radius": 1 }} }}, "position": [{x}, 0, -6] }}"#
        )
    }

    #[test]
    fn a_name_stands_above_its_object_and_inside_the_picture() {
        for (x, middle) in [(0.0, 100.0), (2.0, 143.0), (4.6, 185.0)] {
            let picture = labelled(&format!(r#"{{ "objects": [{}] }}"#, object("HHHH", x)));
            let pixels = written(&picture);
            let columns: Vec<u32> = pixels.iter().map(|(x, _)| *x).collect();
            let (low, high) = (columns.iter().min().unwrap(), columns.iter().max().unwrap());
            let found = f64::from(low + high) / 2.0;
            assert!((found - middle).abs() < 9.0, "{x}: {found}");
            // The sphere's upper edge is at row 53.
            assert!(
                pixels.iter().all(|(_, y)| (35..54).contains(y)),
                "{pixels:?}"
            );
        }
        let beside = labelled(&format!(r#"{{ "objects": [{}] }}"#, object("HHHH", 40.0)));
        assert_eq!(written(&beside), []);
    }

    #[test]
    fn names_of_objects_in_one_place_do_not_overlap() {
        let count = |objects: &[String]| {
            let picture = labelled(&format!(r#"{{ "objects": [{}] }}"#, objects.join(", ")));
            written(&picture).len()
        };
        let one = count(&[object("HH", 0.0)]);
        // The longer name alone has half as many letters more; both together have five halves.
        let two = count(&[object("HH", 0.0), object("HHH", 0.01)]);
        assert!(two as f64 > 1.8 * one as f64, "{one} {two}");
        let many: Vec<String> = (0..40).map(|n| object(&format!("a{n}"), 0.0)).collect();
        assert!(count(&many) > 0);
    }
}
