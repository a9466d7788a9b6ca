//! Which two maps of a material become one picture, and what that picture is known by.

use std::path::PathBuf;

/// Two maps that are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Packing {
    /// The base colour, white where there is no picture of it, and the opacity.
    Opacity,
    /// The roughness and the metalness, of which one may be missing.
    Gloss,
}

impl Packing {
    pub(super) fn statements(self) -> [&'static str; 2] {
        match self {
            Self::Opacity => ["map_Kd", "map_d"],
            Self::Gloss => ["map_Pr", "map_Pm"],
        }
    }
}

/// What a packed texture is made of: the files and whether it ends at its edge.
pub(super) type Key = (Packing, [Option<PathBuf>; 2], bool);
