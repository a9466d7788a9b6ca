//! What a surface is made of, as far as it travels: base colour, texture, gloss, sidedness.
//!
//! The terms and defaults are those of glTF 2.0, section 3.9.

use std::sync::Arc;

/// A material in the terms of glTF's metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// As the source names it.
    pub name: Option<String>,
    /// Linear red, green, blue and opacity.
    pub base_color: [f32; 4],
    /// Multiplies the base colour.
    pub base_color_texture: Option<Texture>,
    /// From 0, an insulator, to 1, a metal.
    pub metallic: f32,
    /// From 0, a mirror, to 1, matt.
    pub roughness: f32,
    /// Multiplies metalness by its blue and roughness by its green.
    pub metallic_roughness_texture: Option<Texture>,
    /// What the opacity means.
    pub alpha_mode: AlphaMode,
    /// Whether the back of the triangles is drawn.
    pub double_sided: bool,
}

impl Material {
    /// All textures there are.
    pub fn textures(&self) -> impl Iterator<Item = &Texture> {
        let slots = [&self.base_color_texture, &self.metallic_roughness_texture];
        slots.into_iter().flatten()
    }
}

impl Default for Material {
    /// glTF's default values, which are those of a metal.
    fn default() -> Self {
        Self {
            name: None,
            base_color: [1.0; 4],
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
        }
    }
}

/// What the opacity of a material means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// Opaque from this opacity on, else absent.
    Mask(f32),
    /// Blended with what is behind.
    Blend,
}

/// An image and the way it is laid on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Shared by all textures that use it.
    pub image: Arc<Image>,
    /// Which `TEXCOORD_n` places it.
    pub tex_coord: u32,
    /// How it is read.
    pub sampler: Sampler,
}

/// An image as its file has it, byte for byte.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    /// As the source names it.
    pub name: Option<String>,
    /// `image/png` or `image/jpeg`.
    pub mime_type: String,
    /// The file.
    pub bytes: Vec<u8>,
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Image")
            .field("name", &self.name)
            .field("mime_type", &self.mime_type)
            .field("bytes", &self.bytes.len())
            .finish()
    }
}

/// How a texture is read between and beyond its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Sampler {
    /// Where a pixel of the texture covers several of the picture.
    pub mag_filter: Option<Filter>,
    /// Where a pixel of the picture covers several of the texture.
    pub min_filter: Option<Filter>,
    /// Beyond the left and right edge.
    pub wrap_s: Wrap,
    /// Beyond the upper and lower edge.
    pub wrap_t: Wrap,
}

/// How a texture is read between its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Filter {
    Nearest,
    Linear,
    NearestMipmapNearest,
    LinearMipmapNearest,
    NearestMipmapLinear,
    LinearMipmapLinear,
}

/// How a texture continues beyond its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[allow(missing_docs)]
pub enum Wrap {
    ClampToEdge,
    MirroredRepeat,
    #[default]
    Repeat,
}
