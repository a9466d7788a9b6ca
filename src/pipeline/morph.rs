//! Photosurfaces of all steps with the same triangles, as morph targets need them.

use super::plan::Plan;
use super::together::make_together;
use super::{Photosurface, PlacedScene, SurfaceOptions};

impl PlacedScene {
    /// The photosurfaces of every part at all steps, with the same triangles at each: the mesh at rest is refined
    /// until it is within the tolerance at every step.
    ///
    /// Each item holds the photosurfaces of one part, one for each step; the parts are in the order of the scene. The
    /// certificates are valid for a file in which all steps share one offset, as
    /// [`Playback::Morph`](crate::write::Playback::Morph) writes it.
    pub fn morphing(&self, wanted: SurfaceOptions) -> impl Iterator<Item = Vec<Photosurface>> {
        let objects = self.scene.objects().iter().zip(&self.objects);
        objects.flat_map(move |(object, placed_object)| {
            let steps = 0..self.scene.steps().len();
            let plans: Vec<Plan<'_>> = steps
                .map(|step| self.plan(object, placed_object, step, wanted))
                .collect();
            let shown: Vec<_> = plans.iter().map(|plan| plan.shown).collect();
            let parts = make_together(placed_object, plans, wanted).into_iter();
            parts.map(move |surfaces| {
                let steps = surfaces.into_iter().zip(&shown).enumerate();
                steps
                    .map(|(step, (surface, shown))| {
                        self.photosurface(
                            object,
                            (step, placed_object.beside),
                            shown,
                            surface,
                            wanted,
                        )
                    })
                    .collect()
            })
        })
    }
}
