//! `photosurface render --film` as users run it; ffmpeg, good and bad.

use std::fs;

use crate::common::command::Workplace;

/// Number of frames of an APNG, as its `acTL` says.
fn frame_count(apng: &[u8]) -> u32 {
    let place = apng.windows(4).position(|word| word == b"acTL");
    let place = place.expect("an animation") + 4;
    u32::from_be_bytes(apng[place..place + 4].try_into().unwrap())
}

/// A scene of two steps, at which a ball is at different places.
const PASSING: &str = r#"{ "observer": { "velocity": { "beta": 0.6, "direction": [1, 0, 0] } }, "steps": [-2, 1, 2],
  "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1, "resolution": 8 } }, "position": [0, 3, 0] } ],
  "tolerance": { "relative": 0.1 } }"#;

#[test]
fn a_film_goes_from_the_first_step_to_the_last() {
    let workplace = Workplace::new();
    workplace.write("scene.json", PASSING);
    let run = workplace.run("render scene.json --size 32x18 --fps 10 --seconds 1.2 --film out.png");
    let run = run.success();
    assert!(run.stderr.contains("out.png: 12 frames"), "{run}");
    let film = workplace.read("out.png");
    assert_eq!(frame_count(&film), 12);
    workplace
        .run("render scene.json --size 32x18 --film default.apng")
        .success();
    assert_eq!(frame_count(&workplace.read("default.apng")), 200);
    // With steps of their own there are exactly these; the first frame of an APNG is a picture like any other.
    let own = "render scene.json --size 32x18 --caption none --steps=2,-2,0";
    workplace.run(&format!("{own} --film=-own.png")).success();
    let film = workplace.read("-own.png");
    assert_eq!(frame_count(&film), 3);
    workplace.run(&format!("{own} -o own.png")).success();
    let pixels = |name: &str| {
        let picture = image::load_from_memory(&workplace.read(name));
        picture.expect("a picture").to_rgb8()
    };
    assert_eq!(pixels("-own.png"), pixels("own_step000.png"));
    // As bytes to stdout.
    let run = workplace.run(&format!("{own} --film -")).success();
    assert_eq!(run.stdout, film);
    assert_eq!(workplace.files().len(), 7, "{:?}", workplace.files());
}

#[test]
fn models_side_by_side_and_views_from_outside_make_films() {
    let workplace = Workplace::new();
    workplace.write("scene.json", PASSING);
    for (flags, size) in [
        ("--view outside --axes", [32, 18]),
        ("--models seen,rest", [68, 18]),
        ("--fov 70 --method mesh", [32, 18]),
    ] {
        let line =
            format!("render scene.json --size 32x18 --fps 2 --seconds 2 {flags} --film a.gif");
        workplace.run(&line).success();
        let film = workplace.read("a.gif");
        let size = size.map(|side: u16| side.to_le_bytes()).concat();
        assert_eq!(&film[6..10], size, "{flags}");
        assert!(film.windows(11).any(|word| word == b"NETSCAPE2.0"));
    }
    let line = "render scene.json --size 32x18 --fps 2 --seconds 2 --no-loop --film a.gif";
    workplace.run(line).success();
    let film = workplace.read("a.gif");
    assert!(!film.windows(11).any(|word| word == b"NETSCAPE2.0"));
}

