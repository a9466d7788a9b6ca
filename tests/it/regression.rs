//! One test for each bug that was found, with its story.

use std::sync::Arc;

use crate::common::alone::alone;
use crate::common::command::{Workplace, glb_json};
use crate::common::glb::Glb;
use crate::common::refining::{Sighting, model, plate};
use photosurface::light_cone::{PhotosurfaceMap, View};
use photosurface::pipeline::{PlacedSceneError, VertexValues};
use photosurface::render::{
    Camera, Picture, PictureOptions, PictureSize, Projection, Scenery, Strokes, Viewpoint,
};
use photosurface::scene::{Attribute, Rotation, even_steps};
use photosurface::shape::{Appearance, Color};
use photosurface::spacetime::{Event, Lorentz, MAX_RAPIDITY, WorldLine};
use photosurface::tessellate::Precision;
use photosurface::write::{
    Export, Playback, WriteError, abandon_writes, destination, write_glb, write_ply, write_whole,
};
use photosurface::{
    DAffine3, DQuat, DVec2, DVec3, Mesh, Model, Object, Observer, Part, Photosurface, PlacedScene,
    Scene, Shape, Source, SurfaceOptions, Tolerance, Velocity, load_models,
};
use serde_json::json;

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
    let uri = workplace.read_json("source.gltf")["buffers"][0]["uri"].clone();
    let (old, new) = (uri.as_str().unwrap(), "data-0123abcd.bin");
    std::fs::rename(workplace.path(old), workplace.path(new)).unwrap();
    let gltf = String::from_utf8(workplace.read("source.gltf")).unwrap();
    // Two that share their data: whoever replaces one must not take it from the other.
    workplace.write("source.gltf", gltf.replace(old, new));
    workplace.write("data.gltf", gltf.replace(old, new));
    workplace.write(
        "scene.json",
        r#"{ "objects": [ { "name": "a", "file": "source.gltf" }, { "name": "b", "file": "a.obj" } ] }"#,
    );
    let files = workplace.files();
    let before: Vec<_> = files.iter().map(|file| workplace.read(file)).collect();
    for (input, output) in [
        ("source.gltf", "-o data.gltf"),
        ("source.gltf", "-o out.glb --report data-0123abcd.bin"),
        ("a.obj", "-o out.glb --report a.mtl"),
        ("a.obj", "-o out.glb --report ./red.png"),
        ("scene.json", "-o data.gltf"),
        ("scene.json", "-o out.glb --report a.mtl"),
        ("scene.json", "-o out.glb --report red.png"),
    ] {
        workplace
            .run(&format!("export {input} {output}"))
            .error(&["the output ", " would overwrite the input "]);
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
    for command in [
        "schema",
        "example",
        "example cube",
        "check",
        "export -o -",
        "export --help",
        "--version",
    ] {
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
    for signal in ["INT", "TERM"] {
        let workplace = Workplace::new();
        // Enough work that the signal comes in its midst, in files that are each begun soon.
        let line = "export --steps=-6..6/4000 --split -o out.glb";
        let status = workplace.interrupt(line, signal, |files| files.len() >= 3);
        assert_eq!(status, Some(130), "{signal}");
        let files = workplace.files();
        assert!(files.len() < 4000, "it was done before the signal");
        for file in files {
            assert!(file.starts_with("out_step"), "{signal}: {file}");
            let bytes = workplace.read(&file);
            // It is whole.
            Glb::new(&bytes);
        }
    }
}

/// The texture that says where a surface is metal was left behind while its factor stayed 1: whole models
/// became metal, which is black wherever it has nothing to reflect.
#[test]
fn a_texture_of_metal_travels_with_its_factors() {
    let workplace = Workplace::new();
    workplace.write(
        "a.obj",
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n",
    );
    workplace.write("a.mtl", "newmtl red\nmap_Kd red.png\n");
    workplace.write("red.png", PNG);
    workplace.write("metal.png", [PNG, b"another"].concat());
    workplace.run("export a.obj -o a.gltf").success();
    let mut source = workplace.read_json("a.gltf");
    source["images"] = json!([{ "uri": "red.png" }, { "uri": "metal.png" }]);
    source["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
    source["materials"][0]["pbrMetallicRoughness"] = json!({
        "baseColorTexture": { "index": 0 },
        "metallicRoughnessTexture": { "index": 1 },
    });
    source["asset"]["generator"] = json!("by hand");
    workplace.write("source.gltf", source.to_string());
    let run = workplace.run("export source.gltf -o out.glb").success();
    assert!(!run.stderr.contains("note"), "{run}");
    let seen = glb_json(&workplace.read("out.glb"));
    let surface = &seen["materials"][0]["pbrMetallicRoughness"];
    assert_eq!(surface["baseColorTexture"]["index"], 0);
    assert_eq!(surface["metallicRoughnessTexture"]["index"], 1);
    assert!(
        surface["metallicFactor"]
            .as_f64()
            .is_none_or(|factor| factor == 1.0)
    );
    assert_eq!(seen["textures"][1]["source"], 1);

    // Where it cannot be had, better no metal than all.
    std::fs::remove_file(workplace.path("metal.png")).unwrap();
    let run = workplace.run("export source.gltf -o out.glb").success();
    assert!(run.stderr.contains("metal.png"), "{run}");
    let seen = glb_json(&workplace.read("out.glb"));
    assert_eq!(
        seen["materials"][0]["pbrMetallicRoughness"]["metallicFactor"],
        0.0
    );
}

/// A hundred thousand steps were computed, and memory ran out, before the file was found too large.
#[test]
fn a_file_too_large_is_refused_before_it_is_computed() {
    let workplace = Workplace::new();
    let ball = r#"{ "sphere": { "radius": 1, "resolution": 96 } }"#;
    let scene = format!(r#"{{ "objects": [ {{ "name": "ball", "shape": {ball} }} ] }}"#);
    workplace.write("fine.json", scene);
    workplace
        .run("export fine.json --steps=-6..6/100000 -o out.glb")
        .error(&[
            "out.glb: the file would have at least",
            "at most 4294967295",
        ]);
    let run = workplace.run("check fine.json --steps=-6..6/100000");
    assert_eq!(run.status, 1, "{run}");
    assert!(run.stderr.contains("at most 4294967295"), "{run}");
    assert_eq!(workplace.files(), ["fine.json"]);
}

/// Messages that named a file twice, blamed the wrong flag, or said NaN.
#[test]
fn messages_say_what_is_wrong() {
    let workplace = Workplace::new();
    let triangle = |x: &str| format!("v 0 0 0\nv {x} 0 0\nv 0 {x} 0\nf 1 2 3\n");
    workplace.write("huge.obj", triangle("1e300"));
    workplace.write("tiny.obj", triangle("1e-42"));
    workplace.write("one.obj", triangle("1"));
    workplace.write("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n");
    workplace.write("latin.json", b"{ \"title\": \"\xfc\" }");
    let object = |what: &str| format!("{{ \"objects\": [ {{ \"name\": \"a\", {what} }} ] }}");
    workplace.write("lost.json", object("\"file\": \"nope.obj\""));
    workplace.write(
        "wide.json",
        object("\"file\": \"one.obj\", \"position\": [1e300, 0, 0]"),
    );
    for (arguments, words) in [
        (
            "lost.json",
            "error: lost.json: object \"a\": cannot read \"nope.obj\": No such file",
        ),
        ("nope.obj", "error: cannot read \"nope.obj\": No such file"),
        (
            "latin.json",
            "latin.json: not text in UTF-8: byte 12, counted from 0, is 0xfc",
        ),
        (
            "huge.obj",
            "huge.obj: 1e300 is a coordinate of vertex 1 of part \"huge\", expected at most 1e75",
        ),
        (
            "wide.json --rapidity 300",
            "overflows 64-bit numbers: lengths, times or the rapidity are too large",
        ),
        (
            "tiny.obj --observer 0,0,0",
            "too small for the 32-bit numbers",
        ),
        (
            "two.obj",
            "the file has none of three corners or more; 1 face of fewer",
        ),
        (
            "one.obj --direction 0,0,0 --beta 0.5",
            "error: --direction: ",
        ),
    ] {
        let run = workplace
            .run(&format!("export {arguments}"))
            .error(&[words]);
        assert!(!run.stderr.contains("NaN"), "{run}");
    }
    for stdin in [triangle("1"), r#"{ "asset": { "version": "2.0" } }"#.into()] {
        workplace
            .run_with("check -", stdin.as_bytes(), &[])
            .error(&["stdin must be a scene (JSON), or a GLB, PLY, STL or OFF"]);
    }
    let run = workplace
        .run("export one.obj -o no/such/a.glb")
        .error(&["No such file"]);
    assert!(!run.stderr.contains(".photosurface-"), "{run}");
}

/// A report that could not be written ended with status 2, "nothing written", though the mesh was.
#[cfg(target_os = "linux")]
#[test]
fn without_its_report_no_mesh_appears() {
    let workplace = Workplace::new();
    for format in ["glb", "gltf", "ply"] {
        for report in ["--report /dev/full", "--report - >/dev/full"] {
            workplace
                .run_shell(&format!("photosurface export -o out.{format} {report}"))
                .error(&["No space left"]);
            assert!(workplace.files().is_empty(), "{:?}", workplace.files());
        }
    }
}

/// Arguments that are no UTF-8 were refused, though they are names of files as good as any.
#[cfg(target_os = "linux")]
#[test]
fn a_file_name_need_not_be_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let workplace = Workplace::new();
    let name = |bytes: &'static [u8]| workplace.path("").join(OsStr::from_bytes(bytes));
    std::fs::write(name(b"\xff.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_photosurface"))
        .args(["export", "-q", "--split", "-o"])
        .args([name(b"\xfe.glb"), name(b"\xff.obj")])
        .status();
    assert!(status.unwrap().success());
    assert!(name(b"\xfe_step000.glb").exists());
}

/// With the observer in a face's plane the chart of the sky is all but a line; where a piece turned over in it, the
/// plain strip was taken: 8000 times what was asked for, and told as certain beforehand.
#[test]
fn a_face_seen_edge_on_is_refined_like_any_other() {
    let workplace = Workplace::new();
    workplace.write(
        "face.obj",
        "v -8 0 -7\nv -6 0 -7\nv -6 0 -5\nv -8 0 -5\nf 1 3 2\nf 1 4 3\n",
    );
    for tolerance in ["abs:1", "abs:0.3"] {
        workplace
            .run(&format!(
                "export face.obj --gamma 1e6 --observer 0,0,0 --tolerance {tolerance} -o out.glb"
            ))
            .success();
    }
}

/// A normal was multiplied by `exp(eta)` before it was brought to unit length: a long one became infinite, and that has
/// no direction, so the normal was zero.
#[test]
fn long_normals_of_fast_things_are_not_zero() {
    let velocity = Velocity::from_rapidity(350.0, DVec3::X).unwrap();
    let map = PhotosurfaceMap::new(&velocity);
    let normal = DVec3::new(0.6, 0.8, 0.0);
    let expected = map.seen_normal(DVec3::Y, normal);
    assert!((expected.length() - 1.0).abs() < 1e-15);
    for length in [1e-200, 1e200, 1e300] {
        let found = map.seen_normal(DVec3::Y, normal * length);
        assert!((found - expected).length() < 1e-15, "{length}: {found}");
    }
}

/// What is seen beyond the range of `f64` was infinite until the axes were turned: zero times infinity in a product
/// with a rotation is NaN.
#[test]
fn what_is_seen_infinitely_far_off_is_not_nan() {
    let moving = |rapidity, direction| WorldLine {
        origin: Event::default(),
        velocity: Velocity::from_rapidity(rapidity, direction).unwrap(),
    };
    let view = View::new(&moving(300.0, DVec3::X).moment(0.0), &moving(2.0, DVec3::Y));
    assert!(view.relative_velocity().rapidity() > 300.0);
    for far in [DVec3::X, DVec3::ONE, DVec3::new(1.0, -1.0, 0.0)] {
        let seen = view.seen_position(far * 1e300);
        assert!(!seen.is_nan(), "{seen}");
        assert!(seen.abs().max_element() == f64::INFINITY, "{seen}");
    }
}

/// Of two tiny rapidities across each other the squares vanished, and with them the velocity.
#[test]
fn two_tiny_velocities_are_not_rest() {
    let [first, second] = [(3e-200, DVec3::X), (4e-200, DVec3::Y)]
        .map(|(eta, n)| Lorentz::boost(Velocity::from_rapidity(eta, n).unwrap()));
    let boost = first.then(&second).boost_velocity();
    assert!((boost.rapidity() / 5e-200 - 1.0).abs() < 1e-15, "{boost:?}");
    assert!(
        (boost.direction() - DVec3::new(0.6, 0.8, 0.0)).length() < 1e-15,
        "{boost:?}"
    );
}

/// The squares of such distances are infinite. The fewest triangles that theory allows, which every certificate tells,
/// are an integral that halves a triangle until it is small against its distance: infinity minus infinity is
/// never small, and what was meant to end after 60 halvings was halved 2^60 times.
#[test]
fn coordinates_of_any_size_do_not_halve_for_ever() {
    for size in [1e-300, 1e150, 1e200, 1e300, f64::MAX] {
        let corners = [
            DVec3::new(-1.0, -1.0, 0.1),
            DVec3::new(1.0, -1.0, 0.1),
            DVec3::new(0.0, 1.0, 0.1),
        ];
        let mesh = Mesh::new(
            corners.map(|corner| corner * size).to_vec(),
            vec![[0, 1, 2]],
        )
        .unwrap();
        let source = Source::Model(Arc::new(model(&[mesh])));
        let observer = Observer {
            velocity: Velocity::from_beta(0.5, DVec3::X).unwrap(),
            ..Observer::default()
        };
        let scene = Scene::new(observer, vec![Object::new("triangle", source)]).unwrap();
        let (models, _) = load_models(&scene, ".".as_ref()).unwrap();
        let wanted = SurfaceOptions {
            subdivide: false,
            ..SurfaceOptions::default()
        };
        let made = PlacedScene::new(scene, models)
            .unwrap()
            .photosurfaces(0, wanted)
            .unwrap()
            .next()
            .unwrap();
        assert!(made.facts.certificate.minimum_with_source >= 1.0, "{size}");
    }
}

/// Offsets too large for their squares are made smaller first, which an infinite one never is: the stack was full. And
/// infinities in the sum that is the observer's place left NaN of it.
#[test]
fn infinite_offsets_are_not_made_smaller_for_ever() {
    let velocity = Velocity::from_beta(0.5, DVec3::X).unwrap();
    let map = PhotosurfaceMap::new(&velocity);
    let far = DVec3::new(f64::INFINITY, 1.0, 0.0);
    assert!(!map.seen_position(far).is_finite());
    assert!(map.stretch_bound(far, 1.0) >= velocity.stretch());
    let at = |x| WorldLine {
        origin: Event::new(x, DVec3::new(x, -x, 0.0)),
        velocity,
    };
    let view = View::new(&at(f64::MAX).moment(1.0), &at(f64::MIN));
    assert_eq!(view.observer_rest(), DVec3::INFINITY);
    assert_eq!(view.seen_position(DVec3::X), DVec3::INFINITY);
}

/// A budget below what a round shape has at its coarsest is not to be had by any tolerance. All of them up to 1e300 times
/// as loose were tried, each half as loose again as the one before: 1700 predictions of a second each.
#[test]
fn a_budget_that_nothing_fits_is_given_up_soon() {
    let workplace = Workplace::new();
    let run = workplace.run(
        "export --rapidity 40 --direction=0,0,1 --observer 0,0,3 --time 0 --max-triangles 1 -o out.glb",
    );
    assert_eq!(run.status, 1, "{run}");
    assert!(workplace.files().contains(&"out.glb".to_owned()));
}

/// What rounding takes of a tolerance was known before refinement only, by the extent that the corners had: the
/// photosurface between them reaches farther, and near the limits of `f32` the certificate was missed by as much.
#[test]
fn what_is_beyond_the_corners_is_rounded_too() {
    let velocity = Velocity::from_beta(0.1, DVec3::X).unwrap();
    for tolerance in [1.2e-7, 2e-7, 4e-7] {
        let mut sighting = Sighting::new(
            DVec3::ZERO,
            velocity,
            Tolerance::absolute(tolerance).unwrap(),
        );
        sighting.wanted.precision = Precision::Single;
        let made = sighting.of_one(&plate(0.001)).certificate;
        assert!(made.rounding > 0.2 * tolerance && made.complete, "{made:?}");
    }
}

/// Far away the closed form of a gap has a floor, 1e-160 of the distance: at 1e300 that was more than any tolerance, and
/// a mesh of 2,560 triangles was refined until memory ran out. What is as small as that on the sky needs no refinement.
#[test]
fn what_is_farther_away_than_digits_reach_is_left_as_it_is() {
    let workplace = Workplace::new();
    workplace
        .run("export --beta 0 --steps 0 --example sphere --tolerance 1e-2 -o ball.glb")
        .success();
    for distance in ["1e120", "1e160", "1e200", "1e300"] {
        let line = format!(
            "export ball.glb --observer {distance},0,0 --beta 0.5 -o out.ply --report report.json"
        );
        let run = workplace.run(&line);
        // Not certified: the digits of the place are not enough.
        assert_eq!(run.status, 1, "{run}");
        assert!(!run.stderr.contains(" fits"), "{run}");
        let certificate = &workplace.read_json("report.json")["objects"][0]["certificate"];
        assert_eq!(certificate["triangles_in"], certificate["triangles_out"]);
        assert!(certificate["gap"].as_f64() < Some(1e-100), "{certificate}");
    }
}

/// A reader that went away in the middle of a file counted as success: status 0 means "done and certified".
#[cfg(unix)]
#[test]
fn a_file_that_nobody_reads_to_its_end_is_not_done() {
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_photosurface"))
        // More than a pipe holds.
        .args("export --example lattice --no-subdivide -q -o -".split(' '))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program can be started");
    drop(program.stdout.take());
    let ended = program.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(141));
    assert!(ended.stderr.is_empty(), "there is nobody to tell");
}

/// An object that keeps up with its observer ended in a panic at 30 of 99 speeds, 0.8 and 0.95 among them, in every
/// command but `check`; so did gamma 1e6 in oblique directions.
#[test]
fn what_keeps_up_with_the_observer_is_seen_at_rest() {
    let workplace = Workplace::with_ball();
    for (speed, abeam) in [
        (r#""beta": 0.8, "direction": [1, 0, 0]"#, "[0, 1, -4]"),
        (r#""beta": 0.95, "direction": [-1, 0, 0]"#, "[0, 1, -4]"),
        (r#""gamma": 10, "direction": [0, 0, 1]"#, "[4, 1, 0]"),
        (r#""gamma": 1e6, "direction": [1, 2, 3]"#, "[2, -1, 0]"),
        (r#""rapidity": 350, "direction": [-3, 1, 2]"#, "[1, 3, 0]"),
    ] {
        let scene = format!(
            r#"{{ "observer": {{ "velocity": {{ {speed} }} }}, "objects": [ {{ "name": "a", "file": "square.obj",
                 "position": {abeam}, "velocity": {{ {speed} }} }} ] }}"#
        );
        workplace.write("fleet.json", scene);
        workplace
            .run("export fleet.json -o out.ply --report report.json")
            .success();
        let object = &workplace.read_json("report.json")["objects"][0];
        assert_eq!(object["relative_gamma"], 1.0, "{speed}");
        assert_eq!(object["certificate"]["gap"], 0.0, "{speed}");
        for command in [
            "check fleet.json",
            "export fleet.json -o out.glb --animate=morph --steps 0,1",
            "render fleet.json -o out.png --size 32x24",
            "render fleet.json -o out.png --size 32x24 --method mesh --view outside",
            "cost fleet.json --only meshes --tolerances 1e-1 --repeats 1",
        ] {
            workplace.run(command).success();
        }
    }
}

/// Writing used to be abandoned with a lock that nobody released: whoever wrote on waited for ever.
#[test]
fn writes_that_are_abandoned_end_with_an_error() {
    alone(
        "regression::writes_that_are_abandoned_end_with_an_error",
        || {
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("out.ply");
            let begun = write_whole(&path, |_| {
                abandon_writes();
                Ok(())
            });
            assert!(matches!(begun, Err(WriteError::Cancelled)), "{begun:?}");
            let later = write_whole(&path, |_| Ok(()));
            assert!(matches!(later, Err(WriteError::Cancelled)), "{later:?}");
            assert!(matches!(destination(&path), Err(WriteError::Cancelled)));
            assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
        },
    );
}

/// Each of these used to panic, or to make photosurfaces of NaN.
#[test]
fn a_stage_is_made_of_what_fits_or_not_at_all() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let nowhere = mesh.clone().transformed(&DAffine3::from_scale(DVec3::NAN));
    let of = |mesh: Mesh| {
        let source = Source::Model(Arc::new(model(&[mesh])));
        let scene = Scene::new(Observer::default(), vec![Object::new("triangle", source)]);
        let (models, _) = load_models(scene.as_ref().unwrap(), ".".as_ref()).unwrap();
        (scene.unwrap(), models)
    };
    let (scene, models) = of(mesh);
    let none = PlacedScene::new(scene.clone(), vec![])
        .unwrap_err()
        .to_string();
    assert!(none.contains("0 models for 1 objects"), "{none}");
    let placed = PlacedScene::new(scene, models).unwrap();
    let late = placed
        .photosurfaces(1, SurfaceOptions::default())
        .err()
        .unwrap();
    assert!(
        late.to_string().contains("step 1 of a scene with 1"),
        "{late}"
    );
    let (scene, models) = of(nowhere);
    let odd = PlacedScene::new(scene, models).unwrap_err().to_string();
    assert!(
        odd.contains("part \"part0\" of object \"triangle\""),
        "{odd}"
    );
}

