//! Cameras outside, which have photosurfaces, ghosts, the marker and axes in the picture.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::extent::{bounds, reach, round_below, scaled};
use super::framing::{Aim, CameraSettings, FRAME, FieldOfView, FramingError, PictureProjection};
use crate::render::{Camera, CameraError, Projection};
use crate::spacetime::length;

/// Vertical field of view of a camera that stands so far away that everything is in the picture, in degrees.
const OUTSIDE_FOV_DEG: f64 = 30.0;

/// Default direction from the objects to a camera outside: in front, a little above and to the right.
const AWAY: DVec3 = DVec3::new(0.3, 0.3, 1.0);

/// The length of an axis with its name, in lengths of the axis.
const AXIS_WITH_NAME: f64 = 1.3;

/// Range of the vertical fields of view, in degrees, for which the distance of a camera is computed.
const FRAMED_FOV_DEG: std::ops::RangeInclusive<f64> = 1e-6..=179.0;

/// A camera outside, with all its lengths in the observer's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutsideCamera {
    pub(super) camera: Camera,
    /// The direction in which the camera looks, of any length.
    look: DVec3,
    /// The position of the camera, in scene units.
    pub(super) place: DVec3,
    /// The height of the picture at the distance of the camera's target, in scene units.
    pub(super) height: f64,
    /// Whether the picture has one scale at that distance; a picture of the whole sky does not.
    pub(super) has_scale: bool,
    /// The length of the observer's axes, in scene units.
    pub(super) axes: f64,
}

/// Where a camera outside is, from which it can be made again: all that depends on what it has to show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Outlook {
    place: DVec3,
    look: DVec3,
    height: f64,
    axes: f64,
}

impl OutsideCamera {
    pub(super) fn outlook(&self) -> Outlook {
        Outlook {
            place: self.place,
            look: self.look,
            height: self.height,
            axes: self.axes,
        }
    }
}

/// The lists of positions, in the observer's frame and in scene units, that cameras outside have to show, one for each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contents<'a> {
    pub(super) frames: &'a [Vec<DVec3>],
    /// Whether the observer's axes are to be seen as well.
    pub(super) with_axes: bool,
}

impl CameraSettings {
    /// One camera for each list of positions. Each camera frames its list, and all have the same distance from their
    /// targets. If `from` is given, it is the position of all cameras instead.
    pub(super) fn outside_cameras(
        &self,
        from: Option<DVec3>,
        contents: Contents,
    ) -> Result<Vec<OutsideCamera>, FramingError> {
        let frames = contents.frames;
        let without = self.cameras_for(from, frames)?;
        let axes = without.first().map_or(0.0, |camera| camera.axes);
        if !contents.with_axes || axes == 0.0 || from.is_some() {
            return Ok(without);
        }
        // The axes are as long as without them, so that they do not grow with the frame that they make wider.
        let ends = DVec3::AXES.map(|axis| axis * (AXIS_WITH_NAME * axes));
        let with_ends = |places: &Vec<DVec3>| [places, &ends[..], &[DVec3::ZERO]].concat();
        let frames: Vec<_> = frames.iter().map(with_ends).collect();
        let mut cameras = self.cameras_for(from, &frames)?;
        for camera in &mut cameras {
            camera.axes = axes;
        }
        Ok(cameras)
    }

    fn cameras_for(
        &self,
        from: Option<DVec3>,
        frames: &[Vec<DVec3>],
    ) -> Result<Vec<OutsideCamera>, FramingError> {
        let fov = self.outside_fov_deg();
        let target = match self.aim {
            Aim::Target(target) => Some(target),
            _ => None,
        };
        let given = from.into_iter().chain(target);
        if let Some(place) = given.into_iter().find(|place| !place.is_finite()) {
            return Err(FramingError::NotFinite(place));
        }
        if fov.is_nan() {
            let limit = 180.0;
            return Err(CameraError::FieldOfView { found: fov, limit }.into());
        }
        let half = fov.clamp(*FRAMED_FOV_DEG.start(), *FRAMED_FOV_DEG.end());
        let half = (half.to_radians() / 2.0).tan();
        let away = match self.aim {
            Aim::Look(look) => -scaled(look).normalize_or_zero(),
            _ => AWAY.normalize(),
        };
        // A camera without a direction or a field of view causes an error below.
        let right = away.cross(DVec3::NEG_Y).try_normalize().unwrap_or(DVec3::X);
        let axes = [right, away.cross(right), away];
        let aspect = f64::from(self.size.width()) / f64::from(self.size.height());
        let framed = frames
            .iter()
            .map(|places| frame(places, target, axes, (half, aspect)));
        let framed: Vec<(DVec3, f64)> = framed.collect();
        let distance = framed.iter().map(|frame| frame.1).fold(0.0, f64::max);
        let outside = |(target, _): (DVec3, f64)| {
            let place = from.unwrap_or(target + away * distance);
            let distance = match from {
                Some(from) => length(from - target),
                None => distance,
            };
            let height = 2.0 * half * distance;
            if !(target.is_finite() && place.is_finite() && height.is_finite()) {
                let reach = reach(frames.iter().flatten());
                return Err(FramingError::TooFar { reach });
            }
            let look = match self.aim {
                Aim::Look(look) => look,
                _ => target - place,
            };
            let axes = round_below(height / 5.0);
            let outlook = Outlook {
                place,
                look,
                height,
                axes,
            };
            self.outside_camera(from, outlook)
        };
        framed.into_iter().map(outside).collect()
    }

