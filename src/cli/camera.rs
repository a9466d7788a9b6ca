//! Flags that say what a picture shows and from where.

use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::Range;

use anyhow::{Context, anyhow, bail, ensure};
use photosurface::jobs::{
    Aim, CameraSettings, FieldOfView, Follow, FramingError, PictureProjection, RenderError,
};
use photosurface::render::{CameraError, PictureSize};
use photosurface::shape::Color;
use photosurface::{DVec3, PictureMethod, PictureSettings, PictureView, Scene};

use super::args::{Given, refuse};
use super::values::{count, number, part, vector};

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Camera (places and directions are in the observer's frame)")]
pub(super) struct CameraArgs {
    /// Draw the observer's view, or the photosurfaces from another place
    #[arg(long, value_enum, default_value_t = View::Observer)]
    pub(super) view: View,
    /// How the observer's view is made; from outside there are photosurfaces only
    /// [default: rays for the observer, mesh from outside]
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Width and height of the picture in pixels, of each picture on a sheet [default: 1280x720, on a sheet 320x240]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<PictureSize>,
    /// Field of view from the lower to the upper edge, in degrees, above 0 and below 180, or below 360 in stereographic
    /// projection [default: so that everything is in the picture; 60 with --look or --target, and for an observer who flies or
    /// whose axes are turned; 30 from outside]
    #[arg(long, value_name = "DEG", value_parser = number, allow_hyphen_values = true)]
    fov: Option<f64>,
    /// How directions are laid out [default: perspective, but stereographic for the observer where everything in
    /// perspective would be more than 100 degrees wide]
    #[arg(long, value_enum)]
    projection: Option<ProjectionName>,
    /// Show the whole sky as a longitude-latitude map, twice as wide as high: --projection full-sky
    #[arg(long, conflicts_with_all = ["fov", "projection"])]
    full_sky: bool,
    /// Aim the observer's camera at the middle of the objects at each step anew [default on a sheet]
    #[arg(long, conflicts_with_all = ["hold", "look", "target"])]
    track: bool,
    /// Hold one direction for all steps: the middle of the whole passage or, if the passage is too wide for a picture, the
    /// direction of motion; an observer who flies looks along its own -z [default in several pictures and films]
    #[arg(long)]
    hold: bool,
    /// Direction in which the camera looks, of any length [default: towards the middle of the objects; for an observer
    /// who flies, or whose axes are turned, its own -z]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, conflicts_with = "target")]
    look: Option<DVec3>,
    /// Place at which the camera looks, in scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Place of an outside camera, in scene units; the observer is at 0,0,0 [default: so that all of every step
    /// is in the picture]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    from: Option<DVec3>,
    /// Show all steps on one sheet: above, what the observer sees, with its proper time; below, the photosurface from
    /// outside, at one scale
    #[arg(long, conflicts_with_all = ["view", "look", "target", "full_sky"])]
    pub(super) sheet: bool,
    /// How many steps a sheet has beside each other [default: at most 8, in rows of about equal length]
    #[arg(long, value_name = "N", value_parser = count, allow_hyphen_values = true, requires = "sheet")]
    columns: Option<NonZeroUsize>,
    /// Show the photosurfaces of all steps in one picture (--view outside)
    #[arg(long, conflicts_with = "sheet")]
    pub(super) together: bool,
    /// Draw only the pictures, or frames of a film, from A up to B, B not included, counted from 0: names, numbers and cameras
    /// are those of the whole
    #[arg(long, value_name = "A..B", value_parser = part, conflicts_with_all = ["sheet", "together"])]
    only: Option<Range<usize>>,
    /// Antialias with N x N rays per pixel, N from 1 to 16
    #[arg(long, value_name = "N", default_value = "3", value_parser = samples, allow_hyphen_values = true)]
    pub(super) samples: NonZeroU32,
    /// Background colour, #rrggbb, white or black [default: #14171c; black where a scene has lamps, black bodies or the searchlight effect]
    #[arg(long, value_name = "COLOR", value_parser = color)]
    background: Option<Color>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum View {
    /// From the observer's place, with the light that arrives there
    Observer,
    /// From any other place
    Outside,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ProjectionName {
    /// Straight lines stay straight
    Perspective,
    /// Circles on the sky stay circles
    Stereographic,
    /// The whole sky in longitude and latitude
    FullSky,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Method {
    /// Follow light back to where it came from
    Rays,
    /// Draw the photosurfaces
    Mesh,
}

impl From<Method> for PictureMethod {
    fn from(method: Method) -> Self {
        match method {
            Method::Rays => Self::Rays,
            Method::Mesh => Self::Mesh,
        }
    }
}

impl CameraArgs {
    /// How the observer's view is made, if there is one.
    pub(super) fn method(&self) -> anyhow::Result<Method> {
        let outside = self.view == View::Outside;
        ensure!(
            outside || !self.together,
            "--together is for --view outside"
        );
        ensure!(
            !outside || !(self.track || self.hold),
            "--track and --hold are for the observer's camera; one from outside stands still"
        );
        ensure!(
            self.fov.is_none() || !self.shows_full_sky(),
            "--fov is for pictures of a part of the sky, --projection full-sky shows all of it"
        );
        match self.method {
            Some(Method::Rays) if outside => bail!(
                "--method rays is what the observer sees; from outside there are photosurfaces only (--method mesh)"
            ),
            _ if !outside && !self.sheet && self.from.is_some() => {
                bail!("--from is for --view outside; the observer is at 0,0,0")
            }
            Some(method) => Ok(method),
            None if outside => Ok(Method::Mesh),
            None => Ok(Method::Rays),
        }
    }

    /// Flags of meshes are an error where there are rays alone.
    pub(super) fn refuse_unused(&self, method: Method, of_meshes: &[Given]) -> anyhow::Result<()> {
        match self.shows_meshes(method) {
            true => Ok(()),
            false => refuse(
                of_meshes,
                "is for meshes, which rays do not need; add --method mesh, --view outside or --sheet",
            ),
        }
    }

    /// Whether there are photosurfaces in the pictures.
    pub(super) fn shows_meshes(&self, method: Method) -> bool {
        self.sheet || method == Method::Mesh
    }

    /// The background of pictures of a scene: where brightness tells something, nothing is darker than it.
    pub(super) fn background(&self, scene: &Scene, default: Color) -> Color {
        let mut objects = scene.objects().iter();
        let tells = scene.effects().shown().searchlight
            || !scene.lamps().is_empty()
            || objects.any(|object| object.emission.is_some());
        let default = if tells { Color([0; 3]) } else { default };
        self.background.unwrap_or(default)
    }

    /// The pictures that the flags ask for.
    pub(super) fn settings(&self, method: Method) -> anyhow::Result<PictureSettings> {
        let view = self.picture_view(method.into());
        let mut settings = PictureSettings::new(view);
        let mut size = settings.camera.size;
        if self.shows_full_sky() {
            size = PictureSize::new(1280, 640)?;
        }
        let size = self.size.unwrap_or(size);
        ensure!(
            !self.shows_full_sky() || size.width() == 2 * size.height(),
            "--size {}x{}: the whole sky is twice as wide as high, expected a size such as 1280x640",
            size.width(),
            size.height()
        );
        settings.camera = CameraSettings {
            size,
            projection: self.projection(),
            field_of_view: self.fov.map_or(FieldOfView::Fitting, FieldOfView::Degrees),
            aim: self.aim(),
            follow: match (self.hold, self.track) {
                (true, _) => Follow::Hold,
                (_, true) => Follow::Track,
                _ => Follow::Usual,
            },
        };
        settings.columns = self.columns;
        settings.only.clone_from(&self.only);
        settings.samples = self.samples;
        Ok(settings)
    }

    /// Whether the projection is left to the program.
    pub(super) fn chooses_projection(&self) -> bool {
        self.projection.is_none() && !self.full_sky
    }

    /// Whether the observer's camera follows the objects.
    pub(super) fn tracks(&self) -> bool {
        self.track || self.sheet && !self.hold
    }

    /// Whether the pictures are of the whole sky.
    pub(super) fn shows_full_sky(&self) -> bool {
        self.full_sky || self.projection == Some(ProjectionName::FullSky)
    }

    fn projection(&self) -> PictureProjection {
        match self.projection {
            _ if self.full_sky => PictureProjection::FullSky,
            None => PictureProjection::Usual,
            Some(ProjectionName::Perspective) => PictureProjection::Perspective,
            Some(ProjectionName::Stereographic) => PictureProjection::Stereographic,
            Some(ProjectionName::FullSky) => PictureProjection::FullSky,
        }
    }

    fn picture_view(&self, method: PictureMethod) -> PictureView {
        let (from, together) = (self.from, self.together);
        match self.view {
            _ if self.sheet => PictureView::Sheet { method, from },
            View::Observer => PictureView::Observer(method),
            View::Outside => PictureView::Outside { from, together },
        }
    }

    fn aim(&self) -> Aim {
        match (self.look, self.target) {
            (Some(look), _) => Aim::Look(look),
            (_, Some(target)) => Aim::Target(target),
            _ => Aim::Usual,
        }
    }

    /// The error of a job with the flag that it is about.
    pub(super) fn flagged(&self, error: RenderError) -> anyhow::Error {
        let RenderError::Framing(error) = error else {
            return error.into();
        };
        match error {
            FramingError::Camera(error @ CameraError::FieldOfView { .. }) => {
                anyhow::Error::new(error).context("--fov")
            }
            FramingError::Camera(error @ CameraError::Look(_)) if self.look.is_some() => {
                anyhow::Error::new(error).context("--look")
            }
            FramingError::TargetIsCamera(_) => {
                anyhow!("--target is the place of the camera, expected another one")
            }
            FramingError::CameraInMiddle(_) => anyhow!(
                "--from is the middle of what is shown, expected another place, or a --look"
            ),
            FramingError::TooFar { .. } => {
                anyhow!("{error}; look at other --steps, or at a lower speed")
            }
            _ => error.into(),
        }
    }
}

/// `WxH`
pub(super) fn size(text: &str) -> anyhow::Result<PictureSize> {
    let (width, height) = text
        .split_once(['x', 'X'])
        .context("expected WxH like 1280x720")?;
    let number = |text: &str| {
        let text = text.trim();
        text.parse().with_context(|| {
            format!("\"{text}\" is not a number of pixels; expected WxH like 1280x720")
        })
    };
    Ok(PictureSize::new(number(width)?, number(height)?)?)
}

/// Rays a pixel along each side.
pub(super) fn samples(text: &str) -> anyhow::Result<NonZeroU32> {
    let number = text.trim().parse().ok();
    let number = number.filter(|number: &NonZeroU32| number.get() <= 16);
    number.with_context(|| format!("\"{text}\" is not a number of rays (expected 1 to 16)"))
}

/// `#rrggbb`, `white` or `black`
fn color(text: &str) -> anyhow::Result<Color> {
    Ok(match text {
        "white" => Color([255; 3]),
        "black" => Color([0; 3]),
        _ => Color::try_from(text.to_owned())?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_colours_are_read() {
        let read = size("640x480").unwrap();
        assert_eq!((read.width(), read.height()), (640, 480));
        for wrong in ["", "640", "0x480", "640x-1", "640x99999", "axb"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(color("#ff0080").unwrap(), Color([255, 0, 128]));
        assert_eq!(color("white").unwrap(), Color([255; 3]));
        assert!(color("red").is_err());
    }
}
