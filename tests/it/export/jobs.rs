//! The export of the library: the same files as those of the command, whatever the settings; an end that the caller says;
//! and a study of what it costs that makes the same.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

use photosurface::jobs::ExportError;
use photosurface::write::Playback;
use photosurface::{
    CostSettings, CostStudy, ExportSettings, PlacedScene, Tolerance, export, load_models,
};

use crate::common::command::Workplace;
use crate::common::progress::Pieces;

/// A scene of two objects and three steps.
const PASSING: &str = r#"{ "title": "Passing", "observer": { "velocity": { "beta": 0.9, "direction": [0, 0, -1] }, "marker": 0.1 },
  "steps": [-1, 0, 1], "objects": [
  { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [2, 0, -3] },
  { "name": "plate", "file": "square.obj", "position": [-2, 0, -1] } ] }"#;

const FRAMES: Playback = Playback::Frames {
    frames_per_second: 12.0,
};
const MORPH: Playback = Playback::Morph {
    frames_per_second: 12.0,
};

fn with_passing() -> (Workplace, PlacedScene) {
    let workplace = Workplace::with_ball();
    workplace.write("passing.json", PASSING);
    let (placed, findings) = PlacedScene::load(&workplace.path("passing.json")).unwrap();
    assert_eq!(findings.len(), 1, "one of the objects is a file");
    (workplace, placed)
}

/// The names of files that begin with `start`, in order, with what is in them; `start` itself is left out of names.
fn files(workplace: &Workplace, start: &str) -> Vec<(String, Vec<u8>)> {
    let names = workplace.files();
    let rest = names.iter().filter_map(|name| name.strip_prefix(start));
    rest.map(|rest| (rest.to_owned(), workplace.read(&format!("{start}{rest}"))))
        .collect()
}

#[test]
fn the_library_writes_the_bytes_of_the_command() {
    let (workplace, placed) = with_passing();
    let tolerances = [1e-2, 1e-3].map(|number| Tolerance::relative(number).unwrap());
    let default = ExportSettings::default;
    let cases = [
        ("glb", "", default()),
        ("ply", "", default()),
        (
            "GLB",
            "--no-subdivide",
            ExportSettings {
                subdivide: false,
                ..default()
            },
        ),
        (
            "glb",
            "--split",
            ExportSettings {
                split: true,
                ..default()
            },
        ),
        (
            "gltf",
            "--split",
            ExportSettings {
                split: true,
                ..default()
            },
        ),
        (
            "glb",
            "--animate --fps 12",
            ExportSettings {
                playback: Some(FRAMES),
                ..default()
            },
        ),
        (
            "glb",
            "--animate=morph --fps 12",
            ExportSettings {
                playback: Some(MORPH),
                ..default()
            },
        ),
        (
            "glb",
            "--lod 1e-2,1e-3",
            ExportSettings {
                levels: tolerances.to_vec(),
                ..default()
            },
        ),
        (
            "glb",
            "--max-triangles 2000",
            ExportSettings {
                max_triangles: 2000,
                ..default()
            },
        ),
    ];
    for (number, (extension, flags, settings)) in cases.into_iter().enumerate() {
        let [theirs, ours] = ["command", "library"].map(|who| format!("{who}{number}"));
        let run = workplace.run(&format!(
            "export passing.json {flags} -o {theirs}.{extension}"
        ));
        let progress = Pieces::until(usize::MAX);
        let path = workplace.path(&format!("{ours}.{extension}"));
        let exported = export(&placed, &settings, &path, &progress).unwrap();
        let (theirs, ours) = (files(&workplace, &theirs), files(&workplace, &ours));
        if extension == "gltf" {
            // The data is named after the file and its content.
            assert_eq!(theirs.len(), 6);
            assert_eq!(theirs.len(), ours.len(), "{flags}");
        } else {
            assert!(theirs == ours && !theirs.is_empty(), "{extension} {flags}");
        }
        let written = exported
            .iter()
            .flat_map(|level| level.files.iter().chain(&level.data_files));
        assert_eq!(written.count(), ours.len());
        let certified = exported.iter().all(|level| level.tally.is_certified());
        assert_eq!(run.status, if certified { 0 } else { 1 }, "{flags}");
        let pieces = 6 * exported.len();
        assert_eq!(progress.begun_and_done(), (pieces, pieces));
        for level in &exported {
            assert_eq!(level.tally.photosurfaces, 6);
            assert_eq!(level.report.objects.len(), 6);
            let stages = level.report.stages.iter().map(|stage| stage.name);
            assert_eq!(
                stages.collect::<Vec<_>>(),
                ["predict", "photosurface", "write"]
            );
        }
    }
}

