//! Pictures of all steps of a scene, drawn in one call.

use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use glam::DVec3;
use thiserror::Error;

use super::files::{OutputError, check_outputs, file_for_each_step};
use super::framing::{Aim, CameraSettings, FieldOfView, FramingError, OBSERVER_FOV_DEG};
use super::guides::Guides;
use super::progress::{Cancelled, Progress};
use super::sheet::{draw_sheet, sheet_size};
use super::tally::Tally;
use super::views::Views;
use crate::pipeline::{PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::render::{CameraError, Picture, PictureOptions, PictureSize, Textures};
use crate::shape::Color;
use crate::tessellate::Precision;
use crate::write::{WriteError, write_whole};

/// Which pictures of a scene are drawn, and from where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureView {
    /// What the observer sees: one picture for each step.
    Observer(PictureMethod),
    /// Photosurfaces from any other place, together with the observer's marker, if the scene has one.
    Outside {
        /// The place of the camera in the observer's frame, in scene units; with `None` it is where everything at every
        /// step is in the picture.
        from: Option<DVec3>,
        /// Whether the photosurfaces of all steps are in one picture; if not, there is one picture for each step.
        together: bool,
    },
    /// One picture of all steps, a column for each: above, what the observer sees, labelled with its proper time; below,
    /// the photosurface from outside, all at one scale.
    Sheet {
        /// How the observer's views are drawn.
        method: PictureMethod,
        /// The place of all cameras outside, as for [`PictureView::Outside`].
        from: Option<DVec3>,
    },
}

/// How the observer's view is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureMethod {
    /// By rays of light, followed back to where they came from: exact at every pixel.
    #[default]
    Rays,
    /// By looking at the photosurfaces, within their tolerance.
    Mesh,
}

/// Everything that the pictures of a scene depend on beside the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSettings {
    /// Which pictures are drawn, and from where.
    pub view: PictureView,
    /// The cameras. On a sheet the size is that of each view.
    pub camera: CameraSettings,
    /// Number of rays a pixel along each side: N is N x N rays.
    pub samples: NonZeroU32,
    /// The colour where nothing is seen.
    pub background: Color,
    /// Marks in views from outside.
    pub guides: Guides,
    /// How photosurfaces are made where they are in the pictures. A number of triangles that they may have together is a
    /// matter of the placed scene: see [`Fitted`](crate::jobs::Fitted).
    pub surface_options: SurfaceOptions,
}

impl PictureSettings {
    /// The settings that the command `photosurface render` starts from: 1280 by 720 pixels, on a sheet 320 by 240 for each
    /// view, nine rays a pixel; 60 degrees for the observer, and cameras that have everything in the picture otherwise.
    pub fn new(view: PictureView) -> Self {
        let [width, height] = match view {
            PictureView::Sheet { .. } => [320, 240],
            _ => [1280, 720],
        };
        let field_of_view = match view {
            PictureView::Observer(_) => FieldOfView::Degrees(OBSERVER_FOV_DEG),
            _ => FieldOfView::Fitting,
        };
        let options = PictureOptions::default();
        Self {
            view,
            camera: CameraSettings {
                size: PictureSize::new(width, height).expect("both sides are within the limits"),
                field_of_view,
                aim: Aim::Middle,
            },
            samples: NonZeroU32::new(options.samples).unwrap_or(NonZeroU32::MIN),
            background: options.background,
            guides: Guides::default(),
            surface_options: SurfaceOptions {
                precision: Precision::Double,
                ..SurfaceOptions::default()
            },
        }
    }

    /// The size of the pictures of a scene with so many steps, in pixels: that of the camera, or of the whole sheet.
    ///
    /// # Errors
    ///
    /// A sheet with more pixels along one side than a picture may have.
    pub fn picture_size(&self, steps: usize) -> Result<PictureSize, CameraError> {
        match self.view {
            PictureView::Sheet { .. } => sheet_size(self.camera.size, steps),
            _ => Ok(self.camera.size),
        }
    }

    /// Number of pictures of a scene with so many steps.
    pub fn picture_count(&self, steps: usize) -> usize {
        match self.view {
            PictureView::Sheet { .. } | PictureView::Outside { together: true, .. } => 1,
            _ => steps,
        }
    }

    /// The files that [`render_to_files`] makes of a scene with so many steps, in the order of the pictures: `path` itself
    /// for one picture, `NAME_step000.png`, `NAME_step001.png` and so on beside it for several.
    pub fn files(&self, path: &Path, steps: usize) -> Vec<PathBuf> {
        match self.picture_count(steps) {
            1 => vec![path.to_owned()],
            count => file_for_each_step(path, count),
        }
    }

    /// Number of rows of all views of a scene with so many steps: the pieces of work that [`Progress`] hears of.
    fn rows(&self, steps: usize) -> usize {
        let views = match self.view {
            PictureView::Sheet { .. } => 2 * steps,
            _ => self.picture_count(steps),
        };
        self.camera.size.height() as usize * views
    }
}