#[test]
fn films_that_make_no_sense_are_refused_before_any_work() {
    let workplace = Workplace::with_ball();
    workplace.write("scene.json", PASSING);
    let before = workplace.files();
    for (flags, words) in [
        (
            "--film a.mov",
            vec!["a.mov", ".gif, .png (APNG), .webp or .mp4"],
        ),
        (
            "--film film",
            vec!["film", ".gif, .png (APNG), .webp or .mp4"],
        ),
        ("--film a.gif --fps 0", vec!["--fps", "from 1 to 120"]),
        ("--film a.gif --fps nan", vec!["--fps", "not finite"]),
        ("--film a.webp --fps 1e9", vec!["--fps", "from 1 to 120"]),
        ("--film a.gif --fps 60", vec!["--fps", "60", "at most 50"]),
        (
            "--film a.gif --seconds -1",
            vec!["--seconds", "at least two frames"],
        ),
        ("--film a.gif --seconds 1e9", vec!["--seconds", "100000"]),
        (
            "--film a.gif --seconds 3 --steps 0,1",
            vec!["--seconds", "--steps"],
        ),
        ("--film a.gif --steps 1", vec!["--film", "one step"]),
        ("--film a.gif -o a.png", vec!["--film", "--output"]),
        ("--film a.gif --sheet", vec!["--film", "--sheet"]),
        ("--film a.mp4 --no-loop", vec!["--no-loop", "player"]),
        ("--fps 20", vec!["--film"]),
        ("--film no/where.gif", vec!["no/where.gif"]),
        ("--film scene.json", vec!["scene.json", ".mp4"]),
    ] {
        let run = workplace.run(&format!("render scene.json {flags}"));
        run.error(&words);
        assert_eq!(workplace.files(), before, "{flags}");
    }
    let run = workplace.run("render ball.json --film a.gif");
    run.error(&["the scene has one step", "--steps=-6..6/200"]);
    let run = workplace.run_with(
        "render scene.json --film a.mp4",
        b"",
        &[("PATH", "/nowhere")],
    );
    let run = run.error(&[
        "a.mp4",
        "ffmpeg",
        "not on the PATH",
        ".gif, .png (APNG) or .webp",
    ]);
    assert_eq!(run.stderr.lines().count(), 1, "{run}");
    assert_eq!(workplace.files(), before);
}

#[cfg(target_os = "linux")]
#[test]
fn a_film_that_finds_no_room_is_one_error_and_changes_nothing() {
    let workplace = Workplace::new();
    workplace.write("scene.json", PASSING);
    for name in ["a.gif", "a.png", "a.webp"] {
        workplace.write(name, "what was there");
        let line = format!(
            "trap '' XFSZ; ulimit -f 1; exec photosurface render scene.json -q --size 64x36 --fps 5 --film {name}"
        );
        let run = workplace.run_shell(&line).error(&[name, "File too large"]);
        assert_eq!(run.stderr.lines().count(), 1, "{run}");
        assert_eq!(workplace.read(name), b"what was there");
        std::os::unix::fs::symlink("/dev/full", workplace.path(&format!("full-{name}"))).unwrap();
        let words = match name {
            "a.webp" => "pipe or a device",
            _ => "No space left",
        };
        let line = format!("render scene.json -q --size 64x36 --fps 5 --film full-{name}");
        workplace.run(&line).error(&[name, words]);
    }
    assert_eq!(workplace.files().len(), 7, "{:?}", workplace.files());
    // Whoever reads may stop.
    let line =
        "photosurface render scene.json -q --size 640x360 --fps 5 --film - | head -c 9 >/dev/null";
    workplace.run_shell(line).success();
}

/// A folder with a program `ffmpeg` that is this line of shell, as a PATH.
#[cfg(unix)]
fn fake_ffmpeg(workplace: &Workplace, line: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let folder = workplace.path("bin");
    let program = folder.join("ffmpeg");
    fs::create_dir_all(&folder).unwrap();
    // Written under another name: what is open for writing cannot be run.
    let written = folder.join("new");
    fs::write(&written, format!("#!/bin/sh\n{line}\n")).unwrap();
    fs::set_permissions(&written, fs::Permissions::from_mode(0o755)).unwrap();
    fs::rename(&written, &program).unwrap();
    let path = std::env::var("PATH").expect("PATH");
    format!("{}:{path}", folder.display())
}

/// For the question which encoders there are.
#[cfg(unix)]
const ENCODERS: &str = "case \"$*\" in *-encoders*) echo ' V....D libx264 H.264'; exit;; esac";

