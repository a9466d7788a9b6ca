//! `photosurface cost --integrators`: errors against numbers that others can recompute, orders against theory, and its ways
//! out say the same.

#![allow(
    clippy::excessive_precision,
    reason = "known answers are written with the digits that they were computed with"
)]

use std::num::NonZeroUsize;

use crate::common::command::Workplace;
use photosurface::Scene;
use photosurface::study::{IntegratorRun, IntegratorSettings, IntegratorStudy, Method};
use serde_json::{Value, json};

/// The paper's flight: from 0.95 c along -z to 0.983 c and 0.994 c.
fn paper() -> Value {
    let velocity = json!({ "beta": 0.95, "direction": [0, 0, -1] });
    scene(
        velocity,
        json!([
            { "proper_time": 2.1, "acceleration": [0, 0, -0.26085503293665] },
            { "proper_time": 1.6, "acceleration": [0, 0, -0.32718303025942] },
        ]),
    )
}

fn scene(velocity: Value, flight: Value) -> Value {
    json!({
        "observer": { "velocity": velocity, "flight": flight },
        "objects": [ { "name": "box", "shape": { "box": { "size": [1, 1, 1] } }, "position": [0, 0, -2] } ],
    })
}

fn at_rest() -> Value {
    json!({ "beta": 0 })
}

fn general_type() -> Value {
    let segment =
        json!({ "proper_time": 2, "acceleration": [0.5, 0.2, 0], "turn_rate": [0, 0.1, 0.7] });
    scene(at_rest(), json!([segment]))
}

/// A coordinated turn whose speed changes, from 0.6 c.
fn spiral() -> Value {
    let segment =
        json!({ "proper_time": 3, "acceleration": [0.2, 0.3, 0.1], "steer": "coordinated" });
    let velocity = json!({ "beta": 0.6, "direction": [1, 0, 0] });
    scene(velocity, json!([segment]))
}

fn study(scene: &Value, steps: &[usize]) -> IntegratorStudy {
    let scene = Scene::from_json(&scene.to_string()).expect("a scene");
    let settings = IntegratorSettings {
        steps: steps
            .iter()
            .map(|&steps| NonZeroUsize::new(steps).expect("steps"))
            .collect(),
        repeats: NonZeroUsize::MIN,
    };
    IntegratorStudy::new(&scene, &settings).expect("a study")
}

#[track_caller]
fn runs(study: &IntegratorStudy, method: Method) -> Vec<IntegratorRun> {
    let rows = study.rows.iter().filter(|cost| cost.method == method);
    rows.map(|cost| cost.run.expect("a flight")).collect()
}

/// Components that are all within a unit in the last place of their size.
#[track_caller]
fn assert_digits(found: [f64; 4], expected: [f64; 4]) {
    for (found, expected) in found.into_iter().zip(expected) {
        let limit = f64::EPSILON * expected.abs() + 1e-30;
        assert!((found - expected).abs() <= limit, "{found} {expected}");
    }
}

/// The displacement by the reference, against matrix exponentials of 30 digits, polynomials and circles.
#[test]
fn the_reference_has_all_digits_that_others_found() {
    let general = study(&general_type(), &[]);
    assert_digits(
        general.displacement,
        [
            2.3708551424454960493,
            0.75296508388867752485,
            0.82153341121334425566,
            -0.054846595972260722447,
        ],
    );
    assert_digits([general.gamma; 4], [1.5407892241870076136; 4]);
    let null = json!([{ "proper_time": 3, "acceleration": [1, 0, 0], "turn_rate": [0, 0, 1] }]);
    let null = study(&scene(at_rest(), null), &[]);
    assert_digits(null.displacement, [7.5, 4.5, 4.5, 0.0]);
    assert_digits([null.gamma; 4], [5.5; 4]);

    let along_x = json!({ "beta": 0.6, "direction": [1, 0, 0] });
    let turn = json!({ "proper_time": 2, "acceleration": [0, 0.3, 0], "turn_rate": [0, 0, 0.5] });
    let turn = study(&scene(along_x.clone(), json!([turn])), &[]);
    let circle = [2.5, 1.3450426704366051781, 0.56867491997406483577, 0.0];
    let thrust = json!({ "proper_time": 2, "acceleration": [0, 0.3, 0] });
    let straight = study(&scene(along_x.clone(), json!([thrust])), &[]);
    let drifted = [
        2.6527232589510052963,
        1.5916339553706031778,
        0.61821739414089234584,
        0.0,
    ];
    let steered = json!({ "proper_time": 2, "acceleration": [0, 0.3, 0], "steer": "coordinated" });
    let steered = study(&scene(along_x, json!([steered])), &[]);
    // The velocity is the number that is nearest to 0.6 c, and 0.3 and 0.5 are not quite that either.
    for (study, expected) in [(turn, circle), (straight, drifted), (steered, circle)] {
        for (found, expected) in study.displacement.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{study:#?}");
        }
    }
}

