//! `--normals` and `"normals"`: which vertices and normals files get.

use std::fmt::Write;

use crate::common::command::{Workplace, glb_json};

/// Corners along a side of the sheet.
const SIDE: usize = 200;

/// A curved sheet without normals.
fn sheet() -> String {
    let mut text = format!("OFF\n{} {} 0\n", SIDE * SIDE, 2 * (SIDE - 1) * (SIDE - 1));
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        writeln!(text, "{x} {y} {}", (x * y) as f64 * 1e-3).expect("memory");
    }
    for i in 0..(SIDE - 1) * (SIDE - 1) {
        let i = i + i / (SIDE - 1);
        let next = i + SIDE;
        writeln!(
            text,
            "3 {i} {} {}\n3 {i} {} {next}",
            i + 1,
            next + 1,
            next + 1
        )
        .expect("memory");
    }
    text
}

/// Vertices of the only mesh, and whether they have normals.
fn vertices(workplace: &Workplace, file: &str) -> (usize, bool) {
    let json = glb_json(&workplace.read(file));
    let attributes = &json["meshes"][0]["primitives"][0]["attributes"];
    let position = attributes["POSITION"].as_u64().expect("positions") as usize;
    let count = json["accessors"][position]["count"].as_u64();
    (
        count.expect("a count") as usize,
        attributes.get("NORMAL").is_some(),
    )
}

#[test]
fn shared_vertices_need_as_much_room_as_the_note_says() {
    let workplace = Workplace::new();
    workplace.write("sheet.off", sheet());
    let (shared, corners) = (SIDE * SIDE, 6 * (SIDE - 1) * (SIDE - 1));
    let note = "no normals: facets are shaded flat, with three vertices each, 6.7 MB a step; shared vertices need about \
                1.9 MB with --normals smooth, 1.4 MB with --normals none";
    for (normals, count, has_normals, megabytes) in [
        ("source", corners, true, "6.7"),
        ("flat", corners, true, "6.7"),
        ("smooth", shared, true, "1.9"),
        ("smooth:180", shared, true, "1.9"),
        ("none", shared, false, "1.4"),
    ] {
        let run =
            format!("export sheet.off --beta 0.5 --no-subdivide --normals {normals} -o out.glb");
        let run = workplace.run(&run);
        assert_eq!(
            run.stderr.contains(note),
            normals == "source",
            "{}",
            run.stderr
        );
        assert_eq!(
            vertices(&workplace, "out.glb"),
            (count, has_normals),
            "{normals}"
        );
        let bytes = workplace.read("out.glb").len();
        assert_eq!(format!("{:.1}", bytes as f64 / 1e6), megabytes, "{normals}");
    }
    // Refinement keeps what is shared shared, certified as ever.
    let refined = |normals: &str| {
        let run = format!(
            "export sheet.off --beta 0.9 --tolerance abs:3e-4 --normals {normals} -o {normals}.ply"
        );
        workplace.run(&run).success();
        let text = String::from_utf8_lossy(&workplace.read(&format!("{normals}.ply"))).into_owned();
        let line = |word: &str| {
            let line = text
                .lines()
                .find(|line| line.starts_with(word))
                .expect("a line");
            line.rsplit(' ')
                .next()
                .and_then(|count| count.parse::<usize>().ok())
                .expect("a count")
        };
        let counts = (line("element vertex"), line("element face"));
        (counts, text.contains("property float nx"))
    };
    let ((smooth, faces), has_normals) = refined("smooth");
    let (none, lacks_normals) = refined("none");
    assert_eq!(
        (none, has_normals, lacks_normals),
        ((smooth, faces), true, false)
    );
    assert!(faces > 2 * (SIDE - 1) * (SIDE - 1));
    // Euler's formula of a sheet in one piece: about half as many vertices as facets.
    assert!(smooth < faces / 2 + 4 * SIDE, "{smooth} of {faces}");
}

#[test]
fn normals_of_a_scene_are_those_of_its_objects_unless_the_flag_says_otherwise() {
    let workplace = Workplace::new();
    let facet =
        |corners: &str| format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n");
    let roof = [
        facet("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"),
        facet("vertex 0 0 0\nvertex 0 1 0\nvertex 0 0 1\n"),
    ];
    workplace.write("roof.stl", format!("solid\n{}endsolid\n", roof.concat()));
    let scene = |normals: &str| {
        let object = format!(r#"{{ "name": "roof", "file": "roof.stl"{normals} }}"#);
        workplace.write("scene.json", format!(r#"{{ "objects": [ {object} ] }}"#));
    };
    for (key, flag, expected) in [
        ("", "", (6, true)),
        (r#", "normals": "none""#, "", (4, false)),
        (r#", "normals": "none""#, "--normals source", (6, true)),
        (r#", "normals": "flat""#, "--normals smooth:90", (4, true)),
        (r#", "normals": "smooth:89""#, "", (6, true)),
    ] {
        scene(key);
        let run = format!("export scene.json --no-subdivide {flag} -o out.glb");
        workplace.run(&run);
        assert_eq!(vertices(&workplace, "out.glb"), expected, "{key} {flag}");
    }
    scene(r#", "normals": "round""#);
    workplace.run("export scene.json").error(&[
        "objects[0].normals",
        "\"round\"",
        "source, smooth, smooth:DEGREES",
    ]);
    workplace
        .run("export roof.stl --normals smooth:181")
        .error(&["--normals", "0 to 180"]);
    workplace
        .run("export --example cube --normals flat")
        .error(&["--normals is for meshes from files"]);
}
