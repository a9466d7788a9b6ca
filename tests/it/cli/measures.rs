//! Measures on the command line and in scenes: which distance a tolerance limits.

use crate::common::command::Workplace;
use serde_json::Value;

const PLATE: &str = r#"{ "grid": { "size": 2, "cells": 1 } }, "position": [0, -1, 0]"#;
const BALL: &str = r#"{ "sphere": { "radius": 1 } }, "position": [0, -2, 0]"#;

/// An object without a picture, and a checkered plate that holds the motion.
fn two(shape: &str, scene: &str, object: &str) -> String {
    format!(
        r##"{{ "observer": {{ "velocity": {{ "beta": 0.6, "direction": [1, 0, 0] }} }}, {scene}
  "objects": [
    {{ "name": "plain", "shape": {shape} {object} }},
    {{ "name": "checkered", "shape": {{ "grid": {{ "size": 2, "cells": 1 }} }}, "position": [0, 1, 0],
      "color": "#ffffff", "checker": "#000000" }} ],
  "tolerance": {{ "absolute": 1e-3 }} }}"##
    )
}

#[test]
fn the_measure_is_that_of_flag_object_scene_or_default() {
    let workplace = Workplace::new();
    for (scene, object, flags, expected) in [
        ("", "", "", ["surface", "points"]),
        ("", "", "--measure points", ["points", "points"]),
        ("", "", "--measure surface", ["surface", "surface"]),
        ("", "", "--attributes doppler", ["points", "points"]),
        ("", "", "--tolerance deg:0.1", ["surface", "points"]),
        (
            r#""effects": { "doppler": "ramp" },"#,
            "",
            "",
            ["points", "points"],
        ),
        (r#""measure": "surface","#, "", "", ["surface", "surface"]),
        (
            r#""measure": "points","#,
            r#", "measure": "surface""#,
            "",
            ["surface", "points"],
        ),
        (
            r#""measure": "surface","#,
            r#", "measure": "points""#,
            "--measure surface",
            ["surface", "surface"],
        ),
    ] {
        workplace.write("scene.json", two(BALL, scene, object));
        workplace
            .run(&format!(
                "export scene.json -o out.glb --report report.json {flags}"
            ))
            .success();
        let report = workplace.read_json("report.json");
        let objects = report["objects"].as_array().expect("objects");
        let certificates: Vec<&Value> = objects
            .iter()
            .map(|object| &object["certificate"])
            .collect();
        let measures: Vec<&Value> = certificates.iter().map(|c| &c["measure"]).collect();
        assert_eq!(measures, expected, "{scene} {object} {flags}");
        for certificate in certificates {
            let number = |key: &str| certificate[key].as_f64().expect("a number");
            let gap = match certificate["measure"] == "surface" {
                true => number("surface_gap"),
                false => number("gap"),
            };
            assert!(number("surface_gap") <= number("gap"), "{certificate}");
            assert!(certificate["complete"] == true, "{certificate}");
            if certificate["unit"] == "length" {
                let sum = gap + number("curvature") + number("rounding");
                assert!((number("total") / sum - 1.0).abs() < 1e-12, "{certificate}");
            }
            let ratio = number("triangles_out") / number("minimum_with_source");
            assert!(
                (number("ratio") / ratio - 1.0).abs() < 1e-12,
                "{certificate}"
            );
            assert!(ratio >= 1.0 && number("minimum_triangles") <= number("minimum_with_source"));
        }
        let flags = flags.replace("--attributes doppler", "");
        let run = workplace.run(&format!("check scene.json --json {flags}"));
        let check: Value = serde_json::from_slice(&run.success().stdout).expect("JSON");
        if !flags.is_empty() || expected != ["points", "points"] {
            assert_eq!(check["objects"][0]["measure"], expected[0], "{flags}");
        }
    }
}

/// Flat shapes and meshes of files are measured by points, and never as surfaces where the tolerance is an angle.
#[test]
fn the_default_is_that_of_what_is_shown() {
    let workplace = Workplace::new();
    workplace.write("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    workplace.write("plate.json", two(PLATE, "", ""));
    for (input, flags, expected) in [
        ("plate.json", "", "points"),
        ("plate.json", "--measure surface", "surface"),
        (
            "plate.json",
            "--measure surface --tolerance deg:0.1",
            "points",
        ),
        ("triangle.obj", "", "points"),
        ("triangle.obj", "--measure surface", "surface"),
    ] {
        let run = workplace.run(&format!("check {input} --json {flags}"));
        let check: Value = serde_json::from_slice(&run.success().stdout).expect("JSON");
        assert_eq!(check["objects"][0]["measure"], expected, "{input} {flags}");
    }
}

#[test]
fn a_surface_takes_fewer_triangles_where_the_motion_runs_along_it() {
    let workplace = Workplace::new();
    workplace.write("scene.json", two(PLATE, "", ""));
    let triangles = |measure: &str| {
        let line = format!(
            "cost scene.json --only meshes --measure {measure} --tolerances abs:1e-3 --repeats 1 --json cost.json"
        );
        workplace.run(&line).success();
        let made = workplace.read_json("cost.json")["meshes"][0]["made"].clone();
        let number = |key: &str| made[key].as_f64().expect("a number");
        assert!(
            number("error") <= number("bound") && number("gap") <= number("bound"),
            "{made}"
        );
        number("triangles")
    };
    assert!(triangles("surface") < 0.3 * triangles("points"));
    let wrong = ["points", "surface"];
    workplace
        .run("export scene.json --measure area -o x.glb")
        .error(&wrong);
    workplace.write("wrong.json", two(PLATE, r#""measure": "area","#, ""));
    workplace
        .run("check wrong.json")
        .error(&["wrong.json", "expected points or surface"]);
}

/// A round shape is an exact surface, whose triangles are inversely proportional to the tolerance, until these are too many.
#[test]
fn a_round_shape_of_millions_of_triangles_gets_facets() {
    let workplace = Workplace::new();
    let predicted = |tolerance: &str| {
        let run = workplace.run(&format!(
            "check --example sphere --measure surface --steps 0 --tolerance {tolerance} --max-triangles none --json"
        ));
        let check: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        check["levels"][0]["triangles"].as_f64().expect("a number")
    };
    let [one, two, facets] = ["5e-7", "2.5e-7", "1.25e-7"].map(predicted);
    // Rounding takes its part of the tolerance.
    assert!((2.0..2.3).contains(&(two / one)), "{one} {two}");
    assert!(two < 4e6 && facets > 5.0 * two, "{two} {facets}");
}