/// The rocket of 1.03 per year, written with 12 digits.
#[test]
fn the_reference_follows_a_rocket() {
    for (proper_time, time, distance, gamma) in [
        (1.0, 1.18643634667, 0.562171259839, 1.57903639763),
        (2.0, 3.74685234972, 2.89972028166, 3.98671189011),
        (5.0, 83.7017917049, 82.7365484085, 86.2186448608),
        (12.0, 113243.315484, 113242.344614, 116640.614953),
    ] {
        let rocket = json!([{ "proper_time": proper_time, "acceleration": [1.03, 0, 0] }]);
        let study = study(&scene(at_rest(), rocket), &[]);
        let [found_time, x, y, z] = study.displacement;
        for (found, expected) in [(found_time, time), (x, distance), (study.gamma, gamma)] {
            assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
        }
        assert_eq!((y, z), (0.0, 0.0));
        assert!(study.event_uncertainty < 1e-26 * time, "{study:#?}");
        assert!(runs(&study, Method::Exact)[0].relative_error < 1e-15);
    }
}

/// A lap of the circle of radius 1 at 0.6 c: it closes, axes too, within what rounding makes of the numbers in the file.
#[test]
fn a_lap_closes() {
    let lap = json!({ "proper_time": 8.3775804095727819692, "acceleration": [0, 0.5625, 0], "turn_rate": [0, 0, 0.9375] });
    let velocity = json!({ "beta": 0.6, "direction": [1, 0, 0] });
    let study = study(&scene(velocity, json!([lap])), &[]);
    let [time, x, y, z] = study.displacement;
    assert!((time - 10.471975511965977).abs() < 4e-15, "{time}");
    assert!(x.abs().max(y.abs()) < 4e-15 && z == 0.0, "{study:#?}");
    assert!((study.gamma - 1.25).abs() < 4e-16);
    let exact = runs(&study, Method::Exact)[0];
    assert!(
        exact.event_error < 1e-14 && exact.axes_error < 2e-15,
        "{exact:?}"
    );
}

/// The errors of Euler's method and of Runge and Kutta's on the general type, which another program found.
#[test]
fn errors_are_those_that_another_program_found() {
    let study = study(&general_type(), &[5, 10, 20, 40, 200, 2000]);
    let errors = |method| {
        let positions = runs(&study, method)
            .into_iter()
            .map(|run| run.position_error);
        positions.collect::<Vec<f64>>()
    };
    let (euler, rk4) = (errors(Method::Euler), errors(Method::Rk4));
    // Numbers of three and of two digits.
    for (found, expected, limit) in [
        (euler[2], 7.36e-2, 1e-2),
        (euler[4], 7.37e-3, 1e-2),
        (euler[5], 7.37e-4, 1e-2),
        (rk4[0], 2.9e-5, 2e-2),
        (rk4[1], 1.76e-6, 1e-2),
        (rk4[2], 1.08e-7, 1e-2),
        (rk4[3], 6.7e-9, 1e-2),
    ] {
        assert!((found / expected - 1.0).abs() < limit, "{found} {expected}");
    }
}

