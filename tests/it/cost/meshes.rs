//! `photosurface cost` of meshes: the study is consistent in itself, and its three ways out say the same.

use crate::common::command::Workplace;
use serde_json::Value;

/// A box that the observer is about to hit: flat, so that the gap alone is what there is to bound.
const BOX_AHEAD: &str = r#"{ "title": "A box ahead", "observer": { "velocity": { "beta": 0.8, "direction": [0, 0, -1] } },
  "objects": [ { "name": "box", "shape": { "box": { "size": [2, 2, 2], "resolution": 1 } }, "position": [0.1, 0.2, -1.2] } ] }"#;

const BALL_AT_REST: &str = r#"{ "objects": [
  { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -4], "scale": [2, 1, 1] } ] }"#;

fn study(workplace: &Workplace, flags: &str) -> Value {
    let run = workplace.run(&format!(
        "cost --only meshes --repeats 1 --json study.json {flags}"
    ));
    assert_eq!(run.success().stderr, "", "{flags}");
    workplace.read_json("study.json")
}

fn rows(study: &Value) -> &[Value] {
    study["meshes"].as_array().expect("rows")
}

/// A number of a row, by its place.
#[track_caller]
fn number(row: &Value, place: &str) -> f64 {
    let value = row.pointer(place).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("{place} in {row:#}"))
}

/// What has to hold for every tolerance that was carried out.
#[track_caller]
fn assert_consistent(row: &Value) {
    let made = |name: &str| number(row, &format!("/made/{name}"));
    let tolerance = number(row, "/tolerance");
    assert_eq!(row["made"]["certified"], true, "{row:#}");
    assert!(made("bound") <= tolerance, "{row:#}");
    assert!(
        made("gap") <= made("bound") && made("error") <= made("bound"),
        "{row:#}"
    );
    let over = made("error_over_bound");
    assert!(
        over <= 1.0 && over >= made("error") / made("bound") * (1.0 - 1e-12),
        "{row:#}"
    );
    let ratio = made("triangles") / made("minimum_with_source");
    assert!(
        (ratio / made("ratio") - 1.0).abs() < 1e-12 && ratio >= 1.0,
        "{row:#}"
    );
    assert!(made("file_bytes") > 12.0 * made("triangles"), "{row:#}");
    for stage in ["predict", "photosurface", "write"] {
        assert!(made(&format!("seconds/{stage}")) > 0.0, "{row:#}");
    }
}

#[test]
fn cost_follows_theory() {
    let workplace = Workplace::new();
    workplace.write("scene.json", BOX_AHEAD);
    let tolerances = "--tolerances abs:1e-3,abs:1,abs:1e-1,abs:1e-2,abs:1e-4";
    let study = study(
        &workplace,
        &format!("scene.json --measure points --places 300000 {tolerances}"),
    );
    assert_eq!(study["unit"], "absolute");
    assert_eq!(study["scene"]["title"], "A box ahead");
    let rows = rows(&study);
    let asked: Vec<f64> = rows.iter().map(|row| number(row, "/tolerance")).collect();
    assert_eq!(asked, [1.0, 1e-1, 1e-2, 1e-3, 1e-4]);
    for row in rows {
        assert_consistent(row);
        let made = |name: &str| number(row, &format!("/made/{name}"));
        // The gap is concave on each triangle: its mean is at least a third of its largest value, and each triangle has
        // several places.
        assert!(made("triangles") * 4.0 < 300_000.0, "{row:#}");
        assert!(made("error") > made("gap") / 3.0, "{row:#}");
        assert!(made("bound_length") == made("bound"), "{row:#}");
        let predicted = number(row, "/predicted_triangles") / made("triangles");
        assert!((0.67..1.5).contains(&predicted), "{row:#}");
    }
    for pair in rows.windows(2) {
        let both = |place| (number(&pair[0], place), number(&pair[1], place));
        let (loose, tight) = both("/made/bound");
        assert!(tight < loose);
        let (loose, tight) = both("/made/triangles");
        assert!(tight > loose);
        assert!(both("/made/file_bytes").1 > both("/made/file_bytes").0);
        // Per decade. Triangles inside go with the inverse of the tolerance, those along sides with its root: a share
        // of them takes away half as much. Against theory's least they are no more than all that is beyond it; a
        // twentieth is for numbers that are not large.
        if loose > 10.0 * number(&pair[0], "/made/triangles_in") {
            let slope = (loose / tight).log10();
            let sides = 1.0 - 1.0 / number(&pair[0], "/made/ratio");
            assert!(
                (-1.05..-0.95 + 0.5 * sides).contains(&slope),
                "{slope} {pair:#?}"
            );
            let (loose, tight) = both("/made/minimum_triangles");
            assert!(((tight / loose).log10() - 1.0).abs() < 1e-3, "{pair:#?}");
        }
    }
    assert!(number(&rows[4], "/made/triangles") > 1000.0 * number(&rows[4], "/made/triangles_in"));
}

