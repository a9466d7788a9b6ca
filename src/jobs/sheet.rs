//! All steps of a scene side by side in one picture.

use glam::DVec3;

use super::guides::label;
use super::pictures::RenderError;
use super::views::Views;
use crate::render::{CameraError, Picture, PictureSize};
use crate::shape::Color;

/// Pixels between the views of a sheet.
const GAP: u32 = 4;

/// The size of a sheet of so many steps, with two views of `size` for each.
pub(super) fn sheet_size(size: PictureSize, steps: usize) -> Result<PictureSize, CameraError> {
    let columns = (steps as u64).saturating_mul(u64::from(size.width() + GAP));
    let width = columns.saturating_sub(u64::from(GAP));
    PictureSize::new(
        u32::try_from(width).unwrap_or(u32::MAX),
        2 * size.height() + GAP,
    )
}

/// For each step what the observer sees and, below, the photosurface from outside, framed by a camera at one distance or
/// at the place `from`.
pub(super) fn draw_sheet(views: &mut Views, from: Option<DVec3>) -> Result<Picture, RenderError> {
    let (scene, settings) = (views.placed.scene(), views.settings);
    let (size, background) = (settings.camera.size, settings.background);
    let steps = scene.steps().len();
    let of_sheet =
        sheet_size(size, steps).map_err(|source| RenderError::Sheet { steps, source })?;
    let mut sheet = Picture::filled(of_sheet, between(background));
    let fov = views.observer_fov_deg()?;
    let cameras = views.outside_cameras(from)?;
    for (step, camera) in cameras.iter().enumerate() {
        let mut above = views.observer(step, fov)?;
        label(
            &mut above,
            &format!("τ = {}", scene.steps()[step]),
            background,
        );
        let below = views.outside(step..step + 1, camera)?;
        let x = step as u32 * (size.width() + GAP);
        sheet.paste(&above, x, 0);
        sheet.paste(&below, x, size.height() + GAP);
    }
    Ok(sheet)
}

/// The colour between the views of a sheet: halfway from the background to grey.
fn between(background: Color) -> Color {
    Color(background.0.map(|level| level / 2 + 0x40))
}
