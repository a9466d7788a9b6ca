//! Pictures of all steps of a scene, drawn in one call.

use std::path::Path;

use super::exposure::expose;
use super::files::check_outputs;
use super::picture_settings::{PictureSettings, PictureView};
use super::progress::Progress;
use super::rendered::{RenderError, Rendered};
use super::sheet::draw_sheet;
use super::views::Views;
use crate::pipeline::PlacedScene;
use crate::render::{Picture, Textures};
use crate::write::write_whole;

/// Draws pictures of a scene: one for each step, or one for all steps, depending on `settings.view`.
///
/// `finished` is called with each picture as soon as it is drawn, and with the picture's number, counted from 0; an
/// error that it returns ends the job. `progress` gets a report of each row of pixels of each view. Textures that
/// cannot be decoded are left out and are among [`Textures::missing`] afterwards. Pictures are the same, to the byte,
/// for any number of threads.
///
/// # Errors
///
/// The errors are a [`RenderError`], converted to the caller's type, if the settings allow no camera, if a sheet is too
/// large or if `progress` cancels the job; or an error of `finished`. Pictures that were finished before stay with the
/// caller.
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
    expose(std::slice::from_mut(&mut views))?;
    match settings.view {
        PictureView::Observer(_) => {
            let fov = views.observer_fov_deg()?;
            for step in 0..steps {
                let mut picture = views.observer(step, fov)?;
                views.draw_legend(&mut picture);
                finished(step, &picture)?;
            }
        }
        PictureView::Outside { from, together } => {
            let camera = views.outside_camera(from)?;
            let pictures = if together { 1 } else { steps };
            for number in 0..pictures {
                let shown = match together {
                    true => 0..steps,
                    false => number..number + 1,
                };
                let mut picture = views.outside(shown, &camera)?;
                views.draw_legend(&mut picture);
                finished(number, &picture)?;
            }
        }
        PictureView::Sheet { from, .. } => finished(0, &draw_sheet(&mut views, from)?)?,
    }
    Ok(views.rendered)
}

/// Draws pictures as [`render()`] does, and writes each as PNG to its file of [`PictureSettings::files`] as soon as it
/// is drawn. A file appears whole or not at all.
///
/// # Errors
///
/// The errors of [`render()`], or the error of a file that cannot be written, which is found before anything is drawn
/// if possible. Files that were finished before stay.
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
