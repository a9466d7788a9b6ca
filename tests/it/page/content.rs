//! What a page says of a scene, and the meshes that it holds.

use std::path::Path;

use photosurface::read::read_model_bytes;
use photosurface::scene::BUILT_IN_SCENES;
use photosurface::{DQuat, DVec3};
use serde_json::{Value, json};

use super::taken_apart::Page;
use crate::common::command::{SQUARE, Workplace, node_names};

/// Everything that a page knows of.
const SCENE: &str = r#"{ "title": "Three things & a square",
  "observer": { "position": [1, 2, 3], "time": 0.5, "velocity": [0, 0, -0.6], "orientation": [0, 0.6, 0, 0.8], "marker": 0.125,
    "flight": [ { "proper_time": 1, "acceleration": [0, 0.125, -0.5], "turn_rate": [0.25, 0, 0.5] },
      { "proper_time": 2, "acceleration": [-0.5, 0, 0], "steer": "coordinated" } ] },
  "steps": [0, 1.5], "effects": { "doppler": { "kelvin": 3000 }, "searchlight": true, "exposure": 1.5 },
  "objects": [
    { "name": "ball", "shape": { "sphere": { "radius": 1.5 } }, "position": [3, 1, -6], "velocity": [0, 0, 0.25],
      "emission": { "kelvin": 4000, "luminance": 2 } },
    { "name": "a box", "shape": { "box": { "size": [1, 2, 3] } }, "position": [-3, 0, -4], "rotation": [0, 0, 0.6, 0.8],
      "scale": [1, 2, 3], "model": "contracted" },
    { "name": "ring", "shape": { "torus": { "major_radius": 2, "minor_radius": 0.5 } } },
    { "name": "square", "file": "square.obj", "normals": "none", "position": [1e6, 0, 0], "scale": 3 } ] }"#;

fn made() -> Page {
    let workplace = Workplace::new();
    workplace.write("square.obj", SQUARE);
    Page::of(SCENE, &workplace.path(""))
}

#[test]
fn everything_that_the_scene_says_is_in_the_page() {
    let Value::Object(mut found) = made().scene else {
        panic!("an object");
    };
    let rapidity = |value: &mut Value, beta: f64| {
        let found = value["rapidity"].take().as_f64().expect("a number");
        assert!((found - beta.atanh()).abs() < 1e-15, "{found}");
    };
    rapidity(&mut found["observer"], 0.6);
    rapidity(&mut found["objects"][0], 0.25);
    let facts = [
        ("version", json!(env!("CARGO_PKG_VERSION"))),
        ("title", json!("Three things & a square")),
        ("input", json!("")),
        (
            "observer",
            json!({ "time": 0.5, "position": [1.0, 2.0, 3.0], "rapidity": null, "direction": [0.0, 0.0, -1.0],
                "orientation": [0.0, 0.6, 0.0, 0.8] }),
        ),
        (
            "flight",
            json!([
                { "proper_time": 1.0, "acceleration": [0.0, 0.125, -0.5], "turn_rate": [0.25, 0.0, 0.5], "steer": "free" },
                { "proper_time": 2.0, "acceleration": [-0.5, 0.0, 0.0], "turn_rate": [0.0, 0.0, 0.0],
                    "steer": "coordinated" },
            ]),
        ),
        ("steps", json!([0.0, 1.5])),
        ("marker", json!(0.125)),
        (
            "effects",
            json!({ "doppler": "spectrum", "searchlight": true, "exposure": 1.5 }),
        ),
        ("model", json!("seen")),
        ("lamps", json!(0)),
    ];
    for (name, expected) in facts {
        assert_eq!(found[name], expected, "{name}");
    }
    let objects = [
        json!({ "name": "ball", "position": [3.0, 1.0, -6.0], "rapidity": null, "direction": [0.0, 0.0, 1.0],
            "shape": { "sphere": { "radius": 1.5 } }, "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0],
            "emission": { "kelvin": 4000.0, "luminance": 2.0 } }),
        json!({ "name": "a box", "position": [-3.0, 0.0, -4.0], "rapidity": 0.0, "model": "contracted", "shape": null,
            "rotation": [0.0, 0.0, 0.6, 0.8], "scale": [1.0, 2.0, 3.0], "emission": null }),
        json!({ "name": "ring", "position": [0.0, 0.0, 0.0], "rapidity": 0.0,
            "shape": { "torus": { "major_radius": 2.0, "minor_radius": 0.5 } }, "emission": null }),
        json!({ "name": "square", "position": [1e6, 0.0, 0.0], "rapidity": 0.0, "shape": null, "emission": null }),
    ];
    assert_eq!(
        found["objects"].as_array().map(Vec::len),
        Some(objects.len())
    );
    for (expected, found) in objects
        .iter()
        .zip(found["objects"].as_array().expect("a list"))
    {
        for (name, value) in expected.as_object().expect("an object") {
            assert_eq!(found[name], *value, "{name} of {found}");
        }
    }
}

#[test]
fn a_scene_without_wishes_has_none_in_its_page() {
    let scene = r#"{ "objects": [{ "name": "ball", "shape": { "sphere": { "radius": 1 } } }, { "name": "b",
        "shape": { "box": { "size": [1, 1, 1] } } }] }"#;
    let found = Page::of(scene, Path::new("")).scene;
    assert_eq!(found["title"], "ball, b");
    assert_eq!(found["flight"], json!([]));
    assert_eq!(found["effects"]["doppler"], "none");
    assert_eq!(found["effects"]["searchlight"], false);
}

