//! One tolerance of the study: photosurfaces made and written, timed, proven and measured.

use std::fs;

use serde::Serialize;

use super::measured::{Measured, measure};
use super::median::median;
use super::memory::{peak_bytes, restart_peak};
use super::settings::MEASUREMENTS;
use super::uniform::{UniformCost, uniform_cost};
use super::{CostSettings, StudyError};
use crate::jobs::{
    Cancelled, ExportError, ExportLevel, ExportSettings, OutputError, Progress, export_levels,
};
use crate::material::Model;
use crate::pipeline::{Facts, PlacedScene};
use crate::scene::{Scene, Tolerance, Unit};
use crate::write::{Format, ScratchFolder, WriteError};

/// What one tolerance costs, all photosurfaces of all steps together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshCost {
    /// Asked for: in the unit that the study says.
    pub tolerance: f64,
    /// About how many triangles were predicted.
    pub predicted_triangles: f64,
    /// Whether it was predicted that the tolerance can be kept.
    pub reachable: bool,
    /// What came out; `None` where more triangles were predicted than the study may make.
    pub made: Option<Made>,
}

/// What came out for one tolerance.
///
/// `gap`, `bound` and `error` are of the photosurface that is worst against its own tolerance, in the unit of the
/// tolerance: that of a relative one is the diagonal of the photosurface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Made {
    /// Of all photosurfaces.
    pub triangles: usize,
    /// Of the meshes at rest before refinement, those of round shapes as fine as their curvature asks for.
    pub triangles_in: usize,
    /// The fewest triangles that theory allows for any mesh, the sum of all certificates.
    pub minimum_triangles: f64,
    /// The fewest with at least one for each triangle of the source, the sum of all certificates.
    pub minimum_with_source: f64,
    /// `triangles / minimum_with_source`
    pub ratio: f64,
    /// Of the GLB with all of them, in bytes.
    pub file_bytes: u64,
    /// How long it took.
    pub seconds: Seconds,
    /// The most memory that the process had in use while it predicted, made and wrote for the first time, in bytes;
    /// with the memory in use before. `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// Proven: whether all are within the tolerance.
    pub certified: bool,
    /// Proven: the bound of the gap of the measure alone, without curvature and rounding.
    pub gap: f64,
    /// Proven: the whole bound.
    pub bound: f64,
    /// Proven: the largest bound, as a length in the observer's frame; `None` where tolerances are angles.
    pub bound_length: Option<f64>,
    /// Measured at random places, before the rounding of the file.
    pub error: f64,
    /// Measured: the largest error, as a length in the observer's frame.
    pub error_length: f64,
    /// Measured over proven, of the photosurface where that is largest: at most 1.
    pub error_over_bound: f64,
    /// What uniform subdivision would take for the same.
    pub uniform: UniformCost,
}

/// How long each stage took, by the wall clock: medians of all repeats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Seconds {
    /// To predict the triangles.
    pub predict: f64,
    /// To refine, map and prove.
    pub photosurface: f64,
    /// To write the GLB, to a file of its own in the folder for temporary files.
    pub write: f64,
}

impl Seconds {
    /// All stages.
    pub fn total(&self) -> f64 {
        self.predict + self.photosurface + self.write
    }
}

/// An export may make so many times the triangles that were predicted before its budget ends it.
const PREDICTION_ROOM: u64 = 2;

