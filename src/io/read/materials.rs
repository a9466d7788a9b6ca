//! Materials and images of a glTF file.
//!
//! Images are kept byte for byte and never decoded: they only travel. One that cannot be had costs the
//! texture, not the file.

use std::collections::HashMap;
use std::sync::Arc;

use gltf::json;
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};

use super::document::Document;
use super::note::{Note, add_note};
use super::uri::{Folder, read_uri};
use crate::mesh::{AlphaMode, Filter, Image, Material, Sampler, Texture, Wrap};

/// Materials and images of a file, each made once and shared.
pub(super) struct Materials<'a> {
    document: &'a Document,
    folder: &'a Folder<'a>,
    materials: HashMap<usize, Arc<Material>>,
    /// `None` for those that cannot be had.
    images: HashMap<usize, Option<Arc<Image>>>,
}

impl<'a> Materials<'a> {
    /// None so far; external images are looked for in `folder`.
    pub(super) fn new(document: &'a Document, folder: &'a Folder<'a>) -> Self {
        Self {
            document,
            folder,
            materials: HashMap::new(),
            images: HashMap::new(),
        }
    }

    /// The material with an index.
    pub(super) fn material(&mut self, index: usize, notes: &mut Vec<Note>) -> Arc<Material> {
        if let Some(material) = self.materials.get(&index) {
            return material.clone();
        }
        let material = Arc::new(self.read_material(index, notes));
        self.materials.insert(index, material.clone());
        material
    }

    fn read_material(&mut self, index: usize, notes: &mut Vec<Note>) -> Material {
        let source = &self.document.root.materials[index];
        let surface = &source.pbr_metallic_roughness;
        let properties = properties_left(source);
        if !properties.is_empty() {
            let material = source.name.clone();
            let note = Note::Material {
                material: material.unwrap_or_else(|| format!("materials[{index}]")),
                properties,
            };
            add_note(notes, note);
        }
        let base_color_texture = surface.base_color_texture.as_ref();
        let gloss_texture = surface.metallic_roughness_texture.as_ref();
        let metallic_roughness_texture = gloss_texture.and_then(|info| self.texture(info, notes));
        // The factor is 1 where a texture says where the metal is; without it all would be metal, which is
        // black wherever it has nothing to reflect.
        let metallic = match gloss_texture.is_some() && metallic_roughness_texture.is_none() {
            true => 0.0,
            false => surface.metallic_factor.0.clamp(0.0, 1.0),
        };
        Material {
            name: source.name.clone(),
            base_color: surface.base_color_factor.0.map(|c| c.clamp(0.0, 1.0)),
            base_color_texture: base_color_texture.and_then(|info| self.texture(info, notes)),
            metallic,
            roughness: surface.roughness_factor.0.clamp(0.0, 1.0),
            metallic_roughness_texture,
            alpha_mode: match source.alpha_mode.unwrap() {
                json::material::AlphaMode::Opaque => AlphaMode::Opaque,
                json::material::AlphaMode::Mask => {
                    let cutoff = source.alpha_cutoff.unwrap_or_default().0;
                    AlphaMode::Mask(cutoff.clamp(0.0, f32::MAX))
                }
                json::material::AlphaMode::Blend => AlphaMode::Blend,
            },
            double_sided: source.double_sided,
        }
    }

    fn texture(&mut self, info: &json::texture::Info, notes: &mut Vec<Note>) -> Option<Texture> {
        let document = self.document;
        let texture = &document.root.textures[info.index.value()];
        let source = texture.source.value();
        if source >= document.root.images.len() {
            let note = Note::Image {
                image: format!("of textures[{}]", info.index),
                reason: "it has none in PNG or JPEG".to_owned(),
            };
            add_note(notes, note);
            return None;
        }
        let sampler = texture.sampler.map(|s| &document.root.samplers[s.value()]);
        Some(Texture {
            image: self.image(source, notes)?,
            tex_coord: info.tex_coord,
            sampler: sampler.map(read_sampler).unwrap_or_default(),
        })
    }

