//! What the tolerances of a scene will take, and what a budget leaves of them.
//!
//! Predictions steer, counts hold: aims are loosened until about as much is predicted as there is, and then each object
//! is granted so many triangles at each step that all together are within the budget, whatever was predicted.

use super::placed_object::Granted;
use super::predicting::{Predicted, predict};
use super::{PlacedScene, SurfaceOptions};
use crate::tessellate::shares;

/// Room that a budget leaves for predictions, which are good to about a half (`tests/it/cli/accuracy.rs`).
const PREDICTION_ROOM: f64 = 1.2;

/// A tolerance that is advised is so many times looser than the aim: it has to fit by itself, whatever the prediction
/// misses, while counts hold the aim.
const ADVISED: f64 = 4.0 / 3.0;

/// Of more triangles than this, all steps together, a prediction looks at as many, evenly spread, but at each step at
/// as many as [`MIN_LOOKED_AT`] at least.
const TRIANGLES_LOOKED_AT: usize = 50_000;
const MIN_LOOKED_AT: usize = 5_000;

/// Of more steps than this a prediction looks at as many, evenly spread.
const STEPS_LOOKED_AT: usize = 32;

/// The triangles before any refinement may be more than a budget: then no tolerance fits it.
const MAX_LOOSENING: f64 = 1e300;

/// A share of the budget beyond the triangles of the source is used up to this part at least, if so many steps suffice.
const USED: f64 = 0.9;
const MAX_HALVINGS: usize = 8;

/// Where even the loosest aim takes more than there is, so many times as much is spent: the last few per cent would
/// take a tolerance that says nothing any more.
const MIN_SPENT: f64 = 1.05;

/// What is predicted for each object, at each step that was looked at.
type Forecast = Vec<Vec<Predicted>>;

/// What one object will take, known in a fraction of the time that it takes to make it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// About how many triangles its photosurfaces will have, all steps together.
    pub triangles: f64,
    /// How many there are before any refinement, all steps together: of a round shape, as fine as its tolerance asks
    /// for. In certificates `triangles_in`.
    pub triangles_in: f64,
    /// Whether its tolerance can be kept, by as many triangles as that.
    ///
    /// Not where rounding alone takes more, where the observer touches a surface and the tolerance is an angle, or
    /// where nothing is to be subdivided.
    pub reachable: bool,
}

impl PlacedScene {
    /// What each object will take, in the order of the scene.
    pub fn predictions(&self, wanted: SurfaceOptions) -> Vec<Prediction> {
        self.predictions_by(&self.forecast(wanted))
    }

    /// What was predicted for each object, and for each step that was looked at.
    fn forecast(&self, wanted: SurfaceOptions) -> Forecast {
        let objects = 0..self.objects.len();
        objects
            .map(|object| self.predict_some(object, wanted))
            .collect()
    }

    fn predictions_by(&self, forecast: &[Vec<Predicted>]) -> Vec<Prediction> {
        let predictions = forecast.iter().enumerate().map(|(object, at_some)| {
            let predicted = self.all_steps(at_some);
            let most = self.max_triangles(object);
            Prediction {
                triangles: predicted.triangles.min(most),
                triangles_in: predicted.before.min(most),
                reachable: predicted.reachable && predicted.triangles <= most,
            }
        });
        predictions.collect()
    }

    /// The same placed scene with looser aims, so that all its photosurfaces together have at most `most` triangles; and for
    /// each object how many times looser a tolerance is that fits by itself, 1 where it is left alone and infinity where no
    /// aim that was tried is loose enough.
    ///
    /// Objects that need less than an equal share of what is left by the others get what they need; the others
    /// share the rest, and within each the largest gaps are closed first. Certificates are still against the
    /// tolerances of the scene. Triangles that a source has stay, even if they are more: those of its meshes, and of a
    /// round shape as many as the coarsest of its kind has.
    ///
    /// The limit holds exactly, also where a prediction is wrong: what is granted is known beforehand, and refinement
    /// stops when it is used up. Of [`PlacedScene::morphing`] it counts the one mesh of each part.
    #[must_use]
    pub fn within_budget(self, wanted: SurfaceOptions, max_triangles: u64) -> (Self, Vec<f64>) {
        let (placed, loosening, _) = self.fitted(wanted, max_triangles);
        (placed, loosening)
    }

