//! `photosurface flight`: the table, CSV and JSON are the library's numbers, and diagrams say what they show.

use photosurface::Scene;
use photosurface::pipeline::MomentFacts;
use serde_json::{Value, json};

use crate::common::command::{Run, Workplace};

const FLIGHT: &str = r#"{ "title": "Past a sphere", "observer": { "velocity": { "rapidity": 1.8317808230648227 }, "flight": [
    { "proper_time": 2.1, "acceleration": [0, 0, -0.26085503293665] },
    { "proper_time": 1.6, "acceleration": [0, 0, -0.32718303025942] } ] },
  "steps": [0, 2.1, 3.7],
  "objects": [ { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -15] },
    { "name": "cube", "shape": { "box": { "size": [1, 1, 1] } }, "position": [0, 3, 0], "velocity": [0, 0, -0.3] } ] }"#;

fn workplace() -> Workplace {
    let workplace = Workplace::with_ball();
    workplace.write("flight.json", FLIGHT);
    workplace
}

/// What the library says of the observer at these proper times.
fn expected(json: &str, times: impl IntoIterator<Item = f64>) -> Vec<MomentFacts> {
    let scene = Scene::from_json(json).unwrap();
    let moments = times
        .into_iter()
        .map(|time| MomentFacts::new(scene.flight(), time));
    moments.collect()
}

/// The words of each line of stdout.
fn words(run: &Run) -> Vec<Vec<&str>> {
    let lines = run.stdout_text().lines();
    lines
        .map(|line| line.split_whitespace().collect())
        .collect()
}

#[test]
fn the_table_has_a_row_for_each_step() {
    let run = workplace().run("flight flight.json").success();
    assert!(run.stderr.is_empty(), "{run}");
    let lines = words(&run);
    assert_eq!(
        lines[0].join(" "),
        "proper time time x y z beta gamma rapidity"
    );
    assert_eq!(lines[1][..4], ["0", "0", "0", "0"]);
    assert_eq!(
        lines[2],
        [
            "2.10000", "8.86099", "0", "0", "-8.60208", "0.983000", "5.44646", "2.37958"
        ]
    );
    assert_eq!(lines[3][5], "0.994000");
    assert_eq!(lines.len(), 5);
    assert!(run.stdout_text().contains("scene units"), "{run}");
}

#[test]
fn a_flight_without_steps_has_even_rows_and_units_are_added() {
    let workplace = workplace();
    let json = FLIGHT.replace(
        r#""steps": [0, 2.1, 3.7],"#,
        r#""units": { "length_m": 299792458 },"#,
    );
    workplace.write("no_steps.json", &json);
    let run = workplace.run("flight no_steps.json").success();
    let lines = words(&run);
    assert!(
        lines[0]
            .join(" ")
            .ends_with("rapidity time s acceleration g"),
        "{run}"
    );
    let first: Vec<&str> = lines[1..12].iter().map(|line| line[0]).collect();
    assert_eq!(
        (first[0], first[1], first[10]),
        ("0", "0.370000", "3.70000")
    );
    // One unit of time is a second; 0.26085503293665 c/s in g.
    assert_eq!(lines[2][1], lines[2][8]);
    let g: f64 = lines[1][9].parse().unwrap();
    assert!(
        (g / (0.26085503293665 * 299_792_458.0 / 9.80665) - 1.0).abs() < 1e-5,
        "{run}"
    );
    assert_eq!(lines.len(), 13);
    // Steps that are asked for are the rows.
    let run = workplace
        .run("flight no_steps.json --steps=-1..1/3")
        .success();
    assert_eq!(words(&run).len(), 5);
}

#[test]
fn csv_and_json_have_all_digits_of_the_library() {
    let workplace = workplace();
    let run = workplace
        .run("flight flight.json --steps 0,0.7,3,9 --csv out.csv --json out.json")
        .success();
    assert!(!run.stdout.is_empty(), "{run}");
    let moments = expected(FLIGHT, [0.0, 0.7, 3.0, 9.0]);
    assert_eq!(
        workplace.read_json("out.json"),
        json!({ "moments": &moments })
    );
    let text = String::from_utf8(workplace.read("out.csv")).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(names.len(), 25);
    for moment in &moments {
        let numbers = lines.next().unwrap().split(',');
        let numbers: Vec<f64> = numbers.map(|number| number.parse().unwrap()).collect();
        let mut all = vec![moment.proper_time, moment.time];
        all.extend(moment.position.iter().chain(&moment.velocity));
        all.extend([moment.gamma, moment.rapidity]);
        all.extend(
            moment
                .axes
                .as_flattened()
                .iter()
                .chain(&moment.acceleration),
        );
        assert_eq!(numbers, all);
    }
    assert_eq!(lines.next(), None);
    // In place of the table.
    let run = workplace.run("flight flight.json --json -").success();
    let json: Value = serde_json::from_slice(&run.stdout).unwrap();
    let keys: Vec<_> = json["moments"][0].as_object().unwrap().keys().collect();
    let fields = "proper_time time position velocity gamma rapidity axes acceleration";
    assert_eq!(keys, fields.split(' ').collect::<Vec<_>>());
    let run = workplace.run("flight flight.json --csv -").success();
    assert!(run.stdout_text().starts_with("proper_time,time,"), "{run}");
}

