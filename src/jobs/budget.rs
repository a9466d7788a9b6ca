//! What tolerances need, and what a budget of triangles leaves of them.

use crate::pipeline::{PlacedScene, Prediction, SurfaceOptions};
use crate::scene::Tolerance;

/// How many triangles photosurfaces have together at most where nothing else is asked for.
pub const DEFAULT_MAX_TRIANGLES: u64 = 20_000_000;

/// A placed scene whose aims are within a budget of triangles, and what was predicted of it.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The scene with the aims that fit.
    pub placed: PlacedScene,
    /// What the tolerances of the scene need, for each object.
    pub needed: Vec<Prediction>,
    /// What the aims that fit will take, for each object; not reachable where its aim is looser than its tolerance.
    pub predictions: Vec<Prediction>,
    /// For each object how many times looser than its own a tolerance is that fits by itself: 1 where the object needs no
    /// looser one, infinite where none that was tried fits.
    pub loosening: Vec<f64>,
}

impl Fitted {
    /// Loosens the aims of a scene until its photosurfaces have at most `max_triangles` together, as
    /// [`PlacedScene::within_budget`] does.
    pub fn new(placed: PlacedScene, wanted: SurfaceOptions, max_triangles: u64) -> Self {
        let (placed, loosening, needed) = placed.fitted(wanted, max_triangles);
        if loosening.iter().all(|&times| times == 1.0) {
            return Self {
                placed,
                predictions: needed.clone(),
                needed,
                loosening,
            };
        }
        let mut predictions = placed.predictions(wanted);
        for (prediction, times) in predictions.iter_mut().zip(&loosening) {
            prediction.reachable &= *times == 1.0;
        }
        Self {
            placed,
            needed,
            predictions,
            loosening,
        }
    }

    /// Each object whose aim is looser than its tolerance, with a tolerance that fits by itself.
    pub fn loosened(&self) -> impl Iterator<Item = (&str, Tolerance)> {
        let scene = self.placed.scene();
        let objects = scene.objects().iter().zip(&self.loosening);
        let loosened = objects.filter(|&(_, &times)| times > 1.0);
        loosened.map(|(object, &times)| {
            let fitting = scene.tolerance(object).times(times);
            (object.name.as_str(), fitting)
        })
    }
}
