//! The observer's camera in a file.

use photosurface::jobs::load_models;
use photosurface::scene::Attributes;
use photosurface::write::{GltfFile, GltfOutput, ObserverCamera, Playback, Target};
use photosurface::{DQuat, DVec3, PlacedScene, Scene, SurfaceOptions};
use serde_json::{Value, json};

use crate::common::command::{Workplace, glb_json};
use crate::common::glb::Glb;

/// An observer inside a marker flies past two balls.
const PASSING: &str = r#"{ "observer": { "velocity": [0.7, 0, 0], "marker": 0.05 }, "steps": [-1, 0, 1, 2], "objects": [
    { "name": "camera", "shape": { "sphere": { "radius": 1 } }, "position": [3, 1.5, -1.2] },
    { "name": "ball", "shape": { "sphere": { "radius": 0.5 } }, "position": [4, 0, -1] } ] }"#;

fn exported(workplace: &Workplace, flags: &str) -> Value {
    workplace
        .run(&format!("export scene.json {flags} -o out.glb"))
        .success();
    glb_json(&workplace.read("out.glb"))
}

fn workplace() -> Workplace {
    let workplace = Workplace::new();
    workplace.write("scene.json", PASSING);
    workplace
}

/// The names of nodes with a camera, and where those look.
fn cameras(json: &Value) -> Vec<(String, DVec3)> {
    let nodes = json["nodes"].as_array().expect("nodes").iter();
    let with_camera = nodes.filter(|node| node.get("camera").is_some());
    let look = |node: &Value| {
        let turn: [f64; 4] = match node.get("rotation") {
            Some(rotation) => serde_json::from_value(rotation.clone()).expect("a quaternion"),
            None => [0.0, 0.0, 0.0, 1.0],
        };
        assert!(
            node.get("translation").is_none(),
            "the observer is at the origin"
        );
        DQuat::from_array(turn) * DVec3::NEG_Z
    };
    with_camera
        .map(|node| {
            (
                node["name"].as_str().expect("a name").to_owned(),
                look(node),
            )
        })
        .collect()
}

#[test]
fn each_step_has_a_camera_below_its_node_and_names_stay_unique() {
    let workplace = workplace();
    let json = exported(&workplace, "--camera --look 1,2,-3 --fov 40 --size 400x100");
    let (nodes, look) = (
        json["nodes"].as_array().expect("nodes"),
        DVec3::new(1.0, 2.0, -3.0),
    );
    for (step, (name, direction)) in cameras(&json).into_iter().enumerate() {
        // An object has the name "camera".
        assert_eq!(name, format!("camera_2_step{step:03}"));
        assert!(direction.distance(look.normalize()) < 1e-12, "{direction}");
        let parent = nodes
            .iter()
            .find(|node| node["name"] == format!("step{step:03}"));
        let children = parent.expect("a node of the step")["children"]
            .as_array()
            .expect("children");
        let names: Vec<_> = children
            .iter()
            .map(|child| &nodes[child.as_u64().unwrap() as usize]["name"])
            .collect();
        let expected =
            ["camera", "ball", "camera_2"].map(|name| json!(format!("{name}_step{step:03}")));
        assert_eq!(names, expected.iter().collect::<Vec<_>>());
    }
    assert_eq!(cameras(&json).len(), 4);
    let perspective = &json["cameras"][0]["perspective"];
    assert_eq!(perspective["aspectRatio"], 4.0);
    let fov = perspective["yfov"].as_f64().expect("an angle").to_degrees();
    assert!((fov - 40.0).abs() < 1e-12, "{fov}");
    // The camera is inside the marker and does not see it; the balls are beyond.
    let near = perspective["znear"].as_f64().expect("a depth");
    assert!(near > 0.05 && near < 0.1, "{near}");
    assert!(perspective["zfar"].as_f64().expect("a depth") > 4.0);
    // What is not asked for is not there.
    let plain = exported(&workplace, "");
    assert!(plain.get("cameras").is_none() && cameras(&plain).is_empty());
}

#[test]
fn one_step_and_files_for_each_step_have_a_camera_beside_their_meshes() {
    let workplace = workplace();
    let json = exported(&workplace, "--camera --look 1,0,0.5 --steps 0");
    assert_eq!(json["scenes"][0]["nodes"], json!([0, 1, 2, 3]));
    let one = cameras(&json);
    assert_eq!(one[0].0, "camera_2");
    workplace
        .run("export scene.json --camera --look 1,0,0.5 --split -o split.glb")
        .success();
    let split = glb_json(&workplace.read("split_step001.glb"));
    assert_eq!(split["scenes"][0]["nodes"], json!([0, 1, 2, 3]));
    let of_split = cameras(&split);
    assert_eq!(
        (of_split[0].0.as_str(), of_split[0].1),
        ("camera_2_step001", one[0].1)
    );
}

/// The interpolation and number of keys of each track of rotations, and the rotations.
fn rotations(file: &[u8]) -> Vec<(String, Vec<DQuat>)> {
    let glb = Glb::new(file);
    let animation = &glb.json["animations"][0];
    let channels = animation["channels"].as_array().expect("channels").iter();
    let turning = channels.filter(|channel| channel["target"]["path"] == "rotation");
    let track = |channel: &Value| {
        let sampler = channel["sampler"].as_u64().expect("an index") as usize;
        let sampler = &animation["samplers"][sampler];
        let how = sampler["interpolation"].as_str().unwrap_or("LINEAR");
        let numbers = glb.numbers(&sampler["output"]);
        let turns = numbers.chunks_exact(4);
        let turns =
            turns.map(|turn| DQuat::from_array([0, 1, 2, 3].map(|axis| f64::from(turn[axis]))));
        (how.to_owned(), turns.collect())
    };
    turning.map(track).collect()
}

