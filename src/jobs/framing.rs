//! Cameras that frame the visible objects: the observer's camera and cameras outside.

use glam::DVec3;
use thiserror::Error;

use super::extent::{angle_around, bounds, middle_of_sky, reach, scaled};
use crate::pipeline::{PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::render::{Camera, CameraError, PictureSize, Projection};
use crate::scene::Scene;
use crate::spacetime::length;

/// Customary vertical field of view of the observer's pictures, in degrees.
pub const OBSERVER_FOV_DEG: f64 = 60.0;

/// Vertical field of view of an outside camera that stands so far away that everything is in the picture, in degrees.
const OUTSIDE_FOV_DEG: f64 = 30.0;

/// Default direction from the objects to an outside camera: in front, a little above and to the right.
const AWAY: DVec3 = DVec3::new(0.3, 0.3, 1.0);

/// Extent of a frame divided by the extent of its contents; the difference is a margin.
const FRAME: f64 = 1.08;

/// Range of the vertical fields of view that are computed to fit the contents, in degrees.
const FITTING_FOV_DEG: std::ops::RangeInclusive<f64> = 1e-6..=100.0;

/// The largest vertical field of view, in degrees, for which the distance of an outside camera is computed.
const MAX_FRAMED_FOV_DEG: f64 = 179.0;

/// How much of the sky a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// A pinhole camera that has everything at every step in the picture. The observer's camera has the narrowest
    /// vertical field of view that does this, from 1e-6 to 100 degrees; a camera outside has 30 degrees and stands far
    /// enough away.
    Fitting,
    /// A pinhole camera with this angle from the lower to the upper edge of the picture, in degrees, above 0 and below
    /// 180.
    Degrees(f64),
    /// The whole sky in longitude and latitude.
    FullSky,
}

/// Where a camera looks, in the observer's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Aim {
    /// An observer who flies, or whose axes are turned, looks along its own -z axis; all others as with [`Aim::Middle`].
    #[default]
    Usual,
    /// The middle of all objects. The observer looks at the middle of the part of the sky that they cover, at each step
    /// anew.
    Middle,
    /// A direction, as a vector of any length.
    Look(DVec3),
    /// A point, in scene units.
    Target(DVec3),
}

/// The settings that the observer's camera and cameras outside have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSettings {
    /// Width and height of a picture, in pixels.
    pub size: PictureSize,
    /// How much of the sky the picture shows.
    pub field_of_view: FieldOfView,
    /// Where the camera looks.
    pub aim: Aim,
}

/// Errors of framing: why no camera has all objects in the picture.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FramingError {
    /// A field of view is out of range, or a direction is zero or not finite.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The target of the camera is its own position, given here in scene units.
    #[error("the camera is to look at {0}, which is its own place, expected another target")]
    TargetIsCamera(DVec3),
    /// The given position of an outside camera, here in scene units, is the middle of the objects, so that the camera
    /// has no direction to look in.
    #[error(
        "the camera is at {0}, the middle of what is shown, expected another place or a direction to look in"
    )]
    CameraInMiddle(DVec3),
    /// The position or target of an outside camera is not finite.
    #[error("the place or target of the camera is {0}, expected finite coordinates")]
    NotFinite(DVec3),
    /// The objects are so far away or so large that no position of an outside camera within `f64` frames them.
    #[error(
        "what is to be seen is so far away or so large, up to {reach:e}, that no camera outside can frame it"
    )]
    TooFar {
        /// The largest absolute value of an object's coordinate, in the observer's frame, in scene units.
        reach: f64,
    },
    /// The scene has no photosurfaces at a step.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
}

/// A camera outside, with all its lengths in the observer's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutsideCamera {
    pub(super) camera: Camera,
    /// The position of the camera, in scene units.
    pub(super) place: DVec3,
    /// The height of the picture at the distance of the camera's target, in scene units.
    pub(super) height: f64,
    /// Whether the picture has one scale at that distance; a picture of the whole sky does not.
    pub(super) has_scale: bool,
}

