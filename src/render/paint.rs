//! What a surface looks like: base colour, texture, opacity.

use std::sync::Arc;

use glam::{DVec2, Vec3, Vec4};
use thiserror::Error;

use crate::mesh::{AlphaMode, Color, Filter, Material, Sampler, Texture, Wrap};

/// Why something cannot be drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A texture that is no picture.
    #[error("the texture {name} of \"{object}\" cannot be decoded, expected PNG or JPEG")]
    Texture {
        /// The object that it is on.
        object: String,
        /// As the source names it.
        name: String,
        /// What is wrong with it.
        source: image::ImageError,
    },
}

/// A material, ready to be looked at.
pub(super) struct Paint {
    base_color: Vec4,
    texture: Option<Pixels>,
    texture_set: usize,
    alpha_mode: AlphaMode,
    pub(super) double_sided: bool,
}

impl Paint {
    /// The paint of `object`'s material.
    ///
    /// # Errors
    ///
    /// A texture that is neither PNG nor JPEG.
    pub(super) fn new(material: Option<&Arc<Material>>, object: &str) -> Result<Self, RenderError> {
        let Some(material) = material else {
            return Ok(Self {
                base_color: Vec4::ONE,
                texture: None,
                texture_set: 0,
                alpha_mode: AlphaMode::Opaque,
                // As in the files written of it.
                double_sided: true,
            });
        };
        let texture = material.base_color_texture.as_ref();
        Ok(Self {
            base_color: material.base_color.into(),
            texture: texture
                .map(|texture| Pixels::decode(texture, object))
                .transpose()?,
            texture_set: texture.map_or(0, |texture| texture.tex_coord as usize),
            alpha_mode: material.alpha_mode,
            double_sided: material.double_sided,
        })
    }

    /// Which set of texture coordinates it uses, if any.
    pub(super) fn texture_set(&self) -> Option<usize> {
        self.texture.as_ref().map(|_| self.texture_set)
    }

    /// Linear colour and opacity at `texture`, where the vertices have the colour `vertex`.
    pub(super) fn color_at(&self, texture: DVec2, vertex: Vec4) -> (Vec3, f32) {
        let picture = self
            .texture
            .as_ref()
            .map_or(Vec4::ONE, |pixels| pixels.at(texture));
        let color = self.base_color * picture * vertex;
        let opacity = match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(least) => f32::from(color.w >= least),
            AlphaMode::Blend => color.w.clamp(0.0, 1.0),
        };
        (color.truncate(), opacity)
    }
}

/// A decoded texture.
struct Pixels {
    image: image::RgbaImage,
    sampler: Sampler,
    /// Linear values of the 256 that a byte can say in sRGB.
    linear: [f32; 256],
}

impl Pixels {
    fn decode(texture: &Texture, object: &str) -> Result<Self, RenderError> {
        let image = image::load_from_memory(&texture.image.bytes).map_err(|source| {
            let name = texture.image.name.clone();
            RenderError::Texture {
                object: object.to_owned(),
                name: name
                    .map_or_else(|| "without a name".to_owned(), |name| format!("\"{name}\"")),
                source,
            }
        })?;
        let linear = std::array::from_fn(|byte| Color([byte as u8; 3]).linear()[0]);
        Ok(Self {
            image: image.to_rgba8(),
            sampler: texture.sampler,
            linear,
        })
    }

    /// Linear colour and opacity. Colours are decoded before they are mixed, as glTF demands.
    fn at(&self, texture: DVec2) -> Vec4 {
        let (width, height) = self.image.dimensions();
        let place = texture * DVec2::new(width.into(), height.into());
        if self.sampler.mag_filter == Some(Filter::Nearest) {
            return self.pixel(place.floor());
        }
        let corner = (place - 0.5).floor();
        let part = (place - 0.5 - corner).as_vec2();
        let row = |y: f64| {
            let left = self.pixel(corner + DVec2::new(0.0, y));
            left.lerp(self.pixel(corner + DVec2::new(1.0, y)), part.x)
        };
        row(0.0).lerp(row(1.0), part.y)
    }

