//! The colours of surfaces that are seen moving: their light shifted by the Doppler factor, with the whole spectrum.
//!
//! # Derivation
//!
//! A surface's colour becomes a smooth reflectance `R`, the surface is lit at rest by a black body of temperature `T`, and
//! of the light `R(lambda) B(lambda, T)` that it sends back an observer sees `D^5 R(D lambda) B(D lambda, T)`, where
//! `D^5 B(D lambda, T) = B(lambda, D T)`: a grey surface is seen as a black body of temperature `D T`. The eye of the CIE
//! 1931 makes a colour of it, in linear sRGB, each channel divided by that of the unshifted light: so that at `D = 1` every
//! surface has its own colour.
//!
//! Colours say nothing of a spectrum beyond the eye's reach. Beyond 380 and 730 nanometres the reflectance stays what it is
//! at these wavelengths. From `D = 1.92` on the visible light of 380 nanometres and more was infrared beyond 730: then
//! this rule alone decides.
//!
//! # Reference
//!
//! W. Jakob, J. Hanika, *A Low-Dimensional Function Space for Efficient Spectral Upsampling*, Computer Graphics Forum 38
//! (2019), 147.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use super::cie_1931::{COUNT, MATCHING, wavelength};
use super::{Beyond, Spectrum, Temperature, TemperatureError};

/// Planck's second radiation constant `h c / k` in metre kelvin: *The International System of Units*, 9th edition (2019).
pub(super) const SECOND_RADIATION_CONSTANT: f64 = 6.626_070_15e-34 * 299_792_458.0 / 1.380_649e-23;

/// The wavelengths between which a colour says what the reflectance is, in metres.
const KNOWN: (f64, f64) = (380e-9, 730e-9);

/// A wavelength is beyond those only if it is so by more than this part: products of wavelengths and Doppler factors are
/// rounded.
const ROUNDED: f64 = 1e-12;

/// A reflectance is found when every channel is right to this.
const FOUND: f64 = 1e-13;

/// Newton's steps for one target, halvings of the way from grey, and the largest coefficient of a reflectance.
const NEWTON_STEPS: usize = 12;
const SHORTEST_WAY: f64 = 1e-4;
const STEEPEST: f64 = 1e6;

/// From the CIE's X, Y, Z to linear sRGB. Reference: IEC 61966-2-1; its primaries, and its white (0.3127, 0.3290).
pub(super) static TO_RGB: LazyLock<DMat3> = LazyLock::new(|| {
    let of_unit_sum = |x: f64, y: f64| DVec3::new(x, y, 1.0 - x - y);
    let primaries = DMat3::from_cols(
        of_unit_sum(0.64, 0.33),
        of_unit_sum(0.30, 0.60),
        of_unit_sum(0.15, 0.06),
    );
    let white = of_unit_sum(0.3127, 0.3290) / 0.3290;
    let strengths = primaries.inverse() * white;
    (primaries * DMat3::from_diagonal(strengths)).inverse()
});

/// The spectral radiance of a black body of so many kelvin at a wavelength in metres, but for a factor.
pub(super) fn planck(wavelength: f64, kelvin: f64) -> f64 {
    // Of size 1 in the middle of the visible.
    let size = wavelength / 560e-9;
    1.0 / (size.powi(5) * (SECOND_RADIATION_CONSTANT / (wavelength * kelvin)).exp_m1())
}

/// The colour of the light of a black body in linear sRGB, at luminance 1: red above 1 where it is red, and below 0 where no
/// screen shows it.
pub fn black_body_color(kelvin: f64) -> DVec3 {
    let sum = |channel: usize| -> f64 {
        let rows = MATCHING.iter().enumerate();
        rows.map(|(row, matching)| matching[channel] * planck(wavelength(row), kelvin))
            .sum()
    };
    let [x, y, z] = [0, 1, 2].map(sum);
    *TO_RGB * DVec3::new(x / y, 1.0, z / y)
}

/// The light by which surfaces are seen: a black body, white-balanced so that at rest every surface has its own colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Daylight {
    spectrum: Spectrum,
    /// What the eye makes of light of each wavelength, in linear sRGB over the channels of the unshifted lamp.
    eye: [DVec3; COUNT],
    /// The same times the light of the lamp.
    lit: [DVec3; COUNT],
}

/// The part of the light of each wavelength that a surface sends back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// The same part of every wavelength: a grey.
    Grey(f64),
    /// A sigmoid of a quadratic of the wavelength, which is -1 at 380 and 1 at 730 nanometres; by falling powers.
    Sigmoid([f64; 3]),
}

