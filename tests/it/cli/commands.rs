//! The binary as users run it: exit status, clean stdout, every flag reaches its parameter, errors that help.

use std::path::Path;

use crate::common::command::{BALL, SQUARE, Workplace, glb_json, node_names};
use crate::common::glb::Glb;
use serde_json::Value;

#[test]
fn the_newcomers_command_writes_the_sphere() {
    let workplace = Workplace::new();
    let run = workplace.run("export").success();
    assert!(run.stdout.is_empty(), "{run}");
    assert!(
        run.stderr
            .contains("sphere_photosurface.glb: 7 photosurfaces"),
        "{run}"
    );
    assert_eq!(workplace.files(), ["sphere_photosurface.glb"]);
    let names = node_names(&workplace.read("sphere_photosurface.glb"));
    assert_eq!(names[0], "observer");
    assert_eq!(names[1], "sphere_step000");
    assert_eq!(names.len(), 8);
}

#[test]
fn every_built_in_scene_exports() {
    let workplace = Workplace::new();
    let list = workplace.run("example").success();
    let names: Vec<_> = list
        .stdout_text()
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    let expected = "sphere, cube, terrell, stretched, plane, speeds, rod, lattice, street, night, snapshot, flight, takeoff, turn, orbit, models, stars";
    assert_eq!(names.join(", "), expected);
    // Some scenes have a million triangles at their own tolerance.
    let tolerance = "--tolerance 1e-2";
    for name in names {
        workplace
            .run(&format!(
                "export --example {name} {tolerance} -o {name}.glb"
            ))
            .success();
        workplace.run(&format!("check --example {name}")).success();
        let printed = workplace.run(&format!("example {name}")).success();
        workplace.write("printed.json", &printed.stdout);
        workplace
            .run(&format!("export printed.json {tolerance} -o printed.glb"))
            .success();
        assert_eq!(
            workplace.read("printed.glb"),
            workplace.read(&format!("{name}.glb"))
        );
    }
    workplace
        .run("example nosuch")
        .error(&["\"nosuch\"", expected]);
    workplace
        .run("export --example nosuch")
        .error(&["\"nosuch\""]);
}

