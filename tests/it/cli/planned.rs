//! Parts of pictures that take what is found by looking at all steps from a plan: `--planned`.

use std::fs;

use serde_json::Value;

use crate::common::command::Workplace;

/// Seven steps of a passage, small.
const PASS: &str = "--steps=-3..3/7 --size 32x18 --samples 1";

/// As bright as a screen can show, which depends on all steps.
const LIT: &str = r#"{ "observer": { "velocity": { "beta": 0.6, "direction": [1, 0, 0] } },
  "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1, "resolution": 8 } }, "position": [0, 3, 0] } ],
  "effects": { "searchlight": true, "exposure": "auto" }, "tolerance": { "relative": 0.1 } }"#;

fn planned(workplace: &Workplace, line: &str, file: &str) -> Value {
    let run = workplace.run(&format!("{line} --plan")).success();
    workplace.write(file, &run.stdout);
    serde_json::from_slice(&run.stdout).expect("JSON")
}

#[test]
fn a_part_with_a_plan_is_that_without() {
    let workplace = Workplace::with_ball();
    workplace.write("lit.json", LIT);
    for (line, has) in [
        ("render ball.json", "observer"),
        ("render ball.json --track", "observer"),
        ("render ball.json --look 0,1,0.3 --fov 70", "observer"),
        ("render ball.json --full-sky --size 32x16", "observer"),
        ("render lit.json", "exposure"),
        (
            "render lit.json --view outside --axes --scale-bar",
            "outside",
        ),
        ("render ball.json --view outside --from 2,3,20", "outside"),
        ("render square.obj --beta 0.9 --ghost rest", "observer"),
        (
            "render ball.json --beta 0.3,0.9 --models seen,rest",
            "observer",
        ),
        ("render lit.json --beta 0.3,0.9 --view outside", "outside"),
        (
            "render square.obj --beta 0.9 --method mesh --tolerance 1e-3 --max-triangles 900",
            "observer",
        ),
    ] {
        let size = if line.contains("--size") {
            "--steps=-3..3/7 --samples 1"
        } else {
            PASS
        };
        let line = format!("{line} {size}");
        let status = if line.contains("--max-triangles") {
            1
        } else {
            0
        };
        let plan = planned(&workplace, &line, "plan.json");
        let found = &plan["overview"]["found"];
        let is_empty = found[has].is_null() || found[has] == serde_json::json!([]);
        assert!(!is_empty, "{line}: {plan}");
        let run = workplace.run(&format!("{line} -o whole.png"));
        assert_eq!(run.status, status, "{run}");
        let run = workplace.run(&format!(
            "{line} -o part.png --only 2..4 --planned plan.json"
        ));
        assert_eq!(run.status, status, "{run}");
        for number in 0..7 {
            let [whole, part] = ["whole", "part"].map(|name| format!("{name}_step00{number}.png"));
            match (2..4).contains(&number) {
                true => assert_eq!(workplace.read(&part), workplace.read(&whole), "{line}"),
                false => assert!(!workplace.files().contains(&part), "{part}"),
            }
        }
        for name in workplace.files() {
            if name.ends_with(".png") {
                fs::remove_file(workplace.path(&name)).expect("a file");
            }
        }
    }
    // Frames of a film, and pictures with seals.
    let line = format!("render lit.json {PASS}");
    planned(&workplace, &format!("{line} --film film.gif"), "plan.json");
    workplace
        .run(&format!("{line} --film film.gif --only 2..4"))
        .success();
    workplace
        .run(&format!(
            "{line} --film part.gif --only 2..4 --planned plan.json"
        ))
        .success();
    assert_eq!(workplace.read("part.gif"), workplace.read("film.gif"));
    planned(&workplace, &format!("{line} --resume"), "plan.json");
    let line = format!("{line} --resume -o part.png --only 2..4");
    workplace
        .run(&format!("{line} --planned plan.json"))
        .success();
    let run = workplace.run(&line).success();
    assert!(run.stderr.contains("2 of them finished before"), "{run}");
}

