//! The formats that photosurfaces are written in: their names and what they hold.

use std::path::Path;

use crate::pipeline::SurfaceOptions;
use crate::scene::{Attribute, Attributes, Scene};
use crate::tessellate::Precision;

/// A format that photosurfaces are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary glTF, one file.
    Glb,
    /// glTF as JSON with its data in a file beside it.
    Gltf,
    /// Binary PLY.
    Ply,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Glb, Self::Gltf, Self::Ply];

    /// The extension of its files, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Ply => "ply",
        }
    }

    /// The format that a file is in by its name, in upper or lower case; `None` for an unknown extension.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Self::ALL
            .into_iter()
            .find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// What a file of the scene holds of every vertex: what the scene asks for, and in a PLY the Doppler factor.
    pub fn attributes(self, scene: &Scene) -> Attributes {
        match self {
            Self::Glb | Self::Gltf => scene.attributes(),
            Self::Ply => scene.attributes().with(Attribute::Doppler),
        }
    }

    /// How photosurfaces of a scene are made for a file: with its attributes, certified for the precision of its numbers.
    pub fn surface_options(self, scene: &Scene) -> SurfaceOptions {
        let precision = match self {
            Self::Glb | Self::Gltf => Precision::Single,
            Self::Ply => Precision::Double,
        };
        SurfaceOptions {
            attributes: self.attributes(scene),
            precision,
            ..SurfaceOptions::default()
        }
    }
}
