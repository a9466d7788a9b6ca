//! Which part of the sky, or of space, pictures show: the settings of their cameras.

use glam::DVec3;
use thiserror::Error;

use crate::pipeline::PlacedSceneError;
use crate::render::{CameraError, PictureSize};
use crate::scene::Observer;

/// Customary vertical field of view of the observer's pictures, in degrees.
pub const OBSERVER_FOV_DEG: f64 = 60.0;

/// Extent of a frame divided by the extent of its contents; the difference is a margin.
pub(super) const FRAME: f64 = 1.08;

/// How directions are laid out on a picture, without the angle that it shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureProjection {
    /// Perspective; the observer's pictures are stereographic if they show everything so and would be wider than 100 degrees
    /// in perspective.
    #[default]
    Usual,
    /// A pinhole camera: straight lines stay straight.
    Perspective,
    /// Circles on the sky stay circles.
    Stereographic,
    /// The whole sky in longitude and latitude, twice as wide as high.
    FullSky,
}

/// How much of the sky a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// Everything at every step that the camera shows, with a margin. The observer's camera has the narrowest field of view
    /// that does this, or one of 60 degrees from the lower to the upper edge where it is told in which direction to look; a
    /// camera outside has 30 degrees and stands far enough away.
    Fitting,
    /// This angle from the lower to the upper edge of the picture, in degrees: above 0, and below 180 in perspective or
    /// below 360 in stereographic projection.
    Degrees(f64),
}

/// Where a camera looks, in the observer's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Aim {
    /// An observer who flies, or whose axes are turned, looks along its own -z axis; all others as with [`Aim::Middle`].
    #[default]
    Usual,
    /// The middle of all objects; for the observer, that of the part of the sky that they cover, or the direction of motion
    /// in pictures of the whole sky that do not track.
    Middle,
    /// A direction, as a vector of any length.
    Look(DVec3),
    /// A point, in scene units.
    Target(DVec3),
}

/// Whether the observer's camera follows the objects from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Follow {
    /// On a sheet it does; in several pictures, and in a film, it does not.
    #[default]
    Usual,
    /// One direction for all steps: the middle of everything at every step; or the direction of motion, if no picture
    /// shows everything.
    Hold,
    /// The middle of the objects at each step anew.
    Track,
}

/// The settings that the observer's camera and cameras outside have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSettings {
    /// Width and height of a picture, in pixels.
    pub size: PictureSize,
    /// How directions are laid out.
    pub projection: PictureProjection,
    /// How much of the sky the picture shows.
    pub field_of_view: FieldOfView,
    /// Where the camera looks.
    pub aim: Aim,
    /// Whether the observer's camera follows the objects.
    pub follow: Follow,
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

impl CameraSettings {
    /// A camera that shows everything, of the usual projection and direction.
    pub fn new(size: PictureSize) -> Self {
        Self {
            size,
            projection: PictureProjection::Usual,
            field_of_view: FieldOfView::Fitting,
            aim: Aim::Usual,
            follow: Follow::Usual,
        }
    }

    /// The settings of the observer's camera, without anything that is "usual" but the projection.
    pub(super) fn for_observer(&self, observer: &Observer, is_sheet: bool) -> Self {
        let mut here = *self;
        if self.aim == Aim::Usual {
            here.aim = match observer.has_own_axes() && self.follow != Follow::Track {
                true => Aim::Look(DVec3::NEG_Z),
                false => Aim::Middle,
            };
        }
        // What is elsewhere than where the camera is told to look is not in the picture.
        let is_told = matches!(here.aim, Aim::Look(_) | Aim::Target(_));
        if is_told && self.field_of_view == FieldOfView::Fitting {
            here.field_of_view = FieldOfView::Degrees(OBSERVER_FOV_DEG);
        }
        if self.follow == Follow::Usual {
            here.follow = if is_sheet {
                Follow::Track
            } else {
                Follow::Hold
            };
        }
        here
    }

    /// Whether the frame of the observer's pictures depends on what is seen; of settings without a usual aim.
    pub(super) fn depends_on_skies(&self) -> bool {
        let is_told = matches!(self.aim, Aim::Look(_) | Aim::Target(_));
        !is_told && self.projection != PictureProjection::FullSky
    }
}
