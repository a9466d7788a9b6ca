//! What a file may have read that somebody else made: where it lies, what it is, how large its pictures are.

use std::collections::HashSet;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use crate::common::command::{BALL, Run, SQUARE, Workplace, glb_json};
use crate::common::glb::{Glb, pack};
use photosurface::read::{Access, Note, ReadError, read_gltf_bytes};
use serde_json::{Value, json};

/// What nobody but its owner should see; as a buffer, three corners.
fn secret() -> Vec<u8> {
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    corners.iter().flat_map(|c| c.to_le_bytes()).collect()
}

/// A triangle whose corners are in the buffer that `uri` names.
fn triangle(uri: &str) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "materials": [{}],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri": uri }],
    })
}

/// The same with its corners within reach, and a picture that `uri` names.
fn painted(uri: &str) -> Value {
    let mut file = triangle("own.bin");
    file["materials"] = json!([{ "emissiveTexture": { "index": 0 },
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    file["textures"] = json!([{ "source": 0 }]);
    file["images"] = json!([{ "uri": uri }]);
    file["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(1);
    let places = json!({ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2" });
    file["accessors"]
        .as_array_mut()
        .expect("a list")
        .push(places);
    file
}

fn png(side: u32) -> Vec<u8> {
    let mut bytes = Cursor::new(vec![]);
    let picture = image::RgbImage::from_pixel(side, side, image::Rgb([250, 30, 20]));
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .expect("a picture is written to memory");
    bytes.into_inner()
}

/// A folder `in` with files of somebody else, beside it what they should not have: `secret.bin`, `secret.png`.
fn folders() -> Workplace {
    let place = Workplace::new();
    fs::create_dir(place.path("in")).expect("a folder");
    place.write("secret.bin", secret());
    place.write("in/own.bin", secret());
    place.write("secret.png", png(2));
    place
}

/// The command in a directory from which the files are not in reach; `FILES` in the line is their folder.
fn elsewhere(files: &Workplace, line: &str) -> Run {
    let folder = files.path("in");
    let folder = folder.to_str().expect("a name in UTF-8");
    Workplace::new().run(&line.replace("FILES", folder))
}

/// Ways to name a file in the folder above, as a URI.
const WAYS: [&str; 5] = [
    "../NAME",
    "./../NAME",
    "..%2fNAME",
    "%2e%2e/NAME",
    "nothing/../../NAME",
];

#[test]
fn a_buffer_outside_is_refused_and_not_read() {
    let files = folders();
    for way in WAYS {
        let uri = way.replace("NAME", "secret.bin");
        files.write("in/a.gltf", triangle(&uri).to_string());
        let run = elsewhere(&files, "export FILES/a.gltf -o out.glb");
        run.error(&["a.gltf", "secret.bin", "--allow-read"]);
    }
    // What is beside the file is read from anywhere; what is above it, from above it or where that is allowed.
    files.write("in/a.gltf", triangle("own.bin").to_string());
    elsewhere(&files, "check FILES/a.gltf").success();
    files.write("in/a.gltf", triangle("../secret.bin").to_string());
    files.run("check in/a.gltf").success();
    for command in [
        "check",
        "export -o a.glb",
        "render --size 8x6 -o a.png",
        "cost --only rays --size 8x6 --pixel-samples 1 --repeats 1",
    ] {
        let line = format!("{command} FILES/a.gltf");
        elsewhere(&files, &line).error(&["--allow-read"]);
        // The folder may be one of several, and one far above.
        let line = format!("{line} --allow-read . --allow-read FILES/..");
        elsewhere(&files, &line).success();
    }
    elsewhere(&files, "check FILES/a.gltf --allow-read FILES/nowhere")
        .error(&["--allow-read", "no such folder"]);
}

#[cfg(unix)]
#[test]
fn links_lead_nowhere_else() {
    use std::os::unix::fs::symlink;
    let files = folders();
    symlink("../secret.bin", files.path("in/link.bin")).expect("a link");
    symlink("..", files.path("in/up")).expect("a link");
    for uri in ["link.bin", "up/secret.bin"] {
        files.write("in/a.gltf", triangle(uri).to_string());
        elsewhere(&files, "check FILES/a.gltf").error(&[uri, "--allow-read"]);
    }
    // The file that the user names may be a link, and its folder be reached by one.
    symlink(files.path("in"), files.path("other")).expect("a link");
    files.write("in/a.gltf", triangle("own.bin").to_string());
    elsewhere(&files, "check FILES/../other/a.gltf").success();
    symlink("in/a.gltf", files.path("own.gltf")).expect("a link");
    files.write("own.bin", secret());
    elsewhere(&files, "check FILES/../own.gltf").success();
}

#[test]
fn a_picture_outside_is_left_out_and_its_bytes_with_it() {
    let files = folders();
    let exported = |line: &str| {
        let workplace = Workplace::new();
        let folder = files.path("in");
        let folder = folder.to_str().expect("a name in UTF-8");
        let run = workplace.run(&line.replace("FILES", folder)).success();
        let glb = workplace.read("out.glb");
        (glb_json(&glb).get("images").is_some(), run)
    };
    for way in WAYS {
        let uri = way.replace("NAME", "secret.png");
        files.write("in/a.gltf", painted(&uri).to_string());
        let (has_image, run) = exported("export FILES/a.gltf -o out.glb");
        assert!(!has_image, "{run}");
        assert!(run.stderr.contains("a.gltf: image"), "{run}");
        assert!(run.stderr.contains("--allow-read"), "{run}");
    }
    files.write("in/a.gltf", painted("../secret.png").to_string());
    assert!(exported("export FILES/a.gltf -o out.glb --allow-read FILES/..").0);

    // Likewise libraries of OBJ, and the pictures that they name, also by an absolute path.
    let textured = "mtllib LIBRARY\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    let absolute = files.path("secret.png");
    let absolute = absolute.to_str().expect("a name in UTF-8");
    files.write("above.mtl", "newmtl red\nKd 0.5 0.25 0.125\n");
    for (library, picture) in [
        ("../above.mtl", ""),
        ("own.mtl", "../secret.png"),
        ("own.mtl", absolute),
    ] {
        files.write("in/own.mtl", format!("newmtl red\nmap_Kd {picture}\n"));
        files.write("in/a.obj", textured.replace("LIBRARY", library));
        let (has_image, run) = exported("export FILES/a.obj -o out.glb");
        assert!(!has_image, "{run}");
        let name = if picture.is_empty() { library } else { picture };
        assert!(run.stderr.contains(name), "{run}");
        assert!(run.stderr.contains("--allow-read"), "{run}");
    }
    assert!(exported("export FILES/a.obj -o out.glb --allow-read FILES/..").0);
}

#[test]
fn a_scene_names_files_in_its_folder_or_the_working_directory() {
    let files = folders();
    let scene = |file: &str| json!({ "objects": [{ "name": "a", "file": file }] }).to_string();
    files.write("above.obj", SQUARE);
    files.write("in/square.obj", SQUARE);
    files.write("in/scene.json", scene("square.obj"));
    elsewhere(&files, "check FILES/scene.json").success();
    files.write("in/scene.json", scene("../above.obj"));
    elsewhere(&files, "check FILES/scene.json").error(&["scene.json", "\"a\"", "--allow-read"]);
    files.run("check in/scene.json").success();
    elsewhere(&files, "check FILES/scene.json --allow-read FILES/..").success();

    // What the files of objects name may be anywhere in the scene's folder.
    fs::create_dir(files.path("in/deep")).expect("a folder");
    files.write("in/deep/a.gltf", triangle("../own.bin").to_string());
    files.write("in/scene.json", scene("deep/a.gltf"));
    elsewhere(&files, "check FILES/scene.json").success();
    files.write("in/deep/a.gltf", triangle("../../secret.bin").to_string());
    elsewhere(&files, "check FILES/scene.json").error(&["--allow-read"]);

    // From stdin there is the working directory alone.
    let absolute = files.path("above.obj");
    let absolute = scene(absolute.to_str().expect("a name in UTF-8"));
    files
        .run_with("check -", scene("above.obj").as_bytes(), &[])
        .success();
    files
        .run_with("check -", absolute.as_bytes(), &[])
        .success();
    let other = Workplace::new();
    other.run_with("check -", absolute.as_bytes(), &[]).error(&[
        "stdin",
        "above.obj",
        "--allow-read",
    ]);
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_at_once() {
    use std::os::unix::fs::symlink;
    let place = Workplace::new();
    let made = std::process::Command::new("mkfifo")
        .arg(place.path("pipe"))
        .status();
    assert!(made.expect("mkfifo is there").success());
    for (target, found) in [("/dev/zero", "is a device"), ("pipe", "is a pipe")] {
        for extension in ["json", "gltf", "glb", "obj"] {
            let name = format!("{}.{extension}", found.replace(' ', "_"));
            symlink(target, place.path(&name)).expect("a link");
            let run = place.run(&format!("check {name}"));
            run.error(&[&name, found, "expected an ordinary file", "write -"]);
        }
    }
    // Files that others name; the devices are allowed, so that it is not their place that keeps them from being read.
    place.write("own.bin", secret());
    for (name, found) in [("/dev/zero", "is a device"), ("pipe", "is a pipe")] {
        place.write("a.obj", format!("mtllib {name}\n{SQUARE}"));
        let run = place.run("check a.obj --allow-read /dev").success();
        assert!(run.stderr.contains(found), "{run}");
        place.write("a.mtl", format!("newmtl m\nmap_Kd {name}\n"));
        place.write("a.obj", format!("mtllib a.mtl\nusemtl m\n{SQUARE}"));
        let run = place.run("check a.obj --allow-read /dev").success();
        assert!(run.stderr.contains(found), "{run}");
        place.write(
            "a.json",
            json!({ "objects": [{ "name": "a", "file": name }] }).to_string(),
        );
        place
            .run("check a.json --allow-read /dev")
            .error(&["a.json", found]);
    }
    place.write("a.gltf", triangle("pipe").to_string());
    place.run("check a.gltf").error(&["a.gltf", "is a pipe"]);
    place.write("a.gltf", painted("pipe").to_string());
    let run = place.run("check a.gltf").success();
    assert!(run.stderr.contains("is a pipe"), "{run}");
    // What a shell puts in place of `<(command)`; stdin itself takes no more than a scene or a mesh can have.
    let run = place.run("check /dev/stdin");
    run.error(&["/dev/stdin", "write -"]);
    place
        .run_shell("photosurface check - < /dev/zero")
        .error(&["stdin", "at most 100000000 bytes"]);
}

#[test]
fn tga_is_made_into_png_wherever_it_is_named() {
    let place = Workplace::new();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/access");
    for name in ["tga.obj", "tga.mtl", "t.tga"] {
        place.write(name, fs::read(fixtures.join(name)).expect("a fixture"));
    }
    place.write("own.bin", secret());
    place.write("tga.gltf", painted("t.tga").to_string());
    for name in ["tga.obj", "tga.gltf"] {
        let run = place
            .run(&format!("export {name} --beta 0 -o out.glb"))
            .success();
        let note = format!("note: {name}: image \"t.tga\" made into PNG from TGA\n");
        assert!(run.stderr.starts_with(&note), "{run}");
        let glb = Glb::new(&place.read("out.glb"));
        let image = &glb.json["images"][0];
        assert_eq!(image["mimeType"], "image/png");
        let picture = image::load_from_memory(glb.view(&image["bufferView"]));
        let picture = picture.expect("a PNG").to_rgb8();
        assert_eq!(picture.dimensions(), (1, 1));
        assert_eq!(picture.get_pixel(0, 0).0, [255, 0, 0]);
        // Too large where no pixel is allowed: an export without it, and a picture.
        for command in ["export -o out.glb", "render --size 8x6 -o a.png"] {
            let run = place
                .run(&format!("{command} {name} --max-texture-pixels 0"))
                .success();
            assert!(run.stderr.contains("--max-texture-pixels"), "{run}");
        }
    }
}

#[test]
fn a_picture_that_cannot_be_decoded_costs_the_texture_alone() {
    let place = Workplace::new();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/access/ktx2.gltf");
    place.write("ktx2.gltf", fs::read(fixture).expect("a fixture"));
    place.write("own.bin", secret());
    place.write("good.png", png(40));
    place.write("broken.png", &png(40)[..60]);
    place.write("broken.jpg", b"\xff\xd8\xff\xe0 no picture");
    for (name, reason) in [
        ("ktx2", "of the type image/ktx2"),
        ("broken.png", "cannot be decoded"),
        ("broken.jpg", "cannot be decoded"),
    ] {
        let file = name.replace('.', "_") + ".gltf";
        if name != "ktx2" {
            place.write(&file, painted(name).to_string());
        }
        for flags in ["", "--method mesh", "--view outside", "--sheet"] {
            let run = place
                .run(&format!("render {file} --size 24x16 -o a.png {flags}"))
                .success();
            let notes: Vec<_> = run
                .stderr
                .lines()
                .filter(|line| line.contains("without its texture"))
                .collect();
            assert_eq!(notes.len(), 1, "{run}");
            assert!(notes[0].starts_with(&format!("note: {file}: ")), "{run}");
            assert!(notes[0].contains(reason), "{run}");
            let picture = image::load_from_memory(&place.read("a.png"))
                .expect("a PNG")
                .to_rgb8();
            let first = picture.get_pixel(0, 0);
            assert!(picture.pixels().any(|pixel| pixel != first), "{run}");
        }
        // An export carries it as it is.
        let run = place.run(&format!("export {file} -o out.glb")).success();
        assert!(!run.stderr.contains("note:"), "{run}");
        assert!(glb_json(&place.read("out.glb")).get("images").is_some());
        let line = format!("cost {file} --only rays --size 8x6 --pixel-samples 1 --repeats 1");
        let run = place.run(&line).success();
        assert!(run.stderr.contains("without its texture"), "{run}");
    }
    // Neither is one that is too large, by its header: 1600 pixels.
    place.write("a.gltf", painted("good.png").to_string());
    let run = |limit: u32| {
        let line = format!("render a.gltf --size 24x16 -o a.png --max-texture-pixels {limit}");
        place.run(&line).success().stderr
    };
    assert!(run(1599).contains("40 x 40 pixels, expected at most 1599 more"));
    assert!(!run(1600).contains("note:"));
}

/// A texture was decoded once for each part: a file of 21 kB took gigabytes.
#[test]
fn a_hundred_nodes_and_images_share_one_picture() {
    let place = Workplace::new();
    place.write("own.bin", secret());
    place.write("good.png", png(40));
    let mut file = painted("good.png");
    // Each node with a mesh, a material, a texture and an image of its own, all of the same file.
    for (list, item) in [
        ("nodes", json!({ "mesh": 0 })),
        ("images", file["images"][0].clone()),
    ] {
        file[list] = Value::Array(vec![item; 100]);
    }
    file["scenes"][0]["nodes"] = (0..100).collect();
    let numbered = |template: &Value, key: &str| -> Value {
        let each = (0..100).map(|number| {
            let text = template
                .to_string()
                .replace(&format!("\"{key}\":0"), &format!("\"{key}\":{number}"));
            serde_json::from_str::<Value>(&text).expect("JSON")
        });
        each.collect()
    };
    file["textures"] = numbered(&file["textures"][0], "source");
    file["materials"] = numbered(&file["materials"][0], "index");
    file["meshes"] = numbered(&file["meshes"][0], "material");
    file["nodes"] = numbered(&file["nodes"][0], "mesh");
    place.write("a.gltf", file.to_string());
    for flags in ["", "--method mesh", "--sheet --steps 0,1"] {
        let line = format!("render a.gltf --size 12x8 -o a.png --max-texture-pixels 1600 {flags}");
        let run = place.run(&line).success();
        assert!(!run.stderr.contains("note:"), "{run}");
    }
    // In memory and in what is written they are there once, too.
    let (model, _) = Access::default()
        .read_model(&place.path("a.gltf"))
        .expect("a model");
    let bytes = |part: &photosurface::Part| {
        let material = part.material.as_ref().expect("a material");
        material.textures()[0].images()[0].bytes().as_ptr()
    };
    assert_eq!(model.parts.len(), 100);
    assert!(
        model
            .parts
            .iter()
            .all(|part| bytes(part) == bytes(&model.parts[0]))
    );
    place.run("export a.gltf -o out.glb").success();
    let written = glb_json(&place.read("out.glb"));
    let images = written["images"].as_array().expect("images");
    let views: HashSet<_> = images
        .iter()
        .map(|image| image["bufferView"].as_u64())
        .collect();
    assert_eq!((images.len(), views.len()), (100, 1));
}

/// The files of all pictures of a model together have a limit, parts of one another included.
#[test]
fn the_files_of_pictures_are_limited_together() {
    let picture = png(40);
    let mut file = painted("");
    let text = json!({ "byteLength": 36 + picture.len() }).to_string();
    file["buffers"] = json!([serde_json::from_str::<Value>(&text).expect("JSON")]);
    let views = (0..4)
        .map(|cut| json!({ "buffer": 0, "byteOffset": 36, "byteLength": picture.len() - cut }));
    let corners = json!({ "buffer": 0, "byteLength": 36 });
    file["bufferViews"] = std::iter::once(corners).chain(views).collect();
    file["images"] = (1..5).map(|view| json!({ "bufferView": view })).collect();
    file["textures"] = (0..4).map(|source| json!({ "source": source })).collect();
    let slots = ["normalTexture", "occlusionTexture", "emissiveTexture"];
    for (index, slot) in slots.iter().enumerate() {
        file["materials"][0][slot] = json!({ "index": index + 1 });
    }
    let glb = pack(&file, &[secret(), picture.clone()].concat());
    let dropped = |access: &Access| {
        let (_, found) = access
            .read_gltf_bytes(&glb, Path::new(""))
            .expect("a model");
        let dropped = found
            .notes
            .iter()
            .filter(|note| matches!(note, Note::Image { .. }));
        dropped.count()
    };
    assert_eq!(dropped(&Access::default()), 0);
    let access = Access {
        // For two of them and a part of a third.
        max_texture_pixels: (5 * picture.len() as u64 / 2) / 8,
        ..Access::default()
    };
    assert_eq!(dropped(&access), 2);
}

#[test]
fn the_library_has_the_same_limits() {
    let files = folders();
    let gltf = triangle("../secret.bin").to_string();
    let error = read_gltf_bytes(gltf.as_bytes(), &files.path("in")).expect_err("out of reach");
    assert!(matches!(error, ReadError::OutOfReach { .. }), "{error}");
    let access = Access {
        folders: vec![files.path("")],
        ..Access::default()
    };
    assert!(
        access
            .read_gltf_bytes(gltf.as_bytes(), &files.path("in"))
            .is_ok()
    );
}

#[test]
fn what_check_says_of_the_range_names_the_file() {
    let place = Workplace::new();
    place.write(
        "ball.json",
        BALL.replace("\"radius\": 1,", "\"radius\": 1e45,"),
    );
    place
        .run("check ball.json")
        .error(&["error: ball.json: the "]);
    place.write("square.obj", SQUARE);
    place
        .run("check square.obj --rapidity 100 --observer 0,0,30")
        .error(&["error: square.obj: the position"]);
}
