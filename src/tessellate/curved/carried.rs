//! Bounds that are proven for one observer, carried over to another one who sees the same triangles from elsewhere.

use glam::DVec3;

use super::frame::largest_size;
use super::sight::Sight;

/// How bounds change between two sights that differ in the observer's place alone.
///
/// # Derivation
///
/// Let `x` be the place of a flat triangle with certain weights, `p` that of the triangle at rest, and `y` a place of the
/// photosurface within `b` of `x`, that of a place `q` at rest. For the other observer the two are apart by
///
/// ```text
/// x - y + gamma beta n (sum l_i g(p_i) - g(q)),        g = r' - r,
/// ```
///
/// with the distances `r` and `r'` from the two observers, where the sum minus `g(p)` is at most a sixth of the square of the
/// longest side times the second derivative of `g`, and `g(p) - g(q)` at most `|p - q|` times its first one, the change of
/// the line of sight. As the first observer sees it, `q` is within `b + gamma beta gap` of `p`, with the `gap` of the
/// triangle, at most a sixth of the square of its longest side divided by the distance. The map of offsets stretches `p - q`
/// at least by the inverse of `shrunk`: it keeps the part `w` across the motion, and along it gives
/// `gamma (1 + beta d.n) v + gamma beta d.w`, with the mean `d` of some lines of sight between `p` and `q`.
///
/// All places of one surface then have a partner on the other one, as before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried {
    /// The change of the line of sight, times `gamma beta` and what the map may have shrunk.
    slide: f64,
    /// What the square of a longest side adds to the way that slides, and to the bound.
    gap: f64,
    bend: f64,
}

impl Carried {
    /// From one sight to another, of anything whose places are within `radius` of the origin of its own frame; `None` if the
    /// sights differ in more than the observer's place, an observer is next to these places, or rounding hides how much is
    /// seen behind an observer.
    pub(crate) fn new(from: &Sight, to: &Sight, radius: f64) -> Option<Self> {
        const LEAST_ALONG_MOTION: f64 = 1e-6;
        if !from.differs_in_place_only(to) {
            return None;
        }
        let radius = from.scale * radius;
        let [before, after] = [from, to].map(|sight| sight.offset(DVec3::ZERO));
        let (r, r_after) = (before.length(), after.length());
        let nearest = [r, r_after].map(|r| r - radius);
        if !(nearest[0] > 0.0 && nearest[1] > 0.0) {
            return None;
        }
        // Lines of sight do not depend on a scale: that of the second sight is such that the middles are equally far.
        let times = r / r_after;
        let apart = (before - after * times).length() + (1.0 - times).abs() * radius;
        let turned = 2.0 * apart / (nearest[0] + times * nearest[1]);
        // The directions from the first observer.
        let (along, aside) = (before.dot(from.motion) / r, radius / r);
        let across = (1.0 - along * along).max(0.0).sqrt();
        let upright = (1.0 - aside * aside).max(0.0).sqrt();
        let least_along = if along > -upright {
            along * upright - across * aside
        } else {
            -1.0
        };
        let most_across = if along.abs() < aside {
            1.0
        } else {
            across * upright + along.abs() * aside
        };
        let gamma = 1.0 + from.gamma_less_one;
        let along_motion = gamma + from.gamma_beta * least_along;
        if !(along_motion > LEAST_ALONG_MOTION * gamma) {
            return None;
        }
        let slant = from.gamma_beta * most_across / along_motion;
        let shrunk = largest_size([
            1.0 + slant * slant,
            slant / along_motion,
            along_motion.recip().powi(2),
        ]);
        let recip = |r: f64, by: f64| [(r + by).recip(), (r - by).recip()];
        let [[low, high], [low_after, high_after]] = [recip(r, radius), recip(r_after, radius)];
        let changed = (high - low_after).max(high_after - low);
        Some(Self {
            slide: from.gamma_beta * turned * shrunk,
            gap: from.gamma_beta / nearest[0] / 6.0,
            bend: from.gamma_beta * (changed + turned * high) / 6.0,
        })
    }