/// A camera that looks elsewhere at each step has keys, of which neighbours are less than half a turn apart; one that
/// looks in one direction has none.
#[test]
fn a_camera_of_an_animation_turns_only_where_it_looks_elsewhere() {
    let scene = Scene::from_json(PASSING).expect("a scene");
    let (models, _) = load_models(&scene, "".as_ref()).expect("shapes alone");
    let placed = PlacedScene::new(scene, models).expect("a scene");
    let turn = DQuat::from_rotation_y;
    // Half a turn on, the same rotation has two quaternions.
    let turning = vec![turn(3.0), turn(3.5), -turn(4.0), turn(2.5)];
    for (playback, how) in [
        (
            Playback::Frames {
                frames_per_second: 10.0,
            },
            "STEP",
        ),
        (
            Playback::Morph {
                frames_per_second: 10.0,
            },
            "LINEAR",
        ),
    ] {
        for (rotations_of_steps, tracks) in [(turning.clone(), 1), (vec![turn(1.0); 4], 0)] {
            let mut bytes = vec![];
            let output = GltfOutput::glb(Target::Stream(&mut bytes), 8);
            let mut file = GltfFile::new(
                output,
                &placed.facts(),
                None,
                Attributes::default(),
                Some(playback),
            )
            .expect("a file");
            file.set_camera(ObserverCamera {
                name: "eye".to_owned(),
                vertical_fov_rad: 1.0,
                aspect: 1.5,
                depths: [0.1, 10.0],
                rotations: rotations_of_steps.clone(),
            });
            let options = SurfaceOptions::default();
            match playback {
                Playback::Morph { .. } => {
                    for part in placed.morphing(options) {
                        file.add_morphing(&part).expect("a part");
                    }
                }
                Playback::Frames { .. } => {
                    for step in 0..4 {
                        for surface in placed.photosurfaces(step, options).expect("a step") {
                            file.add(&surface).expect("a photosurface");
                        }
                    }
                }
            }
            file.finish().expect("a file");
            let json = glb_json(&bytes);
            let there = cameras(&json);
            assert_eq!((there.len(), there[0].0.as_str()), (1, "eye"));
            assert!(there[0].1.distance(rotations_of_steps[0] * DVec3::NEG_Z) < 1e-12);
            let found = rotations(&bytes);
            assert_eq!(found.len(), tracks);
            for (interpolation, turns) in found {
                assert_eq!((interpolation.as_str(), turns.len()), (how, 4));
                for (found, expected) in turns.iter().zip(&turning) {
                    assert!((found.dot(*expected).abs() - 1.0).abs() < 1e-6);
                }
                assert!(turns.windows(2).all(|pair| pair[0].dot(pair[1]) > 0.0));
            }
        }
    }
}

/// Whoever looks along an axis of her own keeps that direction, however the flight goes.
#[test]
fn a_pilot_s_camera_has_no_keys() {
    let workplace = workplace();
    let flight = r#""flight": [{ "proper_time": 3, "acceleration": [0, 0, 0.1] }], "marker""#;
    workplace.write("pilot.json", PASSING.replacen("\"marker\"", flight, 1));
    for flags in ["--animate", "--animate=morph"] {
        workplace
            .run(&format!("export pilot.json --camera {flags} -o out.glb"))
            .success();
        assert!(rotations(&workplace.read("out.glb")).is_empty(), "{flags}");
        assert_eq!(
            cameras(&glb_json(&workplace.read("out.glb")))[0].1,
            DVec3::NEG_Z
        );
    }
}

#[test]
fn a_marker_as_large_as_the_distance_is_left_out() {
    let workplace = workplace();
    let run = workplace
        .run("export scene.json --marker 1 --camera -o out.glb")
        .success();
    assert!(
        run.stderr.contains("without the observer's marker"),
        "{run}"
    );
    assert!(!run.stderr.contains("and the marker"), "{run}");
    let json = glb_json(&workplace.read("out.glb"));
    assert!(
        json["nodes"]
            .as_array()
            .expect("nodes")
            .iter()
            .all(|node| node["name"] != "observer")
    );
    let run = workplace
        .run("export scene.json --camera -o out.glb")
        .success();
    assert!(
        run.stderr.contains("and the marker") && !run.stderr.contains("note"),
        "{run}"
    );
}

#[test]
fn cameras_that_no_file_can_have_are_refused() {
    let workplace = workplace();
    let refused = |flags: &str, words: &[&str]| {
        workplace
            .run(&format!("export scene.json {flags}"))
            .error(words)
    };
    refused(
        "--camera -o out.ply",
        &["--camera", ".ply has no camera", ".glb"],
    );
    refused("--camera --format ply", &["--camera", ".ply has no camera"]);
    refused("--camera --fov 180", &["--fov", "180", "less than 180"]);
    refused(
        "--camera --look 0,0,0",
        &["--look", "expected a finite vector"],
    );
    refused(
        "--camera --target 0,0,0",
        &["--target", "place of the observer"],
    );
    refused("--camera --models seen,rest", &["--camera", "--models"]);
    refused("--fov 30", &["--camera"]);
    refused(
        "--camera --look 1,0,0 --target 1,0,0",
        &["--look", "--target"],
    );
}
