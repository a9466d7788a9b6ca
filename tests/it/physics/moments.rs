//! An observer's own axes and its way to a moment: against the pure boost, and the brute force of the oracle.

use photosurface::light_cone::View;
use photosurface::render::{
    Camera, Picture, PictureOptions, PictureSize, Projection, Scenery, Viewpoint,
};
use photosurface::scene::Rotation;
use photosurface::shape::Color;
use photosurface::spacetime::{Event, Lorentz, WorldLine};
use photosurface::{
    DAffine3, DMat3, DQuat, DVec3, Moment, PlacedScene, Scene, SurfaceOptions, Tolerance, Velocity,
    load_models,
};
use serde_json::json;

use crate::common::oracle::{self, Oracle, big_vector, small};
use crate::common::{Random, Worst};

/// Roundings of a rotation: of its quaternion, of its matrix and of the product.
const ROTATION: f64 = 8.0 * f64::EPSILON;

fn rapidity(rapidity: f64, direction: DVec3) -> Velocity {
    Velocity::from_rapidity(rapidity, direction).expect("not too fast")
}

fn rotation(turn: DQuat) -> Rotation {
    Rotation::new(turn).expect("a unit quaternion")
}

fn turns() -> [DQuat; 4] {
    [
        DQuat::IDENTITY,
        DQuat::from_rotation_y(0.5),
        DQuat::from_axis_angle(DVec3::new(0.6, 0.0, -0.8), 2.5),
        DQuat::from_axis_angle(DVec3::new(-2.0, 3.0, 6.0) / 7.0, std::f64::consts::PI),
    ]
}

/// Turned axes turn the photosurface of the pure boost, positions, normals and tangents, and nothing else.
#[test]
fn turned_axes_see_the_photosurface_turned() {
    let mut random = Random::new(21);
    for (fast, slow) in [
        (0.0, 0.0),
        (0.5, 0.0),
        (3.0, 1.0),
        (15.0, 15.0),
        (100.0, 2.0),
    ] {
        let observer = WorldLine {
            origin: Event::new(0.5, DVec3::new(1.0, -0.25, 0.125)),
            velocity: rapidity(fast, random.direction()),
        };
        let object = WorldLine {
            origin: Event::new(0.0, DVec3::new(-4.0, 0.5, 2.0)),
            velocity: rapidity(slow, random.direction()),
        };
        let boosted = observer.moment(1.5);
        let plain = View::new(&boosted, &object);
        for turn in turns() {
            let view = View::new(&boosted.turned(rotation(turn)), &object);
            assert_eq!(view.observer_rest(), plain.observer_rest());
            assert_eq!(view.relative_velocity(), plain.relative_velocity());
            let back = DMat3::from_quat(turn).transpose();
            let rest: Vec<DVec3> = (0..50)
                .map(|_| random.direction() * random.between(0.1, 9.0))
                .collect();
            let mut seen = vec![DVec3::ZERO; rest.len()];
            view.seen_positions(&rest, &mut seen);
            for (&vertex, &seen) in rest.iter().zip(&seen) {
                let (normal, case) = (random.direction(), format!("{fast} {slow} {turn} {vertex}"));
                assert_eq!(seen, view.seen_position(vertex), "{case}");
                assert_eq!(
                    view.doppler_factor(vertex),
                    plain.doppler_factor(vertex),
                    "{case}"
                );
                for (found, expected, size) in [
                    (seen, plain.seen_position(vertex), seen.length()),
                    (
                        view.seen_normal(vertex, normal),
                        plain.seen_normal(vertex, normal),
                        1.0,
                    ),
                    (
                        view.seen_tangent(vertex, normal),
                        plain.seen_tangent(vertex, normal),
                        1.0,
                    ),
                ] {
                    let error = found.distance(back * expected);
                    assert!(error <= ROTATION * size, "{case}: {error:e}");
                }
            }
            // Where things are now is turned alike.
            let (now, plain_now) = (view.rest_to_now(), plain.rest_to_now());
            let place = now.transform_point3(DVec3::ONE);
            let expected = back * plain_now.transform_point3(DVec3::ONE);
            let size = plain.observer_rest().length() + 2.0;
            assert!(
                place.distance(expected) <= 2.0 * ROTATION * size,
                "{fast} {slow} {turn}"
            );
        }
    }
}

/// The oracle turns its 4x4 matrix; it knows neither moments nor Wigner rotations.
///
/// The limit is that of a few roundings of coordinates of at most 20, each magnified by boosts and the map, at these
/// rapidities by less than `exp(1 + 2 + 3)`.
#[test]
fn turned_observers_see_what_the_oracle_sees() {
    let mut positions = Worst::new("turned axes: position");
    let mut normals = Worst::new("turned axes: normal");
    let mut random = Random::new(22);
    let limit = 20.0 * 6f64.exp() * 16.0 * f64::EPSILON;
    for turn in turns() {
        let event = Event::new(0.5, random.direction());
        let (place, by) = (random.direction(), rapidity(1.0, random.direction()));
        let own = rapidity(2.0, random.direction());
        let object = WorldLine {
            origin: Event::new(0.0, place),
            velocity: by,
        };
        let view = View::new(
            &Moment::new(event, Lorentz::boost(own)).turned(rotation(turn)),
            &object,
        );
        let oracle = Oracle::new(place, &by, event, &own).turned(turn);
        for _ in 0..20 {
            let (vertex, normal) = (
                random.direction() * random.between(0.5, 3.0),
                random.direction(),
            );
            let case = || format!("{turn} {vertex} {normal}");
            let exact = oracle.see(&big_vector(vertex)).position();
            let size = small(&oracle::length(&exact));
            positions.record(
                oracle::vector_error(view.seen_position(vertex), &exact),
                limit,
                size,
                case,
            );
            let exact = oracle.normal(&big_vector(vertex), normal);
            // A normal swings with the ratio of the largest stretch to the smallest, too.
            let error = oracle::vector_error(view.seen_normal(vertex, normal), &exact);
            normals.record(error, limit * 3f64.exp(), 1.0, case);
        }
    }
    positions.check();
    normals.check();
}

