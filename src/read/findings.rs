//! What there is to know about a model beside the model.

use std::path::PathBuf;

use super::note::Note;
use super::notes::lines;

/// What there is to know about a model beside the model.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Findings {
    /// What was left out, replaced or chosen.
    pub notes: Vec<Note>,
    /// Every file that belongs to it: the file itself, its buffers, images and material libraries. One file
    /// may be named several times, and an image that is not there.
    pub files: Vec<PathBuf>,
}

impl Findings {
    /// The notes as lines of text, in their order. What is said of several meshes, nodes, materials or images alike is
    /// said once, with how many there are.
    pub fn lines(&self) -> Vec<String> {
        lines(&self.notes)
    }
}
