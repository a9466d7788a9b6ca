//! Colours under the Doppler effect as tables small enough for a page, from which a shader works out every colour.

use glam::DVec3;

use super::{Doppler, RAMP_OCTAVES, SeenLight, Spectrum, luminance, ramp_color};

/// Colours along each side of the cube; their square roots are evenly spread.
const SIDE: usize = 11;

/// Doppler factors of the cubes: evenly spread logarithms. Beyond the first and the last, all that is visible was beyond the
/// wavelengths of which colours speak.
const FACTORS: usize = 17;
const OCTAVES: [f64; 2] = [-8.0 / 7.0, 8.0 / 7.0];

/// Doppler factors of white light: below them light is too faint for any screen, above them only brighter.
const WHITE_OCTAVES: [f64; 2] = [-4.0, 8.0];
const WHITE_STEPS: usize = 12 * 32;

/// Steps of the ramp, whose ends are at plus and minus [`RAMP_OCTAVES`].
const RAMP_STEPS: usize = 64;

/// A byte of this value means 0.
const ZERO: f64 = 128.0;
const LARGEST: f64 = 127.0;

/// What becomes of the light of surfaces, as tables: see [`SeenLight`], which they are made from.
///
/// The light of a surface of colour `c`, over the luminance of a white one, is `c` times the hue of white, channel by channel,
/// and a rest, which is 0 for every grey. The rest is in `rest`, three bytes for each colour and factor, red fastest, then green,
/// blue and the factor: with `root = (byte - 128) / 127` it is `root |root| scale`. Between colours it is linear in each of the six tetrahedra of a cube around
/// its grey diagonal. Beyond the first and the last factor, light is that of a grey as bright as the light at that factor.
///
/// # Accuracy
///
/// Greys are right to a part of `2e-3`. Of the bytes of other colours, after [`tone`](super::tone), seven of ten are within
/// eight steps of those of [`SeenLight`], and eight of ten within sixteen; the others are those of saturated colours (test of
/// this module).
#[derive(Clone, Debug, PartialEq)]
pub struct ShaderTable {
    /// Colours along each side of the cube.
    pub side: usize,
    /// Doppler factors, whose logarithms are evenly spread.
    pub factors: usize,
    /// Binary logarithms of the first and the last factor.
    pub octaves: [f64; 2],
    /// The largest value in `rest`.
    pub scale: f64,
    /// The table.
    pub rest: Vec<u8>,
    /// Binary logarithms of the first and the last factor of `white`.
    pub white_octaves: [f64; 2],
    /// For evenly spread logarithms of the factor the hue of a white surface at luminance 1, and the binary logarithm of its
    /// luminance over that at rest.
    pub white: Vec<[f64; 4]>,
    /// Binary logarithms of the first and the last factor of `ramp`.
    pub ramp_octaves: [f64; 2],
    /// The colours of the ramp, in linear sRGB.
    pub ramp: Vec<[f64; 3]>,
    /// The temperature of the daylight in kelvin.
    pub daylight_kelvin: f64,
}

impl ShaderTable {
    /// The tables for spectra of which this is known.
    pub fn new(spectrum: Spectrum) -> Self {
        let light = SeenLight::new(Doppler::Spectrum(spectrum), true);
        let white_at = |octaves: f64| {
            let seen = light.seen(DVec3::ONE, light.daylight(), octaves.exp2());
            let brightness = luminance(seen).max(f64::MIN_POSITIVE);
            (seen / brightness, brightness)
        };
        let rests: Vec<DVec3> = even(OCTAVES, FACTORS)
            .flat_map(|octaves| {
                let (hue, brightness) = white_at(octaves);
                let seen = |color| light.seen(color, light.daylight(), octaves.exp2()) / brightness;
                cube()
                    .map(move |color| seen(color) - color * hue)
                    .collect::<Vec<_>>()
            })
            .collect();
        let largest = |rest: &DVec3| rest.abs().max_element();
        let scale = rests.iter().map(largest).fold(1e-6, f64::max);
        let byte = |value: f64| {
            let root = (value.abs() / scale).sqrt().copysign(value);
            (root * LARGEST + ZERO).round() as u8
        };
        Self {
            side: SIDE,
            factors: FACTORS,
            octaves: OCTAVES,
            scale,
            rest: rests
                .iter()
                .flat_map(|rest| rest.to_array().map(byte))
                .collect(),
            white_octaves: WHITE_OCTAVES,
            white: even(WHITE_OCTAVES, WHITE_STEPS + 1)
                .map(|octaves| {
                    let (hue, brightness) = white_at(octaves);
                    [hue.x, hue.y, hue.z, brightness.log2()]
                })
                .collect(),
            ramp_octaves: [-RAMP_OCTAVES, RAMP_OCTAVES],
            ramp: even([-RAMP_OCTAVES, RAMP_OCTAVES], RAMP_STEPS + 1)
                .map(|octaves| ramp_color(octaves.exp2()).to_array())
                .collect(),
            daylight_kelvin: light.daylight().kelvin,
        }
    }
}

/// So many evenly spread numbers, the ends among them.
fn even([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |step| from + (to - from) * step as f64 / (count - 1) as f64)
}

