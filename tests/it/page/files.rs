//! The page as a file: what it lets a browser do, how long it is, where it goes and what goes wrong.

use base64::prelude::{BASE64_STANDARD, Engine};
use photosurface::jobs::{PageSettings, page_to_file};
use photosurface::{PlacedScene, Scene, load_models};
use sha2::{Digest, Sha256};

use super::taken_apart::{Page, html_of};
use crate::common::command::{BALL, Workplace};
use crate::common::glb::Glb;

const TEMPLATE: &str = include_str!("../../../src/page/page.html");
const STYLE: &str = include_str!("../../../src/page/page.css");
const BUNDLE: &str = include_str!("../../../src/page/bundle/page.js");

/// Bytes of the viewer, without any scene.
const MAX_VIEWER: usize = 800_000;

/// Bytes of what the page knows of colours and light, beside the table of colours.
const MAX_TABLES: usize = 40_000;

fn ball() -> Page {
    Page::new(html_of(BALL, "".as_ref(), "ball.json"))
}

/// How often a browser finds markup in a page.
fn markup(html: &str) -> Vec<usize> {
    let marks = [
        "<script", "</script", "<style", "</style", "<title", "</title", "<!--", "-->", "<body",
        "</html",
    ];
    marks
        .map(|mark| html.to_ascii_lowercase().matches(mark).count())
        .into()
}

#[test]
fn words_of_a_scene_are_text_however_wild_and_long() {
    let wild = "</script></title></style><script>alert(1)</script><!-- <script> --> \"'` & &lt; {{script}} \u{2028}\u{0}";
    let long = format!("{}</script>{}", "<".repeat(500_000), "ä\"'".repeat(150_000));
    let calm = markup(&ball().html);
    let workplace = Workplace::new();
    for words in [wild, &long] {
        let scene = serde_json::json!({ "title": words, "objects": [
            { "name": words, "shape": { "box": { "size": [1, 1, 1] } } },
            { "name": "same", "shape": { "box": { "size": [1, 1, 1] } } } ] });
        workplace.write("wild.json", scene.to_string());
        let run = workplace.run("page wild.json -o page.html").success();
        assert!(run.stderr.len() < 20_000, "{}", run.stderr.len());
        let page = Page::new(workplace.read("page.html"));
        assert_eq!(markup(&page.html), calm);
        assert_eq!(page.scene["title"], words);
        assert_eq!(page.scene["objects"][0]["name"], words);
        page.vertices(0);
    }
    workplace.write("it's <script>&.json", BALL);
    let line = r#"photosurface page "it's <script>&.json" -o page.html"#;
    workplace.run_shell(line).success();
    let page = Page::new(workplace.read("page.html"));
    assert_eq!(markup(&page.html), calm);
    assert_eq!(page.scene["input"], r"'it'\''s <script>&.json'");
}

#[test]
fn a_browser_runs_the_viewer_and_nothing_else() {
    let html = ball().html;
    let text = |start: &str, end: &str| {
        let mut pieces = html.split(start);
        let (_, after) = (pieces.next(), pieces.next().expect("the element"));
        assert!(pieces.next().is_none(), "one {start}");
        after.split(end).next().expect("text").to_owned()
    };
    let policy = text("http-equiv=\"Content-Security-Policy\" content=\"", "\"");
    let source = |text: &str| format!("'sha256-{}'", BASE64_STANDARD.encode(Sha256::digest(text)));
    let (script, style) = (text("<script>", "</script>"), text("<style>", "</style>"));
    assert!(script == BUNDLE && style == STYLE);
    let directives: Vec<_> = policy.split(';').map(str::trim).collect();
    for expected in [
        "default-src 'none'".to_owned(),
        format!("script-src {}", source(&script)),
        format!("style-src {}", source(&style)),
        "connect-src 'none'".to_owned(),
        "base-uri 'none'".to_owned(),
        "form-action 'none'".to_owned(),
    ] {
        assert!(directives.contains(&&*expected), "{expected} of {policy}");
    }
    assert!(!policy.contains("unsafe") && !policy.contains("http") && !policy.contains('*'));
    // The policy stands before everything that it forbids.
    let place = |mark: &str| html.find(mark).expect("it is there");
    assert!(place("Content-Security-Policy") < place("<style>").min(place("<script")));
    // What the policy would not let through is not there, nor is anything from elsewhere.
    for mark in [
        " src=",
        " href=",
        " style=",
        " onload=",
        " onclick=",
        "<iframe",
        "<link",
        "http://",
        "https://",
    ] {
        assert!(!TEMPLATE.contains(mark), "{mark}");
    }
}

