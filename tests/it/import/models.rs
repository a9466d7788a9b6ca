//! Reading models: what small files with one issue each become.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common::Random;
use photosurface::material::{AlphaMode, Wrap};
use photosurface::read::{ReadError, read_gltf_bytes, read_model, read_model_bytes};
use photosurface::{DVec3, Model, Part, Vec2, Vec4};
use serde_json::json;

/// The rectangle that most fixtures show, as its two triangles.
const RECTANGLE: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [2.0, 3.0, 0.0],
    [0.0, 0.0, 0.0],
    [2.0, 3.0, 0.0],
    [0.0, 3.0, 0.0],
];

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures/meshes")
        .join(name)
}

/// The model in a fixture, and its notes as text.
fn read(name: &str) -> (Model, Vec<String>) {
    match read_model(&fixture(name)) {
        Ok((model, findings)) => {
            let notes = findings.notes.iter().map(ToString::to_string);
            (model, notes.collect())
        }
        Err(error) => panic!("{name}: {error}"),
    }
}

/// The only part of a fixture that gives no notes.
fn read_part(name: &str) -> Part {
    let (mut model, notes) = read(name);
    assert_eq!(notes, [""; 0], "{name}");
    assert_eq!(model.parts.len(), 1, "{name}");
    model.parts.remove(0)
}

fn read_error(name: &str) -> String {
    let error = read_model(&fixture(name)).expect_err(name);
    error.to_string()
}

/// The corners of all triangles.
fn corners(part: &Part) -> Vec<DVec3> {
    let indices = part.mesh().triangles().iter().flatten();
    indices
        .map(|&i| part.mesh().positions()[i as usize])
        .collect()
}

fn names(model: &Model) -> Vec<&str> {
    model.parts.iter().map(|part| part.name.as_str()).collect()
}

/// Asserts that the triangles of a part have these corners, in this order, and that the normals
/// are those of the triangles.
fn assert_corners(part: &Part, expected: &[[f64; 3]]) {
    let found = corners(part);
    let expected: Vec<DVec3> = expected.iter().map(|&corner| corner.into()).collect();
    let same = found.len() == expected.len()
        && found
            .iter()
            .zip(&expected)
            .all(|(a, b)| a.abs_diff_eq(*b, 1e-12));
    assert!(same, "found {found:?}\nexpected {expected:?}");
    for (triangle, positions) in part.mesh().triangles().iter().zip(expected.chunks(3)) {
        let flat = (positions[1] - positions[0]).cross(positions[2] - positions[0]);
        for &corner in triangle {
            let normal = part.mesh().normals().expect("always there")[corner as usize];
            assert!(normal.abs_diff_eq(flat.normalize(), 1e-12), "{normal}");
        }
    }
}

fn moved(by: [f64; 3]) -> Vec<[f64; 3]> {
    let add = |corner: &[f64; 3]| [corner[0] + by[0], corner[1] + by[1], corner[2] + by[2]];
    RECTANGLE.iter().map(add).collect()
}

#[test]
fn the_same_rectangle_from_every_storage() {
    for name in [
        "strip.glb",
        "fan.glb",
        "non_indexed.glb",
        "indices_u8.glb",
        "indices_u16.glb",
        "indices_u32.glb",
        "sparse_without_view.glb",
        "interleaved.glb",
        "data_uri.gltf",
        "external.gltf",
        "quantized.glb",
    ] {
        let part = read_part(name);
        assert_eq!(part.name, "node", "{name}");
        // Strips and fans start with another corner.
        let mut found = corners(&part);
        let mut expected: Vec<DVec3> = RECTANGLE.iter().map(|&corner| corner.into()).collect();
        match name {
            "strip.glb" => expected = [1, 2, 0, 2, 5, 0].map(|i| expected[i]).to_vec(),
            "fan.glb" => expected = [1, 2, 0, 2, 5, 0].map(|i| expected[i]).to_vec(),
            _ => {}
        }
        // 0.001 is not a binary number.
        found
            .iter_mut()
            .for_each(|corner| *corner = (*corner * 1e9).round() / 1e9);
        assert_eq!(found, expected, "{name}");
        assert!(
            part.mesh()
                .normals()
                .expect("always there")
                .iter()
                .all(|&n| n == DVec3::Z)
        );
    }
}