    /// The bound of a triangle for the second sight, from that for the first one and the square of the longest side, an offset
    /// at rest.
    pub(crate) fn bound(&self, bound: f64, side_square: f64) -> f64 {
        /// Room for rounding.
        const UP: f64 = 1.0 + 1e-9;
        UP * (bound + self.slide * (bound + self.gap * side_square) + self.bend * side_square)
    }
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use glam::{DAffine3, DMat3};

    use super::*;
    use crate::spacetime::Velocity;
    use crate::tessellate::curved::sight::Allowed;

    /// Of any triangles and partners in a ball, not only of those of a surface; of sights next to each other no bound is much
    /// larger than before.
    #[test]
    fn no_partner_is_farther_away_than_the_bound_that_is_carried_over() {
        let (mut compared, mut smallest) = (0, f64::INFINITY);
        for number in 0..20_000u32 {
            let wave = |f: f64| (f64::from(number) * f + f).sin();
            let any = |f: f64| DVec3::new(wave(f), wave(f + 0.37), wave(f + 0.71));
            let beta = [0.0, 0.3, 0.9, 0.99][number as usize % 4];
            let velocity = Velocity::from_beta(beta, any(1.3)).unwrap();
            let matrix = DMat3::from_diagonal(DVec3::new(1.0, 0.7, 1.2));
            let far = [2.0, 6.0, 40.0][number as usize % 3];
            let middle = far * any(2.1).normalize();
            let beside = middle * (1.0 + 0.3 * wave(0.23))
                + [0.3, 0.02][number as usize % 2] * far * any(3.3);
            let [from, to] = [middle, beside].map(|at| {
                let to_offset = DAffine3::from_mat3_translation(matrix, at);
                Sight::new(&velocity, to_offset, Allowed::Length(1.0))
            });
            let Some(carried) = Carried::new(&from, &to, 1.0) else {
                continue;
            };
            let size = [0.3, 0.03][number as usize / 2 % 2];
            let at = 0.6 * any(4.7) / 3f64.sqrt();
            let corners: [DVec3; 3] = from_fn(|k| at + size * any(5.1 + k as f64) / 3f64.sqrt());
            let weights = any(7.9).abs() + 0.01;
            let weights = weights / weights.element_sum();
            let mixed = |of: [DVec3; 3]| (0..3).map(|k| of[k] * weights[k]).sum::<DVec3>();
            let partner = mixed(corners) + [0.1, 0.003][number as usize / 4 % 2] * any(6.3);
            let apart = |sight: &Sight| {
                mixed(corners.map(|corner| sight.seen(corner))).distance(sight.seen(partner))
            };
            let sides = from_fn::<f64, 3, _>(|k| {
                from.at_rest(corners[k] - corners[(k + 1) % 3])
                    .length_squared()
            });
            let longest = sides.into_iter().fold(0.0, f64::max);
            let bound = carried.bound(apart(&from), longest);
            assert!(
                apart(&to) <= bound + 1e-12 * far,
                "{number}: {} {bound}",
                apart(&to)
            );
            compared += 1;
            if number % 12 == 5 {
                smallest = smallest.min(apart(&from) / bound);
            }
        }
        assert!(compared > 15_000, "{compared}");
        assert!(smallest > 0.5, "{smallest}");
    }

    #[test]
    fn nothing_is_carried_over_at_rest_and_between_other_sights() {
        let sight = |beta: f64, at: DVec3, scale: f64| {
            let velocity = Velocity::from_beta(beta, DVec3::X).unwrap();
            let matrix = DMat3::from_diagonal(DVec3::splat(scale));
            let to_offset = DAffine3::from_mat3_translation(matrix, at);
            Sight::new(&velocity, to_offset, Allowed::Length(1.0))
        };
        let [ahead, above] = [DVec3::X * 8.0, DVec3::Y * 3.0];
        let at_rest = Carried::new(&sight(0.0, ahead, 1.0), &sight(0.0, above, 1.0), 1.0);
        let bound = at_rest.map(|carried| carried.bound(0.5, 1.0));
        assert!(bound.is_some_and(|bound| (bound - 0.5).abs() < 1e-8));
        let here = sight(0.5, ahead, 1.0);
        for other in [
            sight(0.6, ahead, 1.0),
            sight(0.5, ahead, 1.1),
            sight(0.5, DVec3::Y * 0.9, 1.0),
        ] {
            assert!(Carried::new(&here, &other, 1.0).is_none());
        }
    }
}
