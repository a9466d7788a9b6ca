//! Predictions for many steps, of which few are dear.

use photosurface::{PlacedScene, Scene, SurfaceOptions, load_models};
use serde_json::json;

fn placed(scene: &Scene, steps: Vec<f64>) -> PlacedScene {
    let scene = scene.clone().with_steps(steps).expect("finite");
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes alone");
    PlacedScene::new(scene, models).expect("a model for each")
}

/// The observer flies close by a plate, which takes many triangles for a moment.
fn passing() -> Scene {
    let scene = json!({
        "observer": { "position": [0, 0.02, 30], "velocity": { "beta": 0.9 },
            "flight": [{ "proper_time": 20, "acceleration": [0, 0, -0.05] }] },
        "objects": [{ "name": "plate", "shape": { "grid": { "size": 2, "cells": 1 } }, "tolerance": { "absolute": 1e-3 },
            "measure": "points" }],
    });
    Scene::from_json(&scene.to_string()).expect("valid")
}

/// A thousand steps at once are predicted as the sum of a thousand steps one by one.
#[test]
fn the_dearest_moments_are_not_overlooked() {
    let (scene, wanted) = (passing(), SurfaceOptions::default());
    let steps: Vec<f64> = (0..=1000).map(|index| 0.02 * f64::from(index)).collect();
    let one_by_one: Vec<f64> = (steps.iter())
        .map(|&step| placed(&scene, vec![step]).predictions(wanted)[0].triangles)
        .collect();
    let sum: f64 = one_by_one.iter().sum();
    let mut dearest = one_by_one.clone();
    dearest.sort_by(|a, b| b.total_cmp(a));
    // The scene is one of few dear moments: a twentieth of the steps takes a third of the triangles, and the dearest a
    // dozen times the mean.
    assert!(dearest[..50].iter().sum::<f64>() > 0.3 * sum);
    assert!(dearest[0] > 10.0 * sum / 1001.0);
    let together = placed(&scene, steps).predictions(wanted)[0].triangles;
    assert!((together / sum - 1.0).abs() < 0.1, "{together} {sum}");
}

/// A budget for many steps gives the dear ones what they need, and holds.
#[test]
fn a_budget_follows_the_dearest_moments() {
    let (scene, wanted) = (passing(), SurfaceOptions::default());
    let steps: Vec<f64> = (0..=200).map(|index| 0.1 * f64::from(index)).collect();
    let whole = placed(&scene, steps);
    let made = |placed: &PlacedScene| -> (usize, bool) {
        let surfaces =
            (0..=200).flat_map(|step| placed.photosurfaces(step, wanted).expect("a step"));
        surfaces.fold((0, true), |(sum, complete), surface| {
            let facts = surface.facts;
            (
                sum + facts.triangles,
                complete && facts.certificate.complete,
            )
        })
    };
    let (needed, _) = made(&whole);
    let (within, loosening) = whole.clone().within_budget(wanted, 2 * needed as u64);
    assert_eq!(loosening, [1.0]);
    assert_eq!(made(&within), (needed, true));
    let (within, _) = whole.within_budget(wanted, needed as u64 / 2);
    let (fewer, complete) = made(&within);
    assert!(
        fewer <= needed / 2 && fewer > needed / 4 && !complete,
        "{fewer} of {needed}"
    );
}
