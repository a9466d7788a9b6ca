//! Pictures: rays of light against the photosurface, and both against closed forms.
//!
//! All pictures here are of things in one or two full colours, one ray a pixel, so that every pixel is one thing or
//! another.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use photosurface::render::{
    Camera, Picture, PictureOptions, PictureSize, Projection, Scenery, Viewpoint,
};
use photosurface::shape::Color;
use photosurface::{DVec3, PlacedScene, Scene, SurfaceOptions, Tolerance, load_models};
use serde_json::{Value, json};

use crate::common::{Random, Worst};

/// One ray a pixel, before black.
const BARE: PictureOptions = PictureOptions {
    samples: 1,
    background: Color([0; 3]),
    wireframe: None,
};

fn placed(scene: &Value, tolerance: Tolerance) -> PlacedScene {
    let scene = Scene::from_json(&scene.to_string()).expect("a valid scene");
    let scene = scene.with_tolerance_for_all(tolerance);
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes, and a fixture");
    PlacedScene::new(scene, models).expect("one model an object")
}

/// What the observer sees at the first step, by rays.
fn by_rays(placed: &PlacedScene, camera: &Camera) -> Picture {
    let mut scenery = Scenery::new();
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part);
        }
    }
    take(placed, &scenery, camera)
}

/// What the observer sees at the first step, by photosurfaces; and how far off, in radians, a point of
/// them may be seen, as certified for a tolerance that is an angle.
fn by_meshes(placed: &PlacedScene, camera: &Camera, wanted: SurfaceOptions) -> (Picture, f64) {
    let mut scenery = Scenery::new();
    let moment = placed.scene().moment(0).expect("a step");
    let mut angle = 0.0_f64;
    for surface in placed.photosurfaces(0, wanted).expect("a step") {
        let objects = placed.scene().objects().iter();
        let object = objects
            .clone()
            .find(|object| object.name == surface.facts.object)
            .expect("photosurfaces are of objects");
        scenery.add_photosurface(object, &moment, &surface.mesh, surface.material.as_ref());
        // In degrees, as the tolerance is.
        angle = angle.max(surface.facts.certificate.total.to_radians());
    }
    (take(placed, &scenery, camera), angle)
}

fn take(placed: &PlacedScene, scenery: &Scenery, camera: &Camera) -> Picture {
    assert!(scenery.textures().missing().is_empty());
    let moment = placed.scene().moment(0).unwrap();
    let viewpoint = Viewpoint::Observer(&moment);
    scenery.picture(camera, viewpoint, BARE)
}

/// What a pixel shows: nothing, or one of three kinds of things, by its strongest channel.
fn kind(picture: &Picture, x: u32, y: u32) -> usize {
    let channels = picture.pixel(x, y);
    let strongest = (0..3)
        .max_by_key(|&channel| channels[channel])
        .expect("three");
    if channels[strongest] == 0 {
        0
    } else {
        strongest + 1
    }
}

fn pixels(picture: &Picture) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (width, height) = (picture.size().width(), picture.size().height());
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Places between neighbouring pixels of different kinds: within half a pixel, along a row or a column, of
/// an outline.
fn outline(picture: &Picture) -> Vec<DVec2> {
    let (width, height) = (picture.size().width(), picture.size().height());
    let mut places = Vec::new();
    for (x, y) in pixels(picture) {
        let here = kind(picture, x, y);
        let middle = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        if x + 1 < width && kind(picture, x + 1, y) != here {
            places.push(middle + DVec2::X * 0.5);
        }
        if y + 1 < height && kind(picture, x, y + 1) != here {
            places.push(middle + DVec2::Y * 0.5);
        }
    }
    places
}

fn pinhole(width: u32, height: u32, vertical_fov_deg: f64, look: DVec3) -> Camera {
    let size = PictureSize::new(width, height).expect("a fair size");
    Camera::new(size, Projection::Perspective { vertical_fov_deg }, look).expect("a fair camera")
}