impl Default for Daylight {
    /// Daylight of 6504 kelvin.
    fn default() -> Self {
        Self::of(Spectrum::default())
    }
}

impl Daylight {
    /// The light of a black body.
    ///
    /// # Errors
    ///
    /// A temperature below 500 or above 1e12 kelvin.
    pub fn new(kelvin: f64) -> Result<Self, TemperatureError> {
        Ok(Self::of(Spectrum {
            daylight: Temperature::new(kelvin)?,
            ..Spectrum::default()
        }))
    }

    /// Daylight, with what is known of reflectances beyond colours.
    pub fn of(spectrum: Spectrum) -> Self {
        let kelvin = spectrum.daylight.kelvin();
        let mut eye = MATCHING.map(|matching| *TO_RGB * DVec3::from_array(matching));
        let mut lit = eye;
        for (row, lit) in lit.iter_mut().enumerate() {
            let wavelength = wavelength(row);
            *lit *= spectrum.known(wavelength) * planck(wavelength, kelvin);
        }
        let lamp: DVec3 = lit.iter().sum();
        for channels in eye.iter_mut().chain(&mut lit) {
            *channels /= lamp;
        }
        Self { spectrum, eye, lit }
    }

    /// The temperature in kelvin.
    pub fn kelvin(&self) -> f64 {
        self.spectrum.daylight.kelvin()
    }

    /// What the eye makes of the light of each wavelength of the table, in linear sRGB over the channels of the unshifted
    /// lamp.
    pub(super) fn eye(&self) -> &[DVec3; COUNT] {
        &self.eye
    }

    /// The colour in which a surface is seen, in linear sRGB: its own at a Doppler factor (seen over emitted frequency) of 1.
    /// Channels may be above 1, and below 0 where no screen shows the colour.
    pub fn seen_color(&self, reflectance: &Reflectance, doppler_factor: f64) -> DVec3 {
        let kelvin = self.kelvin() * doppler_factor;
        let rows = self.eye.iter().enumerate();
        let light = rows.map(|(row, &eye)| {
            let wavelength = wavelength(row);
            eye * (self.part(reflectance, wavelength * doppler_factor) * planck(wavelength, kelvin))
        });
        light.sum()
    }

    /// The part of the light of a wavelength at rest that a surface sends back.
    pub(super) fn part(&self, reflectance: &Reflectance, wavelength: f64) -> f64 {
        match self.spectrum.known(wavelength) {
            0.0 => 0.0,
            known => known * reflectance.at(wavelength),
        }
    }

    /// A reflectance with this colour in linear sRGB, channels from 0 to 1; others are brought there.
    ///
    /// # Accuracy
    ///
    /// Every channel of the colour is right to `1e-12` (tests of this module, 35,000 colours), except within `1e-6` of
    /// black and white, to which `1e-6` applies: sigmoids get there as they become infinitely steep.
    pub fn reflectance(&self, color: DVec3) -> Reflectance {
        let color = color.clamp(DVec3::ZERO, DVec3::ONE);
        if color == DVec3::splat(color.x) {
            return Reflectance::Grey(color.x);
        }
        // From the grey of the same mean, in steps that Newton's method can follow.
        let grey = (color.element_sum() / 3.0).clamp(1e-3, 1.0 - 1e-3);
        let mut found = [0.0, 0.0, inverse_sigmoid(grey)];
        let (mut reached, mut step) = (0.0f64, 1.0f64);
        while reached < 1.0 && step >= SHORTEST_WAY {
            let next = (reached + step).min(1.0);
            let target = DVec3::splat(grey).lerp(color, next);
            match self.followed(found, target) {
                Some(nearer) => {
                    (found, reached) = (nearer, next);
                    step *= 2.0;
                }
                None => step *= 0.5,
            }
        }
        Reflectance::Sigmoid(found)
    }

