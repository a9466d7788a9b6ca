//! `photosurface sweep`: each run writes what its command alone writes; `photosurface join`.

use serde_json::{Value, json};

use crate::common::command::Workplace;

const LIST: &str = r#"{ "all": { "steps": [0, 1] }, "runs": [
  { "name": "slow", "beta": 0.3 },
  { "name": "fast", "gamma": 9, "normals": "smooth", "tolerance": "1e-2", "split": true, "output": "own.glb" },
  { "beta": 0.5, "format": "ply", "steps": "0..2/3" } ] }"#;

fn with_list() -> Workplace {
    let workplace = Workplace::with_ball();
    workplace.write("list.json", LIST);
    workplace
}

#[test]
fn runs_write_what_the_command_alone_writes() {
    let workplace = with_list();
    let run = workplace
        .run("sweep list.json square.obj --json table.json --csv table.csv")
        .success();
    for (line, files) in [
        (
            "--steps 0,1 --beta 0.3 -o a.glb",
            vec![("slow.glb", "a.glb")],
        ),
        (
            "--steps 0,1 --gamma 9 --normals smooth --tolerance 1e-2 --split -o b.glb",
            vec![
                ("own_step000.glb", "b_step000.glb"),
                ("own_step001.glb", "b_step001.glb"),
            ],
        ),
        (
            "--steps 0..2/3 --beta 0.5 -o c.ply",
            vec![("run002.ply", "c.ply")],
        ),
    ] {
        workplace
            .run(&format!("export square.obj {line}"))
            .success();
        for (swept, alone) in files {
            assert_eq!(workplace.read(swept), workplace.read(alone), "{line}");
        }
    }
    let table = workplace.read_json("table.json");
    let rows = table["runs"].as_array().expect("rows");
    assert_eq!(rows.len(), 3, "{run}");
    assert_eq!(rows[1]["name"], "fast");
    assert_eq!(
        rows[1]["files"],
        json!(["own_step000.glb", "own_step001.glb"])
    );
    assert_eq!(rows[1]["photosurfaces"], 2);
    assert_eq!(rows[2]["bytes"], workplace.read("run002.ply").len());
    assert!(rows.iter().all(|row| row["ended"] == "certified"));
    let csv = String::from_utf8(workplace.read("table.csv")).expect("text");
    assert_eq!(csv.lines().count(), 4);
    assert!(csv.starts_with("run,name,ended,seconds,"), "{csv}");
    // For people, and only a part.
    let run = workplace
        .run("sweep list.json square.obj --only 2..3")
        .success();
    assert!(run.stdout_text().contains("run002.ply"), "{run}");
    assert!(!run.stdout_text().contains("slow"), "{run}");
}

#[test]
fn a_list_fits_its_schema() {
    let workplace = with_list();
    let run = workplace.run("schema --sweep").success();
    let schema: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let list: Value = serde_json::from_str(LIST).expect("JSON");
    assert!(validator.is_valid(&list));
    assert!(validator.is_valid(&list["runs"]));
    for wrong in [
        json!([]),
        json!([{ "bet": 1 }]),
        json!({ "runs": [{}], "command": "cost" }),
        json!({ "run": [{}] }),
        json!([{ "beta": { "x": 1 } }]),
    ] {
        assert!(!validator.is_valid(&wrong), "{wrong}");
    }
}

