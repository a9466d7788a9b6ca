//! Reading OBJ and MTL files as programs really write them.

use std::path::{Path, PathBuf};

use photosurface::{DVec3, Model, read_model};

fn fixture(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("fixtures/text").join(name)
}

/// A model and its notes as text.
fn read(path: &Path) -> (Model, Vec<String>) {
    let (model, findings) = read_model(path).unwrap_or_else(|e| panic!("{path:?}: {e}"));
    let notes = findings.notes.iter().map(ToString::to_string);
    (model, notes.collect())
}

fn bounds(model: &Model) -> (DVec3, DVec3) {
    model.parts[0].mesh().bounds().expect("vertices")
}

/// Names and base colours of the materials of all parts.
fn materials(model: &Model) -> Vec<(&str, [f64; 3])> {
    let parts = model.parts.iter();
    let materials = parts.map(|part| part.material.as_deref().expect("a material"));
    let look = |material: &photosurface::Material| {
        let [r, g, b, _] = material.base_color();
        [r, g, b]
    };
    materials
        .map(|m| (m.name().unwrap_or_default(), look(m)))
        .collect()
}

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const GREEN: [f64; 3] = [0.0, 1.0, 0.0];

#[test]
fn a_byte_order_mark_is_no_part_of_the_first_line() {
    let (model, notes) = read(&fixture("bom_silent.obj"));
    assert_eq!(bounds(&model), (DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)));
    assert_eq!(notes, [""; 0]);
    let (model, _) = read(&fixture("bom_first_v.obj"));
    assert_eq!(bounds(&model), (DVec3::NEG_ONE, DVec3::ONE));
    let (model, _) = read(&fixture("bom_mtllib.obj"));
    assert_eq!(materials(&model), [("red", RED)]);
}

#[test]
fn names_are_told_apart_by_their_bytes() {
    let (model, _) = read(&fixture("latin1.obj"));
    assert_eq!(materials(&model), [("Stühle", RED), ("Stöhle", GREEN)]);
    let (model, _) = read(&fixture("hash_two_materials.obj"));
    assert_eq!(materials(&model), [("#ff0000", RED), ("#00ff00", GREEN)]);
}

#[test]
fn statements_may_be_in_lower_case_and_pictures_in_quotes() {
    for name in ["lower_map.obj", "quoted.obj"] {
        let (model, notes) = read(&fixture(name));
        let material = model.parts[0].material.as_ref().expect("a material");
        assert_eq!(material.textures().len(), 1, "{name}");
        assert_eq!(notes, [""; 0], "{name}");
    }
    assert_eq!(materials(&read(&fixture("lower_map.obj")).0), [("m", RED)]);
}

#[test]
fn what_is_wrong_beside_the_shape_is_passed_over_with_a_note() {
    for (name, note) in [
        (
            "dangling_vn.obj",
            "a vt or vn of a corner that is not there: passed over 24 times",
        ),
        (
            "nan_vn.obj",
            "a vn that is not three finite numbers: passed over once, in line 9",
        ),
        (
            "rgba7.obj",
            "numbers behind the colour of v: passed over 8 times, first in line 1",
        ),
        (
            "w_weight.obj",
            "the fourth number of v: passed over 8 times, first in line 1",
        ),
    ] {
        let (model, notes) = read(&fixture(name));
        assert_eq!(notes[0], note, "{name}");
        assert_eq!(bounds(&model), (DVec3::NEG_ONE, DVec3::ONE), "{name}");
        let mesh = model.parts[0].mesh();
        assert_eq!(mesh.triangles().len(), 12, "{name}");
        assert_eq!(mesh.colors().is_some(), name == "rgba7.obj", "{name}");
    }
}

#[test]
fn parts_are_by_material_and_keep_names_without_a_library() {
    let (model, _) = read(&fixture("alternating_small.obj"));
    assert_eq!(materials(&model), [("m0", RED), ("m1", GREEN)]);
    assert!(model.parts.iter().all(|p| p.mesh().triangles().len() == 8));
    let (model, notes) = read(&fixture("no_mtl.obj"));
    let names: Vec<&str> = materials(&model).iter().map(|m| m.0).collect();
    assert_eq!(names, ["wood", "iron"]);
    assert_eq!(notes.len(), 3, "{notes:?}");
}

#[test]
fn any_end_of_line_and_encoding_of_one_file_gives_one_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.obj");
    let text = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl é\nf 1 2 \\\n3\nf 2 4 3";
    let mut models = vec![];
    let utf_16 = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [
        text.to_owned().into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        text.replace('\n', " \t\r\n").into_bytes(),
        text.to_uppercase().into_bytes(),
        utf_16,
    ] {
        std::fs::write(&path, bytes).expect("a file");
        models.push(read(&path).0);
    }
    for (i, model) in models.iter().enumerate() {
        assert_eq!(model.parts.len(), 1, "{i}");
        let mesh = model.parts[0].mesh();
        assert_eq!(
            mesh.triangles(),
            models[0].parts[0].mesh().triangles(),
            "{i}"
        );
        assert_eq!(
            mesh.positions(),
            models[0].parts[0].mesh().positions(),
            "{i}"
        );
    }
}

#[test]
fn many_materials_libraries_and_groups_are_read_in_time() {
    use std::fmt::Write;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let count = 20_000;
    let mut library = String::new();
    let mut file = "mtllib ./a.mtl\nmtllib a.mtl\n".repeat(2_000);
    file += "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    file += &format!("o {}\n", "long".repeat(100_000));
    for i in 0..count {
        // A texture without texture coordinates gives a note for each part.
        writeln!(library, "newmtl m{i}\nKd 1 0 0\nmap_Ks a{i}.png").expect("room");
        writeln!(file, "usemtl m{i}\nf 1 2 3").expect("room");
    }
    let path = folder.path().join("a.obj");
    std::fs::write(folder.path().join("a.mtl"), library).expect("a file");
    std::fs::write(&path, file).expect("a file");
    let start = std::time::Instant::now();
    let (model, _) = read(&path);
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(model.parts.len(), count);
    assert!(model.parts.iter().all(|part| part.name.len() < 1_100));
    assert!(seconds < 20.0, "{seconds} s");
}
