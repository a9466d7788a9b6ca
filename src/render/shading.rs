//! How much of the light that falls on a surface it sends to the eye.
//!
//! # Derivation
//!
//! The metallic-roughness model is linear in the base colour `c`: a dielectric has a white gloss over a matte ground, of a
//! metal the gloss is tinted. With the gloss `S`, the share `m` of metal, and `k = (1 - v.h)^5`,
//!
//! ```text
//! brdf = c ((1 - m)(1 - F) / pi + m (1 - k) S) + (1 - m) F S + m k S            F = 0.04 + 0.96 k
//! S = D V        D = a^2 / (pi ((n.h)^2 (a^2 - 1) + 1)^2)      V = 1 / (s(n.l) s(n.v))      a = roughness^2
//!                                                              s(x) = x + sqrt(a^2 + (1 - a^2) x^2)
//! ```
//!
//! where `n` is the normal, `l` the direction to the lamp, `v` that to the eye, `h` half way between these. All numbers
//! here are of the frame in which the surface is at rest. Normal maps and extensions of the model play no part.
//!
//! # Reference
//!
//! Khronos Group, *glTF 2.0 Specification*, appendix B.

use std::ops::{Add, AddAssign, Mul};

use glam::DVec3;
use serde::Serialize;

use super::albedo::{TABLE, albedo};

/// How brightly a white matte surface that faces the lamp at the eye is lit by that lamp alone.
const HEAD_LIGHT: f64 = 0.65;

/// Radiance of the surroundings at the horizon, and how much more it is above and less below. Together with the lamp, a
/// white matte surface that faces the eye comes to 0.83, and on top to 0.94: nothing matte burns out, and form is seen
/// where the lamp alone would show none.
const HORIZON: f64 = 0.19;
const ABOVE: f64 = 0.165;

/// What the light of pictures is made of, for programs that shade in the same way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct HeadLight {
    /// The parts of an even light from all around that a gloss sends to the eye, tinted and white: see [`super::albedo`].
    albedo: [[[f64; 2]; 11]; 10],
    head_light: f64,
    horizon: f64,
    above: f64,
}

impl HeadLight {
    /// The numbers of this file.
    pub(crate) const TABLES: Self = Self {
        albedo: TABLE,
        head_light: HEAD_LIGHT,
        horizon: HORIZON,
        above: ABOVE,
    };
}

/// The smallest roughness: a lamp that is a point would be seen in a mirror as nothing, or as infinitely bright.
const LEAST_ROUGHNESS: f64 = 0.1;

/// How much of the light a surface that is no metal reflects head-on.
const DIELECTRIC: f64 = 0.04;

/// What decides how light is scattered, beside the colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Finish {
    /// From 0 to 1.
    pub(super) metal: f64,
    /// From 0, a mirror, to 1.
    pub(super) roughness: f64,
}

impl Finish {
    /// Without metal, as rough as can be.
    pub(super) const MATTE: Self = Self {
        metal: 0.0,
        roughness: 1.0,
    };
}

/// Unit vectors at a place of a surface, in the frame in which it is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facing {
    /// On the side of the eye.
    pub(super) normal: DVec3,
    pub(super) to_eye: DVec3,
}

/// Light that a surface sends to the eye: a part in the base colour, and a part in the colour of the light itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reflected {
    pub(super) tinted: f64,
    pub(super) white: f64,
}

impl Add for Reflected {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            tinted: self.tinted + other.tinted,
            white: self.white + other.white,
        }
    }
}

impl AddAssign for Reflected {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Reflected {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            tinted: self.tinted * factor,
            white: self.white * factor,
        }
    }
}

/// Light of the lamp at the eye and of the surroundings; `open` is the part of these, from 0 to 1, that gets there.
pub(super) fn head_light(finish: Finish, facing: Facing, open: f64) -> Reflected {
    let cosine = facing.eye_cosine();
    let lamp = from_lamp(finish, facing, facing.to_eye);
    // Of a sky whose radiance is linear in height a matte surface gathers two thirds of the slope.
    let sky = |height: f64, part: f64| HORIZON + ABOVE * part * height;
    let ground = sky(facing.normal.y, 2.0 / 3.0);
    let mirror = 2.0 * cosine * facing.normal.y - facing.to_eye.y;
    let gloss = sky(mirror, 1.0 - finish.roughness / 3.0);
    lamp * HEAD_LIGHT + from_all_around(finish, cosine, ground, gloss) * open
}

/// Light of a lamp in the unit direction `to_lamp`: for an irradiance, on a surface that faces the lamp, of pi, in which
/// a matte white surface has the radiance 1. None from behind.
pub(super) fn from_lamp(finish: Finish, facing: Facing, to_lamp: DVec3) -> Reflected {
    let lamp = facing.normal.dot(to_lamp);
    if !(lamp > 0.0) {
        return Reflected::default();
    }
    let Facing { normal, to_eye } = facing;
    // Half the sum of two unit vectors is as long as the cosine of half the angle between them.
    let half = 0.5 * (to_lamp + to_eye);
    let eye_half = half.length();
    let half_cosine = match eye_half > 0.0 {
        true => (normal.dot(half) / eye_half).clamp(0.0, 1.0),
        false => 0.0,
    };
    reflected(
        finish,
        Cosines {
            lamp: lamp.min(1.0),
            eye: facing.eye_cosine(),
            half: half_cosine,
            eye_half: eye_half.min(1.0),
        },
    )
}