    fn pixel(&self, place: DVec2) -> Vec4 {
        let (width, height) = self.image.dimensions();
        let x = wrapped(place.x, width, self.sampler.wrap_s);
        let y = wrapped(place.y, height, self.sampler.wrap_t);
        let [red, green, blue, alpha] = self.image.get_pixel(x, y).0;
        let linear = |byte: u8| self.linear[usize::from(byte)];
        Vec4::new(
            linear(red),
            linear(green),
            linear(blue),
            f32::from(alpha) / 255.0,
        )
    }
}

/// The pixel that stands for the one numbered `index`, a whole number, of `count`.
fn wrapped(index: f64, count: u32, wrap: Wrap) -> u32 {
    let length = f64::from(count);
    let inside = match wrap {
        Wrap::ClampToEdge => index,
        Wrap::Repeat => index.rem_euclid(length),
        Wrap::MirroredRepeat => {
            let there_and_back = index.rem_euclid(2.0 * length);
            there_and_back.min(2.0 * length - 1.0 - there_and_back)
        }
    };
    inside.clamp(0.0, length - 1.0) as u32
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::mesh::Image;

    /// Two pixels beside each other: black, opaque, and white, half transparent.
    fn material(sampler: Sampler, alpha_mode: AlphaMode) -> Arc<Material> {
        let mut picture = image::RgbaImage::new(2, 1);
        picture.put_pixel(0, 0, image::Rgba([0, 0, 0, 255]));
        picture.put_pixel(1, 0, image::Rgba([255, 255, 255, 51]));
        let mut bytes = Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        let image = Arc::new(Image {
            name: None,
            mime_type: "image/png".to_owned(),
            bytes: bytes.into_inner(),
        });
        Arc::new(Material {
            base_color: [1.0, 0.5, 0.25, 1.0],
            base_color_texture: Some(Texture {
                image,
                tex_coord: 0,
                sampler,
            }),
            alpha_mode,
            ..Material::default()
        })
    }

    fn paint(sampler: Sampler, alpha_mode: AlphaMode) -> Paint {
        Paint::new(Some(&material(sampler, alpha_mode)), "x").unwrap()
    }

    #[test]
    fn textures_are_mixed_in_linear_light() {
        let paint = paint(Sampler::default(), AlphaMode::Blend);
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
    fn textures_continue_as_their_sampler_says() {
        let indices = |wrap| [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|i| wrapped(i, 2, wrap));
        assert_eq!(indices(Wrap::Repeat), [1, 0, 1, 0, 1, 0, 1]);
        assert_eq!(indices(Wrap::ClampToEdge), [0, 0, 0, 0, 1, 1, 1]);
        assert_eq!(indices(Wrap::MirroredRepeat), [1, 1, 0, 0, 1, 1, 0]);
        let nearest = Sampler {
            mag_filter: Some(Filter::Nearest),
            ..Sampler::default()
        };
        let paint = paint(nearest, AlphaMode::Opaque);
        let red = |u| paint.color_at(DVec2::new(u, 0.5), Vec4::ONE).0.x;
        assert_eq!([red(0.49), red(0.51)], [0.0, 1.0]);
    }

    #[test]
    fn opacity_is_what_the_mode_says() {
        let place = DVec2::new(0.75, 0.5);
        let opacity = |mode| paint(Sampler::default(), mode).color_at(place, Vec4::ONE).1;
        assert_eq!(opacity(AlphaMode::Opaque), 1.0);
        assert_eq!(opacity(AlphaMode::Mask(0.5)), 0.0);
        assert_eq!(opacity(AlphaMode::Mask(0.2)), 1.0);
        assert_eq!(opacity(AlphaMode::Blend), 0.2);
    }

    #[test]
    fn a_texture_that_is_no_picture_is_named() {
        let mut broken = (*material(Sampler::default(), AlphaMode::Opaque)).clone();
        let texture = broken.base_color_texture.as_mut().unwrap();
        texture.image = Arc::new(Image {
            name: Some("wood".to_owned()),
            mime_type: "image/png".to_owned(),
            bytes: b"no picture".to_vec(),
        });
        let error = Paint::new(Some(&Arc::new(broken)), "chair").err().unwrap();
        let message = error.to_string();
        assert!(message.contains("\"wood\" of \"chair\""), "{message}");
    }
}
