//! Which pictures of a scene are drawn, from where and how.

use std::collections::BTreeSet;
use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::caption::Caption;
use super::files::file_for_each_step;
use super::framing::CameraSettings;
use super::guides::Guides;
use super::overview::Overview;
use crate::pipeline::SurfaceOptions;
use crate::render::{PictureOptions, PictureSize};
use crate::shape::Color;
use crate::tessellate::Precision;
use crate::write::Fingerprint;

/// Which pictures of a scene are drawn, and from where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureView {
    /// The observer's view: one picture for each step.
    Observer(PictureMethod),
    /// Photosurfaces seen from outside, together with the observer's marker, if the scene has one.
    Outside {
        /// The position of the camera in the observer's frame, in scene units; with `None` the camera stands where it
        /// has everything at every step in the picture.
        from: Option<DVec3>,
        /// Whether the photosurfaces of all steps are in one picture; if not, there is one picture for each step.
        together: bool,
    },
    /// One picture of all steps beside each other: above, the observer's view, labelled with the observer's proper time;
    /// below, the photosurface from outside, all at one scale.
    Sheet {
        /// How the observer's views are drawn.
        method: PictureMethod,
        /// The position of all cameras outside, as for [`PictureView::Outside`].
        from: Option<DVec3>,
    },
}

/// How the observer's view is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureMethod {
    /// By rays of light that are followed back to the surfaces from which they came: exact at every pixel.
    #[default]
    Rays,
    /// By drawing the photosurfaces, which are exact within their tolerance.
    Mesh,
}

/// All settings on which the pictures of a scene depend.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSettings {
    /// Which pictures are drawn, and from where.
    pub view: PictureView,
    /// The settings of the cameras. On a sheet the size is the size of each view.
    pub camera: CameraSettings,
    /// How many steps a sheet of one scene, or of each of several, has beside each other; with `None` at most eight, in rows
    /// of about equal length.
    pub columns: Option<NonZeroUsize>,
    /// Which of several pictures are drawn, counted from 0, as they are among all: with `None` all of them.
    pub only: Option<Range<usize>>,
    /// The numbers of pictures that are not drawn although they are among these, since they are there already.
    pub skipped: BTreeSet<usize>,
    /// What was found before by looking at all steps; with `None` they are looked at once more. A sheet, which has no parts,
    /// takes no notice of it.
    pub overview: Option<Overview>,
    /// Number of rays along each side of a pixel: N gives N x N rays per pixel. More than 1024 count as 1024.
    pub samples: NonZeroU32,
    /// The colour where nothing is seen.
    pub background: Color,
    /// Marks that help to read the pictures.
    pub guides: Guides,
    /// How photosurfaces are made if the pictures show them. A limit on their triangles belongs to the placed scene;
    /// see [`Fitted`](crate::jobs::Fitted).
    pub surface_options: SurfaceOptions,
}

impl PictureSettings {
    /// The default settings of the command `photosurface render`: 1280 by 720 pixels, or 320 by 240 for each view of a
    /// sheet, and nine rays per pixel. The cameras have everything in the picture. A sheet has a caption.
    pub fn new(view: PictureView) -> Self {
        let [width, height] = match view {
            PictureView::Sheet { .. } => [320, 240],
            _ => [1280, 720],
        };
        let size = PictureSize::new(width, height).expect("both sides are within the limits");
        let options = PictureOptions::default();
        Self {
            view,
            camera: CameraSettings::new(size),
            columns: None,
            only: None,
            skipped: BTreeSet::new(),
            overview: None,
            samples: NonZeroU32::new(options.samples).unwrap_or(NonZeroU32::MIN),
            background: options.background,
            guides: match view {
                PictureView::Sheet { .. } => Guides {
                    caption: Caption::STANDARD,
                    scale_bar: true,
                    ..Guides::default()
                },
                _ => Guides::default(),
            },
            surface_options: SurfaceOptions {
                precision: Precision::Double,
                ..SurfaceOptions::default()
            },
        }
    }

    /// Number of pictures of a scene with `steps` steps.
    pub fn picture_count(&self, steps: usize) -> usize {
        match self.view {
            PictureView::Sheet { .. } | PictureView::Outside { together: true, .. } => 1,
            _ => steps,
        }
    }

    /// The numbers of the pictures that are drawn of a scene with `steps` steps, counted from 0.
    pub fn drawn(&self, steps: usize) -> Range<usize> {
        let count = self.picture_count(steps);
        match &self.only {
            Some(only) => only.start.min(count)..only.end.min(count),
            None => 0..count,
        }
    }

    /// Whether a picture, which is counted from 0, is drawn of a scene with `steps` steps.
    pub(super) fn is_drawn(&self, number: usize, steps: usize) -> bool {
        self.drawn(steps).contains(&number) && !self.skipped.contains(&number)
    }

    /// The fingerprint of a picture with these settings, whose scenes, with their files, have this fingerprint.
    pub fn fingerprint(&self, scenes: Fingerprint, number: usize) -> Fingerprint {
        self.fingerprint_of_all(scenes).with("number", &number)
    }

    /// The fingerprint of all pictures with these settings, and of their [`Overview`].
    pub fn fingerprint_of_all(&self, scenes: Fingerprint) -> Fingerprint {
        let whole = Self {
            only: None,
            skipped: BTreeSet::new(),
            overview: None,
            ..self.clone()
        };
        scenes.with("pictures", &whole)
    }

    /// Whether all pictures are of a kind that has an [`Overview`]: each is of one step.
    pub fn has_overview(&self) -> bool {
        !matches!(
            self.view,
            PictureView::Sheet { .. } | PictureView::Outside { together: true, .. }
        )
    }

    /// The files that [`render_to_files`](super::render_to_files) makes of a scene with `steps` steps, in the order of the pictures: `path`
    /// itself for one picture; `NAME_step000.png`, `NAME_step001.png` and so on in the same folder for several.
    pub fn files(&self, path: &Path, steps: usize) -> Vec<PathBuf> {
        match self.picture_count(steps) {
            1 => vec![path.to_owned()],
            count => file_for_each_step(path, count),
        }
    }
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
