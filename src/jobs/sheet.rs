//! All steps of a scene side by side in one picture.

use glam::DVec3;

use super::guides::label;
use super::picture_settings::{GAP, sheet_size};
use super::rendered::RenderError;
use super::views::Views;
use crate::render::Picture;
use crate::shape::Color;

/// Draws for each step the observer's view and, below it, the photosurface from outside. The cameras outside all have
/// the same distance, or the position `from`.
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
            &format!("τ = {}", short(scene.steps()[step])),
            background,
        );
        let below = views.outside(step..step + 1, camera)?;
        let x = step as u32 * (size.width() + GAP);
        sheet.paste(&above, x, 0);
        sheet.paste(&below, x, size.height() + GAP);
    }
    Ok(sheet)
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
