//! The Minkowski diagram as numbers: light, worldlines and momentary axes are where relativity has them.

use photosurface::jobs::{DiagramError, DiagramPoint, DiagramSettings, WorldlineDiagram};
use photosurface::light_cone::View;
use photosurface::scene::Place;
use photosurface::spacetime::Event;
use photosurface::{DVec3, Scene};

/// The flight of figure 5's kind: faster and faster past a sphere at rest, beside a moving cube.
const FLIGHT: &str = r#"{ "observer": { "velocity": { "beta": 0.95 }, "flight": [
    { "proper_time": 2.1, "acceleration": [0, 0, -0.26085503293665] },
    { "proper_time": 1.6, "acceleration": [0.1, 0.2, -0.32718303025942] } ] },
  "steps": [0, 2.1, 3.7],
  "objects": [
    { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "position": [0, 3, -9] },
    { "name": "cube", "shape": { "box": { "size": [1, 1, 1] } }, "position": [1, 0, 3], "velocity": [0.2, 0.1, -0.7] } ] }"#;

fn scene(json: &str) -> Scene {
    Scene::from_json(json).expect("a scene")
}

fn settings(at: &[f64]) -> DiagramSettings {
    DiagramSettings {
        proper_times: 0.0..=3.7,
        at: at.to_vec(),
        direction: None,
        points: vec![],
    }
}

fn point(object: &str, position: DVec3) -> DiagramPoint {
    DiagramPoint {
        object: object.to_owned(),
        position_rest: Place::new(position).expect("finite"),
    }
}

fn minkowski(a: Event, b: Event) -> f64 {
    a.position.dot(b.position) - a.time * b.time
}

#[test]
fn light_leaves_an_object_on_the_observers_past_light_cone() {
    let scene = scene(FLIGHT);
    let points = vec![
        point("sphere", DVec3::ZERO),
        point("cube", DVec3::ZERO),
        point("cube", DVec3::new(0.5, -0.5, 0.5)),
    ];
    let at = [0.0, 1.3, 2.1, 3.0, 5.0];
    let settings = DiagramSettings {
        points,
        ..settings(&at)
    };
    let diagram = WorldlineDiagram::new(&scene, &settings).expect("a diagram");
    assert_eq!(diagram.emissions.len(), 15);
    for emission in &diagram.emissions {
        let time = at[emission.moment];
        let moment = scene.flight().moment(time);
        let now = diagram.moments[emission.moment].event;
        assert_eq!(now, moment.event());
        // On the light cone, before.
        let way = emission.event - now;
        let duration = -way.time;
        assert!(duration > 0.0, "{emission:?}");
        assert!(
            way.interval().abs() < 1e-13 * duration * (duration + now.time.abs()),
            "{emission:?}"
        );
        // On the worldline.
        let line = &diagram.points[emission.point].world_line;
        let own_time = (emission.event.time - line.origin.time) / line.velocity.gamma();
        let there = line.at(own_time);
        let apart = there.position.distance(emission.event.position);
        assert!(
            apart < 1e-13 * (1.0 + duration + now.time.abs()),
            "{apart:e}"
        );
        // The observer sees it there, now: by the photosurface's own formula, and by a boost of the emission event.
        let to_observer = moment.scene_to_observer();
        let seen = to_observer.apply(emission.seen - now);
        let emitted = to_observer.apply(way);
        let object = &scene.objects()[usize::from(emission.point > 0)];
        let view = View::new(&moment, &object.world_line());
        let by_view = view.seen_position(settings.points[emission.point].position_rest.get());
        let limit = 1e-12 * (1.0 + by_view.length());
        assert!(seen.time.abs() < limit, "{seen:?}");
        assert!(
            seen.position.distance(by_view) < limit,
            "{seen:?} {by_view}"
        );
        assert!(
            emitted.position.distance(by_view) < limit,
            "{emitted:?} {by_view}"
        );
        assert!(
            (emitted.time + by_view.length()).abs() < limit,
            "{emitted:?}"
        );
    }
    let names: Vec<_> = diagram
        .points
        .iter()
        .map(|point| point.name.as_str())
        .collect();
    assert_eq!(names, ["sphere", "cube", "cube [0.5, -0.5, 0.5]"]);
}

/// No digit of the emission event is lost to the observer's own speed.
#[test]
fn an_observer_near_light_speed_keeps_the_light_cone() {
    let scene = scene(
        r#"{ "observer": { "velocity": { "gamma": 1e9, "direction": [1, 0, 0] } }, "objects": [
            { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [2, 3, 6] } ] }"#,
    );
    let settings = DiagramSettings {
        proper_times: 0.0..=0.0,
        ..settings(&[0.0])
    };
    let diagram = WorldlineDiagram::new(&scene, &settings).expect("a diagram");
    let expected = Event::new(-7.0, DVec3::new(2.0, 3.0, 6.0));
    assert_eq!(diagram.emissions[0].event, expected);
    // One moment alone: as long before and after as the light has been under way.
    let (first, last) = (
        diagram.worldline[0],
        diagram.worldline[diagram.worldline.len() - 1],
    );
    assert!((first.time + 7.0).abs() < 1e-12 && (last.time - 7.0).abs() < 1e-12);
    assert_eq!(diagram.direction, DVec3::X);
    assert!((diagram.off_plane(expected) - 45f64.sqrt()).abs() < 1e-14);
}