impl CameraSettings {
    /// The observer's camera for each step of a scene, in the order of the steps; all have the same field of view.
    ///
    /// # Errors
    ///
    /// An error is returned if the field of view is out of range or the aim gives no direction.
    pub fn observer_cameras(&self, placed: &PlacedScene) -> Result<Vec<Camera>, FramingError> {
        let steps = 0..placed.scene().steps().len();
        let here = self.for_observer(placed.scene());
        let fov = here.observer_fov_deg(steps.clone().map(|step| seen_vertices(placed, step)))?;
        let camera = |step| here.observer_camera(fov, &seen_vertices(placed, step)?);
        steps.map(camera).collect()
    }

    /// The settings of the observer's camera in a scene, whose aim is not [`Aim::Usual`].
    pub(super) fn for_observer(&self, scene: &Scene) -> Self {
        if self.aim != Aim::Usual {
            return *self;
        }
        match scene.observer().has_own_axes() {
            false => Self {
                aim: Aim::Middle,
                ..*self
            },
            true => Self {
                aim: Aim::Look(DVec3::NEG_Z),
                field_of_view: match self.field_of_view {
                    // What is behind a pilot is not in the picture.
                    FieldOfView::Fitting => FieldOfView::Degrees(OBSERVER_FOV_DEG),
                    other => other,
                },
                ..*self
            },
        }
    }

    /// Vertical field of view of the observer's camera at all steps, in degrees, from the seen positions at each step.
    pub(super) fn observer_fov_deg<E>(
        &self,
        mut places: impl Iterator<Item = Result<Vec<DVec3>, E>>,
    ) -> Result<f64, E> {
        match self.field_of_view {
            FieldOfView::Fitting => places.try_fold(0.0, |widest: f64, places| {
                Ok(widest.max(fitting_fov_deg(&places?, self.size)))
            }),
            FieldOfView::Degrees(fov) => Ok(fov),
            FieldOfView::FullSky => Ok(OBSERVER_FOV_DEG),
        }
    }

    /// The observer's camera, with a vertical field of view in degrees; `places` are the seen positions, in the
    /// observer's frame.
    pub(super) fn observer_camera(
        &self,
        fov_deg: f64,
        places: &[DVec3],
    ) -> Result<Camera, FramingError> {
        let look = match self.aim {
            Aim::Usual | Aim::Middle => middle_of_sky(places),
            Aim::Look(look) => look,
            Aim::Target(target) => target,
        };
        self.camera(fov_deg, look, None)
    }

