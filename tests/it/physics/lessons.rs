//! What lessons say of built-in scenes, in the scenes themselves.

use glam::{DQuat, DVec3};
use photosurface::light_cone::View;
use photosurface::scene::BuiltInScene;
use photosurface::{Object, Scene};
use serde_json::{Value, json};

fn scene(name: &str) -> Scene {
    let built_in = BuiltInScene::named(name).expect("a built-in scene");
    Scene::from_json(built_in.json).expect("a scene")
}

/// How the observer sees an object at the step with this proper time.
fn view(scene: &Scene, object: &Object, proper_time: f64) -> View {
    let step = scene.steps().iter().position(|&step| step == proper_time);
    let moment = scene.moment(step.expect("a step")).expect("a moment");
    View::new(&moment, &object.world_line())
}

/// Abeam, the front face of a far cube is cos(53.13 degrees) of its width, the rear face sin(53.13 degrees) of its length wide.
#[test]
fn the_cube_looks_turned_by_the_arc_sine_of_its_speed() {
    let scene = scene("terrell");
    let object = &scene.objects()[0];
    let view = view(&scene, object, 0.0);
    let middle = view.seen_position(DVec3::ZERO);
    assert!(
        (middle - DVec3::new(0.0, 0.0, -12.0)).length() < 1e-12,
        "{middle}"
    );
    // A small cube at the same place, so that neither perspective nor shear matters.
    let across = |from: DVec3, to: DVec3| {
        let [from, to] = [from, to].map(|at| view.seen_position(1e-4 * at));
        (to.x - from.x) / 1e-4
    };
    let front = across(DVec3::new(-1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0));
    let rear = across(DVec3::new(-1.0, 0.0, -1.0), DVec3::new(-1.0, 0.0, 1.0));
    let turned = 0.8_f64.asin();
    assert!((turned.to_degrees() - 53.13).abs() < 0.01);
    assert!((front - 2.0 * turned.cos()).abs() < 1e-3, "{front}");
    assert!((rear.abs() - 2.0 * turned.sin()).abs() < 1e-3, "{rear}");
}

/// Straight ahead lengths along the motion are 6.24 times as long, straight behind 0.16 times.
#[test]
fn the_sphere_ahead_is_stretched_sixfold() {
    let scene = scene("stretched");
    let view = view(&scene, &scene.objects()[0], 0.0);
    let observer = view.observer_rest();
    let stretch = |away: f64| {
        // The observer moves along -x.
        let seen = [away, away + 1e-3].map(|x| view.seen_position(observer + DVec3::NEG_X * x).x);
        ((seen[1] - seen[0]) / 1e-3).abs()
    };
    assert!((stretch(50.0) - 6.245).abs() < 1e-3, "{}", stretch(50.0));
    assert!((stretch(-50.0) - 0.160).abs() < 1e-3, "{}", stretch(-50.0));
}

/// ((x - gamma d) / (gamma beta))^2 - rho^2 = d^2, with x ahead, which is +y.
#[test]
fn the_plane_is_a_hyperboloid() {
    let scene = scene("plane");
    let (beta, gamma) = (0.95_f64, 1.0 / (1.0 - 0.95_f64 * 0.95).sqrt());
    for &proper_time in scene.steps() {
        let view = view(&scene, &scene.objects()[0], proper_time);
        // The plane is at y = 0 in its rest frame.
        let d = -view.observer_rest().y;
        for place in [
            DVec3::ZERO,
            DVec3::new(8.0, 0.0, 8.0),
            DVec3::new(-3.0, 0.0, 5.0),
        ] {
            let seen = view.seen_position(place);
            let left =
                ((seen.y - gamma * d) / (gamma * beta)).powi(2) - seen.x * seen.x - seen.z * seen.z;
            assert!(
                (left - d * d).abs() < 1e-9 * (1.0 + left.abs()) * 100.0,
                "{proper_time} {place}"
            );
        }
    }
}

#[test]
fn four_cubes_are_seen_abeam_at_once() {
    let scene = scene("speeds");
    let moved = [1.3, 6.0, 10.9, 12.7];
    let angles = [5.7, 30.0, 64.2, 81.9];
    for ((object, moved), angle) in scene.objects().iter().zip(moved).zip(angles) {
        let view = view(&scene, object, 0.0);
        let seen = view.seen_position(DVec3::ZERO);
        assert!(seen.x.abs() < 1e-9, "{}: {seen}", object.name);
        // Where it is now, shortened by nothing but a point.
        let now = view.rest_to_now().transform_point3(DVec3::ZERO);
        assert!((now.x - moved).abs() < 0.1, "{}: {now}", object.name);
        let turned = object.velocity.beta().asin().to_degrees();
        assert!((turned - angle).abs() < 0.06, "{}: {turned}", object.name);
    }
}

