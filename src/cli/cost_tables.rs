//! Tables of what accuracy costs: for people, and as CSV.

use std::io::Write;

use photosurface::CostStudy;
use photosurface::scene::Unit;
use photosurface::study::{IntegratorCost, IntegratorStudy, MeshCost, Method, RayCost};

use super::accuracy::grouped_number;
use super::messages::{counted, grouped, size};
use super::tables::{csv, table};

const MESH_HEADINGS: [&str; 13] = [
    "tolerance",
    "predicted",
    "triangles",
    "least",
    "ratio",
    "uniform",
    "bound",
    "error",
    "size",
    "predict s",
    "surface s",
    "write s",
    "memory",
];

const RAY_HEADINGS: [&str; 7] = [
    "rays per pixel",
    "rays",
    "error",
    "+-",
    "largest",
    "seconds",
    "rays/s",
];

const INTEGRATOR_HEADINGS: [&str; 8] = [
    "integrator",
    "steps",
    "step",
    "seconds",
    "event error",
    "relative",
    "order",
    "axes error",
];

/// A table of meshes and one of pictures, as far as they were studied, and what the numbers are.
pub(super) fn tables_of(study: &CostStudy, out: &mut dyn Write) -> anyhow::Result<()> {
    let times = format!(
        "times are medians of {}, {}",
        counted(study.repeats, "run"),
        counted(study.threads, "thread"),
    );
    if let Some(unit) = study.unit {
        table(MESH_HEADINGS, study.meshes.iter().map(mesh_cells), out)?;
        let unit = match unit {
            Unit::Relative => "relative to the diagonal of each photosurface",
            Unit::Absolute => "lengths",
            Unit::Degrees => "degrees",
        };
        writeln!(
            out,
            "tolerance (asked), bound (proven) and error (measured) are {unit}; {times}"
        )?;
    }
    let Some(pictures) = &study.pictures else {
        return Ok(());
    };
    if study.unit.is_some() {
        writeln!(out)?;
    }
    table(RAY_HEADINGS, study.rays.iter().map(ray_cells), out)?;
    writeln!(
        out,
        "{} of {} x {} pixels; error (measured, root mean square, with its standard deviation) and largest error of a \
         pixel are of linear light, white being 1, against {} random rays per pixel, themselves off by {:.1e}; {times}",
        counted(pictures.count, "picture"),
        pictures.width,
        pictures.height,
        grouped(pictures.reference_samples_per_pixel as usize),
        pictures.reference_error,
    )?;
    Ok(())
}

/// A table of integrators, and what the numbers are.
pub(super) fn table_of_integrators(
    study: &IntegratorStudy,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let cells = |cost| integrator_cells(study, cost);
    table(INTEGRATOR_HEADINGS, study.rows.iter().map(cells), out)?;
    writeln!(
        out,
        "errors (measured) are those at the end of the flight ({}, {} of proper time, there gamma {:.4}), in the scene \
         frame: of the event a length, in time and space alike, and relative to the displacement, {:.4} long; of velocity \
         and axes the largest of their components, over gamma; order is the power of the step with which the error of the \
         event falls, where it is not rounding; the reference is off by {:.0e} and {:.0e}, by its own estimate; times are \
         medians of {}",
        counted(study.segments, "segment"),
        study.proper_time,
        study.gamma,
        length(&study.displacement),
        study.event_uncertainty,
        study.axes_uncertainty,
        counted(study.repeats, "measurement"),
    )?;
    Ok(())
}

fn length(components: &[f64]) -> f64 {
    components.iter().fold(0.0, |sum, x| x.hypot(sum))
}

/// One tolerance.
fn mesh_cells(cost: &MeshCost) -> [String; MESH_HEADINGS.len()] {
    let mut cells: [String; MESH_HEADINGS.len()] = std::array::from_fn(|_| "-".to_owned());
    cells[0] = format!("{:.0e}", cost.tolerance);
    if cells[0].parse() != Ok(cost.tolerance) {
        cells[0] = format!("{:.3e}", cost.tolerance);
    }
    cells[1] = grouped_number(cost.predicted_triangles);
    let Some(made) = &cost.made else {
        return cells;
    };
    cells[2] = grouped(made.triangles);
    cells[3] = grouped_number(made.minimum_with_source);
    cells[4] = format!("{:.2}", made.ratio);
    cells[5] = grouped_number(made.uniform.triangles);
    cells[6] = format!("{:.2e}", made.bound);
    cells[7] = format!("{:.2e}", made.error);
    cells[8] = size(made.file_bytes);
    let seconds = [
        made.seconds.predict,
        made.seconds.photosurface,
        made.seconds.write,
    ];
    for (cell, seconds) in cells[9..].iter_mut().zip(seconds) {
        *cell = format!("{seconds:.4}");
    }
    if let Some(bytes) = made.peak_memory_bytes {
        cells[12] = size(bytes);
    }
    cells
}

