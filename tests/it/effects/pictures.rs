//! Effects in pictures: against closed forms, and rays against photosurfaces.

use std::sync::Arc;

use glam::DVec2;
use photosurface::effects::{
    Daylight, Doppler, Reflectance, Spectrum, luminance, ramp_color, tone, within_gamut,
};
use photosurface::jobs::{Aim, CameraSettings, PictureProjection, RenderError};
use photosurface::material::Material;
use photosurface::render::{
    Camera, Picture, PictureEffects, PictureOptions, PictureSize, Projection, Scenery, Viewpoint,
};
use photosurface::scene::{Effects, Exposure, Object, Source};
use photosurface::shape::{Appearance, Color, Shape};
use photosurface::{
    DVec3, PictureMethod, PictureSettings, PictureView, PlacedScene, Scene, Textures, load_models,
    render,
};
use serde_json::{Value, json};

const BETA: f64 = 0.8;

/// The bytes, before they are rounded, that a screen shows of linear light.
fn bytes(light: DVec3) -> [f64; 3] {
    tone(within_gamut(light)).to_array().map(|channel| {
        // IEC 61966-2-1.
        let encoded = match channel <= 0.003_130_8 {
            true => 12.92 * channel,
            false => 1.055 * channel.powf(1.0 / 2.4) - 0.055,
        };
        255.0 * encoded
    })
}

fn placed(scene: &Value) -> PlacedScene {
    let scene = Scene::from_json(&scene.to_string()).expect("a valid scene");
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes");
    PlacedScene::new(scene, models).expect("one model an object")
}

/// Something around an observer who moves along -z, with these effects.
fn around(shape: &Value, more: &Value, effects: &Value) -> PlacedScene {
    let mut object = json!({ "name": "around", "shape": shape });
    for (key, value) in more.as_object().expect("keys of an object") {
        object[key] = value.clone();
    }
    placed(&json!({
        "observer": { "velocity": { "beta": BETA, "direction": [0, 0, -1] } },
        "objects": [object],
        "effects": effects,
    }))
}

/// The same with a ball of a grey that it has whatever the lamp: without a lamp's angles.
fn around_unlit(grey: f64, effects: &Value) -> PlacedScene {
    let sphere = json!({ "sphere": { "radius": 9 } });
    let scene = around(&sphere, &json!({}), effects).scene().clone();
    let material = json!({
        "pbrMetallicRoughness": { "baseColorFactor": [grey, grey, grey, 1.0] },
        "doubleSided": true,
        "extensions": { "KHR_materials_unlit": {} },
    });
    let material = Arc::new(Material::new(material, vec![]).expect("a material"));
    let shape = Shape::sphere(9.0).expect("a sphere");
    let mut model = shape.model(&Appearance::default()).expect("a model");
    model.parts[0].material = Some(material);
    let object = Object::new("around", Source::Model(Arc::new(model)));
    let unlit = Scene::new(scene.observer().clone(), vec![object]).expect("a scene");
    let unlit = unlit.with_effects(scene.effects());
    let (models, _) = load_models(&unlit, ".".as_ref()).expect("a model at hand");
    PlacedScene::new(unlit, models).expect("one model an object")
}

/// The picture of the whole sky.
fn sky(placed: &PlacedScene, method: PictureMethod, [width, height]: [u32; 2]) -> Picture {
    let mut settings = PictureSettings::new(PictureView::Observer(method));
    settings.camera = CameraSettings {
        projection: PictureProjection::FullSky,
        aim: Aim::Look(DVec3::NEG_Z),
        ..CameraSettings::new(PictureSize::new(width, height).expect("pixels"))
    };
    settings.samples = 1.try_into().expect("a ray a pixel");
    let mut picture = None;
    let rendered = render(placed, &Textures::default(), &settings, &(), |_, drawn| {
        picture = Some(drawn.clone());
        Ok::<(), RenderError>(())
    });
    rendered.expect("a picture");
    picture.expect("one step")
}

/// Holds every pixel of a picture of the sky against the light that is expected at its Doppler factor.
#[track_caller]
fn assert_sky(placed: &PlacedScene, expected: impl Fn(f64) -> DVec3) {
    let picture = sky(placed, PictureMethod::Rays, [72, 36]);
    let size = PictureSize::new(72, 36).expect("pixels");
    let camera = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).expect("a camera");
    for (x, y) in (0..36).flat_map(|y| (0..72).map(move |x| (x, y))) {
        let seen = camera.direction(DVec2::new(f64::from(x), f64::from(y)) + 0.5);
        let factor = 0.6 / (1.0 + BETA * seen.z);
        let expected = bytes(expected(factor));
        let found = picture.pixel(x, y).map(f64::from);
        for channel in 0..3 {
            let error = found[channel] - expected[channel];
            // Half a step of rounding, and the table's error.
            assert!(
                error.abs() <= 0.6,
                "{seen} {factor}: {found:?} {expected:?}"
            );
        }
    }
}