#[test]
fn sparse_values_replace_those_of_the_view() {
    let mut expected = RECTANGLE;
    expected[2][2] = 7.0;
    expected[4][2] = 7.0;
    assert_corners(&read_part("sparse.glb"), &expected);
}

#[test]
fn transforms_nest_in_double_precision() {
    let part = read_part("nested.glb");
    assert_eq!(part.name, "child");
    // Doubled, moved by 1 along x, turned by a quarter about z, moved by 10 along y and 0.1 along z.
    let place = |[x, y, _]: [f64; 3]| [-2.0 * y, 10.0 + 2.0 * x + 1.0, 0.1];
    assert_corners(&part, &RECTANGLE.map(place));
}

#[test]
fn a_mirrored_node_keeps_its_outside() {
    let part = read_part("mirrored.glb");
    let [a, b, c, d, e, f] = RECTANGLE.map(|[x, y, z]| [-x, y, z]);
    // Wound the other way round, so that it still faces +z.
    assert_corners(&part, &[a, c, b, d, f, e]);
    assert!(
        part.mesh()
            .normals()
            .expect("always there")
            .iter()
            .all(|&n| n == DVec3::Z)
    );
}

#[test]
fn one_mesh_at_two_nodes_is_two_parts() {
    let (model, notes) = read("instanced.glb");
    assert!(notes.is_empty());
    assert_eq!(names(&model), ["left", "right"]);
    assert_corners(&model.parts[0], &RECTANGLE);
    assert_corners(&model.parts[1], &moved([5.0, 0.0, 0.0]));

    let (model, notes) = read("gpu_instanced.glb");
    assert!(notes.is_empty());
    assert_eq!(names(&model), ["node_1", "node_2", "node_3"]);
    for (i, part) in model.parts.iter().enumerate() {
        assert_corners(part, &moved([10.0 * i as f64, 1.0, 0.0]));
    }
}

#[test]
fn the_default_scene_is_read() {
    let (model, notes) = read("several_scenes.glb");
    assert_eq!(names(&model), ["second"]);
    assert_eq!(notes, ["2 scenes: only scenes[1] is read"]);
    let (model, notes) = read("no_scene.glb");
    assert_eq!(names(&model), ["shown"]);
    assert_eq!(notes, ["no scenes: all nodes are read"]);
    assert_eq!(
        read_error("empty_scene.glb"),
        "no triangles, expected at least one; the file has 0 nodes and 0 meshes"
    );
}

#[test]
fn what_has_no_surface_is_skipped_with_a_note() {
    let (model, notes) = read("zero_scale.glb");
    assert_eq!(names(&model), ["full"]);
    assert_eq!(
        notes,
        ["node \"flat\" is scaled to a line or a point: skipped"]
    );
    let (model, notes) = read("points_and_lines.glb");
    assert_eq!(names(&model), ["node"]);
    assert_corners(&model.parts[0], &RECTANGLE);
    assert_eq!(
        notes,
        [
            "meshes[0].primitives[3] (mesh \"mixed\"): 2 left-over indices skipped, \
             expected three for each triangle",
            "meshes[0].primitives[3] (mesh \"mixed\"): has no triangles, skipped",
            "node \"node\": 2 primitives of points or lines skipped",
        ]
    );
    assert_eq!(
        read_error("points_only.glb"),
        "no triangles, expected at least one; the file has 1 node and 1 mesh; \
         node \"node\": 1 primitive of points or lines skipped"
    );
    let error = read_error("count_zero.glb");
    assert!(
        error.starts_with("no triangles, expected at least one;"),
        "{error}"
    );
    let (model, notes) = read("lines.obj");
    assert_eq!(model.triangle_count(), 1);
    assert_eq!(notes, ["the file: 2 primitives of points or lines skipped"]);
}

