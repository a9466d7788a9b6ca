//! What goes into one file, and how its steps follow each other.

use std::ops::RangeInclusive;

use crate::material::Part;
use crate::pipeline::{Photosurface, SceneFacts};

/// What goes into one file.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    /// The scene, in words and numbers.
    pub scene: &'a SceneFacts,
    /// The observer's marker, at rest in the observer's frame.
    pub marker: Option<&'a Part>,
    /// One object of the file each, or one for each part where they are morph targets: all with the same of what
    /// may be asked for of vertices.
    pub photosurfaces: &'a [Photosurface],
    /// How steps follow each other, where the format has time; `None` for all at once.
    pub playback: Option<Playback>,
}

/// Frames per second that an animation may have.
pub(crate) const FRAMES_PER_SECOND: RangeInclusive<f64> = 1e-3..=1e3;

/// How the steps of a scene are shown one after another, in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Playback {
    /// Each photosurface is a node, and those of a step have one parent, which is there during its frame: its scale is
    /// 1, and 0 else.
    Frames {
        /// Steps in a second, from 0.001 to 1000.
        frames_per_second: f64,
    },
    /// Each part is one node whose mesh has a morph target for every step after the first. All steps must have the
    /// same triangles, part by part, as [`PlacedScene::morphing`](crate::PlacedScene::morphing) makes them.
    Morph {
        /// Steps in a second, from 0.001 to 1000.
        frames_per_second: f64,
    },
}

impl Playback {
    /// Steps in a second.
    pub fn frames_per_second(self) -> f64 {
        match self {
            Self::Frames { frames_per_second } | Self::Morph { frames_per_second } => {
                frames_per_second
            }
        }
    }
}