/// The steps divide all segments, as theory asks; in a turn whose speed changes, too.
#[test]
fn errors_fall_with_orders_1_and_4() {
    let paper = study(&paper(), &[37, 74, 148, 296, 592]);
    let others = [general_type(), spiral()].map(|scene| study(&scene, &[40, 80, 160, 320, 640]));
    for study in [paper].into_iter().chain(others) {
        for (method, order, limit) in [(Method::Euler, 1.0, 0.1), (Method::Rk4, 4.0, 0.2)] {
            let runs = runs(&study, method);
            let orders: Vec<f64> = runs.iter().filter_map(|run| run.order).collect();
            assert!(orders.len() >= 2 && runs[0].order.is_none(), "{study:#?}");
            for found in &orders {
                assert!((found - order).abs() < limit, "{study:#?}");
            }
            // Axes too, for as long as they are above rounding.
            let axes = runs.windows(2).filter(|pair| pair[1].axes_error > 1e-12);
            for pair in axes {
                let found = (pair[0].axes_error / pair[1].axes_error).log2();
                assert!((found - order).abs() < limit, "{found} {study:#?}");
            }
        }
    }
}

/// The numbers of the README, of which all but the times are the same on every computer.
#[test]
fn the_table_of_the_readme_holds() {
    let study = study(&paper(), &[10, 100, 1000, 3000, 10_000]);
    let [exact, rk4, euler] = [Method::Exact, Method::Rk4, Method::Euler].map(|m| runs(&study, m));
    assert!(exact[0].relative_error < 4e-16 && exact[0].axes_error < 4e-16);
    assert!(rk4[2].relative_error < 1e-13 && rk4[2].axes_error < 1e-13);
    for (run, event, axes) in [
        (&rk4[0], 1.62e-6, 1.14e-6),
        (&rk4[1], 1.90e-10, 1.31e-10),
        (&euler[1], 8.50e-3, 4.52e-3),
        (&euler[2], 8.60e-4, 4.58e-4),
        (&euler[3], 2.87e-4, 1.53e-4),
        (&euler[4], 8.61e-5, 4.59e-5),
    ] {
        for (found, expected) in [(run.relative_error, event), (run.axes_error, axes)] {
            assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
        }
    }
}

/// Closed forms at rounding where Euler's method with 3,000 steps has four or five digits.
#[test]
fn closed_forms_are_right_to_rounding() {
    let fast = json!({ "beta": 0.999, "direction": [1, 2, -2] });
    let turns = json!([
        { "proper_time": 20, "acceleration": [0.1, 0.2, -0.2], "turn_rate": [0.3, -1.5, 2] },
        { "proper_time": 1.5, "acceleration": [-0.7, 0.3, 0.4], "steer": "coordinated" },
        { "proper_time": 0.75 },
    ]);
    let spiral_and_back = json!([
        { "proper_time": 2, "acceleration": [0, 0, -1.5] },
        { "proper_time": 4, "acceleration": [0.8, 0, 0.3], "steer": "coordinated" },
    ]);
    for scene in [
        paper(),
        general_type(),
        spiral(),
        scene(fast, turns),
        scene(at_rest(), spiral_and_back),
    ] {
        let study = study(&scene, &[3000]);
        let exact = runs(&study, Method::Exact)[0];
        assert!(
            exact.relative_error < 1e-14 && exact.axes_error < 1e-14,
            "{study:#?}"
        );
        let euler = runs(&study, Method::Euler)[0];
        assert!(
            euler.relative_error > 1e-5 && euler.axes_error > 1e-5,
            "{study:#?}"
        );
        let size = study.displacement[0];
        assert!(study.event_uncertainty < 1e-26 * size, "{study:#?}");
        assert!(study.axes_uncertainty < 1e-26, "{study:#?}");
    }
}