    /// Newton's method from one reflectance to one of another colour nearby.
    fn followed(&self, mut coefficients: [f64; 3], target: DVec3) -> Option<[f64; 3]> {
        for _ in 0..NEWTON_STEPS {
            let (mut color, mut slopes) = (DVec3::ZERO, [DVec3::ZERO; 3]);
            for (row, &light) in self.lit.iter().enumerate() {
                let place = place(wavelength(row));
                let argument = quadratic(coefficients, place);
                color += light * sigmoid(argument);
                let size = 1.0 + argument * argument;
                let slope = light * (0.5 / (size * size.sqrt()));
                slopes[0] += slope * (place * place);
                slopes[1] += slope * place;
                slopes[2] += slope;
            }
            let off = color - target;
            if off.abs().max_element() <= FOUND {
                return Some(coefficients);
            }
            let [a, b, c] = slopes;
            let step = DMat3::from_cols(a, b, c).inverse() * off;
            for (coefficient, step) in coefficients.iter_mut().zip(step.to_array()) {
                *coefficient -= step;
                if !(coefficient.abs() <= STEEPEST) {
                    return None;
                }
            }
        }
        None
    }
}

impl Spectrum {
    /// 0 where surfaces are dark because colours say nothing of the wavelength, 1 elsewhere.
    fn known(&self, wavelength: f64) -> f64 {
        let (shortest, longest) = KNOWN;
        let is_dark = match wavelength {
            _ if wavelength < shortest * (1.0 - ROUNDED) => self.ultraviolet,
            _ if wavelength > longest * (1.0 + ROUNDED) => self.infrared,
            _ => Beyond::Edge,
        };
        f64::from(is_dark == Beyond::Edge)
    }
}

impl Reflectance {
    /// The part of the light of a wavelength, in metres, that is sent back, from 0 to 1.
    pub fn at(&self, wavelength: f64) -> f64 {
        match *self {
            Self::Grey(part) => part,
            Self::Sigmoid(coefficients) => sigmoid(quadratic(coefficients, place(wavelength))),
        }
    }
}

/// Where a wavelength is between those that colours speak of: from -1 to 1.
pub(super) fn place(wavelength: f64) -> f64 {
    let (shortest, longest) = KNOWN;
    let middle = 0.5 * (shortest + longest);
    (wavelength.clamp(shortest, longest) - middle) / (longest - middle)
}

fn quadratic([a, b, c]: [f64; 3], place: f64) -> f64 {
    (a * place + b) * place + c
}

fn sigmoid(argument: f64) -> f64 {
    0.5 + 0.5 * argument / (1.0 + argument * argument).sqrt()
}