    fn image(&mut self, index: usize, notes: &mut Vec<Note>) -> Option<Arc<Image>> {
        if let Some(image) = self.images.get(&index) {
            return image.clone();
        }
        let source = &self.document.root.images[index];
        let image = self.image_bytes(index).and_then(|bytes| {
            let name = source.name.clone();
            make_image(name, bytes).ok_or_else(|| "neither PNG nor JPEG".to_owned())
        });
        let image = image.map(Arc::new).map_err(|reason| {
            let name = source.name.as_ref().or(source.uri.as_ref());
            let name = name.filter(|name| !name.starts_with("data:"));
            let image = name.map_or(format!("images[{index}]"), |name| format!("{name:?}"));
            add_note(notes, Note::Image { image, reason });
        });
        let image = image.ok();
        self.images.insert(index, image.clone());
        image
    }

    /// The file of an image, or why it cannot be had.
    fn image_bytes(&self, index: usize) -> Result<Vec<u8>, String> {
        let image = &self.document.root.images[index];
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                let place = format!("images[{index}].uri");
                read_uri(uri, self.folder, u64::MAX, &place).map_err(|error| reason(&error))
            }
            (None, Some(view)) => {
                let bytes = self.document.view(view.value());
                bytes.map(<[u8]>::to_vec).map_err(|error| reason(&error))
            }
            (None, None) => Err("it has neither a uri nor a bufferView".to_owned()),
        }
    }
}

/// An image from its file, whose first bytes tell its type; `None` for a type that glTF does not have.
pub(super) fn make_image(name: Option<String>, bytes: Vec<u8>) -> Option<Image> {
    let mime_type = if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        "image/png"
    } else if bytes.starts_with(b"\xff\xd8\xff") {
        "image/jpeg"
    } else {
        return None;
    };
    Some(Image {
        name,
        mime_type: mime_type.to_owned(),
        bytes,
    })
}

/// An error and its causes in one line.
pub(super) fn reason(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(source) => format!("{error}: {}", reason(source)),
        None => error.to_string(),
    }
}

fn read_sampler(sampler: &json::texture::Sampler) -> Sampler {
    let wrap = |mode| match mode {
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::Repeat => Wrap::Repeat,
    };
    Sampler {
        mag_filter: sampler.mag_filter.map(|filter| match filter.unwrap() {
            MagFilter::Nearest => Filter::Nearest,
            MagFilter::Linear => Filter::Linear,
        }),
        min_filter: sampler.min_filter.map(|filter| match filter.unwrap() {
            MinFilter::Nearest => Filter::Nearest,
            MinFilter::Linear => Filter::Linear,
            MinFilter::NearestMipmapNearest => Filter::NearestMipmapNearest,
            MinFilter::LinearMipmapNearest => Filter::LinearMipmapNearest,
            MinFilter::NearestMipmapLinear => Filter::NearestMipmapLinear,
            MinFilter::LinearMipmapLinear => Filter::LinearMipmapLinear,
        }),
        wrap_s: wrap(sampler.wrap_s.unwrap()),
        wrap_t: wrap(sampler.wrap_t.unwrap()),
    }
}

/// The properties of a material that [`Material`] has no room for.
fn properties_left(source: &json::Material) -> Vec<String> {
    let surface = &source.pbr_metallic_roughness;
    let transformed = |info: &Option<json::texture::Info>| {
        let extensions = info.as_ref().and_then(|info| info.extensions.as_ref());
        extensions.is_some_and(|extensions| extensions.texture_transform.is_some())
    };
    let known = [
        ("normalTexture", source.normal_texture.is_some()),
        ("occlusionTexture", source.occlusion_texture.is_some()),
        ("emissiveTexture", source.emissive_texture.is_some()),
        ("emissiveFactor", source.emissive_factor.0 != [0.0; 3]),
        (
            "KHR_texture_transform of the baseColorTexture",
            transformed(&surface.base_color_texture),
        ),
        (
            "KHR_texture_transform of the metallicRoughnessTexture",
            transformed(&surface.metallic_roughness_texture),
        ),
    ];
    let extensions = source.extensions.as_ref();
    let unlit = extensions.is_some_and(|extensions| extensions.unlit.is_some());
    let others = extensions
        .into_iter()
        .flat_map(|e| e.others.keys().cloned());
    let known = known.into_iter().chain([("KHR_materials_unlit", unlit)]);
    let known = known.filter(|(_, there)| *there);
    known
        .map(|(name, _)| name.to_owned())
        .chain(others)
        .collect()
}