/// A grey surface is a black body of the temperature times the Doppler factor.
#[test]
fn a_grey_ball_has_the_colours_of_black_bodies() {
    let light = Daylight::default();
    let part = f64::from(Color([0x80; 3]).linear()[0]);
    let grey = Reflectance::Grey(part);
    let of = |effects: Value| around_unlit(part, &effects);
    let both = of(json!({ "doppler": "spectrum", "searchlight": true }));
    assert_sky(&both, |factor| light.seen_color(&grey, factor));
    let colour = of(json!({ "doppler": "spectrum" }));
    assert_sky(&colour, |factor| {
        let light = light.seen_color(&grey, factor);
        light * (part / luminance(light))
    });
    let brightness = of(json!({ "searchlight": true, "exposure": -2 }));
    assert_sky(&brightness, |factor| {
        DVec3::splat(luminance(light.seen_color(&grey, factor)) / 4.0)
    });
    assert_sky(&of(json!({ "doppler": "ramp" })), ramp_color);
}

/// No lamp, no paint: a box is as bright on all its faces.
#[test]
fn a_black_body_needs_no_lamp() {
    let white = Daylight::default();
    let shape = json!({ "box": { "size": [3, 9, 5] } });
    let more = json!({ "color": "#102030", "emission": { "kelvin": 5778, "luminance": 0.5 } });
    // In linear sRGB with daylight white.
    let at = |factor: f64| white.seen_color(&Reflectance::Grey(1.0), factor * 5778.0 / 6504.0);
    let rest = luminance(at(1.0));
    let both = json!({ "doppler": "spectrum", "searchlight": true });
    assert_sky(&around(&shape, &more, &both), |factor| {
        at(factor) * (0.5 / rest)
    });
    // Without effects it has its own colour.
    assert_sky(&around(&shape, &more, &json!({})), |_| {
        at(1.0) * (0.5 / rest)
    });
}

/// Rays ask the ray, photosurfaces the place where they are hit: the pictures are the same but for rims.
#[test]
fn both_methods_show_the_same_effects() {
    let scene = json!({
        "observer": { "velocity": { "beta": 0.9, "direction": [0, 0.2, -1] } },
        "objects": [
            { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [-2, 0, -2], "color": "#c04020" },
            { "name": "box", "shape": { "box": { "size": [2, 2, 2] } }, "position": [2, 0, -3], "color": "#2040c0",
              "velocity": { "beta": 0.5, "direction": [1, 0, 0] } },
            { "name": "star", "shape": { "sphere": { "radius": 1 } }, "position": [0, 2, 2], "emission": { "kelvin": 3000 } },
        ],
        "effects": { "doppler": "spectrum", "searchlight": true, "exposure": "auto" },
        "tolerance": { "angle_deg": 0.02 },
    });
    let placed = placed(&scene);
    let [rays, mesh] =
        [PictureMethod::Rays, PictureMethod::Mesh].map(|method| sky(&placed, method, [180, 90]));
    let background = PictureOptions::default().background.0;
    let (mut seen, mut off) = (0, 0);
    for (x, y) in (0..90).flat_map(|y| (0..180).map(move |x| (x, y))) {
        let [a, b] = [&rays, &mesh].map(|picture| picture.pixel(x, y));
        seen += u32::from(a != background);
        let most = (0..3).map(|channel| a[channel].abs_diff(b[channel])).max();
        off += u32::from(most > Some(3));
    }
    assert!(seen > 500, "{seen}");
    assert!(off * 100 < seen, "{off} of {seen}");
}

/// From outside, a photosurface has the colours that its observer sees: an eye at the observer's place finds the hues of
/// the observer's own view, where the Doppler factor would be 1 for the eye itself.
#[test]
fn from_outside_colours_are_those_that_the_observer_sees() {
    let effects = Effects {
        doppler: Doppler::Spectrum(Spectrum::default()),
        searchlight: true,
        exposure: Exposure::default(),
    };
    let placed = around(
        &json!({ "box": { "size": [9, 9, 9] } }),
        &json!({ "color": "#606060" }),
        &json!({}),
    );
    let moment = placed.scene().moment(0).expect("a step");
    let mut scenery = Scenery::new();
    scenery.set_effects(PictureEffects::new(effects));
    let object = &placed.scene().objects()[0];
    for surface in placed.photosurfaces(0, Default::default()).expect("a step") {
        scenery.add_photosurface(object, &moment, &surface.mesh, surface.material.as_ref());
    }
    let size = PictureSize::new(32, 16).expect("pixels");
    let camera = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).expect("a camera");
    let options = PictureOptions {
        samples: 1,
        ..PictureOptions::default()
    };
    let inside = scenery.picture(&camera, Viewpoint::Observer(&moment), options);
    let outside = scenery.picture(&camera, Viewpoint::Outside(DVec3::ZERO), options);
    let hue = |picture: &Picture, x, y| {
        let linear = Color(picture.pixel(x, y)).linear();
        f64::from(linear[2]) / f64::from(linear[0])
    };
    let mut told = 0;
    for (x, y) in (0..16).flat_map(|y| (0..32).map(move |x| (x, y))) {
        // In the dark, bytes say little of hues, and the tone curve makes bright light white.
        let is_told = |picture: &Picture| {
            let pixel = picture.pixel(x, y);
            pixel.iter().all(|byte| (60..200).contains(byte))
        };
        if is_told(&inside) && is_told(&outside) {
            told += 1;
            let [a, b] = [&inside, &outside].map(|picture| hue(picture, x, y));
            assert!((a / b - 1.0).abs() < 0.06, "{x} {y}: {a} {b}");
        }
    }
    assert!(told > 50, "{told}");
}