#[test]
fn meshes_are_at_rest_where_the_scene_has_them() {
    let page = made();
    // The flight, the velocities, the model and the place of the observer change nothing of this.
    let place = |(local, offset): ([f64; 3], [f64; 3])| (DVec3::from(local), DVec3::from(offset));
    let ball: Vec<_> = page.vertices(0).into_iter().map(place).collect();
    assert!(ball.len() > 200, "{}", ball.len());
    for (local, offset) in ball {
        assert!((local.length() - 1.5).abs() < 3e-7, "{local}");
        assert_eq!(offset, DVec3::new(3.0, 1.0, -6.0));
    }
    let ring: Vec<_> = page.vertices(2).into_iter().map(place).collect();
    assert!(ring.len() > 200, "{}", ring.len());
    for (local, offset) in ring {
        let tube = DVec3::new(local.x.hypot(local.z) - 2.0, local.y, 0.0);
        assert!((tube.length() - 0.5).abs() < 6e-7, "{local}");
        assert_eq!(offset, DVec3::ZERO);
    }
    let corners: Vec<_> = page.vertices(1).into_iter().map(place).collect();
    assert_eq!(corners.len(), 24, "a box needs no vertex but its corners");
    let back = DQuat::from_xyzw(0.0, 0.0, 0.6, 0.8).inverse();
    for (local, offset) in corners {
        let corner = (back * local).abs();
        assert!(
            (corner - DVec3::new(0.5, 2.0, 4.5)).length() < 1e-6,
            "{corner}"
        );
        assert_eq!(offset, DVec3::new(-3.0, 0.0, -4.0));
    }
    // Far away as well, a vertex keeps its digits: in the order of the file.
    let square: Vec<_> = page.vertices(3).into_iter().map(place).collect();
    let expected = [(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)];
    assert_eq!(square.len(), 4);
    for ((local, offset), (x, y)) in square.into_iter().zip(expected) {
        assert_eq!(local + offset, DVec3::new(1e6 + x, y, 0.0));
    }
}

#[test]
fn round_shapes_have_the_resolution_that_they_ask_for() {
    let meshes = |resolution: &str| {
        let scene = format!(
            r#"{{ "objects": [{{ "name": "ball", "shape": {{ "sphere": {{ "radius": 1 {resolution} }} }} }}] }}"#
        );
        Page::of(&scene, Path::new("")).vertices(0).len()
    };
    assert_eq!(meshes(""), meshes(r#", "resolution": 24"#));
    assert!(meshes(r#", "resolution": 8"#) < meshes(""));
    assert!(meshes(r#", "resolution": 64"#) > 2 * meshes(""));
}

#[test]
fn each_node_of_the_meshes_belongs_to_one_object() {
    for scene in BUILT_IN_SCENES {
        let page = Page::of(scene.json, Path::new(""));
        assert_eq!(
            page.nodes().concat(),
            node_names(&page.meshes),
            "{}",
            scene.name
        );
    }
    let workplace = Workplace::new();
    let parts = "o part\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl b\nf 1 3 2\no part/2\nf 1 2 3\no part_2\nf 3 2 1\n";
    workplace.write("parts.obj", parts);
    let scene = r#"{ "objects": [ { "name": "it", "file": "parts.obj" }, { "name": "it_part", "file": "parts.obj" },
        { "name": "größe/\"<b>", "file": "parts.obj", "position": [1, 0, 0] } ] }"#;
    let page = Page::of(scene, &workplace.path(""));
    let nodes = page.nodes();
    assert_eq!(nodes.concat(), node_names(&page.meshes));
    assert!(nodes.iter().all(|nodes| nodes.len() == 4), "{nodes:?}");
    assert_eq!(page.scene["objects"][2]["name"], "größe/\"<b>");
    for object in 0..3 {
        page.vertices(object);
    }
}

#[test]
fn a_mesh_is_in_the_page_as_its_file_has_it() {
    let workplace = Workplace::new();
    let places = [
        DVec3::new(0.1, 1.0 / 3.0, -7.25),
        DVec3::new(100.3, 0.0, 1e-3),
        DVec3::new(-3.7, 20.0, 5.5),
        DVec3::new(2.0, 2.5, 1e2),
        DVec3::new(0.0, -1.5, 0.7),
        DVec3::new(-9.0, 4.4, -2.2),
    ];
    let vertices: Vec<_> = places
        .iter()
        .map(|p| format!("v {} {} {}\n", p.x, p.y, p.z))
        .collect();
    let text = format!("{}o first\nf 1 2 3\no second\nf 4 5 6\n", vertices.concat());
    workplace.write("my mesh.obj", text);
    let run = workplace
        .run_shell("photosurface page 'my mesh.obj' --beta 0.9 --normals none -o page.html");
    run.success();
    let page = Page::new(workplace.read("page.html"));
    assert_eq!(page.scene["input"], "'my mesh.obj' --normals none");
    let rapidity = page.scene["observer"]["rapidity"]
        .as_f64()
        .expect("a number");
    assert!((rapidity - 0.9_f64.atanh()).abs() < 1e-14);
    let (model, _) =
        read_model_bytes(&page.meshes, Path::new("")).expect("our own reader reads it");
    let names: Vec<_> = model.parts.iter().map(|part| &*part.name).collect();
    assert_eq!(page.nodes().concat(), names);
    assert_eq!(names.len(), 2);
    let found = model.parts.iter().flat_map(|part| part.mesh().positions());
    let mut count = 0;
    for (found, expected) in found.zip(places) {
        assert!(
            (*found - expected).abs().max_element() < 1e-5,
            "{found} {expected}"
        );
        count += 1;
    }
    assert_eq!(count, places.len());
    let triangles: Vec<_> = model
        .parts
        .iter()
        .map(|part| part.mesh().triangles())
        .collect();
    assert_eq!(triangles, [[[0, 1, 2]], [[0, 1, 2]]]);
}
