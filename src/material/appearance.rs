//! What a material looks like in light: numbers, and textures with their places on a surface.
//!
//! # Reference
//!
//! Khronos Group, *glTF 2.0 Specification*, sections 3.9.2 and 3.9.3; the extensions `KHR_texture_transform` and
//! `KHR_materials_emissive_strength`.

use std::sync::Arc;

use glam::{DAffine2, DVec2, DVec3};
use serde_json::Value;

use super::properties::{tex_coord, texture_index};
use super::{Material, Texture};

/// What a texture of a material says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    BaseColor,
    /// Roughness in green, metal in blue.
    MetallicRoughness,
    Emissive,
    /// How much of the light from all around gets there, in red.
    Occlusion,
}

/// A texture of a material, and its place on a surface.
pub(crate) struct PlacedTexture<'a> {
    pub(crate) texture: &'a Arc<Texture>,
    /// Which `TEXCOORD_n` it is placed by.
    pub(crate) set: u64,
    /// From these coordinates to places on the texture.
    pub(crate) transform: DAffine2,
}

impl Slot {
    fn pointer(self) -> &'static str {
        match self {
            Self::BaseColor => "/pbrMetallicRoughness/baseColorTexture",
            Self::MetallicRoughness => "/pbrMetallicRoughness/metallicRoughnessTexture",
            Self::Emissive => "/emissiveTexture",
            Self::Occlusion => "/occlusionTexture",
        }
    }
}

impl Material {
    /// The texture that says this, if there is one.
    pub(crate) fn placed_texture(&self, slot: Slot) -> Option<PlacedTexture<'_>> {
        let info = self.properties().pointer(slot.pointer())?;
        let texture = self.textures().get(texture_index(info) as usize)?;
        let moved = info.pointer("/extensions/KHR_texture_transform");
        let other_set = moved.and_then(|moved| moved.get("texCoord")?.as_u64());
        Some(PlacedTexture {
            texture,
            set: other_set.unwrap_or_else(|| tex_coord(info)),
            transform: moved.map_or(DAffine2::IDENTITY, transform),
        })
    }

    /// Metal and roughness, each from 0 to 1; a texture multiplies them.
    pub(crate) fn metal_and_roughness(&self) -> [f64; 2] {
        ["metallicFactor", "roughnessFactor"].map(|name| {
            let surface = self.properties().get("pbrMetallicRoughness");
            let number = surface.and_then(|surface| surface.get(name)?.as_f64());
            number.unwrap_or(1.0)
        })
    }

    /// Light that it emits itself, in linear sRGB, unbounded above; a texture multiplies it.
    pub(crate) fn emission(&self) -> DVec3 {
        let properties = self.properties();
        let factor = |channel: usize| properties.get("emissiveFactor")?.get(channel)?.as_f64();
        let strength = properties
            .pointer("/extensions/KHR_materials_emissive_strength/emissiveStrength")
            .and_then(Value::as_f64)
            .filter(|strength| *strength >= 0.0);
        let color = DVec3::from_array([0, 1, 2].map(|channel| factor(channel).unwrap_or(0.0)));
        color * strength.unwrap_or(1.0)
    }

    /// How much of what the texture of occlusion says holds, from 0 to 1.
    pub(crate) fn occlusion_strength(&self) -> f64 {
        let strength = self.properties().pointer("/occlusionTexture/strength");
        strength.and_then(Value::as_f64).unwrap_or(1.0)
    }
}

/// What `KHR_texture_transform` says.
fn transform(moved: &Value) -> DAffine2 {
    let pair = |name: &str, default: f64| {
        let number = |axis: usize| moved.get(name)?.get(axis)?.as_f64();
        DVec2::new(number(0).unwrap_or(default), number(1).unwrap_or(default))
    };
    let turn = moved.get("rotation").and_then(Value::as_f64);
    // Its angle is counter-clockwise, and v points down.
    DAffine2::from_scale_angle_translation(
        pair("scale", 1.0),
        -turn.unwrap_or(0.0),
        pair("offset", 0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::super::Image;
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_that_are_left_out_are_those_of_gltf() {
        let bare = Material::new(json!({}), vec![]).unwrap();
        assert_eq!(bare.metal_and_roughness(), [1.0, 1.0]);
        assert_eq!(bare.emission(), DVec3::ZERO);
        assert_eq!(bare.occlusion_strength(), 1.0);
        assert!(bare.placed_texture(Slot::BaseColor).is_none());
    }

    #[test]
    fn numbers_and_textures_are_found_where_gltf_has_them() {
        let image = Arc::new(Image::new(None, b"\xff\xd8\xff".to_vec()).unwrap());
        let textures = [(); 4].map(|()| Arc::new(Texture::new(image.clone(), None)));
        let moved = json!({ "index": 2, "texCoord": 1, "extensions": {
            "KHR_texture_transform": { "offset": [0.5, 0], "texCoord": 3 } } });
        let properties = json!({
            "pbrMetallicRoughness": {
                "metallicFactor": 0.25, "roughnessFactor": 0.5,
                "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1, "texCoord": 2 },
            },
            "emissiveFactor": [1.0, 0.5, 0.0], "emissiveTexture": moved,
            "occlusionTexture": { "index": 3, "strength": 0.75 },
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8.0 } },
        });
        let material = Material::new(properties, textures.to_vec()).unwrap();
        assert_eq!(material.metal_and_roughness(), [0.25, 0.5]);
        assert_eq!(material.emission(), DVec3::new(8.0, 4.0, 0.0));
        assert_eq!(material.occlusion_strength(), 0.75);
        let slots = [
            Slot::BaseColor,
            Slot::MetallicRoughness,
            Slot::Emissive,
            Slot::Occlusion,
        ];
        let found = slots.map(|slot| material.placed_texture(slot).unwrap());
        for (number, placed) in found.iter().enumerate() {
            assert!(Arc::ptr_eq(placed.texture, &textures[number]));
        }
        assert_eq!(found.map(|placed| placed.set), [0, 2, 3, 0]);
        let emissive = material.placed_texture(Slot::Emissive).unwrap();
        let place = emissive.transform.transform_point2(DVec2::ZERO);
        assert_eq!(place, DVec2::new(0.5, 0.0));
    }
}
