//! How many triangles the tolerances need, and how a budget of triangles loosens them.

use crate::pipeline::{PlacedScene, Prediction, SurfaceOptions};
use crate::scene::Tolerance;

/// Default limit on the triangles of all photosurfaces together.
pub const DEFAULT_MAX_TRIANGLES: u64 = 20_000_000;

/// A placed scene whose aims fit a budget of triangles, with the predictions. The *aim* of an object is the tolerance
/// to which it is refined: its own tolerance, or a looser one.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The scene with the aims that fit.
    pub placed: PlacedScene,
    /// For each object the prediction for its own tolerance.
    pub needed: Vec<Prediction>,
    /// For each object the prediction for its aim; not reachable if the aim is looser than the tolerance.
    pub predictions: Vec<Prediction>,
    /// For each object the factor by which its tolerance has to be loosened to fit without the budget: 1 if the
    /// tolerance fits as it is, infinite if no factor that was tried is large enough.
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

    /// Each object whose aim is looser than its tolerance, with a tolerance that fits without the budget.
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
