//! Finite results and finite files, whatever is asked for: what cannot be written is one clear error.

use std::sync::Arc;

use crate::common::command::Workplace;
use crate::common::glb::{Glb, pack};
use crate::common::refining::model;
use crate::common::{Random, cases};
use photosurface::light_cone::{PhotosurfaceMap, View};
use photosurface::scene::Place;
use photosurface::spacetime::{Event, Lorentz, MAX_RAPIDITY, VelocityError, WorldLine};
use photosurface::tessellate::Precision;
use photosurface::write::{Export, WriteError, write_glb};
use photosurface::{
    DVec3, Mesh, Object, Observer, PlacedScene, Scene, Source, SurfaceOptions, Velocity,
    load_models,
};
use proptest::prelude::*;

/// A scene with one mesh at rest at `place`; the observer at the origin.
fn placed(mesh: &Mesh, place: DVec3, velocity: Velocity) -> PlacedScene {
    let observer = Observer {
        velocity,
        ..Observer::default()
    };
    let source = Source::Model(Arc::new(model(std::slice::from_ref(mesh))));
    let object = Object {
        position: Place::new(place).expect("a finite place"),
        ..Object::new("thing", source)
    };
    let scene = Scene::new(observer, vec![object]).expect("one object with a name");
    let (models, _) = load_models(&scene, ".".as_ref()).expect("nothing to be read");
    PlacedScene::new(scene, models).expect("one model an object")
}

/// Triangles a photosurface is refined to, about: at the tip of a cone of light a tolerance of 1e-3 takes as many as
/// gamma, which is what a budget is for.
const BUDGET: u64 = 400;

/// The bytes of a file, or the one error.
fn export(placed: PlacedScene, subdivide: bool) -> Result<Vec<u8>, WriteError> {
    let wanted = SurfaceOptions {
        subdivide,
        ..SurfaceOptions::default()
    };
    let (placed, _) = placed.within_budget(wanted, BUDGET);
    let photosurfaces: Vec<_> = placed.photosurfaces(0, wanted).expect("a step").collect();
    let scene = placed.facts();
    let export = Export {
        scene: &scene,
        marker: None,
        photosurfaces: &photosurfaces,
        playback: None,
    };
    let mut bytes = Vec::new();
    write_glb(&export, &mut bytes)?;
    Ok(bytes)
}

/// Every number of a GLB: those of all accessors with `f32`, and all of its JSON.
fn assert_finite(bytes: &[u8], case: &str) {
    let glb = Glb::new(bytes);
    // NaN and infinity are null in JSON.
    assert!(
        !glb.text.contains("null"),
        "{case}: a number is missing in {}",
        glb.text
    );
    let mut numbers = 0;
    for accessor in glb.json["accessors"].as_array().expect("accessors") {
        if accessor["componentType"] != 5126 {
            continue;
        }
        for &word in glb.view(&accessor["bufferView"]).as_chunks().0 {
            let number = f32::from_le_bytes(word);
            assert!(number.is_finite(), "{case}: {number}");
            numbers += 1;
        }
    }
    assert!(numbers > 0, "{case}: no numbers");
}

fn triangle(corners: [DVec3; 3]) -> Mesh {
    Mesh::new(corners.to_vec(), vec![[0, 1, 2]])
        .and_then(|mesh| mesh.with_normals(vec![DVec3::Y; 3]))
        .expect("finite")
}

fn small_mesh(size: f64) -> Mesh {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|corner| corner * size);
    Mesh::new(
        corners.to_vec(),
        vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    )
    .expect("finite")
}