#[test]
fn the_readmes_commands_work() {
    let workplace = Workplace::new();
    workplace.write("bunny.obj", SQUARE);
    workplace.write(
        "thrust.json",
        r#"[{ "proper_time": 6, "acceleration": [0, 0, -0.5] }]"#,
    );
    workplace.write("speeds.json", r#"[{ "beta": 0.5 }, { "gamma": 5 }]"#);
    let count = run_commands(&workplace, include_str!("../../../README.md"));
    assert!(count >= 5, "only {count} commands found in the README");
}

#[test]
fn the_commands_of_lessons_work() {
    let lessons = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/lessons");
    let index = std::fs::read_to_string(lessons.join("README.md")).expect("an index");
    let workplace = Workplace::new();
    let mut count = 0;
    for page in std::fs::read_dir(&lessons)
        .expect("a folder")
        .map(|page| page.expect("a page"))
    {
        let name = page.file_name().into_string().expect("a name");
        let text = std::fs::read_to_string(page.path()).expect("text");
        assert!(
            name == "README.md" || index.contains(&format!("({name})")),
            "{name}"
        );
        count += run_commands(&workplace, &text);
        for picture in text.split("](../gallery/").skip(1) {
            let picture = picture.split(')').next().unwrap_or_default();
            assert!(
                lessons.join("../gallery").join(picture).exists(),
                "{name}: {picture}"
            );
        }
    }
    assert!(count >= 14, "only {count} commands found in lessons");
}

/// Runs the commands in blocks of shell in a text; returns how many there are.
fn run_commands(workplace: &Workplace, text: &str) -> usize {
    let blocks = text
        .split("```sh\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap_or_default());
    let lines = blocks
        .flat_map(str::lines)
        .filter(|line| line.starts_with("photosurface "));
    let mut count = 0;
    for line in lines {
        let run = workplace.run_shell(line).success();
        assert!(!run.stderr.contains("written by photosurface"), "{run}");
        count += 1;
    }
    count
}

#[test]
fn a_bare_mesh_needs_no_scene() {
    let workplace = Workplace::with_ball();
    let run = workplace
        .run("export square.obj --beta 0.6 --observer 0,0,2")
        .success();
    assert!(run.stderr.contains("square_photosurface.glb"), "{run}");
    let bytes = workplace.read("square_photosurface.glb");
    assert_eq!(node_names(&bytes), ["square"]);
    // The observer, 2 before the square, moves towards it: the corners are seen where the map of
    // light-cone coordinates puts them, gamma (d + beta r) ahead.
    let json = glb_json(&bytes);
    let z = json["nodes"][0]["translation"][2].as_f64().unwrap_or(0.0);
    let local = json["accessors"][0]["min"][2].as_f64().unwrap();
    let expected = -1.25 * (2.0 + 0.6 * 6f64.sqrt());
    assert!(
        (z + local - expected).abs() < 1e-6,
        "{} {expected}",
        z + local
    );

    // Unplaced, the observer passes at two diagonals, with the mesh on its right.
    workplace
        .run("export square.obj --report report.json")
        .success();
    let z = workplace.read_json("report.json")["scene"]["observer_position"][2]
        .as_f64()
        .unwrap();
    assert!((z - 2.0 * 8f64.sqrt()).abs() < 1e-12, "{z}");
    workplace
        .run("export square.obj --direction 0,0,-1 --report report.json")
        .success();
    let x = workplace.read_json("report.json")["scene"]["observer_position"][0]
        .as_f64()
        .unwrap();
    assert!((x + 2.0 * 8f64.sqrt()).abs() < 1e-12, "{x}");
}

#[test]
fn stdin_and_stdout_take_the_place_of_files() {
    let workplace = Workplace::with_ball();
    workplace.run("export ball.json -o file.glb").success();
    let file = workplace.read("file.glb");
    let run = workplace
        .run_with("export - -o -", BALL.as_bytes(), &[])
        .success();
    assert!(run.stdout == file, "stdout differs from the file");
    assert!(run.stderr.is_empty(), "{run}");
    // A GLB from stdin, its report to stdout.
    let run = workplace
        .run_with("export - -o again.glb --report -", &file, &[])
        .success();
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(report["objects"][0]["object"], "mesh");
    let run = workplace
        .run_with("check -", BALL.as_bytes(), &[])
        .success();
    assert!(run.stdout_text().contains("ball"), "{run}");
    workplace
        .run_with("export - -o x.glb", b"{ \"objects\": 1 }", &[])
        .error(&["stdin", "line 1", "objects"]);
    workplace
        .run_with("export - -o x.glb", b"\xff\xfe", &[])
        .error(&[
            "stdin",
            "this is neither",
            "give its file name instead of -",
        ]);
    workplace.run("export --split -o -").error(&["--split"]);
    workplace
        .run("export -o - --report -")
        .error(&["cannot both go to stdout"]);
}

/// A name says what a file is; stdout has none.
#[test]
fn stdout_takes_the_format_that_is_asked_for() {
    let workplace = Workplace::with_ball();
    workplace.run("export ball.json -o file.glb").success();
    workplace
        .run("export ball.json -o file.ply --format ply")
        .success();
    for format in ["glb", "ply"] {
        let line = format!("export ball.json -o - --format {format}");
        let run = workplace.run(&line).success();
        assert!(run.stdout == workplace.read(&format!("file.{format}")));
    }
    workplace.run("export ball.json --format ply").success();
    assert!(workplace.read("ball_photosurface.ply") == workplace.read("file.ply"));
    workplace
        .run("export ball.json -o - --format gltf")
        .error(&["--format gltf", "expected glb or ply"]);
    workplace
        .run("export ball.json -o other.glb --format ply")
        .error(&["other.glb: is .glb by its name and .ply by --format"]);
}

#[test]
fn wrong_scenes_are_told_with_file_line_column_and_expectation() {
    let workplace = Workplace::new();
    workplace.write("wrong.json", BALL.replace("radius", "raduis"));
    let run = workplace.run("export wrong.json -o out.glb");
    run.error(&[
        "wrong.json: line 2, column",
        "objects[0].shape.sphere",
        "`raduis`",
        "expected",
        "radius",
    ]);
    workplace.write("wrong.json", BALL.replace("0.6", "1.6"));
    workplace.run("check wrong.json").error(&[
        "wrong.json: line 1",
        "observer.velocity",
        "beta is 1.6",
    ]);
    workplace.write(
        "wrong.json",
        BALL.replace("\"shape\"", "\"file\": \"x.glb\", \"shape\""),
    );
    workplace
        .run("check wrong.json")
        .error(&["object \"ball\" has both"]);
    workplace.write(
        "wrong.json",
        r#"{ "objects": [ { "name": "a", "file": "missing.glb" } ] }"#,
    );
    workplace
        .run("check wrong.json")
        .error(&["object \"a\"", "missing.glb"]);
    assert_eq!(workplace.files(), ["wrong.json"]);
}

#[test]
fn missing_and_unknown_files_are_told_by_name() {
    let workplace = Workplace::with_ball();
    workplace
        .run("export nosuch.json")
        .error(&["nosuch.json", "No such file"]);
    workplace
        .run("export nosuch.glb")
        .error(&["nosuch.glb", "No such file"]);
    workplace.run("export ball.fbx").error(&[
        "ball.fbx",
        "unknown extension",
        ".glb, .gltf, .obj, .ply, .stl or .off; Blender or MeshLab",
    ]);
    workplace
        .run("export ball.json -o out.stl")
        .error(&["out.stl", ".glb, .gltf or .ply"]);
    workplace
        .run("export ball.json -o out")
        .error(&["out: unknown extension"]);
    workplace
        .run("export ball.json -o no/such/out.glb")
        .error(&["no/such/out.glb", "No such file"]);
    workplace
        .run("export ball.json -o square.obj/out.glb")
        .error(&["square.obj/out.glb"]);
    workplace
        .run("export ball.json --report no/such.json")
        .error(&["no/such.json"]);
    workplace.write("empty.glb", "");
    workplace.run("export empty.glb").error(&["empty.glb"]);
    assert_eq!(workplace.files(), ["ball.json", "empty.glb", "square.obj"]);
}

/// It was replaced by a file beside it that took its name, which asks nobody.
#[test]
fn what_is_read_only_is_not_replaced() {
    let workplace = Workplace::with_ball();
    for name in ["out.glb", "report.json", "picture.png"] {
        workplace.write(name, "mine");
        let mut permissions = std::fs::metadata(workplace.path(name))
            .unwrap()
            .permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(workplace.path(name), permissions).unwrap();
    }
    for (line, name) in [
        ("export ball.json -o out.glb", "out.glb"),
        (
            "export ball.json -o new.glb --report report.json",
            "report.json",
        ),
        ("render ball.json --size 16x9 -o picture.png", "picture.png"),
    ] {
        workplace.run(line).error(&[name, "denied"]);
        assert_eq!(workplace.read(name), b"mine");
    }
    assert!(!workplace.files().contains(&"new.glb".to_owned()));
}

/// A photosurface of a photosurface is hardly ever meant.
#[test]
fn what_this_program_wrote_is_noted_by_every_command() {
    let workplace = Workplace::with_ball();
    workplace
        .run("export square.obj --beta 0.5 -o seen.glb")
        .success();
    workplace.write(
        "scene.json",
        r#"{ "objects": [ { "name": "a", "file": "seen.glb" } ] }"#,
    );
    for line in [
        "export seen.glb -o out.glb",
        "check seen.glb",
        "render seen.glb --size 16x9 -o out.png",
        "cost seen.glb --only meshes --tolerances 1e-1 --places 9 --repeats 1",
        "export scene.json -o out.glb",
    ] {
        let run = workplace.run(line).success();
        let notes = run
            .stderr
            .matches("seen.glb: written by photosurface ")
            .count();
        assert_eq!(notes, 1, "{run}");
    }
    let run = workplace.run("export square.obj -o out.glb").success();
    assert!(!run.stderr.contains("note"), "{run}");
}

#[test]
fn the_marker_is_told_beside_the_triangles() {
    let workplace = Workplace::with_ball();
    let run = workplace
        .run("export square.obj --marker 0.1 -o out.glb")
        .success();
    assert!(run.stderr.contains(" triangles and the marker, "), "{run}");
}

/// A note for each material would hide the one that matters.
#[test]
fn what_is_said_of_many_things_of_a_file_is_said_once() {
    let workplace = Workplace::new();
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\nusemtl d\nf 1 2 3\n";
    workplace.write("many.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}"));
    let run = workplace.run("check many.obj").success();
    let notes: Vec<_> = run.stderr.lines().collect();
    assert_eq!(notes.len(), 1, "{run}");
    assert!(
        notes[0].starts_with("note: many.obj: material \"a\""),
        "{run}"
    );
    assert!(notes[0].ends_with(", and so 3 more materials"), "{run}");
}

#[cfg(unix)]
#[test]
fn an_unwritable_directory_is_told_before_any_work() {
    use std::os::unix::fs::PermissionsExt;
    let workplace = Workplace::with_ball();
    let directory = workplace.path("locked");
    std::fs::create_dir(&directory).unwrap();
    std::fs::set_permissions(&directory, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(directory.join("probe"), "").is_ok() {
        // The superuser may write anywhere but into what is no file system for it.
        workplace
            .run("export ball.json -o /proc/out.glb")
            .error(&["/proc/out.glb"]);
    } else {
        workplace
            .run("export ball.json -o locked/out.glb")
            .error(&["locked/out.glb", "denied"]);
    }
}

#[test]
fn what_is_read_is_never_written_over() {
    let workplace = Workplace::with_ball();
    workplace.run("export square.obj -o mesh.glb").success();
    let before = workplace.read("mesh.glb");
    workplace
        .run("export mesh.glb -o mesh.glb")
        .error(&["mesh.glb", "overwrite"]);
    workplace
        .run("export mesh.glb -o out.glb --report ./mesh.glb")
        .error(&["overwrite"]);
    assert_eq!(workplace.read("mesh.glb"), before);
    workplace.write(
        "scene.json",
        r#"{ "objects": [ { "name": "a", "file": "mesh.glb" } ] }"#,
    );
    workplace
        .run("export scene.json -o mesh.glb")
        .error(&["mesh.glb", "overwrite"]);
}

#[test]
fn no_two_outputs_are_one_file() {
    let workplace = Workplace::with_ball();
    for arguments in [
        "-o a.glb --report a.glb",
        "-o a.glb --report ./a.glb",
        "-o a.gltf --report a.gltf",
        "-o a.glb --steps 0,1 --split --report a_step001.glb",
    ] {
        workplace
            .run(&format!("export ball.json {arguments}"))
            .error(&["the output ", "overwrite another output, "]);
        assert_eq!(workplace.files(), ["ball.json", "square.obj"]);
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("b.glb", workplace.path("link")).unwrap();
        workplace
            .run("export ball.json -o b.glb --report link")
            .error(&["the output link would overwrite another output, b.glb"]);
        workplace.run("export ball.json --report link").success();
        assert_eq!(
            workplace.read_json("b.glb")["objects"][0]["object"],
            "ball",
            "a link that leads to nothing is followed"
        );
    }
}

#[test]
fn files_come_in_three_formats_and_one_for_each_step() {
    let workplace = Workplace::with_ball();
    workplace
        .run("export ball.json --steps 0,1 -o a.gltf")
        .success();
    let json = workplace.read_json("a.gltf");
    let data = json["buffers"][0]["uri"].as_str().unwrap();
    assert!(data.starts_with("a-") && data.ends_with(".bin"), "{data}");
    assert_eq!(
        json["buffers"][0]["byteLength"].as_u64(),
        Some(workplace.read(data).len() as u64)
    );
    workplace
        .run("export ball.json --steps 0,1 -o a.ply")
        .success();
    assert!(
        workplace
            .read("a.ply")
            .starts_with(b"ply\nformat binary_little_endian 1.0\n")
    );

    workplace
        .run("export ball.json --steps 0,1 --split -o b.glb")
        .success();
    workplace
        .run("export ball.json --steps 0,1 -o c.glb")
        .success();
    assert_eq!(
        workplace.files(),
        [
            data,
            "a.gltf",
            "a.ply",
            "b_step000.glb",
            "b_step001.glb",
            "ball.json",
            "c.glb",
            "square.obj"
        ]
    );
    assert_eq!(
        node_names(&workplace.read("b_step000.glb")),
        ["ball_step000"]
    );
    assert_eq!(
        node_names(&workplace.read("b_step001.glb")),
        ["ball_step001"]
    );
    assert_eq!(
        node_names(&workplace.read("c.glb")),
        ["ball_step000", "ball_step001"]
    );
    // What the steps share is written once.
    let json = glb_json(&workplace.read("c.glb"));
    let indices = |mesh: usize| json["meshes"][mesh]["primitives"][0]["indices"].clone();
    assert_eq!(indices(0), indices(1));
}

#[test]
fn the_report_and_the_extras_say_the_same() {
    let workplace = Workplace::with_ball();
    workplace
        .run("export ball.json --steps 0,1 -o out.glb --report report.json")
        .success();
    let report = workplace.read_json("report.json");
    let json = glb_json(&workplace.read("out.glb"));
    assert_eq!(report["scene"], json["scenes"][0]["extras"]);
    assert_eq!(report["objects"][1], json["nodes"][1]["extras"]);
    assert_eq!(report["objects"][1]["name"], "ball_step001");
    assert_eq!(report["objects"][1]["proper_time"], 1.0);
    let gamma = report["objects"][1]["relative_gamma"].as_f64().unwrap();
    assert!((gamma - 1.25).abs() < 1e-15);
    let stages: Vec<_> = report["stages"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|stage| stage["name"].as_str())
        .collect();
    assert_eq!(stages, ["read", "predict", "photosurface", "write"]);
}

#[test]
fn the_same_bytes_on_every_run_and_with_any_number_of_threads() {
    let workplace = Workplace::new();
    // One step, and several of which some are made ahead.
    for (example, format) in [("snapshot", "glb"), ("snapshot", "ply"), ("cube", "glb")] {
        let mut files = Vec::new();
        for threads in ["1", "2", "7", "7"] {
            let arguments = format!("export --example {example} -o out.{format}");
            workplace
                .run_with(&arguments, b"", &[("RAYON_NUM_THREADS", threads)])
                .success();
            files.push(workplace.read(&format!("out.{format}")));
        }
        for threads in ["1", "3"] {
            let arguments =
                format!("--threads {threads} export --example {example} -o out.{format}");
            workplace.run(&arguments).success();
            files.push(workplace.read(&format!("out.{format}")));
        }
        assert!(files.windows(2).all(|pair| pair[0] == pair[1]), "{format}");
    }
}

#[test]
fn every_command_computes_with_as_many_threads_as_it_is_told() {
    let workplace = Workplace::with_ball();
    let flags = "cost ball.json --only meshes --tolerances 1e-1 --places 9 --repeats 1 --json -";
    for threads in ["1", "3"] {
        let flags = format!("{flags} --threads {threads}");
        // The flag wins.
        let run = workplace.run_with(&flags, b"", &[("RAYON_NUM_THREADS", "2")]);
        let study: Value = serde_json::from_slice(&run.success().stdout).unwrap();
        assert_eq!(study["threads"].to_string(), threads);
    }
    for (threads, said) in [
        ("0", "at least 1"),
        ("-1", "a whole number"),
        ("many", "a whole number"),
        ("1000000", "--threads is 1000000, expected at most"),
    ] {
        let run = workplace.run(&format!("check ball.json --threads {threads}"));
        assert_eq!(run.status, 2, "{run}");
        assert!(run.stderr.contains(said), "{run}");
    }
    let run = workplace.run_with("check ball.json", b"", &[("RAYON_NUM_THREADS", "65535")]);
    assert_eq!(run.status, 2, "{run}");
    let said = "RAYON_NUM_THREADS is 65535, expected at most";
    assert!(run.stderr.contains(said), "{run}");
}

/// In a large file the data is behind room for the JSON; through a pipe it comes when the JSON is known.
#[test]
fn a_large_file_is_what_comes_through_a_pipe_but_for_spaces() {
    let workplace = Workplace::new();
    let arguments = "export --example plane --tolerance 1e-5 -o";
    workplace.run(&format!("{arguments} out.glb")).success();
    let piped = workplace.run(&format!("{arguments} -")).success().stdout;
    let file = workplace.read("out.glb");
    let parts = |glb: &[u8]| {
        let glb = Glb::new(glb);
        (glb.text, glb.binary)
    };
    assert!(piped.len() > 5_000_000, "more than waits in memory");
    assert!(file.len() > piped.len(), "there is room left");
    assert!(parts(&file) == parts(&piped));
}

#[test]
fn messages_go_to_stderr_as_loud_as_asked() {
    let workplace = Workplace::with_ball();
    let quiet = workplace.run("export ball.json -o out.glb -q").success();
    assert!(
        quiet.stdout.is_empty() && quiet.stderr.is_empty(),
        "{quiet}"
    );
    let verbose = workplace.run("export ball.json -o out.glb -v").success();
    assert!(
        verbose.stderr.contains("ball: proper time 0, gamma 1.25"),
        "{verbose}"
    );
    assert!(verbose.stderr.contains("write:"), "{verbose}");
    workplace
        .run("export ball.json -q -v")
        .error(&["cannot be used with"]);
    let out_of_range = workplace.run("export ball.json -o far.glb --rapidity 200");
    out_of_range.error(&[
        "the photosurface \"ball\"",
        "beyond what 32-bit numbers",
        "smaller rapidity",
    ]);
    assert_eq!(workplace.files(), ["ball.json", "out.glb", "square.obj"]);
}

#[test]
fn the_schema_is_a_schema() {
    let workplace = Workplace::new();
    let run = workplace.run("schema").success();
    let schema: Value = serde_json::from_slice(&run.stdout).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    assert!(validator.is_valid(&serde_json::from_str(BALL).unwrap()));
    let ball = |from: &str, to: &str| {
        assert!(BALL.contains(from), "{from}");
        BALL.replace(from, to)
    };
    let shape = r#""shape": { "sphere": { "radius": 1, "resolution": 8 } }"#;
    for right in [
        ball("\"beta\": 0.6", "\"gamma\": 2"),
        ball(
            "\"beta\": 0.6, \"direction\": [1, 0, 0]",
            "\"rapidity\": 350",
        ),
        ball(shape, "\"file\": \"a.glb\""),
        ball(shape, &format!("{shape}, \"color\": \"#ffffff\"")),
        ball("\"objects\"", "\"steps\": [1, 2], \"objects\""),
        ball(
            "\"objects\"",
            "\"steps\": { \"from\": 0, \"to\": 1, \"count\": 2 }, \"objects\"",
        ),
    ] {
        assert!(photosurface::Scene::from_json(&right).is_ok(), "{right}");
        let json = serde_json::from_str(&right).unwrap();
        assert!(validator.is_valid(&json), "{right}");
    }
    for wrong in [
        ball("radius", "raduis"),
        ball("objects", "object"),
        "[]".into(),
        r#"{ "objects": [] }"#.into(),
        ball("\"beta\": 0.6", "\"beta\": 0.6, \"gamma\": 2"),
        ball("\"beta\": 0.6, ", ""),
        ball("\"beta\": 0.6", "\"beta\": 1"),
        ball("\"beta\": 0.6", "\"gamma\": 0.5"),
        ball("\"beta\": 0.6", "\"rapidity\": 400"),
        ball(shape, &format!("{shape}, \"file\": \"a.glb\"")),
        ball(&format!("{shape}, "), ""),
        ball(shape, "\"file\": \"\""),
        ball(shape, "\"file\": \"a.glb\", \"color\": \"#ffffff\""),
        ball(shape, "\"shape\": {}"),
        ball("\"radius\": 1", "\"radius\": 0"),
        ball("{ \"radius\": 1, \"resolution\": 8 }", "[1, 8]"),
        ball("\"objects\"", "\"steps\": [], \"objects\""),
        ball(
            "\"objects\"",
            "\"steps\": { \"from\": 0, \"to\": 1, \"count\": 0 }, \"objects\"",
        ),
    ] {
        assert!(photosurface::Scene::from_json(&wrong).is_err(), "{wrong}");
        let json = serde_json::from_str(&wrong).unwrap();
        assert!(!validator.is_valid(&json), "{wrong}");
    }
    // Descriptions are for authors of scenes.
    for word in ["```", "# Example", "photosurface::", "Error", "Rust"] {
        assert!(!run.stdout_text().contains(word), "{word}");
    }
}

#[test]
fn help_names_every_command_and_the_units() {
    let workplace = Workplace::new();
    let run = workplace.run("--help").success();
    for word in [
        "export",
        "check",
        "cost",
        "flight",
        "example",
        "schema",
        "the speed of light is 1",
        "Exit status",
    ] {
        assert!(run.stdout_text().contains(word), "{word}\n{run}");
    }
    let run = workplace.run("export --help").success();
    for word in [
        "--beta",
        "--one-minus-beta",
        "--steps",
        "--split",
        "--report",
        "[default",
    ] {
        assert!(run.stdout_text().contains(word), "{word}\n{run}");
    }
}
