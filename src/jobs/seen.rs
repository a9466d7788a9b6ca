//! Where the vertices of objects are seen: what cameras have to show.

use glam::DVec3;

use super::extent::{outermost, scaled};
use crate::pipeline::{PlacedScene, PlacedSceneError};

/// Where the vertices of a scene's objects before any refinement are seen at one step, in the observer's frame, in scene
/// units.
pub(super) fn seen_vertices(
    placed: &PlacedScene,
    step: usize,
) -> Result<Vec<DVec3>, PlacedSceneError> {
    let mut places = Vec::new();
    placed.seen_places(step, |of_part| places.extend_from_slice(of_part))?;
    Ok(places)
}

/// The outermost directions, as unit vectors, in which these positions are seen from the origin.
pub(super) fn sky_of(places: &[DVec3]) -> Vec<DVec3> {
    let directions = places
        .iter()
        .filter_map(|place| scaled(*place).try_normalize());
    outermost(directions.collect())
}
