//! Colours: linear light, and light as it is encoded for a screen.
//!
//! # Reference
//!
//! IEC 61966-2-1, the transfer function of sRGB. Its two branches meet where the encoded value is 0.04045 and the linear
//! one 0.0031308, except for a step of less than 1e-7.

/// The linear value, from 0 to 1, of a channel that sRGB encodes as `encoded`, from 0 to 1.
pub(crate) fn linear_of_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// The linear value, from 0 to 1, of a channel that sRGB encodes as a byte.
pub(crate) fn linear_of_byte(byte: u8) -> f32 {
    linear_of_srgb(f64::from(byte) / 255.0) as f32
}

/// The byte that encodes a linear value in sRGB: the nearest one. What is brighter than white is white, and what is
/// below black is black.
pub(crate) fn byte_of_linear(linear: f32) -> u8 {
    (srgb_of_linear(linear) * 255.0).round() as u8
}

/// What [`linear_of_srgb`] undoes, to the precision of pictures: a few units in the last place of `f32`.
fn srgb_of_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked out with 40 digits from the standard's formula, to 15 digits.
    #[test]
    fn values_are_those_of_the_standard() {
        for (byte, linear) in [
            (0, 0.0),
            (1, 3.035_269_835_488_375e-4),
            // The last on the straight part of the curve, and the first on the power law.
            (10, 3.035_269_835_488_375e-3),
            (11, 3.346_535_763_899_161e-3),
            (188, 0.502_886_458_032_568_4),
            (255, 1.0),
        ] {
            let found = linear_of_srgb(f64::from(byte) / 255.0);
            // The power magnifies roundings by 2.4, and there are four of them.
            assert!((found - linear).abs() <= 1e-14 * linear, "{byte}: {found}");
            assert_eq!(linear_of_byte(byte), found as f32);
        }
        // Middle grey is far from half the levels.
        assert_eq!([0.5, 0.18].map(byte_of_linear), [188, 118]);
    }

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255 {
            assert_eq!(byte_of_linear(linear_of_byte(byte)), byte);
        }
    }

    #[test]
    fn brighter_is_never_encoded_as_darker() {
        let mut last = (-1.0, -1.0, 0);
        for step in 0..=1_000_000 {
            let value = f64::from(step) / 1e6;
            let now = (
                linear_of_srgb(value),
                srgb_of_linear(value as f32),
                byte_of_linear(value as f32),
            );
            assert!(now.0 > last.0 && now.2 >= last.2, "{value}");
            // Where two steps are fewer than three units in the last place apart, roundings decide.
            assert!(now.1 >= last.1 - 2.0 * f32::EPSILON, "{value}");
            last = now;
        }
        // Where the branches meet, neighbours are told apart no worse than elsewhere.
        let meet = 0.003_130_8_f32;
        assert!((srgb_of_linear(meet) - srgb_of_linear(meet.next_up())).abs() < 1e-6);
        assert!((linear_of_srgb(0.04045) - linear_of_srgb(0.04045_f64.next_up())).abs() < 1e-7);
    }

    #[test]
    fn what_no_screen_can_show_is_as_close_as_it_can() {
        let odd = [7.0, f32::INFINITY, -1.0, f32::NEG_INFINITY, f32::NAN];
        assert_eq!(odd.map(byte_of_linear), [255, 255, 0, 0, 0]);
    }
}
