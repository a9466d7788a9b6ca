//! Bounds of the second derivatives of the curved patch over a part of a triangle, as it is seen.

use std::array::from_fn;

use glam::{DVec2, DVec3};

use super::bent::Bent;
use super::frame::{Frame, form, largest_form, largest_size};
use super::quadratic;
use super::sight::Sight;

/// A corner of a part of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// The weights of the triangle's second and third corner.
    pub(super) at: DVec2,
    /// From the observer to the curved place, in the rest frame.
    pub(super) offset: DVec3,
    /// From the flat place to the curved one, as both are seen.
    pub(super) error: DVec3,
}

/// A part of a triangle, in its frame.
///
/// # Derivation
///
/// Let `X` be a place at rest, a function of the frame's coordinates, and `P` the place where it is seen. For a constant
/// vector `g`,
///
/// ```text
/// (g.P)_ij = m.X_ij + gamma beta (g.n) (X_i.X_j - (d.X_i)(d.X_j)) / r,        m = g + a (g.n),
/// ```
///
/// with the line of sight `d`, the distance `r` and the vector `a` of the Jacobian `I + n a^T` of the map; the last factor
/// is the second derivative of `r`. The middle of the frame gives its exact value; bounds of third derivatives, of the turn
/// of `d` and of the change of `r` tell how far it is from that in the rest of the unit disc, along steps of length 1. In
/// a smaller disc all these changes are smaller in proportion, or more than that.
pub(super) struct Patch {
    frame: Frame,
    /// No first derivative along a unit step is larger, and no place of the disc farther from its middle, at rest.
    reach: f64,
    toward: DVec3,
    first: [DVec3; 2],
    /// The largest first derivative along a unit step in the middle, and how much first derivatives change.
    size: f64,
    turned: f64,
    second: [DVec3; 3],
    /// How much the second derivatives change.
    change: f64,
    /// How much the line of sight changes.
    turn: f64,
    /// The second derivatives of the distance, and how much they change.
    distance: [f64; 3],
    distance_change: f64,
    /// Whether changes are smaller in proportion in a smaller disc.
    is_linear: bool,
}

/// The second derivatives of `g.P` in the middle of a frame, how much they change along unit steps; the same for the first
/// ones.
pub(super) struct Bend {
    second: [f64; 3],
    second_change: f64,
    first: [f64; 2],
    first_change: f64,
    /// How much `g.P` may differ between two places of the disc, at most.
    apart: f64,
}

impl Patch {
    /// The part of a triangle with these corners.
    pub(super) fn new(chart: &Bent, sight: &Sight, part: &[Corner; 3]) -> Self {
        let frame = Frame::new(part.map(|corner| corner.at));
        let look = chart.look(&frame);
        let first: [DVec3; 2] = from_fn(|k| sight.at_rest(look.jet.first[k]));
        let size = size_of_columns(first);
        let turned = sight.scale * look.turned;
        let change = sight.scale * look.third;
        // Steps are of length 1 at most.
        let reach = size + turned;
        let offset = sight.offset(look.jet.place);
        let r = offset.length();
        let (nearest, sine, toward) = ((r - reach).max(0.0), reach / r, offset / r);
        // The chord of the angle with this sine.
        let turn = if sine < 1.0 {
            sine * (1.0 + 0.42 * sine * sine)
        } else {
            2.0
        };
        let across: [DVec3; 2] = from_fn(|k| first[k] - toward * toward.dot(first[k]));
        let wide = size_of_columns(across);
        let (by_turn, at_most) = (turned + reach * turn, reach + wide);
        let wide_change = by_turn.min(at_most);
        const PAIRS: [(usize, usize); 3] = [(0, 0), (0, 1), (1, 1)];
        let distance = from_fn(|k| {
            let (i, j) = PAIRS[k];
            across[i].dot(across[j]) / r
        });
        let distance_change = (2.0 * wide + wide_change) * wide_change / nearest
            + wide * wide * (reach / (r * nearest));
        Self {
            frame,
            reach,
            toward,
            first,
            size,
            turned,
            second: from_fn(|k| sight.at_rest(look.jet.second[k])),
            change,
            turn,
            distance,
            distance_change,
            is_linear: look.is_linear && sine < 1.0 && by_turn <= at_most,
        }
    }

