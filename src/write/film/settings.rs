//! What a film is to be.

use super::format::FilmFormat;
use super::rate::FrameRate;
use crate::render::PictureSize;

/// All settings on which a film depends, but for its frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// The format.
    pub format: FilmFormat,
    /// Width and height of every frame. An MP4 with an odd side shows the last row or column of pixels twice.
    pub size: PictureSize,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub rate: FrameRate,
    /// Whether the film begins anew when it has ended, where the format can say so; an MP4 cannot.
    pub loops: bool,
}
