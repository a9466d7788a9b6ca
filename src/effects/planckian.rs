//! The light of black bodies of every temperature, as a table.

use glam::DVec3;

use super::cie_1931::{COUNT, wavelength};
use super::luminance;
use super::spectrum::{Daylight, SECOND_RADIATION_CONSTANT, planck};

/// Between which temperatures, in kelvin, the table is: colder bodies have the colour of the longest wavelength alone, and
/// spectra of hotter ones differ by a factor alone.
const COLDEST: f64 = 200.0;
const HOTTEST: f64 = 1e9;

/// From one temperature of the table to the next, of the natural logarithm.
const STEP: f64 = 1.0 / 256.0;

/// Of a light whose luminance grows about as those of black bodies; of the longest wavelength; in metres.
const MIDDLE: f64 = 560e-9;

/// The light of black bodies: luminance, over that of daylight, and colour.
///
/// # Accuracy
///
/// Luminance and colour within a part of `3e-5` above 800 kelvin (test of this module); at the temperature of daylight those
/// of the sum over the spectrum.
pub(super) struct Planckian {
    /// The logarithm of the first temperature.
    first: f64,
    rows: Vec<Row>,
}

/// A black body of one temperature.
#[derive(Clone, Copy)]
pub(super) struct Glow {
    /// The colour in linear sRGB, white as daylight is, at luminance 1.
    pub(super) hue: DVec3,
    log_excess: f64,
    log_kelvin: f64,
}

/// The logarithm of what the luminance is over that of light of one wavelength, and the hue of a [`Glow`].
#[derive(Clone, Copy)]
struct Row {
    log_excess: f64,
    hue: DVec3,
}

impl Planckian {
    pub(super) fn new(daylight: &Daylight) -> Self {
        // Daylight itself is one of them.
        let at_daylight = daylight.kelvin().ln();
        let before = ((at_daylight - COLDEST.ln()) / STEP).ceil();
        let first = at_daylight - before * STEP;
        let count = ((HOTTEST.max(daylight.kelvin()).ln() - first) / STEP).ceil() as usize;
        let row = |number: usize| {
            let log_kelvin = first + STEP * number as f64;
            let kelvin = log_kelvin.exp();
            let rows = daylight.eye().iter().enumerate();
            let light: DVec3 = rows
                .map(|(row, &eye)| eye * planck(wavelength(row), kelvin))
                .sum();
            let luminance = luminance(light);
            Row {
                log_excess: luminance.ln() + exponent(MIDDLE, log_kelvin),
                hue: light / luminance,
            }
        };
        Self {
            first,
            rows: (0..=count).map(row).collect(),
        }
    }

    /// A black body of any temperature from 0 to infinity, given by its natural logarithm.
    pub(super) fn at(&self, log_kelvin: f64) -> Glow {
        let last = self.rows.len() - 1;
        let place = (log_kelvin - self.first) / STEP;
        if !(place > 0.0) {
            // The longest wavelength is all that is left.
            let longest = wavelength(COUNT - 1);
            let [fainter, colder] =
                [longest, MIDDLE].map(|wavelength| exponent(wavelength, log_kelvin));
            let [first_fainter, first_colder] =
                [longest, MIDDLE].map(|wavelength| exponent(wavelength, self.first));
            let excess = (colder - first_colder) - (fainter - first_fainter);
            return self.rows[0].glow(excess, log_kelvin);
        }
        if place >= last as f64 {
            // Luminance grows as the temperature does.
            let brighter = (place - last as f64) * STEP;
            return self.rows[last].glow(brighter, log_kelvin);
        }
        let (before, part) = (place as usize, place.fract());
        let [low, high] = [self.rows[before], self.rows[before + 1]];
        let between = Row {
            log_excess: low.log_excess + part * (high.log_excess - low.log_excess),
            hue: low.hue.lerp(high.hue, part),
        };
        between.glow(0.0, log_kelvin)
    }
}

impl Row {
    fn glow(self, more: f64, log_kelvin: f64) -> Glow {
        Glow {
            hue: self.hue,
            log_excess: self.log_excess + more,
            log_kelvin,
        }
    }
}

impl Glow {
    /// The natural logarithm of the luminance over that of daylight.
    pub(super) fn log_luminance(&self) -> f64 {
        match self.log_excess {
            // Colder than all that has a light in `f64`: exponents beyond it would have no difference.
            excess if excess.is_nan() => f64::NEG_INFINITY,
            excess => excess - exponent(MIDDLE, self.log_kelvin),
        }
    }
}

/// The exponent of the cut-off of Planck's law.
fn exponent(wavelength: f64, log_kelvin: f64) -> f64 {
    SECOND_RADIATION_CONSTANT / wavelength * (-log_kelvin).exp()
}

#[cfg(test)]
mod tests {
    use super::super::{Reflectance, black_body_color};
    use super::*;

    #[test]
    fn the_table_has_the_light_of_black_bodies() {
        let daylight = Daylight::default();
        let table = Planckian::new(&daylight);
        for step in 0..4000 {
            let kelvin = 800.0 * 1.003f64.powi(step);
            let found = table.at(kelvin.ln());
            let light = daylight.seen_color(&Reflectance::Grey(1.0), kelvin / 6504.0);
            let expected = luminance(light);
            let error = found.log_luminance() - expected.ln();
            assert!(error.abs() < 3e-5, "{kelvin}: {error:e}");
            let error = (found.hue - light / expected).abs().max_element();
            assert!(error < 3e-5, "{kelvin}: {error:e}");
        }
        let exact = table.at(6504f64.ln());
        assert!(exact.log_luminance().abs() < 1e-12);
        assert!((exact.hue - 1.0).abs().max_element() < 1e-12);
    }

    /// Neither cold nor heat has a colour that is none: those of the longest wavelength, and of Rayleigh and Jeans.
    #[test]
    fn no_temperature_is_without_a_colour() {
        let table = Planckian::new(&Daylight::default());
        let (cold, hot) = (table.at(f64::NEG_INFINITY), table.at(f64::INFINITY));
        assert_eq!(
            (cold.log_luminance(), hot.log_luminance()),
            (f64::NEG_INFINITY, f64::INFINITY)
        );
        let white = black_body_color(6504.0);
        let limits = [(cold, 250.0, 1e-2), (hot, 1e11, 1e-4)];
        for (found, kelvin, limit) in limits {
            let expected = black_body_color(kelvin) / white;
            let expected = expected / luminance(expected);
            let error = (found.hue - expected).abs().max_element();
            assert!(error < limit, "{kelvin}: {} {expected}", found.hue);
        }
        let mut before = f64::NEG_INFINITY;
        for step in -3000..3000 {
            let found = table.at(10f64.powf(0.1 * f64::from(step)).ln());
            assert!(
                found.hue.is_finite() && found.log_luminance() >= before,
                "{step}"
            );
            before = found.log_luminance();
        }
    }
}