/// Why there are no pictures, or not all of them.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No camera frames what there is to be seen.
    #[error(transparent)]
    Framing(#[from] FramingError),
    /// A sheet of too many pixels.
    #[error("a sheet of {steps} steps side by side")]
    Sheet {
        /// Number of steps.
        steps: usize,
        /// The size of the sheet, which is beyond the limit.
        source: CameraError,
    },
    /// There are no photosurfaces.
    #[error(transparent)]
    PlacedScene(#[from] PlacedSceneError),
    /// A file that must not, or cannot, be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The caller has ended the job.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for RenderError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<WriteError> for RenderError {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Cancelled => Self::Cancelled,
            error => Self::Output(error.into()),
        }
    }
}

/// What is to be said of pictures that have been drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rendered {
    /// The photosurfaces in the pictures, in sum, each counted once; none where all was drawn by rays.
    pub tally: Tally,
    /// The observer's views that show nothing but the background.
    pub empty: Vec<EmptyView>,
    /// The cost of each view, in the order in which they were drawn; a sheet has two of each step.
    pub costs: Vec<ViewCost>,
}

/// A view of the observer that shows nothing but the background: everything is in another direction, or smaller than a
/// pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmptyView {
    /// The step, counted from 0.
    pub step: usize,
    /// The direction to the middle of the sky that everything takes up at that step: a unit vector in the observer's frame.
    pub look: DVec3,
}

/// What one view has cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCost {
    /// Number of rays that start at the camera.
    pub rays: u64,
    /// Wall-clock time for tracing them, in seconds.
    pub seconds: f64,
}

/// Draws pictures of a scene: one of each step, or one of all of them, as `settings.view` says.
///
/// `finished` has each picture as soon as it is drawn, with its number, counted from 0; an error that it returns ends the
/// job. `progress` hears of each row of each view. Textures that cannot be decoded are left out and are among
/// [`Textures::missing`] afterwards. Pictures are the same, to the byte, for any number of threads.
///
/// # Errors
///
/// A [`RenderError`] as an error of the caller's type: settings for which there is no camera, a sheet that is too large,
/// the end of the job by `progress`; or an error of `finished`. Pictures that were finished before stay with the caller.
///
/// # Example
///
/// ```
/// use photosurface::jobs::RenderError;
/// use photosurface::render::{Picture, PictureSize};
/// use photosurface::{PictureMethod, PictureSettings, PictureView, PlacedScene, Scene, Textures, load_models, render};
///
/// let scene = Scene::from_json(
///     r#"{ "observer": { "velocity": { "beta": 0.8 } }, "steps": [0, 1],
///          "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] } ] }"#,
/// )?;
/// let (models, _) = load_models(&scene, ".".as_ref())?;
/// let placed = PlacedScene::new(scene, models)?;
/// let mut settings = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
/// settings.camera.size = PictureSize::new(64, 36)?;
/// let mut pictures: Vec<Picture> = vec![];
/// render(&placed, &Textures::default(), &settings, &(), |_, picture| {
///     pictures.push(picture.clone());
///     Ok::<(), RenderError>(())
/// })?;
/// assert_eq!(pictures.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render<E: From<RenderError>>(
    placed: &PlacedScene,
    textures: &Textures,
    settings: &PictureSettings,
    progress: &dyn Progress,
    mut finished: impl FnMut(usize, &Picture) -> Result<(), E>,
) -> Result<Rendered, E> {
    let steps = placed.scene().steps().len();
    progress.begin(settings.rows(steps));
    let mut views = Views::new(placed, textures, settings, progress);
    match settings.view {
        PictureView::Observer(_) => {
            let fov = views.observer_fov_deg()?;
            for step in 0..steps {
                finished(step, &views.observer(step, fov)?)?;
            }
        }
        PictureView::Outside { from, together } => {
            let camera = views.outside_camera(from)?;
            if together {
                finished(0, &views.outside(0..steps, &camera)?)?;
            } else {
                for step in 0..steps {
                    finished(step, &views.outside(step..step + 1, &camera)?)?;
                }
            }
        }
        PictureView::Sheet { from, .. } => finished(0, &draw_sheet(&mut views, from)?)?,
    }
    Ok(views.rendered)
}

/// Draws pictures as [`render()`] does and writes each as PNG to its one of [`PictureSettings::files`], as soon as
/// it is drawn. A file appears whole or not at all.
///
/// # Errors
///
/// As [`render()`], or a file that cannot be written; that is found out before anything is drawn where it can be.
/// Files that were finished before stay.
pub fn render_to_files(
    placed: &PlacedScene,
    textures: &Textures,
    settings: &PictureSettings,
    path: &Path,
    progress: &dyn Progress,
) -> Result<Rendered, RenderError> {
    let files = settings.files(path, placed.scene().steps().len());
    check_outputs(files.iter().cloned(), &[])?;
    render(placed, textures, settings, progress, |number, picture| {
        write_whole(&files[number], |writer| Ok(picture.write_png(writer)?))?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_pictures_have_a_file_for_each_step() {
        let observer = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
        let sheet = PictureSettings::new(PictureView::Sheet {
            method: PictureMethod::Rays,
            from: None,
        });
        let path = Path::new("folder/out.of.png");
        assert_eq!(observer.files(path, 1), [path]);
        assert_eq!(sheet.files(path, 7), [path]);
        let files = observer.files(path, 1001);
        assert_eq!(files[0], Path::new("folder/out.of_step000.png"));
        assert_eq!(files[1000], Path::new("folder/out.of_step1000.png"));
        assert_eq!(
            observer.files(Path::new("out"), 2)[1],
            Path::new("out_step001")
        );
    }
}
