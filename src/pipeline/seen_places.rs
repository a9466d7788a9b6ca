//! Where the objects of a scene are seen, without photosurfaces: what cameras have to show, and boxes around it.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use super::placed_object::PlacedObject;
use super::plan::seen_parts;
use super::{PlacedScene, PlacedSceneError};
use crate::light_cone::{Extremes, View};
use crate::material::Part;
use crate::scene::Object;

/// The number of vertices up to which flat shapes have the default resolution; where all objects together have more, flat
/// shapes get a coarser one, with about so many vertices. Each of so many objects is a small part of what a camera shows.
const MAX_VERTICES: usize = 1_000_000;

impl PlacedScene {
    /// Calls `tell` with the positions, in the observer's frame, at which the vertices of each part are seen at one step
    /// before any refinement, in the order of the scene. A flat shape has the vertices of its default resolution, or
    /// fewer if there are very many objects.
    ///
    /// # Errors
    ///
    /// An error is returned if the scene has no such step.
    pub(crate) fn seen_places(
        &self,
        step: usize,
        mut tell: impl FnMut(&[DVec3]),
    ) -> Result<(), PlacedSceneError> {
        self.check_step(step)?;
        let share = self.share_of_segments();
        for (object, placed_object) in self.scene.objects().iter().zip(&self.objects) {
            let (stand_in, view) = self.stand_in(object, placed_object, step);
            for seen in seen_parts(&view, &stand_in.parts_looked_at(share)) {
                tell(seen.mesh.positions());
            }
        }
        Ok(())
    }

    /// Each object with its parts at rest as cameras have to look at them: a flat shape has its default resolution, or a
    /// coarser one if there are very many objects.
    pub(crate) fn looked_at(&self) -> impl Iterator<Item = (&Object, Cow<'_, [(String, Part)]>)> {
        let share = self.share_of_segments();
        let objects = self.scene.objects().iter().zip(&self.objects);
        objects.map(move |(object, placed)| (object, placed.parts_looked_at(share)))
    }

    /// For each object the extremes of where the vertices of its default resolution are seen at one step.
    ///
    /// # Errors
    ///
    /// An error is returned if the scene has no such step.
    pub(crate) fn seen_extremes(&self, step: usize) -> Result<Vec<Extremes>, PlacedSceneError> {
        self.check_step(step)?;
        let objects = self.scene.objects().par_iter().zip(&self.objects);
        let extremes = objects.map(|(object, placed_object)| {
            let (stand_in, view) = self.stand_in(object, placed_object, step);
            match &stand_in.shaped {
                Some(shaped) if shaped.is_sampled() => shaped.extremes(&view),
                _ => {
                    let seen = seen_parts(&view, &stand_in.parts).into_iter();
                    let extremes = seen.map(|seen| seen.extremes);
                    extremes.fold(Extremes::NONE, Extremes::and)
                }
            }
        });
        Ok(extremes.collect())
    }

    /// The number of vertices of all objects before any refinement; flat shapes have their default resolution.
    pub(crate) fn vertices_at_rest(&self) -> usize {
        self.objects.iter().map(PlacedObject::vertices).sum()
    }

    fn stand_in<'a>(
        &self,
        object: &Object,
        placed_object: &'a PlacedObject,
        step: usize,
    ) -> (Cow<'a, PlacedObject>, View) {
        let shown = self.model_view(object, step);
        placed_object.stand_in(&shown.expect("the step has been checked"))
    }

    /// The fraction of their default number of segments that flat shapes have where cameras look at them.
    fn share_of_segments(&self) -> f64 {
        (MAX_VERTICES as f64 / self.vertices_at_rest() as f64)
            .sqrt()
            .min(1.0)
    }
}

impl PlacedObject {
    /// The parts; a flat shape has so large a part of its default number of segments.
    fn parts_looked_at(&self, share: f64) -> Cow<'_, [(String, Part)]> {
        match &self.shaped {
            Some(shaped) if shaped.is_sampled() => {
                let shape = shaped.shape.with_share_of_segments(share);
                shaped.parts_like(&shape, &self.parts).into()
            }
            _ => (&self.parts).into(),
        }
    }

    /// The number of vertices of all parts; a flat shape has its default resolution.
    fn vertices(&self) -> usize {
        match &self.shaped {
            Some(shaped) if shaped.is_sampled() => shaped.shape.flat_vertex_count(),
            _ => {
                let parts = self.parts.iter();
                parts.map(|(_, part)| part.mesh().vertex_count()).sum()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::load_models;
    use crate::pipeline::SurfaceOptions;
    use crate::scene::Scene;

    fn placed(objects: &str) -> PlacedScene {
        let scene = Scene::from_json(&format!(
            r#"{{ "observer": {{ "velocity": {{ "beta": 0.9 }} }}, "steps": [0, 2], "objects": [{objects}] }}"#
        ))
        .unwrap();
        let (models, _) = load_models(&scene, "".as_ref()).unwrap();
        PlacedScene::new(scene, models).unwrap()
    }

    /// What is seen of shapes in their default resolution is what a photosurface without refinement shows.
    #[test]
    fn places_are_those_of_photosurfaces_without_refinement() {
        let placed = placed(
            r#"{ "name": "box", "shape": { "box": { "size": [1, 2, 3] } }, "position": [0, 0, -3], "scale": [1, 2, 0.5],
                 "rotation": [0, 0.6, 0, 0.8] },
               { "name": "delayed", "shape": { "grid": { "size": 3, "cells": 2 } }, "model": "delayed" },
               { "name": "lattice", "shape": { "lattice": { "cells": 1, "spacing": 1, "thickness": 0.1 } } },
               { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "velocity": { "beta": 0.5 } }"#,
        );
        let options = SurfaceOptions {
            subdivide: false,
            ..SurfaceOptions::default()
        };
        for step in 0..2 {
            let surfaces: Vec<_> = placed.photosurfaces(step, options).unwrap().collect();
            let mut surfaces_left = surfaces.iter();
            let tell = |places: &[DVec3]| {
                let surface = surfaces_left.next().unwrap();
                assert!(surface.mesh.positions() == places, "{}", surface.facts.name);
            };
            placed.seen_places(step, tell).unwrap();
            assert!(surfaces_left.next().is_none());
            let extremes = placed.seen_extremes(step).unwrap();
            for (extremes, surface) in extremes.iter().zip(&surfaces) {
                let (low, high) = surface.mesh.bounds().unwrap();
                let (seen_low, seen_high) = extremes.bounds().unwrap();
                let room = 1e-14 * (high - low).length();
                let name = &surface.facts.name;
                assert!(
                    (low - seen_low).length() <= room,
                    "{name}: {low} {seen_low}"
                );
                assert!(
                    (high - seen_high).length() <= room,
                    "{name}: {high} {seen_high}"
                );
            }
        }
        assert!(placed.seen_places(2, |_| ()).is_err() && placed.seen_extremes(2).is_err());
    }

    #[test]
    fn a_crowd_of_flat_shapes_is_looked_at_in_few_places() {
        let object = |k: usize| {
            format!(r#"{{ "name": "b{k}", "shape": {{ "box": {{ "size": [1, 1, 1] }} }} }}"#)
        };
        let objects: Vec<String> = (0..1000).map(object).collect();
        let placed = placed(&objects.join(","));
        assert_eq!(placed.vertices_at_rest(), 1000 * 6534);
        let mut count = 0;
        placed
            .seen_places(0, |places| count += places.len())
            .unwrap();
        // 12 segments instead of 32: 13 times 13 vertices on each of six sides.
        assert_eq!(count, 1000 * 6 * 13 * 13);
    }
}
