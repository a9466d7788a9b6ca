//! Light of lamps that move past what they light: when it left, whence it comes, how strong and how shifted it is.
//!
//! # Derivation
//!
//! Light of a lamp arrives with the factor `D`, frequency in the frame of the surface over that in the lamp's own. A surface
//! sees a lamp at the distance `R` at rest with the lamp at `D R` in its own frame, since the vector between the two events
//! is a null one: so `D = R_s / R`. With the spectral radiance of a black body, which is that of `D T` where it was that of `T`, and the
//! solid angle, which goes as `1 / D^2`, the irradiance of a small black body of temperature `T` is in the frame of the
//! surface
//!
//! ```text
//! E ~ B(D T) / (D R)^2 = B(D T) / R_s^2
//! ```
//!
//! # Reference
//!
//! W. Rindler, *Relativity: Special, General, and Cosmological*, 2nd edition (2006), sections 4.3 to 4.5.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

use glam::DVec3;

use crate::spacetime::{Event, Lorentz, MovedLight, Velocity};

/// Doppler factors beyond these and their squares are not within `f64` by far; colder or hotter is nothing to see.
const FACTORS: (f64, f64) = (1e-140, 1e140);

/// Light of a black body of so few kelvin is dark to the eye.
const DARK: f64 = 10.0;

/// Gauss and Legendre's rule of 8 points: half of the points, and their weights.
const POINTS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The largest part of the logarithm of the Doppler factor that the rule is used for at once.
const PANEL: f64 = 2.0;

/// Light as it arrives, in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The unit direction in which it travels.
    pub travel: DVec3,
    /// Its frequency over that in the frame it comes from.
    pub factor: f64,
}

/// Light of a lamp that is at rest, as it reaches an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// The unit direction in which it travels, at rest with the lamp.
    pub travel: DVec3,
    /// The distance that it has travelled, at rest with the lamp.
    pub distance: f64,
    /// The time at which it left the lamp, at rest with the lamp.
    pub emitted: f64,
}

/// Light that travels in the unit direction `travel` here, in the frame behind `here_to_there`.
///
/// # Accuracy
///
/// Direction and factor to a few units in the last place, of the factor also relative to itself, at any rapidity up to
/// 700 (`tests/it/effects/lamps.rs`), for a direction whose own last place is exact.
pub fn arrival(here_to_there: &Lorentz, travel: DVec3) -> Arrival {
    let boost = here_to_there.boost_velocity();
    let (motion, grow) = (boost.direction(), boost.stretch());
    let light = MovedLight::new(travel, motion, grow, 1.0 / grow);
    Arrival {
        travel: here_to_there.rotation() * light.direction(motion).normalize(),
        factor: light.factor,
    }
}

/// The light of a lamp that rests at `place`, at an event given in the lamp's rest frame; none at the lamp itself.
pub fn from_point(place: DVec3, event: Event) -> Option<PointLight> {
    let way = event.position - place;
    let distance = way.length();
    let travel = way / distance;
    (distance > 0.0 && travel.is_finite()).then_some(PointLight {
        travel,
        distance,
        emitted: event.time - distance,
    })
}

/// The irradiance, on a surface that faces the light, of a lamp of intensity 1 at a distance at rest with the lamp: for a
/// lamp that is not shifted `1 / R^2`, and for one whose light is shifted what `B(D T)` is to be multiplied by for the factor
/// `factor`, `1 / (D R)^2`. Nothing where the light is too cold to be seen.
pub fn point_irradiance(distance: f64, kelvin: f64, factor: f64, shifted: bool) -> f64 {
    far_irradiance(kelvin, factor, shifted) / distance / distance
}

/// The same of a lamp infinitely far away, of irradiance 1 in its own frame: 1, and `1 / D^2`.
pub fn far_irradiance(kelvin: f64, factor: f64, shifted: bool) -> f64 {
    match shifted {
        false => 1.0,
        true if factor * kelvin < DARK => 0.0,
        true => held(factor).powi(-2),
    }
}

/// A Doppler factor as far as light of that factor can be told from none or from infinitely much.
pub fn held(factor: f64) -> f64 {
    factor.clamp(FACTORS.0, FACTORS.1)
}

