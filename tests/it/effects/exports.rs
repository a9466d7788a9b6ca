//! Colours of vertices in exports, by the binary: there only where they are asked for.

use serde_json::{Value, json};

use crate::common::command::{Workplace, glb_json};
use crate::common::glb::Glb;

fn attributes(file: &[u8]) -> Vec<String> {
    let json = glb_json(file);
    let attributes = &json["meshes"][0]["primitives"][0]["attributes"];
    let attributes = attributes.as_object().expect("attributes");
    attributes.keys().cloned().collect()
}

fn stages(report: &Value) -> Vec<&str> {
    let stages = report["stages"].as_array().expect("stages");
    stages
        .iter()
        .filter_map(|stage| stage["name"].as_str())
        .collect()
}

/// The colours of the first mesh, four bytes each.
fn colors(file: &[u8]) -> Vec<[u8; 4]> {
    let glb = Glb::new(file);
    let accessor = &glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
    let accessor = &glb.json["accessors"][accessor.as_u64().expect("colours") as usize];
    assert_eq!(
        (&accessor["componentType"], &accessor["type"]),
        (&json!(5121), &json!("VEC4"))
    );
    assert_eq!(accessor["normalized"], json!(true));
    let count = accessor["count"].as_u64().expect("a count") as usize;
    let start = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
    let view = &glb.view(&accessor["bufferView"])[start..];
    view.as_chunks().0[..count].to_vec()
}

#[test]
fn colours_are_written_where_they_are_asked_for() {
    let workplace = Workplace::with_ball();
    let export = |flags: &str| {
        let line = format!("export ball.json -o out.glb --report report.json {flags}");
        workplace.run(&line).success();
        (
            workplace.read("out.glb"),
            workplace.read_json("report.json"),
        )
    };
    let (bare, report) = export("");
    let has = |file: &[u8], name: &str| attributes(file).iter().any(|found| found == name);
    assert!(!has(&bare, "COLOR_0") && !has(&bare, "_DOPPLER"));
    assert!(!stages(&report).contains(&"effects") && report["scene"].get("effects").is_none());
    let (none, _) = export("--doppler none");
    assert_eq!(none, bare);
    for name in ["spectrum", "ramp"] {
        let (colored, report) = export(&format!("--doppler {name}"));
        assert!(
            has(&colored, "COLOR_0") && !has(&colored, "_DOPPLER"),
            "{name}"
        );
        assert!(stages(&report).contains(&"effects"), "{name}");
        assert!(!report["scene"]["effects"]["doppler"].is_null(), "{name}");
        let (both, _) = export(&format!("--doppler {name} --attributes doppler"));
        assert!(has(&both, "COLOR_0") && has(&both, "_DOPPLER"), "{name}");
        assert_eq!(colors(&both), colors(&colored));
        let different: std::collections::BTreeSet<_> = colors(&colored).into_iter().collect();
        assert!(different.len() > 10, "{name}: {}", different.len());
    }
    let ply = |flags: &str| {
        workplace
            .run(&format!("export ball.json -o out.ply {flags}"))
            .success();
        let file = workplace.read("out.ply");
        let end = file
            .windows(10)
            .position(|bytes| bytes == b"end_header")
            .expect("a header");
        String::from_utf8(file[..end].to_vec()).expect("text")
    };
    // A PLY always has the Doppler factor.
    assert!(!ply("").contains("property uchar red") && ply("").contains("quality"));
    let colored = ply("--doppler spectrum");
    assert!(colored.contains("property uchar red") && colored.contains("quality"));
}

