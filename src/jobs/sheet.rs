//! The sheet of all steps of a scene.

use glam::DVec3;

use super::grid::{Grid, grid_size};
use super::guides::label;
use super::rendered::RenderError;
use super::views::Views;
use crate::render::Picture;

/// Draws for each step the observer's view and, below it, the photosurface from outside. The cameras outside all have
/// the same distance, or the position `from`.
pub(super) fn draw_sheet(views: &mut Views, from: Option<DVec3>) -> Result<Picture, RenderError> {
    let (scene, settings) = (views.placed.scene(), views.settings);
    let steps = scene.steps().len();
    let size = grid_size(settings.camera.size, steps, 2);
    let size = size.map_err(|source| RenderError::Sheet { steps, source })?;
    let mut grid = Grid::new(size, settings.camera.size, settings.background);
    let fov = views.observer_fov_deg()?;
    let cameras = views.outside_cameras(from)?;
    for (step, camera) in cameras.iter().enumerate() {
        let mut above = views.observer(step, fov)?;
        label(
            &mut above,
            &label_of(scene.steps()[step]),
            settings.background,
        );
        let mut below = views.outside(step..step + 1, camera)?;
        if step + 1 == steps {
            views.draw_legend(&mut below);
        }
        grid.place(&above, step, 0);
        grid.place(&below, step, 1);
    }
    Ok(grid.picture)
}

/// The label of a step at a proper time of the observer.
pub(super) fn label_of(proper_time: f64) -> String {
    format!("τ = {}", short(proper_time))
}

/// A number in at most six digits, if it has more.
fn short(number: f64) -> f64 {
    match number.to_string().len() {
        ..=8 => number,
        _ => format!("{number:.5e}").parse().unwrap_or(number),
    }
}
