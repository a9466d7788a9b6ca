//! What an observer sees along a flight: against closed forms, and against the brute-force solver in the scene frame.

use photosurface::light_cone::View;
use photosurface::scene::{BuiltInScene, Rotation};
use photosurface::spacetime::{Event, Flight, Integrator, Lorentz, Segment, WorldLine};
use photosurface::tessellate::Precision;
use photosurface::{
    DQuat, DVec3, Moment, PlacedScene, Scene, Shape, Source, SurfaceOptions, Tolerance, Velocity,
    load_models,
};

use super::exact::{Big, State, all_states, big, random_flight, small, states_until};
use crate::common::curve::{pieces, to_piece};
use crate::common::refining::{Sighted, Sighting};
use crate::common::{Random, Worst};

fn thrust_along_x(acceleration: f64) -> Flight {
    let segment = Segment::free(100.0, DVec3::X * acceleration, DVec3::ZERO).expect("finite");
    let start = Moment::new(Event::default(), Lorentz::IDENTITY);
    Flight::new(start, vec![segment], Integrator::Exact).expect("possible")
}

fn at_rest() -> WorldLine {
    WorldLine {
        origin: Event::default(),
        velocity: Velocity::ZERO,
    }
}

/// A point ahead recedes first, as far as `x0 (1 + a x0 / 2)`, then comes, and is passed.
#[test]
fn what_is_ahead_of_a_rocket_recedes_first() {
    let a = 0.5;
    let flight = thrust_along_x(a);
    for (x0, farthest_at, farthest, passed_at) in [
        (2.0, 1.38629436111989, 3.0, 2.633915793849633),
        (5.0, 2.50552593699074, 11.25, 3.849694600476828),
    ] {
        let seen = |proper_time: f64| {
            let view = View::new(&flight.moment(proper_time), &at_rest());
            view.seen_position(DVec3::X * x0).x
        };
        assert!((seen(farthest_at) - farthest).abs() < 1e-13);
        for aside in [-0.01, 0.01] {
            assert!(seen(farthest_at + aside) < farthest);
        }
        assert!(seen(passed_at).abs() < 1e-12, "{}", seen(passed_at));
        assert!(seen(passed_at + 0.1) < 0.0 && seen(passed_at - 0.1) > 0.0);
    }
}

/// As time goes on every point at rest is seen to freeze on the paraboloid of the Rindler horizon, whose focus is the
/// observer.
#[test]
fn a_grid_at_rest_freezes_on_the_paraboloid_of_the_horizon() {
    let a = 0.5;
    let flight = thrust_along_x(a);
    let on_paraboloid = |rho: f64| (a * a * rho * rho - 1.0) / (2.0 * a);
    for proper_time in [20.0, 40.0, 100.0] {
        // What is left to go fades as the light does, by `exp(-a tau)`.
        let limit = |point: DVec3| {
            let size = 1.0 + point.length_squared();
            (8.0 * f64::exp(-a * proper_time) + 16.0 * f64::EPSILON) * size
        };
        let view = View::new(&flight.moment(proper_time), &at_rest());
        for x in [-3.0, -1.0, 0.0, 1.0, 4.0] {
            for (y, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (4.0, 0.0), (-2.0, 3.0)] {
                let point = DVec3::new(x, y, z);
                let seen = view.seen_position(point);
                let rho = point.y.hypot(point.z);
                let expected = DVec3::new(on_paraboloid(rho), y, z);
                let error = seen.distance(expected);
                assert!(
                    error < limit(point),
                    "{proper_time} {point}: {seen} {expected}"
                );
            }
        }
        // The starting point itself.
        let gone = (1.0 - f64::exp(-a * proper_time)).powi(2) / (2.0 * a);
        let start = view.seen_position(DVec3::ZERO);
        assert!((start.x + gone).abs() < 4e-15 * gone.max(1.0), "{start}");
    }
    let view = View::new(&flight.moment(80.0), &at_rest());
    assert!((view.seen_position(DVec3::new(3.0, 1.0, 0.0)).x + 0.75).abs() < 1e-12);
    assert!((view.seen_position(DVec3::new(-1.0, 4.0, 0.0)).x - 3.0).abs() < 1e-12);
}