fn ball() -> Scene {
    let shape = Shape::sphere(1.0).unwrap();
    let source = Source::Shape(shape, Appearance::default());
    Scene::new(Observer::default(), vec![Object::new("ball", source)]).unwrap()
}

/// Of an object with a shape and a model without parts a panic was made; of one with the model of a coarser shape, a
/// certificate for facets that were not there.
#[test]
fn the_model_of_a_shape_is_that_of_the_shape() {
    let of = |model: Model| PlacedScene::new(ball(), vec![model]).map(|_| ());
    let shape = |radius: f64, resolution: u32| {
        let shape = Shape::sphere(radius).unwrap();
        let shape = shape.with_resolution(resolution).unwrap();
        shape.model(&Appearance::default()).unwrap()
    };
    let (models, _) = load_models(&ball(), "".as_ref()).unwrap();
    assert_eq!(of(models[0].clone()), Ok(()));
    // Looks and names are the caller's.
    let mut renamed = models[0].clone();
    renamed.parts[0].name = "mine".to_owned();
    renamed.parts[0].material = None;
    assert_eq!(of(renamed), Ok(()));
    // The same numbers from elsewhere are the same mesh.
    let mut copied = models[0].clone();
    let mesh = copied.parts[0].mesh();
    let copy = Mesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec()).unwrap();
    let copy = copy.with_normals(mesh.normals().unwrap().to_vec()).unwrap();
    copied.parts[0] = Part::new("", copy, None).unwrap();
    assert_eq!(of(copied), Ok(()));
    let mut stretched = models[0].clone();
    let part = stretched.parts.remove(0);
    stretched.parts = vec![part.transformed(&DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.1)))];
    for other in [Model::default(), shape(1.0, 3), shape(1.5, 48), stretched] {
        let object = "ball".to_owned();
        assert_eq!(of(other), Err(PlacedSceneError::Shape { object }));
    }
}

