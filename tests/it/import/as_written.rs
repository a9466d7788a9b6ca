//! Reading glTF as exporters really write it: what every other program draws is drawn, with a note, and what
//! would be wrong is refused.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use photosurface::read::{read_gltf_bytes, read_model};
use photosurface::write::{Export, write_glb, write_ply};
use photosurface::{
    DVec3, Model, Object, Observer, Photosurface, PlacedScene, Scene, Source, SurfaceOptions,
};
use serde_json::{Value, json};

use crate::common::glb::{Glb, MadeGlb, push};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures/as_written")
        .join(name)
}

/// The JSON of a fixture; all of its data is in it.
fn json_of(name: &str) -> Value {
    let text = std::fs::read(fixture(name)).expect(name);
    serde_json::from_slice(&text).expect(name)
}

/// The model and its notes, or the error in words.
fn read(bytes: &[u8]) -> Result<(Model, Vec<String>), String> {
    match read_gltf_bytes(bytes, Path::new("")) {
        Ok((model, findings)) => Ok((
            model,
            findings.notes.iter().map(ToString::to_string).collect(),
        )),
        Err(error) => Err(error.to_string()),
    }
}

fn read_json(json: &Value) -> Result<(Model, Vec<String>), String> {
    read(json.to_string().as_bytes())
}

/// The one part of a model.
fn only(model: &Model) -> &photosurface::Part {
    let [part] = &model.parts[..] else {
        panic!("{} parts", model.parts.len());
    };
    part
}

fn bounds(model: &Model) -> [[f64; 3]; 2] {
    let (low, high) = model.bounds().expect("vertices");
    [low.to_array(), high.to_array()]
}

const CUBE: [[f64; 3]; 2] = [[-1.0; 3], [1.0; 3]];

#[test]
fn a_scene_that_lists_a_child_draws_it_once_at_its_place() {
    let mut json = json_of("scene_lists_child.gltf");
    let note = |count: &str| {
        vec![format!(
            "scenes[0] lists {count} with a parent, the first \"cube\": drawn once, where the parent places it"
        )]
    };
    let (model, notes) = read_json(&json).expect("a cube");
    assert_eq!(only(&model).name, "cube");
    assert_eq!(bounds(&model), CUBE);
    assert_eq!(notes, note("1 node"));
    json["nodes"][0]["translation"] = json!([10, 0, 0]);
    json["scenes"][0]["nodes"] = json!([1, 0, 1]);
    let (model, notes) = read_json(&json).expect("a cube");
    assert_eq!(only(&model).mesh().triangles().len(), 12);
    assert_eq!(bounds(&model), [[9.0, -1.0, -1.0], [11.0, 1.0, 1.0]]);
    assert_eq!(notes, note("1 node"));
}

#[test]
fn a_matrix_with_rounding_is_read_and_a_perspective_refused() {
    let mut json = json_of("matrix_w_noise.gltf");
    let (model, notes) = read_json(&json).expect("a cube");
    assert_eq!(bounds(&model), CUBE);
    assert_eq!(
        notes,
        [
            "nodes: the bottom row of 1 matrix differs from [0, 0, 0, 1] by up to 1e-7 and is ignored"
        ]
    );
    json["nodes"][0]["matrix"][3] = json!(0.01);
    let error = read_json(&json).expect_err("a perspective");
    assert!(
        error.contains("the bottom row of the matrix is [0.01, 0.0, 0.0, 1.0000001"),
        "{error}"
    );
}