#[test]
fn a_run_that_fails_does_not_end_the_others() {
    let workplace = Workplace::with_ball();
    workplace.write(
        "list.json",
        r#"[{ "beta": 0.3 }, { "name": "wrong", "beta": 1.5 }, { "name": "coarse", "max-triangles": 4, "gamma": 50 }]"#,
    );
    let run = workplace.run("sweep list.json square.obj --csv table.csv --progress json");
    assert_eq!(run.status, 2, "{run}");
    assert!(run.stderr.contains("1 of 3 runs failed"), "{run}");
    assert!(run.stderr.contains("wrong"), "{run}");
    assert!(workplace.files().contains(&"run000.glb".to_owned()));
    assert!(workplace.files().contains(&"coarse.glb".to_owned()));
    let lines = run.stderr.lines().filter(|line| line.starts_with('{'));
    let lines: Vec<Value> = lines
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(lines.len(), 3, "{run}");
    assert!(
        lines[1]["error"]
            .as_str()
            .is_some_and(|error| error.contains("--beta")),
        "{run}"
    );
    assert_eq!(lines[2]["certified"], false, "{run}");
    let run = workplace.run("sweep list.json square.obj --only 2..3");
    assert_eq!(run.status, 1, "{run}");
    // What the list itself says wrong is found before anything is made.
    workplace.write(
        "list.json",
        r#"[{ "name": "a" }, { "name": "b", "bta": 0.5 }]"#,
    );
    let run = workplace.run("sweep list.json ball.json");
    run.error(&["list.json", "runs[1] \"b\"", "--bta"]);
    assert!(!workplace.files().contains(&"a.glb".to_owned()));
    workplace.write("list.json", r#"[{ "name": "a" }]"#);
    for table in ["--csv", "--json"] {
        let run = workplace.run(&format!("sweep list.json ball.json {table} a.glb"));
        run.error(&["a.glb", "the run \"a\" writes"]);
    }
    assert!(!workplace.files().contains(&"a.glb".to_owned()));
    workplace.write("list.json", "[{},");
    workplace
        .run("sweep list.json")
        .error(&["list.json", "line 1"]);
    workplace
        .run("sweep list.json --only 3..4")
        .error(&["list.json"]);
}

#[test]
fn finished_runs_stay() {
    let workplace = with_list();
    let line = "sweep list.json square.obj --resume --json table.json -q";
    workplace.run(line).success();
    let files = ["slow.glb", "own_step000.glb", "run002.ply"];
    let before = files.map(|file| workplace.read(file));
    std::fs::remove_file(workplace.path("slow.glb")).expect("a file");
    workplace.run(line).success();
    assert_eq!(files.map(|file| workplace.read(file)), before);
    let table = workplace.read_json("table.json");
    let resumed: Vec<_> = (0..3)
        .map(|run| table["runs"][run]["resumed"].as_u64())
        .collect();
    assert_eq!(resumed, [Some(0), Some(2), Some(1)]);
    let run = workplace
        .run("sweep list.json square.obj --resume --plan")
        .success();
    let plan: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(plan["of"], 3);
    assert_eq!(plan["inputs"], json!(["list.json", "square.obj"]));
    assert_eq!(plan["outputs"].as_array().map(Vec::len), Some(4));
    assert_eq!(plan["outputs"][3]["steps"], json!([2, 3]));
}

#[test]
fn joined_pictures_are_the_film_that_one_run_makes() {
    let workplace = Workplace::with_ball();
    let line = "render ball.json --size 32x18 --samples 1 --caption none --steps=-2..2/5";
    workplace.run(&format!("{line} -o frame.png")).success();
    let frames: Vec<_> = (0..5)
        .map(|step| format!("frame_step00{step}.png"))
        .collect();
    for film in ["film.gif", "film.png", "film.webp"] {
        workplace
            .run(&format!("{line} --fps 10 --no-loop --film {film}"))
            .success();
        let run = workplace.run(&format!(
            "join {} --fps 10 --no-loop -o joined-{film}",
            frames.join(" ")
        ));
        let run = run.success();
        assert!(run.stderr.contains("5 frames, 0.5 s"), "{run}");
        assert_eq!(
            workplace.read(&format!("joined-{film}")),
            workplace.read(film),
            "{film}"
        );
    }
    workplace
        .run("render ball.json --size 16x9 --samples 1 -o small.png")
        .success();
    for (words, expected) in [
        ("frame_step000.png -o x.gif", "two frames"),
        (
            "frame_step000.png small.png -o x.gif",
            "small.png: has 16x9 pixels, expected 32x18",
        ),
        ("frame_step000.png ball.json -o x.gif", "ball.json"),
        (
            "frame_step000.png frame_step001.png -o frame_step001.png",
            "overwrite",
        ),
        ("frame_step000.png none.png -o x.gif", "none.png"),
    ] {
        workplace.run(&format!("join {words}")).error(&[expected]);
    }
    assert!(!workplace.files().contains(&"x.gif".to_owned()));
}