    /// The camera of these settings that was found before.
    pub(super) fn outside_camera(
        &self,
        from: Option<DVec3>,
        found: Outlook,
    ) -> Result<OutsideCamera, FramingError> {
        Ok(OutsideCamera {
            camera: self.camera(self.outside_fov_deg(), found.look, from)?,
            look: found.look,
            place: found.place,
            height: found.height,
            has_scale: self.projection != PictureProjection::FullSky,
            axes: found.axes,
        })
    }

    fn outside_fov_deg(&self) -> f64 {
        match self.field_of_view {
            FieldOfView::Degrees(fov) => fov,
            FieldOfView::Fitting => OUTSIDE_FOV_DEG,
        }
    }

    fn camera(
        &self,
        fov_deg: f64,
        look: DVec3,
        from: Option<DVec3>,
    ) -> Result<Camera, FramingError> {
        let vertical_fov_deg = fov_deg;
        let projection = match self.projection {
            PictureProjection::FullSky => Projection::FullSky,
            PictureProjection::Stereographic => Projection::Stereographic { vertical_fov_deg },
            PictureProjection::Usual | PictureProjection::Perspective => {
                Projection::Perspective { vertical_fov_deg }
            }
        };
        Camera::new(self.size, projection, look).map_err(|error| match (error, self.aim, from) {
            (CameraError::Look(_), Aim::Target(target), _) => FramingError::TargetIsCamera(target),
            (CameraError::Look(_), Aim::Usual | Aim::Middle, Some(from)) => {
                FramingError::CameraInMiddle(from)
            }
            _ => error.into(),
        })
    }
}

/// The point that a camera has to look at to frame the positions `places`, or `target` if that is given, and the
/// smallest distance from that point at which the camera frames them.
///
/// `axes` point right, up and from the target to the camera; `half` is the tangent of half the vertical field of view,
/// and `aspect` the picture's width divided by its height.
fn frame(
    places: &[DVec3],
    target: Option<DVec3>,
    [right, up, away]: [DVec3; 3],
    (half, aspect): (f64, f64),
) -> (DVec3, f64) {
    let local = |place: &DVec3| DVec3::new(place.dot(right), place.dot(up), place.dot(away));
    let (low, high) = bounds(places.iter().map(local));
    // Each number is halved first, because the sum of two large numbers may overflow.
    let middle = low / 2.0 + high / 2.0;
    let middle = right * middle.x + up * middle.y + away * middle.z;
    let target = match target {
        Some(target) => target,
        // Without positions any target frames them equally well.
        None if places.is_empty() => DVec3::ZERO,
        None => middle,
    };
    let distances = places.iter().map(|place| {
        let from_target = local(&(*place - target));
        let across = (from_target.x.abs() / aspect).max(from_target.y.abs());
        from_target.z + FRAME * across / half
    });
    let distance = distances.fold(0.0, f64::max);
    (target, distance.max(min_distance(target, distance)))
}

