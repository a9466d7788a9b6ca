//! Cameras: from pixels to directions and back.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// A pinhole camera: straight lines stay straight.
    Perspective {
        /// Angle from the lower to the upper edge, in degrees, above 0 and below 180.
        vertical_fov_deg: f64,
    },
    /// Circles on the sky stay circles, however wide the picture is.
    Stereographic {
        /// Angle from the lower to the upper edge, in degrees, above 0 and below 360.
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
    /// A field of view that is none, or that the projection cannot hold.
    #[error("the field of view is {found} degrees, expected more than 0 and less than {limit}")]
    FieldOfView {
        /// The field of view, in degrees.
        found: f64,
        /// The projection's limit, in degrees.
        limit: f64,
    },
    /// A direction without direction.
    #[error("the camera looks along {0}, expected a finite vector that is not zero")]
    Look(DVec3),
}

impl Projection {
    /// Half the height of the picture in the plane of the projection.
    fn half_height(self) -> Result<f64, CameraError> {
        let (found, limit, part) = match self {
            Self::Perspective { vertical_fov_deg } => (vertical_fov_deg, 180.0, 2.0),
            Self::Stereographic { vertical_fov_deg } => (vertical_fov_deg, 360.0, 4.0),
            Self::FullSky => return Ok(0.0),
        };
        match found > 0.0 && found < limit {
            true => Ok((found.to_radians() / part).tan()),
            false => Err(CameraError::FieldOfView { found, limit }),
        }
    }
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
    /// Half the picture's width and height in the plane of the projection, at distance 1 from the eye of a pinhole camera
    /// and from the far pole of a stereographic one.
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
        Self::with_up(size, projection, look, DVec3::Y)
    }

    /// As [`Camera::new`], with another direction up in the picture: the part of `up` across `look`.
    ///
    /// # Errors
    ///
    /// As [`Camera::new`].
    pub fn with_up(
        size: PictureSize,
        projection: Projection,
        look: DVec3,
        up: DVec3,
    ) -> Result<Self, CameraError> {
        let forward = unit(look).ok_or(CameraError::Look(look))?;
        let half_height = projection.half_height()?;
        let aspect = f64::from(size.width) / f64::from(size.height);
        let right = unit(forward.cross(up)).unwrap_or(DVec3::X);
        let up = right.cross(forward);
        Ok(Self {
            size,
            projection,
            axes: DMat3::from_cols(right, up, forward),
            half_extent: DVec2::new(half_height * aspect, half_height),
        })
    }

    /// Width and height of the picture.
    pub fn size(&self) -> PictureSize {
        self.size
    }

    /// The unit vector to what is seen at `place`; one of NaN where that is not finite.
    pub fn direction(&self, place: DVec2) -> DVec3 {
        let part = place / self.extent();
        let across = DVec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y) * self.half_extent;
        let local = match self.projection {
            Projection::Perspective { .. } => across.extend(1.0),
            Projection::Stereographic { .. } => {
                (2.0 * across).extend(1.0 - across.length_squared())
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
    /// pinhole camera, straight behind a stereographic one, and where the place is beyond `f64`.
    pub fn place(&self, direction: DVec3) -> Option<DVec2> {
        let local = self.axes.transpose() * direction;
        let in_plane = |depth: f64| {
            let across = local.truncate() / depth / self.half_extent;
            DVec2::new(1.0 + across.x, 1.0 - across.y) / 2.0
        };
        let part = match self.projection {
            Projection::Perspective { .. } => {
                if !(local.z > 0.0) {
                    return None;
                }
                in_plane(local.z)
            }
            Projection::Stereographic { .. } => {
                // The length of the direction plus its part ahead, which cancels behind.
                let across = local.truncate().length_squared();
                let depth = match local.z < 0.0 {
                    true => across / (local.length() - local.z),
                    false => local.length() + local.z,
                };
                if !(depth > 0.0) {
                    return None;
                }
                in_plane(depth)
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
        let narrow = Projection::Perspective {
            vertical_fov_deg: 1.0,
        };
        let wide = Projection::Perspective {
            vertical_fov_deg: 150.0,
        };
        let looks = [
            DVec3::NEG_Z,
            DVec3::new(1.0, 2.0, -3.0),
            DVec3::Y,
            DVec3::NEG_Y * 1e200,
        ];
        let round = [0.5, 170.0, 300.0]
            .map(|vertical_fov_deg| Projection::Stereographic { vertical_fov_deg });
        let all = looks.iter().flat_map(|&look| {
            [narrow, wide, Projection::FullSky]
                .into_iter()
                .chain(round)
                .map(move |projection| Camera::new(size, projection, look))
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
        let projection = Projection::Perspective {
            vertical_fov_deg: 60.0,
        };
        let camera = Camera::new(size, projection, DVec3::NEG_Z).unwrap();
        let [top, bottom] = [0.0, 100.0].map(|y| camera.direction(DVec2::new(100.0, y)));
        assert!((top.angle_between(bottom).to_degrees() - 60.0).abs() < 1e-12);
        assert_eq!(camera.place(DVec3::Z), None);
        let projection = Projection::Stereographic {
            vertical_fov_deg: 200.0,
        };
        let round = Camera::new(size, projection, DVec3::NEG_Z).unwrap();
        let [top, bottom] = [0.0, 100.0].map(|y| round.direction(DVec2::new(100.0, y)));
        assert!((top.dot(DVec3::NEG_Z).acos().to_degrees() - 100.0).abs() < 1e-12);
        assert!((top - bottom).length() < 2.0 && top.y > 0.0 && bottom.y < 0.0);
        assert_eq!(round.place(DVec3::Z), None);
        let sky = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).unwrap();
        assert!(
            sky.place(DVec3::X)
                .unwrap()
                .distance(DVec2::new(150.0, 50.0))
                < 1e-12
        );
        assert!(sky.place(DVec3::Y).unwrap().y.abs() < 1e-12);
    }

    /// All directions at one angle from another one lie on a circle in a stereographic picture, at any place in it.
    #[test]
    fn circles_stay_circles_in_stereographic_pictures() {
        let size = PictureSize::new(400, 300).unwrap();
        let projection = Projection::Stereographic {
            vertical_fov_deg: 220.0,
        };
        let camera = Camera::new(size, projection, DVec3::new(0.3, -0.2, -1.0)).unwrap();
        for (middle, angle) in [
            (DVec3::NEG_Z, 0.2_f64),
            (DVec3::new(1.0, 0.4, 0.1), 0.5),
            (DVec3::new(0.2, 1.0, 0.6), 0.9),
        ] {
            let middle = middle.normalize();
            let (right, up) = middle.any_orthonormal_pair();
            let rim = |part: f64| {
                let (sin, cos) = (part * TAU).sin_cos();
                let across = right * cos + up * sin;
                camera
                    .place(middle * angle.cos() + across * angle.sin())
                    .unwrap()
            };
            // The circle through three of them.
            let [a, b, c] = [0.0, 0.3, 0.7].map(rim);
            let (b, c) = (b - a, c - a);
            let twice = 2.0 * b.perp_dot(c);
            let (bb, cc) = (b.length_squared(), c.length_squared());
            let centre = a + DVec2::new(c.y * bb - b.y * cc, b.x * cc - c.x * bb) / twice;
            let radius = centre.distance(a);
            for part in 0..100 {
                let off = rim(f64::from(part) / 100.0).distance(centre) - radius;
                assert!(off.abs() < 1e-9 * radius, "{middle} {angle}: {off}");
            }
        }
    }

    #[test]
    fn up_may_be_any_direction() {
        let size = PictureSize::new(200, 100).unwrap();
        let projection = Projection::Perspective {
            vertical_fov_deg: 60.0,
        };
        let camera = Camera::with_up(size, projection, DVec3::Y, DVec3::X).unwrap();
        let top = camera.direction(DVec2::new(100.0, 0.0));
        assert!(top.x > 0.0 && top.z.abs() < 1e-15);
        let usual = Camera::with_up(size, projection, DVec3::X, DVec3::Y).unwrap();
        assert_eq!(usual, Camera::new(size, projection, DVec3::X).unwrap());
    }

    #[test]
    fn impossible_cameras_are_refused() {
        assert!(PictureSize::new(0, 1).is_err());
        assert!(PictureSize::new(1, MAX_PICTURE_SIDE + 1).is_err());
        let size = PictureSize::new(1, 1).unwrap();
        for vertical_fov_deg in [0.0, 180.0, f64::NAN, -1.0] {
            let projection = Projection::Perspective { vertical_fov_deg };
            assert!(Camera::new(size, projection, DVec3::X).is_err());
        }
        for vertical_fov_deg in [0.0, 360.0, f64::NAN, -1.0] {
            let projection = Projection::Stereographic { vertical_fov_deg };
            assert!(Camera::new(size, projection, DVec3::X).is_err());
        }
        let none = Camera::new(size, Projection::FullSky, DVec3::ZERO).unwrap_err();
        assert!(
            none.to_string().contains("expected a finite vector"),
            "{none}"
        );
    }
}
