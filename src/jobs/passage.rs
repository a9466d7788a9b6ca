//! Passages: where an observer flies by a mesh, and the proper times at which a passage is worth a look.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use thiserror::Error;

use crate::light_cone::View;
use crate::material::Model;
use crate::scene::{InvalidScene, Observer, Place, PlaceError, Scene, even_steps};
use crate::spacetime::Velocity;

/// Distance at which an observer passes the centre of a mesh by itself, in diagonals of the mesh's bounds.
const PASSING: f64 = 2.0;

/// The largest `gamma` at which a mesh by itself is seen at a right angle.
const MOST_GAMMA: f64 = 1e9;

/// Angle between the direction of motion and the direction in which an object is seen at the first moment of its passage, in
/// radians; at the last one it is seen as close to the opposite direction.
const FIRST_SEEN: f64 = PI / 6.0;

/// Reasons why there is no passage.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PassageError {
    /// The observer is at rest with all objects.
    #[error(
        "nothing passes: the observer is at rest with every object, expected a speed such as a beta of 0.9"
    )]
    AtRest,
    /// The count of moments, or a proper time, is out of range.
    #[error(transparent)]
    Steps(#[from] InvalidScene),
}

/// The observer of a mesh by itself before anything is said of it: at rest, and headed along -x, so that one who is faster
/// passes before the front of the mesh, which is the side of z.
pub fn passing_observer() -> Observer {
    Observer {
        velocity: Velocity::from_rapidity(0.0, DVec3::NEG_X).expect("a unit vector"),
        ..Observer::default()
    }
}

/// The scene of a mesh by itself with an observer who flies by: at two diagonals of the mesh's bounds from the centre of
/// these bounds, which is on the observer's right. The origin of the mesh is the origin of the scene.
///
/// The only step is the proper time at which the observer sees the centre at a right angle to the motion. With a `gamma`
/// above 1e9 it is the proper time 0, at which the observer is beside the mesh: at a right angle it sees light from `gamma`
/// times as far back, which takes as many of the 16 digits of its place.
///
/// # Errors
///
/// An error is returned if the observer's position is out of range.
pub fn fly_by(scene: Scene, model: &Model) -> Result<Scene, PlaceError> {
    let observer = scene.observer().clone();
    let (middle, away) = match model.bounds() {
        None => (DVec3::ZERO, 0.0),
        Some((low, high)) => (0.5 * (low + high), PASSING * (high - low).length()),
    };
    let left = DVec3::Y.cross(observer.velocity.heading());
    let side = left.try_normalize().unwrap_or(DVec3::Z);
    let observer = Observer {
        position: Place::new(middle + side * away)?,
        ..observer
    };
    let moved = scene.with_observer(observer);
    let moved = moved.expect("a flight is possible wherever it begins");
    // The light that arrives at a right angle left the mesh when the observer was beside it, and took `away` in the
    // observer's frame.
    let step = match moved.observer().velocity.gamma() > MOST_GAMMA {
        true => 0.0,
        false => away,
    };
    Ok(moved
        .with_steps(vec![step])
        .expect("one step, as finite as the observer's place"))
}

