//! A study: settings in, what each tolerance and each number of rays costs out.

use serde::Serialize;

use super::mesh_cost::mesh_cost;
use super::ray_cost::ray_costs;
use super::settings::{in_order, rising};
use super::{CostSettings, MeshCost, Pictures, RayCost, StudyError};
use crate::jobs::Progress;
use crate::material::Model;
use crate::pipeline::{PlacedScene, SceneFacts};
use crate::scene::{Scene, Unit};

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
            let cost = mesh_cost(scene, models, tolerance, settings, progress)?;
            meshes.push(cost);
        }
        let placed = PlacedScene::new(scene.clone(), models.to_vec())?;
        let (pictures, rays) = match rays {
            Some(rays) if !samples.is_empty() => {
                let repeats = settings.repeats.get();
                let (pictures, rays) = ray_costs(&placed, rays, &samples, repeats, progress)?;
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use std::num::NonZeroUsize;

    use super::super::RaySettings;
    use super::*;
    use crate::jobs::Cancelled;
    use crate::render::{Camera, PictureSize, Projection};
    use crate::scene::Tolerance;

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
}
