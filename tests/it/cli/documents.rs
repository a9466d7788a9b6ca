//! The documents for other programs: reports, `check --json`, and the schemas of both.

use photosurface::DVec3;
use serde_json::{Value, json};

use crate::common::command::{Workplace, glb_json};

/// Two things, one of which moves and has two parts, and a flight, a lamp and effects: all that facts may hold.
const RICH: &str = r##"{ "title": "rich", "units": { "length_m": 3 }, "tolerance": { "angle_deg": 0.5 }, "effects": { "doppler": "spectrum", "searchlight": true },
    "observer": { "velocity": { "beta": 0.6, "direction": [1, 0, 0] }, "marker": 0.1, "integrator": { "rk4": 0.1 },
        "flight": [{ "proper_time": 1, "acceleration": [0, 0, -0.1] }, { "proper_time": 1, "steer": "coordinated" }] },
    "steps": [0, 0.5], "objects": [
    { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 3, 0], "emission": { "kelvin": 3000 } },
    { "name": "roof", "file": "roof.obj", "position": [5, 0, 1], "scale": 2, "velocity": [0, 0.5, 0], "model": "contracted" } ] }"##;

const ROOF: &str = "o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no right\nv 3 1 0\nf 2 4 3\n";

fn workplace() -> Workplace {
    let workplace = Workplace::with_ball();
    workplace.write("rich.json", RICH);
    workplace.write("roof.obj", ROOF);
    workplace
}

fn schema(workplace: &Workplace, flag: &str) -> jsonschema::Validator {
    let run = workplace.run(&format!("schema {flag}")).success();
    let schema: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    jsonschema::validator_for(&schema).expect("a schema")
}

fn assert_fits(validator: &jsonschema::Validator, document: &Value) {
    let errors: Vec<String> = validator
        .iter_errors(document)
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(errors.is_empty(), "{errors:#?}");
}

/// The document without each of its keys, at any depth, is refused where the schema requires the key.
fn assert_refuses(validator: &jsonschema::Validator, document: &Value, pointers: &[&str]) {
    for pointer in pointers {
        let (parent, key) = pointer.rsplit_once('/').expect("a key");
        let mut without = document.clone();
        let object = without.pointer_mut(parent).and_then(Value::as_object_mut);
        let removed = object.and_then(|object| object.remove(key));
        assert!(removed.is_some(), "{pointer} is not there");
        assert!(!validator.is_valid(&without), "{pointer} is not required");
        let mut other = document.clone();
        *other.pointer_mut(pointer).expect("a key") = json!({ "no": ["such", "thing"] });
        assert!(!validator.is_valid(&other), "{pointer} may be anything");
    }
}

#[test]
fn reports_fit_their_schema() {
    let workplace = workplace();
    let validator = schema(&workplace, "--report");
    for (line, status) in [
        ("ball.json --steps 0,1", 0),
        ("rich.json", 0),
        ("rich.json --animate", 0),
        ("rich.json --split --no-times", 0),
        ("ball.json --steps 0,1 --models seen,rest", 0),
        ("--example cube --tolerance 1e-1 --animate=morph", 0),
        (
            "square.obj --beta 0.9 --tolerance 1e-9 --max-triangles 9",
            1,
        ),
    ] {
        let run = workplace.run(&format!("export {line} -o out.glb --report report.json"));
        assert_eq!(run.status, status, "{run}");
        assert_fits(&validator, &workplace.read_json("report.json"));
    }
    let report = workplace.read_json("report.json");
    assert_refuses(
        &validator,
        &report,
        &[
            "/scene",
            "/objects",
            "/stages",
            "/version",
            "/outputs",
            "/inputs",
            "/command",
            "/objects/0/bounds/centre",
            "/objects/0/tolerance",
            "/objects/0/certificate/total",
            "/scene/observer_gamma",
            "/outputs/0/bytes",
        ],
    );
}