/// Far ahead 4.36 times as long, far behind 0.23 times, and 0.44 times when the light of both ends takes equally long.
#[test]
fn a_rod_along_the_motion_is_long_and_then_short() {
    let scene = scene("rod");
    let view = view(&scene, &scene.objects()[0], 0.0);
    let observer = view.observer_rest();
    let length = |middle: f64, offset: DVec3| {
        let ends =
            [-2.0, 2.0].map(|x| view.seen_position(observer + offset + DVec3::X * (middle + x)));
        ends[0].distance(ends[1]) / 4.0
    };
    assert!((length(-1e6, DVec3::ZERO) - 4.359).abs() < 1e-3);
    assert!((length(1e6, DVec3::ZERO) - 0.229).abs() < 1e-3);
    // Both ends at the same distance in the observer's frame: the middle abeam there.
    let offset = DVec3::new(0.0, -2.5, -8.0);
    let ahead = |middle: f64| {
        let ends =
            [-2.0, 2.0].map(|x| view.seen_position(observer + offset + DVec3::X * (middle + x)));
        ends[0].length() - ends[1].length()
    };
    let (mut low, mut high) = (-100.0, 100.0);
    assert!(ahead(low) > 0.0 && ahead(high) < 0.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if ahead(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    assert!(
        (length(low, offset) - 0.436).abs() < 1e-3,
        "{}",
        length(low, offset)
    );
    // Across the motion: x = gamma (d + beta r) ahead, which is -x.
    let across = &scene.objects()[1];
    let rod = super::lessons::view(&scene, across, 8.0);
    let (beta, gamma) = (0.9_f64, 1.0 / (1.0 - 0.81_f64).sqrt());
    for y in [-4.0, 0.0, 4.0] {
        let place = DVec3::new(0.0, y, 0.0);
        let offset = place - rod.observer_rest();
        let expected = gamma * (-offset.x + beta * offset.length());
        let seen = -rod.seen_position(place).x;
        assert!(
            (seen - expected).abs() < 1e-9 * (1.0 + expected.abs()),
            "{y}: {seen} {expected}"
        );
    }
}

/// The view of the scene `flight`, at rest in its frame, from a place on the line of the flight at this speed towards -z.
///
/// Points are relative to the middle of the ground, as [`GROUND`] is.
fn view_in_flight(z: f64, beta: f64) -> View {
    let built_in = BuiltInScene::named("flight").expect("a built-in scene");
    let mut scene: Value = serde_json::from_str(built_in.json).expect("JSON");
    let velocity = json!({ "beta": beta, "direction": [0, 0, -1] });
    scene["observer"] = json!({ "position": [0, 2, z], "velocity": velocity });
    scene["steps"] = json!([0]);
    let scene = Scene::from_json(&scene.to_string()).expect("a scene");
    let ground = &scene.objects()[0];
    assert_eq!(ground.name, "ground");
    view(&scene, ground, 0.0)
}

/// Where the ground of the scene `flight` is.
const GROUND: DVec3 = DVec3::new(0.0, 0.0, -14.0);

/// The angle between a place in the observer's frame and straight ahead, in degrees.
fn angle_from_ahead(place: DVec3) -> f64 {
    place.angle_between(DVec3::NEG_Z).to_degrees()
}

#[test]
fn the_ring_recedes_and_then_comes_from_behind() {
    // Its middle, after four seconds of thrust.
    let middle = DVec3::new(0.0, 3.0, -10.0) - GROUND;
    let [at_rest, in_flight] =
        [0.0, 0.923].map(|beta| view_in_flight(-3.6, beta).seen_position(middle).length());
    assert!((at_rest - 6.5).abs() < 0.05, "{at_rest}");
    assert!((in_flight - 32.0).abs() < 0.5, "{in_flight}");
    // Its top, 5.5 units behind.
    let top = DVec3::new(0.0, 6.0, -10.0) - GROUND;
    let [at_rest, in_flight] =
        [0.0, 0.997].map(|beta| angle_from_ahead(view_in_flight(-15.5, beta).seen_position(top)));
    assert!((at_rest - 144.0).abs() < 0.5, "{at_rest}");
    assert!((in_flight - 14.0).abs() < 0.5, "{in_flight}");
    let half_tangent = |degrees: f64| (degrees.to_radians() / 2.0).tan();
    let stretch = ((1.0 + 0.997_f64) / (1.0 - 0.997)).sqrt();
    let ratio = half_tangent(at_rest) / half_tangent(in_flight);
    assert!((ratio / stretch - 1.0).abs() < 1e-9, "{ratio} {stretch}");
}

#[test]
fn the_sphere_in_flight_is_a_circle_and_a_cigar() {
    let view = view_in_flight(0.0, 0.95);
    let (middle, radius) = (DVec3::new(5.0, 1.5, -6.0) - GROUND, 1.5);
    let offset = middle - view.observer_rest();
    let (towards, sine) = (offset.normalize(), radius / offset.length());
    let side = towards.any_orthonormal_vector();
    // The outline: where lines from the observer touch the sphere.
    let outline: Vec<DVec3> = (0..360)
        .map(|degrees| {
            let turn = DQuat::from_axis_angle(towards, f64::from(degrees).to_radians());
            let from_middle = turn * side * (1.0 - sine * sine).sqrt() - towards * sine;
            let point = middle + radius * from_middle;
            view.seen_position(point).normalize()
        })
        .collect();
    // The axis of the cone through the outline, from three of its lines.
    let axis = (outline[120] - outline[0])
        .cross(outline[240] - outline[0])
        .normalize();
    for line in &outline {
        let angle = line.dot(axis).abs().acos().to_degrees();
        assert!((angle - 2.0).abs() < 0.005, "{angle}");
    }
    let seen: Vec<DVec3> = (0..=20_000)
        .map(|number| {
            // Points on a spiral, even on the sphere.
            let height = 1.0 - f64::from(number) / 10_000.0;
            let around = DQuat::from_rotation_y(2.399_963 * f64::from(number)) * DVec3::X;
            let level = (1.0 - height * height).max(0.0).sqrt();
            view.seen_position(middle + radius * (level * around + height * DVec3::Y))
        })
        .collect();
    let most = seen.iter().copied().reduce(DVec3::max).expect("points");
    let least = seen.iter().copied().reduce(DVec3::min).expect("points");
    let [thick, _, long] = (most - least).to_array();
    assert!((long - 17.6).abs() < 0.05, "{long}");
    assert!((thick - 3.0).abs() < 0.02, "{thick}");
}