/// glTF has it that a mesh has a primitive; some exporters leave an empty one behind.
#[test]
fn a_mesh_without_primitives_is_named() {
    let json = br#"{ "asset": { "version": "2.0" }, "nodes": [{ "mesh": 0 }, { "mesh": 1 }],
        "meshes": [{ "name": "gone", "primitives": [] }, { "primitives": [] }] }"#;
    let error = read_gltf_bytes(json, Path::new("")).expect_err("no triangles");
    let message = error.to_string();
    let note = "; 2 meshes, the first meshes[0] (mesh \"gone\"): has no triangles, skipped";
    assert!(message.ends_with(note), "{message}");
}

#[test]
fn parts_of_one_node_are_told_apart_by_their_materials() {
    let (model, _) = read("two_primitives.glb");
    assert_eq!(names(&model), ["node_paint", "node_glass"]);
    let (model, _) = read("materials.glb");
    assert_eq!(names(&model), ["node_1", "node_2", "node_3"]);
}

#[test]
fn all_texture_coordinates_are_carried() {
    let part = read_part("two_texture_coordinates.glb");
    let sets = part.mesh().texture_coordinates();
    assert_eq!(sets.len(), 2);
    // Flat normals gave every corner a vertex of its own; the last one is (0, 3, 0).
    assert_eq!((sets[0][2], sets[0][5]), (Vec2::ONE, Vec2::Y));
    assert_eq!((sets[1][2], sets[1][5]), (Vec2::new(2.0, 1.0), Vec2::ONE));
}

#[test]
fn colors_of_every_type_mean_the_same() {
    for name in ["colors_f32.glb", "colors_u8.glb", "colors_u16.glb"] {
        let part = read_part(name);
        let colors = part.mesh().colors().expect(name);
        assert_eq!(colors[0], Vec4::new(1.0, 0.0, 0.0, 1.0), "{name}");
        assert!(
            colors[5].abs_diff_eq(Vec4::new(0.2, 0.4, 0.6, 1.0), 1e-7),
            "{name}"
        );
    }
    let (model, notes) = read("colors_bright.glb");
    let colors = model.parts[0].mesh().colors().expect("colours");
    assert_eq!(colors[0], Vec4::new(1.0, 0.5, 0.0, 1.0));
    assert_eq!(
        notes,
        ["mesh \"rectangle\": 1 colour outside 0 to 1 clamped"]
    );
}

#[test]
fn attributes_of_its_own_are_named() {
    let (_, notes) = read("custom_attributes.glb");
    assert_eq!(notes, ["mesh \"rectangle\": _DOPPLER, _HEAT not copied"]);
}

#[test]
fn zero_normals_become_flat_ones() {
    let (model, notes) = read("zero_normals.glb");
    let normals = model.parts[0].mesh().normals().expect("always there");
    assert_eq!(normals, [DVec3::Z, DVec3::X, DVec3::Z, DVec3::Y]);
    assert_eq!(
        notes,
        ["mesh \"rectangle\": 2 zero normals replaced by that of an adjacent triangle"]
    );
}

#[test]
fn morph_targets_have_their_default_weights() {
    let (model, notes) = read("morph.glb");
    // 0.5 * 1 + 0.25 * 10, then 1 * 1 + 0 * 10.
    assert_corners(&model.parts[0], &moved([0.0, 0.0, 3.0]));
    assert_corners(&model.parts[1], &moved([0.0, 0.0, 1.0]));
    assert_eq!(
        notes,
        [
            "mesh \"rectangle\": morph targets applied with weights [0.5, 0.25]",
            "mesh \"rectangle\": morph targets applied with weights [1.0, 0.0]",
        ]
    );
}