/// Scenes, with where to look and how wide.
fn scenes() -> Vec<(&'static str, Value, DVec3, f64)> {
    let passing = json!({ "velocity": { "beta": 0.95, "direction": [-1, 0, 0] } });
    vec![
        (
            "sphere",
            json!({ "observer": passing, "objects": [
                { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "color": "#ff0000", "position": [0, 3, 0] },
            ]}),
            DVec3::new(-0.95, 0.32, 0.0),
            16.0,
        ),
        (
            "cube",
            json!({ "observer": passing, "objects": [
                { "name": "cube", "shape": { "box": { "size": [2, 2, 2] } }, "color": "#ff0000", "position": [0.5, 3, 0] },
            ]}),
            DVec3::new(-0.95, 0.36, 0.0),
            24.0,
        ),
        (
            "lattice",
            json!({ "observer": { "position": [0.2, 0.3, 6], "velocity": { "beta": 0.9 } }, "objects": [
                { "name": "lattice", "shape": { "lattice": { "cells": [2, 2, 2], "spacing": 1.5, "thickness": 0.4 } },
                  "color": "#ff0000" },
            ]}),
            DVec3::NEG_Z,
            18.0,
        ),
        (
            "textured",
            json!({ "observer": { "velocity": { "beta": 0.8, "direction": [-1, 0, 0] } }, "objects": [
                { "name": "cube", "shape": { "box": { "size": [2, 2, 2] } }, "color": "#ff0000", "checker": "#0000ff",
                  "rotation": [0.1, 0.3, 0, 0.9486833], "position": [4.8, 0.5, -6] },
            ]}),
            DVec3::new(0.0, 0.07, -1.0),
            24.0,
        ),
        (
            "two objects",
            json!({ "observer": { "velocity": { "beta": 0.5, "direction": [0, 1, -1] } }, "objects": [
                { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "color": "#ff0000",
                  "position": [8.406, 0.2, -9], "velocity": { "beta": 0.9, "direction": [1, 0, 0] } },
                { "name": "cube", "shape": { "box": { "size": [1.5, 1.5, 1.5] } }, "color": "#00ff00",
                  "position": [-4.366, -0.3, -5.287], "velocity": { "beta": 0.6, "direction": [-1, 0, 0.2] } },
            ]}),
            DVec3::new(0.0, 0.31, -0.95),
            24.0,
        ),
        (
            "asteroid",
            json!({ "observer": { "velocity": { "beta": 0.9, "direction": [-1, 0, 0] } }, "objects": [
                { "name": "asteroid", "file": "fixtures/meshes/asteroid.glb", "position": [12.4, 0.5, -6],
                  "rotation": [0.1, 0.3, 0, 0.9486833], "scale": 1.0 },
            ]}),
            DVec3::new(0.0, 0.07, -1.0),
            24.0,
        ),
        (
            "delayed cube",
            json!({ "observer": passing, "model": "delayed", "objects": [
                { "name": "cube", "shape": { "box": { "size": [2, 2, 2] } }, "color": "#ff0000", "position": [0.5, 3, 0] },
            ]}),
            DVec3::new(-0.9, 0.42, 0.0),
            40.0,
        ),
        (
            "contracted sphere",
            json!({ "observer": { "velocity": { "beta": 0.8, "direction": [-1, 0, 0.3] } }, "model": "contracted", "objects": [
                { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "color": "#ff0000", "position": [0.5, 3, -2] },
            ]}),
            DVec3::new(0.1, 0.83, -0.55),
            45.0,
        ),
        (
            "three models",
            json!({ "observer": { "velocity": { "beta": 0.9 } }, "objects": [
                { "name": "cube", "shape": { "box": { "size": [2, 2, 2] } }, "color": "#ff0000", "checker": "#0000ff",
                  "rotation": [0.1, 0.3, 0, 0.9486833], "position": [1, 0.2, -6], "model": "rest" },
                { "name": "torus", "shape": { "torus": { "major_radius": 1, "minor_radius": 0.4 } }, "color": "#00ff00",
                  "rotation": [0.6, 0, 0, 0.8], "position": [-1.5, 0, -8], "model": "contracted" },
                { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "color": "#ff0000",
                  "position": [0, 1.5, 4], "velocity": { "beta": 0.3, "direction": [1, 0, 0] }, "model": "delayed" },
            ]}),
            DVec3::new(0.0, 0.1, -1.0),
            60.0,
        ),
        (
            "thrust",
            json!({ "observer": { "flight": [{ "proper_time": 5, "acceleration": [0.1, 0, -0.5] }] }, "steps": [1.9],
                "objects": [
                { "name": "lattice", "shape": { "lattice": { "cells": [2, 2, 2], "spacing": 1.5, "thickness": 0.4 } },
                  "color": "#ff0000", "position": [0.3, 0.2, -6] },
            ]}),
            DVec3::new(0.05, 0.02, -1.0),
            18.0,
        ),
        (
            "coordinated turn",
            json!({ "observer": { "velocity": { "beta": 0.8 }, "flight": [
                    { "proper_time": 4, "acceleration": [-0.6, 0.1, 0.05], "steer": "coordinated" }] }, "steps": [2.5],
                "objects": [
                { "name": "cube", "shape": { "box": { "size": [2, 2, 2] } }, "color": "#ff0000", "checker": "#0000ff",
                  "position": [-7, 0.5, -3], "velocity": { "beta": 0.3, "direction": [0, 1, 0] } },
            ]}),
            DVec3::new(0.0, 0.0, -1.0),
            60.0,
        ),
    ]
}

