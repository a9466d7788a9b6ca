//! The flags of the binary: each reaches its parameter; what cannot be is refused in words that help.

use crate::common::command::{BALL, Workplace, node_names};
use serde_json::{Value, json};

#[test]
fn every_flag_reaches_its_parameter() {
    let workplace = Workplace::with_ball();
    let cases: &[(&str, &str, &[f64])] = &[
        ("", "observer_rapidity", &[std::f64::consts::LN_2]),
        ("--beta 0.8", "observer_beta", &[0.8]),
        (
            "--one-minus-beta 1e-30",
            "observer_rapidity",
            &[34.885_349_985_190_66],
        ),
        ("--gamma 5", "observer_gamma", &[5.0]),
        ("--rapidity 40", "observer_rapidity", &[40.0]),
        ("--beta 0", "observer_gamma", &[1.0]),
        (
            "--direction=-3,0,4",
            "observer_direction",
            &[-0.6, 0.0, 0.8],
        ),
        (
            "--direction 0,0,-2",
            "observer_rapidity",
            &[std::f64::consts::LN_2],
        ),
        (
            "--observer 1,-2,3.5",
            "observer_position",
            &[1.0, -2.0, 3.5],
        ),
        ("--observer -1,2,3", "observer_position", &[-1.0, 2.0, 3.0]),
        (
            "--velocity 0,-0.6,0",
            "observer_direction",
            &[0.0, -1.0, 0.0],
        ),
        ("--velocity -0.6,0,0", "observer_beta", &[0.6]),
        (
            "--orientation 0,0.6,0,0.8",
            "observer_orientation",
            &[0.0, 0.6, 0.0, 0.8],
        ),
        ("--time -4", "observer_time", &[-4.0]),
        ("--steps 1,2.5", "steps", &[1.0, 2.5]),
        ("--steps -1", "steps", &[-1.0]),
        ("--steps=-6..6/3", "steps", &[-6.0, 0.0, 6.0]),
    ];
    for (flags, key, expected) in cases {
        let run = workplace
            .run(&format!(
                "export ball.json -o out.glb --report report.json {flags}"
            ))
            .success();
        let scene = &workplace.read_json("report.json")["scene"];
        let found: Vec<f64> = match &scene[key] {
            Value::Array(numbers) => numbers.iter().filter_map(Value::as_f64).collect(),
            number => number.as_f64().into_iter().collect(),
        };
        assert_eq!(found.len(), expected.len(), "{key}: {found:?}\n{run}");
        for (found, expected) in found.iter().zip(*expected) {
            assert!(
                (found - expected).abs() <= 4e-15 * expected.abs(),
                "{key}: {found} {expected}\n{run}"
            );
        }
    }
    workplace
        .run("export ball.json -o out.glb --marker 0.25")
        .success();
    assert_eq!(node_names(&workplace.read("out.glb")), ["observer", "ball"]);
    workplace
        .run("export --marker 0 --steps 0 -o out.glb")
        .success();
    assert_eq!(node_names(&workplace.read("out.glb")), ["sphere"]);
}