/// One number of rays.
fn ray_cells(cost: &RayCost) -> [String; RAY_HEADINGS.len()] {
    [
        grouped(cost.samples_per_pixel as usize),
        grouped(cost.rays as usize),
        format!("{:.2e}", cost.error),
        format!("{:.0e}", cost.error_uncertainty),
        format!("{:.2e}", cost.largest_error),
        format!("{:.4}", cost.seconds),
        format!("{:.2e}", cost.rays_per_second),
    ]
}

/// One integrator with one number of steps.
fn integrator_cells(
    study: &IntegratorStudy,
    cost: &IntegratorCost,
) -> [String; INTEGRATOR_HEADINGS.len()] {
    let mut cells: [String; INTEGRATOR_HEADINGS.len()] = std::array::from_fn(|_| "-".to_owned());
    let name = match cost.method {
        Method::Exact => "exact",
        Method::Euler => "Euler",
        Method::Rk4 => "RK4",
    };
    cells[0] = name.to_owned();
    if let (Some(steps), Some(step)) = (cost.steps, cost.step) {
        cells[1] = grouped(steps);
        cells[2] = format!("{step:.2e}");
    }
    let Some(run) = &cost.run else {
        return cells;
    };
    cells[3] = format!("{:.1e}", run.seconds);
    let size = length(&study.displacement);
    cells[4] = error(run.event_error, study.event_uncertainty);
    cells[5] = error(run.relative_error, study.event_uncertainty / size);
    if let Some(order) = run.order {
        cells[6] = format!("{order:.2}");
    }
    cells[7] = error(run.axes_error, study.axes_uncertainty);
    cells
}

/// An error, or the least one that its reference can tell.
fn error(error: f64, uncertainty: f64) -> String {
    match error > uncertainty {
        true => format!("{error:.2e}"),
        false => format!("<{uncertainty:.0e}"),
    }
}

/// Columns of the CSV of meshes, and where their numbers stand in the JSON of a tolerance.
const MESH_COLUMNS: [(&str, &str); 23] = [
    ("tolerance", "/tolerance"),
    ("predicted_triangles", "/predicted_triangles"),
    ("reachable", "/reachable"),
    ("triangles", "/made/triangles"),
    ("triangles_in", "/made/triangles_in"),
    ("minimum_triangles", "/made/minimum_triangles"),
    ("minimum_with_source", "/made/minimum_with_source"),
    ("ratio", "/made/ratio"),
    ("file_bytes", "/made/file_bytes"),
    ("predict_seconds", "/made/seconds/predict"),
    ("photosurface_seconds", "/made/seconds/photosurface"),
    ("write_seconds", "/made/seconds/write"),
    ("peak_memory_bytes", "/made/peak_memory_bytes"),
    ("certified", "/made/certified"),
    ("gap", "/made/gap"),
    ("bound", "/made/bound"),
    ("bound_length", "/made/bound_length"),
    ("error", "/made/error"),
    ("error_length", "/made/error_length"),
    ("error_over_bound", "/made/error_over_bound"),
    ("uniform_levels", "/made/uniform/levels"),
    ("uniform_triangles", "/made/uniform/triangles"),
    ("uniform_gap_length", "/made/uniform/run/gap"),
];

const RAY_COLUMNS: [(&str, &str); 8] = [
    ("samples", "/samples"),
    ("samples_per_pixel", "/samples_per_pixel"),
    ("rays", "/rays"),
    ("seconds", "/seconds"),
    ("rays_per_second", "/rays_per_second"),
    ("error", "/error"),
    ("error_uncertainty", "/error_uncertainty"),
    ("largest_error", "/largest_error"),
];

const INTEGRATOR_COLUMNS: [(&str, &str); 10] = [
    ("method", "/method"),
    ("steps", "/steps"),
    ("step", "/step"),
    ("seconds", "/run/seconds"),
    ("time_error", "/run/time_error"),
    ("position_error", "/run/position_error"),
    ("event_error", "/run/event_error"),
    ("relative_error", "/run/relative_error"),
    ("axes_error", "/run/axes_error"),
    ("order", "/run/order"),
];

pub(super) fn csv_of_meshes(meshes: &[MeshCost]) -> String {
    csv(MESH_COLUMNS, meshes)
}

pub(super) fn csv_of_rays(rays: &[RayCost]) -> String {
    csv(RAY_COLUMNS, rays)
}

pub(super) fn csv_of_integrators(rows: &[IntegratorCost]) -> String {
    csv(INTEGRATOR_COLUMNS, rows)
}
