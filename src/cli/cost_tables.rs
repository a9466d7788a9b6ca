//! Tables of what accuracy costs: for people, and as CSV.

use std::io::Write;

use photosurface::CostStudy;
use photosurface::scene::Unit;
use photosurface::study::{MeshCost, RayCost};

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
    cells[3] = grouped_number(made.minimum_triangles);
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

/// Columns of the CSV of meshes, and where their numbers stand in the JSON of a tolerance.
const MESH_COLUMNS: [(&str, &str); 22] = [
    ("tolerance", "/tolerance"),
    ("predicted_triangles", "/predicted_triangles"),
    ("reachable", "/reachable"),
    ("triangles", "/made/triangles"),
    ("triangles_in", "/made/triangles_in"),
    ("minimum_triangles", "/made/minimum_triangles"),
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

pub(super) fn csv_of_meshes(meshes: &[MeshCost]) -> String {
    csv(MESH_COLUMNS, meshes)
}

pub(super) fn csv_of_rays(rays: &[RayCost]) -> String {
    csv(RAY_COLUMNS, rays)
}