/// Where an observer with the exact place and axes of `state` sees a point whose worldline is `start + clock step` in the
/// scene frame: a quadratic equation for the clock, solved in the scene frame; products with the axes.
fn brute_force(state: &State, start: &[Big; 4], step: &[Big; 4]) -> DVec3 {
    let product = |a: &[Big; 4], b: &[Big; 4]| {
        (1..4).fold(-(a[0].clone() * &b[0]), |sum, i| sum + a[i].clone() * &b[i])
    };
    let now = state.column(4);
    let back: [Big; 4] = std::array::from_fn(|i| start[i].clone() - &now[i]);
    let (a, b, c) = (
        product(step, step),
        product(step, &back),
        product(&back, &back),
    );
    let root = (b.clone() * &b - a.clone() * c).sqrt();
    let clock = (root - b) / a;
    let flight: [Big; 4] = std::array::from_fn(|i| back[i].clone() + clock.clone() * &step[i]);
    let miss = small(&product(&flight, &flight)).abs();
    assert!(
        small(&flight[0]) <= 0.0 && miss < 1e-40,
        "off the light cone by {miss:e}"
    );
    let [_, x, y, z] = state.components(&flight);
    DVec3::new(x, y, z)
}

/// Random flights and random points on moving objects. The limit is that of places of size 20, known to a rounding for
/// each segment and magnified by the boosts to the observer and to the object and by the map, each by at most `exp` of
/// their rapidities.
#[test]
fn random_flights_see_what_the_brute_force_solver_sees() {
    let mut random = Random::new(16);
    let mut worst = Worst::new("flights: seen position");
    for case in 0..100 {
        let count = [1, 3, 20][case % 3];
        let segments = random_flight(&mut random, count, 2.0);
        let velocity = Velocity::from_rapidity(random.between(0.0, 1.5), random.direction())
            .expect("slow enough");
        let turn = DQuat::from_axis_angle(random.direction(), random.between(-3.0, 3.0));
        let rotation = Rotation::new(turn).expect("a unit quaternion");
        let start = Moment::new(Event::default(), Lorentz::boost(velocity)).turned(rotation);
        let flight = Flight::new(start, segments.clone(), Integrator::Exact).expect("possible");
        let proper_time = flight.proper_time() * random.between(0.2, 1.0);
        let all = all_states(State::new(velocity, rotation.get()), &segments);
        let states = states_until(&all, &segments, proper_time);
        let state = states.last().expect("the start");

        let object = WorldLine {
            origin: Event::new(0.0, random.direction() * random.between(0.0, 5.0)),
            velocity: Velocity::from_rapidity(random.between(0.0, 1.0), random.direction())
                .expect("slow enough"),
        };
        let moment = flight.moment(proper_time);
        let view = View::new(&moment, &object);
        let frame = State::new(object.velocity, DQuat::IDENTITY);
        let angle: f64 = segments
            .iter()
            .map(|segment| match segment.steering() {
                photosurface::spacetime::Steering::Free { turn_rate } => {
                    turn_rate.length() * segment.proper_time()
                }
                photosurface::spacetime::Steering::Coordinated => 0.0,
            })
            .sum();
        for _ in 0..10 {
            let point = random.direction() * random.between(0.0, 5.0);
            let [_, axes @ ..] = [0, 1, 2, 3].map(|k| frame.column(k));
            let place = [
                0.0,
                object.origin.position.x,
                object.origin.position.y,
                object.origin.position.z,
            ];
            let worldline: [Big; 4] = std::array::from_fn(|i| {
                let offset = (0..3).fold(big(0.0), |sum, k| {
                    sum + axes[k][i].clone() * big(point.to_array()[k])
                });
                big(place[i]) + offset
            });
            let expected = brute_force(state, &worldline, &frame.column(0));
            let seen = view.seen_position(point);
            let relative = view.relative_velocity().rapidity();
            let rapidities = moment.velocity().rapidity() + object.velocity.rapidity() + relative;
            let size = 20.0 + moment.event().position.length() + proper_time;
            let limit = (count as f64 + 4.0 + angle) * size * rapidities.exp() * f64::EPSILON;
            worst.record(seen.distance(expected), limit, seen.length(), || {
                format!("case {case}: {seen} {expected}")
            });
        }
    }
    worst.check();
}

fn placed(name: &str, steps: Vec<f64>) -> PlacedScene {
    let built_in = BuiltInScene::named(name).expect("a built-in scene");
    let scene = Scene::from_json(built_in.json).expect("valid");
    let scene = scene.with_steps(steps).expect("finite");
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes alone");
    PlacedScene::new(scene, models).expect("a model for each")
}

fn is_round(shape: &Shape) -> bool {
    !matches!(shape, Shape::Cuboid(_) | Shape::Grid(_) | Shape::Lattice(_))
}

