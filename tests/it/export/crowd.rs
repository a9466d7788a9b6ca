//! Scenes of many objects: each is as it is alone, what is alike is there once, in little memory, on any number of threads.

use std::fs;
use std::path::Path;

use photosurface::{
    ExportSettings, Photosurface, PlacedScene, Scene, SurfaceOptions, export, load_models,
};
use serde_json::{Value, json};

use crate::common::glb::{Glb, index};

/// An object on a field below the observer and ahead; nearer ones need more triangles.
fn object(k: usize, source: Value) -> Value {
    let (x, z) = ((k % 20) as f64, (k / 20) as f64);
    let mut object = json!({
        "name": format!("o{k}"),
        "position": [1.5 * (x - 10.0), -1.2, -1.5 * z + 2.0],
    });
    for (key, value) in source.as_object().unwrap() {
        object[key] = value.clone();
    }
    object
}

fn cuboid() -> Value {
    json!({ "shape": { "box": { "size": [1, 1, 1] } } })
}

/// Objects of all kinds, some of them alike.
fn mixed(k: usize) -> Value {
    match k % 8 {
        0 | 1 => cuboid(),
        2 => json!({ "shape": { "box": { "size": [1, 1, 1] } }, "scale": [1, 0.5, 1.2] }),
        3 => json!({ "shape": { "grid": { "size": 1, "cells": 3 } }, "checker": "#ffffff" }),
        4 => json!({ "shape": { "lattice": { "cells": 1, "spacing": 0.8, "thickness": 0.2 } } }),
        5 => {
            json!({ "shape": { "box": { "size": [1, 1, 1] } }, "tolerance": { "angle_deg": 0.1 } })
        }
        6 => json!({ "shape": { "box": { "size": [1, 1, 1] } }, "model": "delayed",
                     "rotation": [0, 0.6, 0, 0.8] }),
        _ => json!({ "shape": { "box": { "size": [1, 1, 1], "resolution": 3 } } }),
    }
}

fn placed(objects: Vec<Value>) -> PlacedScene {
    let scene = json!({ "observer": { "velocity": { "beta": 0.9 } }, "objects": objects });
    let scene = Scene::from_json(&scene.to_string()).unwrap();
    let (models, _) = load_models(&scene, Path::new("")).unwrap();
    PlacedScene::new(scene, models).unwrap()
}

fn crowd(count: usize, source: impl Fn(usize) -> Value) -> PlacedScene {
    placed((0..count).map(|k| object(k, source(k))).collect())
}

fn surfaces(placed: &PlacedScene, subdivide: bool) -> Vec<Photosurface> {
    let wanted = SurfaceOptions {
        subdivide,
        ..SurfaceOptions::default()
    };
    placed.photosurfaces(0, wanted).unwrap().collect()
}

fn exported(placed: &PlacedScene) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.glb");
    export(placed, &ExportSettings::default(), &path, &()).unwrap();
    fs::read(path).unwrap()
}

/// Each object of a crowd is made as if there were no other.
#[test]
fn an_object_in_a_crowd_is_as_it_is_alone() {
    let together = surfaces(&crowd(160, mixed), true);
    assert_eq!(together.len(), 160);
    let triangles = together.iter().map(|surface| surface.facts.triangles);
    let (least, most) = (triangles.clone().min(), triangles.max());
    assert!(most > least.map(|least| 20 * least), "{least:?} {most:?}");
    for (k, surface) in together.iter().enumerate() {
        let alone = surfaces(&placed(vec![object(k, mixed(k))]), true);
        let [alone] = &alone[..] else {
            panic!("one object");
        };
        assert_eq!(facts(alone), facts(surface));
        assert!(alone.mesh == surface.mesh, "{}", surface.facts.name);
        assert!(surface.facts.certificate.complete);
    }
}

fn facts(surface: &Photosurface) -> Value {
    serde_json::to_value(&surface.facts).unwrap()
}

