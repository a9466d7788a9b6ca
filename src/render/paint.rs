//! What a surface looks like: base colour, finish, emission, opacity, each with its texture.

use std::sync::Arc;

use glam::{DAffine2, DVec2, DVec4, Vec3, Vec4};

use super::Textures;
use super::shading::Finish;
use super::texture::{BytesMean, Pixels};
use crate::material::{AlphaMode, Material, Slot};
use crate::mesh::Mesh;

/// A material, ready to be looked at.
pub(crate) struct Paint {
    base_color: Vec4,
    emission: Vec3,
    finish: Finish,
    occlusion_strength: f32,
    /// By [`Slot`].
    base_texture: Option<AppliedTexture>,
    finish_texture: Option<AppliedTexture>,
    emissive_texture: Option<AppliedTexture>,
    occlusion_texture: Option<AppliedTexture>,
    /// The sets of texture coordinates that the textures are placed by, each once.
    sets: Vec<usize>,
    alpha_mode: AlphaMode,
    pub(super) double_sided: bool,
    /// Whether it has its colour whatever the light.
    pub(super) unlit: bool,
}

/// Texture coordinates at one place of a surface, in the order of [`Paint::texture_sets`]: there are at most as many sets as
/// there are textures.
pub(super) type TexturePlaces = [DVec2; 4];

/// What a place of a surface looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// In linear sRGB, as all colours here.
    pub(super) base_color: Vec3,
    /// From 0 to 1.
    pub(super) opacity: f32,
    pub(super) finish: Finish,
    /// Light of its own, unbounded above.
    pub(super) emission: Vec3,
    /// The part of the light from all around that gets there, from 0 to 1.
    pub(super) open: f64,
}

/// A texture and how it is laid on a surface.
struct AppliedTexture {
    pixels: Pixels,
    /// Which of the sets of the paint.
    set: usize,
    transform: DAffine2,
}

impl AppliedTexture {
    fn at(&self, places: &TexturePlaces) -> Vec4 {
        self.pixels
            .at(self.transform.transform_point2(places[self.set]))
    }
}

impl Paint {
    /// White and matte on both sides: what has no material, also in the files that are written of it.
    pub(super) fn plain() -> Self {
        Self {
            base_color: Vec4::ONE,
            emission: Vec3::ZERO,
            finish: Finish::MATTE,
            occlusion_strength: 1.0,
            base_texture: None,
            finish_texture: None,
            emissive_texture: None,
            occlusion_texture: None,
            sets: vec![],
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            unlit: false,
        }
    }

    /// The paint of `object`'s material; without those of its textures that cannot be decoded.
    pub(crate) fn new(material: Option<&Arc<Material>>, object: &str, textures: &Textures) -> Self {
        let Some(material) = material else {
            return Self::plain();
        };
        let unlit = material.is_unlit();
        let mut sets = Vec::new();
        let mut applied = |slot: Slot, bytes: BytesMean| {
            let placed = material.placed_texture(slot)?;
            let pixels = textures.pixels(placed.texture, bytes, object)?;
            let set = placed.set as usize;
            let known = sets.iter().position(|&other| other == set);
            Some(AppliedTexture {
                pixels,
                set: known.unwrap_or_else(|| {
                    sets.push(set);
                    sets.len() - 1
                }),
                transform: placed.transform,
            })
        };
        let base_texture = applied(Slot::BaseColor, BytesMean::Color);
        // What needs no light has nothing but its base colour.
        let mut of_lit = |slot, bytes| (!unlit).then(|| applied(slot, bytes)).flatten();
        let finish_texture = of_lit(Slot::MetallicRoughness, BytesMean::Number);
        let emissive_texture = of_lit(Slot::Emissive, BytesMean::Color);
        let occlusion_texture = of_lit(Slot::Occlusion, BytesMean::Number);
        let [metal, roughness] = material.metal_and_roughness();
        // Where the metal is was in the texture: all would be metal without it.
        let lost_metal =
            finish_texture.is_none() && material.placed_texture(Slot::MetallicRoughness).is_some();
        Self {
            base_color: DVec4::from(material.base_color()).as_vec4(),
            emission: material.emission().as_vec3(),
            finish: Finish {
                metal: if lost_metal { 0.0 } else { metal },
                roughness,
            },
            occlusion_strength: material.occlusion_strength() as f32,
            base_texture,
            finish_texture,
            emissive_texture,
            occlusion_texture,
            sets,
            alpha_mode: material.alpha_mode(),
            double_sided: material.double_sided(),
            unlit,
        }
    }

    /// Which sets of texture coordinates it uses, at most as many as [`TexturePlaces`] has.
    pub(super) fn texture_sets(&self) -> &[usize] {
        &self.sets
    }