/// A flight of a file, as a list and as an object, in g of its own units or of the scene's.
#[test]
fn flights_come_from_files() {
    let workplace = Workplace::with_ball();
    let second = r#""units": { "length_m": 299792458 }"#;
    let in_g = r#"[{ "proper_time": 2, "acceleration_g": [0, 0, -3] }]"#;
    let gravity = 9.80665 / 299_792_458.0;
    workplace.write(
        "list.json",
        r#"[{ "proper_time": 2, "acceleration": [0, 0, -0.5] }]"#,
    );
    workplace.write("g.json", in_g);
    workplace.write(
        "object.json",
        format!(r#"{{ "flight": {in_g}, "integrator": {{ "rk4": 0.125 }}, {second} }}"#),
    );
    for (flags, acceleration, integrator) in [
        ("--flight list.json", -0.5, Value::Null),
        (
            "--flight object.json",
            -3.0 * gravity,
            json!({ "rk4": 0.125 }),
        ),
        (
            "--flight list.json --integrator euler:0.25",
            -0.5,
            json!({ "euler": 0.25 }),
        ),
        (
            "--flight object.json --integrator exact",
            -3.0 * gravity,
            Value::Null,
        ),
    ] {
        let run = workplace.run(&format!(
            "export ball.json -o out.glb --report report.json --steps 1,4 {flags}"
        ));
        let run = run.success();
        let report = workplace.read_json("report.json");
        let segment = &report["scene"]["observer_flight"][0];
        let found = segment["acceleration"][2].as_f64().expect("a number");
        assert!((found / acceleration - 1.0).abs() < 1e-15, "{run}");
        assert_eq!(segment["steer"], "free");
        assert_eq!(report["scene"]["observer_integrator"], integrator, "{run}");
        // Where the observer is at each step.
        for object in report["objects"].as_array().expect("a list") {
            assert_eq!(object["observer"]["proper_time"], object["proper_time"]);
        }
    }
    workplace
        .run("export ball.json --flight g.json -o out.glb")
        .error(&["g.json", "line 1", "flight[0]", "acceleration_g", "units"]);
    workplace.write(
        "years.json",
        BALL.replacen('{', r#"{ "units": { "length_m": 9.4607304725808e15 }, "#, 1),
    );
    workplace
        .run("export years.json --flight object.json -o out.glb")
        .error(&[
            "object.json",
            "length_m is 299792458",
            "expected that of the scene",
        ]);
    workplace
        .run("export years.json --flight g.json -o out.glb --report report.json")
        .success();
    let report = workplace.read_json("report.json");
    assert_eq!(report["scene"]["unit_length_m"], 9.4607304725808e15);
    workplace.write("out.json", in_g);
    workplace
        .run("export ball.json --flight list.json --report list.json -o out.glb")
        .error(&["list.json"]);
    for (text, words) in [
        ("[{]", "line 1, column 3"),
        (
            "[{ \"proper_time\": 0 }]",
            "the proper time is 0, expected a finite duration > 0",
        ),
        ("{ \"flights\": [] }", "unknown key `flights`"),
        ("7", "expected a list of segments"),
        ("", "the text ends"),
        (
            "[{ \"proper_time\": 400, \"acceleration\": [1, 0, 0] }]",
            "flight[0] ends at rapidity",
        ),
        (
            "{ \"flight\": [{ \"proper_time\": 1, \"acceleration\": [1, 2, 3, 4] }] }",
            "expected the list to end here",
        ),
        (BALL, "this is a scene, expected its flight alone"),
    ] {
        workplace.write("wrong.json", text);
        workplace
            .run("export ball.json --flight wrong.json -o out.glb")
            .error(&["wrong.json", words]);
    }
    workplace
        .run("export ball.json --flight nosuch.json")
        .error(&["nosuch.json"]);
}

/// The scene of a flight, with words in place of it.
fn flying(flight: &str) -> String {
    BALL.replacen(
        r#""observer": {"#,
        &format!(r#""observer": {{ {flight}"#),
        1,
    )
}

#[test]
fn a_flight_is_left_out() {
    let workplace = Workplace::new();
    let flight = r#""flight": [{ "proper_time": 670, "acceleration": [0.5, 0.1, 0] }],
        "integrator": { "rk4": 0.125 }, "#;
    workplace.write("flying.json", flying(flight));
    workplace.write("straight.json", flying(""));
    let export = |line: &str| {
        let run = workplace.run(&format!("export {line} -o out.glb --steps 1,3"));
        assert!(run.status < 2, "{run}");
        workplace.read("out.glb")
    };
    let straight = export("straight.json");
    assert!(straight != export("flying.json"));
    assert!(straight == export("flying.json --no-flight"));
    // The flight starts at another speed, and is refused there.
    workplace
        .run("export flying.json -o none.glb --rapidity 10")
        .error(&["flight[0] ends at rapidity"]);
    export("flying.json --rapidity 10 --no-flight");
    workplace.write("list.json", "[]");
    for flag in ["--flight list.json", "--integrator exact"] {
        workplace
            .run(&format!("export flying.json --no-flight {flag}"))
            .error(&["cannot be used with", "--no-flight"]);
    }
    workplace
        .run("render flying.json --searchlight --no-searchlight")
        .error(&["cannot be used with", "--no-searchlight"]);
}

#[test]
fn impossible_flags_are_refused_by_name() {
    let workplace = Workplace::with_ball();
    for (flags, words) in [
        ("--velocity 1,0,0", "below the speed of light"),
        ("--velocity 1,0", "expected 3"),
        ("--velocity 0.5,0,0 --beta 0.5", "cannot be used with"),
        (
            "--velocity 0.5,0,0 --direction 1,0,0",
            "cannot be used with",
        ),
        ("--orientation 0,0,0,2", "expected a unit quaternion"),
        ("--orientation 1,0,0", "expected 4: X,Y,Z,W"),
        (
            "--integrator rk5:1",
            "expected exact, euler:STEP or rk4:STEP",
        ),
        (
            "--integrator euler:0",
            "the step is 0, expected a finite proper time > 0",
        ),
        (
            "--integrator euler",
            "expected exact, euler:STEP or rk4:STEP",
        ),
    ] {
        workplace.run(&format!("export {flags}")).error(&[words]);
    }
    workplace
        .run("export --beta 1")
        .error(&["--beta", "beta is 1, expected 0 <= beta < 1"]);
    workplace.run("export --beta -0.5").error(&["beta is -0.5"]);
    workplace
        .run("export --gamma 0.5")
        .error(&["--gamma", "gamma is 0.5"]);
    workplace
        .run("export --rapidity 400")
        .error(&["--rapidity", "at most 350"]);
    workplace
        .run("export --one-minus-beta 2")
        .error(&["--one-minus-beta", "one_minus_beta is 2"]);
    workplace
        .run("export --beta 0.5 --gamma 2")
        .error(&["cannot be used with"]);
    workplace
        .run("export --direction 0,0,0")
        .error(&["--direction", "not zero"]);
    workplace
        .run("export --direction 1,2")
        .error(&["--direction", "expected 3"]);
    workplace
        .run("export --steps 1..2")
        .error(&["--steps", "FROM..TO/COUNT"]);
    workplace
        .run("export --time nan")
        .error(&["--time", "finite"]);
    workplace
        .run("export --marker -1")
        .error(&["--marker", "-1"]);
    for radius in ["1e70", "1e-65", "5e-324", "1.7e308", "-0.001", "inf", "nan"] {
        let scene = format!(r#"{{ "observer": {{ "marker": {radius} }}, "objects": [] }}"#);
        workplace.write("marker.json", scene);
        for command in ["export -o out.glb", "render -o out.png", "check", "cost"] {
            (workplace.run(&format!("{command} ball.json --marker={radius}")))
                .error(&["--marker", radius]);
            let run = workplace.run(&format!("{command} marker.json"));
            run.error(&["marker.json: line 1, column "]);
        }
    }
    std::fs::remove_file(workplace.path("marker.json")).expect("it was written");
    workplace
        .run("export --example cube ball.json")
        .error(&["cannot be used with"]);
    workplace.run("export --nonsense").error(&["--nonsense"]);
    workplace.run("").error(&["Usage"]);
    assert_eq!(workplace.files(), ["ball.json", "square.obj"]);
}

#[test]
fn what_is_no_number_is_told_with_what_was_expected() {
    let workplace = Workplace::with_ball();
    for (line, words) in [
        (
            "export --beta abc",
            ["--beta", "\"abc\" is not a number (expected e.g. 0.5)"],
        ),
        ("export --gamma inf", ["--gamma", "inf is not finite"]),
        // Negative numbers of every form are values, no flags; a flag in the place of a value is none.
        (
            "export --beta -1e-3",
            ["--beta", "-0.001, expected 0 <= beta"],
        ),
        (
            "export --marker -5E-1",
            ["--marker is -0.5", "expected a length"],
        ),
        ("render --fov -1e-3", ["--fov", "-0.001"]),
        ("export --time -q", ["--time", "\"-q\" is not a number"]),
        ("export --marker x", ["--marker", "\"x\" is not a number"]),
        ("render --fov wide", ["--fov", "\"wide\" is not a number"]),
        ("render --samples 0", ["--samples", "expected 1 to 16"]),
        ("cost --repeats 0", ["--repeats", "expected at least 1"]),
        ("cost --places x", ["--places", "expected a whole number"]),
        (
            "export --fps 1e300 --animate --steps 0,1",
            ["--fps is 1e300", "from 0.001 to 1000"],
        ),
    ] {
        workplace.run(line).error(&words);
    }
    let run = workplace
        .run("export --marker -1")
        .error(&["--marker is -1", "or 0 for none"]);
    assert!(!run.stderr.contains("> 0"), "{run}");
}

#[test]
fn how_to_animate_takes_an_equals_sign_and_that_is_said() {
    let workplace = Workplace::with_ball();
    for line in [
        "export ball.json --steps 0,1 --animate morph",
        "export --animate morph",
    ] {
        workplace.run(line).error(&["morph", "--animate=morph"]);
    }
    assert_eq!(workplace.files(), ["ball.json", "square.obj"]);
}

/// "To pass '--no-subdivide' as a value" would make it a file name.
#[test]
fn flags_of_other_commands_are_not_taken_for_files() {
    let workplace = Workplace::new();
    for (line, flag) in [
        ("cost --no-subdivide", "'--no-subdivide'"),
        ("render --lod 1e-2,1e-3", "'--lod'"),
        ("check --nonsense", "'--nonsense'"),
    ] {
        let run = workplace.run(line).error(&["unexpected argument", flag]);
        assert!(!run.stderr.contains("-- --"), "{run}");
    }
    // What is like another flag is still told.
    workplace
        .run("export --bete 0.5")
        .error(&["--bete", "--beta"]);
}

#[test]
fn a_flag_that_would_change_nothing_is_refused() {
    let workplace = Workplace::with_ball();
    for (line, words) in [
        (
            "render ball.json --tolerance 1e-2",
            ["--tolerance is for meshes", "--method mesh"],
        ),
        (
            "render ball.json --no-subdivide",
            ["--no-subdivide is for meshes", "--method mesh"],
        ),
        (
            "render ball.json --max-triangles 9",
            ["--max-triangles is for meshes", "--method mesh"],
        ),
        ("cost ball.json --plot-size 960x480", ["--plot", "required"]),
        (
            "cost ball.json --only meshes --size 9x9",
            ["--size is for pictures", "--only meshes"],
        ),
        (
            "cost ball.json --only meshes --fov 60",
            ["--fov is for pictures", "--only meshes"],
        ),
        (
            "cost ball.json --only rays --places 9",
            ["--places is for meshes", "--only rays"],
        ),
        (
            "cost ball.json --only rays --tolerances 1",
            ["--tolerances is for meshes", "--only rays"],
        ),
        ("export ball.json --fps 3", ["--animate", "required"]),
    ] {
        workplace.run(line).error(&words);
    }
    for line in ["--sheet", "--method mesh", "--view outside"] {
        let line = format!("render ball.json {line} --tolerance 1e-1 --size 16x9 -o out.png");
        workplace.run(&line).success();
    }
}

/// Words that people try are no flags, and the error says which flag is meant.
#[test]
fn flags_that_people_try_are_told_the_flag_that_is_meant() {
    let workplace = Workplace::with_ball();
    for (line, tip) in [
        ("export ball.json --speed 0.9", "did you mean --beta?"),
        ("export ball.json --speed=0.9", "did you mean --beta?"),
        ("export ball.json --out a.glb", "did you mean --output?"),
        (
            "render ball.json --resolution 64x64",
            "did you mean --size?",
        ),
        ("check ball.json --tol 1e-3", "did you mean --tolerance?"),
        ("flight ball.json --step 1", "did you mean --steps?"),
        (
            "export ball.json --tolerence 1e-3",
            "did you mean --tolerance?",
        ),
        (
            "cost ball.json --samples 9",
            "did you mean --places or --pixel-samples?",
        ),
        ("export ball.json morph", "did you mean --animate=morph?"),
        ("export ball.json --morph", "did you mean --animate?"),
    ] {
        workplace.run(line).error(&[tip]);
    }
    let run = workplace
        .run("export ball.json --zzzzzz")
        .error(&["--zzzzzz"]);
    assert!(!run.stderr.contains("did you mean"), "{run}");
    // The command has no such flag.
    let run = workplace.run("check ball.json --resolution 9");
    assert!(!run.stderr.contains("--size"), "{run}");
}

#[test]
fn values_in_no_form_are_told_all_forms() {
    let workplace = Workplace::with_ball();
    let tolerance = ["like 1e-3", "abs:0.01", "deg:0.02"];
    let steps = ["A,B,C like -1,0,2.5", "FROM..TO/COUNT like -6..6/7"];
    for (line, forms) in [
        ("--tolerance fine", &tolerance[..]),
        ("--tolerance rel:1", &tolerance),
        ("--lod 1e-2,abs:x", &tolerance),
        ("--steps all", &steps),
        ("--steps 1..2", &steps),
        ("--velocity fast", &["X,Y,Z like 0,0.5,-0.9"]),
        ("--orientation up", &["X,Y,Z,W like"]),
    ] {
        workplace
            .run(&format!("check ball.json {line}"))
            .error(forms);
    }
    for size in ["640", "axb"] {
        let line = format!("render ball.json --size {size}");
        workplace.run(&line).error(&["WxH like 1280x720"]);
    }
}

#[test]
fn unknown_keys_are_told_the_key_that_is_meant() {
    let workplace = Workplace::with_ball();
    let ball = String::from_utf8(workplace.read("ball.json")).expect("text");
    for (right, wrong, tip) in [
        ("\"radius\"", "\"raduis\"", "did you mean `radius`?"),
        ("\"position\"", "\"pos\"", "did you mean `position`?"),
        (
            "\"tolerance\"",
            "\"tolerence\"",
            "did you mean `tolerance`?",
        ),
        ("\"sphere\"", "\"shpere\"", "did you mean `sphere`?"),
        ("\"observer\"", "\"Observer\"", "did you mean `observer`?"),
        ("\"direction\"", "\"dirction\"", "did you mean `direction`?"),
    ] {
        assert!(ball.contains(right));
        workplace.write("wrong.json", ball.replacen(right, wrong, 1));
        workplace
            .run("check wrong.json")
            .error(&["wrong.json", "unknown", "expected", tip]);
    }
    workplace.write("wrong.json", ball.replacen("\"radius\"", "\"zzzzzz\"", 1));
    let run = workplace
        .run("check wrong.json")
        .error(&["unknown key `zzzzzz`"]);
    assert!(!run.stderr.contains("did you mean"), "{run}");
}
