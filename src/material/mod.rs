//! What a surface is made of: a material as glTF says it, and the pictures that it is painted with.
//!
//! A material is kept in the words of its source, glTF 2.0, section 3.9, and its extensions: what the
//! program does not know travels as well as what it knows, and no number changes on the way. What the program
//! needs itself is read out of those words.

mod appearance;
mod error;
mod material;
mod normals;
mod part;
mod pixels;
mod properties;
mod texture;

pub(crate) use appearance::Slot;
pub use error::MaterialError;
pub(crate) use material::position;
pub use material::{AlphaMode, Material};
pub use normals::{Crease, Normals, UnknownNormals};
pub use part::{Model, Part};
pub use pixels::PictureError;
pub(crate) use pixels::decode;
pub(crate) use properties::{clamp_factors, extension_names, retain_textures};
pub(crate) use texture::map_sources;
pub use texture::{Image, Texture, Wrap};