/// What is written is listed with its length, and what was read.
#[test]
fn reports_name_files_and_their_lengths() {
    let workplace = workplace();
    for (flags, files) in [
        ("-o out.glb", 1),
        ("-o out.ply", 1),
        ("-o out.gltf", 2),
        ("--split -o out.gltf", 4),
        ("--split -o out.glb", 2),
    ] {
        let line = format!("export rich.json {flags} --report report.json");
        workplace.run(&line).success();
        let report = workplace.read_json("report.json");
        let outputs = report["outputs"].as_array().expect("a list");
        assert_eq!(outputs.len(), files, "{flags}");
        for output in outputs {
            let file = output["file"].as_str().expect("a name");
            assert_eq!(output["bytes"], workplace.read(file).len(), "{file}");
        }
        assert_eq!(
            report["inputs"],
            json!(["rich.json", "roof.obj"]),
            "{flags}"
        );
        assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
        let command: Vec<_> = report["command"]
            .as_array()
            .expect("a list")
            .iter()
            .skip(1)
            .collect();
        assert_eq!(
            command,
            line.split(' ')
                .map(Value::from)
                .collect::<Vec<_>>()
                .iter()
                .collect::<Vec<_>>()
        );
        assert!(report["stages"][0]["seconds"].is_number());
    }
    let bytes = workplace
        .run("export ball.json -o - --report report.json")
        .success()
        .stdout;
    let report = workplace.read_json("report.json");
    assert_eq!(
        report["outputs"],
        json!([{ "file": "-", "bytes": bytes.len() }])
    );
    workplace
        .run("export rich.json -o levels.glb --lod 1e-1,1e-2 --report levels.json")
        .success();
    let level = workplace.read_json("levels_lod1.json");
    assert_eq!(level["outputs"][0]["file"], "levels_lod1.glb");
    assert_eq!(
        level["outputs"][0]["bytes"],
        workplace.read("levels_lod1.glb").len()
    );
    assert_eq!(level["objects"][0]["tolerance"], "0.01");
}

#[test]
fn bounds_are_those_of_the_vertices_and_tolerances_those_asked_for() {
    let workplace = workplace();
    workplace
        .run("export rich.json -o out.glb --report report.json")
        .success();
    let report = workplace.read_json("report.json");
    let json = glb_json(&workplace.read("out.glb"));
    let facts = report["objects"].as_array().expect("a list");
    assert_eq!(facts.len(), 6);
    for facts in facts {
        assert_eq!(facts["tolerance"], "deg:0.5");
        let vector =
            |value: &Value| -> DVec3 { serde_json::from_value(value.clone()).expect("a vector") };
        let node = json["nodes"]
            .as_array()
            .expect("nodes")
            .iter()
            .find(|node| node["name"] == facts["name"]);
        let node = node.expect("in the file");
        assert_eq!(node["extras"]["bounds"], facts["bounds"]);
        let mesh = &json["meshes"][node["mesh"].as_u64().expect("an index") as usize];
        let positions = mesh["primitives"][0]["attributes"]["POSITION"]
            .as_u64()
            .expect("an index") as usize;
        let accessor = &json["accessors"][positions];
        let offset = node.get("translation").map_or(DVec3::ZERO, vector);
        let bounds = &facts["bounds"];
        let (low, high) = (vector(&bounds["low"]), vector(&bounds["high"]));
        // Positions in the file are rounded to f32.
        assert!(
            (vector(&accessor["min"]) + offset).distance(low) < 1e-5,
            "{facts}"
        );
        assert!(
            (vector(&accessor["max"]) + offset).distance(high) < 1e-5,
            "{facts}"
        );
        assert_eq!(vector(&bounds["size"]), high - low);
        assert!(vector(&bounds["centre"]).distance((low + high) / 2.0) < 1e-12);
    }
}

#[test]
fn reports_without_times_are_the_same_on_every_run() {
    let workplace = workplace();
    let line = "export rich.json -o out.glb --no-times --report report.json";
    let mut reports = vec![];
    for threads in ["1", "2", "7"] {
        let run = workplace.run_with(line, b"", &[("RAYON_NUM_THREADS", threads)]);
        run.success();
        reports.push(workplace.read("report.json"));
    }
    assert!(reports.windows(2).all(|pair| pair[0] == pair[1]));
    assert_eq!(workplace.read_json("report.json")["stages"], json!([]));
    workplace
        .run("export rich.json --no-times")
        .error(&["--report"]);
}