#[test]
fn a_mesh_by_itself_is_seen_as_the_command_sees_it() {
    let workplace = Workplace::with_ball();
    workplace.run("export square.obj -o command.glb").success();
    let (placed, _) = PlacedScene::load(&workplace.path("square.obj")).unwrap();
    export(
        &placed,
        &ExportSettings::default(),
        &workplace.path("library.glb"),
        &(),
    )
    .unwrap();
    assert!(workplace.read("command.glb") == workplace.read("library.glb"));
    for (name, expected) in [
        ("nothing.txt", "nothing.txt: unknown extension"),
        ("nothing.json", "nothing.json"),
        ("nothing.obj", "nothing.obj"),
    ] {
        let error = PlacedScene::load(&workplace.path(name)).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn an_export_that_is_ended_leaves_what_stood_there() {
    let (workplace, placed) = with_passing();
    for (extension, playback) in [
        ("glb", None),
        ("glb", Some(FRAMES)),
        ("glb", Some(MORPH)),
        ("gltf", None),
        ("ply", None),
    ] {
        let name = format!("out.{extension}");
        workplace.write(&name, "before");
        let before = workplace.files();
        for last in 0..6 {
            let progress = Pieces::until(last + 1);
            let settings = ExportSettings {
                playback,
                ..ExportSettings::default()
            };
            let ended = export(&placed, &settings, &workplace.path(&name), &progress);
            assert!(matches!(ended, Err(ExportError::Cancelled)), "{ended:?}");
            assert_eq!(progress.begun_and_done(), (6, last + 1));
            assert_eq!(workplace.files(), before);
            assert_eq!(workplace.read(&name), b"before");
        }
    }
}

#[test]
fn settings_that_do_not_go_together_are_refused_before_the_work() {
    let (workplace, placed) = with_passing();
    let default = ExportSettings::default;
    let one = Tolerance::relative(1e-2).unwrap();
    let fast = Playback::Frames {
        frames_per_second: f64::NAN,
    };
    let report = Some(workplace.path("out.glb"));
    let cases = [
        (
            "out.ply",
            ExportSettings {
                playback: Some(FRAMES),
                ..default()
            },
            "a .ply has no time",
        ),
        (
            "out.glb",
            ExportSettings {
                playback: Some(fast),
                ..default()
            },
            "NaN frames a second",
        ),
        (
            "out.glb",
            ExportSettings {
                playback: Some(MORPH),
                split: true,
                ..default()
            },
            "one file",
        ),
        (
            "out.glb",
            ExportSettings {
                levels: vec![one, one],
                ..default()
            },
            "given twice",
        ),
        (
            "out.glb",
            ExportSettings {
                report,
                ..default()
            },
            "another output",
        ),
        ("out.stl", default(), "out.stl: unknown extension"),
        ("no/out.glb", default(), "no/out.glb"),
    ];
    let before = workplace.files();
    for (name, settings, expected) in cases {
        let progress = Pieces::until(1);
        let error = export(&placed, &settings, &workplace.path(name), &progress).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
        assert_eq!(workplace.files(), before);
    }
    let one_step = placed.scene().clone().with_steps(vec![0.0]).unwrap();
    let (models, _) = load_models(&one_step, workplace.path("").as_path()).unwrap();
    let one_step = PlacedScene::new(one_step, models).unwrap();
    let settings = ExportSettings {
        playback: Some(FRAMES),
        ..default()
    };
    let error = export(&one_step, &settings, Path::new("out.glb"), &()).unwrap_err();
    assert!(matches!(error, ExportError::OneStep));
}

#[test]
fn a_study_of_the_cost_makes_what_an_export_makes() {
    let (workplace, placed) = with_passing();
    let tolerance = Tolerance::relative(1e-3).unwrap();
    let placed = placed.with_tolerance_for_all(tolerance);
    let path = workplace.path("out.glb");
    let exported = export(&placed, &ExportSettings::default(), &path, &()).unwrap();
    let settings = CostSettings {
        tolerances: vec![tolerance],
        repeats: NonZeroUsize::MIN,
        samples: NonZeroUsize::MIN,
        ..CostSettings::default()
    };
    let (models, _) = load_models(placed.scene(), &workplace.path("")).unwrap();
    let study = CostStudy::new(placed.scene(), &models, &settings, &()).unwrap();
    let made = study.meshes[0].made.as_ref().unwrap();
    assert_eq!(made.triangles, exported[0].tally.triangles);
    assert_eq!(made.file_bytes, fs::metadata(&path).unwrap().len());
    assert!(made.certified && exported[0].tally.is_certified());
}
