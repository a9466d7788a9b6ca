//! Colours of surfaces under shifted light, as a table: what is exact for one colour, quickly for all.

use std::sync::OnceLock;

use glam::DVec3;
use rayon::prelude::*;

use super::cie_1931::{COUNT, wavelength};
use super::planckian::Planckian;
use super::spectrum::{Daylight, Reflectance, planck};

/// Colours along each axis of the cube: their square roots are evenly spread, as the eye tells them apart.
const SIDE: usize = 17;

/// Doppler factors of the table: evenly spread logarithms, 1 among them. Beyond the first and the last, all that is visible
/// was beyond the wavelengths of which colours speak.
const OCTAVE: f64 = 28.0;
const BEFORE_ONE: usize = 32;
const FACTORS: usize = 62;

/// Temperatures of the illuminant, as 1e6 over kelvin; with daylight's own.
const MIREDS: [f64; 12] = [
    0.0, 40.0, 80.0, 120.0, 200.0, 260.0, 330.0, 420.0, 550.0, 750.0, 1100.0, 2000.0,
];

/// The light of surfaces, over that which a white surface sends back.
///
/// # Derivation
///
/// The light of a surface of colour `c`, over the luminance of a white one, is that of a grey one channel by channel, `c`
/// times the hue of the black body, and a rest, which is 0 for every grey, and for every colour in unshifted daylight. The
/// table holds the rest: between colours linear in each of the six tetrahedra of a cube around its grey diagonal, linear in
/// the logarithm of the Doppler factor and in the reciprocal of the temperature.
pub(super) struct ColorTable {
    daylight: Daylight,
    /// The reflectances of the colours, blue fastest.
    reflectances: Vec<Reflectance>,
    /// Their values at the shortest and at the longest wavelength, over the blue and the red channel.
    edges: Vec<[f32; 2]>,
    /// By rising reciprocals; each made when it is needed: for each colour the rest at each Doppler factor.
    tables: Vec<(f64, OnceLock<Vec<[f32; 3]>>)>,
}

/// Four colours of the table and their weights.
type Corners = [(usize, f64); 4];

impl ColorTable {
    pub(super) fn new(daylight: Daylight) -> Self {
        let colors: Vec<_> = (0..SIDE * SIDE * SIDE).map(color_of).collect();
        let reflectances: Vec<_> = colors
            .par_iter()
            .map(|&color| daylight.reflectance(color))
            .collect();
        let edges = reflectances
            .iter()
            .zip(&colors)
            .map(|(reflectance, color)| {
                let [short, long] =
                    [0.0, 1.0].map(|wavelength| daylight.part(reflectance, wavelength));
                [(short - color.z) as f32, (long - color.x) as f32]
            });
        let mut mireds = MIREDS.to_vec();
        mireds.push(1e6 / daylight.kelvin());
        mireds.sort_by(f64::total_cmp);
        Self {
            edges: edges.collect(),
            tables: mireds
                .into_iter()
                .map(|mired| (mired, OnceLock::new()))
                .collect(),
            reflectances,
            daylight,
        }
    }

    /// The light of a surface whose colour has channels from 0 to 1, lit by a black body of `kelvin`, over the luminance of
    /// a white surface; `hue` is that of the black body as it is seen, at luminance 1.
    pub(super) fn light(
        &self,
        planckian: &Planckian,
        color: DVec3,
        kelvin: f64,
        doppler_factor: f64,
        hue: DVec3,
    ) -> DVec3 {
        let corners = corners(color);
        let place = doppler_factor.log2() * OCTAVE + BEFORE_ONE as f64;
        let edge = match place {
            _ if !(place > 0.0) => Some((0, color.z)),
            _ if place >= (FACTORS - 1) as f64 => Some((1, color.x)),
            _ => None,
        };
        if let Some((edge, channel)) = edge {
            let over = corners
                .iter()
                .map(|&(corner, weight)| weight * f64::from(self.edges[corner][edge]));
            return hue * (channel + over.sum::<f64>()).clamp(0.0, 1.0);
        }
        let factor = (place as usize, place.fract());
        let mired = (1e6 / kelvin).min(MIREDS[MIREDS.len() - 1]);
        let after = self.tables.partition_point(|(other, _)| *other < mired);
        let rest = |number: usize| self.rest(planckian, number, &corners, factor);
        let rest = match self.tables.get(after) {
            Some((exact, _)) if after == 0 || exact - mired <= 1e-9 * mired => rest(after),
            None => rest(self.tables.len() - 1),
            Some((high, _)) => {
                let low = self.tables[after - 1].0;
                rest(after - 1).lerp(rest(after), (mired - low) / (high - low))
            }
        };
        color * hue + rest
    }