    /// The bend of `g.P`.
    pub(super) fn bend(&self, sight: &Sight, g: DVec3) -> Bend {
        let along = g.dot(sight.motion);
        let m = g + sight.jacobian_vector(self.toward) * along;
        let factor = sight.gamma_beta * along;
        let m_change = factor.abs() * self.turn;
        let m_size = m.length() + m_change;
        let second: [f64; 3] = from_fn(|k| m.dot(self.second[k]) + factor * self.distance[k]);
        let [uu, uv, vv] = self.second.map(DVec3::length_squared);
        let second_change = m_size * self.change
            + m_change * (uu + 2.0 * uv + vv).sqrt()
            + if factor == 0.0 {
                0.0
            } else {
                factor.abs() * self.distance_change
            };
        let by_second = largest_form(second) + second_change;
        let by_turn = m_size * self.turned + m_change * self.size;
        let steepest = g.length() + along.abs() * (sight.gamma_less_one + sight.gamma_beta);
        Bend {
            second,
            second_change,
            first: from_fn(|k| m.dot(self.first[k])),
            first_change: if by_second <= by_turn {
                by_second
            } else {
                by_turn
            },
            apart: 2.0 * steepest * self.reach,
        }
    }

    /// An upper bound on how far `g.P` is from its linear interpolation between the corners of a part.
    ///
    /// The difference is half a mean of second derivatives along the ways from a place to the corners, whose squares are 1 in
    /// the mean, minus the square of the place's distance from the middle.
    pub(super) fn bulge(&self, bend: &Bend) -> f64 {
        match self.is_vague(bend) {
            false => self.bent(bend),
            true => bend.apart,
        }
    }

    /// Whether second derivatives tell less about the part than its size does, as at the tip of a cone.
    pub(super) fn is_vague(&self, bend: &Bend) -> bool {
        self.bent(bend) > bend.apart
    }

    fn bent(&self, bend: &Bend) -> f64 {
        let bent = 0.5 * (largest_form(bend.second) + bend.second_change);
        if bent.is_nan() { f64::INFINITY } else { bent }
    }

    /// An upper bound on the largest `|g.error|` of a part with these corners: the largest one that the second derivatives
    /// in the middle give, and what their change adds.
    ///
    /// From a place at the distance `x` from the middle, a corner is seen along a way whose places at the part `t` are at most
    /// `(1 - t) x + t` from the middle. With a change in proportion to that, what it adds is the mean of
    /// `(1 - t) ((1 - t) x + t)` times `1 - x^2`, so `(x / 3 + 1 / 6) (1 - x^2)`, at most 0.2528.
    pub(super) fn largest(&self, bend: &Bend, g: DVec3, part: &[Corner; 3]) -> f64 {
        let at_corners: [f64; 3] = from_fn(|k| g.dot(part[k].error));
        let most = at_corners
            .iter()
            .fold(0.0, |most: f64, at| most.max(at.abs()));
        let plain = most + self.bulge(bend);
        let bulges: [f64; 3] = from_fn(|k| -form(bend.second, Frame::side(k)) / 8.0);
        let share = if self.is_linear { 0.2528 } else { 0.5 };
        let close = quadratic::largest(at_corners, bulges) + share * bend.second_change;
        if close <= plain { close } else { plain }
    }

