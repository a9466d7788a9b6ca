//! `photosurface check` and what `export` says: one predicts what the other makes, and how it ends.

use crate::common::command::Workplace;

#[test]
fn check_says_what_an_export_would_make() {
    let workplace = Workplace::with_ball();
    let run = workplace.run("check ball.json --steps 0,1,2").success();
    let (text, triangles) = (run.stdout_text(), 3 * 20 * 2 * 2);
    assert!(text.contains(&format!(" {triangles} ")), "{run}");
    assert!(text.contains("3 steps: 3 photosurfaces"), "{run}");
    assert!(text.contains(&format!(" {triangles} triangles")), "{run}");
    assert_eq!(workplace.files(), ["ball.json", "square.obj"]);
}

#[test]
fn counts_and_sizes_are_told_as_people_say_them() {
    let workplace = Workplace::new();
    workplace.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let run = workplace.run("export one.obj -o one.gltf").success();
    let gltf = workplace.read_json("one.gltf");
    let data = gltf["buffers"][0]["uri"].as_str().unwrap();
    let bytes = workplace.read("one.gltf").len() + workplace.read(data).len();
    let summary = format!(
        "one.gltf: 1 photosurface, 1 triangle, {:.1} kB\n",
        bytes as f64 / 1e3
    );
    assert_eq!(run.stderr, summary, "{run}");
    let run = workplace.run("check one.obj -q").success();
    assert!(
        run.prediction()
            .ends_with("1 step: 1 photosurface, about 1 triangle"),
        "{run}"
    );
    let run = workplace.run("check one.obj -v").success();
    assert!(run.stderr.contains("one: 3 vertices, 1 triangle"), "{run}");
}

/// Of a round shape there are as many as its tolerance asks for: what the shape had by itself was printed, and was more
/// than what came out.
#[test]
fn triangles_in_are_those_of_the_certificates() {
    let workplace = Workplace::with_ball();
    for flags in [
        "--example cube --tolerance 1e-1",
        "--example lattice --tolerance 1e-1",
        "--example sphere --tolerance 1e-2",
        "square.obj --steps 0,1,2 --beta 0.9",
    ] {
        let check = workplace.run(&format!("check {flags}")).success();
        let line = check.stdout_text().lines().nth(1).expect("an object");
        let column = |number: usize| line.split_whitespace().nth(number).expect("a column");
        let count = |text: &str| -> u64 { text.replace(',', "").parse().expect("a count") };
        let export = format!("export {flags} -o out.glb --report report.json");
        workplace.run(&export).success();
        let report = workplace.read_json("report.json");
        let objects = report["objects"].as_array().expect("objects").iter();
        let certified = objects.filter_map(|object| object["certificate"]["triangles_in"].as_u64());
        assert_eq!(count(column(2)), certified.sum::<u64>(), "{check}");
        assert!(count(column(2)) <= count(column(8)), "{check}");
    }
}

/// The exit status is that of the export.
#[test]
fn check_ends_as_the_export_will() {
    let workplace = Workplace::with_ball();
    for (flags, status) in [
        ("ball.json", 0),
        ("--no-subdivide --tolerance 1e-6", 1),
        ("--tolerance 1e-9 --format ply --max-triangles 1000", 1),
        // What is there already is within the tolerance, and stays.
        ("square.obj --max-triangles 1", 0),
        ("ball.json --max-triangles 0", 0),
        ("--max-triangles 0", 1),
        (
            "square.obj --max-triangles 1 --no-subdivide --tolerance 1",
            0,
        ),
        ("square.obj --lod 1e-2,1e-9", 1),
        ("square.obj --lod 1e-2,1e-3", 0),
        ("--beta 2", 2),
    ] {
        let run = workplace.run(&format!("check {flags}"));
        assert_eq!(run.status, status, "{run}");
        let says_no = status == 1;
        if status < 2 && !flags.contains("--lod") {
            let certified = run.stdout_text().lines().nth(1).expect("a table");
            assert_eq!(certified.trim_end().ends_with(" no"), says_no, "{run}");
        }
        let (flags, extension) = match flags.split_once("--format ply") {
            Some((before, after)) => (format!("{before}{after}"), "ply"),
            None => (flags.to_owned(), "glb"),
        };
        let report = if flags.contains("--lod") {
            ""
        } else {
            "--report report.json"
        };
        let run = workplace.run(&format!("export {flags} -o out.{extension} {report}"));
        assert_eq!(run.status, status, "{run}");
        if status < 2 && !report.is_empty() {
            let report = workplace.read_json("report.json");
            let mut objects = report["objects"].as_array().expect("objects").iter();
            let all = objects.all(|object| object["certificate"]["complete"] == true);
            assert_eq!(all, !says_no, "{run}");
        }
    }
}

/// What is beyond the 32-bit numbers of a GLB is so by distance here, not by speed, and a PLY holds it.
#[test]
fn check_is_of_the_format_that_is_to_be_written() {
    let workplace = Workplace::with_ball();
    workplace.write("tiny.obj", "v 0 0 0\nv 1e-50 0 0\nv 0 1e-50 0\nf 1 2 3\n");
    let far = "square.obj --observer 1e40,0,0 --beta 0.5 --tolerance abs:1e30";
    for line in [format!("check {far}"), format!("export {far} -o out.glb")] {
        let run = workplace
            .run(&line)
            .error(&["too far away", "smaller distance", ".ply"]);
        assert!(!run.stderr.contains("smaller rapidity"), "{run}");
    }
    workplace
        .run(&format!("check {far} --format gltf"))
        .error(&["too far away"]);
    workplace
        .run(&format!("check {far} --format ply"))
        .success();
    workplace.run(&format!("export {far} -o out.ply")).success();
    // Too fast and too small are no matter of distance, and a PLY holds these too.
    for (flags, word) in [
        ("square.obj --rapidity 300", "smaller rapidity"),
        ("ball.json --rapidity 350", "smaller rapidity"),
        ("tiny.obj --beta 0.5", "too small"),
    ] {
        let glb = [
            "check FLAGS",
            "export FLAGS -o out.glb",
            "export FLAGS -o out.gltf",
        ];
        for line in glb.map(|line| line.replace("FLAGS", flags)) {
            workplace
                .run(&line)
                .error(&[word, "; or write a .ply, whose 64-bit numbers hold it"]);
        }
        let status = workplace.run(&format!("check {flags} --format ply")).status;
        assert!(status < 2, "{flags}");
    }
}

/// A point has no diagonal that a tolerance could be a fraction of.
#[test]
fn what_has_no_extent_takes_a_length_as_tolerance() {
    let workplace = Workplace::new();
    workplace.write("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
    let line = "export point.obj --observer 0,0,3 --beta 0.5 --steps 0,1 -o out.ply";
    let run = workplace.run(line);
    assert_eq!(run.status, 1, "{run}");
    assert!(run.stderr.contains("such as --tolerance abs:0.01"), "{run}");
    workplace
        .run(&format!("{line} --tolerance abs:0.01"))
        .success();
}
