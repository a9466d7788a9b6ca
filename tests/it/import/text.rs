//! Reading OBJ and MTL files as programs really write them.

use std::path::{Path, PathBuf};

use photosurface::read::read_model;
use photosurface::{DVec3, Model};

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
    let look = |material: &photosurface::material::Material| {
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

/// The pixels of the texture in a slot of the only material of a file.
fn pixels(model: &Model, slot: &str) -> image::RgbaImage {
    let material = model.parts[0].material.as_ref().expect("a material");
    let index = &material.properties()["pbrMetallicRoughness"][slot]["index"];
    let index = index.as_u64().expect("a texture") as usize;
    let image = material.textures()[index].image().expect("an image");
    let decoded = image::load_from_memory(image.bytes()).expect("a PNG");
    decoded.to_rgba8()
}

#[test]
fn opacity_roughness_and_metalness_are_packed_as_gltf_has_them() {
    let (model, notes) = read(&fixture("pbrmaps.obj"));
    // BT.709: red weighs 0.2126.
    let grey = 54;
    let opacity = pixels(&model, "baseColorTexture");
    assert_eq!(opacity.dimensions(), (2, 2));
    assert!(opacity.pixels().all(|p| p.0 == [255, 255, 255, grey]));
    let gloss = pixels(&model, "metallicRoughnessTexture");
    assert!(gloss.pixels().all(|p| p.0 == [255, grey, grey, 255]));
    let material = model.parts[0].material.as_ref().expect("a material");
    let properties = material.properties();
    let surface = &properties["pbrMetallicRoughness"];
    assert_eq!(surface["roughnessFactor"], 0.5);
    assert_eq!(surface["metallicFactor"], 1.0);
    assert_eq!(properties["alphaMode"], "BLEND");
    // Only the picture of the colour, which is not there, is spoken of.
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("image \"my red tex.png\" dropped"));
}

#[test]
fn packed_pictures_may_differ_in_size_and_lie_but_not_exceed_the_limit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name);
    let rough = image::GrayImage::from_fn(2, 1, |x, _| image::Luma([200 * x as u8]));
    rough.save(file("rough.png")).expect("a picture");
    let metal = image::GrayImage::from_pixel(4, 3, image::Luma([77]));
    metal.save(file("metal.png")).expect("a picture");
    let color = image::RgbImage::from_fn(4, 3, |x, y| image::Rgb([x as u8, y as u8, 9]));
    color.save(file("color.png")).expect("a picture");
    let clear = image::RgbaImage::from_fn(4, 3, |x, y| image::Rgba([5, 5, 5, (50 * x + y) as u8]));
    clear.save(file("clear.png")).expect("a picture");
    let obj = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    std::fs::write(file("a.obj"), obj).expect("a file");
    let with = |library: &str, max_texture_pixels: u64| {
        std::fs::write(file("a.mtl"), format!("newmtl m\n{library}\n")).expect("a file");
        let access = photosurface::read::Access {
            max_texture_pixels,
            ..photosurface::read::Access::default()
        };
        let (model, findings) = access.read_model(&file("a.obj")).expect("a model");
        let notes: Vec<String> = findings.notes.iter().map(ToString::to_string).collect();
        (model, notes)
    };
    let maps = "Pm 0\nmap_Pr rough.png\nmap_Pm metal.png\nmap_Kd color.png\nmap_d clear.png";
    let (model, notes) = with(maps, 1 << 20);
    let gloss = pixels(&model, "metallicRoughnessTexture");
    assert_eq!(gloss.dimensions(), (4, 3));
    assert!(gloss.pixels().all(|p| p.0[2] == 77));
    let row: Vec<u8> = (0..4).map(|x| gloss.get_pixel(x, 1).0[1]).collect();
    assert_eq!((row[0], row[3]), (0, 200));
    assert!(row.is_sorted() && row[1] < 100 && row[2] > 100, "{row:?}");
    let expected =
        "image \"rough + metal\" combines images of different sizes: scaled to the larger size";
    assert_eq!(notes, [expected]);
    let base = pixels(&model, "baseColorTexture");
    for (x, y, pixel) in base.enumerate_pixels() {
        assert_eq!(pixel.0, [x as u8, y as u8, 9, (50 * x + y) as u8]);
    }
    let material = model.parts[0].material.as_ref().expect("a material");
    let surface = &material.properties()["pbrMetallicRoughness"];
    // Zero would hide the picture.
    assert_eq!(surface["metallicFactor"], 1.0);
    assert_eq!(surface["roughnessFactor"], 1.0);

    // A picture that lies in another way cannot be put together with another, nor one above the limit.
    let (model, notes) = with("Pm 0\nmap_Pr rough.png\nmap_Pm -s 2 2 2 metal.png", 1 << 20);
    let material = model.parts[0].material.as_ref().expect("a material");
    let surface = &material.properties()["pbrMetallicRoughness"];
    assert_eq!(surface["metallicFactor"], 0.0);
    assert_eq!(
        pixels(&model, "metallicRoughnessTexture").dimensions(),
        (2, 1)
    );
    let expected = "material \"m\": map_Pm (laid in another way than map_Pr) not copied";
    assert_eq!(notes, [expected]);
    let (model, notes) = with("map_Pr rough.png\nmap_Pm metal.png", 20);
    let material = model.parts[0].material.as_ref().expect("a material");
    assert!(material.textures().is_empty());
    assert_eq!(
        notes,
        [
            "material \"m\": map_Pm (4 x 3 pixels, expected at most 6 more; --max-texture-pixels \
             allows more) not copied"
        ]
    );
}

#[test]
fn what_is_wrong_beside_the_shape_is_passed_over_with_a_note() {
    for (name, note) in [
        (
            "dangling_vn.obj",
            "a vt or vn of a corner that is not there: ignored 24 times",
        ),
        (
            "nan_vn.obj",
            "a vn that is not three finite numbers: ignored once, in line 9",
        ),
        (
            "rgba7.obj",
            "numbers behind the colour of v: ignored 8 times, first in line 1",
        ),
        (
            "w_weight.obj",
            "the fourth number of v: ignored 8 times, first in line 1",
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