#[cfg(unix)]
#[test]
fn an_ffmpeg_that_fails_is_quoted_and_leaves_nothing() {
    let workplace = Workplace::new();
    workplace.write("scene.json", PASSING);
    workplace.write("a.mp4", "what was there");
    for (program, words) in [
        (
            "echo no library >&2; exit 1",
            vec!["ffmpeg failed: no library"],
        ),
        ("exit 1", vec!["ffmpeg failed", "says nothing"]),
        (
            "echo ' V..... mjpeg'",
            vec!["libx264, libopenh264, mpeg4", ".gif"],
        ),
        (
            &format!("{ENCODERS}; echo 1 >&2; echo odd >&2; exit 3"),
            vec!["ffmpeg failed: 1; odd"],
        ),
        (
            &format!("{ENCODERS}; head -c 5000 >/dev/null; echo tired >&2; exit 1"),
            vec!["tired"],
        ),
        (
            &format!("{ENCODERS}; cat >/dev/null; echo at last >&2; exit 1"),
            vec!["at last"],
        ),
        (
            &format!("{ENCODERS}; cat >/dev/null"),
            vec!["ffmpeg failed", "says nothing"],
        ),
        (&format!("{ENCODERS}; kill -9 $$"), vec!["ffmpeg failed"]),
    ] {
        let path = fake_ffmpeg(&workplace, program);
        let line = "render scene.json -q --size 64x36 --fps 4 --film a.mp4";
        let run = workplace.run_with(line, b"", &[("PATH", &path)]);
        let run = run.error(&words).error(&["a.mp4"]);
        assert_eq!(run.stderr.lines().count(), 1, "{run}");
        assert_eq!(
            workplace.files(),
            ["a.mp4", "bin", "scene.json"],
            "{program}"
        );
        assert_eq!(workplace.read("a.mp4"), b"what was there");
    }
    // What it writes is the film.
    let made = "for last; do :; done; cat >/dev/null; echo made >\"${last#file:}\"";
    let path = fake_ffmpeg(&workplace, &format!("{ENCODERS}; {made}"));
    let line = "render scene.json -q --size 64x36 --fps 4 --film a.mp4";
    workplace.run_with(line, b"", &[("PATH", &path)]).success();
    assert_eq!(workplace.read("a.mp4"), b"made\n");
}

/// ffmpeg that reads nothing and never ends: it ends with the program.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_film_ends_ffmpeg_and_leaves_nothing() {
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::Duration;
    for (film, signal) in [("a.mp4", "INT"), ("a.mp4", "TERM"), ("a.gif", "INT")] {
        let workplace = Workplace::new();
        workplace.write("scene.json", PASSING);
        let hanging = format!(
            "{ENCODERS}; echo $$ >{}; exec sleep 1000",
            workplace.path("id").display()
        );
        let path = fake_ffmpeg(&workplace, &hanging);
        let mut child = Command::new(env!("CARGO_BIN_EXE_photosurface"))
            .args([
                "render",
                "scene.json",
                "-q",
                "--size",
                "320x180",
                "--film",
                film,
            ])
            .current_dir(workplace.path(""))
            .env("PATH", &path)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let has_begun = || {
            let names = workplace.files();
            let is_asked = film == "a.gif" || names.iter().any(|name| name == "id");
            is_asked && names.iter().any(|name| name.starts_with(".photosurface-"))
        };
        while !has_begun() {
            assert!(
                child.try_wait().unwrap().is_none(),
                "it ended before the signal"
            );
            sleep(Duration::from_millis(5));
        }
        sleep(Duration::from_millis(100));
        let id = child.id().to_string();
        Command::new("kill")
            .args(["-s", signal, &id])
            .status()
            .unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{film}");
        let left = workplace.files();
        let left: Vec<_> = left.iter().filter(|name| *name != "id").collect();
        assert_eq!(left, ["bin", "scene.json"], "{film}");
        if let Ok(id) = fs::read_to_string(workplace.path("id")) {
            let line = fs::read_to_string(format!("/proc/{}/cmdline", id.trim()));
            assert!(
                !line.is_ok_and(|line| line.contains("sleep")),
                "ffmpeg is still there"
            );
        }
    }
}
