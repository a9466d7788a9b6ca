//! Which views stand where in a picture: scenes beside each other, steps of a sheet.

use std::num::NonZeroUsize;
use std::ops::Range;

use super::caption::strip_height;
use super::grid::grid_size;
use super::guides::Guides;
use super::picture_settings::{PictureSettings, PictureView};
use crate::render::{CameraError, PictureSize};

/// The scenes that are shown beside each other: so many rows of so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// One scene at one step, or at several steps together; on a sheet two views, one above the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// The number of the scene, counted from 0 row by row.
    pub(super) scene: usize,
    pub(super) steps: Range<usize>,
}

/// The cells of a picture, row by row.
pub(super) type Page = Vec<Vec<Cell>>;

impl PictureSettings {
    /// The size, in pixels, of the pictures of a scene with `steps` steps: the size of the camera's picture or of the
    /// whole sheet.
    ///
    /// # Errors
    ///
    /// An error is returned if a sheet has more pixels along one side than a picture may have.
    pub fn picture_size(&self, steps: usize) -> Result<PictureSize, CameraError> {
        self.side_by_side_size(1, 1, steps)
    }

    /// As [`PictureSettings::picture_size`], of so many rows and columns of scenes beside each other.
    ///
    /// # Errors
    ///
    /// As [`PictureSettings::picture_size`].
    pub fn side_by_side_size(
        &self,
        rows: usize,
        columns: usize,
        steps: usize,
    ) -> Result<PictureSize, CameraError> {
        let pages = self.pages(Shape { rows, columns }, steps);
        pages
            .first()
            .map_or(Ok(self.camera.size), |page| self.page_size(page))
    }

    /// The pictures of scenes with so many steps.
    pub(super) fn pages(&self, scenes: Shape, steps: usize) -> Vec<Page> {
        pages(self.view, scenes, steps, self.columns)
    }

    /// The size, in pixels, of a picture of these cells.
    pub(super) fn page_size(&self, page: &Page) -> Result<PictureSize, CameraError> {
        let columns = page.iter().map(Vec::len).max().unwrap_or(1);
        let rows = page.len() * self.views_of_a_cell();
        let size = grid_size(self.camera.size, columns, rows)?;
        PictureSize::new(size.width(), size.height() + self.strip_height())
    }

    /// The height of the strip above a sheet in which the caption of all of it stands, in pixels.
    pub(super) fn strip_height(&self) -> u32 {
        let Guides {
            caption, ghosts, ..
        } = &self.guides;
        let has_ghosts = !caption.is_none() && !ghosts.is_empty();
        match self.view {
            PictureView::Sheet { .. } if caption.is_of_a_sheet() || has_ghosts => {
                strip_height(self.camera.size.height())
            }
            _ => 0,
        }
    }

    /// How many views stand above each other for a scene at a step.
    pub(super) fn views_of_a_cell(&self) -> usize {
        match self.view {
            PictureView::Sheet { .. } => 2,
            _ => 1,
        }
    }
}

/// The pictures of scenes with so many steps. `columns` is how many steps a sheet of single scenes has beside each other.
fn pages(
    view: PictureView,
    Shape { rows, columns }: Shape,
    steps: usize,
    columns_asked: Option<NonZeroUsize>,
) -> Vec<Page> {
    let beside = |steps: Range<usize>| {
        let row = |row: usize| {
            let scenes = row * columns..(row + 1) * columns;
            scenes.map(|scene| cell(scene, steps.clone())).collect()
        };
        (0..rows).map(row).collect::<Page>()
    };
    match view {
        PictureView::Outside { together: true, .. } => vec![beside(0..steps)],
        PictureView::Outside { .. } | PictureView::Observer(_) => {
            (0..steps).map(|step| beside(step..step + 1)).collect()
        }
        PictureView::Sheet { .. } if columns == 1 => {
            let wide = sheet_columns(steps, columns_asked);
            let row = |scene: usize, from: usize| {
                let steps = from..(from + wide).min(steps);
                steps.map(|step| cell(scene, step..step + 1)).collect()
            };
            let rows = (0..rows)
                .flat_map(|scene| (0..steps).step_by(wide).map(move |from| row(scene, from)));
            vec![rows.collect()]
        }
        // A column for each scene, the steps below each other.
        PictureView::Sheet { .. } => {
            let rows = (0..rows).flat_map(|row| {
                (0..steps).map(move |step| {
                    let scenes = row * columns..(row + 1) * columns;
                    scenes.map(|scene| cell(scene, step..step + 1)).collect()
                })
            });
            vec![rows.collect()]
        }
    }
}

fn cell(scene: usize, steps: Range<usize>) -> Cell {
    Cell { scene, steps }
}

/// How many steps a sheet has beside each other: as many as asked for, or in rows of about equal length.
fn sheet_columns(steps: usize, asked: Option<NonZeroUsize>) -> usize {
    const MOST: usize = 8;
    match asked {
        Some(columns) => columns.get(),
        None => steps.div_ceil(steps.div_ceil(MOST).max(1)).max(1),
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture_settings::PictureMethod;
    use super::*;

    const SHEET: PictureView = PictureView::Sheet {
        method: PictureMethod::Rays,
        from: None,
    };

    /// The scenes and first steps of a picture.
    fn numbers(page: &Page) -> Vec<Vec<(usize, usize)>> {
        let row = |row: &Vec<Cell>| {
            row.iter()
                .map(|cell| (cell.scene, cell.steps.start))
                .collect()
        };
        page.iter().map(row).collect()
    }

    #[test]
    fn the_steps_of_a_sheet_wrap() {
        let one = Shape {
            rows: 1,
            columns: 1,
        };
        let widths = |steps, asked| {
            let page = &pages(SHEET, one, steps, NonZeroUsize::new(asked))[0];
            page.iter().map(Vec::len).collect::<Vec<_>>()
        };
        assert_eq!(widths(7, 0), [7]);
        assert_eq!(widths(9, 0), [5, 4]);
        assert_eq!(widths(17, 0), [6, 6, 5]);
        assert_eq!(widths(7, 3), [3, 3, 1]);
        assert_eq!(widths(2, 5), [2]);
    }

    #[test]
    fn scenes_are_rows_or_columns() {
        let speeds = Shape {
            rows: 2,
            columns: 1,
        };
        let sheet = &pages(SHEET, speeds, 3, None)[0];
        let first = [(0, 0), (0, 1), (0, 2)];
        assert_eq!(numbers(sheet), [first, first.map(|(_, step)| (1, step))]);
        let models = Shape {
            rows: 2,
            columns: 2,
        };
        let sheet = &pages(SHEET, models, 2, None)[0];
        let expected = [
            [(0, 0), (1, 0)],
            [(0, 1), (1, 1)],
            [(2, 0), (3, 0)],
            [(2, 1), (3, 1)],
        ];
        assert_eq!(numbers(sheet), expected);
        let pictures = pages(PictureView::Observer(PictureMethod::Rays), models, 3, None);
        assert_eq!(pictures.len(), 3);
        assert_eq!(numbers(&pictures[1]), [[(0, 1), (1, 1)], [(2, 1), (3, 1)]]);
        let together = PictureView::Outside {
            from: None,
            together: true,
        };
        let page = &pages(together, speeds, 4, None)[0];
        assert_eq!((page.len(), page[1][0].steps.clone()), (2, 0..4));
    }
}
