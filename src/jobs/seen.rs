//! Where the vertices of objects are seen: what cameras have to show.

use glam::DVec3;

use super::extent::{outermost, scaled};
use crate::pipeline::{PlacedScene, PlacedSceneError, SurfaceOptions};

/// Where the source vertices of a scene's objects are seen at one step, in the observer's frame, in scene units.
pub(super) fn seen_vertices(
    placed: &PlacedScene,
    step: usize,
) -> Result<Vec<DVec3>, PlacedSceneError> {
    let options = SurfaceOptions {
        subdivide: false,
        ..SurfaceOptions::default()
    };
    let surfaces = placed.photosurfaces(step, options)?;
    Ok(surfaces
        .flat_map(|surface| surface.mesh.positions().to_vec())
        .collect())
}

/// The outermost directions, as unit vectors, in which these positions are seen from the origin.
pub(super) fn sky_of(places: &[DVec3]) -> Vec<DVec3> {
    let directions = places
        .iter()
        .filter_map(|place| scaled(*place).try_normalize());
    outermost(directions.collect())
}