/// Both methods show the same thing at every pixel that is farther from an outline than the mesh may be off.
///
/// # Where the limit comes from
///
/// A point of the mesh is seen at most the angle `delta` from the point of the true surface that it stands for, as
/// its certificate says: `delta` in pixels is that angle times the pixels a radian has in the corner of a
/// pinhole picture, where it has most. So a pixel that differs has its middle within `delta` of an
/// outline, of the thing or of a field of its checker: a point of the mesh has the texture of the point that it
/// stands for. An outline of length `L` pixels has the area `2 delta L` around it, and `pi delta^2` at ends: as many
/// pixel middles lie there on average over all places of the grid of pixels, and on one grid not more by
/// chance than four standard deviations of as many independent events. `L` is not longer than the
/// number of steps along rows and columns that follow it.
#[test]
fn rays_and_photosurfaces_show_the_same_to_within_the_tolerance() {
    let (width, height) = (640, 480);
    println!("scene        asked px  proven px  outline px  differ  limit");
    for (name, scene, look, fov) in scenes() {
        let camera = pinhole(width, height, fov, look);
        let half_height = (fov.to_radians() / 2.0).tan();
        let per_radian_middle = f64::from(height) / 2.0 / half_height;
        let aspect = f64::from(width) / f64::from(height);
        let per_radian = per_radian_middle * (1.0 + half_height.powi(2) * (1.0 + aspect.powi(2)));
        let mut counts = Vec::new();
        for asked in [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125] {
            let tolerance = Tolerance::degrees((asked / per_radian).to_degrees()).unwrap();
            let placed = placed(&scene, tolerance);
            let rays = by_rays(&placed, &camera);
            let (meshes, angle) = by_meshes(&placed, &camera, SurfaceOptions::default());
            let delta = angle * per_radian;
            let length = outline(&rays).len() as f64;
            let differ = |other: &Picture| {
                let differ = |&(x, y): &(u32, u32)| kind(&rays, x, y) != kind(other, x, y);
                pixels(&rays).filter(differ).count()
            };
            let area = 2.0 * length * delta + PI * delta * delta;
            let limit = area + 4.0 * area.sqrt();
            let count = differ(&meshes);
            println!("{name:12} {asked:8.2} {delta:10.3} {length:11} {count:7} {limit:6.0}");
            assert!(length > 300.0, "{name}: there is something to compare");
            assert!(
                count as f64 <= limit,
                "{name}: {count} pixels differ, at most {limit}"
            );
            counts.push(count);
        }
        let [coarse, .., fine] = counts.as_slice() else {
            unreachable!("seven tolerances")
        };
        // A tolerance 64 times finer; a quarter is what even a lucky coarse mesh must lose.
        assert!(4 * fine <= *coarse, "{name}: {counts:?}");
    }
}

/// Another velocity, by a hundredth of that of light, is another picture: the comparison is sharp.
#[test]
fn a_wrong_velocity_is_seen() {
    let (_, mut scene, look, fov) = scenes().remove(0);
    let camera = pinhole(640, 480, fov, look);
    let right = by_rays(&placed(&scene, Tolerance::default()), &camera);
    scene["observer"]["velocity"]["beta"] = json!(0.94);
    let wrong = by_rays(&placed(&scene, Tolerance::default()), &camera);
    let differ = pixels(&right).filter(|&(x, y)| kind(&right, x, y) != kind(&wrong, x, y));
    let (differ, length) = (differ.count() as f64, outline(&right).len() as f64);
    // More than what the comparison above lets pass with a tolerance of a pixel.
    assert!(differ > 2.0 * length, "{differ} of {length}");
}

/// How far, at most, the places of an outline are from the circle of `half_angle` about `center`, in radians.
fn off_circle(picture: &Picture, camera: &Camera, center: DVec3, half_angle: f64) -> f64 {
    let places = outline(picture);
    assert!(places.len() > 200, "an outline is there: {}", places.len());
    let angles = places
        .into_iter()
        .map(|place| camera.direction(place).angle_between(center));
    angles
        .map(|angle| (angle - half_angle).abs())
        .fold(0.0, f64::max)
}

/// A sphere, or an ellipsoid of `scale`, at rest at `center`; the observer moves along -x.
fn lone(beta: f64, center: DVec3, scale: [f64; 3]) -> Value {
    json!({
        "observer": { "velocity": { "beta": beta, "direction": [-1, 0, 0] } },
        "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "scale": scale,
                       "color": "#ffffff", "position": center.to_array() } ],
    })
}