#[test]
fn a_page_is_the_viewer_and_four_thirds_of_its_meshes() {
    let viewer = TEMPLATE.len() + STYLE.len() + BUNDLE.len();
    assert!(viewer <= MAX_VIEWER, "{viewer}");
    let workplace = Workplace::new();
    let grid = r#"{ "objects": [{ "name": "grid", "shape": { "sphere": { "radius": 1, "resolution": 300 } } }] }"#;
    for scene in [BALL, grid] {
        let page = Page::of(scene, &workplace.path(""));
        let base64 = |bytes: &[u8]| bytes.len().div_ceil(3) * 4;
        let tables = page.html.len() - base64(&page.meshes) - base64(&page.colors);
        assert!(tables <= viewer + MAX_TABLES, "{}", tables - viewer);
        assert!(page.colors.len() <= 70_000, "{}", page.colors.len());
    }
    let page = Page::of(grid, &workplace.path(""));
    let vertices = page.vertices(0).len();
    // Places, normals and texture coordinates, and the corners of two triangles, of each vertex.
    assert!(
        page.meshes.len() < vertices * (12 + 12 + 8 + 2 * 12) + 2000,
        "{} of {vertices}",
        page.meshes.len()
    );
    // What files for other programs hold besides would only take room.
    let glb = Glb::new(&page.meshes);
    let attributes = glb.json["meshes"][0]["primitives"][0]["attributes"].as_object();
    let names: Vec<_> = attributes.expect("an object").keys().collect();
    assert!(
        names
            .iter()
            .all(|name| ["POSITION", "NORMAL", "TEXCOORD_0"].contains(&&***name)),
        "{names:?}"
    );
}

#[test]
fn all_ways_lead_to_the_same_bytes() {
    let workplace = Workplace::with_ball();
    workplace.run("page ball.json").success();
    assert_eq!(
        workplace.files(),
        ["ball.json", "ball_page.html", "square.obj"]
    );
    let file = workplace.read("ball_page.html");
    for line in [
        "page ball.json -o -",
        "page ball.json -o - -v",
        "page ball.json -o - --threads 1",
        "page ball.json -o - --threads 5",
    ] {
        assert!(workplace.run(line).success().stdout == file, "{line}");
    }
    assert!(
        html_of(BALL, "".as_ref(), "ball.json") == file,
        "the library"
    );
    let scene = Scene::from_json(BALL).expect("valid");
    let (models, _) = load_models(&scene, "".as_ref()).expect("no files");
    let placed = PlacedScene::new(scene, models).expect("it can be placed");
    let settings = PageSettings {
        input: "ball.json".to_owned(),
        ..PageSettings::default()
    };
    page_to_file(&placed, &settings, &workplace.path("library.html"), &()).expect("it is written");
    assert!(workplace.read("library.html") == file);
}

#[test]
fn a_page_without_a_scene_flies() {
    let workplace = Workplace::new();
    let run = workplace.run("page").success();
    assert!(
        run.stdout.is_empty() && run.stderr.contains("flight_page.html: "),
        "{run}"
    );
    let page = Page::new(workplace.read("flight_page.html"));
    assert_eq!(page.scene["input"], "--example flight");
    assert!(!page.scene["flight"].as_array().expect("a list").is_empty());
}

#[test]
fn flags_reach_the_page() {
    let workplace = Workplace::with_ball();
    let line = "page ball.json -o - --rapidity 2 --direction 0,0,-1 --time 3 --observer 1,2,3 --steps 0,4 --doppler ramp \
                --searchlight --exposure 2 --no-flight";
    let page = Page::new(workplace.run(line).success().stdout);
    let scene = &page.scene;
    assert_eq!(scene["observer"]["rapidity"], 2.0);
    assert_eq!(scene["observer"]["time"], 3.0);
    assert_eq!(
        scene["observer"]["position"],
        serde_json::json!([1.0, 2.0, 3.0])
    );
    assert_eq!(scene["steps"], serde_json::json!([0.0, 4.0]));
    assert_eq!(scene["effects"]["doppler"], "ramp");
    assert_eq!(scene["effects"]["searchlight"], true);
    // What the page's own state says is not repeated by its commands.
    assert_eq!(scene["input"], "ball.json");
    let page = Page::new(
        workplace
            .run("page --example flight --no-flight -o -")
            .success()
            .stdout,
    );
    assert_eq!(page.scene["flight"], serde_json::json!([]));
}

#[test]
fn what_goes_wrong_leaves_everything_as_it_was() {
    let workplace = Workplace::with_ball();
    workplace.write("out.html", "what was there");
    workplace.write("broken.json", "{");
    for (line, words) in [
        ("page ball.json -o ball.json", "ball.json"),
        ("page square.obj -o square.obj", "square.obj"),
        ("page nosuch.json -o out.html", "nosuch.json"),
        ("page ball.txt -o out.html", "unknown extension"),
        ("page broken.json -o out.html", "line 1"),
        ("page --example nosuch -o out.html", "nosuch"),
        ("page ball.json -o nosuch/out.html", "nosuch"),
        ("page ball.json --beta 0.1,0.5 -o out.html", "--beta"),
    ] {
        workplace.run(line).error(&["error: ", words]);
    }
    if cfg!(target_os = "linux") {
        let line = "trap '' XFSZ; ulimit -f 1; exec photosurface page ball.json -q -o out.html";
        workplace
            .run_shell(line)
            .error(&["out.html", "File too large"]);
    }
    assert_eq!(workplace.read("out.html"), b"what was there");
    assert_eq!(workplace.read("ball.json"), BALL.as_bytes());
    assert_eq!(
        workplace.files(),
        ["ball.json", "broken.json", "out.html", "square.obj"]
    );
}
