//! Pictures: what the observer sees, by tracing light back, and surfaces seen from anywhere.
//!
//! An independent witness of the photosurface: nothing here maps a vertex. A ray of light that reaches the
//! observer is turned into the rest frame of each object, where the object is just a thing at rest, and
//! followed back until it meets it. That a picture made so agrees with an ordinary picture of the
//! photosurface is a statement about both (`tests/it/render/pictures.rs`).

mod aberration;
mod albedo;
mod body;
mod bounds;
mod camera;
mod caster;
mod cone;
mod crowd;
mod lettering;
mod lighting;
mod paint;
mod picture;
mod picture_effects;
mod pixel_shader;
mod ray;
mod scenery;
mod shading;
mod shadows;
mod shape_placement;
mod slant;
mod sphere;
mod stroke;
mod texture;
mod tree;
mod turned;
mod viewpoint;

pub use camera::{Camera, CameraError, MAX_PICTURE_SIDE, PictureSize, Projection};
#[cfg(feature = "plot")]
pub(crate) use lettering::FONT;
pub use lettering::lettering_width;
pub(crate) use paint::Paint;
pub use picture::{Picture, PngError};
pub use picture_effects::PictureEffects;
pub(crate) use scenery::grid_places;
pub use scenery::{PictureOptions, Scenery};
pub(crate) use shading::HeadLight;
pub use stroke::Strokes;
pub use texture::{MissingTexture, Textures};
pub use viewpoint::Viewpoint;
