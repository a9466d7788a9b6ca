//! Cameras: from pixels to directions and back.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3};
use thiserror::Error;

use crate::spacetime::unit;

/// Most pixels along one side of a picture: a guard against slips of the pen.
pub const MAX_PICTURE_SIDE: u32 = 16_384;

/// Width and height of a picture in pixels; neither is zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    width: u32,
    height: u32,
}

/// How directions are laid out on a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pinhole camera: straight lines stay straight.
    Pinhole {
        /// Angle from the lower to the upper edge, in degrees, above 0 and below 180.
        vertical_fov_deg: f64,
    },
    /// The whole sky in longitude and latitude, looking at the middle of the picture.
    FullSky,
}

/// Why numbers do not make a camera.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// No pixels, or too many.
    #[error("the picture is {0} x {1} pixels, expected 1 to {MAX_PICTURE_SIDE} on each side")]
    Size(u32, u32),
    /// A field of view that is none, or that a plane cannot hold.
    #[error("the field of view is {0} degrees, expected more than 0 and less than 180")]
    FieldOfView(f64),
    /// A direction without direction.
    #[error("the camera looks along {0}, expected a finite vector that is not zero")]
    Look(DVec3),
}

impl PictureSize {
    /// A picture of `width` by `height` pixels.
    ///
    /// # Errors
    ///
    /// A side of no pixels, or of more than [`MAX_PICTURE_SIDE`].
    pub fn new(width: u32, height: u32) -> Result<Self, CameraError> {
        let sides = 1..=MAX_PICTURE_SIDE;
        if sides.contains(&width) && sides.contains(&height) {
            Ok(Self { width, height })
        } else {
            Err(CameraError::Size(width, height))
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }
}

/// Which pixel shows which direction.
///
/// Places on the picture are in pixels from its upper left corner, x to the right, y down; the middle of
/// the first pixel is at (0.5, 0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    size: PictureSize,
    projection: Projection,
    /// Right, up, forward: unit vectors at right angles.
    axes: DMat3,
    /// Half the picture's width and height at distance 1 of a pinhole camera.
    half_extent: DVec2,
}

impl Camera {
    /// A camera that looks along `look`, with y up in the picture; one that looks along y itself has -z up
    /// (looking down) or z (looking up), as if it had been tilted from looking along -z.
    ///
    /// # Errors
    ///
    /// No direction, or a field of view out of range.
    pub fn new(
        size: PictureSize,
        projection: Projection,
        look: DVec3,
    ) -> Result<Self, CameraError> {
        let forward = unit(look).ok_or(CameraError::Look(look))?;
        let half_extent = match projection {
            Projection::Pinhole { vertical_fov_deg } => {
                if !(vertical_fov_deg > 0.0 && vertical_fov_deg < 180.0) {
                    return Err(CameraError::FieldOfView(vertical_fov_deg));
                }
                let half_height = (vertical_fov_deg.to_radians() / 2.0).tan();
                let aspect = f64::from(size.width) / f64::from(size.height);
                DVec2::new(half_height * aspect, half_height)
            }
            Projection::FullSky => DVec2::ZERO,
        };
        let right = unit(forward.cross(DVec3::Y)).unwrap_or(DVec3::X);
        let up = right.cross(forward);
        Ok(Self {
            size,
            projection,
            axes: DMat3::from_cols(right, up, forward),
            half_extent,
        })
    }

    /// Width and height of the picture.
    pub fn size(&self) -> PictureSize {
        self.size
    }