#[test]
fn uniform_subdivision_needs_more_close_by() {
    let workplace = Workplace::new();
    workplace.write("scene.json", BOX_AHEAD);
    let study = study(
        &workplace,
        "scene.json --places 50000 --tolerances abs:1e-1,abs:1e-2,abs:1e-3",
    );
    let mut carried_out = 0;
    for row in rows(&study) {
        let uniform = &row["made"]["uniform"];
        let (levels, triangles) = (number(uniform, "/levels"), number(uniform, "/triangles"));
        assert_eq!(
            triangles,
            number(row, "/made/triangles_in") * 4f64.powf(levels)
        );
        assert!(triangles > number(row, "/made/triangles"), "{row:#}");
        assert_eq!(uniform["run"].is_object(), triangles <= 2e6, "{row:#}");
        if uniform["run"].is_object() {
            let (gap, error) = (number(uniform, "/run/gap"), number(uniform, "/run/error"));
            assert!(gap <= number(row, "/tolerance") && error <= gap, "{row:#}");
            // With ten places each, the largest one of few is missed once in e^10.
            if triangles * 10.0 < 50_000.0 {
                carried_out += 1;
                assert!(error > gap / 3.0, "{row:#}");
            }
        }
    }
    assert!(carried_out > 0);
}

/// What triangles miss of a round shape is measured against the true shape: seen by an observer at rest that is all that
/// there is, and what is proven of it is hardly more.
#[test]
fn round_shapes_are_measured_against_the_true_surface() {
    let workplace = Workplace::new();
    workplace.write("scene.json", BALL_AT_REST);
    let study = study(
        &workplace,
        "scene.json -q --measure surface --tolerances abs:1e-2,abs:1e-3",
    );
    for row in rows(&study) {
        assert_consistent(row);
        assert!(number(row, "/made/gap") > 0.9 * number(row, "/made/bound"));
        let over = number(row, "/made/error_over_bound");
        assert!((0.8..1.0).contains(&over), "{row:#}");
    }
}

/// Where the surface is seen far from its facet the nearest place is not next to that with the same weights.
#[test]
fn round_shapes_of_fast_observers_are_measured_against_the_true_surface() {
    let workplace = Workplace::new();
    for (shape, beta, tolerance) in [
        (
            r#"{ "cylinder": { "radius": 0.7, "height": 2 } }"#,
            0.99,
            "1e-2",
        ),
        (
            r#"{ "torus": { "major_radius": 1, "minor_radius": 0.35 } }"#,
            0.99,
            "1e-2",
        ),
        (
            r#"{ "torus": { "major_radius": 1, "minor_radius": 0.35 } }"#,
            0.999,
            "1e-3",
        ),
    ] {
        workplace.write(
            "scene.json",
            format!(
                r#"{{ "observer": {{ "velocity": {{ "beta": {beta}, "direction": [-1, 0, 0] }} }},
                "objects": [ {{ "name": "round", "shape": {shape}, "position": [0, 3, 0] }} ] }}"#
            ),
        );
        for measure in ["points", "surface"] {
            let flags = format!("scene.json -q --measure {measure} --tolerances {tolerance}");
            rows(&study(&workplace, &flags))
                .iter()
                .for_each(assert_consistent);
        }
    }
}

