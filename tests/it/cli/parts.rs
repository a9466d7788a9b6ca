//! Work that is done in parts: `--only`, `--resume`, `--progress json`, `--plan`.

use std::fs;

use serde_json::Value;

use crate::common::command::{Workplace, glb_json, node_names};

const STEPS: &str = "--steps=-2..2/5";

/// The lines of `--progress json`.
fn lines(stderr: &str) -> Vec<Value> {
    let lines = stderr.lines().filter(|line| line.starts_with('{'));
    lines
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect()
}

#[test]
fn a_part_of_an_export_is_that_of_the_whole() {
    let workplace = Workplace::with_ball();
    // A budget that the tolerance needs more than: it is shared out among all steps, whichever are written.
    for (extension, flags, status) in [
        ("glb", "", 0),
        ("gltf", "--no-subdivide --max-triangles 9", 0),
        ("ply", "--tolerance 1e-3 --max-triangles 900", 1),
        ("glb", "--camera --track", 0),
        ("glb", "--models seen,rest", 0),
    ] {
        let line = format!("export ball.json {STEPS} {flags} --split");
        let run = workplace.run(&format!("{line} -o whole.{extension}"));
        assert_eq!(run.status, status, "{run}");
        let run = workplace.run(&format!("{line} -o part.{extension} --only 1..3"));
        assert_eq!(run.status, status, "{run}");
        for number in 0..5 {
            let [whole, part] =
                ["whole", "part"].map(|name| format!("{name}_step00{number}.{extension}"));
            match (1..3).contains(&number) {
                // The data of a .gltf has a name of its own.
                true if extension == "gltf" => assert!(workplace.files().contains(&part)),
                true => assert_eq!(workplace.read(&part), workplace.read(&whole), "{flags}"),
                false => assert!(!workplace.files().contains(&part), "{part}"),
            }
        }
        for name in workplace.files() {
            if name.starts_with("whole") || name.starts_with("part") {
                fs::remove_file(workplace.path(&name)).expect("a file");
            }
        }
    }
    // One file of some steps; their names are those of the whole.
    let line = format!("export ball.json {STEPS}");
    workplace
        .run(&format!("{line} -o some.glb --only 1..3"))
        .success();
    let names = node_names(&workplace.read("some.glb"));
    assert_eq!(names, ["ball_step001", "ball_step002"]);
    workplace
        .run(&format!("{line} -o one.glb --only 4..5"))
        .success();
    assert_eq!(node_names(&workplace.read("one.glb")), ["ball_step004"]);
    workplace
        .run(&format!("{line} --only 4..6"))
        .error(&["--only is 4..6", "5 steps"]);
    workplace
        .run(&format!("{line} --only 1..3 --animate"))
        .error(&["--only", "--animate"]);
    workplace
        .run(&format!("{line} --only 3..3"))
        .error(&["expected A..B"]);
}

#[test]
fn finished_files_stay_and_others_are_made_anew() {
    let workplace = Workplace::with_ball();
    for (command, extension) in [
        ("export ball.json --split", "glb"),
        ("export ball.json --split", "gltf"),
        ("export ball.json --split", "ply"),
        ("render ball.json --size 32x18 --samples 1", "png"),
    ] {
        let line = format!("{command} {STEPS} --progress json -o out.{extension}");
        let plain = workplace.run(&line).success();
        assert!(
            lines(&plain.stderr)
                .iter()
                .all(|line| line["resumed"] == false)
        );
        // Without --resume nothing is sealed, and what is not sealed is not known to be finished.
        let run = workplace.run(&format!("{line} --resume")).success();
        let resumed = |stderr: &str| -> Vec<u64> {
            let lines = lines(stderr).into_iter();
            let resumed = lines.filter(|line| line["resumed"] == true);
            resumed.map(|line| line["step"].as_u64().unwrap()).collect()
        };
        assert_eq!(resumed(&run.stderr), [0_u64; 0], "{run}");
        let name = |step: usize| format!("out_step00{step}.{extension}");
        let whole: Vec<_> = (0..5).map(|step| workplace.read(&name(step))).collect();
        let run = workplace.run(&format!("{line} --resume")).success();
        assert_eq!(resumed(&run.stderr), [0, 1, 2, 3, 4], "{run}");
        assert!(run.stderr.contains("finished before"), "{run}");

        // One is gone, one was copied half-way, one has another byte, one is that of another step.
        fs::remove_file(workplace.path(&name(0))).expect("a file");
        workplace.write(&name(1), &whole[1][..whole[1].len() / 2]);
        let mut changed = whole[2].clone();
        let middle = changed.len() / 2;
        changed[middle] ^= 1;
        workplace.write(&name(2), changed);
        workplace.write(&name(3), &whole[4]);
        let run = workplace.run(&format!("{line} --resume")).success();
        assert_eq!(resumed(&run.stderr), [4], "{run}");
        for (step, whole) in whole.iter().enumerate() {
            assert_eq!(&workplace.read(&name(step)), whole, "{}", name(step));
        }
        // Another flag, another scene, another part.
        let run = workplace
            .run(&format!("{line} --resume --beta 0.5"))
            .success();
        assert_eq!(resumed(&run.stderr), [0_u64; 0], "{run}");
        let run = workplace
            .run(&format!("{line} --resume --only 2..4"))
            .success();
        assert_eq!(resumed(&run.stderr), [0_u64; 0], "{run}");
        let run = workplace
            .run(&format!("{line} --resume --only 1..3"))
            .success();
        assert_eq!(resumed(&run.stderr), [2], "{run}");
        for name in workplace.files() {
            if name.starts_with("out") {
                fs::remove_file(workplace.path(&name)).expect("a file");
            }
        }
    }
}

