//! Objects that the observer is inside of.

use glam::DVec3;

use super::PlacedScene;
use crate::material::Part;
use crate::scene::Object;

/// An object that the observer is inside of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Around<'a> {
    /// The name of the object.
    pub object: &'a str,
    /// The first step, counted from 0, at which the observer is inside.
    pub step: usize,
}

impl PlacedScene {
    /// The objects that the observer is inside of at some step, in the order of the scene: those whose triangles at rest,
    /// which may leave holes, are on more than half of the sky around the observer.
    pub fn around_observer(&self) -> Vec<Around<'_>> {
        let around = |(object, parts)| {
            let step = self.first_inside(object, parts)?;
            Some(Around {
                object: &object.name,
                step,
            })
        };
        self.objects().filter_map(around).collect()
    }

    fn first_inside(&self, object: &Object, parts: &[(String, Part)]) -> Option<usize> {
        let meshes = || parts.iter().map(|(_, part)| part.mesh());
        let bounds = meshes().filter_map(|mesh| mesh.bounds());
        let (low, high) = bounds.reduce(|(low, high), (a, b)| (low.min(a), high.max(b)))?;
        let is_inside = |place: DVec3| {
            let is_near = place.cmpgt(low).all() && place.cmplt(high).all();
            // Triangles may face inwards.
            is_near
                && meshes()
                    .map(|mesh| mesh.winding_number(place))
                    .sum::<f64>()
                    .abs()
                    > 0.5
        };
        (0..self.scene().steps().len()).find(|&step| {
            let view = self.view(object, step);
            view.is_some_and(|view| is_inside(view.observer_rest()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Source};

    /// An observer who flies through a ball between steps 1 and 3, past another, and through a hole of a ring.
    #[test]
    fn whoever_is_inside_is_told_of() {
        let scene = Scene::from_json(
            r#"{ "observer": { "velocity": { "beta": 0.6, "direction": [0, 0, -1] } }, "steps": [0, 4, 8, 12],
            "objects": [
                { "name": "through", "shape": { "sphere": { "radius": 2 } }, "position": [0, 0, -6] },
                { "name": "beside", "shape": { "sphere": { "radius": 2 } }, "position": [3, 0, 0] },
                { "name": "ring", "shape": { "torus": { "major_radius": 2, "minor_radius": 0.5 } }, "position": [0, 0, -3] }] }"#,
        )
        .unwrap();
        let models = scene.objects().iter().map(|object| match &object.source {
            Source::Shape(shape, appearance) => shape.model(appearance).unwrap(),
            _ => unreachable!("all objects are shapes"),
        });
        let placed = PlacedScene::new(scene.clone(), models.collect()).unwrap();
        // After 8 of its own time, at 0.75 a unit, the observer is at the middle of the ball.
        let expected = Around {
            object: "through",
            step: 2,
        };
        assert_eq!(placed.around_observer(), [expected]);
    }
}
