//! Every way to export and to draw follows a flight.

use photosurface::Scene;
use photosurface::pipeline::MomentFacts;
use serde_json::Value;

use crate::common::command::{Workplace, glb_json};

/// Thrust, then a coordinated turn; one thing at rest, one that moves.
const SCENE: &str = r#"{ "observer": { "velocity": { "rapidity": 0.7, "direction": [0, 0, -1] }, "marker": 0.1, "flight": [
    { "proper_time": 1, "acceleration": [0, 0, -0.5] },
    { "proper_time": 3, "acceleration": [-0.4, 0, 0], "steer": "coordinated" } ] },
  "steps": [-0.5, 0.5, 2, 5], "tolerance": { "relative": 1e-2 },
  "objects": [ { "name": "cube", "shape": { "box": { "size": [2, 2, 2] } }, "position": [-3, 0, -4] },
    { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [3, 1, -6], "velocity": [0, 0, 0.3] } ] }"#;

fn workplace() -> Workplace {
    let workplace = Workplace::new();
    workplace.write("flying.json", SCENE);
    workplace
}

/// What the library says of the observer at each step.
fn moments() -> Vec<Value> {
    let scene = Scene::from_json(SCENE).expect("valid");
    let facts = scene
        .steps()
        .iter()
        .map(|&step| MomentFacts::new(scene.flight(), step));
    facts
        .map(|facts| serde_json::to_value(facts).expect("numbers"))
        .collect()
}

/// Facts of photosurfaces, in a file or in a report: certified, and of the observer who was there.
#[track_caller]
fn assert_along_the_flight<'a>(facts: impl IntoIterator<Item = &'a Value>, count: usize) {
    let (moments, mut found) = (moments(), 0);
    for facts in facts {
        let step = facts["step"].as_u64().expect("a step") as usize;
        assert_eq!(facts["observer"], moments[step], "{facts}");
        assert_eq!(facts["certificate"]["complete"], true, "{facts}");
        found += 1;
    }
    assert_eq!(found, count);
}

#[test]
fn every_export_follows_the_flight() {
    let workplace = workplace();
    for flags in [
        "",
        "--split",
        "--animate",
        "--animate=morph",
        "--attributes doppler,emission_time,rest_position,radiance",
        "--max-triangles 200000",
    ] {
        let line = format!("export flying.json -o out.glb --report report.json {flags}");
        workplace.run(&line).success();
        let report = workplace.read_json("report.json");
        assert_along_the_flight(report["objects"].as_array().expect("a list"), 8);
        assert_eq!(
            report["scene"]["observer_flight"][1]["steer"],
            "coordinated"
        );
    }
    let line = "export flying.json -o levels.glb --report report.json --lod 1e-1,1e-2";
    workplace.run(line).success();
    for level in 0..2 {
        let report = workplace.read_json(&format!("report_lod{level}.json"));
        assert_along_the_flight(report["objects"].as_array().expect("a list"), 8);
    }
    // The same facts stand in the file, and each step of --split is that of the whole.
    let whole = glb_json(&workplace.read("out.glb"));
    let nodes = whole["nodes"].as_array().expect("a list");
    assert_along_the_flight(
        nodes
            .iter()
            .filter_map(|node| node["extras"].get("step").map(|_| &node["extras"])),
        8,
    );
    for step in 0..4 {
        let part = glb_json(&workplace.read(&format!("out_step{step:03}.glb")));
        let nodes = part["nodes"].as_array().expect("a list");
        let seen = |node: &&Value| node["extras"].get("step").is_some();
        for node in nodes.iter().filter(seen) {
            let name = node["name"].as_str().expect("a name");
            let whole = whole["nodes"].as_array().expect("a list");
            let same = whole.iter().find(|other| other["name"] == name);
            let same = same.unwrap_or_else(|| panic!("{name} is not in the whole"));
            assert_eq!(node["translation"], same["translation"], "{name}");
            assert_eq!(
                node["extras"]["observer"], same["extras"]["observer"],
                "{name}"
            );
        }
    }
    workplace.run("check flying.json").success();
}

#[test]
fn every_picture_follows_the_flight() {
    let workplace = workplace();
    for (flags, files) in [
        ("", 4),
        ("--method mesh", 4),
        ("--view outside --axes", 4),
        ("--view outside --together", 1),
        ("--sheet", 1),
        ("--full-sky", 4),
    ] {
        let before = workplace.files().len();
        let name = format!("picture{before}.png");
        workplace
            .run(&format!(
                "render flying.json --size 96x48 -o {name} {flags}"
            ))
            .success();
        assert_eq!(workplace.files().len() - before, files, "{flags}");
    }
}
