//! The material of a shape: a plain colour or a checker pattern.
//!
//! A checker pattern is a picture, not coloured triangles: its cells stay sharp where the tessellation is
//! coarse, and its lines show how a photosurface is sheared and turned.

use std::sync::Arc;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::json;

use super::{Appearance, Color};
use crate::material::{Image, Material, Texture};

/// Width and height of a cell in pixels: enough for a sharp edge after linear filtering.
const CELL_PX: u32 = 32;

// Numbers of glTF 2.0, section 5.26.
const LINEAR: u32 = 9729;
const LINEAR_MIPMAP_LINEAR: u32 = 9987;
const REPEAT: u32 = 10497;

/// The material of `appearance`, a checker pattern having `cells` columns and rows over the unit square
/// of texture coordinates.
pub(super) fn material(appearance: &Appearance, cells: [u32; 2]) -> Material {
    let [red, green, blue] = match appearance.checker {
        None => appearance.color.linear(),
        Some(_) => [1.0; 3],
    };
    let mut surface = json!({
        "baseColorFactor": [red, green, blue, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.9,
    });
    let mut textures = vec![];
    if let Some(checker) = appearance.checker {
        let picture = png([appearance.color, checker], cells);
        let image = Image::new(Some("checker"), picture).expect("PNG is known");
        let sampler = json!({
            "magFilter": LINEAR,
            "minFilter": LINEAR_MIPMAP_LINEAR,
            "wrapS": REPEAT,
            "wrapT": REPEAT,
        });
        surface["baseColorTexture"] = json!({ "index": 0 });
        textures.push(Arc::new(Texture::new(Arc::new(image), Some(sampler))));
    }
    let properties = json!({ "pbrMetallicRoughness": surface, "doubleSided": true });
    Material::new(properties, textures).expect("a colour has numbers from 0 to 1")
}

/// A PNG file of cells in two colours, the first in the upper left corner.
fn png(colors: [Color; 2], [columns, rows]: [u32; 2]) -> Vec<u8> {
    let [width, height] = [columns * CELL_PX, rows * CELL_PX];
    let pixels: Vec<u8> = (0..height)
        .flat_map(|y| (0..width).map(move |x| x / CELL_PX + y / CELL_PX))
        .flat_map(|steps| colors[(steps % 2) as usize].0)
        .collect();
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&pixels, width, height, ExtendedColorType::Rgb8)
        .expect("three bytes a pixel, written to memory");
    file
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Wrap;

    const APPEARANCE: Appearance = Appearance {
        color: Color([200, 30, 40]),
        checker: Some(Color([250, 240, 230])),
    };

    #[test]
    fn a_checker_alternates_both_colours() {
        let material = material(&APPEARANCE, [4, 2]);
        assert_eq!(material.base_color(), [1.0; 4]);
        let (texture, tex_coord) = material.base_color_texture().unwrap();
        assert_eq!((texture.wrap(), tex_coord), ([Wrap::Repeat; 2], 0));
        let picture = image::load_from_memory(texture.image().unwrap().bytes()).unwrap();
        let picture = picture.to_rgb8();
        assert_eq!(picture.dimensions(), (128, 64));
        for (x, y, pixel) in picture.enumerate_pixels() {
            let first = (x / 32 + y / 32) % 2 == 0;
            let expected = if first {
                [200, 30, 40]
            } else {
                [250, 240, 230]
            };
            assert_eq!(pixel.0, expected, "at {x}, {y}");
        }
    }

    #[test]
    fn the_picture_is_the_same_every_time() {
        assert_eq!(
            material(&APPEARANCE, [24, 12]),
            material(&APPEARANCE, [24, 12])
        );
    }

    #[test]
    fn a_plain_shape_has_a_linear_colour_and_no_texture() {
        let appearance = Appearance {
            checker: None,
            ..APPEARANCE
        };
        let material = material(&appearance, [4, 2]);
        assert_eq!(material.base_color_texture(), None);
        assert_eq!(
            material.base_color()[..3],
            appearance.color.linear().map(f64::from)
        );
        let surface = &material.properties()["pbrMetallicRoughness"];
        assert_eq!(
            (&surface["metallicFactor"], &surface["roughnessFactor"]),
            (&json!(0.0), &json!(0.9))
        );
        assert!(material.double_sided());
    }
}
