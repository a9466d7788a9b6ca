//! Attributes of vertices from the conventions of other formats to those of glTF.

use glam::{DVec2, DVec4, Vec2, Vec4};

use crate::effects::linear_of_srgb;

/// OBJ, PLY and OFF count v from the lower edge of an image, glTF from the upper one. NaN, which stands for a vertex
/// without texture coordinates, becomes zero.
pub(super) fn texture_coordinate(uv: &DVec2) -> Vec2 {
    match uv.is_nan() {
        true => Vec2::ZERO,
        false => Vec2::new(uv.x as f32, (1.0 - uv.y) as f32),
    }
}

/// Linear colours of vertices, and how many of the given ones are outside 0 to 1. Programs write colours of vertices into
/// OBJ, PLY and OFF files as on the screen, in sRGB; opacity is linear.
pub(super) fn clamped_colors(colors: impl Iterator<Item = DVec4>) -> (Vec<Vec4>, usize) {
    let mut outside = 0;
    let linear = |srgb: DVec4| {
        let clamped = srgb.clamp(DVec4::ZERO, DVec4::ONE);
        outside += usize::from(clamped != srgb);
        let rgb = clamped.truncate().to_array().map(linear_of_srgb);
        let [r, g, b] = rgb.map(|component| component as f32);
        Vec4::new(r, g, b, clamped.w as f32)
    };
    let colors = colors.map(linear).collect();
    (colors, outside)
}