    fn rest(
        &self,
        planckian: &Planckian,
        number: usize,
        corners: &Corners,
        (factor, part): (usize, f64),
    ) -> DVec3 {
        let (mired, table) = &self.tables[number];
        let table = table.get_or_init(|| self.made(planckian, *mired));
        let sum = corners.iter().map(|&(corner, weight)| {
            let at = corner * FACTORS + factor;
            let [low, high] = [at, at + 1].map(|at| DVec3::from(table[at].map(f64::from)));
            low.lerp(high, part) * weight
        });
        sum.sum()
    }

    /// The table of an illuminant.
    fn made(&self, planckian: &Planckian, mired: f64) -> Vec<[f32; 3]> {
        // What is hotter than every lamp is as if it were infinitely hot.
        let kelvin = (1e6 / mired).min(1e14);
        let shifted: Vec<_> = (0..FACTORS)
            .map(|factor| self.shifted(planckian, kelvin, factor))
            .collect();
        let colors = self.reflectances.par_iter().enumerate();
        let rows = colors.flat_map_iter(|(number, reflectance)| {
            let color = color_of(number);
            shifted.iter().map(move |(eye, hue, factor)| {
                // In unshifted daylight every colour is its own, also where its reflectance is not quite found.
                if *factor == 1.0 && mired == 1e6 / self.daylight.kelvin() {
                    return [0.0; 3];
                }
                let rows = eye.iter().enumerate();
                let light: DVec3 = rows
                    .map(|(row, &eye)| {
                        eye * self.daylight.part(reflectance, wavelength(row) * factor)
                    })
                    .sum();
                (light - color * *hue).as_vec3().to_array()
            })
        });
        rows.collect()
    }

    /// What the eye makes of each wavelength of the light of a white surface, of luminance 1; its hue; the factor.
    fn shifted(
        &self,
        planckian: &Planckian,
        kelvin: f64,
        factor: usize,
    ) -> ([DVec3; COUNT], DVec3, f64) {
        let factor = ((factor as f64 - BEFORE_ONE as f64) / OCTAVE).exp2();
        let glow = planckian.at(kelvin * factor);
        let mut eye = *self.daylight.eye();
        for (row, eye) in eye.iter_mut().enumerate() {
            *eye *= planck(wavelength(row), kelvin * factor) / glow.log_luminance.exp();
        }
        (eye, glow.hue, factor)
    }
}

/// The value of a channel of the table.
fn level(step: usize) -> f64 {
    let root = step as f64 / (SIDE - 1) as f64;
    root * root
}

fn color_of(number: usize) -> DVec3 {
    let [red, green, blue] = [number / SIDE / SIDE, number / SIDE % SIDE, number % SIDE].map(level);
    DVec3::new(red, green, blue)
}

/// The corners of the tetrahedron of the table that a colour is in: from the corner of its cube that is nearest to black
/// along the axis of the channel that is farthest from it, then along the next.
fn corners(color: DVec3) -> Corners {
    let mut low = 0;
    let axes = [(color.x, SIDE * SIDE), (color.y, SIDE), (color.z, 1)];
    let mut parts = axes.map(|(channel, stride)| {
        let step = ((channel.sqrt() * (SIDE - 1) as f64) as usize).min(SIDE - 2);
        // A square root that is rounded may be of the next step.
        let step = if channel < level(step) {
            step - 1
        } else {
            step
        };
        low += step * stride;
        let part = (channel - level(step)) / (level(step + 1) - level(step));
        (part.min(1.0), stride)
    });
    parts.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let [(a, first), (b, second), (c, third)] = parts;
    [
        (low, 1.0 - a),
        (low + first, a - b),
        (low + first + second, b - c),
        (low + first + second + third, c),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_means_of_the_corners_around_them() {
        for step in 0..20_000 {
            let part = |by: f64| (f64::from(step) * by).fract();
            let color = DVec3::new(part(0.618), part(0.414), part(0.732));
            for color in [color, color * color, DVec3::splat(color.x)] {
                let corners = corners(color);
                let mean: DVec3 = corners
                    .iter()
                    .map(|&(corner, weight)| color_of(corner) * weight)
                    .sum();
                assert!(mean.distance(color) < 1e-15, "{color} {mean}");
                assert!(
                    corners
                        .iter()
                        .all(|&(_, weight)| (0.0..=1.0).contains(&weight))
                );
            }
        }
        for corner in [DVec3::ZERO, DVec3::ONE, DVec3::X] {
            let sum: f64 = corners(corner).iter().map(|&(_, weight)| weight).sum();
            assert_eq!(sum, 1.0);
        }
    }
}
