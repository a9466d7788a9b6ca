//! From light of any strength and colour to what a screen can show.
//!
//! # Reference
//!
//! Khronos Group, *PBR Neutral Tone Mapper Specification* (2024), without its toe, which darkens matte surfaces.

use glam::DVec3;

/// What each channel of linear sRGB adds to luminance: IEC 61966-2-1.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// Where the tone curve begins to compress, and how quickly what is brighter turns white.
const COMPRESSED_FROM: f64 = 0.8;
const DESATURATION: f64 = 0.15;

/// The luminance of a colour in linear sRGB; that of white is 1.
pub fn luminance(color: DVec3) -> f64 {
    LUMINANCE.dot(color)
}

/// A colour in linear sRGB with no channel below 0: one that no screen shows goes towards the grey of its luminance. A
/// colour without luminance is black.
pub fn within_gamut(color: DVec3) -> DVec3 {
    let (grey, least) = (luminance(color), color.min_element());
    if least >= 0.0 {
        return color;
    }
    if !(grey > 0.0) {
        return DVec3::ZERO;
    }
    let inside = DVec3::splat(grey).lerp(color, grey / (grey - least));
    inside.max(DVec3::ZERO)
}

/// A colour in linear sRGB with channels from 0 to 1, for what is shown with a tone curve of its own: colours that a screen
/// shows stay, and brighter ones are as bright as their hue can be. Infinite light is white.
pub fn within_screen(color: DVec3) -> DVec3 {
    let color = within_gamut(color);
    let most = color.max_element();
    match most {
        _ if most <= 1.0 => color,
        _ if color.is_finite() => color / most,
        _ => DVec3::ONE,
    }
}

/// A colour as a screen shows it, channels from 0 to 1: those up to 0.8 stay, brighter ones are compressed and turn white.
/// Channels of `color`, in linear sRGB, are 0 or more; infinite light is white.
pub fn tone(color: DVec3) -> DVec3 {
    let peak = color.max_element();
    if peak <= COMPRESSED_FROM {
        return color;
    }
    if !color.is_finite() {
        return DVec3::ONE;
    }
    let room = 1.0 - COMPRESSED_FROM;
    let compressed = 1.0 - room * room / (peak + room - COMPRESSED_FROM);
    let whiter = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    (color / peak * compressed).lerp(DVec3::splat(compressed), whiter)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn colors() -> impl Iterator<Item = DVec3> {
        let levels = [
            -2.0, -0.1, -1e-9, 0.0, 1e-6, 0.3, 0.8, 1.0, 1.5, 40.0, 1e9, 1e300,
        ];
        let pairs = move |red: f64| levels.into_iter().map(move |green| (red, green));
        let all = levels.into_iter().flat_map(pairs);
        all.flat_map(move |(red, green)| levels.map(|blue| DVec3::new(red, green, blue)))
    }

    #[test]
    fn colours_never_leave_what_a_screen_shows() {
        for color in colors() {
            let inside = within_gamut(color);
            assert!(inside.min_element() >= 0.0, "{color}: {inside}");
            let bounded = within_screen(color);
            let fits = |channel: f64| (0.0..=1.0).contains(&channel);
            assert!(
                bounded.to_array().into_iter().all(fits),
                "{color}: {bounded}"
            );
            // The same hue.
            let times = inside.max_element().max(1.0);
            assert!(
                (bounded - inside / times).abs().max_element() < 1e-15,
                "{color}: {bounded}"
            );
            let shown = tone(inside);
            assert!(shown.to_array().into_iter().all(fits), "{color}: {shown}");
        }
    }

    #[test]
    fn what_is_brought_inside_keeps_its_luminance() {
        for color in colors().filter(|color| luminance(*color) > 0.0) {
            let error = luminance(within_gamut(color)) - luminance(color);
            assert!(error.abs() <= 4e-15 * color.abs().max_element(), "{color}");
        }
        let inside = DVec3::new(0.1, 0.7, 0.3);
        assert_eq!(within_gamut(inside), inside);
    }

    #[test]
    fn the_tone_curve_leaves_matte_surfaces_alone_and_never_darkens() {
        let matte = DVec3::new(0.8, 0.2, 0.0);
        assert_eq!(tone(matte), matte);
        let (mut before, bluish) = (0.0, DVec3::new(0.2, 0.5, 1.0));
        for step in 0..2000 {
            let shown = tone(bluish * 10f64.powf(-2.0 + 0.005 * f64::from(step)));
            assert!(shown.z >= before, "{step}");
            before = shown.z;
        }
        assert!(tone(bluish * 1e9).min_element() > 0.99);
    }
}
