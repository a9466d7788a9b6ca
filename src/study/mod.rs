//! What accuracy costs: for one tolerance after the other the triangles, bytes, time and memory that it takes, what is
//! proven and what is measured then, and what theory and uniform subdivision say; for pictures by rays of light, for one
//! number of rays a pixel after the other, the time that it takes and the error that is measured.

mod measured;
mod memory;
mod mesh_cost;
#[cfg(feature = "plot")]
mod plot;
mod random;
mod ray_cost;
mod true_surface;
mod uniform;

use std::num::{NonZeroU32, NonZeroUsize};

use serde::Serialize;
use thiserror::Error;

pub use mesh_cost::{Made, MeshCost, Seconds};
#[cfg(feature = "plot")]
pub use plot::{PlotError, PlotSize};
pub use ray_cost::{Pictures, RayCost, RaySettings};
pub use uniform::{UniformCost, UniformRun};

use crate::jobs::{Cancelled, ExportError, Progress};
use crate::material::Model;
use crate::pipeline::{PlacedScene, PlacedSceneError, SceneFacts};
use crate::scene::{Scene, Tolerance, Unit};

/// What a study looks at, and how closely.
#[derive(Clone, Debug)]
pub struct CostSettings {
    /// Of meshes: all in one unit, none twice, in any order; none for no meshes.
    pub tolerances: Vec<Tolerance>,
    /// Pictures by rays, if there are to be any.
    pub rays: Option<RaySettings>,
    /// How often each tolerance and each number of rays is carried out; times are medians.
    pub repeats: NonZeroUsize,
    /// What would take more triangles is predicted, and not made.
    pub max_triangles: u64,
    /// At about how many random places the error of each tolerance is measured.
    pub samples: NonZeroUsize,
    /// Uniform subdivision is counted, and not carried out, where it makes more triangles.
    pub max_uniform_triangles: u64,
}

impl Default for CostSettings {
    /// Meshes alone, from a tenth to a millionth of the diagonal.
    fn default() -> Self {
        let fraction = |number| Tolerance::relative(number).expect("finite and positive");
        let tolerances = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
        Self {
            tolerances: tolerances.map(fraction).to_vec(),
            rays: None,
            repeats: NonZeroUsize::MIN.saturating_add(2),
            max_triangles: 3_000_000,
            samples: NonZeroUsize::MIN.saturating_add(199_999),
            max_uniform_triangles: 2_000_000,
        }
    }
}

impl CostSettings {
    /// How many runs, measurements and pictures [`CostStudy::new`] does.
    pub fn pieces(&self) -> usize {
        let repeats = self.repeats.get();
        let rays = self.rays.as_ref();
        self.tolerances.len() * (repeats + mesh_cost::MEASUREMENTS)
            + rays.map_or(0, |rays| rays.pieces(repeats))
    }
}

/// What accuracy costs in one scene.
///
/// # Example
///
/// ```
/// use photosurface::{CostSettings, CostStudy, Scene, Tolerance, load_models};
///
/// let scene = Scene::from_json(
///     r#"{ "observer": { "velocity": { "beta": 0.8 } },
///          "objects": [ { "name": "box", "shape": { "box": { "size": [1, 1, 1] } }, "position": [0, 0, -2] } ] }"#,
/// )?;
/// let (models, _) = load_models(&scene, ".".as_ref())?;
/// let settings = CostSettings {
///     tolerances: vec![Tolerance::relative(1e-2)?, Tolerance::relative(1e-3)?],
///     ..CostSettings::default()
/// };
/// let study = CostStudy::new(&scene, &models, &settings, &())?;
/// for cost in &study.meshes {
///     let made = cost.made.as_ref().expect("few triangles");
///     assert!(made.error <= made.bound && made.bound <= cost.tolerance);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CostStudy {
    /// The scene.
    pub scene: SceneFacts,
    /// Of tolerances; `None` without meshes.
    pub unit: Option<Unit>,
    /// How many threads there were.
    pub threads: usize,
    /// How often each tolerance and each number of rays was carried out.
    pub repeats: usize,
    /// Places at which each error of meshes was measured.
    pub samples: usize,
    /// Of photosurfaces as meshes, the loosest tolerance first.
    pub meshes: Vec<MeshCost>,
    /// Which pictures were made by rays, if any were.
    pub pictures: Option<Pictures>,
    /// Of these pictures, the fewest rays first.
    pub rays: Vec<RayCost>,
}