fn inverse_sigmoid(part: f64) -> f64 {
    let twice = 2.0 * part - 1.0;
    twice / (1.0 - twice * twice).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_near(found: DVec3, expected: [f64; 3], limit: f64) {
        let error = (found - DVec3::from_array(expected)).abs().max_element();
        assert!(error <= limit, "{found} {expected:?}, off by {error:e}");
    }

    /// Linear sRGB at luminance 1, written with 4 digits.
    #[test]
    fn black_bodies_have_the_colours_of_the_tables() {
        for (kelvin, expected) in [
            (2000.0, [2.5203, 0.6469, 0.0204]),
            (4000.0, [1.4140, 0.9240, 0.5334]),
            (6500.0, [1.0434, 0.9836, 1.0350]),
            (10_000.0, [0.8720, 0.9946, 1.4307]),
        ] {
            assert_near(black_body_color(kelvin), expected, 1e-4);
        }
    }

    /// Luminances of a black body seen at a Doppler factor, over that at rest: not the fourth power of the factor.
    #[test]
    fn luminance_is_not_the_fourth_power() {
        let luminance = |kelvin: f64| -> f64 {
            let rows = MATCHING.iter().enumerate();
            rows.map(|(row, matching)| matching[1] * planck(wavelength(row), kelvin))
                .sum()
        };
        for (kelvin, factor, expected) in [
            (6504.0, 0.5, 0.018897),
            (6504.0, 2.0, 8.4448),
            (6504.0, 4.3589, 36.215),
            (5778.0, 0.5, 0.0117961),
            (5778.0, 2.0, 10.53638),
            (5778.0, 4.3589, 49.98454),
        ] {
            let found = luminance(kelvin * factor) / luminance(kelvin);
            assert!(
                (found / expected - 1.0f64).abs() < 1e-4,
                "{kelvin} {factor}: {found}"
            );
        }
    }

    #[test]
    fn greys_and_a_red_are_shifted_as_in_the_tables() {
        let light = Daylight::default();
        let grey = light.reflectance(DVec3::splat(0.5));
        for (factor, expected) in [
            (0.7, [0.1109, 0.0863, 0.0575]),
            (1.3, [1.151, 1.3085, 1.612]),
            (2.0, [3.2793, 4.2664, 6.6062]),
        ] {
            assert_near(light.seen_color(&grey, factor), expected, 1e-4);
        }
        let red = light.reflectance(DVec3::new(0.7, 0.05, 0.04));
        assert_near(light.seen_color(&red, 1.3), [2.142, 2.795, 0.814], 5e-4);
    }

    /// A grey surface is a black body of another temperature, at any factor.
    #[test]
    fn grey_is_a_black_body_of_the_shifted_temperature() {
        for kelvin in [1000.0, 2856.0, 4000.0, 6504.0, 20_000.0] {
            let light = Daylight::new(kelvin).expect("warm enough");
            for step in 0..20 {
                let factor = 10f64.powf(-0.5 + 0.1 * f64::from(step));
                let found = light.seen_color(&Reflectance::Grey(0.25), factor);
                let there = kelvin * factor;
                let lamp = |kelvin: f64| -> DVec3 {
                    let rows = MATCHING.iter().enumerate();
                    let light = rows.map(|(row, matching)| {
                        DVec3::from_array(*matching) * planck(wavelength(row), kelvin)
                    });
                    *TO_RGB * light.sum::<DVec3>()
                };
                let expected = 0.25 * lamp(there) / lamp(kelvin);
                let error = (found - expected).abs().max_element();
                assert!(
                    error <= 1e-13 * expected.abs().max_element(),
                    "{kelvin} {factor}"
                );
            }
        }
    }

    /// There and back for colours all over the cube, at its edges and next to them.
    #[test]
    fn every_colour_has_a_reflectance() {
        let light = Daylight::default();
        let mut levels: Vec<f64> = (0..=30).map(|level| f64::from(level) / 30.0).collect();
        levels.extend([1e-6, 1.0 - 1e-6]);
        for &red in &levels {
            for &green in &levels {
                for &blue in &levels {
                    let color = DVec3::new(red, green, blue);
                    let reflectance = light.reflectance(color);
                    let error = (light.seen_color(&reflectance, 1.0) - color)
                        .abs()
                        .max_element();
                    let spread = color.max_element() - color.min_element();
                    let at_the_end = spread <= 1e-6 && !(1e-3..0.999).contains(&color.x);
                    let limit = if at_the_end { 1e-6 } else { 1e-12 };
                    assert!(error <= limit, "{color}: off by {error:e}, {reflectance:?}");
                    for nanometres in [100.0, 380.0, 500.0, 650.0, 730.0, 5000.0] {
                        assert!((0.0..=1.0).contains(&reflectance.at(nanometres * 1e-9)));
                    }
                }
            }
        }
    }

    /// With a dark infrared nothing is left of visible light that was infrared, and at rest all is as ever.
    #[test]
    fn what_colours_say_nothing_of_may_be_dark() {
        let dark = |infrared, ultraviolet| {
            Daylight::of(Spectrum {
                infrared,
                ultraviolet,
                ..Spectrum::default()
            })
        };
        let (edge, none) = (Beyond::Edge, Beyond::Dark);
        let color = DVec3::new(0.6, 0.3, 0.2);
        for (light, darkest) in [
            (dark(none, edge), 2.03),
            (dark(edge, none), 0.457),
            (dark(none, none), 2.03),
        ] {
            for color in [color, DVec3::ONE] {
                let reflectance = light.reflectance(color);
                assert_near(light.seen_color(&reflectance, 1.0), color.to_array(), 1e-12);
                assert_eq!(light.seen_color(&reflectance, darkest), DVec3::ZERO);
            }
        }
        let other = dark(none, edge);
        let reflectance = other.reflectance(color);
        assert!(other.seen_color(&reflectance, 0.457).x > 0.0);
        // Between the edges nothing of it is seen, but for the ends that the eye hardly sees.
        let usual = Daylight::default();
        let found = usual.seen_color(&usual.reflectance(color), 1.02);
        assert_near(other.seen_color(&reflectance, 1.02), found.to_array(), 2e-3);
    }

    #[test]
    fn no_factor_makes_a_number_that_is_none() {
        let light = Daylight::default();
        let green = light.reflectance(DVec3::new(0.1, 0.8, 0.2));
        for factor in [0.0, 1e-300, 1e-3, 1.0, 1e3, 1e100] {
            let color = light.seen_color(&green, factor);
            assert!(color.is_finite(), "{factor}: {color}");
        }
        assert_eq!(light.seen_color(&green, 1e-3), DVec3::ZERO);
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY, 499.0] {
            assert!(Daylight::new(wrong).is_err(), "{wrong}");
        }
    }
}