/// 25 rapidities, 20 distances, 20 directions: 10,000 files, each finite or refused for its range.
#[test]
fn ten_thousand_files_are_finite_or_one_clear_error() {
    let mut random = Random::new(7);
    let rapidities = [
        0.0, 5e-324, 1e-300, 1e-20, 1e-8, 0.1, 0.5, 1.0, 2.0, 3.0, 5.0, 7.6, 10.0, 14.5, 18.0,
        19.0, 20.0, 28.3, 40.0, 60.0, 80.0, 100.0, 200.0, 300.0, 350.0,
    ];
    let distances = [
        0.0, 1e-300, 1e-150, 1e-40, 1e-20, 1e-9, 1e-3, 0.1, 0.5, 1.0, 2.0, 10.0, 1e3, 1e9, 1e20,
        1e36, 1e40, 1e75, 1e155, 1e300,
    ];
    let (mut written, mut refused) = (0, 0);
    for rapidity in rapidities {
        for (number, distance) in distances.into_iter().enumerate() {
            // As large as it is far away, or much smaller, or much larger.
            let size = [1.0_f64, distance, 1e-3 * distance][number % 3].max(1e-30_f64);
            let mesh = small_mesh(size);
            for number in 0..20 {
                let direction = match number {
                    0..3 => DVec3::AXES[number],
                    3 => DVec3::new(1.0, 2.0, 3.0),
                    4 => DVec3::new(1e-300, 1.0, -1e-300),
                    5 => DVec3::new(1e300, -1e300, 5e299),
                    _ => random.direction(),
                };
                let place = match number {
                    3 | 6 => direction * distance,
                    7 => direction * -distance,
                    _ => random.direction() * distance,
                };
                let case = format!("rapidity {rapidity}, size {size}, {place}, {direction}");
                let velocity = Velocity::from_rapidity(rapidity, direction).expect("valid");
                // Of the directions two are refined, at every rapidity and distance: a file takes as long as 50 others.
                let subdivide = matches!(number, 3 | 9);
                match export(placed(&mesh, place, velocity), subdivide) {
                    Ok(bytes) => {
                        assert_finite(&bytes, &case);
                        written += 1;
                    }
                    Err(
                        WriteError::Range { .. }
                        | WriteError::Overflow { .. }
                        | WriteError::TooSmall { .. },
                    ) => refused += 1,
                    Err(other) => panic!("{case}: {other}"),
                }
            }
        }
    }
    assert_eq!(written + refused, 10_000);
    // What fits into `f32` is not refused: two thirds of the distances do for half of the rapidities.
    assert!(written > 3_300, "only {written} written");
}

/// Triangles without area, needles, one point, the observer on a corner, an edge, a face; all ahead and all
/// behind; neighbouring floats and coordinates as far apart as can be.
#[test]
fn degenerate_triangles_make_finite_files() {
    let (o, x, y) = (DVec3::ZERO, DVec3::X, DVec3::Y);
    let tiny = DVec3::new(1.0, f64::EPSILON, 0.0);
    let shapes = [
        ("a point", [x, x, x]),
        ("a point at the observer", [o, o, o]),
        ("a double corner", [x, x, y]),
        ("collinear", [x, x * 2.0, x * 3.0]),
        ("collinear through the observer", [-x, x, x * 3.0]),
        ("a needle", [x, tiny, x * 1e3]),
        ("a needle across", [x, x + y * 1e-16, x + y * 1e6]),
        ("the observer on a corner", [o, x, y]),
        ("the observer on an edge", [-x, x, y]),
        ("the observer on the face", [-x - y, x - y, y]),
        (
            "the observer just off the face",
            [-x - y, x - y, y + DVec3::Z * 1e-16],
        ),
        ("all ahead", [x, x + y * 0.1, x * 1.1]),
        ("all behind", [-x, y * 0.1 - x, x * -1.1]),
        (
            "neighbouring floats",
            [x, tiny, DVec3::new(1.0f64.next_up(), 0.0, 0.0)],
        ),
        ("far apart", [x * 1e-300, y * 1e30, x * -1e30]),
        ("subnormal", [x * 5e-324, y * 5e-324, -x]),
    ];
    for (name, corners) in shapes {
        for rapidity in [0.0, 1e-300, 1.0, 7.6, 40.0, 350.0] {
            for direction in [DVec3::X, DVec3::NEG_X, DVec3::new(1.0, 2.0, -3.0)] {
                for subdivide in [false, true] {
                    let velocity = Velocity::from_rapidity(rapidity, direction).expect("valid");
                    let case = format!("{name}, rapidity {rapidity}, {direction}");
                    match export(placed(&triangle(corners), o, velocity), subdivide) {
                        Ok(bytes) => assert_finite(&bytes, &case),
                        Err(WriteError::Range { .. } | WriteError::TooSmall { .. }) => {
                            assert!(rapidity > 7.6, "{case}: refused");
                        }
                        Err(other) => panic!("{case}: {other}"),
                    }
                }
            }
        }
    }
}