/// Certificates of the built-in flights, against the definition at random places of every triangle.
#[test]
fn certificates_hold_along_flights() {
    let mut random = Random::new(17);
    let wanted = SurfaceOptions {
        precision: Precision::Double,
        ..SurfaceOptions::default()
    };
    for (name, steps) in [
        ("flight", vec![-1.0, 0.7, 2.1, 3.7, 5.0]),
        ("takeoff", vec![0.3, 2.6, 9.0]),
        ("turn", vec![3.5, 5.5, 8.0]),
        ("orbit", vec![4.0, 21.0]),
    ] {
        let count = steps.len();
        let placed = placed(name, steps);
        let tolerance = placed.scene().tolerance(&placed.scene().objects()[0]);
        let mut gaps = 0;
        for step in 0..count {
            for surface in placed.photosurfaces(step, wanted).expect("a step") {
                let facts = &surface.facts;
                assert!(facts.certificate.complete, "{name} {step} {}", facts.name);
                let objects = placed.scene().objects();
                let object = objects.iter().find(|object| object.name == facts.object);
                let object = object.expect("its object");
                let view = placed.view(object, step).expect("a step");
                let sighting = Sighting {
                    observer: view.observer_rest(),
                    velocity: view.relative_velocity(),
                    tolerance,
                    wanted,
                };
                let back = view.rotation().inverse();
                let seen = surface
                    .mesh
                    .clone()
                    .transformed(&photosurface::DAffine3::from_quat(back));
                let map = photosurface::light_cone::PhotosurfaceMap::new(&sighting.velocity);
                let rest = seen
                    .positions()
                    .iter()
                    .map(|&seen| map.rest_offset(seen) + sighting.observer);
                let sighted = Sighted {
                    certificate: facts.certificate.clone(),
                    rest: rest.collect(),
                    seen,
                };
                let largest = match &object.source {
                    // An exact surface is held against its curve.
                    Source::Shape(shape, _)
                        if is_round(shape) && facts.certificate.curvature == 0.0 =>
                    {
                        let to_rest = object.model_to_rest();
                        let from_rest = to_rest.inverse();
                        let seen = |piece, place: DVec3| {
                            let place = to_piece(shape, piece, from_rest.transform_point3(place));
                            sighting.seen(to_rest.transform_point3(place))
                        };
                        sighting.assert_near_curve(&sighted, 2, pieces(shape), seen, &mut random)
                    }
                    _ => sighting.assert_contained(&sighted, 2, &mut random),
                };
                gaps += usize::from(largest > 0.1 * facts.certificate.gap);
            }
        }
        assert!(gaps > 0, "{name}: bounds far from every gap");
    }
}

/// A flight without segments, and axes that are not turned, leave every byte as it was.
#[test]
fn coasting_is_uniform_motion() {
    let plain = r#"{ "observer": { "velocity": { "beta": 0.9, "direction": [1, 2, 3] }, "time": 0.3, "position": [1, 2, 3] },
        "objects": [{ "name": "cube", "shape": { "box": { "size": [1, 2, 3] } }, "velocity": [0, 0.5, 0] }],
        "steps": [-1, 0, 2.5] }"#;
    let coasting = plain.replace(
        r#""time": 0.3"#,
        r#""flight": [], "orientation": [0, 0, 0, 1], "integrator": "exact", "time": 0.3"#,
    );
    let scene = Scene::from_json(plain).expect("valid");
    assert_eq!(Scene::from_json(&coasting).expect("valid"), scene);
    let line = WorldLine {
        origin: Event::new(0.3, DVec3::new(1.0, 2.0, 3.0)),
        velocity: scene.observer().velocity,
    };
    // A segment without thrust is coasting too, but for a rounding of its beginning.
    let segment = Segment::free(2.0, DVec3::ZERO, DVec3::ZERO).expect("finite");
    let drift = Flight::new(line.moment(0.0), vec![segment], Integrator::Exact).expect("possible");
    for (step, proper_time) in [-1.0, 0.0, 2.5].into_iter().enumerate() {
        assert_eq!(
            scene.moment(step).expect("a step"),
            line.moment(proper_time)
        );
        let (a, b) = (
            drift.moment(proper_time).event(),
            line.moment(proper_time).event(),
        );
        assert!((a - b).position.length() < 1e-14 && (a.time - b.time).abs() < 1e-14);
    }
    assert_eq!(scene.tolerance(&scene.objects()[0]), Tolerance::default());
}