/// Why there is nothing to study.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// No tolerance, and no number of rays.
    #[error("nothing to study, expected at least one tolerance or number of rays a pixel")]
    Nothing,
    /// One number of rays twice.
    #[error("{0} rays along each side of a pixel are there twice, expected each number once")]
    RepeatedSamples(u32),
    /// One tolerance twice.
    #[error("the tolerance {0} is there twice, expected each once")]
    Repeated(Tolerance),
    /// Tolerances that cannot be put in order.
    #[error("the tolerances {0} and {1} differ in their units, expected one unit for all")]
    MixedUnits(Tolerance, Tolerance),
    /// Not one model for each object, or one that is nowhere.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
    /// Not one camera for each step.
    #[error("there are {cameras} cameras for {steps} steps, expected one for each")]
    Cameras {
        /// How many steps the scene has.
        steps: usize,
        /// How many cameras there are.
        cameras: usize,
    },
    /// Photosurfaces that no file can hold, or a file that cannot be written.
    #[error("at the tolerance {tolerance}")]
    Export {
        /// Which.
        tolerance: Tolerance,
        /// Why.
        source: ExportError,
    },
    /// The caller ended the study.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CostStudy {
    /// Studies a scene with one model for each object; the pieces of work that `progress` hears of are runs, measurements and
    /// pictures, [`CostSettings::pieces`] in all.
    ///
    /// # Errors
    ///
    /// Nothing to study; one tolerance or number of rays twice, or tolerances of several units; photosurfaces that do
    /// not make a file; not as many models as objects, or for pictures not as many cameras as steps.
    pub fn new(
        scene: &Scene,
        models: &[Model],
        settings: &CostSettings,
        progress: &dyn Progress,
    ) -> Result<Self, StudyError> {
        let tolerances = in_order(&settings.tolerances)?;
        let rays = settings.rays.as_ref();
        let samples = rays.map_or(Ok(vec![]), |rays| rising(&rays.samples))?;
        if tolerances.is_empty() && samples.is_empty() {
            return Err(StudyError::Nothing);
        }
        let steps = scene.steps().len();
        if let Some(cameras) = rays.map(|rays| rays.cameras.len()).filter(|&n| n != steps) {
            return Err(StudyError::Cameras { steps, cameras });
        }
        progress.begin(settings.pieces());
        let unit = tolerances.first().map(|first| first.unit());
        // From loose to tight, so that what an allocator keeps of one says little of the next one's memory.
        let mut meshes = Vec::with_capacity(tolerances.len());
        for tolerance in tolerances {
            let cost = mesh_cost::mesh_cost(scene, models, tolerance, settings, progress)?;
            meshes.push(cost);
        }
        let placed = PlacedScene::new(scene.clone(), models.to_vec())?;
        let (pictures, rays) = match rays {
            Some(rays) if !samples.is_empty() => {
                let repeats = settings.repeats.get();
                let (pictures, rays) =
                    ray_cost::ray_costs(&placed, rays, &samples, repeats, progress)?;
                (Some(pictures), rays)
            }
            _ => (None, vec![]),
        };
        Ok(Self {
            scene: placed.facts(),
            unit,
            threads: rayon::current_num_threads(),
            repeats: settings.repeats.get(),
            samples: settings.samples.get(),
            meshes,
            pictures,
            rays,
        })
    }

    /// The study as JSON text.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a study is names and numbers")
    }
}

/// The loosest first.
fn in_order(tolerances: &[Tolerance]) -> Result<Vec<Tolerance>, StudyError> {
    let mut sorted = tolerances.to_vec();
    sorted.sort_by(|a, b| b.number().total_cmp(&a.number()));
    for pair in sorted.windows(2) {
        if pair[0].unit() != pair[1].unit() {
            return Err(StudyError::MixedUnits(pair[0], pair[1]));
        }
        if pair[0] == pair[1] {
            return Err(StudyError::Repeated(pair[0]));
        }
    }
    Ok(sorted)
}