/// At rest all colours are those that surfaces have: the effect changes nothing but how it is written.
#[test]
fn at_rest_vertices_have_the_colour_of_the_surface() {
    let workplace = Workplace::with_ball();
    workplace.write(
        "scene.json",
        r##"{ "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1, "resolution": 8 } }, "color": "#c04020",
            "position": [0, 0, -4] } ], "tolerance": { "relative": 0.1 } }"##,
    );
    workplace
        .run("export scene.json -o out.glb --doppler spectrum")
        .success();
    let file = workplace.read("out.glb");
    // Linear, of 255.
    let expected = [0xc0, 0x40, 0x20].map(|byte| {
        let linear = ((f64::from(byte) / 255.0 + 0.055) / 1.055).powf(2.4);
        (255.0 * linear).round() as u8
    });
    for [red, green, blue, alpha] in colors(&file) {
        assert_eq!(([red, green, blue], alpha), (expected, 255));
    }
    let material = &glb_json(&file)["materials"][0]["pbrMetallicRoughness"];
    assert!(material.get("baseColorFactor").is_none(), "{material}");
}

#[test]
fn one_mesh_for_all_steps_has_no_room_for_colours_of_each() {
    let workplace = Workplace::with_ball();
    let run =
        workplace.run("export ball.json -o out.glb --steps 0,1 --animate=morph --doppler ramp");
    run.error(&["--animate=morph", "Doppler effect", "--animate=frames"]);
    let line = "export ball.json -o out.glb --steps 0,1 --animate --doppler ramp";
    workplace.run(line).success();
}

#[test]
fn check_says_what_each_effect_costs() {
    let workplace = Workplace::with_ball();
    let without = workplace.run("check ball.json").success();
    assert!(!without.stdout_text().contains("effect"), "{without}");
    let scene = std::str::from_utf8(&workplace.read("ball.json"))
        .expect("text")
        .replacen(
            '{',
            r#"{ "effects": { "doppler": "spectrum", "searchlight": true },"#,
            1,
        );
    workplace.write("both.json", scene);
    let both = workplace.run("check both.json").success();
    let lines = both
        .stdout_text()
        .lines()
        .filter(|line| line.starts_with("effect "));
    let lines: Vec<_> = lines.collect();
    assert_eq!(lines.len(), 2, "{both}");
    assert!(
        lines[0].starts_with("effect doppler: about ") && lines[0].contains("vertices"),
        "{both}"
    );
    assert!(
        lines[1].starts_with("effect searchlight: about ") && lines[1].contains("1280 x 720"),
        "{both}"
    );
    let by_flags =
        workplace.run("check ball.json --doppler spectrum --searchlight --exposure auto");
    for effect in ["effect doppler", "effect searchlight", "effect exposure"] {
        assert!(by_flags.stdout_text().contains(effect), "{by_flags}");
    }
    let night = workplace
        .run("check --example night --model rest")
        .success();
    for line in [
        "effect lamps: about ",
        "effect emission: about ",
        "model rest: 45 objects",
    ] {
        assert!(night.stdout_text().contains(line), "{night}");
    }
}

#[test]
fn flags_change_pictures_and_the_ramp_has_a_legend() {
    let workplace = Workplace::with_ball();
    let picture = |flags: &str| {
        let line = format!("render ball.json -o out.png --size 320x240 --samples 1 {flags}");
        workplace.run(&line).success();
        workplace.read("out.png")
    };
    let flags = [
        "",
        "--doppler spectrum",
        "--doppler ramp",
        "--searchlight",
        "--exposure -1",
        "--exposure auto",
        "--doppler spectrum --searchlight",
    ];
    let pictures = flags.map(picture);
    for (number, one) in pictures.iter().enumerate() {
        assert!(!pictures[..number].contains(one), "{}", flags[number]);
    }
    assert_eq!(picture("--doppler none --exposure 0"), pictures[0]);
    workplace
        .run("render ball.json -o out.png --exposure bright")
        .error(&["--exposure", "bright"]);
    // Beside the ball nothing changes but the corner of the legend.
    let image = |bytes: &[u8]| {
        image::load_from_memory(bytes)
            .expect("a picture")
            .into_rgb8()
    };
    let [bare, ramp] = [&pictures[0], &pictures[2]].map(|bytes| image(bytes));
    assert_eq!(bare.get_pixel(2, 2), ramp.get_pixel(2, 2));
    let mut corner = (160..320).flat_map(|x| (180..240).map(move |y| (x, y)));
    assert!(corner.any(|(x, y)| bare.get_pixel(x, y) != ramp.get_pixel(x, y)));
}
