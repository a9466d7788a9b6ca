//! What goes wrong outside the program: one error that names the place, the right exit status, what was there before as
//! it was, and nothing left over.

#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::Random;
use crate::common::command::{Run, Workplace, glb_json};

/// Everything in a directory.
fn contents(workplace: &Workplace) -> BTreeMap<String, Vec<u8>> {
    let files = workplace.files().into_iter();
    files
        .map(|file| (file.clone(), workplace.read(&file)))
        .collect()
}

/// There is one message, and it is an error.
#[track_caller]
fn one_error(run: Run, words: &[&str]) {
    let run = run.error(words);
    let lines: Vec<_> = run.stderr.lines().collect();
    assert_eq!(lines.len(), 1, "{run}");
    assert!(lines[0].starts_with("error: "), "{run}");
}

fn start(workplace: &Workplace, arguments: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_photosurface"))
        .args(arguments.split_whitespace())
        .current_dir(workplace.path(""))
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// So much work that it is not done before something happens.
const LONG: &str = "--example plane --steps=-6..6/100";

#[test]
fn a_full_disk_is_one_error_and_changes_nothing() {
    let workplace = Workplace::with_ball();
    for output in ["out.glb", "out.gltf", "out.ply", "report.json", "out.png"] {
        let command = match output {
            "report.json" => "export ball.json -q -o - --report report.json >/dev/null".to_owned(),
            "out.png" => "render ball.json -q --size 320x240 -o out.png".to_owned(),
            _ => format!("export ball.json -q --steps=0..1/40 --tolerance 1e-3 -o {output}"),
        };
        workplace.write(output, "what was there");
        let before = contents(&workplace);
        // No file may be larger than 512 bytes, and whoever writes more is told instead of killed.
        let line = format!("trap '' XFSZ; ulimit -f 1; exec photosurface {command}");
        one_error(workplace.run_shell(&line), &[output, "File too large"]);
        assert!(
            contents(&workplace) == before,
            "{output}: {:?}",
            workplace.files()
        );
    }
    // A device has no room at all.
    symlink("/dev/full", workplace.path("full.glb")).unwrap();
    let line = "export ball.json -q -o full.glb";
    one_error(workplace.run(line), &["full.glb", "No space left"]);
    assert!(workplace.path("full.glb").is_symlink());
}

#[test]
fn a_directory_that_may_not_be_written_to_is_named() {
    let workplace = Workplace::with_ball();
    let closed = workplace.path("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
    // Root may write anywhere, but for the kernel's own places.
    let is_root = fs::write(closed.join("probe"), "").is_ok();
    let place = if is_root { "/sys/kernel" } else { "closed" };
    for output in ["out.glb", "out.gltf", "out.ply"] {
        let run = workplace.run(&format!("export ball.json -q -o {place}/{output}"));
        one_error(run, &[&format!("{place}/{output}"), "denied"]);
    }
    let run = workplace.run(&format!(
        "export ball.json -q --report {place}/r.json -o a.glb"
    ));
    one_error(run, &["r.json", "denied"]);
    assert!(!workplace.path("a.glb").exists());
}

#[test]
fn a_directory_that_vanishes_is_one_error() {
    for output in ["out.glb", "out.gltf"] {
        let workplace = Workplace::new();
        let directory = workplace.path("gone");
        fs::create_dir(&directory).unwrap();
        let child = start(&workplace, &format!("export -q {LONG} -o gone/{output}"));
        let has_begun = || fs::read_dir(&directory).unwrap().count() > 0;
        while !has_begun() {
            sleep(Duration::from_millis(1));
        }
        while fs::remove_dir_all(&directory).is_err() {}
        let ended = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{text}");
        assert!(
            text.starts_with("error: ") && text.contains(output),
            "{text}"
        );
        assert_eq!(text.lines().count(), 1, "{text}");
        assert_eq!(workplace.files(), [""; 0]);
    }
}

#[test]
fn what_cannot_be_read_to_its_end_is_named() {
    let workplace = Workplace::with_ball();
    // It opens like a file, and every read fails.
    symlink("/proc/self/mem", workplace.path("bad.obj")).unwrap();
    symlink("/proc/self/mem", workplace.path("bad.json")).unwrap();
    symlink("/proc/self/mem", workplace.path("bad.glb")).unwrap();
    workplace.write(
        "scene.json",
        r#"{ "objects": [ { "name": "a", "file": "bad.obj" } ] }"#,
    );
    let before = workplace.files();
    for input in ["bad.obj", "bad.json", "bad.glb", "scene.json"] {
        let run = workplace.run(&format!("export {input} -o out.glb"));
        let named = if input == "scene.json" {
            "bad.obj"
        } else {
            input
        };
        one_error(run, &[named]);
    }
    // A directory opens too.
    one_error(
        workplace.run_shell("photosurface export - -o out.glb <."),
        &["stdin", "directory"],
    );
    assert_eq!(workplace.files(), before);
}

#[test]
fn a_signal_at_any_moment_leaves_all_or_nothing() {
    let mut random = Random::new(20);
    let mut stopped = 0;
    for turn in 0..24 {
        let workplace = Workplace::new();
        let (output, signal) = match turn % 4 {
            0 => ("out.glb", "INT"),
            1 => ("out.gltf", "TERM"),
            2 => ("out.gltf", "INT"),
            _ => ("out.ply", "TERM"),
        };
        workplace.write(output, "{}");
        let line = format!("export -q --steps=-6..6/150 -o {output}");
        let mut child = start(&workplace, &line);
        sleep(Duration::from_secs_f64(random.between(0.0, 0.5)));
        let pid = child.id().to_string();
        // It may be done already.
        let _ = Command::new("kill").args(["-s", signal, &pid]).status();
        let status = child.wait().unwrap();
        let files = workplace.files();
        let is_new = workplace.read(output) != b"{}";
        match status.code() {
            Some(0) => assert!(is_new, "{line}"),
            // Before it can answer a signal, the system does.
            Some(130) | None => stopped += 1,
            other => panic!("{line}: {other:?}"),
        }
        match (output, is_new) {
            ("out.gltf", true) => check_pair(&workplace),
            _ => assert_eq!(files, [output], "{signal}"),
        }
    }
    assert!(stopped > 0, "no signal came in time");
}

/// A `.gltf` and its data, and nothing else.
#[track_caller]
fn check_pair(workplace: &Workplace) {
    let json = workplace.read_json("out.gltf");
    let buffer = &json["buffers"][0];
    let data = buffer["uri"].as_str().expect("a name");
    let files = workplace.files().into_iter();
    let inputs = ["ball.json", "square.obj"];
    let files: Vec<_> = files.filter(|file| !inputs.contains(&&**file)).collect();
    assert_eq!(files, [data, "out.gltf"]);
    let length = workplace.read(data).len();
    assert_eq!(Some(length as u64), buffer["byteLength"].as_u64());
}

#[test]
fn two_writers_of_one_gltf_never_mix() {
    let betas = ["0.5", "0.6"];
    let line = |beta: &str| format!("export ball.json -q --beta {beta} --steps 0,1 -o out.gltf");
    let alone = betas.map(|beta| {
        let workplace = Workplace::with_ball();
        workplace.run(&line(beta)).success();
        check_pair(&workplace);
        contents(&workplace)
    });
    assert!(alone[0] != alone[1]);
    let workplace = Workplace::with_ball();
    let mut last = [0, 0];
    for _ in 0..40 {
        let children = betas.map(|beta| start(&workplace, &line(beta)));
        for child in children {
            let ended = child.wait_with_output().unwrap();
            assert!(ended.status.success(), "{ended:?}");
        }
        let both = contents(&workplace);
        let which = alone.iter().position(|alone| *alone == both);
        last[which.unwrap_or_else(|| panic!("mixed: {:?}", workplace.files()))] += 1;
    }
    assert_eq!(last[0] + last[1], 40);
}

#[test]
fn a_closed_stdout_is_an_error_where_something_was_to_go_there() {
    let workplace = Workplace::with_ball();
    let before = workplace.files();
    for command in [
        "export ball.json -o -",
        "export ball.json -o out.glb --report -",
        "render ball.json --size 16x12 -o -",
        "schema",
        "example sphere",
        "--help",
        "-h",
        "--version",
        "help cost",
        "export --help",
    ] {
        let run = workplace.run_shell(&format!("photosurface {command} >&-"));
        one_error(run, &["stdout", "closed"]);
        assert_eq!(workplace.files(), before, "{command}");
    }
    // What is thrown away on purpose is no error.
    let run = workplace.run_shell("photosurface export ball.json -o - >/dev/null");
    assert_eq!(run.status, 0, "{run}");
    let run = workplace.run_shell("photosurface check ball.json >&-");
    assert_eq!(run.status, 0, "{run}");
}

#[test]
fn a_place_for_temporary_files_that_fails_is_not_called_stdout() {
    let workplace = Workplace::with_ball();
    // So many steps that their JSON does not wait in memory.
    let line = "export ball.json -q --steps=0..1/300 -o -";
    let run = workplace.run_with(line, b"", &[("TMPDIR", "/nowhere/at/all")]);
    assert!(!run.stderr.contains("stdout"), "{run}");
    one_error(
        run,
        &["a temporary file in /nowhere/at/all", "No such file"],
    );
}

#[test]
fn who_may_read_a_file_may_read_what_replaces_it_and_nobody_else() {
    let workplace = Workplace::with_ball();
    let mode = |name: &str| {
        fs::metadata(workplace.path(name))
            .unwrap()
            .permissions()
            .mode()
    };
    for (output, others) in [("a.glb", 0o600), ("a.gltf", 0o640), ("a.ply", 0o604)] {
        workplace.write(output, "{}");
        let mine = fs::Permissions::from_mode(others);
        fs::set_permissions(workplace.path(output), mine).unwrap();
        workplace
            .run(&format!("export ball.json -o {output}"))
            .success();
        assert_eq!(mode(output) & 0o7777, others, "{output}");
    }
    let json = workplace.read_json("a.gltf");
    let data = json["buffers"][0]["uri"].as_str().unwrap();
    assert_eq!(mode(data) & 0o7777, 0o640, "the data is as private");
    workplace
        .run_shell("umask 027; photosurface export ball.json -o new.glb")
        .success();
    assert_eq!(mode("new.glb") & 0o7777, 0o640);
}

#[test]
fn the_data_of_a_gltf_that_is_replaced_does_not_stay() {
    let workplace = Workplace::with_ball();
    for beta in ["0.3", "0.4", "0.5", "0.5"] {
        workplace
            .run(&format!("export ball.json --beta {beta} -o out.gltf"))
            .success();
        let bins = workplace.files().into_iter();
        let bins: Vec<_> = bins.filter(|file| file.ends_with(".bin")).collect();
        let json = workplace.read_json("out.gltf");
        assert_eq!(bins, [json["buffers"][0]["uri"].as_str().unwrap()]);
    }
    // What is not named as ours is nobody's to remove.
    workplace.write("other.bin", "precious");
    workplace.write("out.gltf", r#"{ "buffers": [ { "uri": "other.bin" } ] }"#);
    workplace.run("export ball.json -o out.gltf").success();
    assert_eq!(workplace.read("other.bin"), b"precious");
}

#[test]
fn texts_of_files_are_shown_and_never_obeyed() {
    let workplace = Workplace::new();
    let forged = r"a\u001b[2J\u001b]0;x\u0007\r\nnote: forged\u009b31m";
    workplace.write(
        "scene.json",
        format!(
            r#"{{ "objects": [ {{ "name": "{forged}", "shape": {{ "sphere": {{ "radius": 1 }} }}, "position": [0, 0, -5] }} ] }}"#
        ),
    );
    workplace.write(
        "library.obj",
        "mtllib a\u{1b}[2Jb.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \u{1b}[31mred\nf 1 2 3\n",
    );
    workplace.write(
        "bad.obj",
        "v 0 0 0\nv 1 0 0\u{1b}[2J\nv 0 1 x\u{1b}]0;y\u{7}\nf 1 2 3\n",
    );
    let long = "x".repeat(1 << 20);
    workplace.write("long.obj", format!("v {long} 0 0\nf 1 1 1\n"));
    let glb = format!("{}\u{1b}[31m.glb", "a");
    for line in [
        "export scene.json -v -o out.glb",
        "export scene.json -v -o no/out.glb",
        "check scene.json -v",
        "export library.obj -v -o out.glb",
        "export bad.obj -o out.glb",
        "export long.obj -o out.glb",
        &format!("export {glb}"),
    ] {
        let run = workplace.run(line);
        for stream in [&*run.stderr, run.stdout_text()] {
            let acts = |c: char| c.is_control() && c != '\n';
            assert!(!stream.contains(acts), "{line}: {stream:?}");
            assert!(
                !stream.lines().any(|l| l.starts_with("note: forged")),
                "{run}"
            );
            assert!(stream.len() < 20_000, "{line}: {} bytes", stream.len());
        }
    }
    workplace.run("export scene.json -q -o out.glb").success();
    let name = glb_json(&workplace.read("out.glb"))["nodes"][0]["name"].clone();
    assert!(!name.as_str().unwrap().contains(char::is_control), "{name}");
}

#[test]
fn names_of_every_script_are_kept_in_files() {
    let workplace = Workplace::new();
    workplace.write(
        "parts.obj",
        "o 轮子\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no 车身.1\nv 1 1 0\nf 2 4 3\n",
    );
    workplace.write(
        "scene.json",
        r#"{ "objects": [ { "name": "ящик", "file": "parts.obj" }, { "name": "коло", "file": "parts.obj", "position": [2, 0, 0] } ] }"#,
    );
    let run = workplace.run("export scene.json -o out.glb").success();
    let json = glb_json(&workplace.read("out.glb"));
    let names: Vec<_> = json["nodes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n["name"].clone())
        .collect();
    assert_eq!(
        names,
        ["ящик_轮子", "ящик_车身_1", "коло_轮子", "коло_车身_1"]
    );
    let meshes = json["meshes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|m| m["name"].clone());
    assert_eq!(meshes.collect::<Vec<_>>(), names);
    assert_eq!(
        json["nodes"][1]["extras"]["part"], "车身.1",
        "as the source has it"
    );
    assert!(
        run.stderr.contains("note: out.glb: names changed, because")
            && run
                .stderr
                .contains("\"ящик_车身.1\" became \"ящик_车身_1\", and 1 name more"),
        "{run}"
    );
}

#[test]
fn doubles_of_a_ply_hold_what_no_single_does() {
    let workplace = Workplace::with_ball();
    for (rapidity, kind) in [("20", "float"), ("100", "double"), ("300", "double")] {
        let run = workplace.run(&format!(
            "export ball.json --rapidity {rapidity} --attributes doppler,emission_time --tolerance 0.3 --max-triangles 4000 -o out.ply --report r.json"
        ));
        assert!(run.status < 2, "{run}");
        let ply = workplace.read("out.ply");
        let text = String::from_utf8_lossy(&ply[..600]);
        assert!(
            text.contains(&format!("property {kind} quality\n")),
            "{text}"
        );
        let report = String::from_utf8(workplace.read("r.json")).unwrap();
        assert!(!report.contains("null"), "{report}");
    }
    // In glTF there are none.
    one_error(
        workplace.run("export ball.json --rapidity 100 -q -o out.glb"),
        &["out.glb", "smaller rapidity"],
    );
}

#[test]
fn no_number_of_a_report_is_null() {
    let workplace = Workplace::with_ball();
    let begun = Instant::now();
    for (input, flags) in [
        ("square.obj", "--beta 0.9 --tolerance abs:1e-300"),
        ("square.obj", "--rapidity 20 --tolerance abs:5e-324"),
        ("square.obj", "--beta 0.9 --tolerance abs:1e300"),
        ("square.obj", "--beta 0 --tolerance 1e-3"),
        ("square.obj", "--rapidity 300 --tolerance deg:1e-9"),
        ("ball.json", "--beta 0.9 --tolerance abs:1e-200"),
    ] {
        let run = workplace.run(&format!(
            "export {input} {flags} --no-subdivide -o out.ply --report r.json"
        ));
        assert!(run.status < 2, "{run}");
        let report = String::from_utf8(workplace.read("r.json")).unwrap();
        assert!(!report.contains("null"), "{flags}: {report}");
    }
    assert!(begun.elapsed() < Duration::from_secs(60));
}

/// The meshes that a study makes are among the system's temporary files, in a folder that goes with the program.
#[test]
fn a_study_that_is_interrupted_leaves_no_folder() {
    for signal in ["INT", "TERM"] {
        let workplace = Workplace::with_ball();
        let before = workplace.files();
        let status = workplace.interrupt(
            "cost ball.json --only meshes --tolerances 1e-6 --repeats 1000",
            signal,
            |files| files.iter().any(|file| file.starts_with(".photosurface-")),
        );
        assert_eq!(status, Some(130), "{signal}");
        assert_eq!(workplace.files(), before, "{signal}");
    }
}
