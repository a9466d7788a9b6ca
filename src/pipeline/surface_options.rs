//! What is wanted of photosurfaces.

use crate::scene::Attributes;
use crate::tessellate::Precision;

/// What is wanted of photosurfaces beside their shape, and how much may be spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// What is to be known of every vertex.
    pub attributes: Attributes,
    /// Whether meshes are refined until they are within the tolerance; if not, every vertex stays what it is and
    /// the certificate tells how far off the mesh is.
    pub subdivide: bool,
    /// How many digits the file will have.
    pub precision: Precision,
}

impl Default for SurfaceOptions {
    /// Meshes within the tolerance, for glTF, and nothing else.
    fn default() -> Self {
        Self {
            attributes: Attributes::default(),
            subdivide: true,
            precision: Precision::Single,
        }
    }
}