    /// What it looks like at these texture coordinates, where the vertices have the colour `vertex`.
    pub(super) fn look(&self, places: &TexturePlaces, vertex: Vec4) -> Look {
        let color = self.color(places, vertex);
        let mut look = Look {
            base_color: color.truncate(),
            opacity: self.opacity(color.w),
            finish: self.finish,
            emission: self.emission,
            open: 1.0,
        };
        if let Some(texture) = &self.finish_texture {
            let [_, rough, metal, _] = texture.at(places).to_array();
            look.finish.roughness *= f64::from(rough);
            look.finish.metal *= f64::from(metal);
        }
        if let Some(texture) = &self.emissive_texture {
            look.emission *= texture.at(places).truncate();
        }
        if let Some(texture) = &self.occlusion_texture {
            look.open = f64::from(1.0 - self.occlusion_strength * (1.0 - texture.at(places).x));
        }
        look
    }

    /// Whether what is behind it may be seen through it everywhere.
    pub(super) fn is_blended(&self) -> bool {
        self.alpha_mode == AlphaMode::Blend
    }

    /// Whether nothing is seen through it anywhere.
    pub(super) fn is_opaque(&self) -> bool {
        self.alpha_mode == AlphaMode::Opaque
    }

    /// How opaque it is at these texture coordinates, from 0 to 1.
    pub(super) fn opacity_at(&self, places: &TexturePlaces, vertex: Vec4) -> f32 {
        self.opacity(self.color(places, vertex).w)
    }

    fn color(&self, places: &TexturePlaces, vertex: Vec4) -> Vec4 {
        let texture = self.base_texture.as_ref();
        let picture = texture.map_or(Vec4::ONE, |texture| texture.at(places));
        self.base_color * picture * vertex
    }