/// A composed velocity may be twice as fast as any that is given: two of those ended in a failed assertion, and without
/// assertions in a relative velocity whose rapidity and `gamma` were not of each other.
#[test]
fn composed_velocities_never_leave_the_range_of_numbers() {
    let of =
        |rapidity: f64, direction: DVec3| Velocity::from_rapidity(rapidity, direction).unwrap();
    let there = of(MAX_RAPIDITY, DVec3::X);
    let back = of(MAX_RAPIDITY, DVec3::new(-1.0, 0.5, 0.0));
    for other in [there.reversed(), back] {
        let fast = Lorentz::between(other, there);
        let mut whole = fast;
        for _ in 0..5 {
            whole = whole.then(&fast);
            let velocity = whole.boost_velocity();
            assert!((2.0 * MAX_RAPIDITY - velocity.rapidity()).abs() < 1e-6 * MAX_RAPIDITY);
            assert!((velocity.stretch().ln() - velocity.rapidity()).abs() < 1e-9);
            assert!(velocity.gamma().is_finite());
            let undone = whole.then(&whole.inverse()).boost_velocity();
            assert!(undone.rapidity() <= 2.0 * MAX_RAPIDITY * (1.0 + 1e-9));
        }
        // A scene takes none that is faster than may be given.
        let observer = Observer {
            velocity: whole.boost_velocity(),
            ..Observer::default()
        };
        let scene = ball().with_observer(observer).unwrap();
        let (models, _) = load_models(&scene, "".as_ref()).unwrap();
        let refused = PlacedScene::new(scene, models).unwrap_err().to_string();
        assert!(
            refused.contains("the rapidity of the observer is 700, expected at most 350"),
            "{refused}"
        );
    }
}

