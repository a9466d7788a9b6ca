//! What the tolerances of a scene will take, and what a budget leaves of them.

use super::plan::Foresight;
use super::{Placed, Stage, Wanted};
use crate::mesh::{Mesh, Part};

/// Room that a budget leaves for predictions, which are good to about a half (`tests/cli.rs`).
const PREDICTION_ROOM: f64 = 1.6;

/// Of more triangles than this, all steps together, a prediction looks at as many, evenly spread, but at each step at
/// as many as [`LEAST_LOOKED_AT`] at least.
const TRIANGLES_LOOKED_AT: usize = 50_000;
const LEAST_LOOKED_AT: usize = 5_000;

/// Of more steps than this a prediction looks at as many, evenly spread.
const STEPS_LOOKED_AT: usize = 32;

/// What is there before any refinement may be more than a budget: then no tolerance fits it.
const MAX_LOOSENING: f64 = 1e300;

/// A share of the budget is used up to this part at least, if so many steps are enough to come near to it.
const USED: f64 = 0.7;
const MAX_HALVINGS: usize = 12;

/// Where even the loosest aim takes more than there is, so many times as much is spent: the last few per cent would
/// take a tolerance that says nothing any more.
const SPENT_AT_LEAST: f64 = 1.05;

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

impl Stage {
    /// What each object will take, in the order of the scene.
    pub fn predictions(&self, wanted: Wanted) -> Vec<Prediction> {
        let objects = 0..self.objects.len();
        objects
            .map(|object| {
                let foresight = self.foresee(object, wanted);
                Prediction {
                    triangles: foresight.triangles,
                    triangles_in: foresight.before,
                    reachable: foresight.reachable,
                }
            })
            .collect()
    }

    /// The same stage with looser aims, so that all its photosurfaces together have about as many triangles as
    /// `most`, or fewer; and for each object how many times looser, 1 where it is left alone.
    ///
    /// Objects that need less than an equal share of what is left by the others get what they need; the others
    /// share the rest, and within each the largest gaps are closed first. Certificates are still against the
    /// tolerances of the scene. Triangles that are there before any refinement stay, even if they are more.
    #[must_use]
    pub fn within_budget(mut self, wanted: Wanted, most: u64) -> (Self, Vec<f64>) {
        let needed = |stage: &Self, object| {
            let Foresight {
                triangles, before, ..
            } = stage.foresee(object, wanted);
            before + PREDICTION_ROOM * (triangles - before)
        };
        let mut objects: Vec<(usize, f64)> = (0..self.objects.len())
            .map(|object| (object, needed(&self, object)))
            .collect();
        objects.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let mut left = most as f64;
        for (done, &(object, mut need)) in objects.iter().enumerate() {
            let share = left / (objects.len() - done) as f64;
            if wanted.subdivide && need > share {
                need = self.loosen(object, share, need, needed);
            }
            left = (left - need).max(0.0);
        }
        let loosening = self.objects.iter().map(|placed| placed.loosening).collect();
        (self, loosening)
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
        share = share.max(SPENT_AT_LEAST * least);
        let mut too_tight = 1.0;
        let mut loosening: f64 = 1.0;
        self.objects[object].loosening = loosening;
        while need > share && loosening < MAX_LOOSENING {
            too_tight = loosening;
            // Triangles go with the inverse of the tolerance, but for those that are there anyway.
            loosening = (loosening * (need / share).max(2.0)).min(MAX_LOOSENING);
            self.objects[object].loosening = loosening;
            need = needed(self, object);
        }
        for _ in 0..MAX_HALVINGS {
            if need > share || need >= USED * share {
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

    /// All steps together.
    fn foresee(&self, object: usize, wanted: Wanted) -> Foresight {
        let (object, placed) = (&self.scene.objects()[object], &self.objects[object]);
        let steps = self.scene.steps().len();
        let looked_at = steps.min(STEPS_LOOKED_AT);
        let triangles = (TRIANGLES_LOOKED_AT / looked_at).max(LEAST_LOOKED_AT);
        let sketch = (wanted.subdivide.then(|| placed.sketch(triangles))).flatten();
        let (placed, weights) = match &sketch {
            Some((sketch, weights)) => (sketch, weights.clone()),
            None => (placed, vec![1.0; placed.parts.len()]),
        };
        let mut sum = Foresight {
            triangles: 0.0,
            before: 0.0,
            reachable: true,
        };
        let each = steps as f64 / looked_at as f64;
        for index in 0..looked_at {
            let step = index * (steps - 1) / (looked_at - 1).max(1);
            let plan = self.plan(object, placed, step, wanted);
            let foresight = plan.foresee(wanted, &weights);
            sum.triangles += foresight.triangles * each;
            sum.before += foresight.before * each;
            sum.reachable &= foresight.reachable;
        }
        sum
    }
}

impl Placed {
    /// A sample of about `most` triangles where there are more, and for each part of how many each is a sample.
    fn sketch(&self, most: usize) -> Option<(Self, Vec<f64>)> {
        let count = |part: &Part| part.mesh().triangles().len();
        let all: usize = self.parts.iter().map(|(_, part)| count(part)).sum();
        if all <= most || self.shaped.is_some() {
            return None;
        }
        let share = most as f64 / all as f64;
        let parts = self.parts.iter().map(|(name, part)| {
            let triangles = part.mesh().triangles();
            let sampled = (triangles.len() as f64 * share).ceil() as usize;
            let weight = triangles.len() as f64 / sampled as f64;
            (
                (name.clone(), part.with_mesh(sample(part.mesh(), sampled))),
                weight,
            )
        });
        let (parts, weights) = parts.unzip();
        let sketch = Self {
            parts,
            shaped: None,
            loosening: self.loosening,
        };
        Some((sketch, weights))
    }
}

/// So many triangles of a mesh, spread by multiples of the golden ratio: in step with no pattern of rows.
fn sample(mesh: &Mesh, triangles: usize) -> Mesh {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let all = mesh.triangles();
    let chosen = (0..triangles).map(|index| {
        let place = (index as f64 * GOLDEN).fract() * all.len() as f64;
        all[(place as usize).min(all.len() - 1)]
    });
    let corners = chosen
        .flatten()
        .map(|corner| mesh.positions()[corner as usize]);
    let positions: Vec<_> = corners.collect();
    let indices = (0..positions.len() as u32).step_by(3);
    let sampled = Mesh::new(
        positions,
        indices.map(|i| [i, i + 1, i + 2]).collect::<Vec<_>>(),
    );
    let sampled = sampled.and_then(Mesh::with_flat_normals);
    sampled.expect("finite positions and indices in range, as in the mesh")
}