#[test]
fn a_diagram_says_what_it_shows() {
    let workplace = workplace();
    let run = workplace
        .run("flight flight.json --diagram out.svg --at 0,2.1 --point sphere --point cube:0,0.5,0")
        .success();
    assert!(!run.stdout.is_empty(), "{run}");
    let svg = String::from_utf8(workplace.read("out.svg")).unwrap();
    assert!(
        svg.starts_with("<svg width=\"800\" height=\"800\""),
        "{}",
        &svg[..99]
    );
    for words in [
        "Past a sphere",
        "-z, in scene units",
        "time t, in scene units",
        "\u{3c4} = 0",
        "\u{3c4} = 2.1",
        "sphere",
        "cube [0, 0.5, 0]",
        "light cone",
        "own axes",
        "t&apos;",
        "-z&apos;",
        "emission of what is seen",
        "where it is seen",
        "off this plane by up to 3.5",
    ] {
        assert!(svg.contains(words), "{words}\n{svg}");
    }
    assert!(!svg.contains("NaN"), "{svg}");
    let run = workplace.run("flight flight.json --diagram out.png --diagram-size 640x500 --csv -");
    assert!(run.success().stdout_text().starts_with("proper_time"));
    let png = image::load_from_memory(&workplace.read("out.png")).unwrap();
    assert_eq!((png.width(), png.height()), (640, 500));
    workplace
        .run("flight flight.json --diagram plane.svg --plane 3,0,4")
        .success();
    let svg = String::from_utf8(workplace.read("plane.svg")).unwrap();
    assert!(svg.contains("along 0.6, 0, 0.8, in scene units"), "{svg}");
}

/// Whatever the scene is: built-in scenes, a bare mesh, speeds beyond reason, an observer who is where the object is.
#[test]
fn every_scene_has_a_diagram() {
    let workplace = workplace();
    for line in [
        "flight",
        "flight --example street",
        "flight --example snapshot",
        "flight --example lattice --gamma 1e9",
        "flight square.obj --beta 0.9",
        "flight square.obj --rapidity 300",
        "flight square.obj --observer 0,0,0",
        "flight square.obj --beta 0.6 --observer 0,0,0 --time 1e15",
        "flight ball.json --steps -1e30,1e30",
    ] {
        workplace
            .run(&format!("{line} --diagram out.svg -q"))
            .success();
        let svg = String::from_utf8(workplace.read("out.svg")).unwrap();
        assert!(svg.contains("observer, with proper time"), "{line}");
        assert!(!svg.contains("NaN"), "{line}");
    }
}

#[test]
fn errors_name_the_flag_and_what_was_expected() {
    let workplace = workplace();
    let before = workplace.files();
    for (flags, words) in [
        (
            "--diagram out.jpg",
            ["--diagram out.jpg", "expected .png or .svg"],
        ),
        ("--at 0", ["--diagram", "required"]),
        ("--plane 1,0,0", ["--diagram", "required"]),
        ("--point sphere", ["--diagram", "required"]),
        ("--diagram-size 800x800", ["--diagram", "required"]),
        (
            "--diagram out.svg --at 0,x",
            ["--at", "\"x\" is not a number"],
        ),
        (
            "--diagram out.svg --point cone",
            [
                "--point",
                "no object \"cone\", expected one of: sphere, cube",
            ],
        ),
        (
            "--diagram out.svg --point cube:1,2",
            ["--point", "\"cube:1,2\""],
        ),
        (
            "--diagram out.svg --plane 0,0,0",
            ["--plane", "other than zero"],
        ),
        (
            "--diagram out.svg --diagram-size 80x80",
            ["--diagram-size", "at least 640 x 480"],
        ),
        (
            "--diagram out.svg --at 1e305",
            ["--diagram", "at proper time 1"],
        ),
        ("--csv - --json -", ["--json and --csv", "stdout"]),
        ("--json flight.json", ["flight.json", "input"]),
        (
            "--steps 1e308",
            ["at proper time 1e308", "farther than any number says"],
        ),
    ] {
        workplace
            .run(&format!("flight flight.json {flags}"))
            .error(&words);
        assert_eq!(workplace.files(), before, "{flags}");
    }
}

/// XML has no control characters, whatever names and titles hold.
#[test]
fn an_svg_has_no_characters_that_xml_has_not() {
    let workplace = Workplace::new();
    let scene = FLIGHT.replacen("Past a sphere", "bell \\u0007 \\ufffe <&> \\u001b", 1);
    workplace.write("bell.json", scene);
    workplace
        .run("flight bell.json --diagram bell.svg")
        .success();
    let svg = String::from_utf8(workplace.read("bell.svg")).expect("text");
    assert!(svg.contains("bell  "), "{svg}");
    let is_odd = |c: char| (c < ' ' && !"\n\r\t".contains(c)) || c == '\u{fffe}';
    assert!(!svg.contains(is_odd));
}