#[test]
fn angles_are_proven_and_measured_as_angles() {
    let workplace = Workplace::new();
    workplace.write("scene.json", BOX_AHEAD);
    let study = study(
        &workplace,
        "scene.json --places 20000 --tolerances deg:1,deg:0.1",
    );
    assert_eq!(study["unit"], "angle_deg");
    for row in rows(&study) {
        assert_consistent(row);
        assert!(row["made"]["bound_length"].is_null());
        assert!(number(row, "/made/error") > 0.0 && number(row, "/made/error_length") > 0.0);
    }
}

/// On every built-in scene, what is predicted is what `check` predicts, and nothing measured is beyond what is proven.
#[test]
fn built_in_scenes_keep_their_bounds() {
    let workplace = Workplace::new();
    for scene in ["sphere", "cube", "lattice", "street", "snapshot"] {
        let flags = format!("--example {scene} --places 20000 --tolerances 1e-2,1e-3");
        let study = study(&workplace, &flags);
        assert_eq!(study["unit"], "relative");
        for (row, tolerance) in rows(&study).iter().zip(["1e-2", "1e-3"]) {
            assert_consistent(row);
            let check = workplace.run(&format!("check --example {scene} --tolerance {tolerance}"));
            let table = check.success().stdout_text().replace(',', "");
            let predicted = format!("about {:.0} triangles", number(row, "/predicted_triangles"));
            assert!(table.contains(&predicted), "{predicted}\n{table}");
        }
    }
}

