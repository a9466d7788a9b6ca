//! Scenes of many objects: each flat one is as it is alone, round ones share meshes, what is alike is there once, in little
//! memory, on any number of threads.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

use photosurface::{
    DVec3, ExportSettings, Photosurface, PlacedScene, Scene, Source, SurfaceOptions, export,
    load_models,
};
use serde_json::{Value, json};

use crate::common::Random;
use crate::common::curve::on_curve;
use crate::common::glb::{Glb, index};
use crate::common::refining::distance_to_mesh;

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

/// Each flat object of a crowd is made as if there were no other.
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
        pool.unwrap().install(|| {
            let mut objects: Vec<Value> = (0..160).map(|k| object(k, mixed(k))).collect();
            objects.extend((0..40).map(far_away));
            exported(&placed(objects))
        })
    };
    let [one, two, five] = [1, 2, 5].map(with);
    assert!(one == two && one == five);
}

/// Balls and rings in a field far ahead: many are seen in nearly the same direction.
fn far_away(k: usize) -> Value {
    let (x, z) = ((k % 8) as f64, (k / 8) as f64);
    let shape = match k % 2 {
        0 => json!({ "sphere": { "radius": 0.5 } }),
        _ => json!({ "torus": { "major_radius": 0.4, "minor_radius": 0.15 } }),
    };
    json!({ "name": format!("far{k}"), "shape": shape, "scale": [1, 0.8, 1.1],
            "position": [1.5 * x - 6.0, -1.2 + 0.1 * z, -1.5 * z - 60.0] })
}

/// Round objects of one shape that are seen in nearly the same direction share a mesh. What is proven of it for one holds for
/// all, with few triangles more than each would have alone.
#[test]
fn round_objects_seen_in_one_direction_share_a_mesh_that_is_proven_for_each() {
    let objects: Vec<Value> = (0..64).map(far_away).collect();
    let of_crowd = surfaces(&placed(objects.clone()), true);
    let mut random = Random::new(5);
    let mut shared = 0;
    let meshes: Vec<_> = of_crowd
        .iter()
        .map(|surface| surface.mesh.triangles())
        .collect();
    for (k, surface) in of_crowd.iter().enumerate() {
        let certificate = &surface.facts.certificate;
        assert!(certificate.complete && certificate.curvature == 0.0, "{k}");
        let alike = meshes.iter().filter(|mesh| **mesh == meshes[k]).count();
        shared += usize::from(alike >= 4);
        let scene = placed(vec![objects[k].clone()]);
        let (object, _) = scene.objects().next().unwrap();
        let view = scene.view(object, 0).unwrap();
        let to_rest = object.model_to_rest();
        let seen = |place: DVec3| view.seen_position(to_rest.transform_point3(place));
        let Source::Shape(shape, _) = &object.source else {
            panic!("all have shapes");
        };
        // Corners are on the photosurface, and no place of it is far from the mesh.
        for _ in 0..40 {
            let distance = distance_to_mesh(seen(on_curve(shape, &mut random)), &surface.mesh);
            assert!(
                distance <= certificate.total * (1.0 + 1e-9),
                "{k}: {distance:e} {certificate:?}"
            );
        }
        if k % 8 == 0 {
            let alone = &surfaces(&scene, true)[0];
            let ratio = surface.facts.triangles as f64 / alone.facts.triangles as f64;
            assert!((1.0..1.25).contains(&ratio), "{k}: {ratio}");
        }
    }
    assert!(shared >= 48, "{shared} of 64");
}

/// In a file such objects have their indices and texture coordinates once.
#[test]
fn what_round_objects_share_is_in_the_file_once() {
    let glb = Glb::new(&exported(&placed((0..64).map(far_away).collect())));
    let primitives = glb.json["meshes"].as_array().unwrap().iter();
    let indices: HashSet<usize> = primitives
        .map(|mesh| index(&mesh["primitives"][0]["indices"]))
        .collect();
    assert!(indices.len() <= 12, "{}", indices.len());
}

/// A few objects, and those whose tolerance is an angle, are as they are alone.
#[test]
fn few_round_objects_are_as_they_are_alone() {
    let few = (0..64).filter(|k| k % 11 == 0).map(far_away).collect();
    let of_angles = (0..16).map(|k| {
        let mut object = far_away(k);
        object["tolerance"] = json!({ "angle_deg": 0.01 });
        object
    });
    for objects in [few, of_angles.collect::<Vec<_>>()] {
        for (object, surface) in objects.iter().zip(surfaces(&placed(objects.clone()), true)) {
            let alone = &surfaces(&placed(vec![object.clone()]), true)[0];
            assert_eq!(facts(alone), facts(&surface));
            assert!(alone.mesh == surface.mesh);
        }
    }
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