    /// One camera for each list of positions, in the observer's frame and in scene units. Each camera frames its list,
    /// and all have the same distance from their targets. If `from` is given, it is the position of all cameras
    /// instead.
    pub(super) fn outside_cameras(
        &self,
        from: Option<DVec3>,
        frames: &[Vec<DVec3>],
    ) -> Result<Vec<OutsideCamera>, FramingError> {
        let fov = match self.field_of_view {
            FieldOfView::Degrees(fov) => fov,
            FieldOfView::Fitting | FieldOfView::FullSky => OUTSIDE_FOV_DEG,
        };
        let target = match self.aim {
            Aim::Target(target) => Some(target),
            _ => None,
        };
        let given = from.into_iter().chain(target);
        if let Some(place) = given.into_iter().find(|place| !place.is_finite()) {
            return Err(FramingError::NotFinite(place));
        }
        if fov.is_nan() {
            return Err(CameraError::FieldOfView(fov).into());
        }
        let half = fov.clamp(*FITTING_FOV_DEG.start(), MAX_FRAMED_FOV_DEG);
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
            Ok(OutsideCamera {
                camera: self.camera(fov, look, from)?,
                place,
                height,
                has_scale: self.field_of_view != FieldOfView::FullSky,
            })
        };
        framed.into_iter().map(outside).collect()
    }

    fn camera(
        &self,
        fov_deg: f64,
        look: DVec3,
        from: Option<DVec3>,
    ) -> Result<Camera, FramingError> {
        let projection = match self.field_of_view {
            FieldOfView::FullSky => Projection::FullSky,
            _ => Projection::Pinhole {
                vertical_fov_deg: fov_deg,
            },
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

/// The vertical field of view, in degrees, with which the observer's camera, aimed at the middle of the positions, has
/// all of them in the picture.
fn fitting_fov_deg(places: &[DVec3], size: PictureSize) -> f64 {
    let half = angle_around(middle_of_sky(places), places) * FRAME;
    // The shorter side of the picture has to hold the angle.
    let aspect = f64::from(size.width()) / f64::from(size.height());
    let tan = half.min(1.5).tan() / aspect.min(1.0);
    (2.0 * tan.atan().to_degrees()).clamp(*FITTING_FOV_DEG.start(), *FITTING_FOV_DEG.end())
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
            size: size(1280, 720),
            field_of_view: FieldOfView::Fitting,
            aim: Aim::Middle,
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
                let fov = fitting_fov_deg(places, settings.size);
                assert!(FITTING_FOV_DEG.contains(&fov), "{context}");
                let look = middle_of_sky(places);
                assert!((look.length() - 1.0).abs() < 1e-12, "{context}");
                settings.observer_camera(fov, places).unwrap();
                match settings.outside_cameras(from, std::slice::from_ref(places)) {
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
            size: size(16, 9),
            field_of_view: FieldOfView::Fitting,
            aim: Aim::Middle,
        };
        let places = [vec![DVec3::NEG_Z, DVec3::NEG_ONE]];
        for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0, 180.0] {
            let settings = CameraSettings {
                field_of_view: FieldOfView::Degrees(bad),
                ..plain
            };
            let field = |error: &FramingError| {
                matches!(error, FramingError::Camera(CameraError::FieldOfView(_)))
            };
            let outside = settings.outside_cameras(None, &places);
            assert!(outside.is_err_and(|error| field(&error)), "{bad}");
            let observer = settings.observer_camera(bad, &places[0]);
            assert!(observer.is_err_and(|error| field(&error)), "{bad}");
        }
        for bad in [f64::NAN, f64::INFINITY] {
            let bad = DVec3::new(bad, 0.0, 0.0);
            for aim in [Aim::Look(bad), Aim::Target(bad)] {
                let settings = CameraSettings { aim, ..plain };
                assert!(settings.outside_cameras(None, &places).is_err(), "{aim:?}");
                assert!(
                    settings.observer_camera(60.0, &places[0]).is_err(),
                    "{aim:?}"
                );
            }
            let error = plain.outside_cameras(Some(bad), &places).unwrap_err();
            assert!(matches!(error, FramingError::NotFinite(_)), "{error}");
        }
        let middle = [vec![DVec3::ZERO]];
        let error = plain.outside_cameras(Some(DVec3::ZERO), &middle);
        assert!(matches!(error, Err(FramingError::CameraInMiddle(_))));
    }

    #[test]
    fn the_fitting_field_of_view_holds_everything_with_a_margin() {
        for distance in [1e-310, 1e-200, 1.0, 1e200, 1e305] {
            let around = [DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.6, -0.8, 0.0)];
            let fov = fitting_fov_deg(&around.map(|place| place * distance), size(100, 100));
            assert_eq!(fov, *FITTING_FOV_DEG.end());
            let ahead = around.map(|place| DVec3::new(place.x, place.y / 8.0, 0.0) * distance);
            let fov = fitting_fov_deg(&ahead, size(100, 100));
            let expected = 2.0 * FRAME * (1.0_f64 / 6.0).atan().to_degrees();
            assert!(
                (fov - expected).abs() < 1e-9,
                "{distance}: {fov} {expected}"
            );
        }
    }
}