/// Studies one tolerance; `progress` advances by one after each run and each measurement.
pub(super) fn mesh_cost(
    scene: &Scene,
    models: &[Model],
    tolerance: Tolerance,
    settings: &CostSettings,
    progress: &dyn Progress,
) -> Result<MeshCost, StudyError> {
    let placed = PlacedScene::new(
        scene.clone().with_tolerance_for_all(tolerance),
        models.to_vec(),
    )?;
    let wanted = Format::Glb.surface_options(placed.scene());
    let number = tolerance.number();
    let predictions = placed.predictions(wanted);
    let predicted_triangles: f64 = predictions.iter().map(|p| p.triangles).sum();
    let mut cost = MeshCost {
        tolerance: number,
        predicted_triangles,
        reachable: predictions.iter().all(|prediction| prediction.reachable),
        made: None,
    };
    if predicted_triangles > settings.max_triangles as f64 {
        progress.advance(settings.repeats.get() + MEASUREMENTS)?;
        return Ok(cost);
    }
    let wrong = |source| StudyError::Export { tolerance, source };
    let max_triangles = settings.max_triangles.saturating_mul(PREDICTION_ROOM);
    let export = RepeatedExport::new(&placed, max_triangles).map_err(wrong)?;
    let counts_memory = restart_peak();
    let first = export.run(progress).map_err(wrong)?;
    let peak_memory_bytes = counts_memory.then(peak_bytes).flatten();
    progress.advance(1)?;
    let mut times = vec![first.seconds];
    for _ in 1..settings.repeats.get() {
        times.push(export.run(progress).map_err(wrong)?.seconds);
        progress.advance(1)?;
    }
    let placed = first.placed;
    let certificates = || first.facts.iter().map(|facts| &facts.certificate);
    let triangles = certificates().map(|c| c.triangles_out).sum();
    let minimum_triangles: f64 = certificates().map(|c| c.minimum_triangles).sum();
    let minimum_with_source: f64 = certificates().map(|c| c.minimum_with_source).sum();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let Measured {
        length,
        of_tolerance,
        of_bound,
    } = measure(&placed, wanted, triangles, settings.samples.get());
    progress.advance(1)?;
    let uniform = uniform_cost(
        &placed,
        wanted,
        settings.max_uniform_triangles,
        settings.samples.get(),
    );
    progress.advance(1)?;
    cost.made = Some(Made {
        triangles,
        triangles_in: certificates().map(|c| c.triangles_in).sum(),
        minimum_triangles,
        minimum_with_source,
        ratio: triangles as f64 / minimum_with_source,
        file_bytes: first.bytes,
        seconds: medians(&times),
        peak_memory_bytes,
        certified: certificates().all(|c| c.complete),
        gap: number * largest(&mut certificates().map(|c| c.measured_gap() / c.tolerance)),
        bound: number * largest(&mut certificates().map(|c| c.total / c.tolerance)),
        bound_length: match tolerance.unit() {
            Unit::Degrees => None,
            _ => Some(largest(&mut certificates().map(|c| c.total))),
        },
        error: number * of_tolerance,
        error_length: length,
        error_over_bound: of_bound,
        uniform,
    });
    Ok(cost)
}

/// The export of a placed scene to a GLB, again and again, in a folder of its own.
struct RepeatedExport {
    level: ExportLevel,
    folder: ScratchFolder,
}

/// What one run gives, without the photosurfaces.
struct Run {
    placed: PlacedScene,
    seconds: Seconds,
    facts: Vec<Facts>,
    bytes: u64,
}

impl RepeatedExport {
    fn new(placed: &PlacedScene, max_triangles: u64) -> Result<Self, ExportError> {
        let folder = ScratchFolder::new().map_err(OutputError::from)?;
        let settings = ExportSettings {
            max_triangles,
            ..ExportSettings::default()
        };
        let path = folder.path().join("study.glb");
        let mut levels = export_levels(placed, &settings, Format::Glb, &path)?;
        Ok(Self {
            level: levels.swap_remove(0),
            folder,
        })
    }

    fn run(&self, progress: &dyn Progress) -> Result<Run, ExportError> {
        self.level.check()?;
        let fitted = self.level.clone().fit();
        let within = fitted.fitted();
        let placed = within.map_or(self.level.placed(), |within| &within.placed);
        let placed = placed.clone();
        let exported = fitted.write(&Heard(progress), |_| Ok(()))?;
        let bytes = fs::metadata(&exported.files[0]).map(|file| file.len());
        let in_folder = |source| ExportError::of_file(self.folder.path(), source);
        let bytes = bytes.map_err(|source| in_folder(WriteError::Stream(source)))?;
        let seconds = |name: &str| {
            let stages = exported.report.stages.iter();
            let of_name = stages.filter(|stage| stage.name == name);
            of_name.map(|stage| stage.seconds).sum()
        };
        Ok(Run {
            placed,
            seconds: Seconds {
                predict: seconds("predict"),
                photosurface: seconds("photosurface"),
                write: seconds("write"),
            },
            facts: exported.report.objects,
            bytes,
        })
    }
}

/// The caller of the study, who hears nothing of the pieces of an export and may end it all the same.
struct Heard<'a>(&'a dyn Progress);

impl Progress for Heard<'_> {
    fn begin(&self, _: usize) {}

    fn advance(&self, _: usize) -> Result<(), Cancelled> {
        self.0.advance(0)
    }
}

fn medians(times: &[Seconds]) -> Seconds {
    let median = |of: fn(&Seconds) -> f64| median(times.iter().map(of).collect());
    Seconds {
        predict: median(|times| times.predict),
        photosurface: median(|times| times.photosurface),
        write: median(|times| times.write),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stage_has_a_median_of_its_own() {
        let seconds = |predict, photosurface, write| Seconds {
            predict,
            photosurface,
            write,
        };
        let times = [
            seconds(3.0, 1.0, 5.0),
            seconds(1.0, 2.0, 9.0),
            seconds(2.0, 7.0, 4.0),
        ];
        assert_eq!(medians(&times), seconds(2.0, 2.0, 5.0));
        assert_eq!(medians(&times[..2]), seconds(2.0, 1.5, 7.0));
        assert_eq!(medians(&times).total(), 9.0);
    }
}
