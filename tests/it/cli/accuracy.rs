//! Accuracy on the command line: tolerances, budgets, what is predicted and what is certified.

use crate::common::command::{Workplace, glb_json};
use serde_json::Value;

/// A floor at the observer's feet, which no angle can be kept on, and a ball and a box ahead.
const TOUCHED: &str = r#"{ "observer": { "velocity": { "beta": 0.9 } },
  "objects": [
    { "name": "floor", "shape": { "grid": { "size": 10, "cells": 4 } } },
    { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 2, -6] },
    { "name": "box", "shape": { "box": { "size": [1, 1, 1] } }, "position": [3, 1, -6] } ],
  "tolerance": { "angle_deg": 0.01 } }"#;

/// Each object's last column in the table of `check`, and its last line.
fn predicted(table: &str) -> (Vec<(String, bool)>, String) {
    let lines: Vec<_> = table.lines().collect();
    let objects = lines[1..lines.len() - 1].iter().map(|line| {
        let words: Vec<_> = line.split_whitespace().collect();
        (words[0].to_owned(), words[words.len() - 1] == "yes")
    });
    (objects.collect(), lines[lines.len() - 1].to_owned())
}

fn triangles(report: &Value) -> u64 {
    let objects = report["objects"].as_array().expect("objects");
    objects
        .iter()
        .filter_map(|object| object["triangles"].as_u64())
        .sum()
}

/// The numbers of the passing sphere were found by a program of its own, which integrates the square root of the
/// Gaussian curvature (Pottmann et al. 2000).
#[test]
fn the_least_triangles_of_a_sphere_are_those_of_theory() {
    let workplace = Workplace::new();
    let run =
        workplace.run("export --example sphere --measure surface -o out.glb --report report.json");
    assert_eq!(run.status, 0, "{run}");
    let report = workplace.read_json("report.json");
    let objects = report["objects"].as_array().expect("objects");
    let expected = [556.0, 619.0, 725.0, 748.0, 726.0, 705.0, 697.0];
    assert_eq!(objects.len(), expected.len());
    for (object, expected) in objects.iter().zip(expected) {
        let least = object["certificate"]["minimum_triangles"].as_f64();
        let off = least.expect("a number") / expected - 1.0;
        assert!(off.abs() < 5e-3, "{object:#}: {expected}");
    }
}

#[test]
fn accuracy_is_asked_for_in_three_units_and_certified() {
    let workplace = Workplace::new();
    let certificate = |flags: &str, status: i32| {
        let run = workplace.run(&format!(
            "export --example cube --steps 1 -o out.glb --report report.json {flags}"
        ));
        assert_eq!(run.status, status, "{run}");
        let certificate = workplace.read_json("report.json")["objects"][0]["certificate"].clone();
        assert_eq!(certificate["complete"], status == 0, "{run}\n{certificate}");
        let json = glb_json(&workplace.read("out.glb"));
        assert_eq!(json["nodes"][1]["extras"]["certificate"], certificate);
        certificate
    };
    let default = certificate("", 0);
    assert_eq!(default, certificate("--tolerance 1e-3", 0));
    assert!(
        certificate("--tolerance 1e-4", 0)["tolerance"].as_f64() < default["tolerance"].as_f64()
    );
    assert_eq!(certificate("--tolerance abs:0.02", 0)["tolerance"], 0.02);
    let angle = certificate("--tolerance deg:0.5", 0);
    assert_eq!(
        (&angle["unit"], &angle["tolerance"]),
        (&"degrees".into(), &0.5.into())
    );
    let untouched = certificate("--no-subdivide --tolerance 1e-6", 1);
    assert_eq!(untouched["triangles_in"], untouched["triangles_out"]);
    let budget = certificate("--tolerance 1e-6 --max-triangles 1000", 1);
    assert!(budget["triangles_out"].as_u64() <= Some(1000), "{budget}");
    for (wrong, words) in [
        ("0", "expected a finite number > 0"),
        ("-1", "expected a finite number > 0"),
        ("deg:100", "90 degrees"),
        ("mm:1", "abs:0.01"),
    ] {
        workplace
            .run(&format!("export --tolerance {wrong} -o x.glb"))
            .error(&["--tolerance", words]);
    }
    let scene = |tolerance: &str| {
        format!(
            r#"{{ "objects": [ {{ "name": "ball", "shape": {{ "sphere": {{ "radius": 1 }} }} }} ],
                 "tolerance": {tolerance} }}"#
        )
    };
    for (tolerance, words) in [
        (
            r#"{ "relative": -0.1 }"#,
            "is -0.1, expected a finite number > 0",
        ),
        (
            r#"{ "angle_deg": 0 }"#,
            "is 0 degrees, expected an angle > 0",
        ),
        (
            r#"{ "relative": 1, "absolute": 1 }"#,
            "both `relative` and `absolute`",
        ),
    ] {
        workplace.write("wrong.json", scene(tolerance));
        workplace
            .run("check wrong.json")
            .error(&["wrong.json", "line 2", "tolerance", words]);
    }
}

