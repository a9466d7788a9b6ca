//! What a surface looks like: base colour, texture, opacity.

use std::sync::Arc;

use glam::{DAffine2, DVec2, DVec4, Vec3, Vec4};

use super::Textures;
use super::texture::Pixels;
use crate::material::{AlphaMode, Material};
use crate::mesh::Mesh;

/// A material, ready to be looked at: its base colour.
///
/// There is no light but the lamp at the eye, so gloss, metal and bumps stay out of pictures.
pub(crate) struct Paint {
    base_color: Vec4,
    texture: Option<AppliedTexture>,
    alpha_mode: AlphaMode,
    pub(super) double_sided: bool,
    /// Whether it has its colour whatever the light.
    pub(super) unlit: bool,
}

/// A texture and how it is laid on a surface.
struct AppliedTexture {
    pixels: Pixels,
    set: usize,
    transform: DAffine2,
}

impl Paint {
    /// White on both sides: what has no material, also in the files that are written of it.
    pub(super) fn plain() -> Self {
        Self {
            base_color: Vec4::ONE,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            unlit: false,
        }
    }

    /// The paint of `object`'s material; without its texture where that cannot be decoded.
    pub(crate) fn new(material: Option<&Arc<Material>>, object: &str, textures: &Textures) -> Self {
        let Some(material) = material else {
            return Self::plain();
        };
        let texture = material.base_color_texture().and_then(|(texture, set)| {
            let (transform, other_set) = material.base_color_transform();
            Some(AppliedTexture {
                pixels: textures.pixels(texture, object)?,
                set: other_set.unwrap_or(set) as usize,
                transform,
            })
        });
        Self {
            base_color: DVec4::from(material.base_color()).as_vec4(),
            texture,
            alpha_mode: material.alpha_mode(),
            double_sided: material.double_sided(),
            unlit: material.is_unlit(),
        }
    }

    /// Which set of texture coordinates it uses, if any.
    pub(super) fn texture_set(&self) -> Option<usize> {
        self.texture.as_ref().map(|texture| texture.set)
    }

    /// Linear colour and opacity at `texture`, where the vertices have the colour `vertex`.
    pub(super) fn color_at(&self, texture: DVec2, vertex: Vec4) -> (Vec3, f32) {
        let color = self.base_color * self.picture_at(texture) * vertex;
        let opacity = match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(least) => f32::from(f64::from(color.w) >= least),
            AlphaMode::Blend => color.w.clamp(0.0, 1.0),
        };
        (color.truncate(), opacity)
    }

    /// Linear colour and opacity at a vertex of a mesh: opaque where the material says that opacity means nothing.
    pub(crate) fn at_vertex(&self, mesh: &Mesh, vertex: usize) -> Vec4 {
        let set = self.texture_set();
        let set = set.and_then(|set| mesh.texture_coordinates().get(set));
        let texture = set.map_or(DVec2::ZERO, |set| set[vertex].as_dvec2());
        let own = mesh.colors().map_or(Vec4::ONE, |colors| colors[vertex]);
        let color = self.base_color * self.picture_at(texture) * own;
        match self.alpha_mode {
            AlphaMode::Opaque => color.with_w(1.0),
            AlphaMode::Mask(_) | AlphaMode::Blend => color,
        }
    }

    fn picture_at(&self, texture: DVec2) -> Vec4 {
        self.texture.as_ref().map_or(Vec4::ONE, |placed| {
            let place = placed.transform.transform_point2(texture);
            placed.pixels.at(place)
        })
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

    fn paint(sampler: Option<Value>, mode: Value) -> Paint {
        paint_of(&material(sampler, mode, json!({})))
    }

    #[test]
    fn textures_are_mixed_in_linear_light() {
        let paint = paint(None, json!({ "alphaMode": "BLEND" }));
        let at = |u| paint.color_at(DVec2::new(u, 0.5), Vec4::ONE);
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
        let red = |u| paint.color_at(DVec2::new(u, 0.5), Vec4::ONE).0.x;
        assert_eq!([red(0.49), red(0.51)], [0.0, 1.0]);
    }

    #[test]
    fn opacity_is_what_the_mode_says() {
        let place = DVec2::new(0.75, 0.5);
        let opacity = |mode| paint(None, mode).color_at(place, Vec4::ONE).1;
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
        assert_eq!(paint.texture_set(), Some(3));
        let red = |u, v| paint.color_at(DVec2::new(u, v), Vec4::ONE).0.x;
        // (u, v) is read at (0.25 - v / 2, u).
        assert_eq!([red(0.3, 0.0), red(0.3, 0.4)], [0.0, 0.0]);
        assert_eq!([red(0.3, 0.6), red(0.9, 1.4)], [1.0, 1.0]);
    }

    #[test]
    fn without_a_picture_the_rest_is_drawn() {
        let broken = of_image(b"\x89PNG\r\n\x1a\n".to_vec(), None, json!({}), json!({}));
        let paint = paint_of(&broken);
        assert_eq!(paint.texture_set(), None);
        let seen = paint.color_at(DVec2::ZERO, Vec4::ONE);
        assert_eq!(seen, (Vec3::new(1.0, 0.5, 0.25), 1.0));
    }
}
