//! The colour in which a surface is seen: whatever effects are asked for, in one function.

use std::sync::OnceLock;

use glam::DVec3;

use super::color_table::ColorTable;
use super::planckian::{Glow, Planckian};
use super::{Daylight, Doppler, Spectrum, Temperature, luminance, ramp_color};

/// Limits on the natural logarithm of a ratio of luminances: what is beyond them is beyond every screen.
const LOGARITHMS: (f64, f64) = (-600.0, 600.0);

/// So bright that brighter light is no other, and far below what `f64` ends with.
const BRIGHTEST: f64 = 1e260;

/// The light of surfaces as an observer sees it, with the effects that are asked for and no others.
///
/// The Doppler effect changes colours at the luminance that surfaces have at rest; the searchlight effect changes their
/// brightness by the ratio of the luminances of the light that arrives and the light at rest, and keeps the colour. Both
/// together are the whole shifted spectrum. The ratio is that which the eye sees, not the fourth power of the Doppler
/// factor: of daylight seen at 2 it is 8.4.
///
/// Tables are made where a colour first needs them; `photosurface check` says how long all of it takes.
///
/// # Accuracy
///
/// Greys are right to a part of `1e-4`. Of the bytes of other colours, after [`tone`](super::tone), 94 of 100 are within two
/// steps of those of the sum over the spectrum, and 97 of 100 within eight; what is farther off are saturated colours, above
/// all yellow ones, whose reflectance near 730 nanometres changes much with the colour. At a Doppler factor of 1 every
/// colour is its own to `1e-6` (tests of this module).
///
/// # Example
///
/// ```
/// use photosurface::DVec3;
/// use photosurface::effects::{Doppler, SeenLight, Spectrum};
///
/// let light = SeenLight::new(Doppler::Spectrum(Spectrum::default()), true);
/// let grey = light.seen(DVec3::splat(0.5), light.daylight(), 2.0);
/// assert!(grey.z > grey.x && grey.x > 3.0, "twice the frequency is blue and bright");
/// ```
pub struct SeenLight {
    doppler: Doppler,
    searchlight: bool,
    spectrum: Spectrum,
    black_bodies: OnceLock<Planckian>,
    colors: OnceLock<ColorTable>,
}

/// A lamp, as it lights a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamplight {
    /// The temperature in kelvin at rest with the lamp.
    pub kelvin: f64,
    /// The Doppler factor of its light at rest with the surface.
    pub factor: f64,
}

impl SeenLight {
    /// The light with these effects.
    pub fn new(doppler: Doppler, searchlight: bool) -> Self {
        let spectrum = match doppler {
            Doppler::Spectrum(spectrum) => spectrum,
            Doppler::None | Doppler::Ramp => Spectrum::default(),
        };
        Self {
            doppler,
            searchlight,
            spectrum,
            black_bodies: OnceLock::new(),
            colors: OnceLock::new(),
        }
    }

    /// The light in which every surface at rest has its own colour, from a lamp at rest with it.
    pub fn daylight(&self) -> Lamplight {
        Lamplight {
            kelvin: self.spectrum.daylight.kelvin(),
            factor: 1.0,
        }
    }

    /// Whether light changes on its way.
    pub fn is_shifted(&self) -> bool {
        self.doppler != Doppler::None || self.searchlight
    }

