//! Pictures of all steps of a scene, or of several scenes beside each other, drawn in one call.

use std::path::Path;
use std::time::Instant;

use glam::{DVec2, DVec3};

use super::caption::{Block, Words, draw_strip};
use super::exposure::expose;
use super::files::check_outputs;
use super::grid::Grid;
use super::layout::{Cell, Page, Shape};
use super::observer_frame::{ObserverFrame, heading};
use super::outside_camera::{Contents, OutsideCamera};
use super::overview::Overview;
use super::picture_settings::{PictureMethod, PictureSettings, PictureView};
use super::progress::{Finished, Progress};
use super::rendered::{RenderError, Rendered};
use super::views::Views;
use crate::pipeline::PlacedScene;
use crate::render::{Picture, Projection, Textures};
use crate::scene::{Exposure, Stops};
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
    finished: impl FnMut(usize, &Picture) -> Result<(), E>,
) -> Result<Rendered, E> {
    let shape = Shape {
        rows: 1,
        columns: 1,
    };
    let views = vec![Views::new(placed, textures, settings, progress)];
    Table::new(shape, views, vec![""])?.draw(finished)
}

/// A scene that is shown beside others.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The words in the upper left corner of its views.
    pub label: String,
    /// The scene.
    pub placed: PlacedScene,
}

/// Draws pictures as [`render()`] does, of several scenes beside each other: rows of as many scenes each.
///
/// The observer's views have one field of view, and one direction where the camera holds it; views from outside have one
/// distance from the middle of what they show. A sheet of rows of single scenes has the steps beside each other, any other
/// sheet has the steps below each other.
///
/// # Errors
///
/// As [`render()`]; also if the scenes differ in their number of steps, if the rows differ in their number of scenes, or if
/// there is none.
pub fn render_side_by_side<E: From<RenderError>>(
    rows: &[Vec<Variant>],
    textures: &Textures,
    settings: &PictureSettings,
    progress: &dyn Progress,
    finished: impl FnMut(usize, &Picture) -> Result<(), E>,
) -> Result<Rendered, E> {
    Table::side_by_side(rows, textures, settings, progress)?.draw(finished)
}

/// Looks at all steps of the pictures that [`render_side_by_side`] draws, or, of one scene, [`render()`]: what they have in
/// common. Given in [`PictureSettings::overview`], it spares those who draw a part of the pictures the look at all others.
///
/// # Errors
///
/// As [`render_side_by_side`].
pub fn overview(
    rows: &[Vec<Variant>],
    textures: &Textures,
    settings: &PictureSettings,
    progress: &dyn Progress,
) -> Result<Overview, RenderError> {
    let settings = PictureSettings {
        only: Some(0..0),
        overview: None,
        ..settings.clone()
    };
    Ok(Table::side_by_side(rows, textures, &settings, progress)?.overview)
}

/// The views of scenes beside each other, and the pictures that show them.
struct Table<'a> {
    /// One for each scene, row by row.
    views: Vec<Views<'a>>,
    labels: Vec<&'a str>,
    settings: &'a PictureSettings,
    steps: usize,
    pages: Vec<Page>,
    overview: Overview,
    /// For each cell, in the order of pictures, rows and columns.
    outside: Vec<OutsideCamera>,
}

impl<'a> Table<'a> {
    /// Of rows of scenes.
    fn side_by_side(
        rows: &'a [Vec<Variant>],
        textures: &'a Textures,
        settings: &'a PictureSettings,
        progress: &'a dyn Progress,
    ) -> Result<Self, RenderError> {
        let columns = rows.first().map_or(0, Vec::len);
        let all: Vec<&Variant> = rows.iter().flatten().collect();
        let Some(first) = all.first() else {
            return Err(RenderError::NoScene);
        };
        if rows.iter().any(|row| row.len() != columns) {
            return Err(RenderError::Rows);
        }
        let steps = first.placed.scene().steps().len();
        let other = |variant: &&&Variant| variant.placed.scene().steps().len() != steps;
        if let Some(variant) = all.iter().find(other) {
            let label = variant.label.clone();
            let found = variant.placed.scene().steps().len();
            return Err(RenderError::Steps {
                label,
                found,
                steps,
            });
        }
        let shape = Shape {
            rows: rows.len(),
            columns,
        };
        let views = all
            .iter()
            .map(|variant| Views::new(&variant.placed, textures, settings, progress));
        let labels = all.iter().map(|variant| variant.label.as_str()).collect();
        Self::new(shape, views.collect(), labels)
    }