/// A triangle of which every vertex follows the first of two joints, moved up by 1, with these weights for it.
fn skinned(weights: [f32; 3], binds: &[[f32; 16]; 2], other_joint: u8) -> MadeGlb {
    let mut glb = MadeGlb::triangle(0);
    let joints = [0, other_joint, 0, 0].repeat(3);
    let joints = glb.accessor("VEC4", 5121, 3, &joints);
    let weights: Vec<f32> = weights.iter().flat_map(|&w| [w, 0.0, 0.0, 0.0]).collect();
    let weights = glb.floats("VEC4", &weights);
    let binds = glb.floats("MAT4", binds.as_flattened());
    let attributes = &mut glb.primitive()["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let joints = ["up", "elsewhere"].map(|name| {
        let node = json!({ "name": name, "translation": [0, 1, 0] });
        let node = push(&mut glb.json["nodes"], node);
        push(&mut glb.json["scenes"][0]["nodes"], node.into());
        node
    });
    glb.json["nodes"][0]["skin"] = json!(0);
    glb.json["skins"] = json!([{ "joints": joints, "inverseBindMatrices": binds }]);
    glb
}

const IDENTITY: [f32; 16] = [
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
];

#[test]
fn a_vertex_without_weights_follows_its_first_joint() {
    let (model, notes) = read_json(&json_of("skin_zero_weight.gltf")).expect("a cube");
    assert_eq!(bounds(&model), [[-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]]);
    assert_eq!(
        notes,
        [
            "node \"cube\": skin applied in its default pose",
            "mesh \"cube\": 1 vertex without weights: the first joint applies"
        ]
    );
}