#[test]
fn table_csv_and_json_say_the_same() {
    let workplace = Workplace::new();
    workplace.write("scene.json", BOX_AHEAD);
    let flags = "scene.json --only meshes --repeats 1 --places 1000 --tolerances 1e-1,1e-2,1e-6 --max-triangles 20000";
    let run = workplace.run(&format!("cost {flags} --json study.json --csv study.csv"));
    let run = run.success();
    assert!(
        run.stderr
            .contains("1 tolerance would take more than --max-triangles 20,000"),
        "{run}"
    );
    let study = workplace.read_json("study.json");
    assert!(rows(&study)[2]["made"].is_null());
    let csv = String::from_utf8(workplace.read("study.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let table: Vec<&str> = run.stdout_text().lines().collect();
    assert_eq!((lines.len(), table.len()), (4, 5), "{csv}\n{run}");
    let column = |line: &[&str], name: &str| {
        let index = lines[0].iter().position(|&heading| heading == name);
        line[index.unwrap_or_else(|| panic!("no column {name}"))].to_owned()
    };
    for ((row, line), shown) in rows(&study).iter().zip(&lines[1..]).zip(&table[1..]) {
        let words: Vec<&str> = shown.split_whitespace().collect();
        let written = |name: &str| column(line, name).parse::<f64>().ok();
        assert_eq!(written("tolerance"), Some(number(row, "/tolerance")));
        assert_eq!(words[0].parse().ok(), written("tolerance"), "{run}");
        let Some(made) = row["made"].as_object() else {
            assert!(line[3..].iter().all(|cell| cell.is_empty()), "{csv}");
            assert!(words[2..].iter().all(|&cell| cell == "-"), "{run}");
            continue;
        };
        for name in [
            "triangles",
            "ratio",
            "file_bytes",
            "gap",
            "bound",
            "error",
            "error_over_bound",
        ] {
            assert_eq!(written(name), made[name].as_f64(), "{name}");
        }
        for stage in ["predict", "photosurface", "write"] {
            let seconds = number(row, &format!("/made/seconds/{stage}"));
            assert_eq!(written(&format!("{stage}_seconds")), Some(seconds));
        }
        assert_eq!(
            written("uniform_triangles"),
            Some(number(row, "/made/uniform/triangles"))
        );
        assert_eq!(
            words[2].replace(',', ""),
            column(line, "triangles"),
            "{run}"
        );
        let rounded = format!("{:.2e}", number(row, "/made/bound"));
        assert_eq!(words[6], rounded, "{run}");
    }
    let stdout = workplace.run(&format!("cost {flags} --csv - -q")).success();
    assert_eq!(stdout.stdout_text().lines().next(), csv.lines().next());
    assert_eq!(stdout.stderr, "");
}

#[test]
fn the_same_study_twice_differs_in_time_and_memory_alone() {
    let workplace = Workplace::new();
    let timeless = |threads: &str| {
        let flags = "cost --example cube --tolerances 1e-2,1e-3 --places 9000 --size 32x18 --pixel-samples 1,2 \
            --repeats 2 --json -";
        let run = workplace.run_with(flags, b"", &[("RAYON_NUM_THREADS", threads)]);
        let mut study: Value = serde_json::from_slice(&run.success().stdout).unwrap();
        assert_eq!(study["threads"].to_string(), threads);
        study["threads"].take();
        for row in study["meshes"].as_array_mut().unwrap() {
            row["made"]["seconds"].take();
            row["made"]["peak_memory_bytes"].take();
        }
        for row in study["rays"].as_array_mut().unwrap() {
            row["seconds"].take();
            row["rays_per_second"].take();
        }
        study
    };
    assert_eq!(timeless("1"), timeless("3"));
}

#[test]
fn plots_are_pictures_of_the_size_asked_for() {
    let workplace = Workplace::new();
    let flags = "cost --example cube --tolerances 1e-1,1e-2 --places 100 --size 32x18 --pixel-samples 1,2 --repeats 1";
    workplace
        .run(&format!("{flags} --plot a.png --plot-size 640x480"))
        .success();
    let png = workplace.read("a.png");
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (640, 480));
    workplace.run(&format!("{flags} --plot a.SVG")).success();
    let svg = String::from_utf8(workplace.read("a.SVG")).unwrap();
    assert!(
        svg.starts_with("<svg width=\"960\" height=\"780\""),
        "{svg}"
    );
    for words in [
        "What accuracy costs: ",
        "triangles",
        "uniform 1:4",
        "1e-2",
        "inverse to the tolerance",
        "picture error",
        "root mean square",
        "error to the \u{2212}4/3",
    ] {
        assert!(svg.contains(words), "{words}");
    }
}

/// At small sizes the legend covered curves and words ran off the edge; now it has a strip of its own, and sizes at which
/// that is too little are refused.
#[test]
fn words_cover_neither_curves_nor_each_other_at_the_smallest_size() {
    let workplace = Workplace::new();
    let title = "A cube of which there is much more to be said than a title of one line has room for in this plot";
    let scene = workplace.run("example cube").success();
    let scene = scene.stdout_text().replace("A cube flies by", title);
    workplace.write("scene.json", scene);
    let flags = "cost scene.json --tolerances 1e-1,1e-2,1e-3 --places 100 --size 32x18 --pixel-samples 1,2 --repeats 1";
    workplace
        .run(&format!("{flags} --plot a.svg --plot-size 640x480"))
        .success();
    let svg = String::from_utf8(workplace.read("a.svg")).unwrap();
    let attribute = |element: &str, name: &str| -> Option<String> {
        let (_, rest) = element.split_once(&format!(" {name}=\""))?;
        Some(rest.split('"').next()?.to_owned())
    };
    let number =
        |element: &str, name: &str| -> f64 { attribute(element, name).unwrap().parse().unwrap() };
    // Left, top, right and bottom of each text; letters of DejaVu Sans are half as wide as high.
    let texts = svg.split("<text").skip(1).map(|element| {
        let (tag, words) = element.split_once('>').unwrap();
        let words = words.split('<').next().unwrap().trim();
        let letters = number(tag, "font-size");
        let (x, y) = (number(tag, "x"), number(tag, "y"));
        let width = 0.5 * letters * words.chars().count() as f64;
        let before = match attribute(tag, "text-anchor").unwrap().as_str() {
            "start" => 0.0,
            "middle" => 0.5 * width,
            _ => width,
        };
        let half = 0.4 * letters;
        let bounds = match attribute(tag, "transform") {
            // Upwards.
            Some(_) => [x, y - before, x + half, y + before],
            None => [x - before, y - half, x - before + width, y + half],
        };
        (words.to_owned(), bounds)
    });
    let texts: Vec<(String, [f64; 4])> = texts.collect();
    assert!(texts.len() > 30, "{texts:?}");
    for (index, (words, [left, top, right, bottom])) in texts.iter().enumerate() {
        let is_within = *left >= 0.0 && *top >= 0.0 && *right <= 640.0 && *bottom <= 480.0;
        assert!(is_within, "{words}: {left} {top} {right} {bottom}");
        for (other, [l, t, r, b]) in &texts[..index] {
            let apart = left > r || right < l || top > b || bottom < t;
            assert!(apart, "\"{words}\" is on \"{other}\"");
        }
        for circle in svg.split("<circle").skip(1) {
            let (x, y) = (number(circle, "cx"), number(circle, "cy"));
            let covered = (*left..=*right).contains(&x) && (*top..=*bottom).contains(&y);
            assert!(!covered, "\"{words}\" covers a point");
        }
    }
}

#[test]
fn what_cannot_be_plotted_is_told_all_the_same() {
    let workplace = Workplace::new();
    let run = workplace.run("cost --only meshes --max-triangles 1 --plot out.png -q");
    assert_eq!(run.status, 2, "{run}");
    assert!(
        run.stderr.contains("--plot") && run.stderr.contains("nothing to plot"),
        "{run}"
    );
    assert!(
        String::from_utf8_lossy(&run.stdout).contains("1e-3"),
        "{run}"
    );
    assert!(workplace.files().is_empty(), "{:?}", workplace.files());
}

#[test]
fn a_study_of_what_is_at_rest_says_so() {
    let workplace = Workplace::with_ball();
    let line = "cost square.obj --only meshes --tolerances 1e-1 --places 10 --repeats 1";
    for (flags, is_said) in [("", true), ("--beta 0.5", false)] {
        let run = workplace.run(&format!("{line} {flags}")).success();
        let says = run
            .stderr
            .contains("nothing moves relative to the observer");
        assert_eq!(says, is_said, "{run}");
    }
}

#[test]
fn errors_name_the_flag() {
    let workplace = Workplace::new();
    for (flags, words) in [
        (
            "--tolerances 1e-1,abs:1",
            ["--tolerances", "expected one unit"],
        ),
        (
            "--tolerances 1e-1,1e-2,1e-1",
            ["--tolerances", "1.000e-1 is given twice"],
        ),
        (
            "--tolerances 1e-1,0",
            ["--tolerances", "expected a finite number > 0"],
        ),
        ("--repeats 0", ["--repeats", "at least 1"]),
        ("--places 0", ["--places", "at least 1"]),
        ("--max-triangles -1", ["--max-triangles", "-1"]),
        ("--plot out.pdf", ["--plot", "expected .png or .svg"]),
        ("--plot-size 639x480", ["--plot-size", "at least 640 x 480"]),
        ("--plot-size 960", ["--plot-size", "expected WxH"]),
        ("--json - --csv -", ["--json and --csv", "stdout"]),
        ("--json a --csv ./a", ["./a", "overwrite another output"]),
        (
            "--json a_rays --csv a",
            ["a_rays", "overwrite another output"],
        ),
        ("--csv -", ["--csv", "choose one with --only"]),
        ("--pixel-samples 2,1,2", ["--pixel-samples", "2 rays"]),
        ("--pixel-samples 0", ["--pixel-samples", "expected 1 to 16"]),
        ("--size 0x9", ["--size", "0 x 9"]),
        ("--fov 180", ["--fov", "180"]),
        ("--look 0,0,0", ["--look", "not zero"]),
        ("--json nowhere/a", ["nowhere/a", "cannot write"]),
    ] {
        workplace.run(&format!("cost {flags} -q")).error(&words);
    }
    assert!(workplace.files().is_empty(), "{:?}", workplace.files());
}