/// Light from all around: `ground` is the mean radiance, by the cosine, over the hemisphere above the surface, and `gloss`
/// that of what the surface mirrors.
pub(super) fn from_all_around(
    finish: Finish,
    eye_cosine: f64,
    ground: f64,
    gloss: f64,
) -> Reflected {
    let [tinted, white] = albedo(finish.roughness, eye_cosine);
    let Finish { metal, .. } = finish;
    // As from lamps, but for the direction of the half-way vector.
    let dielectric = DIELECTRIC * tinted + white;
    Reflected {
        tinted: (1.0 - metal) * (1.0 - dielectric) * ground + metal * tinted * gloss,
        white: ((1.0 - metal) * dielectric + metal * white) * gloss,
    }
}

/// The cosines between normal, lamp, eye and the direction half way between these two, all from 0 to 1.
struct Cosines {
    lamp: f64,
    eye: f64,
    /// Between the normal and the half-way direction.
    half: f64,
    /// Between the eye and the half-way direction.
    eye_half: f64,
}

/// The model of the head of this file, times pi and the cosine of the lamp.
fn reflected(finish: Finish, cosines: Cosines) -> Reflected {
    let alpha = finish.roughness.max(LEAST_ROUGHNESS).powi(2);
    let square = alpha * alpha;
    let slant = |cosine: f64| cosine + (square + (1.0 - square) * cosine * cosine).sqrt();
    let spread = cosines.half * cosines.half * (square - 1.0) + 1.0;
    let visible = slant(cosines.lamp) * slant(cosines.eye);
    let gloss = square * cosines.lamp / (spread * spread * visible);
    let glancing = (1.0 - cosines.eye_half).powi(5);
    let fresnel = DIELECTRIC + (1.0 - DIELECTRIC) * glancing;
    let Finish { metal, .. } = finish;
    Reflected {
        tinted: (1.0 - metal) * (1.0 - fresnel) * cosines.lamp + metal * (1.0 - glancing) * gloss,
        white: ((1.0 - metal) * fresnel + metal * glancing) * gloss,
    }
}