/// What `check` says beforehand is what `export` makes, to within a half, on every built-in scene.
#[test]
fn triangles_are_predicted() {
    let workplace = Workplace::new();
    for scene in ["sphere", "cube", "lattice", "street", "snapshot"] {
        for tolerance in ["1e-2", "1e-3", "1e-4"] {
            let flags = format!("--example {scene} --tolerance {tolerance}");
            let check = workplace.run(&format!("check {flags}")).success();
            let last = check
                .prediction()
                .lines()
                .last()
                .unwrap_or_default()
                .to_owned();
            let digits = last.rsplit("about ").next().unwrap_or_default();
            let digits: String = digits.chars().filter(char::is_ascii_digit).collect();
            let predicted: f64 = digits.parse().expect("a count");
            workplace
                .run(&format!("export {flags} -o out.glb --report report.json"))
                .success();
            let report = workplace.read_json("report.json");
            let objects = report["objects"].as_array().unwrap();
            let made: f64 = objects
                .iter()
                .filter_map(|object| object["triangles"].as_f64())
                .sum();
            let ratio = predicted / made;
            assert!(
                (0.67..1.5).contains(&ratio),
                "{flags}: {predicted} predicted, {made} made"
            );
        }
    }
}

/// However fine a tolerance is, what it takes is known at once, and a budget keeps round shapes small too.
#[test]
fn no_tolerance_is_too_fine_to_predict() {
    let workplace = Workplace::new();
    for tolerance in ["1e-9", "abs:1e-9", "abs:1e-300", "deg:1e-9"] {
        for example in ["sphere", "lattice"] {
            let run = workplace.run(&format!(
                "check --example {example} --tolerance {tolerance}"
            ));
            assert_eq!(run.status, 1, "{run}");
            assert!(
                run.stderr.contains("more than --max-triangles 20,000,000"),
                "{run}"
            );
            assert!(run.stderr.contains(" fits"), "{run}");
            assert!(!predicted(run.prediction()).0[0].1, "{run}");
        }
        let run = workplace.run(&format!(
            "export --tolerance {tolerance} --max-triangles 30000 -o out.glb --report report.json"
        ));
        assert_eq!(run.status, 1, "{run}");
        let made = triangles(&workplace.read_json("report.json"));
        assert!((10_000..=30_000).contains(&made), "{made}\n{run}");
    }
}

/// What is there before any subdivision is never taken away; that it is more than the budget is said, and what is
/// proven is what the exit status tells.
#[test]
fn a_budget_below_the_source_is_not_kept_and_that_is_said() {
    let workplace = Workplace::new();
    workplace.write(
        "square.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n",
    );
    let run = workplace.run("export square.obj --max-triangles 1 -o out.glb --report report.json");
    assert_eq!(run.status, 0, "{run}");
    assert!(
        run.stderr
            .contains("2 triangles are more than --max-triangles 1"),
        "{run}"
    );
    assert_eq!(triangles(&workplace.read_json("report.json")), 2);
    let run = workplace.run("export square.obj --max-triangles 2 -o out.glb");
    assert_eq!(run.status, 0, "{run}");
}