#[test]
fn a_skin_has_its_default_pose() {
    let (model, notes) = read("skin.glb");
    let expected = RECTANGLE.map(|[x, y, z]| [x, if y > 0.0 { y + 4.0 } else { y }, z]);
    assert_corners(&model.parts[0], &expected);
    assert_eq!(
        notes,
        ["node \"skinned\": skin applied in its default pose"]
    );
}

#[test]
fn materials_and_images_are_carried_and_shared() {
    let (model, notes) = read("materials.glb");
    let [red, lost, again] =
        [0, 1, 2].map(|i| model.parts[i].material.clone().expect("a material"));
    assert!(Arc::ptr_eq(&red, &again));
    assert_eq!(red.name(), Some("red"));
    assert_eq!(red.base_color(), [0.5, 0.25, 1.0, 0.5]);
    assert_eq!(
        (red.alpha_mode(), red.double_sided()),
        (AlphaMode::Blend, true)
    );
    let surface = &red.properties()["pbrMetallicRoughness"];
    assert_eq!(
        (&surface["metallicFactor"], &surface["roughnessFactor"]),
        (&json!(0.125), &json!(0.75))
    );
    assert_eq!(red.properties()["emissiveFactor"], json!([1, 1, 1]));
    let (texture, tex_coord) = red.base_color_texture().expect("a texture");
    assert_eq!(tex_coord, 0);
    let sampler = json!({ "magFilter": 9728, "wrapS": 33071 });
    assert_eq!(texture.sampler(), Some(&sampler));
    assert_eq!(texture.wrap(), [Wrap::ClampToEdge, Wrap::Repeat]);
    let image = texture.image().expect("one for every program");
    assert_eq!(image.mime_type(), "image/png");
    let file = std::fs::read(fixture("textures/red.png")).expect("a fixture");
    assert_eq!(image.bytes(), file);
    assert_eq!(lost.base_color_texture(), None);
    assert!(
        notes[0].starts_with("image \"missing.png\" dropped: cannot read "),
        "{notes:?}"
    );
    assert_eq!(notes.len(), 1);
}

#[test]
fn what_cannot_be_read_is_refused_by_name_and_place() {
    let place = "meshes[0].primitives[0] (mesh \"rectangle\")";
    let refused = |extension: &str| {
        format!(
            "needs the glTF extension {extension}, which is not supported; expected plain glTF 2.0"
        )
    };
    for (name, expected) in [
        ("draco.glb", refused("KHR_draco_mesh_compression")),
        ("meshopt.glb", refused("EXT_meshopt_compression")),
        ("unknown_extension.glb", refused("ACME_procedural_mesh")),
        (
            "nan_position.glb",
            format!("{place}: POSITION of vertex 3 is [NaN, 0, 0], expected finite numbers"),
        ),
        (
            "index_out_of_range.glb",
            format!("{place}: triangle 1 uses vertex 4, expected an index below 4"),
        ),
        (
            "accessor_out_of_bounds.glb",
            format!(
                "{place}, POSITION, accessors[0]: ends at byte 60 of bufferViews[0], which has 48"
            ),
        ),
        // Before anything is made room for.
        (
            "huge_count.glb",
            format!(
                "{place}, POSITION, accessors[0]: ends at byte 51539607540 of bufferViews[0], which has 48"
            ),
        ),
        (
            "count_mismatch.glb",
            format!("{place}, NORMAL, accessors[0]: has 3 elements, expected 4"),
        ),
        (
            "cyclic.glb",
            "nodes[1] (\"b\"): is among its own descendants, expected a tree".to_owned(),
        ),
        (
            "bad_number.obj",
            "line 7: \"two\", expected a finite number".to_owned(),
        ),
    ] {
        assert_eq!(read_error(name), expected, "{name}");
    }
    let error = read_model(&fixture("missing_buffer.gltf")).expect_err("no such file");
    assert!(matches!(error, ReadError::File { path, .. } if path == fixture("missing.bin")));
}