/// Axes could be turned by no rotation at all, of which the next composition made a failed assertion.
#[test]
fn axes_are_turned_by_rotations_alone() {
    for odd in [0.0, 1e-200, 2.0, 1e200, f64::INFINITY, f64::NAN] {
        assert!(Rotation::new(DQuat::IDENTITY * odd).is_err(), "{odd}");
    }
    let turn = Rotation::new(DQuat::from_rotation_y(0.5)).unwrap();
    let moment = ball().moment(0).unwrap().turned(turn);
    assert!((moment.scene_to_observer().rotation().length() - 1.0).abs() < 1e-15);
    assert!(ball().moment(1).is_none());
}

/// Photosurfaces may be anyone's: of numbers that are not one for each vertex, of steps with other triangles and of a
/// step beyond the last the writers made a panic, of a box around nothing and of no frames in a second files of NaN, and
/// of a photosurface without the numbers that others have, numbers of something at rest.
#[test]
fn what_does_not_fit_together_is_not_written() {
    let scene = ball().with_steps(vec![0.0, 1.0]).unwrap();
    let (models, _) = load_models(&scene, "".as_ref()).unwrap();
    let placed = PlacedScene::new(scene, models).unwrap();
    let wanted = SurfaceOptions {
        attributes: [Attribute::Doppler, Attribute::RestPosition]
            .into_iter()
            .collect(),
        ..SurfaceOptions::default()
    };
    let facts = placed.facts();
    let write = |photosurfaces: &[Photosurface], playback: Option<Playback>| {
        let export = Export {
            scene: &facts,
            marker: None,
            photosurfaces,
            playback,
        };
        let (mut glb, mut ply) = (vec![], vec![]);
        let glb = write_glb(&export, &mut glb).map(|()| glb);
        let ply = write_ply(&export, &mut ply).map(|()| ply);
        (glb, ply)
    };
    let surface = placed.photosurfaces(0, wanted).unwrap().next().unwrap();
    let (fine, _) = write(std::slice::from_ref(&surface), None);
    let fine = fine.unwrap();

    let mut short = surface.clone();
    let places = short.vertex_data.rest_positions().unwrap();
    let fewer = VertexValues::Vectors(places[1..].to_vec());
    short.vertex_data.set(Attribute::RestPosition, Some(fewer));
    let mut without = surface.clone();
    without.vertex_data.set(Attribute::Doppler, None);
    for (others, attribute) in [
        (vec![short], "rest_x"),
        (vec![surface.clone(), without], "doppler"),
    ] {
        let (glb, ply) = write(&others, None);
        for error in [glb.unwrap_err(), ply.unwrap_err()] {
            assert!(error.to_string().contains(attribute), "{error}");
            assert!(matches!(error, WriteError::Attribute { .. }), "{error}");
        }
    }

    let mut late = surface.clone();
    late.facts.step = usize::MAX;
    let (late, _) = write(&[late], None);
    let step = |error: &WriteError| {
        matches!(
            error,
            WriteError::PlacedScene(PlacedSceneError::Step { .. })
        )
    };
    assert!(step(&late.unwrap_err()));

    for odd in [DVec3::NAN, DVec3::INFINITY, DVec3::ZERO] {
        let mut boxed = surface.clone();
        boxed.around = (odd, odd);
        let (boxed, _) = write(&[boxed], None);
        assert!(boxed.unwrap() == fine, "{odd}");
    }

    let morphing: Vec<Photosurface> = placed.morphing(wanted).flatten().collect();
    for frames_per_second in [0.0, -1.0, 1e-300, 1e300, f64::INFINITY, f64::NAN] {
        for playback in [
            Playback::Frames { frames_per_second },
            Playback::Morph { frames_per_second },
        ] {
            let (glb, _) = write(&morphing, Some(playback));
            assert!(matches!(glb, Err(WriteError::FramesPerSecond(_))));
        }
    }
    let playback = Playback::Morph {
        frames_per_second: 24.0,
    };
    assert!(write(&morphing, Some(playback)).0.is_ok());
    let mut other = morphing.clone();
    other[1].mesh = cube();
    let (other, _) = write(&other, Some(playback));
    assert!(matches!(other, Err(WriteError::Morph { step: 1, .. })));
}

