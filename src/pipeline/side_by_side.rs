//! A scene under several models side by side.

use glam::DVec3;

use super::{PlacedScene, PlacedSceneError};
use crate::material::Model;
use crate::scene::Scene;
use crate::spacetime::ViewModel;

/// Distance between neighbours, as a fraction of the largest extent of any.
const GAP: f64 = 0.2;

impl PlacedScene {
    /// A scene with all objects under each of these models, whatever the scene says; `models` are one for each object of
    /// `scene`.
    ///
    /// Files move what is shown under all models but the first: aside along x of the observer's frame, so that nothing overlaps
    /// at any step, and along y and z to the middle of the first. Each object has the name of its model behind its own, as `ball_delayed`.
    ///
    /// # Errors
    ///
    /// As [`PlacedScene::new`]; also no model, or one that is given twice.
    pub fn side_by_side(
        scene: Scene,
        models: &[Model],
        view_models: &[ViewModel],
    ) -> Result<Self, PlacedSceneError> {
        let scene = scene.with_each_model(view_models)?;
        let models = view_models.iter().flat_map(|_| models.iter().cloned());
        let placed = Self::new(scene, models.collect())?;
        placed.with_groups_apart(view_models.len())
    }

    /// The same scene with so many groups of as many objects each, one after the other, moved apart in files.
    fn with_groups_apart(mut self, groups: usize) -> Result<Self, PlacedSceneError> {
        let in_each = self.objects.len() / groups.max(1);
        let boxes = self.boxes_of_groups(groups)?;
        let largest = boxes.iter().map(|(low, high)| high.x - low.x);
        let gap = GAP * largest.fold(0.0, f64::max);
        let middle = |(low, high): (DVec3, DVec3)| 0.5 * low + 0.5 * high;
        let Some(&first) = boxes.first() else {
            return Ok(self);
        };
        let mut end = first.1.x;
        let others = boxes.iter().zip(self.objects.chunks_mut(in_each.max(1)));
        for (&around, objects) in others.skip(1) {
            let mut beside = middle(first) - middle(around);
            beside.x = end + gap - around.0.x;
            end = around.1.x + beside.x;
            for object in objects.iter_mut().filter(|_| beside.is_finite()) {
                object.beside = beside;
            }
        }
        Ok(self)
    }

    /// Low and high corner of the box around each group at all steps, in the observer's frame.
    fn boxes_of_groups(&self, groups: usize) -> Result<Vec<(DVec3, DVec3)>, PlacedSceneError> {
        let in_each = (self.objects.len() / groups.max(1)).max(1);
        let nowhere = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut boxes = vec![nowhere; groups];
        for step in 0..self.scene().steps().len() {
            for (number, extremes) in self.seen_extremes(step)?.iter().enumerate() {
                let (low, high) = extremes.bounds().unwrap_or(nowhere);
                let group = &mut boxes[number / in_each];
                *group = (group.0.min(low), group.1.max(high));
            }
        }
        Ok(boxes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::SurfaceOptions;
    use super::*;
    use crate::jobs::load_models;

    #[test]
    fn models_stand_beside_each_other_and_the_first_one_where_it_is() {
        let scene = Scene::from_json(
            r#"{ "observer": { "velocity": { "beta": 0.9 } }, "steps": [0, 1], "objects": [
                 { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] },
                 { "name": "box", "shape": { "box": { "size": [1, 1, 1] } }, "position": [3, 0, -5] } ] }"#,
        )
        .unwrap();
        let (models, _) = load_models(&scene, ".".as_ref()).unwrap();
        let placed = PlacedScene::side_by_side(scene.clone(), &models, &ViewModel::ALL).unwrap();
        let mut intervals = vec![];
        for (number, view_model) in ViewModel::ALL.into_iter().enumerate() {
            let mut interval = (f64::INFINITY, f64::NEG_INFINITY);
            for step in 0..2 {
                let surfaces = placed
                    .photosurfaces(step, SurfaceOptions::default())
                    .unwrap();
                for surface in surfaces.skip(2 * number).take(2) {
                    assert!(surface.facts.object.ends_with(view_model.name()));
                    assert_eq!(surface.facts.beside.is_some(), number > 0);
                    let (low, high) = surface.mesh.bounds().unwrap();
                    interval.0 = interval.0.min(low.x + surface.beside.x);
                    interval.1 = interval.1.max(high.x + surface.beside.x);
                }
            }
            intervals.push(interval);
        }
        assert!(
            intervals.windows(2).all(|pair| pair[0].1 < pair[1].0),
            "{intervals:?}"
        );
        let twice = PlacedScene::side_by_side(scene, &models, &[ViewModel::Rest; 2]).unwrap_err();
        assert!(twice.to_string().contains("ball_rest"), "{twice}");
    }
}