    /// As [`PlacedScene::within_budget`], and what the tolerances themselves need.
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
        let needed = |placed: &Self, object| {
            let at_some = placed.predict_some(object, wanted);
            placed.all_steps(&at_some).needed()
        };
        let mut objects: Vec<(usize, f64)> = forecast
            .iter()
            .map(|at_some| self.all_steps(at_some).needed())
            .enumerate()
            .collect();
        objects.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let mut left = most as f64;
        for (done, &(object, mut need)) in objects.iter().enumerate() {
            let share = left / (objects.len() - done) as f64;
            if wanted.subdivide && need > share {
                need = self.loosen(object, share, need, needed);
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

    /// Grants each object so many triangles at each step that all together are at most `most`, or those of the source.
    fn grant(&mut self, forecast: &[Vec<Predicted>], most: u64) {
        let steps = self.scene.steps().len();
        let sources: Vec<u64> = (self.objects.iter())
            .map(|placed_object| placed_object.source_triangles)
            .collect();
        let all: u64 = sources.iter().sum();
        // What each object needs at each step beyond its source.
        let needs: Vec<Vec<f64>> = (forecast.iter().zip(&sources))
            .map(|(at_some, &source)| {
                let need = |step: usize| {
                    let last = (steps - 1).max(1) as f64;
                    let at = step as f64 / last * (at_some.len() - 1) as f64;
                    let need = at_some[at.round() as usize].needed() - source as f64;
                    // Infinity and NaN are as good as all that there is.
                    if need < most as f64 {
                        need.max(0.0)
                    } else {
                        most as f64
                    }
                };
                (0..steps).map(need).collect()
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

    /// The most that an object can have at all steps together.
    fn max_triangles(&self, object: usize) -> f64 {
        let placed_object = &self.objects[object];
        let source = placed_object.source_triangles as f64;
        let steps = 0..self.scene.steps().len();
        steps
            .map(|step| source + placed_object.granted(step) as f64)
            .sum()
    }

    /// Loosens the aim of one object until it needs no more than its share, and hardly less; what it needs then. An
    /// object that needs more however loose it is comes near to that.
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
            // The source takes all of it, and stays whatever the budget.
            self.objects[object].loosening = 1.0;
            return need;
        }
        if share <= least {
            // Nothing is left to be granted.
            return least;
        }
        share = share.max(MIN_SPENT * least);
        let mut too_tight = 1.0;
        let mut loosening: f64 = 1.0;
        self.objects[object].loosening = loosening;
        // Triangles go with the inverse of the tolerance, but for those that are there anyway.
        let mut factor = (need / share).max(2.0);
        while need > share && loosening < MAX_LOOSENING {
            too_tight = loosening;
            loosening = (loosening * factor).min(MAX_LOOSENING);
            self.objects[object].loosening = loosening;
            let loosened = needed(self, object);
            // Where that changes little, tolerances that matter are far away.
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
            // The roots first: the product might overflow.
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

    /// All steps together, by those that were looked at.
    fn all_steps(&self, at_some: &[Predicted]) -> Predicted {
        let each = self.scene.steps().len() as f64 / at_some.len() as f64;
        let mut sum = Predicted {
            triangles: 0.0,
            before: 0.0,
            reachable: true,
        };
        for predicted in at_some {
            sum.triangles += predicted.triangles * each;
            sum.before += predicted.before * each;
            sum.reachable &= predicted.reachable;
        }
        sum
    }

    /// Each step, or some of many, evenly spread.
    fn predict_some(&self, object: usize, wanted: SurfaceOptions) -> Vec<Predicted> {
        let (object, placed_object) = (&self.scene.objects()[object], &self.objects[object]);
        let steps = self.scene.steps().len();
        let looked_at = steps.min(STEPS_LOOKED_AT);
        let triangles = (TRIANGLES_LOOKED_AT / looked_at).max(MIN_LOOKED_AT);
        let sketch = (wanted.subdivide.then(|| placed_object.sketch(triangles))).flatten();
        let (placed_object, weights) = match &sketch {
            Some((sketch, weights)) => (sketch, weights.clone()),
            None => (placed_object, vec![1.0; placed_object.parts.len()]),
        };
        let predict_at = |index: usize| {
            let step = index * (steps - 1) / (looked_at - 1).max(1);
            let plan = self.plan(object, placed_object, step, wanted);
            predict(plan, wanted, &weights)
        };
        (0..looked_at).map(predict_at).collect()
    }
}

/// Of what there is, what each needs and then shares of the rest, or shares of all in proportion to what each needs. With
/// each need, the number of triangles of its source.
fn granted(whole: u64, needs: &[(f64, u64)]) -> Vec<u64> {
    let needed: Vec<f64> = needs.iter().map(|(need, _)| need.ceil()).collect();
    let all: f64 = needed.iter().sum();
    if all >= whole as f64 {
        return shares(whole, &needed);
    }
    let needed = needed.into_iter().map(|need| need as u64);
    let rest = whole - all as u64;
    // What was not predicted may be anywhere.
    let weights = needs
        .iter()
        .map(|&(need, source)| need + source as f64 + 1.0);
    let rest = shares(rest, &weights.collect::<Vec<f64>>());
    needed.zip(rest).map(|(need, more)| need + more).collect()
}

impl Predicted {
    /// With room for what a prediction may miss.
    fn needed(&self) -> f64 {
        self.before + PREDICTION_ROOM * (self.triangles - self.before)
    }
}