fn cube() -> Mesh {
    let cube = Shape::cuboid([1.0; 3]).unwrap();
    let model = cube.model(&Appearance::default()).unwrap();
    model.parts[0].mesh().clone()
}

/// A picture that was pasted far beside another one ended in a panic; so did 65,536 rays along each side of a pixel,
/// after some hours.
#[test]
fn pictures_take_any_numbers() {
    let odd = [
        0.0,
        -1.0,
        5e-324,
        1e300,
        f64::MAX,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    let size = PictureSize::new(4, 3).unwrap();
    let white = Color([255; 3]);
    let mut picture = Picture::filled(size, white);
    for x in [0, 3, 4, 9, u32::MAX] {
        for y in [0, 2, 3, u32::MAX] {
            picture.paste(&Picture::filled(size, white), x, y);
        }
    }
    for width_px in odd {
        for x in odd {
            let lines = vec![[DVec2::new(x, 1.0), DVec2::new(width_px, x)]];
            picture.draw(&Strokes {
                lines,
                color: white,
                width_px,
            });
            picture.write("a", DVec2::new(x, 2.0), width_px, white);
        }
    }
    let mut scenery = Scenery::new();
    let (scene, (models, _)) = (ball(), load_models(&ball(), "".as_ref()).unwrap());
    scenery.add_at_rest(&scene.objects()[0], &models[0].parts[0]);
    let part = &models[0].parts[0];
    for odd in odd {
        scenery.add_in_view(
            &part
                .clone()
                .transformed(&DAffine3::from_scale(DVec3::new(odd, 1.0, 1.0))),
        );
    }
    scenery.set_ghosts(odd.into_iter().map(|odd| {
        let moved = DAffine3::from_translation(DVec3::X * odd);
        (part.mesh().clone().transformed(&moved), white)
    }));
    let views = [0.0, 5e-324, 1e-300, 179.999_999_999_999, 180.0, f64::NAN];
    let projections = views.map(|vertical_fov_deg| Projection::Perspective { vertical_fov_deg });
    let cameras = projections.into_iter().chain([Projection::FullSky]);
    let cameras: Vec<Camera> = cameras
        .filter_map(|projection| Camera::new(size, projection, DVec3::NEG_Z).ok())
        .collect();
    assert_eq!(cameras.len(), 4);
    for camera in &cameras {
        for x in odd {
            assert!(
                camera
                    .place(DVec3::new(x, 1.0, -1.0))
                    .is_none_or(DVec2::is_finite)
            );
            let moments = [
                ball().flight().moment(x),
                ball().moment(0).unwrap().coasted(x),
            ];
            let eyes = [
                Viewpoint::Outside(DVec3::new(x, 0.0, 9.0)),
                Viewpoint::Observer(&moments[0]),
                Viewpoint::Observer(&moments[1]),
            ];
            for eye in eyes {
                let options = PictureOptions {
                    samples: 0,
                    wireframe: Some(white),
                    ..PictureOptions::default()
                };
                let mut picture = scenery.picture(camera, eye, options);
                let lines = vec![[DVec3::new(x, 0.0, 0.0), DVec3::Y]];
                let strokes = Strokes {
                    lines,
                    color: white,
                    width_px: 1.0,
                };
                scenery.draw(&mut picture, camera, eye, &[strokes]);
            }
        }
    }
    let options = PictureOptions {
        samples: u32::MAX,
        ..PictureOptions::default()
    };
    let one = PictureSize::new(1, 1).unwrap();
    let camera = Camera::new(one, Projection::FullSky, DVec3::NEG_Z).unwrap();
    let viewpoint = Viewpoint::Outside(DVec3::Z * 9.0);
    Scenery::new().picture(&camera, viewpoint, options);
}

/// Steps between ends whose difference is beyond `f64` were infinite.
#[test]
fn even_steps_are_finite() {
    let steps = even_steps(-f64::MAX, f64::MAX, 5).unwrap();
    for (step, part) in steps.into_iter().zip([-1.0, -0.5, 0.0, 0.5, 1.0]) {
        assert!((step / f64::MAX - part).abs() <= f64::EPSILON, "{step}");
    }
}
