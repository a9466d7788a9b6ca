//! Several moving objects and a moving observer, against their worldlines in the scene frame.

use crate::common::oracle::{self, Oracle, big_vector, small};
use crate::common::{RELATIVE, Random, TURN, Worst, composition_swings, normal_limit};
use photosurface::light_cone::View;
use photosurface::spacetime::{Event, WorldLine};
use photosurface::{DVec3, Velocity};

/// Two objects and an observer, all in motion in different directions, at several moments of the
/// observer's clock: what the library makes of it in the objects' rest frames against the worldlines
/// in the scene frame.
///
/// Four things are uncertain: the relative velocity and the rotation (limits as above); the
/// observer's place in the rest frame, to `exp(eta)` of the object times the roundings of the event,
/// magnified by the map's derivative, at most `exp(eta) + 1` of the relative rapidity; and the map's own
/// roundings.
#[test]
fn moving_objects_are_seen_where_their_worldlines_meet_the_light_cone() {
    let mut positions = Worst::new("moving objects: position");
    let mut dopplers = Worst::new("moving objects: Doppler factor");
    let mut normals = Worst::new("moving objects: normal");
    let along = |rapidity, direction| Velocity::from_rapidity(rapidity, direction).expect("valid");
    let tilted = DVec3::new(0.3, -0.5, 0.6);
    let observers = [
        along(0.0, DVec3::X),
        along(1.2, DVec3::new(-1.0, 0.2, 0.1)),
        along(6.0, tilted),
        along(15.0, DVec3::Z),
    ];
    let objects = [
        (DVec3::new(0.0, 3.0, -1.0), along(0.7, DVec3::Y)),
        (
            DVec3::new(-4.0, 0.5, 2.0),
            along(3.0, DVec3::new(1.0, 1.0, -0.2)),
        ),
        (DVec3::new(2.0, -2.0, 1.0), along(8.0, -tilted)),
        (DVec3::new(1.0, 1.0, -5.0), along(15.0, DVec3::NEG_Z)),
    ];
    let mut random = Random::new(7);
    for observer_velocity in observers {
        let flight = WorldLine {
            origin: Event::new(0.5, DVec3::new(1.0, -0.25, 0.125)),
            velocity: observer_velocity,
        };
        for (object_position, object_velocity) in objects {
            for proper_time in [-3.0, 0.0, 2.5] {
                let event = flight.at(proper_time);
                let from_origin = event - Event::new(0.0, object_position);
                let object = WorldLine {
                    origin: Event::new(0.0, object_position),
                    velocity: object_velocity,
                };
                let observer = WorldLine {
                    origin: event,
                    velocity: observer_velocity,
                };
                let view = View::new(&observer.moment(0.0), &object);
                let oracle =
                    Oracle::new(object_position, &object_velocity, event, &observer_velocity);

                let relative = view.relative_velocity();
                let (swing, rotation_swing) =
                    composition_swings(&object_velocity, &observer_velocity);
                let half = 0.5 * relative.rapidity();
                let turned = RELATIVE + 2.0 * TURN * rotation_swing / half.cosh();
                let rapidity_error =
                    RELATIVE * relative.rapidity() + 2.0 * TURN * swing / half.cosh();
                let direction_error = turned + TURN * swing / half.sinh();
                let place_error = (RELATIVE + TURN)
                    * object_velocity.rapidity().exp()
                    * (from_origin.time.abs() + from_origin.position.length());

                for _ in 0..10 {
                    let vertex = random.direction() * random.between(0.1, 2.0);
                    let normal_rest = random.direction();
                    let offset = vertex - view.observer_rest();
                    let case = || {
                        format!(
                            "object {object_velocity:?} at {object_position}, vertex {vertex}, \
                             observer {observer_velocity:?} at {event:?}"
                        )
                    };

                    let seen = oracle.see(&big_vector(vertex)).position();
                    let size = small(&oracle::length(&seen));
                    let (r, doppler) = (offset.length(), view.doppler_factor(vertex));
                    let sine = relative.direction().cross(offset).length() / r;
                    let gamma_beta = relative.gamma_beta();
                    let angle_error = direction_error + TURN + place_error / r;
                    let limit = (RELATIVE + turned + rapidity_error + direction_error) * size
                        + angle_error * r * (1.0 + relative.gamma() * sine)
                        + place_error * doppler;
                    let error = oracle::vector_error(view.seen_position(vertex), &seen);
                    positions.record(error, limit, size, case);

                    let exact = oracle.doppler_factor(&big_vector(vertex));
                    let limit =
                        (RELATIVE + rapidity_error) * doppler + angle_error * gamma_beta * sine;
                    let size = small(&exact);
                    dopplers.record(oracle::error(doppler, &exact), limit, size, case);

                    // As for one object, with more in the angles and in the rapidity.
                    let limit = turned
                        + normal_limit(
                            &relative,
                            offset,
                            normal_rest,
                            RELATIVE + rapidity_error,
                            angle_error,
                        );
                    let exact = oracle.normal(&big_vector(vertex), normal_rest);
                    let normal = view.seen_normal(vertex, normal_rest);
                    let error = oracle::vector_error(normal, &exact);
                    normals.record(error, limit, 1.0, case);
                }
            }
        }
    }
    positions.check();
    dopplers.check();
    normals.check();
}

/// An observer who flies beside a fast object moves little in the object's rest frame, far in the scene:
/// a view, which carries the worldline into the rest frame, keeps the digits that events of the scene
/// have not got.
///
/// The place is `tau gamma beta n` of the relative velocity. An error of `v` (see
/// `composition_swings`) counts `2 cosh(eta / 2)` times in `gamma beta n`, one of the rotation once.
#[test]
fn an_observer_beside_a_fast_object_keeps_its_place() {
    let mut carried = Worst::new("observer's place by a worldline in the rest frame");
    let mut random = Random::new(8);
    for rapidity in [3.0f64, 7.0, 15.0] {
        for proper_time in [-2.5, 1000.0] {
            let direction = random.direction();
            let nearly = direction + random.direction() * (-rapidity).exp();
            let object = Velocity::from_rapidity(rapidity, direction).expect("valid");
            let observer = Velocity::from_rapidity(rapidity + 0.1, nearly).expect("valid");

            // The flow of the observer's clock, through the scene into the rest frame.
            let zero = || oracle::big(0.0);
            let clock = [oracle::big(proper_time), zero(), zero(), zero()];
            let in_scene = oracle::apply(&oracle::boost(&observer.reversed()), &clock);
            let [_, x, y, z] = oracle::apply(&oracle::boost(&object), &in_scene);
            let exact = [x, y, z];
            let size = small(&oracle::length(&exact));

            let from_origin = |velocity| WorldLine {
                origin: Event::default(),
                velocity,
            };
            let view = View::new(
                &from_origin(observer).moment(proper_time),
                &from_origin(object),
            );
            let relative = view.relative_velocity();
            let error = oracle::vector_error(view.observer_rest(), &exact);
            let (swing, rotation_swing) = composition_swings(&object, &observer);
            let half = 0.5 * relative.rapidity();
            let limit = RELATIVE * (1.0 + relative.rapidity()) * size
                + proper_time.abs() * TURN * 2.0 * half.cosh() * swing
                + size * TURN * rotation_swing / half.cosh();
            let case = || format!("{object:?}, {observer:?}, {proper_time}");
            carried.record(error, limit, size, case);
        }
    }
    carried.check();
}