/// `count` proper times of the observer from the approach of the objects, over their closest pass, to their departure.
///
/// An observer who coasts sees the middle of an object first at 30 degrees from the direction of motion, last at 150
/// degrees, and between at evenly spaced angles. Where several objects pass, the first moment is that of the first one, the
/// last moment that of the last one. An observer who flies has moments at evenly spaced proper times of its flight.
///
/// # Errors
///
/// Nothing moves relative to the observer, or `count` is out of range.
pub fn passage(scene: &Scene, models: &[Model], count: usize) -> Result<Vec<f64>, PassageError> {
    if !scene.observer().flight.is_empty() {
        return Ok(even_steps(0.0, scene.flight().proper_time(), count)?);
    }
    // The bounds of the count are checked there.
    even_steps(0.0, 1.0, count)?;
    let passes: Vec<Pass> = scene
        .objects()
        .iter()
        .zip(models)
        .filter_map(|(object, model)| {
            let (low, high) = model.bounds()?;
            let to_rest = object.model_to_rest();
            let middle = to_rest.transform_point3(0.5 * (low + high));
            let radius = 0.5 * to_rest.transform_vector3(high - low).length();
            Pass::new(
                &View::new(&scene.observer().start(), &object.world_line()),
                middle,
                radius,
            )
        })
        .collect();
    if passes.is_empty() {
        return Err(PassageError::AtRest);
    }
    let steps = (0..count).map(|number| {
        let part = match count {
            1 => 0.5,
            _ => number as f64 / (count - 1) as f64,
        };
        let angle = FIRST_SEEN + part * (PI - 2.0 * FIRST_SEEN);
        let mut times: Vec<f64> = passes.iter().map(|pass| pass.time_at(angle)).collect();
        times.sort_unstable_by(f64::total_cmp);
        // From the first object to the last one.
        let place = part * (times.len() - 1) as f64;
        let (before, after) = (times[place.floor() as usize], times[place.ceil() as usize]);
        before + (after - before) * place.fract()
    });
    let steps: Vec<f64> = steps.collect();
    match steps.iter().position(|step| !step.is_finite()) {
        Some(index) => Err(InvalidScene::Step(index, steps[index]).into()),
        None => Ok(steps),
    }
}

/// How an object passes an observer who coasts.
struct Pass {
    /// Proper time at which the object's middle is beside the observer, in the rest frame of either.
    beside: f64,
    /// The smallest distance between the two.
    distance: f64,
    beta: f64,
}

impl Pass {
    /// The pass of something whose `middle` is at this place in its rest frame, seen at proper time 0 as `view` says; `None`
    /// if it does not move relative to the observer, or is beyond `f64`.
    ///
    /// A pass through it is taken as one at a distance of its `radius`.
    fn new(view: &View, middle: DVec3, radius: f64) -> Option<Self> {
        let velocity = view.relative_velocity();
        let offset = middle - view.observer_rest();
        let along = offset.dot(velocity.direction());
        let across = (offset - velocity.direction() * along).length();
        let pass = Self {
            beside: along / velocity.gamma_beta(),
            distance: across.max(radius).max(f64::MIN_POSITIVE),
            beta: velocity.beta(),
        };
        (velocity.rapidity() > 0.0 && pass.beside.is_finite()).then_some(pass)
    }

    /// The observer's proper time at which the middle is seen at an angle from the direction of motion.
    ///
    /// In the observer's frame the middle is at `distance cot(angle)` ahead when it emits the light, which takes
    /// `distance / sin(angle)`.
    fn time_at(&self, angle: f64) -> f64 {
        let ahead = match angle == FRAC_PI_2 {
            true => 0.0,
            false => angle.cos(),
        };
        self.beside + self.distance * (1.0 - ahead / self.beta) / angle.sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Object, Source};
    use crate::shape::{Appearance, Shape};

    fn scene(json: &str) -> (Scene, Vec<Model>) {
        let scene = Scene::from_json(json).unwrap();
        let (models, _) = super::super::load_models(&scene, ".".as_ref()).unwrap();
        (scene, models)
    }

    fn angles(scene: &Scene) -> Vec<f64> {
        let steps = 0..scene.steps().len();
        let object = &scene.objects()[0];
        let angle = |step| {
            let view = View::new(&scene.moment(step).unwrap(), &object.world_line());
            let heading = -view_direction_of_motion(&view);
            view.seen_position(DVec3::ZERO).angle_between(heading)
        };
        steps.map(angle).collect()
    }

    /// The velocity of the object in the observer's frame points there.
    fn view_direction_of_motion(view: &View) -> DVec3 {
        -(view.rotation() * view.relative_velocity().direction())
    }