/// Penrose 1959, Terrell 1959: the outline of a sphere is a circle at any speed.
///
/// # Where the limit comes from
///
/// A place of the outline is halfway between the middles of two pixels on its two sides: half a pixel from it
/// along a row or a column, so no farther across. A pixel of a pinhole picture is largest in the middle.
#[test]
fn a_passing_sphere_has_a_circle_for_an_outline() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/penrose_terrell.json");
    let text = std::fs::read_to_string(path).expect("the fixture is there");
    let fixture: Value = serde_json::from_str(&text).expect("the fixture is JSON");
    let cases = fixture["cases"].as_array().expect("a list of cases");
    assert_eq!(cases.len(), 5);
    for case in cases {
        let number = |value: &Value| value.as_f64().expect("a number");
        let beta = number(&case["beta"]);
        let place = DVec3::from_array([0, 1, 2].map(|i| number(&case["centre"][i])));
        let half_angle = number(&case["half_angle_deg"]).to_radians();
        let (sin, cos) = number(&case["centre_angle_deg"]).to_radians().sin_cos();
        let across = place.with_x(0.0).normalize();
        let center = DVec3::X * cos + across * sin;
        let fov = (2.0 * (1.2 * half_angle.tan()).atan()).to_degrees();
        let camera = pinhole(600, 600, fov, center);
        let pixel = 2.0 * (fov.to_radians() / 2.0).tan() / 600.0;
        let off = |scale| {
            let placed = placed(&lone(beta, place, scale), Tolerance::default());
            off_circle(&by_rays(&placed, &camera), &camera, center, half_angle)
        };
        let sphere = off([1.0; 3]);
        println!(
            "beta {beta}, {place}: {:.3} of half a pixel",
            sphere / pixel * 2.0
        );
        assert!(sphere <= pixel / 2.0, "{sphere} > {}", pixel / 2.0);
        // As if it were contracted at rest, a little: the test can fail.
        assert!(off([0.95, 1.0, 1.0]) > pixel / 2.0);
    }
}

/// The same far from the axis, 90 degrees from where the camera looks, on a picture of the whole sky.
///
/// The centre of the outline is at right angles to the motion where `cos theta' = beta cos psi'`; then
/// `cot psi = cos psi' / (gamma sin psi')`. A pixel is largest on the equator of the picture.
#[test]
fn a_sphere_far_off_axis_has_a_circle_for_an_outline_on_the_sky() {
    let (beta, distance) = (0.9_f64, 3.0_f64);
    let gamma = 1.0 / ((1.0 - beta) * (1.0 + beta)).sqrt();
    let at_rest = (1.0 / distance).asin();
    let half_angle = (gamma * at_rest.tan()).atan();
    let cos = beta * at_rest.cos();
    let place = distance * DVec3::new(cos, 0.0, (1.0 - cos * cos).sqrt());
    let width = 1600;
    let size = PictureSize::new(width, width / 2).expect("a fair size");
    let camera = Camera::new(size, Projection::FullSky, DVec3::X).expect("a fair camera");
    let pixel = TAU / f64::from(width);
    let off = |scale| {
        let placed = placed(&lone(beta, place, scale), Tolerance::default());
        off_circle(&by_rays(&placed, &camera), &camera, DVec3::Z, half_angle)
    };
    assert!(off([1.0; 3]) <= pixel / 2.0);
    assert!(off([0.95, 1.0, 1.0]) > pixel / 2.0);
}

