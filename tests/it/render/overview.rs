//! Pictures that are handed what was found by looking at all steps: nothing else of the other steps is needed.

use photosurface::jobs::{Overview, RenderError, Variant, overview, render_side_by_side};
use photosurface::render::{Picture, PictureSize};
use photosurface::{
    PictureMethod, PictureSettings, PictureView, PlacedScene, Scene, Textures, load_models,
};

const STEPS: [f64; 5] = [-3.0, -1.0, 0.0, 1.5, 6.0];

const SCENE: &str = r#"{ "observer": { "velocity": { "beta": 0.7, "direction": [1, 0, 0] } },
  "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1, "resolution": 8 } }, "position": [0, 3, 0] },
    { "name": "box", "shape": { "box": { "size": [1, 1, 1] } }, "position": [4, -2, -1] } ],
  "effects": { "searchlight": true, "exposure": "auto" }, "tolerance": { "relative": 0.1 } }"#;

fn rows(steps: &[f64]) -> Vec<Vec<Variant>> {
    let scene = Scene::from_json(SCENE).unwrap();
    let scene = scene.with_steps(steps.to_vec()).unwrap();
    let (models, _) = load_models(&scene, ".".as_ref()).unwrap();
    let placed = PlacedScene::new(scene, models).unwrap();
    let label = String::new();
    vec![vec![Variant { label, placed }]]
}

fn pictures(
    rows: &[Vec<Variant>],
    settings: &PictureSettings,
) -> Result<Vec<Picture>, RenderError> {
    let mut pictures = vec![];
    render_side_by_side(rows, &Textures::default(), settings, &(), |_, picture| {
        pictures.push(picture.clone());
        Ok::<(), RenderError>(())
    })?;
    Ok(pictures)
}

/// A scene that has one of the steps alone gives the picture of that step in the whole, if it is handed the overview of the
/// whole, also by way of JSON; without, it gives another.
#[test]
fn a_step_alone_with_the_overview_of_all_is_as_among_them() {
    for view in [
        PictureView::Observer(PictureMethod::Rays),
        PictureView::Observer(PictureMethod::Mesh),
        PictureView::Outside {
            from: None,
            together: false,
        },
    ] {
        let mut settings = PictureSettings::new(view);
        settings.camera.size = PictureSize::new(40, 30).unwrap();
        let whole = pictures(&rows(&STEPS), &settings).unwrap();
        let found = overview(&rows(&STEPS), &Textures::default(), &settings, &()).unwrap();
        let text = serde_json::to_string(&found).unwrap();
        let again: Overview = serde_json::from_str(&text).unwrap();
        assert_eq!(again, found, "{text}");
        for (step, expected) in STEPS.iter().zip(&whole) {
            let alone = rows(&[*step]);
            let handed = PictureSettings {
                overview: Some(again.clone()),
                ..settings.clone()
            };
            assert!(
                pictures(&alone, &handed).unwrap()[0] == *expected,
                "{view:?} {step}"
            );
            assert!(
                pictures(&alone, &settings).unwrap()[0] != *expected,
                "{view:?} {step}"
            );
        }
        // Of other settings: there is no camera outside, or no exposure.
        let mut others = settings.clone();
        others.view = match view {
            PictureView::Observer(_) => PictureView::Outside {
                from: None,
                together: false,
            },
            _ => PictureView::Observer(PictureMethod::Rays),
        };
        others.overview = Some(found);
        let refused = pictures(&rows(&STEPS), &others);
        assert!(matches!(refused, Err(RenderError::Overview)), "{view:?}");
    }
}