    #[test]
    fn moments_are_those_at_which_the_middle_is_seen_at_even_angles() {
        for (beta, direction, at) in [
            (0.95, "[-1, 0, 0]", "[0, 3, 0]"),
            (0.1, "[0, 0, -1]", "[-50, 2, 7]"),
            (0.9999, "[1, 2, 3]", "[5, -7, 100]"),
        ] {
            let (scene, models) = scene(&format!(
                r#"{{ "observer": {{ "velocity": {{ "beta": {beta}, "direction": {direction} }} }},
                "objects": [{{ "name": "s", "shape": {{ "sphere": {{ "radius": 1 }} }}, "position": {at} }}] }}"#
            ));
            let steps = passage(&scene, &models, 7).unwrap();
            let scene = scene.with_steps(steps).unwrap();
            for (number, angle) in angles(&scene).into_iter().enumerate() {
                let expected = 30.0 + 20.0 * number as f64;
                assert!(
                    (angle.to_degrees() - expected).abs() < 1e-6,
                    "{beta} {number}: {angle}"
                );
            }
        }
    }

    #[test]
    fn one_moment_is_the_closest_pass() {
        let (scene, models) = scene(
            r#"{ "observer": { "velocity": { "beta": 0.8, "direction": [-1, 0, 0] } },
            "objects": [{ "name": "s", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] }] }"#,
        );
        assert_eq!(passage(&scene, &models, 1).unwrap(), [5.0]);
        assert!(passage(&scene, &models, 0).is_err());
    }

    #[test]
    fn a_passage_of_several_objects_is_from_the_first_to_the_last() {
        let (scene, models) = scene(
            r#"{ "observer": { "velocity": { "beta": 0.5, "direction": [-1, 0, 0] } },
            "objects": [
                { "name": "near", "shape": { "sphere": { "radius": 1 } }, "position": [-10, 0, -3] },
                { "name": "far", "shape": { "sphere": { "radius": 1 } }, "position": [-100, 0, -3] },
                { "name": "along", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -3],
                  "velocity": { "beta": 0.5, "direction": [-1, 0, 0] } }] }"#,
        );
        let steps = passage(&scene, &models, 9).unwrap();
        assert!(steps.is_sorted());
        let alone = |at: usize| {
            let alone = Scene::new(scene.observer().clone(), vec![scene.objects()[at].clone()]);
            passage(&alone.unwrap(), &models[at..=at], 9).unwrap()
        };
        assert_eq!((steps[0], steps[8]), (alone(0)[0], alone(1)[8]));
    }

    #[test]
    fn nothing_passes_an_observer_at_rest() {
        let (still, models) = scene(
            r#"{ "objects": [{ "name": "s", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] }] }"#,
        );
        assert_eq!(passage(&still, &models, 7), Err(PassageError::AtRest));
        let (flying, models) = scene(
            r#"{ "observer": { "flight": [{ "proper_time": 4, "acceleration": [0, 0, -1] }] },
            "objects": [{ "name": "s", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] }] }"#,
        );
        assert_eq!(passage(&flying, &models, 3).unwrap(), [0.0, 2.0, 4.0]);
    }

    /// At any speed the centre of a mesh by itself is seen at a right angle, on the right, at the same distance.
    #[test]
    fn a_mesh_is_passed_on_the_right() {
        let shape = Shape::sphere(1.0).unwrap();
        let model = shape.model(&Appearance::default()).unwrap();
        for rapidity in [0.0, 0.5, 5.0, 20.0, 300.0] {
            for direction in [DVec3::NEG_Z, DVec3::NEG_X, DVec3::new(1.0, 2.0, 3.0)] {
                // Off the axes a direction has 16 digits, of which the way of the observer costs those of gamma twice.
                if rapidity == 20.0 && direction.x == 1.0 {
                    continue;
                }
                let velocity = Velocity::from_rapidity(rapidity, direction).unwrap();
                let observer = Observer {
                    velocity,
                    ..Observer::default()
                };
                let object = Object::new("s", Source::File("s.glb".into()));
                let scene = Scene::new(observer, vec![object]).unwrap();
                let scene = fly_by(scene, &model).unwrap();
                let world_line = scene.objects()[0].world_line();
                let view = View::new(&scene.moment(0).unwrap(), &world_line);
                if rapidity == 300.0 {
                    assert_eq!(scene.steps(), [0.0]);
                    continue;
                }
                let seen = view.seen_position(DVec3::ZERO);
                let (low, high) = model.bounds().unwrap();
                let away = 2.0 * low.distance(high);
                let right = direction.normalize().cross(DVec3::Y).normalize();
                let off = seen.distance(right * away) / away;
                assert!(off < 1e-9, "{rapidity} {direction}: {seen}");
            }
        }
    }
}