/// The light of a sky that is the same in all directions in its own frame, on a surface that moves with `motion` there and
/// has the unit normal `normal` in its rest frame, whose axes are those of the sky under a pure boost. Calls `visit` with
/// parts of the irradiance, of which the sum is 1, and the Doppler factor of each.
///
/// # Derivation
///
/// Light that comes from the angle `theta'` to the motion has the factor `D = 1 / (s e^eta + (1 - s) e^-eta)`,
/// `s = sin^2(theta'/2)`. In `y = ln D`, from `-eta` to `eta`, the solid angle is `2 pi e^-y dy / sinh(eta)`. On a ring of
/// one `theta'` the cosine with the normal is `a + b cos phi`, of which the positive part has the mean
/// `(a phi_0 + b sin phi_0) / pi`, `cos phi_0 = -a / b`.
///
/// # Accuracy
///
/// To `2e-4` for any radiance that is a power of the factor up to `D^4` (`tests/it/effects/lamps.rs`): eight points for each
/// part of the sky that the horizon of the surface cuts, and for each factor of `e^2`. Exact at rest, and for a radiance
/// that is the same for all factors.
pub fn sky_irradiance(motion: Velocity, normal: DVec3, mut visit: impl FnMut(f64, f64)) {
    let rapidity = motion.rapidity();
    if rapidity == 0.0 {
        return visit(1.0, 1.0);
    }
    let normal_along = normal.dot(motion.direction()).clamp(-1.0, 1.0);
    let normal_across = ((1.0 - normal_along) * (1.0 + normal_along)).sqrt();
    let ring = |y: f64| {
        // s and 1 - s, of differences that do not cancel.
        let spread = 2.0 * motion.gamma_beta();
        let behind = (-rapidity).exp() * (rapidity - y).exp_m1() / spread;
        let ahead = (-y).exp() * (rapidity + y).exp_m1() / spread;
        let (a, b) = (
            (ahead - behind) * normal_along,
            2.0 * (ahead * behind).max(0.0).sqrt() * normal_across,
        );
        (-y).exp() / motion.gamma_beta() * positive_mean(a, b)
    };
    // Where rings begin and cease to be cut by the horizon of the surface the rule would be far less exact.
    let touching = |cosine: f64| {
        let half = 0.5 * (1.0 - cosine);
        -(half * motion.stretch() + (1.0 - half) / motion.stretch()).ln()
    };
    let edges = [
        -rapidity,
        touching(-normal_across),
        touching(normal_across),
        rapidity,
    ];
    let all = || (0..3).flat_map(|part| points(edges[part], edges[part + 1]));
    let whole: f64 = all().map(|(y, weight)| weight * ring(y)).sum();
    for (y, weight) in all() {
        let part = weight * ring(y) / whole;
        if part > 0.0 {
            visit(part, y.exp());
        }
    }
}

/// Points between two numbers, and their weights: closer together at both ends, where there may be a root.
fn points(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let panels = ((to - from).max(0.0) / PANEL).ceil();
    let half = 0.5 * (to - from) / panels;
    (0..panels as u32).flat_map(move |panel| {
        let middle = from + half * (2.0 * f64::from(panel) + 1.0);
        let both = POINTS.into_iter().flat_map(|(x, w)| [(-x, w), (x, w)]);
        both.map(move |(x, weight)| {
            let place = 0.5 * x * (3.0 - x * x);
            (middle + half * place, 1.5 * (1.0 - x * x) * half * weight)
        })
    })
}

/// The mean of the positive part of `a + b cos phi` over a turn, `b` not negative.
fn positive_mean(a: f64, b: f64) -> f64 {
    if a >= b {
        return a;
    }
    if a <= -b {
        return 0.0;
    }
    let sine = (a / b).clamp(-1.0, 1.0);
    let angle = FRAC_PI_2 + sine.asin();
    (a * angle + b * ((1.0 - sine) * (1.0 + sine)).sqrt()) * FRAC_1_PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_positive_part_of_a_wave_has_its_mean() {
        for (a, b) in [
            (0.3, 0.5),
            (-0.3, 0.5),
            (0.5, 0.2),
            (-0.5, 0.2),
            (0.0, 1.0),
            (0.0, 0.0),
        ] {
            let count = 100_000;
            let sum: f64 = (0..count)
                .map(|k| {
                    let phi = std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(count);
                    (a + b * phi.cos()).max(0.0)
                })
                .sum();
            let off = positive_mean(a, b) - sum / f64::from(count);
            assert!(off.abs() < 1e-8, "{a} {b}: {off}");
        }
    }
}
