//! What the one animation of a file is made of.

use std::collections::HashMap;

use gltf::json::{self, Index, animation};

/// Channels, and the key frames that they share.
#[derive(Default)]
pub(super) struct Tracks {
    pub(super) channels: Vec<animation::Channel>,
    pub(super) samplers: Vec<animation::Sampler>,
    /// Those that are used again: by the frame that is shown, or by how many targets there are weights for.
    pub(super) keys: HashMap<usize, Keys>,
}

/// Times and what holds there.
#[derive(Clone, Copy)]
pub(super) struct Keys {
    pub(super) times: Index<json::Accessor>,
    pub(super) values: Index<json::Accessor>,
}