    /// How fast functions `g.P` with these bends move away from linear functions with these derivatives by the weights, along
    /// this step of the weights, the sum of all: in the middle, and an upper bound for the part. A bound up to `enough` is not
    /// looked at more closely.
    pub(super) fn slope(&self, of: &[(&Bend, DVec2)], by: DVec2, enough: f64) -> [f64; 2] {
        let step = self.frame.step(by);
        let length = step.length();
        let in_middle =
            |bend: &Bend, own: DVec2| DVec2::from_array(bend.first).dot(step) - own.dot(by);
        let middle: f64 = of
            .iter()
            .map(|(bend, own)| in_middle(bend, *own).abs())
            .sum();
        let first_change: f64 = of.iter().map(|(bend, _)| bend.first_change).sum();
        let in_disc = middle + first_change * length;
        if in_disc <= enough {
            return [middle, in_disc];
        }
        let at_corner = |corner: DVec2| -> f64 {
            let each = of.iter().map(|(bend, own)| {
                let [uu, uv, vv] = bend.second;
                let turned =
                    DVec2::new(uu * corner.x + uv * corner.y, uv * corner.x + vv * corner.y);
                (in_middle(bend, *own) + turned.dot(step)).abs()
            });
            each.sum()
        };
        let at_corners = Frame::CORNERS
            .map(at_corner)
            .into_iter()
            .fold(0.0, f64::max);
        let second_change: f64 = of.iter().map(|(bend, _)| bend.second_change).sum();
        let share = if self.is_linear { 0.5 } else { 1.0 };
        let close = at_corners + share * second_change * length;
        [middle, if close <= in_disc { close } else { in_disc }]
    }

    /// How much `g.P` bends along the side opposite a corner.
    pub(super) fn along(&self, bend: &Bend, k: usize) -> f64 {
        let side = Frame::side(k);
        let length = (self.first[0] * side.x + self.first[1] * side.y).length_squared();
        form(bend.second, side).abs() + bend.second_change * length / (self.size * self.size)
    }

    /// How many times any length of the shape's own frame may be stretched in the part.
    pub(super) fn steepest(&self, sight: &Sight) -> f64 {
        let jacobian = sight.jacobian_vector(self.toward).length() + sight.gamma_beta * self.turn;
        sight.scale * (1.0 + jacobian)
    }
}

