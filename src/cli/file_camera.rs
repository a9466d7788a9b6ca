//! Flags that put the observer's camera into a file.

use anyhow::{anyhow, ensure};
use photosurface::jobs::{
    Aim, CameraSettings, FieldOfView, Follow, FramingError, PictureProjection,
};
use photosurface::render::{CameraError, PictureSize};
use photosurface::{DVec3, PictureMethod, PictureSettings, PictureView};

use super::camera::size;
use super::values::{number, vector};

#[derive(Debug, clap::Args)]
#[command(
    next_help_heading = "Camera in the file (places and directions are in the observer's frame)"
)]
pub(super) struct FileCameraArgs {
    /// Put a camera into the .glb or .gltf, at the observer's place: what is seen through it is what render
    /// --projection perspective draws with the same flags. Each of several steps has a camera of its own; an animation has one that turns with its steps
    #[arg(long)]
    camera: bool,
    /// Width and height of the picture in pixels, of which the camera has the aspect [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = size, requires = "camera")]
    size: Option<PictureSize>,
    /// Field of view of the camera from the lower to the upper edge, in degrees, above 0 and below 180 [default: that of
    /// render]
    #[arg(long, value_name = "DEG", value_parser = number, allow_hyphen_values = true, requires = "camera")]
    fov: Option<f64>,
    /// Aim the camera at the middle of the objects at each step anew; in an animation it turns [default: one direction for all
    /// steps, as in render]
    #[arg(long, conflicts_with_all = ["look", "target"], requires = "camera")]
    track: bool,
    /// Direction in which the camera looks, of any length [default: that of render]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, conflicts_with = "target", requires = "camera")]
    look: Option<DVec3>,
    /// Place at which the camera looks, in scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, requires = "camera")]
    target: Option<DVec3>,
}

impl FileCameraArgs {
    /// The camera that the flags ask for.
    ///
    /// # Errors
    ///
    /// An error is returned if models stand side by side, so that no camera sees what an observer sees.
    pub(super) fn settings(&self, is_side_by_side: bool) -> anyhow::Result<Option<CameraSettings>> {
        if !self.camera {
            return Ok(None);
        }
        ensure!(
            !is_side_by_side,
            "--camera is at the observer's place, and --models moves objects away from where they are seen; choose one --model"
        );
        let usual = PictureSettings::new(PictureView::Observer(PictureMethod::Rays)).camera;
        let aim = match (self.look, self.target) {
            (Some(look), _) => Aim::Look(look),
            (None, Some(target)) => Aim::Target(target),
            (None, None) => usual.aim,
        };
        Ok(Some(CameraSettings {
            size: self.size.unwrap_or(usual.size),
            projection: PictureProjection::Perspective,
            field_of_view: self.fov.map_or(usual.field_of_view, FieldOfView::Degrees),
            aim,
            follow: if self.track {
                Follow::Track
            } else {
                Follow::Usual
            },
        }))
    }
}

/// The error of a camera with the flag that it is about.
pub(super) fn flagged(error: FramingError) -> anyhow::Error {
    let flag = match error {
        FramingError::Camera(CameraError::FieldOfView { .. }) => "--fov",
        FramingError::Camera(CameraError::Look(_)) => "--look",
        FramingError::TargetIsCamera(_) => {
            return anyhow!("--target is the place of the observer, expected another one");
        }
        _ => "--camera",
    };
    anyhow::Error::new(error).context(flag)
}