/// Ahead of the observer an error is magnified by `exp(eta)`, behind him by 1: nowhere by more or less.
#[test]
fn the_condition_is_the_largest_stretch_at_a_vertex() {
    let velocity = Velocity::from_gamma(1000.0, DVec3::X).expect("valid");
    for (place, expected) in [(1.0, velocity.stretch()), (-1.0, 1.0)] {
        let mesh = triangle([1.0, 2.0, 3.0].map(|x| DVec3::X * (place * x)));
        let placed = placed(&mesh, DVec3::ZERO, velocity);
        let made = placed
            .photosurfaces(0, SurfaceOptions::default())
            .expect("a step")
            .next()
            .expect("one part");
        let condition = made.facts.condition;
        assert!(
            (condition / expected - 1.0).abs() <= 4.0 * f64::EPSILON,
            "{condition}"
        );
    }
}

#[test]
fn no_triangles_and_no_numbers_are_clear_errors() {
    for corners in [vec![], vec![DVec3::X]] {
        let empty = Mesh::new(corners, vec![]).expect("nothing wrong with it");
        let error = export(placed(&empty, DVec3::X, Velocity::ZERO), true).expect_err("empty");
        assert!(matches!(error, WriteError::Empty(_)), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let error = Mesh::new(vec![DVec3::new(0.0, bad, 0.0)], vec![]).expect_err("no number");
        assert!(
            error.to_string().contains("expected finite numbers"),
            "{error}"
        );
    }
}

/// The same through the command.
#[test]
fn the_command_takes_degenerate_files_or_says_why_not() {
    let workplace = Workplace::new();
    for (name, text, error) in [
        ("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", None),
        (
            "needle.obj",
            "v 0 0 -1\nv 1e-30 0 -1\nv 0 9 -1\nf 1 2 3\n",
            None,
        ),
        ("touching.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", None),
        ("same.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n", None),
        (
            "nan.obj",
            "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            Some("nan"),
        ),
        (
            "inf.obj",
            "v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            Some("inf"),
        ),
        ("empty.obj", "", Some("empty.obj")),
        ("one.obj", "v 0 0 0\n", Some("one.obj")),
        (
            "far.obj",
            "v 1e200 0 0\nv 2e200 1 0\nv 0 1e200 0\nf 1 2 3\n",
            Some("1e200"),
        ),
    ] {
        workplace.write(name, text);
        for speed in ["--beta 0", "--beta 0.9", "--gamma 1e6", "--rapidity 40"] {
            let run = workplace.run(&format!(
                "export {name} {speed} --direction 1,2,-3 --observer 0,0,0 -o out.glb"
            ));
            if let Some(message) = error {
                run.error(&[message]);
                continue;
            }
            assert!(run.status == 0 || run.status == 1, "{run}");
            assert_finite(&workplace.read("out.glb"), &format!("{name} {speed}"));
        }
    }
    let run = workplace.run("export far.obj --rapidity 350 --observer 0,0,0 -o out2.glb");
    assert_eq!(run.status, 2, "{run}");
    assert!(!workplace.files().iter().any(|name| name == "out2.glb"));
}

/// A GLB of nothing but triangles, three corners each.
fn glb(corners: &[[f32; 3]]) -> Vec<u8> {
    let of_all = |axis: usize, choose: fn(f32, f32) -> f32| {
        let numbers = corners.iter().map(|corner| corner[axis]);
        numbers
            .reduce(choose)
            .filter(|number| number.is_finite())
            .unwrap_or(0.0)
    };
    let (low, high) = (
        [0, 1, 2].map(|axis| of_all(axis, f32::min)),
        [0, 1, 2].map(|axis| of_all(axis, f32::max)),
    );
    let bytes: Vec<u8> = corners
        .as_flattened()
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0, "name": "thing" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "count": corners.len(), "type": "VEC3",
            "min": low, "max": high,
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() }],
        "buffers": [{ "byteLength": bytes.len() }],
    });
    pack(&document, &bytes)
}

