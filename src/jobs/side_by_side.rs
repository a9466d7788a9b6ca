//! Pictures of several scenes side by side, a column for each: one scene under several models, for example.

use super::exposure::expose;
use super::grid::{Grid, grid_size};
use super::picture_settings::{PictureSettings, PictureView};
use super::progress::Progress;
use super::rendered::{RenderError, Rendered};
use super::sheet::label_of;
use super::views::Views;
use crate::pipeline::PlacedScene;
use crate::render::{CameraError, Picture, PictureSize, Textures};

/// A scene that stands in one column.
#[derive(Clone, Debug)]
pub struct Column {
    /// The words in the upper left corner of the column.
    pub label: String,
    /// The scene.
    pub placed: PlacedScene,
}

/// The size, in pixels, of pictures of so many scenes of `steps` steps side by side.
///
/// # Errors
///
/// An error is returned if there are more pixels along one side than a picture may have.
pub fn side_by_side_size(
    settings: &PictureSettings,
    columns: usize,
    steps: usize,
) -> Result<PictureSize, CameraError> {
    let rows = match settings.view {
        PictureView::Sheet { .. } => 2 * steps,
        _ => 1,
    };
    grid_size(settings.camera.size, columns, rows)
}

/// Draws pictures as [`render()`](super::render()) does, of several scenes side by side.
///
/// The observer's views have one field of view, views from outside one distance from the middle of what they show. A
/// sheet has the steps below each other, each with the observer's view above and the view from outside below.
///
/// # Errors
///
/// As [`render()`](super::render()); also if the scenes differ in their number of steps, or if there is none.
pub fn render_side_by_side<E: From<RenderError>>(
    columns: &[Column],
    textures: &Textures,
    settings: &PictureSettings,
    progress: &dyn Progress,
    mut finished: impl FnMut(usize, &Picture) -> Result<(), E>,
) -> Result<Rendered, E> {
    let steps = match columns {
        [] => return Err(RenderError::NoColumn.into()),
        [first, ..] => first.placed.scene().steps().len(),
    };
    let other = |column: &&Column| column.placed.scene().steps().len() != steps;
    if let Some(column) = columns.iter().find(other) {
        let label = column.label.clone();
        let found = column.placed.scene().steps().len();
        return Err(RenderError::Columns {
            label,
            found,
            steps,
        }
        .into());
    }
    progress.begin(columns.len() * settings.rows(steps));
    let views = columns
        .iter()
        .map(|column| Views::new(&column.placed, textures, settings, progress));
    let mut row = Row {
        views: views.collect(),
        columns,
        settings,
        steps,
    };
    expose(&mut row.views)?;
    let size = side_by_side_size(settings, columns.len(), steps);
    let size = size.map_err(|source| RenderError::Sheet { steps, source })?;
    match settings.view {
        PictureView::Observer(_) => {
            let fov = row.fov_deg()?;
            for step in 0..steps {
                let mut grid = Grid::new(size, settings.camera.size, settings.background);
                row.draw(&mut grid, 0, |views, _| views.observer(step, fov))?;
                finished(step, &grid.picture)?;
            }
        }
        PictureView::Outside { from, together } => {
            let frames = row.views.iter().map(Views::all_framed);
            let frames: Vec<_> = frames.collect::<Result<_, _>>()?;
            let cameras = settings.camera.outside_cameras(from, &frames);
            let cameras = cameras.map_err(RenderError::from)?;
            let pictures = match together {
                true => vec![(0, steps)],
                false => (0..steps).map(|step| (step, step + 1)).collect(),
            };
            for (number, (from, to)) in pictures.into_iter().enumerate() {
                let mut grid = Grid::new(size, settings.camera.size, settings.background);
                row.draw(&mut grid, 0, |views, column| {
                    views.outside(from..to, &cameras[column])
                })?;
                finished(number, &grid.picture)?;
            }
        }
        PictureView::Sheet { from, .. } => {
            let fov = row.fov_deg()?;
            let mut frames = vec![];
            for step in 0..steps {
                for views in &row.views {
                    frames.push(views.framed(step)?);
                }
            }
            let cameras = settings.camera.outside_cameras(from, &frames);
            let cameras = cameras.map_err(RenderError::from)?;
            let mut grid = Grid::new(size, settings.camera.size, settings.background);
            for step in 0..steps {
                let cameras = &cameras[step * columns.len()..];
                row.draw(&mut grid, 2 * step, |views, _| views.observer(step, fov))?;
                row.draw(&mut grid, 2 * step + 1, |views, column| {
                    views.outside(step..step + 1, &cameras[column])
                })?;
            }
            finished(0, &grid.picture)?;
        }
    }
    let each = row.views.into_iter().map(|views| views.rendered);
    Ok(each.fold(Rendered::default(), Rendered::with))
}

/// The views of all columns.
struct Row<'a> {
    views: Vec<Views<'a>>,
    columns: &'a [Column],
    settings: &'a PictureSettings,
    steps: usize,
}

impl Row<'_> {
    /// The vertical field of view of all observer's cameras, in degrees.
    fn fov_deg(&self) -> Result<f64, RenderError> {
        let mut widest = 0.0_f64;
        for views in &self.views {
            widest = widest.max(views.observer_fov_deg()?);
        }
        Ok(widest)
    }

    /// Draws one row of a grid; the first row of a step has the labels.
    fn draw(
        &mut self,
        grid: &mut Grid,
        row: usize,
        draw: impl Fn(&mut Views<'_>, usize) -> Result<Picture, RenderError>,
    ) -> Result<(), RenderError> {
        for (number, (views, column)) in self.views.iter_mut().zip(self.columns).enumerate() {
            let mut picture = draw(views, number)?;
            if row.is_multiple_of(2) {
                let is_sheet = matches!(self.settings.view, PictureView::Sheet { .. });
                let text = match is_sheet && self.steps > 1 {
                    true => {
                        let proper_time = column.placed.scene().steps()[row / 2];
                        format!("{}, {}", column.label, label_of(proper_time))
                    }
                    false => column.label.clone(),
                };
                super::guides::label(&mut picture, &text, self.settings.background);
            }
            let is_last_row = (row + 1) as u32 == grid.rows();
            if is_last_row && number + 1 == self.columns.len() {
                views.draw_legend(&mut picture);
            }
            grid.place(&picture, number, row);
        }
        Ok(())
    }
}