    /// The light of a surface whose colour, in linear sRGB, is `color`, lit by a lamp and seen with a Doppler factor (seen
    /// over emitted frequency) from 0 to infinity: linear sRGB, channels below 0 where no screen shows the colour.
    ///
    /// A white surface at rest lit by a lamp at rest with it has luminance 1, in daylight the colour (1, 1, 1). Light that a
    /// surface emits itself is that of a surface of this colour in daylight.
    pub fn seen(&self, color: DVec3, lamp: Lamplight, doppler_factor: f64) -> DVec3 {
        if !self.is_shifted() && lamp.kelvin == self.daylight().kelvin {
            return color;
        }
        let log_factor = doppler_factor.ln();
        if self.doppler == Doppler::Ramp {
            let brighter = match self.searchlight {
                true => self.brighter(lamp, &self.glow_of(lamp, log_factor)),
                false => 1.0,
            };
            return ramp_color(doppler_factor) * brighter;
        }
        // Reflectances are those of colours up to white; brighter ones are so many times as bright.
        let color = color.max(DVec3::ZERO);
        let times = color.max_element().max(1.0);
        let color = color / times;
        let at_rest = match lamp.kelvin == self.daylight().kelvin {
            true => color,
            false => {
                let still = Lamplight {
                    factor: 1.0,
                    ..lamp
                };
                self.light(color, lamp.kelvin, 0.0, &self.glow_of(still, 0.0))
            }
        };
        if !self.is_shifted() {
            return at_rest * times;
        }
        let glow = self.glow_of(lamp, log_factor);
        let shifted = self.light(color, lamp.kelvin * lamp.factor, log_factor, &glow);
        let [rest_luminance, seen_luminance] = [at_rest, shifted].map(luminance);
        let light = match (self.doppler, self.searchlight) {
            (Doppler::None, _) if !(rest_luminance > 0.0) => DVec3::ZERO,
            (Doppler::None, _) => at_rest * (seen_luminance.max(0.0) / rest_luminance),
            (_, true) => shifted,
            (_, false) if !(seen_luminance > 0.0) => DVec3::ZERO,
            (_, false) => shifted * (rest_luminance / seen_luminance),
        };
        light * (times * self.brighter(lamp, &glow))
    }

    /// The light of a black body of this temperature and luminance at rest.
    pub fn glow(&self, temperature: Temperature, luminance: f64, doppler_factor: f64) -> DVec3 {
        let lamp = Lamplight {
            kelvin: temperature.kelvin(),
            factor: 1.0,
        };
        let glow = self.glow_of(lamp, doppler_factor.ln());
        let hue = match self.doppler {
            Doppler::None => self.black_bodies().at(lamp.kelvin.ln()).hue,
            Doppler::Spectrum(_) => glow.hue,
            Doppler::Ramp => ramp_color(doppler_factor),
        };
        hue * (luminance * self.brighter(lamp, &glow)).min(BRIGHTEST)
    }

    /// The light of a lamp, as it is seen of a white surface whose Doppler factor has this natural logarithm.
    fn glow_of(&self, lamp: Lamplight, log_factor: f64) -> Glow {
        let log_kelvin = (lamp.kelvin * lamp.factor).ln();
        self.black_bodies().at(log_kelvin + log_factor)
    }

    /// Over the luminance of a white surface in this light.
    fn light(&self, color: DVec3, kelvin: f64, log_factor: f64, glow: &Glow) -> DVec3 {
        let colors = self
            .colors
            .get_or_init(|| ColorTable::new(Daylight::of(self.spectrum)));
        colors.light(self.black_bodies(), color, kelvin, log_factor, glow.hue)
    }

    /// The luminance of a white surface, whose light is `glow`, over that at rest, where it is to be seen.
    fn brighter(&self, lamp: Lamplight, glow: &Glow) -> f64 {
        if !self.searchlight {
            return 1.0;
        }
        // That of daylight is 1.
        let at_rest = match lamp.kelvin == self.daylight().kelvin {
            true => 0.0,
            false => self.black_bodies().at(lamp.kelvin.ln()).log_luminance(),
        };
        let ratio = glow.log_luminance() - at_rest;
        ratio.clamp(LOGARITHMS.0, LOGARITHMS.1).exp()
    }