impl Facing {
    /// Of the angle between normal and eye, from 0 to 1.
    pub(super) fn eye_cosine(&self) -> f64 {
        self.normal.dot(self.to_eye).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINISHES: [Finish; 6] = [
        Finish::MATTE,
        finish(0.0, 0.9),
        finish(0.0, 0.3),
        finish(0.5, 0.5),
        finish(1.0, 0.15),
        finish(1.0, 1.0),
    ];

    /// Where a mirror sends light from the eye, about +y.
    const AZIMUTH: f64 = 0.4;

    const fn finish(metal: f64, roughness: f64) -> Finish {
        Finish { metal, roughness }
    }

    /// A direction at an angle to +y, turned about it.
    fn direction(angle: f64, turn: f64) -> DVec3 {
        DVec3::new(
            angle.sin() * turn.cos(),
            angle.cos(),
            angle.sin() * turn.sin(),
        )
    }

    fn facing(eye_angle: f64) -> Facing {
        Facing {
            normal: DVec3::Y,
            to_eye: direction(eye_angle, AZIMUTH + std::f64::consts::PI),
        }
    }

    /// The model as appendix B of glTF writes it, with its functions and for a colour.
    fn as_in_gltf(finish: Finish, color: f64, facing: Facing, lamp: DVec3) -> f64 {
        let Facing { normal, to_eye } = facing;
        let half = (lamp + to_eye).normalize();
        let alpha = finish.roughness * finish.roughness;
        let mix = |a: f64, b: f64, part: f64| a * (1.0 - part) + b * part;
        let distribution = {
            let square = alpha * alpha;
            let f = normal.dot(half).powi(2) * (square - 1.0) + 1.0;
            square / (std::f64::consts::PI * f * f)
        };
        let masking = |v: DVec3| {
            let cosine = normal.dot(v);
            2.0 * cosine
                / (cosine + (alpha * alpha + (1.0 - alpha * alpha) * cosine * cosine).sqrt())
        };
        let specular = distribution * masking(lamp) * masking(to_eye)
            / (4.0 * normal.dot(lamp) * normal.dot(to_eye));
        let schlick = (1.0 - to_eye.dot(half)).powi(5);
        let diffuse = color / std::f64::consts::PI;
        let dielectric = mix(diffuse, specular, 0.04 + 0.96 * schlick);
        let metal = specular * (color + (1.0 - color) * schlick);
        mix(dielectric, metal, finish.metal)
    }

    #[test]
    fn the_model_is_that_of_gltf() {
        for finish in FINISHES {
            for (eye_angle, lamp_angle, turn, color) in [
                (0.1, 0.2, 0.0, 0.8),
                (1.2, 0.3, 2.0, 0.5),
                (0.7, 1.4, 3.5, 0.0),
                (1.5, 1.5, 0.4, 1.0),
            ] {
                let (facing, lamp) = (facing(eye_angle), direction(lamp_angle, turn));
                let expected =
                    as_in_gltf(finish, color, facing, lamp) * lamp.y * std::f64::consts::PI;
                let found = from_lamp(finish, facing, lamp);
                let found = found.tinted * color + found.white;
                assert!(
                    (found - expected).abs() < 1e-12 * expected.max(1.0),
                    "{finish:?} {eye_angle} {lamp_angle}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn no_light_comes_from_behind_and_no_number_is_none() {
        for finish in FINISHES.into_iter().chain([finish(1.0, 0.0)]) {
            for angle in [0.0, 1e-9, 1.0, 1.57] {
                let facing = facing(angle);
                for lamp in [facing.to_eye, -facing.to_eye, DVec3::Y, -DVec3::Y, DVec3::X] {
                    let lit = from_lamp(finish, facing, lamp);
                    assert!(lit.tinted >= 0.0 && lit.white >= 0.0 && lit.white.is_finite());
                    assert!(lamp.y > 0.0 || lit == Reflected::default());
                }
                let lit = head_light(finish, facing, 1.0);
                assert!(lit.tinted >= 0.0 && lit.white >= 0.0 && lit.tinted.is_finite());
            }
        }
    }

    /// What a surface of white colour reflects of light of radiance 1 from every direction: the sum over lamps.
    fn under_an_even_sky(finish: Finish, eye_angle: f64) -> Reflected {
        use std::f64::consts::{FRAC_PI_2, PI};
        let mut sum = Reflected::default();
        let (rings, turns) = (600, 300);
        for ring in 0..rings {
            let angle = FRAC_PI_2 * (f64::from(ring) + 0.5) / f64::from(rings);
            let width = angle.sin() * FRAC_PI_2 / f64::from(rings);
            for turn in 0..turns {
                // Closer together beside the plane of the eye, where the light of a smooth surface is.
                let aside = (2.0 * f64::from(turn) + 1.0) / f64::from(turns) - 1.0;
                let area = width * 3.0 * PI * aside * aside * 2.0 / f64::from(turns);
                let lamp = direction(angle, AZIMUTH + PI * aside.powi(3));
                sum += from_lamp(finish, facing(eye_angle), lamp) * (area / PI);
            }
        }
        sum
    }

    /// The gloss of metals, of which nothing else is seen, at roughnesses and angles between those of the table.
    #[test]
    fn light_from_all_around_is_the_sum_over_lamps() {
        for roughness in [0.2, 0.35, 0.6, 0.85, 1.0] {
            for eye_angle in [0.0, 0.3, 0.75, 1.05, 1.3, 1.45, 1.53] {
                let metal = finish(1.0, roughness);
                let sum = under_an_even_sky(metal, eye_angle);
                let found = from_all_around(metal, eye_angle.cos(), 1.0, 1.0);
                for off in [found.tinted - sum.tinted, found.white - sum.white] {
                    assert!(
                        off.abs() < 0.025,
                        "{roughness} {eye_angle}: {found:?} {sum:?}"
                    );
                }
            }
        }
    }

    /// No finish sends back more than it gets, a matte one nearly all. Not so at grazing incidence, where the model of glTF
    /// takes too little of the ground's light for the gloss.
    #[test]
    fn nothing_reflects_more_than_falls_on_it() {
        for finish in FINISHES {
            for eye_angle in [0.0, 0.5, 1.0] {
                let sum = under_an_even_sky(finish, eye_angle);
                let all = sum.tinted + sum.white;
                assert!(all < 1.03, "{finish:?} {eye_angle}: {all}");
                assert!(
                    finish.metal > 0.0 || all > 0.85,
                    "{finish:?} {eye_angle}: {all}"
                );
            }
        }
    }

    #[test]
    fn light_from_above_shows_form() {
        let seen = |normal: DVec3| {
            let facing = Facing {
                normal,
                to_eye: DVec3::Z,
            };
            let lit = head_light(Finish::MATTE, facing, 1.0);
            lit.tinted + lit.white
        };
        let slanted = |y: f64| seen(DVec3::new(0.0, y, 1.0).normalize());
        assert!(slanted(1.0) > slanted(-1.0) + 0.1);
        let ahead = seen(DVec3::Z);
        assert!((ahead - 0.83).abs() < 0.01, "{ahead}");
        let from_above = Facing {
            normal: DVec3::Y,
            to_eye: DVec3::Y,
        };
        let on_top = head_light(Finish::MATTE, from_above, 1.0);
        let on_top = on_top.tinted + on_top.white;
        assert!((on_top - 0.94).abs() < 0.01, "{on_top}");
    }
}
