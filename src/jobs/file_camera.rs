//! The observer's camera in an exported file: what `render` draws is what is seen through it.

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::framing::{CameraSettings, FramingError};
use super::seen::seen_vertices;
use crate::pipeline::PlacedScene;
use crate::render::Camera;
use crate::spacetime::length;
use crate::write::ObserverCamera;

/// The name of the camera, if no mesh has it.
const NAME: &str = "camera";

/// The camera sees nothing that is nearer than this part of the distance of the nearest vertex of a source: between
/// vertices a surface may be nearer than at them.
const NEAR: f64 = 1e-2;

/// Depth buffers of 24 bits tell nothing apart where the farthest depth is more than so many times the nearest.
const MAX_DEPTH_RATIO: f64 = 1e6;

/// The near plane of a camera inside the observer's marker, in radii of the marker.
const BEYOND_MARKER: f64 = 1.01;

/// The camera goes beyond the marker only if nothing is nearer than so many radii of it.
const ROOM_AROUND_MARKER: f64 = 10.0;

/// The observer's camera for a file, and whether it would see the observer's marker, inside which it stands.
///
/// # Errors
///
/// An error is returned if the field of view is out of range or the aim gives no direction.
pub(super) fn file_camera(
    placed: &PlacedScene,
    settings: &CameraSettings,
) -> Result<(ObserverCamera, bool), FramingError> {
    let cameras = settings.observer_cameras(placed)?;
    let (mut nearest, mut farthest) = (f64::INFINITY, 0.0_f64);
    for step in 0..placed.scene().steps().len() {
        for place in seen_vertices(placed, step)? {
            nearest = nearest.min(length(place));
            farthest = farthest.max(length(place));
        }
    }
    // The distance at which a point of a triangle is seen is a convex function of the point: no point of it is farther
    // than its farthest corner. Rounding, and round shapes between their vertices, have all the room up to twice that.
    let far = match farthest > 0.0 {
        true => (2.0 * farthest).min(f64::MAX),
        false => 1.0,
    };
    let marker = placed.marker().and_then(|part| part.mesh().bounds());
    let radius = marker.map_or(0.0, |(_, high)| high.max_element());
    let sees_marker = !(ROOM_AROUND_MARKER * radius <= nearest);
    let near = match sees_marker || radius == 0.0 {
        true => (NEAR * nearest).clamp(far / MAX_DEPTH_RATIO, far / 2.0),
        false => BEYOND_MARKER * radius,
    };
    let size = settings.size;
    let camera = ObserverCamera {
        name: free_name(placed),
        vertical_fov_rad: cameras.first().map_or(1.0, vertical_fov_rad),
        aspect: f64::from(size.width()) / f64::from(size.height()),
        depths: [near, far],
        rotations: cameras.iter().map(rotation).collect(),
    };
    Ok((camera, sees_marker && radius > 0.0))
}

/// A name that no part and no marker has.
fn free_name(placed: &PlacedScene) -> String {
    let mut name = NAME.to_owned();
    let mut number = 1;
    let is_taken = |name: &str| {
        let mut parts = placed.objects().flat_map(|(_, parts)| parts);
        placed.marker().is_some_and(|marker| marker.name == name)
            || parts.any(|(of_part, _)| of_part == name)
    };
    while is_taken(&name) {
        number += 1;
        name = format!("{NAME}_{number}");
    }
    name
}

fn extent(camera: &Camera) -> DVec2 {
    let size = camera.size();
    DVec2::new(size.width().into(), size.height().into())
}

/// The angle between the directions to the middles of the lower and the upper edge.
fn vertical_fov_rad(camera: &Camera) -> f64 {
    let extent = extent(camera);
    let [up, down] = [0.0, 1.0].map(|y| camera.direction(DVec2::new(0.5, y) * extent));
    length(up.cross(down)).atan2(up.dot(down))
}

/// The rotation from the axes of a glTF camera (x right, y up, looking along -z) to the observer's.
fn rotation(camera: &Camera) -> DQuat {
    let extent = extent(camera);
    let forward = camera.direction(DVec2::splat(0.5) * extent);
    let edge = camera.direction(DVec2::new(1.0, 0.5) * extent);
    let across: DVec3 = edge - forward * edge.dot(forward);
    let right = across.normalize();
    let up = right.cross(forward);
    DQuat::from_mat3(&DMat3::from_cols(right, up, -forward)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{PictureSize, Projection};

    #[test]
    fn the_axes_and_the_field_of_view_are_those_of_the_picture() {
        let size = PictureSize::new(160, 90).unwrap();
        for vertical_fov_deg in [1e-3, 60.0, 150.0] {
            let projection = Projection::Perspective { vertical_fov_deg };
            for look in [DVec3::NEG_Z, DVec3::new(1.0, 2.0, -3.0), DVec3::Y, DVec3::X] {
                let camera = Camera::new(size, projection, look).unwrap();
                let fov = vertical_fov_rad(&camera).to_degrees();
                assert!(
                    (fov - vertical_fov_deg).abs() < 1e-9 * vertical_fov_deg,
                    "{fov}"
                );
                let turn = rotation(&camera);
                let half = (vertical_fov_deg.to_radians() / 2.0).tan();
                for place in [DVec2::new(80.0, 45.0), DVec2::new(10.5, 7.0)] {
                    let part = place / DVec2::new(160.0, 90.0);
                    let local = DVec3::new(
                        (2.0 * part.x - 1.0) * half * 160.0 / 90.0,
                        (1.0 - 2.0 * part.y) * half,
                        -1.0,
                    );
                    let seen = camera.direction(place);
                    assert!(
                        (turn * local.normalize()).distance(seen) < 1e-8,
                        "{look} {place}"
                    );
                }
            }
        }
    }
}