/// The smallest distance from `target` that a camera may have: enough for its direction to survive rounding, and above
/// zero if `distance` is zero, as for a single point.
fn min_distance(target: DVec3, distance: f64) -> f64 {
    let least = target.abs().max_element() * 1e-12;
    if distance > 0.0 {
        least
    } else {
        least.max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::render::PictureSize;

    fn size(width: u32, height: u32) -> PictureSize {
        PictureSize::new(width, height).unwrap()
    }

    /// Lists of positions with sizes and distances from zero to the largest numbers, and an empty list.
    fn frames() -> Vec<Vec<DVec3>> {
        let sizes = [
            0.0, 1e-300, 1e-155, 1e-30, 1e-9, 1.0, 1e30, 1e152, 1e156, 1e290, 1e308,
        ];
        let mut frames = vec![vec![], vec![DVec3::splat(f64::NAN)]];
        for size in sizes {
            for away in sizes {
                let middle = DVec3::new(0.2, -0.5, 0.8) * away;
                frames.push(vec![middle - size * 0.5, middle + size * 0.5]);
                frames.push(vec![middle]);
            }
        }
        frames
    }

    /// The frames contain nothing, one point, or tiny and huge objects, far and near. In each case the camera is finite
    /// and looks at the middle, or there is an error with the reason.
    #[test]
    fn every_frame_is_finite_or_an_error() {
        let plain = CameraSettings {
            aim: Aim::Middle,
            ..CameraSettings::new(size(1280, 720))
        };
        let aimed = |aim| CameraSettings { aim, ..plain };
        let wide = |degrees| CameraSettings {
            field_of_view: FieldOfView::Degrees(degrees),
            ..plain
        };
        let long = CameraSettings {
            size: size(4000, 1),
            ..plain
        };
        let all = [
            (plain, None),
            (aimed(Aim::Look(DVec3::new(1.0, 2.0, 3.0))), None),
            (aimed(Aim::Look(DVec3::Y)), None),
            (aimed(Aim::Look(DVec3::NEG_Z * 1e200)), None),
            (aimed(Aim::Target(DVec3::new(1.0, 2.0, 3.0))), None),
            (plain, Some(DVec3::ZERO)),
            (wide(1e-6), Some(DVec3::new(4.0, 5.0, 6.0))),
            (wide(179.99), None),
            (long, None),
        ];
        let mut made = 0;
        for (settings, from) in all {
            for places in &frames() {
                let context = format!("{settings:?} {from:?} {places:?}");
                let contents = Contents {
                    frames: std::slice::from_ref(places),
                    with_axes: true,
                };
                match settings.outside_cameras(from, contents) {
                    Ok(outside) => {
                        let &[outside] = &outside[..] else {
                            panic!("one frame, one camera")
                        };
                        let OutsideCamera { camera, place, .. } = outside;
                        let middle = DVec2::new(0.5, 0.5) * f64::from(camera.size().height());
                        assert!(place.is_finite() && outside.height.is_finite(), "{context}");
                        assert!(camera.direction(middle).is_finite());
                        made += 1;
                    }
                    Err(FramingError::TooFar { .. } | FramingError::CameraInMiddle(_)) => {}
                    Err(FramingError::TargetIsCamera(_)) => {
                        assert!(matches!(settings.aim, Aim::Target(_)), "{context}");
                    }
                    Err(other) => panic!("{context}: {other}"),
                }
            }
        }
        assert!(made > 1000, "{made}");
    }

    #[test]
    fn settings_that_are_no_numbers_are_errors() {
        let plain = CameraSettings {
            aim: Aim::Middle,
            ..CameraSettings::new(size(16, 9))
        };
        let frames = [vec![DVec3::NEG_Z, DVec3::NEG_ONE]];
        let contents = Contents {
            frames: &frames,
            with_axes: false,
        };
        for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0, 180.0] {
            let settings = CameraSettings {
                field_of_view: FieldOfView::Degrees(bad),
                ..plain
            };
            let field = |error: &FramingError| {
                matches!(error, FramingError::Camera(CameraError::FieldOfView { .. }))
            };
            let outside = settings.outside_cameras(None, contents);
            assert!(outside.is_err_and(|error| field(&error)), "{bad}");
        }
        for bad in [f64::NAN, f64::INFINITY] {
            let bad = DVec3::new(bad, 0.0, 0.0);
            for aim in [Aim::Look(bad), Aim::Target(bad)] {
                let settings = CameraSettings { aim, ..plain };
                assert!(settings.outside_cameras(None, contents).is_err(), "{aim:?}");
            }
            let error = plain.outside_cameras(Some(bad), contents).unwrap_err();
            assert!(matches!(error, FramingError::NotFinite(_)), "{error}");
        }
        let contents = Contents {
            frames: &[vec![DVec3::ZERO]],
            with_axes: false,
        };
        let error = plain.outside_cameras(Some(DVec3::ZERO), contents);
        assert!(matches!(error, Err(FramingError::CameraInMiddle(_))));
    }

    /// Positions of all lists, and the ends of the axes, are inside the picture, whichever list is the largest.
    #[test]
    fn everything_and_the_axes_are_in_the_picture() {
        let ball = |middle: DVec3, radius: f64| -> Vec<DVec3> {
            DVec3::AXES
                .iter()
                .flat_map(|&axis| [middle + axis * radius, middle - axis * radius])
                .collect()
        };
        let frames = [
            ball(DVec3::new(3.0, 1.0, -4.0), 2.0),
            ball(DVec3::new(-30.0, 2.0, 5.0), 9.0),
            vec![],
        ];
        for settings in [
            CameraSettings::new(size(640, 200)),
            CameraSettings {
                aim: Aim::Look(DVec3::new(1.0, -0.5, 0.2)),
                field_of_view: FieldOfView::Degrees(100.0),
                ..CameraSettings::new(size(100, 300))
            },
        ] {
            let contents = Contents {
                frames: &frames,
                with_axes: true,
            };
            let cameras = settings.outside_cameras(None, contents).unwrap();
            for (outside, places) in cameras.iter().zip(&frames) {
                let ends = DVec3::AXES.map(|axis| axis * outside.axes);
                for place in places.iter().chain(&ends) {
                    let at = outside.camera.place(*place - outside.place).unwrap();
                    let (width, height) = (settings.size.width(), settings.size.height());
                    let inside = at.cmpge(DVec2::ZERO).all()
                        && at.cmple(DVec2::new(width.into(), height.into())).all();
                    assert!(inside, "{settings:?} {place} {at}");
                }
            }
        }
    }
}
