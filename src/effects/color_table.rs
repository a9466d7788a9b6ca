//! Colours of surfaces under shifted light, as a table: what is exact for one colour, quickly for all.

use std::f64::consts::LN_2;
use std::sync::OnceLock;

use glam::{DVec3, Vec4};

use super::cie_1931::{COUNT, wavelength};
use super::planckian::Planckian;
use super::spectrum::{Daylight, Reflectance, place, planck};

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

/// The wavelengths of the eye's table, made even for several at a time.
const LANES: usize = 8;
const ROWS: usize = COUNT.next_multiple_of(LANES);

/// The light of surfaces, over that which a white surface sends back.
///
/// # Derivation
///
/// The light of a surface of colour `c`, over the luminance of a white one, is that of a grey one channel by channel, `c`
/// times the hue of the black body, and a rest, which is 0 for every grey, and for every colour in unshifted daylight. The
/// table holds the rest: between colours linear in each of the six tetrahedra of a cube around its grey diagonal, linear in
/// the logarithm of the Doppler factor and in the reciprocal of the temperature.
///
/// Tables are made by one thread, while others wait for it: threads that helped could come to wait for themselves.
pub(super) struct ColorTable {
    daylight: Daylight,
    /// The reflectances of the colours, blue fastest.
    reflectances: Vec<Reflectance>,
    /// Their values at the shortest and at the longest wavelength, over the blue and the red channel.
    edges: Vec<[f32; 2]>,
    /// By rising reciprocals; each made when it is needed: for each colour the rest at each Doppler factor.
    tables: Vec<(f64, OnceLock<Vec<Vec4>>)>,
    /// The number of that of unshifted daylight.
    of_daylight: usize,
}

/// What is the same for all colours at one illuminant and Doppler factor.
struct Shifted {
    /// The hue of a white surface, at luminance 1.
    hue: DVec3,
    /// What the eye makes of each wavelength of the light of a white surface, of luminance 1; by channels.
    eye: [[f32; ROWS]; 3],
    /// The wavelength at rest of each, as reflectances take it.
    places: [f32; ROWS],
}

/// Four colours of the table and their weights.
type Corners = [(usize, f64); 4];

