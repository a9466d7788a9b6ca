//! Colours that stand out against a background.
//!
//! Source: W3C, *Web Content Accessibility Guidelines* 2.2: relative luminance, contrast ratio, and 3 as the least contrast
//! of graphics that have to be understood.

use crate::effects::byte_of_linear;
use crate::shape::Color;

/// The least contrast ratio of marks and their background.
const LEAST: f64 = 3.0;

/// Of light reflected by a screen that shows black, as a part of white.
const FLARE: f64 = 0.05;

/// A background of this luminance is as far from black as from white.
const MIDDLE: f64 = 0.179;

const WHITE: Color = Color([0xf4; 3]);
const BLACK: Color = Color([0x0c; 3]);

/// Luminance as a part of that of white.
fn luminance(color: Color) -> f64 {
    let [red, green, blue] = color.linear().map(f64::from);
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn is_dark(background: Color) -> bool {
    luminance(background) < MIDDLE
}

/// The colour of letters on a background.
pub(super) fn ink(background: Color) -> Color {
    if is_dark(background) { WHITE } else { BLACK }
}

/// The colour around letters that may stand on anything: as dark or light as the background.
pub(super) fn halo(background: Color) -> Color {
    if is_dark(background) { BLACK } else { WHITE }
}

/// The colour itself where it stands out against the background; else as much darker, or mixed with white, as it has to be.
pub(super) fn legible(color: Color, background: Color) -> Color {
    let (own, behind) = (luminance(color) + FLARE, luminance(background) + FLARE);
    // A step of 1/255 more, for rounding.
    let wanted = LEAST * 1.04;
    let part = |now: f64, end: f64, goal: f64| ((goal - now) / (end - now)).clamp(0.0, 1.0) as f32;
    let mixed = |end: f32, part: f32| {
        let mixed = color.linear().map(|level| level + (end - level) * part);
        Color(mixed.map(byte_of_linear))
    };
    match is_dark(background) {
        true if own >= behind * wanted => color,
        true => mixed(1.0, part(own, 1.0 + FLARE, behind * wanted)),
        false if own * wanted <= behind => color,
        false => mixed(0.0, part(own, FLARE, behind / wanted)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::ghosts::ghost_color;
    use super::super::guides::AXES;
    use super::*;
    use crate::spacetime::ViewModel;

    /// By another formula: sRGB as the standard has it, not the program's table.
    fn contrast(a: Color, b: Color) -> f64 {
        let luminance = |color: Color| {
            let [r, g, b] = color.0.map(|byte| {
                let part = f64::from(byte) / 255.0;
                match part <= 0.04045 {
                    true => part / 12.92,
                    false => ((part + 0.055) / 1.055).powf(2.4),
                }
            });
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn guides_stand_out_against_any_background() {
        let models = [
            ViewModel::Seen,
            ViewModel::Delayed,
            ViewModel::Contracted,
            ViewModel::Rest,
        ];
        let ghosts = models.map(ghost_color);
        let colors = ghosts.into_iter().chain(AXES.map(|(_, _, color)| color));
        let colors: Vec<Color> = colors.collect();
        let greys = (0..=255).map(|level| Color([level; 3]));
        let named = [
            [0x14, 0x17, 0x1c],
            [255, 0, 0],
            [0, 0, 255],
            [0, 255, 0],
            [90, 120, 140],
        ];
        for background in greys.chain(named.map(Color)) {
            for &color in &colors {
                let shown = legible(color, background);
                let found = contrast(shown, background);
                assert!(
                    found >= 3.0,
                    "{color:?} on {background:?}: {shown:?} {found}"
                );
                assert!(contrast(shown, halo(background)) >= 2.8, "{shown:?}");
            }
            assert!(
                contrast(ink(background), background) >= 4.0,
                "{background:?}"
            );
            assert!(contrast(ink(background), halo(background)) >= 15.0);
        }
    }

    #[test]
    fn colours_that_stand_out_stay_as_they_are_and_stay_apart() {
        let dark = Color([0x14, 0x17, 0x1c]);
        for model in [ViewModel::Seen, ViewModel::Rest] {
            assert_eq!(legible(ghost_color(model), dark), ghost_color(model));
        }
        // On white, orange is still more red than blue and the shape at rest more blue than red.
        let [red, _, blue] = legible(ghost_color(ViewModel::Contracted), Color([255; 3])).0;
        assert!(red > blue + 60);
        let [red, _, blue] = legible(ghost_color(ViewModel::Rest), Color([255; 3])).0;
        assert!(blue > red + 60);
    }
}