#[test]
fn the_kind_of_file_is_told_by_name_or_content() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let odd = folder.path().join("model.bin");
    std::fs::copy(fixture("strip.glb"), &odd).expect("a copy");
    assert_eq!(read_model(&odd).expect("a GLB file").0.triangle_count(), 2);
    let upper = folder.path().join("MODEL.OBJ");
    std::fs::copy(fixture("quad.obj"), &upper).expect("a copy");
    assert_eq!(
        read_model(&upper).expect("an OBJ file").0.parts[0].name,
        "MODEL"
    );
    for (name, text) in [
        (
            "ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
          element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        ),
        (
            "stl",
            "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
        ),
        ("off", "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
    ] {
        for file in [format!("model.{name}"), format!("{name} without extension")] {
            let path = folder.path().join(file);
            std::fs::write(&path, text).expect("a file");
            let (model, findings) = read_model(&path).expect(name);
            assert_eq!(model.triangle_count(), 1, "{name}");
            assert_eq!(findings.files, [path]);
        }
        let (model, _) = read_model_bytes(text.as_bytes(), Path::new("")).expect(name);
        assert_eq!(model.triangle_count(), 1, "{name}");
    }
    let other = folder.path().join("model.fbx");
    std::fs::copy(fixture("quad.obj"), &other).expect("a copy");
    assert_eq!(
        read_model(&other).expect_err("unknown").to_string(),
        "unknown kind of file \"fbx\", expected .glb, .gltf, .obj, .ply, .stl or .off; Blender or MeshLab convert other \
         formats"
    );
}

#[test]
fn obj_faces_become_triangles() {
    let part = read_part("quad.obj");
    assert_eq!(part.name, "quad");
    let [a, b, c, d] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    assert_corners(&part, &[a, b, c, a, c, d]);
    // v counts from below in OBJ and from above in glTF.
    let set = &part.mesh().texture_coordinates()[0];
    assert_eq!((set[0], set[5]), (Vec2::Y, Vec2::ZERO));

    // -4 -3 -2 and, one vertex later, -5 -3 -2.
    assert_corners(&read_part("negative_indices.obj"), &[a, b, c, a, c, d]);

    let part = read_part("concave.obj");
    let mut area = 0.0;
    for triangle in corners(&part).chunks(3) {
        let cross = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        assert!(
            cross.z > 0.0,
            "{triangle:?} is outside the polygon or upside down"
        );
        area += cross.z / 2.0;
    }
    assert_eq!(area, 1.0);
}

#[test]
fn obj_groups_and_materials_become_parts() {
    let (model, notes) = read("groups.obj");
    assert_eq!(names(&model), ["lower_red", "lower_glass", "upper"]);
    let [red, glass, upper] =
        [0, 1, 2].map(|i| model.parts[i].material.clone().expect("a material"));
    assert!(Arc::ptr_eq(&glass, &upper));
    assert_eq!(red.base_color(), [0.5, 0.25, 1.0, 1.0]);
    let surface = &red.properties()["pbrMetallicRoughness"];
    assert_eq!(
        (&surface["metallicFactor"], &surface["roughnessFactor"]),
        (&json!(0.0), &json!(0.5))
    );
    assert_eq!(
        (red.alpha_mode(), red.double_sided()),
        (AlphaMode::Opaque, true)
    );
    assert_eq!(glass.base_color(), [1.0, 1.0, 1.0, 0.5]);
    assert_eq!(glass.alpha_mode(), AlphaMode::Blend);
    assert!(
        notes[0].starts_with("image \"bump.png\" dropped: cannot read "),
        "{notes:?}"
    );
    assert!(
        notes[1].starts_with("image \"missing.png\" dropped: cannot read "),
        "{notes:?}"
    );
    assert_eq!(
        notes[2],
        "part \"lower_red\": no texture coordinates for the baseColorTexture of material \"red\", dropped"
    );

    let (model, notes) = read("missing_mtl.obj");
    let gold = model.parts[0].material.as_ref().expect("a material");
    assert_eq!(gold.properties(), &json!({ "name": "gold" }));
    assert!(
        notes[0].contains("nowhere.mtl\" skipped: cannot read "),
        "{notes:?}"
    );
    assert_eq!(
        notes[1],
        "material \"gold\" is not defined: parts keep only its name"
    );
}