#[test]
fn the_command_takes_degenerate_binary_files_or_says_why_not() {
    let workplace = Workplace::new();
    let (a, b, c) = ([0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0]);
    let largest = f32::MAX;
    for (name, corners, error) in [
        ("no_area.glb", vec![a, b, a, a, b, [2.0, 0.0, -1.0]], None),
        ("doubled.glb", vec![a, b, c, a, b, c, c, b, a], None),
        ("one_point.glb", vec![a, a, a], None),
        ("at_the_observer.glb", vec![[0.0; 3], b, c], None),
        (
            "needle.glb",
            vec![a, [1e-38, 0.0, -1.0], [0.0, 1e3, -1.0]],
            None,
        ),
        (
            "subnormal.glb",
            vec![[1e-45, 0.0, 0.0], [0.0, 1e-45, 0.0], [0.0, 0.0, -1e-45]],
            None,
        ),
        ("nan.glb", vec![a, [f32::NAN, 0.0, 0.0], c], Some("NaN")),
        (
            "infinite.glb",
            vec![a, [f32::INFINITY, 0.0, 0.0], c],
            Some("inf"),
        ),
        (
            "far.glb",
            vec![
                [largest, 0.0, 0.0],
                [0.0, largest, 0.0],
                [0.0, 0.0, largest],
            ],
            Some("32-bit"),
        ),
    ] {
        workplace.write(name, glb(&corners));
        for speed in ["--beta 0.9", "--gamma 1e6", "--rapidity 40"] {
            let run = workplace.run(&format!(
                "export {name} {speed} --direction 1,2,-3 --observer 0,0,0 --max-triangles 1000 -o out.glb"
            ));
            if let Some(message) = error {
                run.error(&[message]);
                continue;
            }
            if run.status == 2 {
                // Next to nothing stays next to nothing, unless it is stretched by gamma.
                assert!(name == "subnormal.glb" && speed != "--rapidity 40", "{run}");
                run.error(&["too small for the 32-bit numbers"]);
                continue;
            }
            assert!(run.status == 0 || run.status == 1, "{run}");
            assert_finite(&workplace.read("out.glb"), &format!("{name} {speed}"));
        }
    }
}

/// Numbers that hurt, of any size.
fn nasty_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        Just(-0.0),
        Just(5e-324),
        Just(-f64::MIN_POSITIVE),
        Just(1.0),
        Just(1f64.next_down()),
        Just(f64::MAX),
        Just(f64::MIN),
        -2.0..2.0f64,
        (-320.0..308.0f64, any::<bool>())
            .prop_map(|(exponent, minus)| 10f64.powf(exponent) * if minus { -1.0 } else { 1.0 }),
    ]
}

