//! How many triangles the tolerances of a scene need, and how a budget of triangles loosens them.
//!
//! The *aim* of an object is the tolerance to which it is refined: its own tolerance times a loosening factor. The
//! budget is kept in two stages. First the aims are loosened until the predicted number of triangles is about the
//! budget. Then each object is granted a number of triangles at each step; all grants together are within the budget,
//! even where the predictions are wrong.

use rayon::prelude::*;

use super::forecast::{ObjectForecast, examined_steps};
use super::placed_object::Granted;
use super::predicting::{Predicted, predict};
use super::{PlacedScene, SurfaceOptions};
use crate::tessellate::shares;

/// Factor by which predicted refinement is enlarged when it is compared with a budget. Predictions are good to about a
/// half (`tests/it/cli/accuracy.rs`).
const PREDICTION_ROOM: f64 = 1.2;

/// The tolerance that the user is advised to ask for is the aim times this factor. It has to fit without the grants,
/// even where the prediction is too low.
const ADVISED: f64 = 4.0 / 3.0;

/// A prediction examines at most this many triangles, all steps together, evenly spread over the mesh, but at each step
/// at least [`MIN_LOOKED_AT`].
const TRIANGLES_LOOKED_AT: usize = 50_000;
const MIN_LOOKED_AT: usize = 5_000;

/// The largest loosening that is tried. No tolerance fits a budget that is smaller than the number of triangles before
/// refinement.
const MAX_LOOSENING: f64 = 1e300;

/// An object's share of the budget beyond its source triangles is used up to at least this fraction, if
/// [`MAX_HALVINGS`] halvings suffice.
const USED: f64 = 0.9;
const MAX_HALVINGS: usize = 14;

/// An aim is not loosened further once the object needs no more than this many times the triangles of the loosest aim:
/// the last few per cent would need a meaningless tolerance.
const MIN_SPENT: f64 = 1.05;

/// The predictions for each object.
type Forecast = Vec<ObjectForecast>;

/// A prediction for one object: how many triangles it needs, found in a fraction of the time of making them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// About how many triangles the object's photosurfaces will have, all steps together.
    pub triangles: f64,
    /// Number of triangles before refinement, all steps together; a round shape is then as fine as its tolerance asks
    /// for. Certificates call this number `triangles_in`.
    pub triangles_in: f64,
    /// Whether that many triangles keep the object's tolerance.
    ///
    /// They do not if rounding alone exceeds the tolerance, if the tolerance is an angle and the observer touches a
    /// surface, or if meshes are not to be subdivided.
    pub reachable: bool,
}

impl PlacedScene {
    /// The prediction for each object, in the order of the scene.
    pub fn predictions(&self, wanted: SurfaceOptions) -> Vec<Prediction> {
        self.predictions_by(&self.forecast(wanted))
    }

    /// The predictions for each object.
    fn forecast(&self, wanted: SurfaceOptions) -> Forecast {
        let objects = (0..self.objects.len()).into_par_iter();
        objects
            .map(|object| self.predict_some(object, wanted))
            .collect()
    }

    fn predictions_by(&self, forecast: &[ObjectForecast]) -> Vec<Prediction> {
        let predictions = forecast.iter().enumerate().map(|(object, of_object)| {
            let predicted = of_object.all_steps();
            let most = self.max_triangles(object);
            Prediction {
                triangles: predicted.triangles.min(most),
                triangles_in: predicted.before.min(most),
                reachable: predicted.reachable && predicted.triangles <= most,
            }
        });
        predictions.collect()
    }

    /// The same placed scene with looser aims, so that all its photosurfaces together have at most `max_triangles`
    /// triangles; and for each object the factor by which its tolerance has to be loosened to fit without the budget.
    /// The factor is 1 if the aim is not loosened, and infinite if no aim that was tried is loose enough.
    ///
    /// An object that needs less than an equal share of what the other objects leave of the budget gets as many
    /// triangles as it needs. The other objects share the rest, and each of them closes its largest gaps first.
    /// Certificates still compare with the tolerances of the scene. The triangles of a source are always kept, even if
    /// they exceed the budget: those of its meshes, or those of the coarsest form of a round shape.
    ///
    /// The limit holds exactly, even where a prediction is wrong: grants are fixed beforehand, and refinement stops
    /// when a grant is used up. For [`PlacedScene::morphing`] the limit counts the triangles of each part once, because
    /// all steps share one mesh.
    #[must_use]
    pub fn within_budget(self, wanted: SurfaceOptions, max_triangles: u64) -> (Self, Vec<f64>) {
        let (placed, loosening, _) = self.fitted(wanted, max_triangles);
        (placed, loosening)
    }

