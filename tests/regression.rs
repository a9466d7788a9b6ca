//! One test for each bug that was found, with its story.

mod common;

use common::command::Workplace;

/// The header of a PNG, which is all of it that is looked at.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Only the file on the command line and those of the objects were protected: exporting `Cameras.gltf` to
/// `simpleSquare.gltf` replaced `simpleSquare.bin`, which held the source's own data, and a report could
/// replace a material library or a texture.
#[test]
fn what_a_source_refers_to_is_not_written_over() {
    let workplace = Workplace::new();
    let mesh = "o a\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n";
    workplace.write("a.obj", mesh);
    workplace.write("a.mtl", "newmtl red\nmap_Kd red.png\n");
    workplace.write("red.png", PNG);
    workplace.run("export a.obj -o source.gltf").success();
    let gltf = workplace.read("source.gltf");
    std::fs::rename(workplace.path("source.bin"), workplace.path("data.bin")).unwrap();
    let gltf = String::from_utf8(gltf).unwrap();
    workplace.write("source.gltf", gltf.replace("source.bin", "data.bin"));
    workplace.write(
        "scene.json",
        r#"{ "objects": [ { "name": "a", "file": "source.gltf" }, { "name": "b", "file": "a.obj" } ] }"#,
    );
    let files = workplace.files();
    let before: Vec<_> = files.iter().map(|file| workplace.read(file)).collect();
    for (input, output) in [
        ("source.gltf", "-o data.gltf"),
        ("source.gltf", "-o out.glb --report data.bin"),
        ("a.obj", "-o out.glb --report a.mtl"),
        ("a.obj", "-o out.glb --report ./red.png"),
        ("scene.json", "-o data.gltf"),
        ("scene.json", "-o out.glb --report a.mtl"),
        ("scene.json", "-o out.glb --report red.png"),
    ] {
        workplace
            .run(&format!("export {input} {output}"))
            .error(&["would be written over what is read"]);
    }
    assert_eq!(workplace.files(), files);
    for (file, before) in files.iter().zip(before) {
        assert_eq!(workplace.read(file), before, "{file}");
    }
}

/// `eprintln!` panics where stderr cannot be written, so that a full disk turned every exit status into 101.
#[cfg(target_os = "linux")]
#[test]
fn a_stderr_that_is_full_changes_no_exit_status() {
    let workplace = Workplace::new();
    let run = workplace.run_shell("photosurface export -v 2>/dev/full");
    assert_eq!(run.status, 0, "{run}");
    let run = workplace.run_shell("photosurface export nosuch.json 2>/dev/full");
    assert_eq!(run.status, 2, "{run}");
    let run = workplace.run_shell("photosurface export --nonsense 2>/dev/full");
    assert_eq!(run.status, 2, "{run}");
}

/// A stdout that could not be written was an error without a name, and none at all where what was left in
/// the buffer was lost.
#[cfg(target_os = "linux")]
#[test]
fn a_stdout_that_is_full_is_named() {
    let workplace = Workplace::new();
    for command in ["schema", "example", "example cube", "check", "export -o -"] {
        workplace
            .run_shell(&format!("photosurface {command} >/dev/full"))
            .error(&["error: stdout: ", "No space left"]);
    }
    workplace
        .run_shell("photosurface export --report - >/dev/full")
        .error(&["stdout", "No space left"]);
}

/// Ctrl-C left `.photosurface-XXXXXX` behind, half written.
#[cfg(unix)]
#[test]
fn an_interrupted_export_leaves_no_file_behind() {
    use std::process::{Command, Stdio};
    for signal in ["INT", "TERM"] {
        let workplace = Workplace::new();
        // Enough work that the signal comes in its midst, in files that are each begun soon.
        let mut child = Command::new(env!("CARGO_BIN_EXE_photosurface"))
            .args(["export", "--steps=-6..6/4000", "--split", "-o", "out.glb"])
            .current_dir(workplace.path(""))
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while workplace.files().len() < 3 {
            assert_eq!(
                child.try_wait().unwrap(),
                None,
                "it ended before the signal"
            );
            std::thread::yield_now();
        }
        let pid = child.id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &pid]).status();
        assert!(sent.unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        let files = workplace.files();
        assert!(files.len() < 4000, "it was done before the signal");
        for file in files {
            assert!(file.starts_with("out_step"), "{signal}: {file}");
            let bytes = workplace.read(&file);
            let length = u32::from_le_bytes(bytes[8..12].try_into().unwrap());
            assert_eq!(bytes.len(), length as usize, "{file} is whole");
        }
    }
}