/// An object whose tolerance no number of triangles keeps does not use up what the others need.
#[test]
fn a_hopeless_object_is_predicted_and_leaves_the_budget_to_the_others() {
    let workplace = Workplace::new();
    workplace.write("touched.json", TOUCHED);
    for flags in ["", "--max-triangles 30000"] {
        let check = workplace.run(&format!("check touched.json {flags}"));
        assert_eq!(check.status, 1, "{check}");
        let (objects, _) = predicted(check.prediction());
        let expected = [("floor", false), ("ball", true), ("box", true)];
        assert_eq!(
            objects,
            expected.map(|(name, kept)| (name.to_owned(), kept))
        );
        let run = workplace.run(&format!(
            "export touched.json {flags} -o out.glb --report report.json"
        ));
        assert_eq!(run.status, 1, "{run}");
        let report = workplace.read_json("report.json");
        for (object, (name, kept)) in report["objects"].as_array().unwrap().iter().zip(objects) {
            assert_eq!(object["name"], name.as_str());
            assert_eq!(object["certificate"]["complete"], kept, "{object}");
            assert!(
                object["certificate"]["total"].as_f64() <= Some(180.0),
                "{object}"
            );
        }
    }
    // As they are, only what is small enough already is within the tolerance.
    let run = workplace.run("check touched.json --no-subdivide");
    let kept: Vec<_> = predicted(run.prediction())
        .0
        .into_iter()
        .map(|(_, kept)| kept)
        .collect();
    workplace.run("export touched.json --no-subdivide -o out.glb --report report.json");
    let report = workplace.read_json("report.json");
    let objects = report["objects"].as_array().unwrap().iter();
    let complete: Vec<_> = objects
        .map(|object| object["certificate"]["complete"] == true)
        .collect();
    assert_eq!(kept, complete);
    assert!(complete.contains(&true) && complete.contains(&false));
}

#[test]
fn each_level_of_detail_is_a_file_and_a_report() {
    let workplace = Workplace::new();
    let run = workplace
        .run("export --lod 1e-1,1e-2 -o out.glb --report report.json")
        .success();
    let files = [
        "out_lod0.glb",
        "out_lod1.glb",
        "report_lod0.json",
        "report_lod1.json",
    ];
    assert_eq!(workplace.files(), files, "{run}");
    let [coarse, fine] = ["report_lod0.json", "report_lod1.json"]
        .map(|report| triangles(&workplace.read_json(report)));
    assert!(coarse < fine, "{coarse} {fine}");
    workplace
        .run("export --lod 1e-2,abs:1,1e-2 -o twice.glb")
        .error(&["--lod", "1.000e-2 twice"]);
}

/// A speed that makes numbers beyond `f32` is refused with the object, the step and the number, by `export` and
/// `check` alike, before anything is refined.
#[test]
fn numbers_beyond_the_file_are_refused_at_once() {
    let workplace = Workplace::new();
    let words = [
        "\"sphere_step000\"",
        "vertex 0",
        "beyond what 32-bit",
        "smaller rapidity",
    ];
    workplace
        .run("export --rapidity 350 --tolerance 1e-6 -o out.glb")
        .error(&words);
    assert!(workplace.files().is_empty());
    workplace.run("check --rapidity 350").error(&words);
    // What 64 bits can hold is no matter of range there; the tolerance is another.
    let run = workplace.run("export --rapidity 350 --max-triangles 10000 -o out.ply");
    assert_eq!(run.status, 1, "{run}");
    assert!(run.stderr.contains("not within their tolerance"), "{run}");
}

/// A budget near to what the coarsest mesh has was looked for through 1700 predictions; and its advice was a
/// tolerance of 1e297.
#[test]
fn a_budget_that_hardly_suffices_is_found_at_once() {
    let workplace = Workplace::new();
    for flags in [
        "--example sphere --max-triangles 2000",
        "--example cube --max-triangles 73",
    ] {
        let run = workplace.run(&format!("export {flags} -o out.glb --report report.json"));
        assert_eq!(run.status, 1, "{run}");
        let (_, advice) = run.stderr.split_once("--tolerance ").expect("advice");
        let tolerance: f64 = advice.split(' ').next().unwrap().parse().expect("a number");
        assert!(tolerance < 1.0, "{run}");
        let budget: u64 = flags.rsplit(' ').next().unwrap().parse().unwrap();
        let made = triangles(&workplace.read_json("report.json"));
        assert!(made <= budget && 2 * made > budget, "{made} {run}");
    }
}