#[test]
fn checks_fit_their_schema_and_say_what_the_tables_say() {
    let workplace = workplace();
    let validator = schema(&workplace, "--check");
    for (line, status) in [
        ("ball.json --steps 0,1", 0),
        ("rich.json", 0),
        (
            "rich.json --lod 1e-1,1e-9 --format ply --max-triangles 1000",
            1,
        ),
        ("--example lattice", 0),
        ("--example stars --models seen,rest", 0),
        (
            "square.obj --beta 0.9 --tolerance 1e-9 --max-triangles 9",
            1,
        ),
    ] {
        let run = workplace.run(&format!("check {line} --json"));
        assert_eq!(run.status, status, "{run}");
        let check: Value = serde_json::from_slice(&run.stdout).expect("JSON alone");
        assert_fits(&validator, &check);
        assert_eq!(check["certified"], status == 0);
        let notes = check["notes"].as_array().expect("a list");
        let told: Vec<String> = run
            .stderr
            .lines()
            .filter_map(|line| line.strip_prefix("note: "))
            .map(str::to_owned)
            .collect();
        assert_eq!(
            notes,
            &told.into_iter().map(Value::from).collect::<Vec<_>>(),
            "{run}"
        );
        let table = workplace.run(&format!("check {line}"));
        let table = table.stdout_text().to_owned();
        for object in check["objects"].as_array().expect("a list") {
            let name = object["name"].as_str().expect("a name");
            assert!(table.matches(name).count() > 1, "{table}");
        }
        for level in check["levels"].as_array().expect("a list") {
            for effect in level["effects"].as_array().expect("a list") {
                assert!(
                    table.contains(&format!(
                        "effect {}:",
                        effect["effect"].as_str().expect("a name")
                    )),
                    "{table}"
                );
            }
        }
    }
    let run = workplace.run("check rich.json --json").success();
    let check: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_refuses(
        &validator,
        &check,
        &[
            "/objects",
            "/levels",
            "/notes",
            "/steps",
            "/inputs",
            "/objects/0/relative_gamma",
            "/levels/0/triangles",
            "/levels/0/objects/0/tolerance",
            "/objects/0/photosurface_at_steps/0/low",
            "/levels/0/effects/0/picture_seconds",
        ],
    );
}

/// Against closed forms: a ball at rest and as an observer who moves along its line of sight sees it.
#[test]
fn check_tells_where_objects_are_and_are_seen() {
    let workplace = Workplace::new();
    workplace.write(
        "plate.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n",
    );
    workplace.write(
        "plate.json",
        r#"{ "observer": { "velocity": [0, 0, -0.6] }, "steps": [0, 1], "objects": [
            { "name": "plate", "file": "plate.obj", "position": [0, 0, -5], "scale": 2 } ] }"#,
    );
    let run = workplace.run("check plate.json --json").success();
    let check: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let object = &check["objects"][0];
    assert_eq!(
        object["at_rest"],
        json!({ "low": [-2.0, -2.0, -5.0], "high": [2.0, 2.0, -5.0], "centre": [0.0, 0.0, -5.0], "size": [4.0, 4.0, 0.0] })
    );
    // A corner at (2, 2, -d) at rest is seen at gamma (z - beta r) along the motion; gamma is 1.25.
    let z = |d: f64| 1.25 * (-d - 0.6 * (d * d + 8.0).sqrt());
    // After a proper time of 1 the observer has come nearer by gamma beta.
    let expected = [z(5.0), z(5.0 - 0.75)];
    for (step, expected) in expected.into_iter().enumerate() {
        let seen = &object["photosurface_at_steps"][step];
        assert_eq!(
            (&seen["step"], &seen["proper_time"]),
            (&json!(step), &json!(step as f64))
        );
        let found = seen["centre"][2].as_f64().expect("a number");
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        assert_eq!(seen["size"][0], 4.0);
    }
    let low = object["photosurface"]["low"][2].as_f64().expect("a number");
    let size = object["photosurface"]["size"][2]
        .as_f64()
        .expect("a number");
    assert!(
        (low - expected[0]).abs() < 1e-12 && (size - (expected[1] - expected[0])).abs() < 1e-12
    );
    let table = workplace.run("check plate.json").success();
    let lines: Vec<&str> = table.stdout_text().lines().collect();
    assert_eq!(
        lines[4].split_whitespace().next(),
        Some("object"),
        "{table}"
    );
    let cells: Vec<&str> = lines[5].split_whitespace().collect();
    assert_eq!(cells[..3], ["plate", "0,0,-5", "4,4,0"], "{table}");
    assert_eq!(cells.len(), 5, "{table}");
}
