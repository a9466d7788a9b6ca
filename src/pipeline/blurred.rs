//! Objects of which 64 bits do not hold where the observer is.

use super::PlacedScene;
use crate::material::Part;
use crate::scene::Object;

/// An object whose surface the observer cannot see sharply, as its place relative to the object has too few digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blurred<'a> {
    /// The name of the object.
    pub object: &'a str,
    /// The first step, counted from 0, at which it is blurred.
    pub step: usize,
    /// The error of the observer's place at that step, in sizes of the object.
    pub error: f64,
}

/// Errors of place up to this part of an object's size are not told.
const SHARP: f64 = 1e-3;

impl PlacedScene {
    /// The objects that some step shows less sharply than a thousandth of their size, in the order of the scene: for the
    /// error of the observer's place in their rest frame a few units in the last place of the way there are taken.
    ///
    /// Certificates of meshes hold the same error; pictures by rays have no other sign of it.
    pub fn blurred(&self) -> Vec<Blurred<'_>> {
        let blurred = |(object, parts)| {
            let (step, error) = self.first_blurred(object, parts)?;
            Some(Blurred {
                object: &object.name,
                step,
                error,
            })
        };
        self.objects().filter_map(blurred).collect()
    }

    /// The first step at which an object is blurred, and the error there.
    fn first_blurred(&self, object: &Object, parts: &[(String, Part)]) -> Option<(usize, f64)> {
        let bounds = parts.iter().filter_map(|(_, part)| part.mesh().bounds());
        let (low, high) = bounds.reduce(|(low, high), (a, b)| (low.min(a), high.max(b)))?;
        let size = (high - low).length();
        let errors = (0..self.scene().steps().len()).filter_map(|step| {
            let place_size = self.view(object, step)?.place_size();
            Some((step, 4.0 * f64::EPSILON * place_size / size))
        });
        let mut blurred = errors.filter(|(_, error)| *error > SHARP);
        blurred.next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Source};

    #[test]
    fn after_a_journey_of_a_thousand_million_million_sizes_all_is_blurred() {
        let placed = |rapidity: f64| {
            let scene = Scene::from_json(&format!(
                r#"{{ "observer": {{ "velocity": {{ "rapidity": {rapidity} }} }}, "steps": [0, 3],
                "objects": [{{ "name": "s", "shape": {{ "sphere": {{ "radius": 1 }} }}, "position": [3, 0, 0] }}] }}"#
            ))
            .unwrap();
            let models = scene.objects().iter().map(|object| match &object.source {
                Source::Shape(shape, appearance) => shape.model(appearance).unwrap(),
                _ => unreachable!("a shape"),
            });
            PlacedScene::new(scene.clone(), models.collect()).unwrap()
        };
        assert!(placed(10.0).blurred().is_empty());
        let far = placed(40.0);
        let [blurred] = far.blurred()[..] else {
            panic!("one object");
        };
        // The way is 3 sinh(40) = 3.5e17 units long.
        assert!((blurred.object, blurred.step) == ("s", 1));
        assert!(
            blurred.error > 10.0 && blurred.error < 1000.0,
            "{blurred:?}"
        );
    }
}