    /// The results of [`PlacedScene::within_budget`], and the predictions for the tolerances of the scene.
    pub(crate) fn fitted(
        mut self,
        wanted: SurfaceOptions,
        most: u64,
    ) -> (Self, Vec<f64>, Vec<Prediction>) {
        for placed_object in &mut self.objects {
            placed_object.granted = None;
        }
        let mut forecast = self.forecast(wanted);
        let needs = self.predictions_by(&forecast);
        let needed =
            |placed: &Self, object| placed.predict_some(object, wanted).all_steps().needed();
        // An aim stays where the prediction fits: if it was too low, counts hold.
        let mut objects: Vec<(usize, f64)> = forecast
            .iter()
            .map(|of_object| of_object.all_steps().triangles)
            .enumerate()
            .collect();
        objects.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let mut left = most as f64;
        for (done, &(object, mut need)) in objects.iter().enumerate() {
            let share = left / (objects.len() - done) as f64;
            if wanted.subdivide && need > share {
                let with_room = forecast[object].all_steps().needed();
                need = self.loosen(object, share, with_room, needed);
                forecast[object] = self.predict_some(object, wanted);
            }
            left = (left - need).max(0.0);
        }
        let loosening = self
            .objects
            .iter()
            .map(|placed_object| match placed_object.loosening {
                MAX_LOOSENING.. => f64::INFINITY,
                1.0 => 1.0,
                times => ADVISED * times,
            });
        let loosening = loosening.collect();
        if wanted.subdivide {
            self.grant(&forecast, most);
        }
        (self, loosening, needs)
    }

    /// Grants each object a number of triangles at each step. All triangles together are at most `most`, or those of
    /// the sources if these are more.
    fn grant(&mut self, forecast: &[ObjectForecast], most: u64) {
        let steps = self.scene.steps().len();
        let sources: Vec<u64> = (self.objects.iter())
            .map(|placed_object| placed_object.source_triangles)
            .collect();
        let all: u64 = sources.iter().sum();
        // The number of triangles that each object needs at each step beyond those of its source.
        let needs: Vec<Vec<f64>> = (forecast.iter().zip(&sources))
            .map(|(of_object, &source)| {
                let need = |predicted: &Predicted| {
                    let need = predicted.needed() - source as f64;
                    // A need of infinity or NaN counts as the whole budget.
                    if need < most as f64 {
                        need.max(0.0)
                    } else {
                        most as f64
                    }
                };
                of_object.each_step(steps, need)
            })
            .collect();
        let at_steps: Vec<(f64, u64)> = (needs.iter().zip(&sources))
            .flat_map(|(needs, &source)| needs.iter().map(move |&need| (need, source)))
            .collect();
        let at_steps = granted(
            most.saturating_sub(all.saturating_mul(steps as u64)),
            &at_steps,
        );
        let together: Vec<(f64, u64)> = (needs.iter().zip(&sources))
            .map(|(needs, &source)| (needs.iter().sum(), source))
            .collect();
        let together = granted(most.saturating_sub(all), &together);
        let granted = at_steps.chunks(steps).zip(together);
        for (placed_object, (steps, together)) in self.objects.iter_mut().zip(granted) {
            let steps = steps.to_vec();
            placed_object.granted = Some(Granted { steps, together });
        }
    }

    /// Upper limit on the triangles of an object, all steps together.
    fn max_triangles(&self, object: usize) -> f64 {
        let placed_object = &self.objects[object];
        let source = placed_object.source_triangles as f64;
        let steps = 0..self.scene.steps().len();
        steps
            .map(|step| source + placed_object.granted(step) as f64)
            .sum()
    }