#[test]
fn weights_are_divided_by_their_sum_and_what_is_none_is_refused() {
    let up = |notes: &[&str], glb: MadeGlb| {
        let (model, found) = read(&glb.bytes()).expect("a triangle");
        assert_eq!(bounds(&model), [[0.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
        assert_eq!(found[1..], *notes);
    };
    let binds = [IDENTITY; 2];
    up(&[], skinned([1.0, 0.995, 1.0], &binds, 1));
    up(
        &["mesh \"made\": weights of 2 vertices divided by their sum, expected 1"],
        skinned([0.5, 1.0, 3.0], &binds, 1),
    );
    // A joint of no weight need not be there, nor have a matrix that makes sense.
    up(&[], skinned([1.0; 3], &[IDENTITY, [0.0; 16]], 9));
    let mut noisy = IDENTITY;
    noisy[3] = 3e-7;
    let noisy_note = "skins[0].inverseBindMatrices: the bottom row of 1 matrix differs from [0, 0, 0, 1] \
                      by up to 3e-7 and is ignored";
    let (model, found) = read(&skinned([1.0; 3], &[noisy, IDENTITY], 1).bytes()).expect("read");
    assert_eq!(bounds(&model), [[0.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
    assert_eq!(found[0], noisy_note);

    for (glb, expected) in [
        (
            skinned([1.0; 3], &[[0.0; 16], IDENTITY], 1),
            "the bottom row of the matrix is [0.0, 0.0, 0.0, 0.0]",
        ),
        (
            skinned([1.0, -1.0, 1.0], &binds, 1),
            "the weights of vertex 1 add up to -1, expected 1",
        ),
        (
            skinned([1.0, f32::NAN, 1.0], &binds, 1),
            "the weights of vertex 1 add up to NaN, expected 1",
        ),
    ] {
        let error = read(&glb.bytes()).expect_err(expected);
        assert!(error.contains(expected), "{error}");
    }
    let mut without = skinned([1.0; 3], &binds, 1);
    let attributes = without.primitive()["attributes"].as_object_mut();
    attributes.expect("a table").shift_remove("WEIGHTS_0");
    let error = read(&without.bytes()).expect_err("no weights");
    assert!(error.contains("no JOINTS_0 and WEIGHTS_0"), "{error}");
}

#[test]
fn a_surface_scaled_flat_is_drawn() {
    let (model, notes) = read_json(&json_of("card_scale_z0.gltf")).expect("a card");
    let mesh = only(&model).mesh();
    assert_eq!(mesh.triangles().len(), 2);
    assert_eq!(bounds(&model), [[0.0; 3], [2.0, 1.0, 0.0]]);
    assert!(
        mesh.normals()
            .is_some_and(|normals| normals.iter().all(|&normal| normal == DVec3::Z))
    );
    assert_eq!(notes, [""; 0]);
}

/// Where a normal has been in the direction that is left out, the triangle gives one.
#[test]
fn what_is_flat_has_normals_across_it() {
    let mut glb = MadeGlb::triangle(0);
    let normals = glb.floats("VEC3", &[0.6, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
    glb.primitive()["attributes"]["NORMAL"] = normals.into();
    // A quarter turn about x after the scaling, below a parent.
    glb.json["nodes"][0]["scale"] = json!([1, 2, 0]);
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let parent = json!({ "children": [0], "rotation": [h, 0, 0, h] });
    push(&mut glb.json["nodes"], parent);
    glb.json["scenes"][0]["nodes"] = json!([1]);
    let (model, notes) = read(&glb.bytes()).expect("a triangle");
    let mesh = only(&model).mesh();
    let expected = [DVec3::NEG_Y, DVec3::NEG_Y, DVec3::Y];
    for (found, expected) in mesh.normals().expect("always").iter().zip(expected) {
        assert!(found.abs_diff_eq(expected, 1e-15), "{found}");
    }
    let found: Vec<DVec3> = mesh.positions().to_vec();
    for (found, expected) in found.iter().zip([DVec3::ZERO, DVec3::X, DVec3::Z * 2.0]) {
        assert!(found.abs_diff_eq(expected, 1e-15), "{found}");
    }
    assert_eq!(
        notes,
        ["mesh \"made\": 1 zero normal replaced by that of an adjacent triangle"]
    );
    // As small as can be, but a surface; a line is none, and neither is a point.
    for (scale, parts) in [
        ([1e-200, 1e-200, 1e-200], 1),
        ([1.0, 0.0, 0.0], 0),
        ([0.0; 3], 0),
    ] {
        glb.json["nodes"][0]["scale"] = json!(scale);
        let read = read(&glb.bytes());
        assert_eq!(
            read.as_ref().map_or(0, |(model, _)| model.parts.len()),
            parts
        );
        if let Err(error) = read {
            let reason = "node \"it\" is scaled to a line or a point: skipped";
            assert!(error.ends_with(reason), "{error}");
        }
    }
}

#[test]
fn a_primitive_without_positions_is_skipped() {
    let mut json = json_of("prim_without_position.gltf");
    let note = "meshes[0].primitives[1] (mesh \"cube\"): has no POSITION, skipped";
    let (model, notes) = read_json(&json).expect("a cube");
    assert_eq!(bounds(&model), CUBE);
    assert_eq!(only(&model).name, "cube");
    assert_eq!(notes, [note]);
    json["meshes"][0]["primitives"][1] = json!({});
    assert_eq!(read_json(&json).expect("a cube").1, [note]);
    json["meshes"][0]["primitives"][0]["attributes"] = json!({});
    let error = read_json(&json).expect_err("nothing");
    let of_both = "; 2 primitives, the first meshes[0].primitives[0] (mesh \"cube\"): has no POSITION, skipped";
    assert!(error.ends_with(of_both), "{error}");
}

/// All whole numbers of a JSON text as some programs write them.
fn with_points(value: &Value) -> Value {
    match value {
        Value::Number(number) => match number.as_u64() {
            Some(whole) => json!(whole as f64),
            None => value.clone(),
        },
        Value::Array(list) => list.iter().map(with_points).collect(),
        Value::Object(table) => table
            .iter()
            .map(|(name, value)| (name.clone(), with_points(value)))
            .collect(),
        _ => value.clone(),
    }
}

#[test]
fn whole_numbers_may_be_written_with_a_point() {
    for name in ["skin_zero_weight.gltf", "card_scale_z0.gltf"] {
        let json = json_of(name);
        let pointed = with_points(&json);
        assert!(pointed.to_string().contains("\"componentType\":5126.0"));
        assert!(read_json(&pointed).is_ok() && read_json(&pointed) == read_json(&json));
    }
    let mut broken = json_of("card_scale_z0.gltf");
    broken["accessors"][0]["count"] = json!(4.5);
    let error = read_json(&broken).expect_err("half an element");
    assert!(error.starts_with("accessors[0].count: "), "{error}");
}

#[test]
fn the_largest_index_of_a_type_is_the_vertex_of_that_number() {
    for (component, last) in [(5121, 255usize), (5123, 65535)] {
        for vertices in [last, last + 1] {
            let mut glb = MadeGlb::new();
            let corner = |i: usize| [i as f32, (i % 7) as f32, 0.0];
            let corners: Vec<f32> = (0..vertices).flat_map(corner).collect();
            let positions = glb.floats("VEC3", &corners);
            let corners = [last - 2, last - 1, last, 0, 1, 2];
            let bytes: Vec<u8> = match component {
                5121 => corners.iter().map(|&i| i as u8).collect(),
                _ => corners
                    .iter()
                    .flat_map(|&i| (i as u16).to_le_bytes())
                    .collect(),
            };
            let indices = glb.accessor("SCALAR", component, 6, &bytes);
            let primitive = glb.primitive();
            primitive["attributes"]["POSITION"] = positions.into();
            primitive["indices"] = indices.into();
            let read = read(&glb.bytes());
            if vertices == last {
                let error = read.expect_err("no such vertex");
                assert!(error.contains("indices[2]") || error.contains(&last.to_string()));
                continue;
            }
            let (model, notes) = read.expect("two triangles");
            assert_eq!(only(&model).mesh().triangles().len(), 2);
            let (_, high) = model.bounds().expect("vertices");
            assert_eq!(high.x, last as f64);
            assert_eq!(
                notes,
                [format!(
                    "meshes[0].primitives[0] (mesh \"made\"), indices: {last}, reserved by glTF, used 1 time as the index of a vertex"
                )]
            );
        }
    }
}

/// A model as the program writes it, seen from rest, as GLB and as PLY.
fn written(model: &Model) -> (Value, Vec<u8>, Vec<u8>) {
    let named = |name: &str| Object::new(name, Source::Model(Arc::new(model.clone())));
    let scene = Scene::new(Observer::default(), vec![named("one"), named("two")]);
    let placed = PlacedScene::new(
        scene.expect("two objects"),
        vec![model.clone(), model.clone()],
    )
    .expect("one model an object");
    let photosurfaces: Vec<Photosurface> = placed
        .photosurfaces(0, SurfaceOptions::default())
        .unwrap()
        .collect();
    let export = Export {
        scene: &placed.facts(),
        marker: None,
        photosurfaces: &photosurfaces,
        playback: None,
    };
    let (mut glb, mut ply) = (vec![], vec![]);
    write_glb(&export, &mut glb).expect("a file");
    write_ply(&export, &mut ply).expect("a file");
    (Glb::new(&glb).json, glb, ply)
}

#[test]
fn who_made_a_file_and_what_it_says_of_itself_is_carried() {
    let mut source = json_of("attribution.gltf");
    source["meshes"][0]["primitives"][0]["extras"] = json!({"layer": 4});
    let (model, notes) = read_json(&source).expect("a cube");
    assert_eq!(notes, [""; 0]);
    let (json, glb, ply) = written(&model);
    let copyright = "(c) 2024 A. Nother, CC-BY 4.0";
    assert_eq!(json["asset"]["copyright"], copyright);
    assert_eq!(
        json["scenes"][0]["extras"]["sources"],
        json!([{
            "objects": ["one", "two"],
            "copyright": copyright,
            "asset": {"author": "x", "license": "CC-BY-4.0"},
            "scene": {"b": 2},
            "file": {"a": 1},
        }])
    );
    let of_part = &json["nodes"][1]["extras"]["source"];
    assert_eq!(*of_part, json!({"primitive": {"layer": 4}}));
    let header = b"\ncomment copyright (c) 2024 A. Nother, CC-BY 4.0\nelement vertex ";
    assert!(ply.windows(header.len()).any(|bytes| bytes == header));

    // And through the program a second time.
    let (again, _) = read(&glb).expect("the program's own file");
    let (json, ..) = written(&again);
    assert_eq!(json["asset"]["copyright"], copyright);
    let sources = &json["scenes"][0]["extras"]["sources"][0];
    assert_eq!(sources["sources"][0]["asset"]["author"], "x");

    // Without any of it a file says nothing of sources.
    let (plain, _) = read_json(&json_of("matrix_w_noise.gltf")).expect("a cube");
    let (json, ..) = written(&plain);
    assert_eq!(json["asset"].get("copyright"), None);
    assert_eq!(json["scenes"][0]["extras"].get("sources"), None);
}

/// A header of PLY is read line by line; what a file calls itself must not add any.
#[test]
fn a_copyright_of_many_lines_is_none_in_a_header() {
    let mut source = json_of("attribution.gltf");
    source["asset"]["copyright"] = json!(format!("a\nelement vertex 9\n{}", "x".repeat(200)));
    let (model, _) = read_json(&source).expect("a cube");
    let (json, _, ply) = written(&model);
    assert_eq!(json["asset"]["copyright"], source["asset"]["copyright"]);
    let end = ply.windows(10).position(|bytes| bytes == b"end_header");
    let header = std::str::from_utf8(&ply[..end.expect("a header")]).expect("text");
    let lines: Vec<&str> = header.lines().collect();
    assert!(lines.iter().all(|line| line.len() < 80), "{header}");
    let elements = lines.iter().filter(|line| line.starts_with("element"));
    assert_eq!(elements.count(), 2, "{header}");
}

#[test]
fn what_has_extras_without_a_place_is_named() {
    let mut source = json_of("skin_zero_weight.gltf");
    for list in ["accessors", "bufferViews", "buffers", "skins"] {
        source[list][0]["extras"] = json!(1);
    }
    push(&mut source["scenes"], json!({"nodes": [], "extras": 2}));
    let (_, notes) = read_json(&source).expect("a cube");
    for what in [
        "1 accessor",
        "1 buffer view",
        "1 buffer",
        "1 skin",
        "1 scene that is not read",
    ] {
        let note = format!("extras of {what}: not copied");
        assert!(notes.contains(&note), "{note}: {notes:?}");
    }
}

#[test]
fn odd_json_is_no_panic() {
    let text = json_of("attribution.gltf").to_string();
    let twice = text.replacen('{', "{\"asset\":3,\"extras\":{},\"extras\":[1,\"", 1);
    assert!(read(twice.as_bytes()).is_err());
    let twice = text.replacen('{', "{\"asset\":3,\"meshes\":{},", 1);
    assert!(read(twice.as_bytes()).is_ok(), "the last of a name counts");
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        let deep = format!("{}0{}", open.repeat(100_000), close.repeat(100_000));
        let deep = text.replacen('{', &format!("{{\"extras\":{deep},"), 1);
        let error = read(deep.as_bytes()).expect_err("too deep");
        assert!(error.starts_with("not glTF"), "{error}");
    }
    let long = "x".repeat(5_000_000);
    let mut source = json_of("attribution.gltf");
    source["nodes"][0]["extras"] = json!({ "long": long });
    let (model, _) = read_json(&source).expect("a cube");
    let (json, ..) = written(&model);
    assert_eq!(json["nodes"][1]["extras"]["source"]["node"]["long"], long);
}

#[test]
fn the_fixtures_are_read_as_files_too() {
    for name in [
        "attribution",
        "scene_lists_child",
        "matrix_w_noise",
        "skin_zero_weight",
        "card_scale_z0",
        "prim_without_position",
    ] {
        let (model, _) = read_model(&fixture(&format!("{name}.gltf"))).expect(name);
        assert_eq!(model.parts.len(), 1, "{name}");
    }
}