    /// Frames all views and finds their exposure; there is at least one.
    fn new(
        shape: Shape,
        mut views: Vec<Views<'a>>,
        labels: Vec<&'a str>,
    ) -> Result<Self, RenderError> {
        let settings = views[0].settings;
        let steps = views[0].steps().end;
        let pages = settings.pages(shape, steps);
        let drawn = pages.iter().enumerate();
        let drawn = drawn.filter(|(number, _)| settings.is_drawn(*number, steps));
        let cells = drawn
            .flat_map(|(_, page)| page)
            .map(Vec::len)
            .sum::<usize>();
        let rows = settings.camera.size.height() as usize * cells * settings.views_of_a_cell();
        views[0].progress.begin(rows);
        let found = settings
            .overview
            .as_ref()
            .filter(|_| settings.has_overview());
        let overview = match found {
            Some(found) => {
                found.hand_to(&mut views)?;
                found.clone()
            }
            None => Overview::look(&mut views)?,
        };
        let mut table = Self {
            views,
            labels,
            settings,
            steps,
            pages,
            overview,
            outside: vec![],
        };
        table.outside = match settings.view {
            PictureView::Observer(_) => vec![],
            PictureView::Outside { from, .. } => {
                let cameras = match found {
                    Some(found) => found.outside_cameras(&table.views, from)?,
                    None => table.outside_cameras()?,
                };
                table.overview.outside = cameras.iter().map(OutsideCamera::outlook).collect();
                let cells = table.pages.iter().flatten().flatten();
                cells.map(|cell| cameras[cell.scene]).collect()
            }
            PictureView::Sheet { .. } => table.outside_cameras()?,
        };
        Ok(table)
    }

    /// The cameras outside, at one distance from the middle of what they show: one for each scene at all steps, on a sheet one
    /// for each cell.
    fn outside_cameras(&self) -> Result<Vec<OutsideCamera>, RenderError> {
        let (from, frames) = match self.settings.view {
            PictureView::Observer(_) => return Ok(vec![]),
            PictureView::Outside { from, .. } => {
                let frames = self.views.iter().map(Views::all_framed);
                (from, frames.collect::<Result<Vec<_>, _>>()?)
            }
            PictureView::Sheet { from, .. } => {
                let cells = self.pages.iter().flatten().flatten();
                let frames =
                    cells.map(|cell| self.views[cell.scene].framed_outside(cell.steps.start));
                (from, frames.collect::<Result<Vec<_>, _>>()?)
            }
        };
        let contents = Contents {
            frames: &frames,
            with_axes: self.settings.guides.axes,
        };
        Ok(self.settings.camera.outside_cameras(from, contents)?)
    }

    fn draw<E: From<RenderError>>(
        mut self,
        mut finished: impl FnMut(usize, &Picture) -> Result<(), E>,
    ) -> Result<Rendered, E> {
        let mut before = 0;
        let (settings, steps) = (self.settings, self.steps);
        let progress = self.views[0].progress;
        let mut last = Instant::now();
        for (number, page) in std::mem::take(&mut self.pages).iter().enumerate() {
            if settings.is_drawn(number, steps) {
                let uncertified = self.uncertified();
                let picture = self.picture(page, before)?;
                let now = Instant::now();
                progress.finished(&Finished {
                    steps: match settings.picture_count(steps) {
                        1 => 0..steps,
                        _ => number..number + 1,
                    },
                    of: steps,
                    seconds: (now - last).as_secs_f64(),
                    is_certified: self.uncertified() == uncertified,
                    file: None,
                    is_resumed: false,
                });
                last = now;
                finished(number, &picture)?;
            }
            before += page.iter().map(Vec::len).sum::<usize>();
        }
        let each = self.views.into_iter().map(|views| views.rendered);
        Ok(each.fold(Rendered::default(), Rendered::with))
    }

    /// How many of the photosurfaces in the pictures drawn so far are not certified.
    fn uncertified(&self) -> usize {
        let each = self.views.iter();
        each.map(|views| views.rendered.tally.uncertified).sum()
    }

    /// One picture, before which there are so many cells.
    fn picture(&mut self, page: &Page, before: usize) -> Result<Picture, RenderError> {
        let steps = self.steps;
        let settings = self.settings;
        let size = settings.page_size(page);
        let size = size.map_err(|source| RenderError::Sheet { steps, source })?;
        let top = settings.strip_height();
        let mut grid = Grid::new(size, settings.camera.size, top, settings.background);
        if top > 0 {
            draw_strip(&mut grid.picture, &self.strip(), top, settings.background);
        }
        let last = page.iter().map(Vec::len).sum::<usize>();
        let mut number = 0;
        for (row, cells) in page.iter().enumerate() {
            for (column, cell) in cells.iter().enumerate() {
                let outside = self.outside.get(before + number).copied();
                number += 1;
                let mut pictures = self.cell(cell, outside, number == 1)?;
                if let Some(picture) = pictures.last_mut().filter(|_| number == last) {
                    self.views[cell.scene].draw_legend(picture);
                }
                for (part, picture) in pictures.iter().enumerate() {
                    grid.place(picture, column, row * settings.views_of_a_cell() + part);
                }
            }
        }
        Ok(grid.picture)
    }