/// The largest size of a unit step that two columns map.
fn size_of_columns([a, b]: [DVec3; 2]) -> f64 {
    largest_size([a.length_squared(), a.dot(b), b.length_squared()])
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::shape::{Piece, Spot};
    use crate::spacetime::Velocity;
    use crate::tessellate::curved::chart::Facet;
    use crate::tessellate::curved::sight::{About, Allowed};

    /// Triangles of all charts, each with a sight.
    fn cases() -> impl Iterator<Item = (Bent, [DVec3; 3], Sight)> {
        let pieces = [
            Piece::Ball { radius: 1.0 },
            Piece::Globe { radius: 1.0 },
            Piece::Tube {
                major: 1.0,
                minor: 0.4,
            },
            Piece::Side {
                radius: 1.0,
                height: 2.0,
            },
            Piece::Slope {
                radius: 1.0,
                height: 2.0,
            },
        ];
        (0..1_500).filter_map(move |number| {
            let wave = |f: f64| (f64::from(number) * f).sin();
            let piece = pieces[number as usize % 5];
            let beta = [0.0, 0.5, 0.9, 0.999][number as usize / 5 % 4];
            let velocity = Velocity::from_beta(beta, DVec3::new(1.0, wave(0.3), wave(0.5)));
            let scale = [DVec3::ONE, DVec3::new(1.0, 0.6, 1.7)][number as usize / 20 % 2];
            let observer = 2.5 * DVec3::new(wave(0.7), wave(1.1), wave(1.9));
            let to_offset = DAffine3::from_scale_rotation_translation(
                scale,
                DQuat::from_rotation_y(wave(2.3)),
                -observer,
            );
            let sight = Sight::new(&velocity.unwrap(), to_offset, Allowed::Length(1e-3));
            let size = [0.4, 0.1, 0.02][number as usize / 40 % 3];
            let spots: [Spot; 3] = from_fn(|k| {
                let turn = 2.1 * k as f64 + wave(0.9);
                let (a, b) = (turn.cos() * size, turn.sin() * size);
                Spot::inside(match piece {
                    Piece::Ball { .. } => {
                        let middle = DVec3::new(wave(3.1), wave(3.7), wave(4.3)).normalize();
                        let (u, v) = middle.any_orthonormal_pair();
                        (middle + u * a + v * b).normalize()
                    }
                    Piece::Side { .. } => DVec3::new(0.1 * a + wave(3.1), b, 0.0),
                    _ => DVec3::new(0.1 * a + wave(3.1), 0.5 + 0.3 * wave(3.7) + 0.2 * b, 0.0),
                })
            });
            let about = [About::Surface, About::Points][number as usize % 7 / 4];
            let facet = Facet::new(&piece, [&spots[0], &spots[1], &spots[2]], about);
            let seen = [0, 1, 2].map(|k| sight.seen(piece.place_of(&spots[k])));
            let bent = match about {
                About::Surface => Bent::new(facet, &sight, seen, [None; 3]),
                About::Points => Bent::straight(facet),
            };
            let is_triangle = seen.iter().all(|place| place.is_finite());
            is_triangle.then_some((bent, seen, sight))
        })
    }

    /// Of the whole and of small parts, also beyond the triangle.
    #[test]
    fn no_place_of_a_part_is_beyond_its_bounds_and_small_parts_have_close_ones() {
        let (mut close, mut all) = (0, 0);
        for (number, (chart, seen, sight)) in cases().enumerate() {
            let wave = |f: f64| (number as f64 * f + f).sin();
            let flat = |at: DVec2| seen[0] * (1.0 - at.x - at.y) + seen[1] * at.x + seen[2] * at.y;
            let place = |at: DVec2| sight.seen(chart.place(at));
            let small = [1.0, 0.3, 0.05][number % 3];
            let corners = [(-0.1, -0.1), (1.2, -0.1), (-0.1, 1.2)].map(|(x, y)| {
                small * DVec2::new(x, y) + (1.0 - small) * DVec2::new(0.3 + 0.2 * wave(0.6), 0.3)
            });
            let part = corners.map(|at| Corner {
                at,
                offset: sight.offset(chart.place(at)),
                error: place(at) - flat(at),
            });
            let patch = Patch::new(&chart, &sight, &part);
            let g = DVec3::new(wave(0.8), wave(1.7), wave(2.6)).normalize();
            let bend = patch.bend(&sight, g);
            let largest = patch.largest(&bend, g, &part);
            let by = DVec2::new(wave(0.2), wave(0.4));
            let own = DVec2::new(wave(0.11), wave(0.13));
            let [_, slope] = patch.slope(&[(&bend, own)], by, 0.0);
            let (mut error, mut bulge, mut steepest) = (0.0f64, 0.0f64, 0.0f64);
            for i in 0..=12 {
                for j in 0..=12 - i {
                    let [x, y] = [i, j].map(|k| f64::from(k) / 12.0);
                    let l = [1.0 - x - y, x, y];
                    let at: DVec2 = (0..3).map(|k| corners[k] * l[k]).sum();
                    let here = g.dot(place(at) - flat(at));
                    let line: f64 = (0..3).map(|k| l[k] * g.dot(part[k].error)).sum();
                    error = error.max(here.abs());
                    bulge = bulge.max((here - line).abs());
                    let step = 1e-4 * small * by;
                    let moved = g.dot(place(at + step) - place(at - step)) / 2e-4 / small;
                    steepest = steepest.max((moved - own.dot(by)).abs());
                }
            }
            let size = seen[0].distance(seen[1]) + seen[1].distance(seen[2]);
            let rounding = 1e-13 * (size + seen[0].length());
            let case = format!("{number} {chart:?}");
            assert!(error <= largest + rounding, "{error} {largest} {case}");
            assert!(bulge <= patch.bulge(&bend) + rounding, "{bulge} {case}");
            let rounding = rounding / 1e-5;
            assert!(
                steepest <= slope * (1.0 + 1e-6) + rounding,
                "{steepest} {slope} {case}"
            );
            if small < 0.1 && bulge > 1e-9 {
                all += 1;
                close += usize::from(largest < 1.1 * error + rounding);
            }
        }
        assert!(
            all > 100 && close as f64 > 0.9 * f64::from(all),
            "{close} of {all}"
        );
    }
}