    fn opacity(&self, alpha: f32) -> f32 {
        match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(least) => f32::from(f64::from(alpha) >= least),
            AlphaMode::Blend => alpha.clamp(0.0, 1.0),
        }
    }

    /// Linear base colour and opacity at a vertex of a mesh: opaque where the material says that opacity means nothing.
    pub(crate) fn at_vertex(&self, mesh: &Mesh, vertex: usize) -> Vec4 {
        let mut places = TexturePlaces::default();
        for (place, &set) in places.iter_mut().zip(self.texture_sets()) {
            let set = mesh.texture_coordinates().get(set);
            *place = set.map_or(DVec2::ZERO, |set| set[vertex].as_dvec2());
        }
        let own = mesh.colors().map_or(Vec4::ONE, |colors| colors[vertex]);
        let color = self.color(&places, own);
        match self.alpha_mode {
            AlphaMode::Opaque => color.with_w(1.0),
            AlphaMode::Mask(_) | AlphaMode::Blend => color,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;
    use std::io::Cursor;

    use serde_json::{Value, json};

    use super::*;
    use crate::material::{Image, Texture};

    /// Two pixels beside each other: black, opaque, and white, half transparent.
    fn material(sampler: Option<Value>, mode: Value, transform: Value) -> Arc<Material> {
        let mut picture = image::RgbaImage::new(2, 1);
        picture.put_pixel(0, 0, image::Rgba([0, 0, 0, 255]));
        picture.put_pixel(1, 0, image::Rgba([255, 255, 255, 51]));
        let mut bytes = Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        of_image(bytes.into_inner(), sampler, mode, transform)
    }

    fn of_image(
        bytes: Vec<u8>,
        sampler: Option<Value>,
        mode: Value,
        transform: Value,
    ) -> Arc<Material> {
        let image = Arc::new(Image::new(Some("wood"), bytes).unwrap());
        let texture = Arc::new(Texture::new(image, sampler));
        let mut properties = json!({ "pbrMetallicRoughness": {
            "baseColorFactor": [1.0, 0.5, 0.25, 1.0],
            "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": transform } },
        } });
        for (key, value) in mode.as_object().unwrap() {
            properties[key] = value.clone();
        }
        Arc::new(Material::new(properties, vec![texture]).unwrap())
    }

    fn paint_of(material: &Arc<Material>) -> Paint {
        Paint::new(Some(material), "x", &Textures::default())
    }

    /// Base colour and opacity.
    fn seen(paint: &Paint, place: DVec2) -> (Vec3, f32) {
        let look = paint.look(&[place; 4], Vec4::ONE);
        assert_eq!(paint.opacity_at(&[place; 4], Vec4::ONE), look.opacity);
        (look.base_color, look.opacity)
    }

    fn paint(sampler: Option<Value>, mode: Value) -> Paint {
        paint_of(&material(sampler, mode, json!({})))
    }

    #[test]
    fn textures_are_mixed_in_linear_light() {
        let paint = paint(None, json!({ "alphaMode": "BLEND" }));
        let at = |u| seen(&paint, DVec2::new(u, 0.5));
        assert_eq!(at(0.25), (Vec3::ZERO, 1.0));
        assert_eq!(at(0.75), (Vec3::new(1.0, 0.5, 0.25), 0.2));
        assert!(at(0.5).0.distance(Vec3::new(0.5, 0.25, 0.125)) < 1e-6);
        // Repeats: a quarter before the beginning is the end.
        assert_eq!(at(-0.25), at(0.75));
        assert_eq!(at(2.25), at(0.25));
        assert!((at(0.0).0.x - 0.5).abs() < 1e-6);
    }

    #[test]
    fn textures_are_magnified_as_their_sampler_says() {
        let nearest = json!({ "magFilter": 9728 });
        let paint = paint(Some(nearest), json!({}));
        let red = |u| seen(&paint, DVec2::new(u, 0.5)).0.x;
        assert_eq!([red(0.49), red(0.51)], [0.0, 1.0]);
    }

    #[test]
    fn opacity_is_what_the_mode_says() {
        let place = DVec2::new(0.75, 0.5);
        let opacity = |mode| seen(&paint(None, mode), place).1;
        assert_eq!(opacity(json!({})), 1.0);
        assert_eq!(opacity(json!({ "alphaMode": "MASK" })), 0.0);
        assert_eq!(
            opacity(json!({ "alphaMode": "MASK", "alphaCutoff": 0.2 })),
            1.0
        );
        assert_eq!(opacity(json!({ "alphaMode": "BLEND" })), 0.2);
    }

    /// glTF's own formula: scaled, then turned counter-clockwise seen with v down, then moved.
    #[test]
    fn textures_are_moved_as_they_say() {
        let transform = json!({ "offset": [0.25, 0.0], "scale": [1.0, 0.5], "rotation": -FRAC_PI_2, "texCoord": 3 });
        let material = material(Some(json!({ "magFilter": 9728 })), json!({}), transform);
        let paint = paint_of(&material);
        assert_eq!(paint.texture_sets(), [3]);
        let red = |u, v| seen(&paint, DVec2::new(u, v)).0.x;
        // (u, v) is read at (0.25 - v / 2, u).
        assert_eq!([red(0.3, 0.0), red(0.3, 0.4)], [0.0, 0.0]);
        assert_eq!([red(0.3, 0.6), red(0.9, 1.4)], [1.0, 1.0]);
    }

    #[test]
    fn without_a_picture_the_rest_is_drawn() {
        let broken = of_image(b"\x89PNG\r\n\x1a\n".to_vec(), None, json!({}), json!({}));
        let paint = paint_of(&broken);
        assert!(paint.texture_sets().is_empty());
        let seen = seen(&paint, DVec2::ZERO);
        assert_eq!(seen, (Vec3::new(1.0, 0.5, 0.25), 1.0));
    }

    /// A picture of one pixel: in sRGB 188 is half the light, and as a number 188 / 255.
    fn one_pixel(pixel: [u8; 4]) -> Arc<Texture> {
        let mut bytes = Cursor::new(Vec::new());
        let picture = image::RgbaImage::from_pixel(1, 1, image::Rgba(pixel));
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        let image = Image::new(None, bytes.into_inner()).unwrap();
        Arc::new(Texture::new(Arc::new(image), None))
    }

    fn with_all_textures(unlit: bool) -> Paint {
        let mut properties = json!({
            "pbrMetallicRoughness": {
                "metallicFactor": 0.5, "roughnessFactor": 0.75,
                "metallicRoughnessTexture": { "index": 0, "texCoord": 1 },
            },
            "emissiveFactor": [1.0, 0.5, 0.0], "emissiveTexture": { "index": 0, "texCoord": 2 },
            "occlusionTexture": { "index": 0, "texCoord": 1, "strength": 0.5 },
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } },
        });
        if unlit {
            properties["extensions"]["KHR_materials_unlit"] = json!({});
        }
        let textures = vec![one_pixel([51, 102, 204, 255])];
        paint_of(&Arc::new(Material::new(properties, textures).unwrap()))
    }

    #[test]
    fn finish_emission_and_occlusion_are_factors_times_textures() {
        let paint = with_all_textures(false);
        assert_eq!(paint.texture_sets(), [1, 2]);
        let look = paint.look(&[DVec2::ZERO; 4], Vec4::ONE);
        assert_eq!(look.base_color, Vec3::ONE);
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-6;
        // Numbers as they are, colours decoded.
        assert!(near(look.finish.roughness, 0.75 * 0.4));
        assert!(near(look.finish.metal, 0.5 * 0.8));
        assert!(near(look.open, 1.0 - 0.5 * 0.8));
        let linear = |byte: f64| ((byte / 255.0 + 0.055) / 1.055).powf(2.4);
        let expected = [4.0 * linear(51.0), 2.0 * linear(102.0), 0.0];
        for (found, expected) in look.emission.to_array().into_iter().zip(expected) {
            assert!(near(f64::from(found), expected), "{}", look.emission);
        }
        assert!(with_all_textures(true).texture_sets().is_empty());
    }
}