#[test]
fn momentary_axes_are_orthogonal() {
    let scene = scene(FLIGHT);
    let at = [0.0, 1.0, 2.1, 3.3, 9.0];
    for direction in [None, Some(DVec3::new(3.0, -1.0, 2.0))] {
        let settings = DiagramSettings {
            direction,
            ..settings(&at)
        };
        let diagram = WorldlineDiagram::new(&scene, &settings).expect("a diagram");
        assert!((diagram.direction.length() - 1.0).abs() < 1e-15);
        for moment in &diagram.moments {
            let (time, space) = (moment.time_axis, moment.space_axis);
            let limit = 1e-14 * time.time;
            assert!(minkowski(time, space).abs() < limit, "{moment:?}");
            assert!((minkowski(time, time) + 1.0).abs() < limit * time.time);
            assert!((diagram.along(space) - 1.0).abs() < 1e-15);
            assert_eq!(space.position, diagram.direction);
            // At one time for the observer, who is at rest along the other axis.
            let observer = scene
                .flight()
                .moment(moment.proper_time)
                .scene_to_observer();
            assert!(observer.apply(space).time.abs() < limit);
            assert!(observer.apply(time).position.length() < limit);
        }
        let proper_times: Vec<f64> = diagram.moments.iter().map(|m| m.proper_time).collect();
        assert_eq!(proper_times, at);
    }
}

/// From rest with thrust 1 the worldline is the hyperbola `(x + 1)^2 - t^2 = 1`, of which chords are on the inner side.
#[test]
fn a_worldline_is_as_good_as_its_curve() {
    let scene = scene(
        r#"{ "observer": { "flight": [ { "proper_time": 3, "acceleration": [1, 0, 0] } ] },
          "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [-1, 0, 0] } ] }"#,
    );
    let settings = DiagramSettings {
        proper_times: 0.0..=3.0,
        ..settings(&[0.0])
    };
    let diagram = WorldlineDiagram::new(&scene, &settings).expect("a diagram");
    let events = &diagram.worldline;
    assert!((33..500).contains(&events.len()), "{}", events.len());
    let off = |event: Event| {
        let x = event.position.x + 1.0;
        (x - 1f64.hypot(event.time), event.time)
    };
    for ends in events.windows(2) {
        let (on, before) = (off(ends[0]), off(ends[1]));
        assert!(on.0.abs() < 1e-13 && on.1 < before.1, "{ends:?}");
        let middle = off(ends[0] * 0.5 + ends[1] * 0.5);
        assert!((-1e-13..10.0 / 4000.0).contains(&middle.0), "{middle:?}");
    }
    let last = events[events.len() - 1];
    assert!((last.time - 3f64.sinh()).abs() < 1e-13);
    // Round proper times, with the four-velocity (cosh, sinh).
    let ticks: Vec<f64> = diagram.ticks.iter().map(|tick| tick.proper_time).collect();
    assert_eq!(ticks, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
    for tick in &diagram.ticks {
        assert!((tick.event.time - tick.proper_time.sinh()).abs() < 1e-13);
        assert!((tick.four_velocity.time - tick.proper_time.cosh()).abs() < 1e-13);
        assert!((diagram.along(tick.four_velocity) - tick.proper_time.sinh()).abs() < 1e-13);
    }
    assert_eq!(diagram.off_plane(last), 0.0);
}

/// An observer who stays looks along the light that has been under way longest.
#[test]
fn the_plane_is_that_of_what_extends_farthest() {
    let scene = scene(
        r#"{ "observer": { "time": 2, "position": [1, 1, 1] }, "objects": [
            { "name": "near", "shape": { "sphere": { "radius": 1 } }, "position": [2, 1, 1] },
            { "name": "far", "shape": { "sphere": { "radius": 1 } }, "position": [1, -4, 1] } ] }"#,
    );
    let settings = DiagramSettings {
        proper_times: 0.0..=1.0,
        ..settings(&[0.5])
    };
    let diagram = WorldlineDiagram::new(&scene, &settings).expect("a diagram");
    assert_eq!(diagram.direction, DVec3::NEG_Y);
    let beside: Vec<f64> = diagram
        .emissions
        .iter()
        .map(|e| diagram.off_plane(e.event))
        .collect();
    assert_eq!(beside, [1.0, 0.0]);
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let scene = scene(FLIGHT);
    let error = |settings: &DiagramSettings| WorldlineDiagram::new(&scene, settings).unwrap_err();
    let unknown = DiagramSettings {
        points: vec![point("cone", DVec3::X)],
        ..settings(&[0.0])
    };
    assert_eq!(
        error(&unknown),
        DiagramError::Object("cone".into(), "sphere, cube".into())
    );
    let nowhere = DiagramSettings {
        direction: Some(DVec3::ZERO),
        ..settings(&[0.0])
    };
    assert_eq!(error(&nowhere), DiagramError::Direction(DVec3::ZERO));
    assert_eq!(
        error(&settings(&[f64::INFINITY])),
        DiagramError::ProperTime(f64::INFINITY)
    );
    assert_eq!(
        error(&settings(&[1e301])),
        DiagramError::ObserverTooFar(1e301)
    );
}