#[test]
fn threads_make_no_difference_to_a_crowd() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| exported(&crowd(160, mixed)))
    };
    let [one, two, five] = [1, 2, 5].map(with);
    assert!(one == two && one == five);
}

/// A tolerance that is a part of the size is a part of the size of the whole photosurface: that of a flat shape bends
/// between the corners of its coarsest form, from which refinement starts.
#[test]
fn the_size_of_a_flat_shape_is_that_of_its_bent_faces() {
    for source in [
        json!({ "shape": { "box": { "size": [6, 1, 4] } } }),
        json!({ "shape": { "grid": { "size": 5, "cells": 1 } }, "rotation": [0, 0.6, 0, 0.8] }),
        json!({ "shape": { "lattice": { "cells": 1, "spacing": 4, "thickness": 0.2 } }, "scale": [1, 1.2, 1] }),
        json!({ "shape": { "box": { "size": [6, 1, 4] } }, "model": "delayed" }),
    ] {
        // The observer is above the middle, whose far corners are seen far behind.
        let mut object = object(0, source.clone());
        object["position"] = json!([0.3, -1, 1]);
        let placed = placed(vec![object]);
        let diagonal = |surface: &Photosurface| {
            let (low, high) = surface.mesh.bounds().unwrap();
            (high - low).length()
        };
        let refined = &surfaces(&placed, true)[0];
        let certificate = &refined.facts.certificate;
        let fine = diagonal(&surfaces(&placed, false)[0]);
        let ratio = certificate.tolerance / (1e-3 * fine);
        assert!((ratio - 1.0).abs() < 1e-12, "{source}: {ratio}");
        assert!(certificate.complete, "{source}");
        // The corners alone are not as far apart.
        let (object, parts) = placed.objects().next().unwrap();
        let view = placed.model_view(object, 0).unwrap();
        let corners = parts[0].1.mesh().positions().iter();
        let seen = corners.map(|&corner| view.shown_position(corner));
        let low = seen.clone().reduce(|a, b| a.min(b)).unwrap();
        let high = seen.reduce(|a, b| a.max(b)).unwrap();
        assert!((high - low).length() < 0.99 * fine, "{source}");
    }
}

#[test]
fn what_boxes_of_one_kind_share_is_in_the_file_once() {
    let placed = placed(
        (0..50)
            .map(|k| {
                let mut object = object(k, cuboid());
                // Far from the observer nothing is refined.
                object["position"] = json!([3 * k, -40, -900]);
                object
            })
            .collect(),
    );
    let glb = Glb::new(&exported(&placed));
    let primitives = glb.json["meshes"].as_array().unwrap().iter();
    let primitives: Vec<&Value> = primitives.map(|mesh| &mesh["primitives"][0]).collect();
    assert_eq!(primitives.len(), 50);
    for primitive in &primitives {
        let own = |key: &str| index(&primitive["attributes"][key]);
        assert_eq!(
            index(&primitive["indices"]),
            index(&primitives[0]["indices"])
        );
        assert_eq!(
            own("TEXCOORD_0"),
            index(&primitives[0]["attributes"]["TEXCOORD_0"])
        );
        assert_eq!(
            glb.numbers(&primitive["attributes"]["POSITION"]).len(),
            3 * 24
        );
    }
    assert_eq!(glb.json["materials"].as_array().unwrap().len(), 1);
}

/// In the default resolution, the vertices of so many boxes take 600 MB.
#[cfg(target_os = "linux")]
#[test]
fn a_crowd_of_boxes_takes_little_memory() {
    use crate::common::alone::{alone, peak_memory};
    alone(
        "export::crowd::a_crowd_of_boxes_takes_little_memory",
        || {
            let before = peak_memory();
            // Each has a size of its own.
            let placed = crowd(
                1500,
                |k| json!({ "shape": { "box": { "size": [1, 1.0 + k as f64 / 1e4, 1] } } }),
            );
            exported(&placed);
            let more = peak_memory() - before;
            assert!(more < 60_000_000, "{more} bytes");
        },
    );
}
