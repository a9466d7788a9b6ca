//! What each effect costs: a scene's export and a picture of it with one effect more, over those without any.
//!
//! `cargo bench --bench effects`, on an idle machine; with `-- --quick` in a fraction of the time. With and without take
//! turns, so that whatever else the machine does slows both down; the table gives medians.

use std::time::Instant;

use photosurface::jobs::{RenderError, export_levels};
use photosurface::render::PictureSize;
use photosurface::scene::BuiltInScene;
use photosurface::write::Format;
use photosurface::{
    ExportSettings, PictureMethod, PictureSettings, PictureView, PlacedScene, Scene, Textures,
    load_models,
};
use serde_json::{Value, json};

/// The scene, changed by the keys of an effect; objects get those of `object`.
struct Case {
    name: &'static str,
    scene: Value,
    object: Value,
}

fn case(name: &'static str, scene: Value) -> Case {
    Case {
        name,
        scene,
        object: json!({}),
    }
}

fn models() -> [Case; 3] {
    [
        case("model delayed", json!({ "model": "delayed" })),
        case("model contracted", json!({ "model": "contracted" })),
        case("model rest", json!({ "model": "rest" })),
    ]
}

fn of_exports() -> Vec<Case> {
    let doppler = |how: &str| json!({ "effects": { "doppler": how } });
    let mut cases = vec![
        case("attribute doppler", json!({ "attributes": ["doppler"] })),
        case("attribute radiance", json!({ "attributes": ["radiance"] })),
        case("doppler spectrum", doppler("spectrum")),
        case("doppler ramp", doppler("ramp")),
    ];
    cases.extend(models());
    cases
}

fn of_pictures() -> Vec<Case> {
    let effects = |effects: Value| json!({ "effects": effects });
    let lamps = |lamps: Value| json!({ "lamps": lamps });
    let point = |x: f64| json!({ "point": { "position": [x, 3, -4], "intensity": 10 } });
    let mut cases = vec![
        case(
            "doppler spectrum",
            effects(json!({ "doppler": "spectrum" })),
        ),
        case("doppler ramp", effects(json!({ "doppler": "ramp" }))),
        case("searchlight", effects(json!({ "searchlight": true }))),
        case(
            "spectrum and searchlight",
            effects(json!({ "doppler": "spectrum", "searchlight": true })),
        ),
        case(
            "searchlight, exposure auto",
            effects(json!({ "searchlight": true, "exposure": "auto" })),
        ),
        Case {
            name: "black bodies",
            scene: json!({}),
            object: json!({ "emission": { "kelvin": 5778 } }),
        },
        case(
            "a sun, with shadows",
            lamps(json!([{ "sun": { "direction": [1, -2, -1], "irradiance": 1 } }])),
        ),
        case(
            "surroundings",
            lamps(json!([{ "ambient": { "irradiance": 1 } }])),
        ),
        case("a point lamp, with shadows", lamps(json!([point(0.0)]))),
        case(
            "four point lamps",
            lamps(json!([point(-3.0), point(-1.0), point(1.0), point(3.0)])),
        ),
    ];
    cases.extend(models());
    cases
}

/// A built-in scene at one step with these changes.
fn placed(name: &str, case: &Case) -> PlacedScene {
    let built_in = BuiltInScene::named(name).expect("a built-in scene");
    let mut scene: Value = serde_json::from_str(built_in.json).expect("tested");
    let with = |value: &mut Value, keys: &Value| {
        for (key, change) in keys.as_object().into_iter().flatten() {
            value[key.as_str()] = change.clone();
        }
    };
    with(&mut scene, &case.scene);
    for object in scene["objects"].as_array_mut().into_iter().flatten() {
        with(object, &case.object);
    }
    let scene = Scene::from_json(&scene.to_string()).expect("a scene");
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes");
    PlacedScene::new(scene, models).expect("one model an object")
}

/// Writes all photosurfaces into memory.
fn export(placed: &PlacedScene) {
    let settings = ExportSettings {
        keep_facts: false,
        ..ExportSettings::default()
    };
    let levels = export_levels(placed, &settings, Format::Glb, "out.glb".as_ref());
    let level = levels.expect("nothing contradicts").remove(0);
    let mut bytes = Vec::new();
    let written = level.fit().write_to(&mut bytes, &());
    written.expect("memory takes everything");
    assert!(!bytes.is_empty());
}

fn picture(placed: &PlacedScene, method: PictureMethod) {
    let mut settings = PictureSettings::new(PictureView::Observer(method));
    settings.camera.size = PictureSize::new(320, 180).expect("a small picture");
    let drawn = photosurface::render(placed, &Textures::default(), &settings, &(), |_, _| {
        Ok::<(), RenderError>(())
    });
    drawn.expect("a picture");
}

/// The medians of both, in seconds; they take turns.
fn medians(rounds: usize, mut bare: impl FnMut(), mut with: impl FnMut()) -> [f64; 2] {
    let mut seconds = [vec![], vec![]];
    for _ in 0..rounds {
        let works: [&mut dyn FnMut(); 2] = [&mut bare, &mut with];
        for (seconds, work) in seconds.iter_mut().zip(works) {
            let start = Instant::now();
            work();
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds[rounds / 2]
    })
}

fn table(title: &str, scene: &str, rounds: usize, cases: &[Case], work: impl Fn(&PlacedScene)) {
    println!("\n{title}, scene \"{scene}\"");
    println!(
        "{:28} {:>12} {:>12} {:>7}",
        "effect", "without, ms", "with, ms", "ratio"
    );
    let bare = placed(scene, &case("none", json!({})));
    for case in cases {
        let changed = placed(scene, case);
        let [without, with] = medians(rounds, || work(&bare), || work(&changed));
        let [without_ms, with_ms] = [without, with].map(|seconds| 1e3 * seconds);
        let ratio = with / without;
        println!(
            "{:28} {without_ms:12.2} {with_ms:12.2} {ratio:7.2}",
            case.name
        );
    }
}

fn main() {
    let is_quick = std::env::args().any(|argument| argument == "--quick");
    let rounds = if is_quick { 3 } else { 15 };
    for scene in ["lattice", "street"] {
        table("export", scene, rounds, &of_exports(), export);
    }
    for scene in ["lattice", "street"] {
        table(
            "picture by rays, 320 x 180",
            scene,
            rounds,
            &of_pictures(),
            |placed| {
                picture(placed, PictureMethod::Rays);
            },
        );
    }
}
