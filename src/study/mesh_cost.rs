//! One tolerance of the study: photosurfaces made and written, timed, proven and measured.

use std::hint::black_box;
use std::io::{self, Write};
use std::time::Instant;

use serde::Serialize;

use super::measured::{Measured, measure};
use super::memory::{peak_bytes, restart_peak};
use super::uniform::{UniformCost, uniform_cost};
use super::{CostSettings, StudyError};
use crate::material::Model;
use crate::pipeline::{Facts, Photosurface, PlacedScene, SurfaceOptions};
use crate::scene::{Scene, Tolerance, Unit};
use crate::tessellate::Precision;
use crate::write::{Export, Format, write_glb};

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
    /// The fewest triangles that theory allows, the sum of all certificates.
    pub minimum_triangles: f64,
    /// `triangles / minimum_triangles`
    pub ratio: f64,
    /// Of the GLB with all of them, in bytes.
    pub file_bytes: u64,
    /// How long it took.
    pub seconds: Seconds,
    /// The most memory that the process had in use while it predicted, made and wrote for the first time, in bytes;
    /// with what was in use before. `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// Proven: whether all are within the tolerance.
    pub certified: bool,
    /// Proven: the bound of the gap alone, without curvature and rounding.
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
    /// To write the GLB, to nowhere.
    pub write: f64,
}

impl Seconds {
    /// All stages.
    pub fn total(&self) -> f64 {
        self.predict + self.photosurface + self.write
    }
}

/// What is measured of each tolerance beside its runs: the error, and uniform subdivision.
pub(super) const MEASUREMENTS: usize = 2;

/// Studies one tolerance; `done` is called after each run and each measurement.
pub(super) fn mesh_cost(
    scene: &Scene,
    models: &[Model],
    tolerance: Tolerance,
    settings: &CostSettings,
    mut done: impl FnMut(),
) -> Result<MeshCost, StudyError> {
    let placed = PlacedScene::new(
        scene.clone().with_tolerance_for_all(tolerance),
        models.to_vec(),
    )?;
    let wanted = SurfaceOptions {
        attributes: Format::Glb.attributes(placed.scene()),
        subdivide: true,
        precision: Precision::Single,
    };
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
        (0..settings.repeats.get() + MEASUREMENTS).for_each(|_| done());
        return Ok(cost);
    }
    let placed = placed.granting(wanted, settings.max_triangles);
    let counts_memory = restart_peak();
    let first = run(&placed, wanted, tolerance)?;
    let peak_memory_bytes = counts_memory.then(peak_bytes).flatten();
    done();
    let mut times = vec![first.seconds];
    for _ in 1..settings.repeats.get() {
        times.push(run(&placed, wanted, tolerance)?.seconds);
        done();
    }
    let certificates = || first.facts.iter().map(|facts| &facts.certificate);
    let triangles = certificates().map(|c| c.triangles_out).sum();
    let minimum_triangles: f64 = certificates().map(|c| c.minimum_triangles).sum();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let Measured {
        length,
        of_tolerance,
        of_bound,
    } = measure(&placed, wanted, triangles, settings.samples.get());
    done();
    let uniform = uniform_cost(
        &placed,
        wanted,
        settings.max_uniform_triangles,
        settings.samples.get(),
    );
    done();
    cost.made = Some(Made {
        triangles,
        triangles_in: certificates().map(|c| c.triangles_in).sum(),
        minimum_triangles,
        ratio: triangles as f64 / minimum_triangles,
        file_bytes: first.bytes,
        seconds: medians(&times),
        peak_memory_bytes,
        certified: certificates().all(|c| c.complete),
        gap: number * largest(&mut certificates().map(|c| c.gap / c.tolerance)),
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

/// What one run gives, without the photosurfaces.
struct Run {
    seconds: Seconds,
    facts: Vec<Facts>,
    bytes: u64,
}

/// Predicts, makes and writes all photosurfaces of a placed scene, as an export does.
fn run(
    placed: &PlacedScene,
    wanted: SurfaceOptions,
    tolerance: Tolerance,
) -> Result<Run, StudyError> {
    let start = Instant::now();
    black_box(placed.predictions(wanted));
    let predict = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut photosurfaces: Vec<Photosurface> = vec![];
    for step in 0..placed.scene().steps().len() {
        photosurfaces.extend(placed.photosurfaces(step, wanted)?);
    }
    let photosurface = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut sink = Counting(0);
    let export = Export {
        scene: &placed.facts(),
        marker: placed.marker(),
        photosurfaces: &photosurfaces,
        playback: None,
    };
    write_glb(&export, &mut sink).map_err(|source| StudyError::Write { tolerance, source })?;
    let write = start.elapsed().as_secs_f64();
    Ok(Run {
        seconds: Seconds {
            predict,
            photosurface,
            write,
        },
        facts: photosurfaces.into_iter().map(|made| made.facts).collect(),
        bytes: sink.0,
    })
}

fn medians(times: &[Seconds]) -> Seconds {
    let median = |of: fn(&Seconds) -> f64| median(times.iter().map(of).collect());
    Seconds {
        predict: median(|times| times.predict),
        photosurface: median(|times| times.photosurface),
        write: median(|times| times.write),
    }
}

/// The one in the middle, or the mean of two.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        0 => 0.5 * (values[middle - 1] + values[middle]),
        _ => values[middle],
    }
}

/// Counts bytes and forgets them.
struct Counting(u64);

impl Write for Counting {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
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