    fn black_bodies(&self) -> &Planckian {
        // They have light of every wavelength.
        let spectrum = Spectrum {
            daylight: self.spectrum.daylight,
            ..Spectrum::default()
        };
        self.black_bodies
            .get_or_init(|| Planckian::new(&Daylight::of(spectrum)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Beyond, Reflectance, tone, within_gamut};
    use super::*;

    fn spectrum(searchlight: bool) -> SeenLight {
        SeenLight::new(Doppler::Spectrum(Spectrum::default()), searchlight)
    }

    fn bytes(color: DVec3) -> [u8; 3] {
        let shown = tone(within_gamut(color)).as_vec3();
        shown.to_array().map(super::super::byte_of_linear)
    }

    /// Colours of a scene: from quite dark to quite bright.
    fn colors() -> Vec<DVec3> {
        let levels = [0.03, 0.1, 0.25, 0.5, 0.77, 0.9];
        let pairs =
            levels.map(|red| levels.map(|green| levels.map(|blue| DVec3::new(red, green, blue))));
        pairs.into_iter().flatten().flatten().collect()
    }

    fn factors() -> impl Iterator<Item = f64> {
        (-50..=50).map(|step| 2f64.powf(0.0507 * f64::from(step)))
    }

    #[test]
    fn nothing_is_done_where_nothing_is_asked_for() {
        let light = SeenLight::new(Doppler::None, false);
        let color = DVec3::new(0.2, 7.0, -0.1);
        assert_eq!(light.seen(color, light.daylight(), 1.7), color);
        assert!(light.colors.get().is_none() && light.black_bodies.get().is_none());
    }

    #[test]
    fn greys_are_black_bodies_of_the_shifted_temperature() {
        let exact = Daylight::default();
        let light = spectrum(true);
        for factor in factors().map(|factor| factor * 1.01) {
            for part in [1e-3, 0.2, 0.5, 1.0] {
                let expected = exact.seen_color(&Reflectance::Grey(part), factor);
                let found = light.seen(DVec3::splat(part), light.daylight(), factor);
                let error = (found - expected).abs().max_element();
                assert!(
                    error < 1e-4 * expected.abs().max_element(),
                    "{factor} {part}: {error:e}"
                );
            }
        }
    }

    #[test]
    fn unshifted_light_has_the_colour_of_the_surface() {
        let mut levels: Vec<f64> = (0..=20).map(|level| f64::from(level) / 20.0).collect();
        levels.extend([1e-5, 2.5, 100.0]);
        for searchlight in [false, true] {
            for edges in [Beyond::Edge, Beyond::Dark] {
                let light = SeenLight::new(
                    Doppler::Spectrum(Spectrum {
                        infrared: edges,
                        ultraviolet: edges,
                        ..Spectrum::default()
                    }),
                    searchlight,
                );
                for (&red, &green) in levels
                    .iter()
                    .flat_map(|a| levels.iter().map(move |b| (a, b)))
                {
                    for &blue in &levels {
                        let color = DVec3::new(red, green, blue);
                        let error = (light.seen(color, light.daylight(), 1.0) - color)
                            .abs()
                            .max_element();
                        assert!(
                            error <= 1e-6 * color.max_element().max(1.0),
                            "{color}: {error:e}"
                        );
                    }
                }
            }
        }
    }

    /// Whatever the factor: light that a screen can show, at the luminance at rest where nothing is searched for.
    #[test]
    fn no_factor_makes_a_colour_that_is_none() {
        let dark = Doppler::Spectrum(Spectrum {
            infrared: Beyond::Dark,
            ultraviolet: Beyond::Dark,
            ..Spectrum::default()
        });
        let usual = Doppler::Spectrum(Spectrum::default());
        for doppler in [Doppler::None, usual, dark, Doppler::Ramp] {
            for searchlight in [false, true] {
                let light = SeenLight::new(doppler, searchlight);
                let mut factors = vec![0.0, 5e-324, 1e-300, 1e300, f64::MAX, f64::INFINITY];
                factors.extend((-60..60).map(|step| 10f64.powf(0.1 * f64::from(step))));
                for factor in factors {
                    for color in [DVec3::ZERO, DVec3::ONE, DVec3::X, DVec3::new(0.3, 7.0, 0.0)] {
                        for (kelvin, lamp) in
                            [(6504.0, 1.0), (3000.0, 1.0), (3000.0, 1e-9), (1e12, 1e30)]
                        {
                            let lamp = Lamplight {
                                kelvin,
                                factor: lamp,
                            };
                            let seen = within_gamut(light.seen(color, lamp, factor));
                            let glow = within_gamut(light.glow(Temperature::DAYLIGHT, 2.0, factor));
                            for light in [seen, glow] {
                                assert!(
                                    light.is_finite() && light.min_element() >= 0.0,
                                    "{doppler:?} {color} {factor}"
                                );
                            }
                            if doppler == usual
                                && !searchlight
                                && lamp.kelvin == 6504.0
                                && color == DVec3::ONE
                            {
                                assert!((luminance(seen) - 1.0).abs() < 1e-9, "{factor}: {seen}");
                            }
                        }
                    }
                }
            }
        }
    }

    /// A lamp that comes closer is a hotter lamp, and shifts go one after the other: of greys only their product counts.
    #[test]
    fn lamps_have_colours_and_shifts_of_their_own() {
        let light = spectrum(true);
        let white =
            |kelvin, factor, doppler| light.seen(DVec3::ONE, Lamplight { kelvin, factor }, doppler);
        let near = |a: DVec3, b: DVec3| {
            assert!(
                (a - b).abs().max_element() < 1e-4 * b.max_element(),
                "{a} {b}"
            )
        };
        near(white(3000.0, 1.5, 0.8), white(3000.0, 1.0, 1.2));
        near(white(6504.0, 2.0, 1.0), white(6504.0, 1.0, 2.0));
        assert!((luminance(white(3000.0, 1.0, 1.0)) - 1.0).abs() < 1e-6);
        let candle =
            super::super::black_body_color(2000.0) / super::super::black_body_color(6504.0);
        near(white(2000.0, 1.0, 1.0), candle / luminance(candle));
        let glow = light.glow(Temperature::new(2000.0).unwrap(), 3.0, 1.0);
        near(glow, 3.0 * candle / luminance(candle));
        // Red paint by candlelight is as it is without effects.
        let red = DVec3::new(0.7, 0.05, 0.04);
        let candlelight = Lamplight {
            kelvin: 2000.0,
            factor: 1.0,
        };
        let without = SeenLight::new(Doppler::None, false).seen(red, candlelight, 1.7);
        near(light.seen(red, candlelight, 1.0), without);
    }

    /// Against the sum over the spectrum, as bytes of a picture.
    #[test]
    fn colours_are_those_of_the_whole_spectrum() {
        let exact = Daylight::default();
        let both = spectrum(true);
        let hue = spectrum(false);
        let bright = SeenLight::new(Doppler::None, true);
        let (mut counts, mut worst) = ([0_usize; 256], (0, String::new()));
        for color in colors() {
            let reflectance = exact.reflectance(color);
            for factor in factors() {
                let shifted = exact.seen_color(&reflectance, factor);
                let ratio = luminance(shifted) / luminance(color);
                for (light, expected) in [
                    (&both, shifted),
                    (&hue, shifted / ratio),
                    (&bright, color * ratio),
                ] {
                    let found = light.seen(color, light.daylight(), factor);
                    let [found_bytes, expected_bytes] = [found, expected].map(bytes);
                    let off = (0..3)
                        .map(|k| found_bytes[k].abs_diff(expected_bytes[k]))
                        .max()
                        .unwrap_or(0);
                    counts[usize::from(off)] += 1;
                    if off > worst.0 {
                        worst = (off, format!("{color} {factor} {found} {expected}"));
                    }
                }
            }
        }
        let total: usize = counts.iter().sum();
        let beyond = |limit: usize| counts[limit + 1..].iter().sum::<usize>() as f64 / total as f64;
        assert!(beyond(2) < 0.06 && beyond(8) < 0.03, "{worst:?}");
    }
}