#[test]
fn files_that_the_scene_names_count() {
    let workplace = Workplace::with_ball();
    let line = "export square.obj --beta 0.5 -o out.glb --resume";
    workplace.run(line).success();
    assert!(
        workplace
            .run(line)
            .success()
            .stderr
            .contains("was finished before")
    );
    let square = String::from_utf8(workplace.read("square.obj")).expect("text");
    workplace.write("square.obj", square.replace("-1 -1 0", "-1 -1.5 0"));
    let run = workplace.run(line).success();
    assert!(!run.stderr.contains("finished before"), "{run}");
    // A scene that says the same in other letters is the same.
    let line = "export ball.json -o ball.glb --resume";
    workplace.run(line).success();
    let ball = String::from_utf8(workplace.read("ball.json")).expect("text");
    workplace.write("ball.json", ball.replace(": ", " :  "));
    assert!(
        workplace
            .run(line)
            .success()
            .stderr
            .contains("was finished before")
    );
    workplace.write("ball.json", ball.replace("0.6", "0.7"));
    assert!(
        !workplace
            .run(line)
            .success()
            .stderr
            .contains("finished before")
    );
    // A mesh from stdin has no file that could be compared, and stdout holds no finished file.
    workplace
        .run_with(
            "export - --beta 0.5 --resume",
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            &[],
        )
        .error(&["--resume", "stdin"]);
    workplace
        .run("export ball.json -o - --resume")
        .error(&["--resume", "stdout"]);
}

#[test]
fn what_is_not_certified_stays_so() {
    let workplace = Workplace::with_ball();
    let line = "export square.obj --beta 0.9 --steps 0,1 --tolerance 1e-9 --max-triangles 9 -o out.glb --resume";
    for _ in 0..2 {
        let run = workplace.run(&format!("{line} --progress json"));
        assert_eq!(run.status, 1, "{run}");
        let last = lines(&run.stderr).pop().expect("a line");
        assert_eq!(last["certified"], false, "{run}");
    }
    assert_eq!(workplace.run(line).status, 1);
}

#[test]
fn a_file_is_finished_only_with_its_report() {
    let workplace = Workplace::with_ball();
    let line = "export ball.json -o out.glb --report report.json --no-times --resume";
    workplace.run(line).success();
    let report = workplace.read("report.json");
    let run = workplace.run(line).success();
    assert!(run.stderr.contains("was finished before"), "{run}");
    assert_eq!(workplace.read("report.json"), report);
    workplace.write("report.json", &report[..report.len() - 9]);
    let run = workplace.run(line).success();
    assert!(!run.stderr.contains("finished before"), "{run}");
    assert_eq!(workplace.read("report.json"), report);
    // A report of several files names those that it does not describe.
    let line = format!("{line} --split {STEPS}");
    workplace.run(&line).success();
    fs::remove_file(workplace.path("out_step003.glb")).expect("a file");
    workplace.run(&line).success();
    let report = workplace.read_json("report.json");
    assert_eq!(report["resumed"].as_array().map(Vec::len), Some(4));
    assert_eq!(report["objects"].as_array().map(Vec::len), Some(1));
    assert_eq!(report["objects"][0]["step"], 3);
}

