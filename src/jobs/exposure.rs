//! The exposure of pictures by the brightness of what they show.

use glam::{DVec2, DVec3};

use super::picture_settings::PictureView;
use super::rendered::RenderError;
use super::views::Views;
use crate::render::{Camera, Scenery, Viewpoint};
use crate::scene::{Exposure, Stops};

/// So many steps at most are looked at, with so many rays together.
const MAX_STEPS: usize = 24;
const RAYS: usize = 4096;

/// Of all rays that meet a surface this part is darker than [`BRIGHT`] after the exposure.
const PART: f64 = 0.95;

/// The luminance up to which a screen shows light as it is.
const BRIGHT: f64 = 0.8;

/// Finds the exposure of views whose scenes leave it to be found: one for all of them, so that they can be compared. Returns
/// that exposure.
///
/// Light is measured where the observer sees it. For views from outside, which show all of the photosurfaces, rays go in
/// the directions of vertices.
pub(super) fn expose(all: &mut [Views]) -> Result<Stops, RenderError> {
    let mut found = Vec::new();
    for views in all.iter().filter(|views| is_auto(views)) {
        let of_scene = views.with_all_at_rest(|scenery| luminances(views, scenery))?;
        found.extend(of_scene);
    }
    let stops = exposure(found);
    for views in all.iter_mut().filter(|views| is_auto(views)) {
        views.set_exposure(stops);
    }
    Ok(stops)
}

/// Whether a scene leaves its exposure to be found.
pub(super) fn is_auto(views: &Views) -> bool {
    views.placed.scene().effects().shown().exposure == Exposure::Auto
}

/// The luminances of surfaces that the observer sees.
fn luminances(views: &Views, scenery: &Scenery) -> Result<Vec<f64>, RenderError> {
    let steps = views.steps().end;
    let looked_at = steps.min(MAX_STEPS);
    let mut luminances = Vec::new();
    for number in 0..looked_at {
        // Evenly spread, the first and the last among them.
        let step = number * (steps - 1) / (looked_at - 1).max(1);
        let places = views.seen_vertices(step)?;
        let directions = match views.settings.view {
            PictureView::Outside { .. } => of_vertices(&places, RAYS / looked_at),
            _ => of_pixels(&views.observer_camera(&places)?, RAYS / looked_at),
        };
        let moment = views.moment(step)?;
        luminances.extend(scenery.luminances(Viewpoint::Observer(&moment), &directions));
    }
    Ok(luminances)
}

/// Directions of some of the vertices, from the observer.
fn of_vertices(places: &[DVec3], count: usize) -> Vec<DVec3> {
    let every = places.len().div_ceil(count.max(1)).max(1);
    let some = places.iter().step_by(every);
    some.filter_map(|place| place.try_normalize()).collect()
}

/// Directions of some of the pixels of a picture.
pub(super) fn of_pixels(camera: &Camera, count: usize) -> Vec<DVec3> {
    let size = DVec2::new(camera.size().width().into(), camera.size().height().into());
    let columns = ((count as f64 * size.x / size.y).sqrt() as usize).clamp(1, count.max(1));
    let rows = (count / columns).max(1);
    let cells = (0..columns * rows).map(|cell| (cell % columns, cell / columns));
    let middles = cells.map(|(column, row)| {
        let cell = DVec2::new(column as f64, row as f64) + 0.5;
        camera.direction(cell / DVec2::new(columns as f64, rows as f64) * size)
    });
    middles.collect()
}

/// The exposure that makes [`PART`] of these luminances at most [`BRIGHT`]; none if nothing is seen.
fn exposure(mut luminances: Vec<f64>) -> Stops {
    luminances.sort_unstable_by(f64::total_cmp);
    let place = (luminances.len() as f64 * PART) as usize;
    match luminances.get(place) {
        Some(&luminance) => Stops::between(luminance, BRIGHT),
        None => Stops::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_of_what_is_seen_is_shown_as_it_is() {
        let luminances: Vec<_> = (0..1000).map(f64::from).collect();
        let factor = exposure(luminances).factor();
        assert!((factor * 950.0 - BRIGHT).abs() < 1e-12);
        assert_eq!(exposure(vec![]), Stops::default());
        assert_eq!(exposure(vec![0.0; 9]).get(), 64.0);
        let every = of_vertices(&[DVec3::X, DVec3::ZERO, DVec3::Y * 7.0, DVec3::Z], 2);
        assert_eq!(every, [DVec3::X, DVec3::Y]);
    }
}