#[test]
fn table_csv_and_json_say_the_same() {
    let workplace = Workplace::new();
    let mut scene = paper();
    scene["title"] = json!("The paper's flight");
    workplace.write("paper.json", scene.to_string());
    let run = workplace
        .run("cost paper.json --integrators --repeats 2 --json a.json --csv a.csv --plot a.svg");
    let run = run.success();
    assert_eq!(run.stderr, "", "{run}");
    assert_eq!(
        workplace.files(),
        ["a.csv", "a.json", "a.svg", "paper.json"]
    );
    let study = workplace.read_json("a.json");
    assert_eq!(study["title"], "The paper's flight");
    assert_eq!(
        (&study["repeats"], &study["segments"]),
        (&json!(2), &json!(2))
    );
    let rows = study["rows"].as_array().expect("rows");
    let csv = String::from_utf8(workplace.read("a.csv")).expect("text");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let shown: Vec<&str> = run.stdout_text().lines().collect();
    assert_eq!(
        (rows.len(), lines.len(), shown.len()),
        (15, 16, 17),
        "{run}"
    );
    let least = |name: &str| study[name].as_f64().expect("a number");
    for ((row, line), shown) in rows.iter().zip(&lines[1..]).zip(&shown[1..]) {
        for (name, cell) in lines[0].iter().zip(line) {
            let value = match &row["run"][name] {
                Value::Null => &row[name],
                value => value,
            };
            match value {
                Value::String(text) => assert_eq!(cell, text),
                Value::Null => assert_eq!(*cell, ""),
                number => assert_eq!(cell.parse().ok(), number.as_f64(), "{name}"),
            }
        }
        let words: Vec<&str> = shown.split_whitespace().collect();
        let event_error = row["run"]["event_error"].as_f64().expect("an error");
        let expected = match event_error > least("event_uncertainty") {
            true => format!("{event_error:.2e}"),
            false => format!("<{:.0e}", least("event_uncertainty")),
        };
        assert_eq!(words[4], expected, "{run}");
    }
    let svg = String::from_utf8(workplace.read("a.svg")).expect("text");
    for text in [
        "The paper's flight",
        "Euler: event",
        "RK4: event",
        "exact: event",
        "orders 1 and 4",
    ] {
        assert!(
            svg.contains(text) || svg.contains(&text.replace('\'', "&apos;")),
            "{text}: {svg}"
        );
    }
}

#[test]
fn the_study_goes_to_stdout_and_into_pictures() {
    let workplace = Workplace::new();
    workplace.write("paper.json", paper().to_string());
    let flags = "cost paper.json --integrators --repeats 1";
    let csv = workplace.run(&format!("{flags} --csv - --plot a.png --plot-size 640x480"));
    let csv = csv.success();
    assert!(
        csv.stdout_text().starts_with("method,steps,step,seconds,"),
        "{csv}"
    );
    assert!(csv.stdout_text().contains("\nexact,,,"), "{csv}");
    let png = image::load_from_memory(&workplace.read("a.png")).expect("a picture");
    assert_eq!((png.width(), png.height()), (640, 480));
    let json = workplace.run(&format!("{flags} --json -")).success();
    let json: Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!(json["rows"][0]["method"], "exact");
}

#[test]
fn what_is_not_of_flights_is_refused() {
    let workplace = Workplace::with_ball();
    workplace.write("paper.json", paper().to_string());
    let spin = json!([{ "proper_time": 1e6, "turn_rate": [0, 1, 0] }]);
    workplace.write("spin.json", scene(at_rest(), spin).to_string());
    for (flags, expected) in [
        ("ball.json", "has no flight"),
        (
            "ball.json",
            "built-in scenes flight, takeoff, turn and orbit",
        ),
        ("spin.json", "too long for the reference"),
        (
            "paper.json --only rays",
            "--only is for meshes and pictures, which --integrators leaves out",
        ),
        (
            "paper.json --tolerances 1e-2",
            "--tolerances is for meshes and pictures",
        ),
        (
            "paper.json --pixel-samples 2",
            "--pixel-samples is for meshes and pictures",
        ),
        (
            "paper.json --integrator exact",
            "--integrator changes nothing for --integrators",
        ),
        ("paper.json --steps 1", "--steps changes nothing"),
        ("paper.json --json - --csv -", "cannot both go to stdout"),
        ("paper.json --plot a.gif", "unknown extension"),
    ] {
        let run = workplace.run(&format!("cost {flags} --integrators"));
        assert_eq!(run.status, 2, "{run}");
        assert!(run.stderr.contains(expected), "{expected}: {run}");
    }
}