impl ColorTable {
    pub(super) fn new(daylight: Daylight) -> Self {
        let colors = (0..SIDE * SIDE * SIDE).map(color_of);
        let reflectances: Vec<_> = colors
            .clone()
            .map(|color| daylight.reflectance(color))
            .collect();
        let edges = reflectances.iter().zip(colors).map(|(reflectance, color)| {
            let [short, long] = [0.0, 1.0].map(|wavelength| daylight.part(reflectance, wavelength));
            [(short - color.z) as f32, (long - color.x) as f32]
        });
        let own = 1e6 / daylight.kelvin();
        let of_daylight = MIREDS.partition_point(|&mired| mired < own);
        let mut mireds = MIREDS.to_vec();
        mireds.insert(of_daylight, own);
        let tables = mireds.into_iter().map(|mired| (mired, OnceLock::new()));
        Self {
            edges: edges.collect(),
            tables: tables.collect(),
            of_daylight,
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
        log_factor: f64,
        hue: DVec3,
    ) -> DVec3 {
        let corners = corners(color);
        let place = log_factor * (OCTAVE / LN_2) + BEFORE_ONE as f64;
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
        let factor = (place as usize, place.fract() as f32);
        let rest = |number: usize| self.rest(planckian, number, &corners, factor);
        let rest = if kelvin == self.daylight.kelvin() {
            rest(self.of_daylight)
        } else {
            let mired = (1e6 / kelvin).min(MIREDS[MIREDS.len() - 1]);
            let after = self.tables.partition_point(|(other, _)| *other < mired);
            let after = after.clamp(1, self.tables.len() - 1);
            let [low, high] = [after - 1, after].map(|number| self.tables[number].0);
            let part = if high > low {
                (mired - low) / (high - low)
            } else {
                1.0
            };
            rest(after - 1).lerp(rest(after), part)
        };
        color * hue + rest
    }

    fn rest(
        &self,
        planckian: &Planckian,
        number: usize,
        corners: &Corners,
        (factor, part): (usize, f32),
    ) -> DVec3 {
        let (mired, table) = &self.tables[number];
        let table = table.get_or_init(|| self.made(planckian, *mired, number == self.of_daylight));
        let mut sum = Vec4::ZERO;
        for &(corner, weight) in corners {
            let at = corner * FACTORS + factor;
            sum += table[at].lerp(table[at + 1], part) * weight as f32;
        }
        sum.truncate().as_dvec3()
    }

    /// The table of an illuminant.
    fn made(&self, planckian: &Planckian, mired: f64, is_daylight: bool) -> Vec<Vec4> {
        // What is hotter than every lamp is as if it were infinitely hot.
        let kelvin = (1e6 / mired).min(1e14);
        let factors = 0..FACTORS;
        let shifted: Vec<_> = factors
            .map(|factor| self.shifted(planckian, kelvin, factor))
            .collect();
        let mut table = Vec::with_capacity(self.reflectances.len() * FACTORS);
        for (number, reflectance) in self.reflectances.iter().enumerate() {
            let color = color_of(number);
            for (factor, shifted) in shifted.iter().enumerate() {
                // In unshifted daylight every colour is its own, also where its reflectance is not quite found.
                let rest = match is_daylight && factor == BEFORE_ONE {
                    true => DVec3::ZERO,
                    false => shifted.light(reflectance) - color * shifted.hue,
                };
                table.push(rest.as_vec3().extend(0.0));
            }
        }
        table
    }

    fn shifted(&self, planckian: &Planckian, kelvin: f64, factor: usize) -> Shifted {
        let factor = ((factor as f64 - BEFORE_ONE as f64) / OCTAVE).exp2();
        let glow = planckian.at((kelvin * factor).ln());
        let mut shifted = Shifted {
            hue: glow.hue,
            eye: [[0.0; ROWS]; 3],
            places: [0.0; ROWS],
        };
        let white = glow.log_luminance().exp();
        for (row, eye) in self.daylight.eye().iter().enumerate() {
            let at_rest = wavelength(row) * factor;
            let known = self.daylight.part(&Reflectance::Grey(1.0), at_rest);
            let seen = *eye * (known * planck(wavelength(row), kelvin * factor) / white);
            for (channel, seen) in seen.to_array().into_iter().enumerate() {
                shifted.eye[channel][row] = seen as f32;
            }
            shifted.places[row] = place(at_rest) as f32;
        }
        shifted
    }
}

impl Shifted {
    /// The light of a surface, over the luminance of a white one. In `f32`, several wavelengths at a time.
    fn light(&self, reflectance: &Reflectance) -> DVec3 {
        let mut parts = [0.0; ROWS];
        match *reflectance {
            Reflectance::Grey(part) => parts = [part as f32; ROWS],
            Reflectance::Sigmoid(coefficients) => {
                let [a, b, c] = coefficients.map(|coefficient| coefficient as f32);
                for (part, place) in parts.iter_mut().zip(self.places) {
                    let argument = (a * place + b) * place + c;
                    *part = 0.5 + 0.5 * argument / (1.0 + argument * argument).sqrt();
                }
            }
        }
        let channel = |eye: &[f32; ROWS]| {
            let mut sums = [0.0_f32; LANES];
            for (eye, parts) in eye.chunks_exact(LANES).zip(parts.chunks_exact(LANES)) {
                for lane in 0..LANES {
                    sums[lane] += eye[lane] * parts[lane];
                }
            }
            sums.iter().map(|&sum| f64::from(sum)).sum()
        };
        DVec3::from_array(self.eye.each_ref().map(channel))
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
    for (left, right) in [(0, 1), (1, 2), (0, 1)] {
        if parts[left].0 < parts[right].0 {
            parts.swap(left, right);
        }
    }
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
