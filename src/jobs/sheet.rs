//! Several views in one picture: a grid, and the sheet of all steps of a scene.

use glam::DVec3;

use super::guides::label;
use super::picture_settings::PictureSettings;
use super::rendered::RenderError;
use super::views::Views;
use crate::render::{CameraError, Picture, PictureSize};
use crate::shape::Color;

/// Distance between the views of a grid, in pixels.
const GAP: u32 = 4;

/// The size of a grid of so many views of `size`.
pub(super) fn grid_size(
    size: PictureSize,
    columns: usize,
    rows: usize,
) -> Result<PictureSize, CameraError> {
    let along = |count: usize, pixels: u32| {
        let all = (count as u64).saturating_mul(u64::from(pixels + GAP));
        u32::try_from(all.saturating_sub(u64::from(GAP))).unwrap_or(u32::MAX)
    };
    PictureSize::new(along(columns, size.width()), along(rows, size.height()))
}

/// A picture of several views of one size, in columns and rows.
pub(super) struct Grid {
    pub(super) picture: Picture,
    size: PictureSize,
}

impl Grid {
    /// A picture of `size` pixels in which nothing stands yet.
    pub(super) fn new(size: PictureSize, settings: &PictureSettings) -> Self {
        Self {
            picture: Picture::filled(size, between(settings.background)),
            size: settings.camera.size,
        }
    }

    /// Places a view.
    pub(super) fn place(&mut self, view: &Picture, column: usize, row: usize) {
        let x = column as u32 * (self.size.width() + GAP);
        let y = row as u32 * (self.size.height() + GAP);
        self.picture.paste(view, x, y);
    }
}

/// Draws for each step the observer's view and, below it, the photosurface from outside. The cameras outside all have
/// the same distance, or the position `from`.
pub(super) fn draw_sheet(views: &mut Views, from: Option<DVec3>) -> Result<Picture, RenderError> {
    let (scene, settings) = (views.placed.scene(), views.settings);
    let steps = scene.steps().len();
    let size = grid_size(settings.camera.size, steps, 2);
    let size = size.map_err(|source| RenderError::Sheet { steps, source })?;
    let mut grid = Grid::new(size, settings);
    let fov = views.observer_fov_deg()?;
    let cameras = views.outside_cameras(from)?;
    for (step, camera) in cameras.iter().enumerate() {
        let mut above = views.observer(step, fov)?;
        label(
            &mut above,
            &label_of(scene.steps()[step]),
            settings.background,
        );
        let below = views.outside(step..step + 1, camera)?;
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

/// The colour between the views of a sheet: halfway from the background to grey.
fn between(background: Color) -> Color {
    Color(background.0.map(|level| level / 2 + 0x40))
}