/// Output, part and threads are no part of what a plan is of; all else is.
#[test]
fn a_plan_of_something_else_is_refused() {
    let workplace = Workplace::with_ball();
    workplace.write("lit.json", LIT);
    let line = format!("render lit.json {PASS}");
    planned(&workplace, &line, "plan.json");
    for same in [
        "-o other.png",
        "--only 3..4 -o a.png",
        "--threads 1 -q -o b.png",
    ] {
        workplace
            .run(&format!("{line} {same} --planned plan.json"))
            .success();
    }
    let another = [
        "--planned",
        "plan.json",
        "another scene",
        "other flags",
        "--plan",
    ];
    let refused = |line: &str, words: &[&str]| {
        let before = workplace.files();
        workplace
            .run(&format!(
                "{line} -o refused.png --only 2..4 --planned plan.json"
            ))
            .error(words);
        assert_eq!(workplace.files(), before);
    };
    for other in [
        "--beta 0.61",
        "--view outside",
        "--track",
        "--fov 40",
        "--background white",
        "--method mesh",
        "--exposure 0",
        "--models seen,rest",
    ] {
        refused(&format!("{line} {other}"), &another);
    }
    refused(
        "render lit.json --steps=-3..3/8 --size 32x18 --samples 1",
        &another,
    );
    refused(
        "render lit.json --steps=-3..3/7 --size 32x19 --samples 1",
        &another,
    );
    refused(&format!("render ball.json {PASS}"), &another);
    // The same words, another content.
    workplace.write("lit.json", LIT.replace("[0, 3, 0]", "[0, 3.5, 0]"));
    refused(&line, &another);
    let mesh = format!("render square.obj --beta 0.5 {PASS}");
    planned(&workplace, &mesh, "plan.json");
    let square = String::from_utf8(workplace.read("square.obj")).expect("text");
    workplace.write("square.obj", square.replace("-1 -1 0", "-1 -1.5 0"));
    refused(&mesh, &another);
    // Nothing to compare, and nothing that a part could take.
    workplace
        .run_with(
            "render - --beta 0.5 --planned plan.json",
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            &[],
        )
        .error(&["--planned", "stdin"]);
    workplace
        .run("render ball.json --sheet --planned plan.json")
        .error(&["--planned", "--sheet"]);
    workplace
        .run("render ball.json -o plan.json --planned plan.json")
        .error(&["plan.json"]);
}

#[test]
fn a_plan_that_is_damaged_is_refused() {
    let workplace = Workplace::with_ball();
    workplace.write("lit.json", LIT);
    let line = format!("render lit.json {PASS}");
    let plan = planned(&workplace, &line, "plan.json");
    let text = String::from_utf8(workplace.read("plan.json")).expect("text");
    let refused = |content: &str, words: &[&str]| {
        workplace.write("bad.json", content);
        let all = [&["--planned", "bad.json"], words].concat();
        workplace
            .run(&format!("{line} -o refused.png --planned bad.json"))
            .error(&all);
        assert!(
            !workplace
                .files()
                .iter()
                .any(|name| name.starts_with("refused"))
        );
    };
    refused("", &["is no plan", "EOF"]);
    refused(&text[..text.len() / 2], &["is no plan", "EOF"]);
    refused("[1, 2]", &["is no plan", "version"]);
    let version = env!("CARGO_PKG_VERSION");
    refused(&text.replace(version, "0.0.1"), &["version 0.0.1", version]);
    let exposure = plan["overview"]["found"]["exposure"]
        .as_f64()
        .expect("stops");
    let changed = |pointer: &str, value: Value| {
        let mut changed = plan.clone();
        *changed.pointer_mut(pointer).expect("it is there") = value;
        changed.to_string()
    };
    // The last digit.
    let near = f64::from_bits(exposure.to_bits() ^ 1);
    for (pointer, value) in [
        ("/overview/found/exposure", near.into()),
        ("/overview/found/observer/is_cut", true.into()),
        ("/overview/digest", "0".into()),
    ] {
        refused(&changed(pointer, value), &["is damaged", "as it was found"]);
    }
    refused(
        &changed("/overview/found/exposure", "bright".into()),
        &["is damaged", "bright"],
    );
    refused(
        &changed("/overview/found", serde_json::json!({ "more": 1 })),
        &["is damaged", "more"],
    );
    refused(
        &changed("/overview", Value::Null),
        &["without \"overview\""],
    );
    let files = workplace.run(&format!("{line} --plan=files")).success();
    refused(
        files.stdout_text(),
        &["without \"overview\"", "--plan=files"],
    );
    let export = workplace.run("export lit.json --plan").success();
    refused(export.stdout_text(), &["without \"overview\""]);
    workplace
        .run(&format!("{line} --planned none.json"))
        .error(&["--planned", "none.json"]);
    // Who shares the work out sends the version and the overview.
    let few = serde_json::json!({ "version": plan["version"], "overview": plan["overview"] });
    workplace.write("few.json", few.to_string());
    workplace
        .run(&format!("{line} -o few.png --planned few.json"))
        .success();
}