/// Every pixel of a sky full of stars shows what is there at rest in the direction that
/// `tan(theta'/2) = exp(eta) tan(theta/2)` gives.
#[test]
fn the_sky_of_a_moving_observer_is_aberrated_by_the_half_angle() {
    let (distance, radius) = (1000.0, 40.0_f64);
    let half_angle = (radius / distance).asin();
    let stars: Vec<DVec3> = (0..12)
        .flat_map(|row| (0..24).map(move |column| (row, column)))
        .map(|(row, column)| {
            let (height, across) = (PI * (f64::from(row) - 5.5) / 12.0).sin_cos();
            let (sin, cos) = (TAU * f64::from(column) / 24.0).sin_cos();
            DVec3::new(across * cos, height, across * sin)
        })
        .collect();
    let objects: Vec<Value> = stars
        .iter()
        .enumerate()
        .map(|(number, star)| {
            json!({ "name": format!("star{number}"), "shape": { "sphere": { "radius": radius } },
                    "color": "#ffffff", "position": (*star * distance).to_array() })
        })
        .collect();
    let motion = DVec3::new(0.48, 0.6, -0.64);
    for beta in [0.0, 0.5, 0.9, 0.99_f64] {
        let scene = json!({
            "observer": { "velocity": { "beta": beta, "direction": motion.to_array() } },
            "objects": objects,
        });
        let size = PictureSize::new(360, 180).expect("a fair size");
        let camera = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).expect("a fair camera");
        let picture = by_rays(&placed(&scene, Tolerance::default()), &camera);
        let (mut lit, mut wrong) = (0, 0);
        for (x, y) in pixels(&picture) {
            let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let seen = camera.direction(place);
            let theta = seen.angle_between(motion);
            let theta_rest = 2.0 * ((theta / 2.0).tan() * beta.atanh().exp()).atan();
            let across = (seen - motion * seen.dot(motion)).normalize();
            let at_rest = motion * theta_rest.cos() + across * theta_rest.sin();
            let nearest = stars.iter().map(|star| star.angle_between(at_rest));
            let inside = nearest.fold(f64::INFINITY, f64::min) - half_angle;
            let shown = kind(&picture, x, y) != 0;
            lit += u32::from(shown);
            // On the very edge roundings decide.
            wrong += u32::from(inside.abs() > 1e-9 && shown != (inside < 0.0));
        }
        assert_eq!(wrong, 0, "beta {beta}");
        assert!(lit > 250, "beta {beta}: {lit}");
    }
}

/// Both methods shade alike: normals on the photosurface lead back to those at rest.
///
/// In smooth places a level may be rounded to the other side of a half, which is one step of 8 bits; normals
/// between the corners of facets within 1e-5 of their size turn by the square root of 8e-5, 0.009, at
/// most, which changes a level by as many of the 255 x 0.75 steps of the lamp: two more.
#[test]
fn rays_and_photosurfaces_are_shaded_alike() {
    let mut random = Random::new(11);
    let mut worst = Worst::new("shading, steps of 8 bits");
    for (name, scene, look, fov) in scenes() {
        let camera = pinhole(320, 240, fov, look);
        let placed = placed(&scene, Tolerance::relative(1e-5).unwrap());
        let rays = by_rays(&placed, &camera);
        let (meshes, _) = by_meshes(&placed, &camera, SurfaceOptions::default());
        for _ in 0..20_000 {
            let x = random.between(1.0, 319.0) as u32;
            let y = random.between(1.0, 239.0) as u32;
            let around = [(0, 0), (1, 0), (0, 1)].map(|(i, j)| (x - i, y - j));
            let level = |picture: &Picture, (x, y): (u32, u32)| {
                f64::from(picture.pixel(x, y).into_iter().max().unwrap_or_default())
            };
            let levels = around.map(|place| level(&rays, place));
            // Neither an outline nor an edge.
            if levels[0] == 0.0 || levels.iter().any(|l| (l - levels[0]).abs() > 4.0) {
                continue;
            }
            let error = (level(&meshes, (x, y)) - levels[0]).abs();
            worst.record(error, 3.0, 1.0, || format!("{name} at {x}, {y}"));
        }
    }
    worst.check();
}

#[test]
fn pictures_are_the_same_for_any_number_of_threads() {
    let (_, scene, look, fov) = scenes().remove(4);
    let camera = pinhole(160, 120, fov, look);
    let placed = placed(&scene, Tolerance::default());
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| by_rays(&placed, &camera))
    };
    assert_eq!(with(1), with(3));
}

/// Surfaces in front hide those behind, whatever their speeds: the two objects overlap in the picture.
#[test]
fn what_is_seen_nearer_hides_what_is_farther() {
    let (_, scene, look, fov) = scenes().remove(4);
    let camera = pinhole(320, 240, fov, look);
    let both = by_rays(&placed(&scene, Tolerance::default()), &camera);
    let alone = |number: usize| {
        let mut scene = scene.clone();
        scene["objects"] = json!([scene["objects"][number]]);
        by_rays(&placed(&scene, Tolerance::default()), &camera)
    };
    let (sphere, cube) = (alone(0), alone(1));
    let mut shared = 0;
    for (x, y) in pixels(&both) {
        let shown = [&both, &sphere, &cube].map(|picture| kind(picture, x, y));
        // The cube's light is younger wherever both are in the way.
        let expected = if shown[2] != 0 { shown[2] } else { shown[1] };
        assert_eq!(shown[0], expected, "{x}, {y}");
        shared += u32::from(shown[1] != 0 && shown[2] != 0);
    }
    assert!(shared > 200, "they overlap in {shared} pixels");
}