/// Angles that can be kept, and those that cannot because the observer touches something, are told apart.
#[test]
fn whether_an_angle_can_be_kept_is_predicted() {
    let workplace = Workplace::new();
    let scene = |shape: &str, more: &str| {
        format!(
            r#"{{ "observer": {{ "velocity": {{ "beta": 0.9 }} }},
                 "objects": [ {{ "name": "thing", "shape": {shape}{more} }} ], "tolerance": {{ "angle_deg": 1 }} }}"#
        )
    };
    let sphere = r#"{ "sphere": { "radius": 1 } }"#;
    let cube = r#"{ "box": { "size": [2, 2, 2] } }"#;
    for (shape, more, kept) in [
        (sphere, r#", "position": [0, 2, -3]"#, true),
        (sphere, "", true),
        (sphere, r#", "position": [0, 0, -1]"#, false),
        (
            sphere,
            r#", "position": [0, 2, -3], "scale": [100, 1, 1]"#,
            true,
        ),
        (cube, "", true),
        (cube, r#", "position": [0.3, 1, -0.2]"#, false),
        (cube, r#", "position": [1, 1, -0.2]"#, false),
        (r#"{ "rod": { "length": 4, "radius": 0.05 } }"#, "", true),
    ] {
        workplace.write("scene.json", scene(shape, more));
        let check = workplace.run("check scene.json");
        let (objects, _) = predicted(check.prediction());
        let run = workplace.run("export scene.json -o out.glb");
        let status = i32::from(!kept);
        assert_eq!(
            (objects[0].1, check.status, run.status),
            (kept, status, status),
            "{shape}{more}\n{run}"
        );
        // Not even where the observer touches it is a flat shape curved.
        let is_flat = shape == cube;
        let says_curved = !kept && !run.stderr.contains("curvature 0.000e0");
        assert!(!(is_flat && says_curved), "{shape}{more}\n{run}");
    }
}

/// Triangles that had nothing to do with a budget: points inside a triangle with the observer in its plane, a hundred
/// times as many; charts that were tried in vain; edges beyond what was predicted; mesh after mesh of a morph.
#[test]
fn a_budget_holds_exactly_but_for_the_source() {
    let workplace = Workplace::new();
    let plate = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n";
    workplace.write("plate.obj", format!("{plate}f 1 2 3 4\n"));
    workplace.write("flag.obj", format!("{plate}o a\nf 1 2 3\no b\nf 1 3 4\n"));
    let inside = "--direction 1,0,0 --observer 0.13,0,-0.21";
    let steep = "--rapidity 35.69 --steps=-51450,0,3939621,-24847 --tolerance 1.0004e-8";
    let thin = "--rapidity 20 --steps=-1,0,2 --direction 1,2,3 --tolerance deg:1";
    for (flags, source) in [
        (
            format!("plate.obj --beta 0.9 {inside} --tolerance deg:0.01"),
            2,
        ),
        (
            format!("flag.obj --rapidity 14.4 {inside} --tolerance deg:0.005"),
            2,
        ),
        (
            format!("flag.obj --beta 0.9 {inside} --tolerance 5e-324"),
            2,
        ),
        (format!("plate.obj {steep}"), 8),
        (format!("plate.obj {steep} --animate"), 8),
        (format!("plate.obj {thin} --animate=morph"), 2),
        (
            "--example cube --gamma 1000 --tolerance deg:0.01 --animate=morph".to_owned(),
            12,
        ),
        ("--example cube --tolerance 5e-324".to_owned(), 72),
        ("--example sphere --tolerance 5e-324".to_owned(), 56),
        ("--example sphere --tolerance deg:0.01".to_owned(), 56),
    ] {
        for budget in [0, 100, 2000] {
            let run = workplace.run(&format!(
                "export {flags} --max-triangles {budget} -o out.glb --report report.json"
            ));
            assert!(run.status == 0 || run.status == 1, "{run}");
            let report = workplace.read_json("report.json");
            let objects = report["objects"].as_array().expect("objects");
            let first = objects
                .iter()
                .filter(|object| object["step"] == 0 || !flags.contains("morph"));
            let count =
                |object: &serde_json::Value| object["certificate"]["triangles_out"].as_u64();
            let made: u64 = first.map(|object| count(object).expect("a count")).sum();
            assert!(
                made <= budget.max(source),
                "{made} of {budget}: {flags}\n{run}"
            );
        }
    }
}

/// A round shape keeps to its tolerance where its triangles are within the budget, whatever was predicted, and otherwise to the
/// budget: its coarsest form has few triangles. Most of the budget is used.
#[test]
fn round_shapes_use_a_budget_and_keep_it() {
    let workplace = Workplace::new();
    let scene = |speed: &str, objects: &str| {
        format!(
            r#"{{ "observer": {{ "velocity": {{ {speed}, "direction": [-1, 0, 0] }} }}, "objects": [ {objects} ] }}"#
        )
    };
    let rods: Vec<String> = (0..20)
        .map(|k| format!(r#"{{ "name": "r{k}", "shape": {{ "rod": {{ "length": 4, "radius": 0.1 }} }}, "position": [{k}, 20, 0] }}"#))
        .collect();
    let one =
        |shape: &str| format!(r#"{{ "name": "o", "shape": {shape}, "position": [0, 3, 0] }}"#);
    let ball = one(r#"{ "sphere": { "radius": 1 } }"#);
    let rod = one(r#"{ "rod": { "length": 4, "radius": 0.1 } }"#);
    for (speed, objects, flags, coarsest) in [
        (r#""beta": 0.9"#, &ball, "--tolerance 1e-2", 8),
        (
            r#""beta": 0.9"#,
            &ball,
            "--tolerance 1e-2 --measure points",
            8,
        ),
        (r#""beta": 0.999"#, &rod, "--measure points", 28),
        (r#""beta": 0.9"#, &rods.join(","), "--tolerance 1e-3", 560),
    ] {
        workplace.write("scene.json", scene(speed, objects));
        let made = |budget: u64| {
            let run = workplace.run(&format!(
                "export scene.json {flags} --max-triangles {budget} -o out.glb --report report.json"
            ));
            let made = triangles(&workplace.read_json("report.json"));
            assert!(made <= budget.max(coarsest), "{made} of {budget}\n{run}");
            (made, run.status)
        };
        let (needed, status) = made(1_000_000);
        assert_eq!(status, 0, "{flags}");
        if coarsest < 100 {
            assert_eq!(made(needed), (needed, 0), "{flags}");
        }
        assert_eq!(made(coarsest).1, 1, "{flags}");
        let (few, _) = made((needed + coarsest) / 2);
        assert!(3 * few > needed + coarsest, "{flags}: {few} of {needed}");
    }
}

/// With an angle as tolerance and the observer in a facet's plane, what was predicted was too little a thousandfold.
#[test]
fn what_an_observer_in_a_plane_asks_for_is_predicted() {
    let workplace = Workplace::new();
    workplace.write(
        "plate.obj",
        "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3 4\n",
    );
    for observer in ["0.13,0,-0.21", "1.3,0,0.4", "0.13,1e-6,-0.21"] {
        for tolerance in ["deg:3", "deg:1", "deg:0.3", "deg:0.1"] {
            let flags = format!(
                "plate.obj --beta 0.9 --direction 1,0,0 --observer {observer} --tolerance {tolerance}"
            );
            let check = workplace.run(&format!("check {flags}"));
            let (_, predicted) = check.prediction().rsplit_once("about ").expect("a count");
            let digits: String = predicted.chars().filter(char::is_ascii_digit).collect();
            let predicted: f64 = digits.parse().expect("a count");
            workplace.run(&format!("export {flags} -o out.glb --report report.json"));
            let made = triangles(&workplace.read_json("report.json")) as f64;
            let ratio = predicted / made;
            assert!(
                (0.5..1.5).contains(&ratio),
                "{flags}: {predicted} predicted, {made} made"
            );
        }
    }
}

/// The search for a looser tolerance has an end, and that end was given out as a tolerance that fits.
#[test]
fn a_tolerance_that_was_not_found_is_not_advised() {
    let workplace = Workplace::new();
    for tolerance in ["5e-324", "deg:4e-308"] {
        let line =
            format!("check --example cube --tolerance {tolerance} --max-triangles 2000 --beta 0.9");
        let run = workplace.run(&line);
        assert_eq!(run.status, 1, "{run}");
        assert!(
            run.stderr.contains("no looser tolerance near it fits"),
            "{run}"
        );
    }
}

/// A budget that holds the predicted triangles loosens no aim, and no message says that a budget is less than a number
/// below it. The cube takes fewer than predicted.
#[test]
fn a_budget_of_the_predicted_triangles_loosens_nothing() {
    let workplace = Workplace::new();
    for (example, tolerance) in [("cube", "1e-2"), ("sphere", "1e-3"), ("street", "1e-3")] {
        let flags = format!("--example {example} --tolerance {tolerance}");
        let check = workplace.run(&format!("check {flags}")).success();
        let text = check.prediction().replace(',', "");
        let words: Vec<&str> = text.split_whitespace().collect();
        let about = words.iter().rposition(|word| *word == "about").unwrap();
        let budget = words[about + 1].parse::<u64>().unwrap() + 1;
        let run = workplace.run(&format!(
            "export {flags} --max-triangles {budget} -o out.glb"
        ));
        assert!(!run.stderr.contains("the tolerance needs"), "{run}");
        if example == "cube" {
            let budget = budget + budget / 10;
            let flags = format!("{flags} --max-triangles {budget} -o out.glb");
            workplace.run(&format!("export {flags}")).success();
        }
    }
}