    /// The views of one cell, from above; `is_first` is whether it is the first of its picture.
    fn cell(
        &mut self,
        cell: &Cell,
        outside: Option<OutsideCamera>,
        is_first: bool,
    ) -> Result<Vec<Picture>, RenderError> {
        let size = self.settings.camera.size;
        let words = self.words(cell, is_first);
        let caption = Block::in_corner(&words, size.width().into(), size.height().into());
        let views = &mut self.views[cell.scene];
        views.taken_corner = caption.size;
        let mut pictures = vec![];
        if !matches!(self.settings.view, PictureView::Outside { .. }) {
            pictures.push(views.observer(cell.steps.start)?);
        }
        if let Some(camera) = outside {
            pictures.push(views.outside(cell.steps.clone(), &camera)?);
        }
        if let Some(first) = pictures.first_mut() {
            caption.draw(first, self.settings.background);
        }
        Ok(pictures)
    }

    /// The words above a sheet: what is the same in all of it.
    fn strip(&self) -> Vec<Words> {
        let caption = self.settings.guides.caption;
        let title = caption.title(self.views[0].placed).unwrap_or_default();
        let mut words = vec![Words::new(title)];
        words.extend(
            self.common_numbers()
                .unwrap_or_default()
                .into_iter()
                .map(Words::new),
        );
        words.extend(Words::of_ghosts(&self.settings.guides.ghosts));
        words
    }

    /// The numbers of a sheet's caption, if they are the same in all its cells.
    fn common_numbers(&self) -> Option<Vec<String>> {
        let caption = self.settings.guides.caption;
        let mut all = self.views.iter().flat_map(|views| {
            let steps = views.steps();
            steps.map(|step| caption.numbers(views.placed, step..step + 1))
        });
        let first = all.next()?;
        all.all(|other| other == first).then_some(first)
    }

    /// The words on a cell, line by line: title, which scene, numbers, names of ghosts. On a sheet only what differs from cell
    /// to cell.
    fn words(&self, cell: &Cell, is_first: bool) -> Vec<Vec<Words>> {
        let is_sheet = matches!(self.settings.view, PictureView::Sheet { .. });
        let (guides, placed) = (&self.settings.guides, self.views[cell.scene].placed);
        let caption = guides.caption;
        let label = Some(self.labels[cell.scene].to_owned()).filter(|label| !label.is_empty());
        let numbers = match is_sheet && self.common_numbers().is_some() {
            true => vec![],
            // The label says the speed, or the model.
            false if label.is_some() => vec![],
            false => caption.numbers(placed, cell.steps.clone()),
        };
        let time = caption.time(placed, cell.steps.clone());
        let numbers = label.into_iter().chain(numbers).chain(time);
        let is_shown = is_first && !is_sheet;
        let title = caption.title(placed).filter(|_| is_shown).map(Words::new);
        let ghosts = match is_shown && !caption.is_none() {
            true => Words::of_ghosts(&guides.ghosts),
            false => vec![],
        };
        vec![
            title.into_iter().collect(),
            numbers.map(Words::new).collect(),
            ghosts,
        ]
    }
}

/// Finds one frame for the observer's pictures of all scenes, if there are such pictures.
pub(super) fn frame_observer(all: &mut [Views]) -> Result<Option<ObserverFrame>, RenderError> {
    let [first, ..] = all else {
        return Ok(None);
    };
    let is_sheet = matches!(first.settings.view, PictureView::Sheet { .. });
    if matches!(first.settings.view, PictureView::Outside { .. }) {
        return Ok(None);
    }
    let scene = first.placed.scene();
    let camera = first
        .settings
        .camera
        .for_observer(scene.observer(), is_sheet);
    let heading = heading(first.placed);
    let mut skies = vec![];
    if camera.depends_on_skies() {
        for views in all.iter() {
            skies.extend(views.skies()?);
        }
    }
    let frame = ObserverFrame::new(&camera, &skies, heading)?;
    for views in all {
        views.set_frame(Some(frame));
    }
    Ok(Some(frame))
}

/// How the observer's pictures of a scene are framed and exposed where nothing else is asked for.
pub(super) struct FirstView {
    pub(super) projection: Projection,
    /// The direction of the camera at the first step, in the observer's own axes.
    pub(super) look: DVec3,
    pub(super) exposure: Stops,
}

/// Frames and exposes the observer's pictures of a scene, without drawing them.
pub(super) fn first_view(
    placed: &PlacedScene,
    textures: &Textures,
) -> Result<FirstView, RenderError> {
    let settings = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
    let mut views = [Views::new(placed, textures, &settings, &())];
    frame_observer(&mut views)?;
    let exposure = match placed.scene().effects().exposure {
        Exposure::Stops(stops) => stops,
        Exposure::Auto => expose(&mut views)?,
    };
    let [views] = &views;
    let camera = views.observer_camera(&views.framed(0)?)?;
    let size = camera.size();
    let middle = DVec2::new(size.width().into(), size.height().into()) / 2.0;
    let facts = views.rendered.frame.expect("the pictures are framed");
    Ok(FirstView {
        projection: facts.projection,
        look: camera.direction(middle),
        exposure,
    })
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
    let drawn = settings.drawn(placed.scene().steps().len());
    let drawn = files.get(drawn).unwrap_or_default();
    check_outputs(drawn.iter().cloned(), &[])?;
    render(placed, textures, settings, progress, |number, picture| {
        write_whole(&files[number], |writer| Ok(picture.write_png(writer)?))?;
        Ok(())
    })
}
