//! The Doppler factor as a colour of its own: blue above 1, red below, grey at 1.
//!
//! Even steps of the logarithm of the factor are even steps of colour: each half goes along a straight line in Oklab, in
//! which equal distances look equal, at the same lightness on both sides.
//!
//! # Reference
//!
//! B. Ottosson, *A perceptual color space for image processing* (2020): Oklab.

use std::f64::consts::LN_2;

use glam::{DMat3, DVec3};

/// The factor at which the colours end is 2 to the power of this; beyond it and below its inverse they stay.
pub const RAMP_OCTAVES: f64 = 3.0;

/// In Oklab (lightness, green to red, blue to yellow): the middle and both ends.
const MIDDLE: DVec3 = DVec3::new(0.93, 0.0, 0.0);
const BLUE: DVec3 = DVec3::new(0.45, -0.032, -0.15);
const RED: DVec3 = DVec3::new(0.45, 0.145, 0.055);

/// From Oklab to the cube roots of the cones' responses, and from these responses to linear sRGB.
const TO_CONES: DMat3 = DMat3::from_cols_array(&[
    1.0,
    1.0,
    1.0,
    0.396_337_777_4,
    -0.105_561_345_8,
    -0.089_484_177_5,
    0.215_803_757_3,
    -0.063_854_172_8,
    -1.291_485_548_0,
]);
const CONES_TO_RGB: DMat3 = DMat3::from_cols_array(&[
    4.076_741_662_1,
    -1.268_438_004_6,
    -0.004_196_086_3,
    -3.307_711_591_3,
    2.609_757_401_1,
    -0.703_418_614_7,
    0.230_969_929_2,
    -0.341_319_396_5,
    1.707_614_701_0,
]);

/// The colour of a Doppler factor (seen over emitted frequency), in linear sRGB with channels from 0 to 1.
pub fn ramp_color(doppler_factor: f64) -> DVec3 {
    let octaves = doppler_factor.ln() / LN_2;
    let part = (octaves / RAMP_OCTAVES).clamp(-1.0, 1.0);
    let end = if part > 0.0 { BLUE } else { RED };
    linear_of_oklab(MIDDLE.lerp(end, part.abs()))
}

fn linear_of_oklab(color: DVec3) -> DVec3 {
    let roots = TO_CONES * color;
    CONES_TO_RGB * (roots * roots * roots)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oklab(linear: DVec3) -> DVec3 {
        let cones = CONES_TO_RGB.inverse() * linear;
        TO_CONES.inverse() * DVec3::from_array(cones.to_array().map(f64::cbrt))
    }

    #[test]
    fn every_colour_of_the_ramp_is_one_that_a_screen_shows() {
        for step in -4000..=4000 {
            let color = ramp_color(2f64.powf(f64::from(step) / 1000.0));
            assert!(
                color.min_element() >= 0.0 && color.max_element() <= 1.0,
                "{step}: {color}"
            );
        }
        for extreme in [0.0, 5e-324, 1e-3] {
            assert_eq!(ramp_color(extreme), ramp_color(0.125), "{extreme}");
        }
        for extreme in [1e3, f64::MAX, f64::INFINITY] {
            assert_eq!(ramp_color(extreme), ramp_color(8.0), "{extreme}");
        }
    }

    /// Even steps on each side, as far on one side as on the other to a tenth, equally dark.
    #[test]
    fn even_steps_look_even() {
        let lengths = [1.0, -1.0].map(|side: f64| {
            let at = |step: i32| oklab(ramp_color(2f64.powf(side * f64::from(step) / 10.0)));
            let steps: Vec<f64> = (0..30)
                .map(|step| at(step).distance(at(step + 1)))
                .collect();
            let mean = steps.iter().sum::<f64>() / 30.0;
            assert!(
                steps.iter().all(|step| (step / mean - 1.0).abs() < 1e-6),
                "{steps:?}"
            );
            30.0 * mean
        });
        assert!((lengths[0] / lengths[1] - 1.0).abs() < 0.1, "{lengths:?}");
        let [blue, red] = [8.0, 0.125].map(|factor| oklab(ramp_color(factor)));
        assert!((blue.x - red.x).abs() < 1e-6);
        // Without colour at 1, bluer above it, redder below.
        let grey = ramp_color(1.0);
        assert!((grey.max_element() - grey.min_element()) < 1e-3, "{grey}");
        let [blue, red] = [1.1, 0.9].map(ramp_color);
        assert!(blue.z > blue.x && red.x > red.z, "{blue} {red}");
    }

    /// Oklab of white and of the primaries, as its author gives them, to three digits.
    #[test]
    fn oklab_is_that_of_its_author() {
        for (linear, expected) in [
            (DVec3::ONE, [1.0, 0.0, 0.0]),
            (DVec3::X, [0.628, 0.225, 0.126]),
            (DVec3::Y, [0.866, -0.234, 0.179]),
            (DVec3::Z, [0.452, -0.032, -0.312]),
        ] {
            let error = oklab(linear) - DVec3::from_array(expected);
            assert!(error.abs().max_element() < 1e-3, "{linear}: {error}");
        }
    }
}