    /// Loosens the aim of one object until the object needs slightly fewer triangles than its share; returns the need
    /// with that aim. If the object needs more than its share at any aim, it ends with a need only slightly above the
    /// smallest one.
    fn loosen(
        &mut self,
        object: usize,
        mut share: f64,
        mut need: f64,
        needed: impl Fn(&Self, usize) -> f64,
    ) -> f64 {
        self.objects[object].loosening = MAX_LOOSENING;
        let least = needed(self, object);
        if need <= least {
            // The source makes up the whole need, and it is always kept.
            self.objects[object].loosening = 1.0;
            return need;
        }
        if share <= least {
            // The budget leaves nothing to grant beyond the source.
            return least;
        }
        share = share.max(MIN_SPENT * least);
        let mut too_tight = 1.0;
        let mut loosening: f64 = 1.0;
        self.objects[object].loosening = loosening;
        // The number of triangles is inversely proportional to the tolerance, except for the triangles before
        // refinement.
        let mut factor = (need / share).max(2.0);
        while need > share && loosening < MAX_LOOSENING {
            too_tight = loosening;
            loosening = (loosening * factor).min(MAX_LOOSENING);
            self.objects[object].loosening = loosening;
            let loosened = needed(self, object);
            // A small change of the need means that the aim is still much too tight.
            factor = match loosened > 0.5 * need {
                true => factor * factor,
                false => (loosened / share).max(2.0),
            };
            need = loosened;
        }
        for _ in 0..MAX_HALVINGS {
            if need > share || need - least >= USED * (share - least) {
                break;
            }
            // The roots are taken first, because the product might overflow.
            let between = too_tight.sqrt() * loosening.sqrt();
            self.objects[object].loosening = between;
            let need_between = needed(self, object);
            if need_between > share {
                too_tight = between;
            } else {
                (loosening, need) = (between, need_between);
            }
        }
        self.objects[object].loosening = loosening;
        need
    }

    /// The predictions for one object at each step, or at a selection of many steps.
    fn predict_some(&self, object: usize, wanted: SurfaceOptions) -> ObjectForecast {
        let (object, placed_object) = (&self.scene.objects()[object], &self.objects[object]);
        let steps = self.scene.steps().len();
        let bounds = placed_object.bounds();
        let examined = examined_steps(steps, self.objects.len(), |step| {
            let view = self.view(object, step).expect("a step of the scene");
            bounds.map_or(0.0, |(low, high)| {
                let observer = view.observer_rest();
                observer.distance(observer.clamp(low, high))
            })
        });
        let triangles = (TRIANGLES_LOOKED_AT / examined.len()).max(MIN_LOOKED_AT);
        let sketch = (wanted.subdivide.then(|| placed_object.sketch(triangles))).flatten();
        let (placed_object, weights) = match &sketch {
            Some((sketch, weights)) => (sketch, weights.clone()),
            None => (placed_object, vec![1.0; placed_object.parts.len()]),
        };
        ObjectForecast::new(&examined, |step| {
            predict(
                self.plan(object, placed_object, step, wanted),
                wanted,
                &weights,
            )
        })
    }
}

/// Divides `whole`. If it suffices for all needs, each gets its need and a share of the rest; otherwise each gets a
/// share in proportion to its need. Each need comes with the number of triangles of its source.
fn granted(whole: u64, needs: &[(f64, u64)]) -> Vec<u64> {
    let needed: Vec<f64> = needs.iter().map(|(need, _)| need.ceil()).collect();
    let all: f64 = needed.iter().sum();
    if all >= whole as f64 {
        return shares(whole, &needed);
    }
    let needed = needed.into_iter().map(|need| need as u64);
    let rest = whole - all as u64;
    // Triangles that were not predicted may be needed anywhere.
    let weights = needs
        .iter()
        .map(|&(need, source)| need + source as f64 + 1.0);
    let rest = shares(rest, &weights.collect::<Vec<f64>>());
    needed.zip(rest).map(|(need, more)| need + more).collect()
}

impl Predicted {
    /// The predicted number of triangles, with room for the error of the prediction.
    fn needed(&self) -> f64 {
        self.before + PREDICTION_ROOM * (self.triangles - self.before)
    }
}