    /// The unit vector to what is seen at `place`; one of NaN where that is not finite.
    pub fn direction(&self, place: DVec2) -> DVec3 {
        let part = place / self.extent();
        let local = match self.projection {
            Projection::Pinhole { .. } => {
                let across = DVec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y) * self.half_extent;
                across.extend(1.0)
            }
            Projection::FullSky => {
                let (sin, cos) = ((part.x - 0.5) * TAU).sin_cos();
                let (height, across) = ((0.5 - part.y) * PI).sin_cos();
                DVec3::new(across * sin, height, across * cos)
            }
        };
        (self.axes * local).normalize()
    }

    /// The place on the picture, or beside it, where `direction` of any length is seen; `None` behind a
    /// pinhole camera, and where the place is beyond `f64`.
    pub fn place(&self, direction: DVec3) -> Option<DVec2> {
        let local = self.axes.transpose() * direction;
        let part = match self.projection {
            Projection::Pinhole { .. } => {
                if !(local.z > 0.0) {
                    return None;
                }
                let across = local.truncate() / local.z / self.half_extent;
                DVec2::new(1.0 + across.x, 1.0 - across.y) / 2.0
            }
            Projection::FullSky => {
                let longitude = local.x.atan2(local.z);
                let latitude = local.y.atan2(local.x.hypot(local.z));
                DVec2::new(longitude / TAU + 0.5, 0.5 - latitude / PI)
            }
        };
        let place = part * self.extent();
        place.is_finite().then_some(place)
    }

    fn extent(&self) -> DVec2 {
        DVec2::new(self.size.width.into(), self.size.height.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cameras() -> Vec<Camera> {
        let size = PictureSize::new(160, 90).unwrap();
        let narrow = Projection::Pinhole {
            vertical_fov_deg: 1.0,
        };
        let wide = Projection::Pinhole {
            vertical_fov_deg: 150.0,
        };
        let looks = [
            DVec3::NEG_Z,
            DVec3::new(1.0, 2.0, -3.0),
            DVec3::Y,
            DVec3::NEG_Y * 1e200,
        ];
        let all = looks.iter().flat_map(|&look| {
            [narrow, wide, Projection::FullSky]
                .map(|projection| Camera::new(size, projection, look))
        });
        all.map(Result::unwrap).collect()
    }

    #[test]
    fn places_and_directions_are_there_and_back() {
        for camera in cameras() {
            for x in [0.5, 33.25, 80.0, 159.5] {
                for y in [0.5, 45.0, 71.125] {
                    let place = DVec2::new(x, y);
                    let direction = camera.direction(place);
                    assert!((direction.length() - 1.0).abs() < 1e-15);
                    let back = camera.place(direction * 7.0).unwrap();
                    // A narrow picture has 1e4 pixels a radian, each direction rounded to 1e-16.
                    assert!(back.distance(place) < 1e-10, "{camera:?} {place} {back}");
                }
            }
        }
    }

    #[test]
    fn right_is_right_and_up_is_up() {
        for camera in cameras() {
            let middle = DVec2::new(80.0, 45.0);
            let ahead = camera.direction(middle);
            let between = |step| camera.direction(middle + step) - camera.direction(middle - step);
            let (right, up) = (between(DVec2::X), between(DVec2::NEG_Y));
            assert!(right.cross(up).normalize().dot(-ahead) > 1.0 - 1e-12);
            assert!(right.y.abs() < 1e-9 * right.length());
            assert!(up.y >= -1e-9);
        }
        let size = PictureSize::new(160, 90).unwrap();
        let down = Camera::new(size, Projection::FullSky, DVec3::NEG_Y).unwrap();
        let top = down.direction(DVec2::new(80.0, 44.0));
        assert!(top.z < 0.0, "looking down, ahead (-z) is up: {top}");
    }

    #[test]
    fn the_field_of_view_is_from_edge_to_edge() {
        let size = PictureSize::new(200, 100).unwrap();
        let projection = Projection::Pinhole {
            vertical_fov_deg: 60.0,
        };
        let camera = Camera::new(size, projection, DVec3::NEG_Z).unwrap();
        let [top, bottom] = [0.0, 100.0].map(|y| camera.direction(DVec2::new(100.0, y)));
        assert!((top.angle_between(bottom).to_degrees() - 60.0).abs() < 1e-12);
        assert_eq!(camera.place(DVec3::Z), None);
        let sky = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).unwrap();
        assert!(
            sky.place(DVec3::X)
                .unwrap()
                .distance(DVec2::new(150.0, 50.0))
                < 1e-12
        );
        assert!(sky.place(DVec3::Y).unwrap().y.abs() < 1e-12);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        assert!(PictureSize::new(0, 1).is_err());
        assert!(PictureSize::new(1, MAX_PICTURE_SIDE + 1).is_err());
        let size = PictureSize::new(1, 1).unwrap();
        for vertical_fov_deg in [0.0, 180.0, f64::NAN, -1.0] {
            let projection = Projection::Pinhole { vertical_fov_deg };
            assert!(Camera::new(size, projection, DVec3::X).is_err());
        }
        let none = Camera::new(size, Projection::FullSky, DVec3::ZERO).unwrap_err();
        assert!(
            none.to_string().contains("expected a finite vector"),
            "{none}"
        );
    }
}