/// The fewest first.
fn rising(samples: &[NonZeroU32]) -> Result<Vec<u32>, StudyError> {
    let mut sorted: Vec<u32> = samples.iter().map(|samples| samples.get()).collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(StudyError::RepeatedSamples(pair[0])),
        None => Ok(sorted),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::render::{Camera, PictureSize, Projection};

    #[test]
    fn all_pieces_are_done_whether_carried_out_or_not() {
        let scene = r#"{ "observer": { "velocity": { "beta": 0.8 } },
            "objects": [ { "name": "box", "shape": { "box": { "size": [1, 1, 1] } }, "position": [0, 0, -2] } ] }"#;
        let scene = Scene::from_json(scene).unwrap();
        let (models, _) = crate::jobs::load_models(&scene, ".".as_ref()).unwrap();
        let settings = CostSettings {
            tolerances: [1e-1, 1e-9]
                .map(|number| Tolerance::relative(number).unwrap())
                .to_vec(),
            max_triangles: 1000,
            samples: NonZeroUsize::MIN,
            ..CostSettings::default()
        };
        let counted = Counted::default();
        let study = CostStudy::new(&scene, &models, &settings, &counted).unwrap();
        assert!(study.meshes[0].made.is_some() && study.meshes[1].made.is_none());
        let [begun, done] = [counted.begun, counted.done].map(AtomicUsize::into_inner);
        assert_eq!((begun, done, settings.pieces()), (10, 10, 10));
    }

    /// Hears how many pieces there are, and how many are done; ends the work after so many.
    #[derive(Default)]
    struct Counted {
        begun: AtomicUsize,
        done: AtomicUsize,
        last: Option<usize>,
    }

    impl Progress for Counted {
        fn begin(&self, pieces: usize) {
            self.begun.store(pieces, Ordering::Relaxed);
        }

        fn advance(&self, pieces: usize) -> Result<(), Cancelled> {
            let before = self.done.fetch_add(pieces, Ordering::Relaxed);
            match self.last {
                Some(last) if before + pieces > last => Err(Cancelled),
                _ => Ok(()),
            }
        }
    }

    #[test]
    fn a_study_ends_where_its_caller_says_so() {
        let text = r#"{ "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] } ] }"#;
        let scene = Scene::from_json(text).unwrap();
        let (models, _) = crate::jobs::load_models(&scene, ".".as_ref()).unwrap();
        let size = PictureSize::new(8, 8).unwrap();
        let camera = Camera::new(size, Projection::FullSky, glam::DVec3::NEG_Z).unwrap();
        let settings = CostSettings {
            tolerances: vec![Tolerance::relative(0.1).unwrap()],
            rays: Some(RaySettings::new(vec![camera])),
            samples: NonZeroUsize::MIN,
            ..CostSettings::default()
        };
        for last in 0..settings.pieces() {
            let counted = Counted {
                last: Some(last),
                ..Counted::default()
            };
            let ended = CostStudy::new(&scene, &models, &settings, &counted);
            assert!(matches!(ended, Err(StudyError::Cancelled(_))), "{last}");
            assert_eq!(counted.done.into_inner(), last + 1);
        }
        CostStudy::new(&scene, &models, &settings, &()).unwrap();
    }

    #[test]
    fn what_does_not_fit_the_scene_is_refused() {
        let text =
            r#"{ "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } } } ] }"#;
        let scene = Scene::from_json(text).unwrap();
        let (models, _) = crate::jobs::load_models(&scene, ".".as_ref()).unwrap();
        let study = |models: &[Model], rays| {
            let settings = CostSettings {
                rays,
                ..CostSettings::default()
            };
            CostStudy::new(&scene, models, &settings, &())
                .unwrap_err()
                .to_string()
        };
        let of_models = study(&[], None);
        assert!(of_models.contains("0 models for 1 objects"), "{of_models}");
        let of_cameras = study(&models, Some(RaySettings::new(vec![])));
        assert!(of_cameras.contains("0 cameras for 1 steps"), "{of_cameras}");
    }

    #[test]
    fn tolerances_are_put_in_order_or_refused() {
        let relative = |number| Tolerance::relative(number).unwrap();
        let absolute = |number| Tolerance::absolute(number).unwrap();
        let sorted = in_order(&[1e-3, 1e-1, 1e-2].map(relative)).unwrap();
        assert_eq!(sorted, [1e-1, 1e-2, 1e-3].map(relative));
        let error = |tolerances: &[Tolerance]| in_order(tolerances).unwrap_err().to_string();
        assert!(error(&[absolute(1.0), relative(0.5)]).contains("abs:1.000e0 and 5.000e-1"));
        assert!(error(&[absolute(1.0), absolute(1.0)]).contains("abs:1.000e0 is there twice"));
    }
}