/// Files cut off or changed in random places are read or refused, but never cause a panic.
#[test]
fn no_bytes_cause_a_panic() {
    let folder = fixture("");
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("the fixtures")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|e| ["glb", "gltf", "obj"].iter().any(|&x| e == x))
        })
        .collect();
    files.sort();
    assert!(files.len() > 40);
    let temporary = tempfile::tempdir().expect("a temporary folder");
    std::fs::copy(fixture("groups.mtl"), temporary.path().join("groups.mtl")).expect("a copy");
    let mut random = Random::new(1);
    let mut read = 0;
    for path in &files {
        let bytes = std::fs::read(path).expect("a fixture");
        for case in 0..150 {
            let mutated = mutate(&bytes, case, &mut random);
            let result = catch_unwind(AssertUnwindSafe(|| {
                if path.extension().is_some_and(|extension| extension == "obj") {
                    let file = temporary.path().join("mutated.obj");
                    std::fs::write(&file, &mutated).expect("a temporary file");
                    read_model(&file).is_ok()
                } else {
                    read_gltf_bytes(&mutated, &folder).is_ok()
                }
            }));
            match result {
                Ok(was_read) => read += usize::from(was_read),
                Err(_) => panic!(
                    "panic on case {case} of {path:?}: {:?}",
                    mutated.escape_ascii().to_string()
                ),
            }
        }
    }
    // Some changes are harmless: that shows that the others reach beyond the first check.
    assert!(read > files.len() * 10, "{read}");
}

/// Cuts the file off, changes bytes anywhere, or changes numbers in its text.
fn mutate(bytes: &[u8], case: usize, random: &mut Random) -> Vec<u8> {
    let mut mutated = bytes.to_vec();
    match case % 5 {
        0 => mutated.truncate(random.below(bytes.len())),
        1 => {
            for _ in 0..=random.below(3) {
                mutated[random.below(bytes.len())] = random.below(256) as u8;
            }
        }
        // Behind the text of a GLB file.
        2 => {
            let half = bytes.len() / 2;
            mutated[half + random.below(bytes.len() - half)] =
                [0, 0x7f, 0x80, 0xff][random.below(4)];
        }
        _ => {
            let digits: Vec<usize> = (0..bytes.len())
                .filter(|&i| bytes[i].is_ascii_digit())
                .collect();
            let at = digits[random.below(digits.len())];
            let numbers: [&[u8]; 8] = [
                b"0",
                b"1",
                b"3",
                b"9",
                b"-1",
                b"255",
                b"4294967295",
                b"9223372036854775807",
            ];
            let number = numbers[random.below(numbers.len())];
            mutated.splice(at..=at, number.iter().copied());
            // A GLB file has to stay as long as it says.
            if bytes.starts_with(b"glTF") {
                mend_lengths(&mut mutated, number.len() as u32 - 1);
            }
        }
    }
    mutated
}

/// Adds to the lengths of a GLB file and of its first chunk.
fn mend_lengths(glb: &mut [u8], more: u32) {
    for at in [8, 12] {
        let word: [u8; 4] = glb[at..at + 4].try_into().expect("four bytes");
        let length = u32::from_le_bytes(word) + more;
        glb[at..at + 4].copy_from_slice(&length.to_le_bytes());
    }
}
