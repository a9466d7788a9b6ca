//! Options for making photosurfaces.

use crate::scene::Attributes;
use crate::tessellate::Precision;

/// Options for making photosurfaces: attributes, refinement and precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// The attributes that every vertex gets.
    pub attributes: Attributes,
    /// Whether meshes are refined until they are within the tolerance; if not, no vertex is added and the certificate
    /// states the resulting bound.
    pub subdivide: bool,
    /// The precision of positions in the file.
    pub precision: Precision,
}

impl Default for SurfaceOptions {
    /// Meshes refined to the tolerance, in single precision for glTF, without attributes.
    fn default() -> Self {
        Self {
            attributes: Attributes::default(),
            subdivide: true,
            precision: Precision::Single,
        }
    }
}