fn nasty_vector() -> impl Strategy<Value = DVec3> {
    (nasty_number(), nasty_number(), nasty_number()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn nasty_velocity() -> impl Strategy<Value = Velocity> {
    let rapidity = prop_oneof![
        Just(0.0),
        Just(5e-324),
        Just(MAX_RAPIDITY),
        (-320.0..2.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        0.0..MAX_RAPIDITY,
    ];
    (rapidity, nasty_vector()).prop_filter_map("no direction", |(rapidity, direction)| {
        Velocity::from_rapidity(rapidity, direction).ok()
    })
}

proptest! {
    #![proptest_config(cases(3000))]

    /// Of any finite input: infinite where `f64` ends, never NaN, and ratios always finite.
    #[test]
    fn the_map_never_gives_nan(
        velocity in nasty_velocity(),
        offset in nasty_vector(),
        normal in nasty_vector(),
    ) {
        let map = PhotosurfaceMap::new(&velocity);
        for place in [map.seen_position(offset), map.rest_offset(offset)] {
            prop_assert!(!place.is_nan(), "{place}");
        }
        prop_assert!(map.emission_time(offset) <= 0.0);
        let doppler = map.doppler_factor(offset);
        prop_assert!(doppler > 0.0 && doppler.is_finite(), "{doppler}");
        prop_assert!(map.jacobian(offset).is_finite());
        prop_assert!(map.stretch_bound(offset, 0.0) >= 1.0);
        for unit in [map.seen_normal(offset, normal), map.seen_tangent(offset, normal)] {
            let vanished = unit == DVec3::ZERO && normal.abs().max_element() < 1e-150;
            prop_assert!(vanished || (unit.length() - 1.0).abs() < 1e-14, "{unit}");
        }
    }

    #[test]
    fn compositions_are_finite_and_undone_by_their_inverse(
        first in nasty_velocity(),
        second in nasty_velocity(),
    ) {
        let whole = Lorentz::boost(first).then(&Lorentz::boost(second));
        let (boost, rotation) = (whole.boost_velocity(), whole.rotation());
        prop_assert!(boost.rapidity() >= 0.0 && boost.stretch().is_finite());
        prop_assert!(boost.rapidity() <= (first.rapidity() + second.rapidity()) * (1.0 + 1e-15));
        let least = (first.rapidity() - second.rapidity()).abs();
        prop_assert!(boost.rapidity() >= least * (1.0 - 1e-15));
        prop_assert!((boost.direction().length() - 1.0).abs() < 1e-15);
        prop_assert!((rotation.length() - 1.0).abs() < 1e-15);
        // The other order differs by a rotation only.
        let other = Lorentz::boost(second).then(&Lorentz::boost(first)).boost_velocity();
        let apart = (other.rapidity() - boost.rapidity()).abs();
        prop_assert!(apart <= 8.0 * f64::EPSILON * boost.rapidity(), "{boost:?} {other:?}");
        // There and back is rest: both rapidities are the same number.
        let rest = Lorentz::boost(first).then(&Lorentz::boost(first.reversed()));
        prop_assert_eq!(rest.boost_velocity().rapidity(), 0.0);
    }

    #[test]
    fn views_are_never_nan(
        velocities in (nasty_velocity(), nasty_velocity()),
        event in nasty_vector(),
        time in nasty_number(),
        vertex in nasty_vector(),
    ) {
        let observer = WorldLine { origin: Event::new(time, event), velocity: velocities.0 };
        let object = WorldLine { origin: Event::default(), velocity: velocities.1 };
        let view = View::new(&observer.moment(0.0), &object);
        prop_assert!(!view.observer_rest().is_nan());
        prop_assert!(!view.seen_position(vertex).is_nan());
        // A place beyond f64 is in no direction.
        if view.observer_rest().abs().max_element() < 1e308 && vertex.abs().max_element() < 1e307 {
            prop_assert!(view.doppler_factor(vertex).is_finite());
        }
    }

    /// Any vector is a velocity, or one clear error; the speed is that of the vector.
    #[test]
    fn any_vector_is_a_velocity_or_an_error(vector in nasty_vector()) {
        match Velocity::from_vector(vector) {
            Ok(velocity) => {
                prop_assert!(velocity.rapidity().is_finite() && velocity.stretch() >= 1.0);
                prop_assert!(vector.length() < 1.0 + f64::EPSILON);
            }
            Err(error) => {
                prop_assert!(matches!(error, VelocityError::Beta(_)), "{error}");
                prop_assert!(vector.abs().max_element() > 0.5);
            }
        }
    }

    #[test]
    fn any_triangle_makes_a_finite_photosurface(
        corners in [nasty_vector(), nasty_vector(), nasty_vector()],
        velocity in nasty_velocity(),
    ) {
        let wanted = SurfaceOptions { precision: Precision::Double, subdivide: false, ..SurfaceOptions::default() };
        let placed = placed(&triangle(corners), DVec3::ZERO, velocity);
        let made = placed.photosurfaces(0, wanted).unwrap().next().expect("one part");
        for position in made.mesh.positions() {
            prop_assert!(!position.is_nan(), "{position}");
        }
        prop_assert!(made.facts.condition >= 1.0 && made.facts.condition.is_finite());
        match export(placed, false) {
            Ok(bytes) => assert_finite(&bytes, "any triangle"),
            Err(error) => prop_assert!(
                matches!(error, WriteError::Range { .. } | WriteError::Overflow { .. } | WriteError::TooSmall { .. }),
                "{error}"
            ),
        }
    }
}