/// Thrust for a while: the view after the way by legs is that of the event and the velocity written out in the scene.
#[test]
fn a_way_by_legs_leads_to_the_event_and_the_velocity() {
    let (start, proper_time) = (Event::new(0.25, DVec3::new(1.0, 2.0, -3.0)), 1.25f64);
    let thrust = Event::new(proper_time.sinh(), DVec3::X * (proper_time.cosh() - 1.0));
    let boost = rapidity(proper_time, DVec3::X);
    let flown = Moment::new(start, Lorentz::IDENTITY).flown(thrust, &Lorentz::boost(boost));
    let coasted = flown.coasted(2.0);
    let event =
        start + thrust + Event::new(2.0 * boost.gamma(), DVec3::X * (2.0 * boost.gamma_beta()));
    let direct = Moment::new(event, Lorentz::boost(boost));
    assert_eq!(coasted.velocity(), direct.velocity());
    for velocity in [
        Velocity::ZERO,
        rapidity(1.0, DVec3::Y),
        rapidity(1.2, DVec3::X),
    ] {
        let object = WorldLine {
            origin: Event::new(0.0, DVec3::Y),
            velocity,
        };
        let (by_legs, at_once) = (View::new(&coasted, &object), View::new(&direct, &object));
        for vertex in [DVec3::ZERO, DVec3::ONE, DVec3::new(-3.0, 0.5, 2.0)] {
            let (found, expected) = (by_legs.seen_position(vertex), at_once.seen_position(vertex));
            assert!(
                found.distance(expected) < 1e-13 * (1.0 + expected.length()),
                "{velocity:?} {vertex}"
            );
        }
    }
}

/// Rays of an observer with turned axes meet what the photosurface of the pure boost, turned, shows there.
///
/// Pixels may differ where a ray passes an edge within what the mesh may be off, a hundredth of a degree, a tenth of a
/// pixel: of at most 400 pixels along outlines one in ten.
#[test]
fn rays_agree_with_the_turned_photosurface() {
    let scene = json!({
        "observer": { "velocity": { "beta": 0.5, "direction": [0, 1, -1] } },
        "objects": [
            { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "color": "#ff0000",
              "position": [8.406, 0.2, -9], "velocity": { "beta": 0.9, "direction": [1, 0, 0] } },
            { "name": "cube", "shape": { "box": { "size": [1.5, 1.5, 1.5] } }, "color": "#00ff00",
              "position": [-4.366, -0.3, -5.287], "velocity": { "beta": 0.6, "direction": [-1, 0, 0.2] } },
        ],
    });
    let scene = Scene::from_json(&scene.to_string()).expect("a valid scene");
    let scene = scene.with_tolerance_for_all(Tolerance::degrees(0.01).expect("a fair angle"));
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes");
    let placed = PlacedScene::new(scene, models).expect("one model an object");
    let look = DVec3::new(0.0, 0.31, -0.95);
    let mut at_rest = Scenery::new();
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            at_rest.add_at_rest(object, part);
        }
    }
    for turn in turns() {
        let moment = placed.scene().moment(0).unwrap().turned(rotation(turn));
        let back = DAffine3::from_quat(turn.inverse());
        let mut turned = Scenery::new();
        for (surface, object) in placed
            .photosurfaces(0, SurfaceOptions::default())
            .expect("the first step")
            .zip(placed.scene().objects())
        {
            turned.add_photosurface(
                object,
                &moment,
                &surface.mesh.transformed(&back),
                surface.material.as_ref(),
            );
        }
        let size = PictureSize::new(120, 90).expect("a fair size");
        let projection = Projection::Perspective {
            vertical_fov_deg: 24.0,
        };
        let camera =
            Camera::new(size, projection, back.transform_vector3(look)).expect("a fair camera");
        let options = PictureOptions {
            samples: 1,
            background: Color([0; 3]),
            wireframe: None,
        };
        let take =
            |scenery: &Scenery| scenery.picture(&camera, Viewpoint::Observer(&moment), options);
        let (by_rays, by_mesh) = (take(&at_rest), take(&turned));
        let levels = |picture: &Picture| picture.bytes().to_vec();
        let (a, b) = (levels(&by_rays), levels(&by_mesh));
        let pixels = a.chunks(3).zip(b.chunks(3));
        let shown = pixels
            .clone()
            .filter(|(a, _)| a.iter().any(|&level| level > 0))
            .count();
        let differ = pixels
            .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 4))
            .count();
        assert!(shown > 500, "{turn}: {shown}");
        assert!(differ <= 40, "{turn}: {differ} of {shown}");
    }
}
