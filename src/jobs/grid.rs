//! Several views of one size in one picture.

use crate::render::{CameraError, Picture, PictureSize};
use crate::shape::Color;

/// Distance between the views of a grid, in pixels.
const GAP: u32 = 4;

/// The size of a grid of so many views of `size`.
pub(super) fn grid_size(
    size: PictureSize,
    columns: usize,
    rows: usize,
) -> Result<PictureSize, CameraError> {
    let along = |count: usize, pixels: u32| {
        let all = (count as u64).saturating_mul(u64::from(pixels + GAP));
        u32::try_from(all.saturating_sub(u64::from(GAP))).unwrap_or(u32::MAX)
    };
    PictureSize::new(along(columns, size.width()), along(rows, size.height()))
}

/// A picture of several views of one size, in columns and rows.
pub(super) struct Grid {
    pub(super) picture: Picture,
    size: PictureSize,
    /// Height of the strip above all views, in pixels.
    top: u32,
}

impl Grid {
    /// A picture of `size` pixels in which nothing stands yet, for views of the size `of_view` with this background, below a
    /// strip of `top` pixels.
    pub(super) fn new(
        size: PictureSize,
        of_view: PictureSize,
        top: u32,
        background: Color,
    ) -> Self {
        let mut picture = Picture::filled(size, between(background));
        if let Ok(strip) = PictureSize::new(size.width(), top) {
            picture.paste(&Picture::filled(strip, background), 0, 0);
        }
        Self {
            picture,
            size: of_view,
            top,
        }
    }

    /// Places a view.
    pub(super) fn place(&mut self, view: &Picture, column: usize, row: usize) {
        let x = column as u32 * (self.size.width() + GAP);
        let y = self.top + row as u32 * (self.size.height() + GAP);
        self.picture.paste(view, x, y);
    }
}

/// The colour between the views of a grid: halfway from the background to grey.
fn between(background: Color) -> Color {
    Color(background.0.map(|level| level / 2 + 0x40))
}