#[test]
fn progress_is_told_in_lines_that_programs_read() {
    let workplace = Workplace::with_ball();
    let run = workplace.run(&format!(
        "export ball.json {STEPS} -o out.glb --progress json -q"
    ));
    let told = lines(&run.success().stderr);
    // Each step, then the file that they are in.
    let steps: Vec<_> = told
        .iter()
        .map(|line| (line["step"].as_u64(), line["steps"].as_u64()))
        .collect();
    let one = |step| (Some(step), Some(1));
    assert_eq!(
        steps,
        [one(0), one(1), one(2), one(3), one(4), (Some(0), Some(5))]
    );
    let file = &told[5];
    assert_eq!(file["file"], "out.glb");
    assert_eq!(file["bytes"], workplace.read("out.glb").len());
    assert_eq!(file["of"], 5);
    assert_eq!(file["certified"], true);
    assert!(told[..5].iter().all(|line| line["file"].is_null()));
    let pictures = "render ball.json --size 32x18 --samples 1 --progress json --only 1..3";
    let run = workplace
        .run(&format!("{pictures} {STEPS} -o out.png"))
        .success();
    let told = lines(&run.stderr);
    assert_eq!(told.len(), 2, "{run}");
    assert_eq!(told[1]["file"], "out_step002.png");
    assert_eq!(told[1]["step"], 2);
    assert_eq!(told[1]["bytes"], workplace.read("out_step002.png").len());
    let run = workplace
        .run(&format!("{pictures} {STEPS} --film out.gif"))
        .success();
    let told = lines(&run.stderr);
    assert_eq!(told.len(), 3, "{run}");
    assert_eq!(told[2]["file"], "out.gif");
    assert_eq!(told[2]["bytes"], workplace.read("out.gif").len());
}

#[test]
fn a_plan_says_what_there_is_to_do_and_makes_nothing() {
    let workplace = Workplace::with_ball();
    let line = format!("export square.obj --beta 0.5 {STEPS} --split -o out.glb --resume");
    let plan = |line: &str| -> Value {
        let run = workplace.run(&format!("{line} --plan")).success();
        serde_json::from_slice(&run.stdout).expect("JSON")
    };
    let before = workplace.files();
    let planned = plan(&line);
    assert_eq!(workplace.files(), before);
    assert_eq!(planned["of"], 5);
    assert_eq!(planned["inputs"][0], "square.obj");
    assert_eq!(planned["outputs"][4]["file"], "out_step004.glb");
    assert_eq!(planned["outputs"][4]["steps"], serde_json::json!([4, 5]));
    let finished = |plan: &Value| -> Vec<bool> {
        let outputs = plan["outputs"].as_array().expect("outputs");
        let each = outputs
            .iter()
            .map(|output| output["finished"].as_bool().unwrap());
        each.collect()
    };
    assert_eq!(finished(&planned), [false; 5]);
    workplace.run(&format!("{line} --only 1..3")).success();
    assert_eq!(finished(&plan(&line)), [false, true, true, false, false]);
    let planned = plan("render ball.json --size 32x18 -o out.png");
    assert_eq!(planned["outputs"][0]["file"], "out.png");
}

/// The seal is all that `--resume` adds.
#[test]
fn sealed_files_are_the_same_beside_their_seal() {
    let workplace = Workplace::with_ball();
    workplace.run("export ball.json -o plain.glb").success();
    workplace
        .run("export ball.json -o sealed.glb --resume")
        .success();
    let plain = glb_json(&workplace.read("plain.glb"));
    let mut sealed = glb_json(&workplace.read("sealed.glb"));
    let extras = sealed["scenes"][0]["extras"]
        .as_object_mut()
        .expect("extras");
    let seal = extras.remove("seal").expect("a seal");
    assert!(
        seal.as_str()
            .is_some_and(|seal| seal.starts_with("photosurface-seal:"))
    );
    assert_eq!(sealed, plain);
    let picture = "render ball.json --size 32x18 --samples 1";
    workplace.run(&format!("{picture} -o plain.png")).success();
    workplace
        .run(&format!("{picture} -o sealed.png --resume"))
        .success();
    let pixels = |name: &str| {
        image::open(workplace.path(name))
            .expect("a picture")
            .to_rgb8()
    };
    assert_eq!(pixels("plain.png"), pixels("sealed.png"));
    assert_ne!(workplace.read("plain.png"), workplace.read("sealed.png"));
}

#[test]
fn no_limit_gives_the_bytes_of_a_limit_that_is_not_reached() {
    let workplace = Workplace::with_ball();
    let line = format!("export square.obj --beta 0.9 {STEPS}");
    workplace.run(&format!("{line} -o limited.glb")).success();
    let run = workplace.run(&format!("{line} --max-triangles none -v -o free.glb"));
    let run = run.success();
    assert_eq!(workplace.read("free.glb"), workplace.read("limited.glb"));
    assert!(!run.stderr.contains("about"), "{run}");
    let line =
        format!("render square.obj --beta 0.9 {STEPS} --size 32x18 --samples 1 --method mesh");
    workplace.run(&format!("{line} -o limited.png")).success();
    workplace
        .run(&format!("{line} --max-triangles none -o free.png"))
        .success();
    assert_eq!(
        workplace.read("free_step002.png"),
        workplace.read("limited_step002.png")
    );
}