/// The colours of the cube, red fastest.
fn cube() -> impl Iterator<Item = DVec3> {
    let level = |step: usize| (step as f64 / (SIDE - 1) as f64).powi(2);
    (0..SIDE * SIDE * SIDE).map(move |number| {
        DVec3::new(
            level(number % SIDE),
            level(number / SIDE % SIDE),
            level(number / SIDE / SIDE),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::{byte_of_linear, tone, within_gamut};
    use super::*;

    /// What the shader of the page makes of the tables.
    fn shaded(table: &ShaderTable, color: DVec3, octaves: f64) -> DVec3 {
        let place = |octaves: f64, [from, to]: [f64; 2], count: usize| {
            let at = (octaves - from) / (to - from) * (count - 1) as f64;
            let first = (at.max(0.0) as usize).min(count - 2);
            (first, at - first as f64)
        };
        let white = |octaves: f64| {
            let (first, part) = place(octaves, table.white_octaves, table.white.len());
            let [low, high] = [table.white[first], table.white[first + 1]];
            std::array::from_fn::<f64, 4, _>(|k| low[k] + (high[k] - low[k]) * part)
        };
        let [.., log_brightness] = white(octaves);
        let hue = |octaves| DVec3::from_slice(&white(octaves));
        let inside = octaves.clamp(table.octaves[0], table.octaves[1]);
        let (factor, between) = place(inside, table.octaves, table.factors);
        let cell = color
            .to_array()
            .map(|channel| channel.sqrt() * (SIDE - 1) as f64);
        let corner = cell.map(|at| (at as usize).min(SIDE - 2));
        let mut parts: Vec<(f64, usize)> = (0..3)
            .map(|axis| (cell[axis] - corner[axis] as f64, SIDE.pow(axis as u32)))
            .collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let value = |byte: u8| {
            let root = (f64::from(byte) - ZERO) / LARGEST;
            root * root.abs() * table.scale
        };
        let entry = |number: usize| {
            DVec3::from_array(std::array::from_fn(|k| value(table.rest[3 * number + k])))
        };
        let at_factor = |factor: usize| {
            let mut number = corner[0] + SIDE * (corner[1] + SIDE * (corner[2] + SIDE * factor));
            let mut rest = entry(number) * (1.0 - parts[0].0);
            for (k, &(part, step)) in parts.iter().enumerate() {
                number += step;
                let next = parts.get(k + 1).map_or(0.0, |&(part, _)| part);
                rest += entry(number) * (part - next);
            }
            rest
        };
        let rest = at_factor(factor).lerp(at_factor(factor + 1), between);
        let light = color * hue(inside) + rest;
        let light = match inside == octaves {
            true => light,
            false => hue(octaves) * luminance(light).clamp(0.0, 1.0),
        };
        light * log_brightness.exp2()
    }

    fn bytes(light: DVec3) -> [u8; 3] {
        let shown = tone(within_gamut(light)).as_vec3();
        shown.to_array().map(byte_of_linear)
    }

    #[test]
    fn colours_of_the_tables_are_those_that_are_seen() {
        let table = ShaderTable::new(Spectrum::default());
        let light = SeenLight::new(Doppler::Spectrum(Spectrum::default()), true);
        let levels = [0.05, 0.2, 0.45, 0.7, 0.95];
        let (mut near, mut all, mut far) = (0, 0, 0);
        for number in 0..125 {
            let color = DVec3::new(
                levels[number % 5],
                levels[number / 5 % 5],
                levels[number / 25],
            );
            for step in -45..=45 {
                let octaves = 0.0431 * f64::from(step);
                let expected = light.seen(color, light.daylight(), octaves.exp2());
                let found = shaded(&table, color, octaves);
                // As bright as at rest: how strong light is is another thing.
                let brightness = luminance(expected).max(1e-300) / luminance(color);
                let [found, expected] = [found, expected].map(|light| bytes(light / brightness));
                let off = (0..3).map(|k| found[k].abs_diff(expected[k])).max();
                near += usize::from(off <= Some(8));
                far += usize::from(off <= Some(16));
                all += 1;
            }
        }
        assert!(
            near * 10 >= all * 7 && far * 10 >= all * 8,
            "{near}, {far} of {all}"
        );
    }

    #[test]
    fn greys_keep_their_hue_and_brightness() {
        let table = ShaderTable::new(Spectrum::default());
        let light = SeenLight::new(Doppler::Spectrum(Spectrum::default()), true);
        for step in -60..=90 {
            let octaves = 0.0431 * f64::from(step);
            for part in [0.1, 0.6, 1.0] {
                let color = DVec3::splat(part);
                let expected = light.seen(color, light.daylight(), octaves.exp2());
                let error = (shaded(&table, color, octaves) - expected)
                    .abs()
                    .max_element();
                let limit = 2e-3 * expected.abs().max_element();
                assert!(error < limit, "{octaves} {part}: {error:e}");
            }
        }
    }

    #[test]
    fn at_rest_every_colour_stays() {
        let table = ShaderTable::new(Spectrum::default());
        for number in 0..SIDE * SIDE * SIDE {
            let color = cube().nth(number).unwrap();
            let error = (shaded(&table, color, 0.0) - color).abs().max_element();
            assert!(error < 1e-3, "{color}: {error:e}");
        }
    }
}
