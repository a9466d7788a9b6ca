//! Bounds of the second derivatives of the curved patch over a part of a triangle, as it is seen.

use std::array::from_fn;

use glam::{DVec2, DVec3};

use super::bent::Bent;
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

/// A box of weights that holds a part of a triangle.
///
/// # Derivation
///
/// Let `X` be a place at rest, a function of the weights, and `P` the place where it is seen. For a constant vector `g`,
///
/// ```text
/// (g.P)_ij = m.X_ij + gamma beta (g.n) (X_i.X_j - (d.X_i)(d.X_j)) / r,        m = g + a (g.n),
/// ```
///
/// with the line of sight `d`, the distance `r` and the vector `a` of the Jacobian `I + n a^T` of the map; the last factor
/// is the second derivative of `r`. The middle of the box gives its exact value; bounds of third derivatives, of the turn
/// of `d` and of the change of `r` tell how far it is from that in the rest of the box.
pub(super) struct Patch {
    half: DVec2,
    /// No two places of the box are farther apart than twice this, at rest.
    reach: f64,
    toward: DVec3,
    first: [DVec3; 2],
    /// How much the first derivatives change.
    turned: [f64; 2],
    second: [DVec3; 3],
    /// How much the second derivatives change.
    change: [f64; 3],
    /// How much the line of sight changes.
    turn: f64,
    /// The second derivatives of the distance, and how much they change.
    distance: [f64; 3],
    distance_change: [f64; 3],
}

/// The second derivatives of `g.P` in the middle of a box, how much they change in it; the same for the first ones.
pub(super) struct Bend {
    second: [f64; 3],
    second_change: [f64; 3],
    pub(super) first: [f64; 2],
    pub(super) first_change: [f64; 2],
    /// How much `g.P` may differ between two places of the box, at most.
    apart: f64,
}

impl Patch {
    /// The smallest box around a part of a triangle.
    pub(super) fn new(chart: &Bent, sight: &Sight, part: &[Corner; 3]) -> Self {
        let [a, b, c] = part.map(|corner| corner.at);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let half = 0.5 * (high - low);
        let (jet, second, third, turns) = chart.look(0.5 * (low + high), half);
        let first: [DVec3; 2] = from_fn(|k| sight.at_rest(jet.first[k]));
        let turned: [f64; 2] = from_fn(|k| {
            let by_second = second[k] * half.x + second[k + 1] * half.y;
            sight.scale * by_second.min(turns[k])
        });
        let change = from_fn(|k| sight.scale * (third[k] * half.x + third[k + 1] * half.y));
        let sizes: [f64; 2] = from_fn(|k| first[k].length() + turned[k]);
        let reach = sizes[0] * half.x + sizes[1] * half.y;
        let offset = sight.offset(jet.place);
        let r = offset.length();
        let (nearest, sine, toward) = ((r - reach).max(0.0), reach / r, offset / r);
        // The chord of the angle with this sine.
        let turn = if sine < 1.0 {
            sine * (1.0 + 0.42 * sine * sine)
        } else {
            2.0
        };
        let across: [DVec3; 2] = from_fn(|k| first[k] - toward * toward.dot(first[k]));
        let wide: [f64; 2] = from_fn(|k| across[k].length());
        let wide_change: [f64; 2] =
            from_fn(|k| (turned[k] + sizes[k] * turn).min(sizes[k] + wide[k]));
        const PAIRS: [(usize, usize); 3] = [(0, 0), (0, 1), (1, 1)];
        let distance = from_fn(|k| {
            let (i, j) = PAIRS[k];
            across[i].dot(across[j]) / r
        });
        let distance_change = from_fn(|k| {
            let (i, j) = PAIRS[k];
            let product = wide[i] * wide_change[j]
                + wide[j] * wide_change[i]
                + wide_change[i] * wide_change[j];
            product / nearest + wide[i] * wide[j] * (1.0 / nearest - 1.0 / r)
        });
        Self {
            half,
            reach,
            toward,
            first,
            turned,
            second: from_fn(|k| sight.at_rest(jet.second[k])),
            change,
            turn,
            distance,
            distance_change,
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
        let second_change: [f64; 3] = from_fn(|k| {
            m_size * self.change[k]
                + m_change * self.second[k].length()
                + if factor == 0.0 {
                    0.0
                } else {
                    factor.abs() * self.distance_change[k]
                }
        });
        let first_change = from_fn(|k| {
            let of = |k: usize| second[k].abs() + second_change[k];
            let by_second = of(k) * self.half.x + of(k + 1) * self.half.y;
            let by_turn = m_size * self.turned[k] + m_change * self.first[k].length();
            if by_second <= by_turn {
                by_second
            } else {
                by_turn
            }
        });
        let steepest = g.length() + along.abs() * (sight.gamma_less_one + sight.gamma_beta);
        Bend {
            second,
            second_change,
            first: from_fn(|k| m.dot(self.first[k])),
            first_change,
            apart: 2.0 * steepest * self.reach,
        }
    }

    /// An upper bound on how far `g.P` is from its linear interpolation between the corners of a part in the box.
    ///
    /// The difference is half a mean of second derivatives along the ways from a place to the corners. The mean square of
    /// a coordinate's difference from its mean is at most a quarter of the square of its range.
    pub(super) fn bulge(&self, bend: &Bend) -> f64 {
        match self.is_vague(bend) {
            false => self.bent(bend),
            true => bend.apart,
        }
    }

    /// Whether second derivatives tell less about the box than its size does, as at the tip of a cone.
    pub(super) fn is_vague(&self, bend: &Bend) -> bool {
        self.bent(bend) > bend.apart
    }

    fn bent(&self, bend: &Bend) -> f64 {
        self.over_box(from_fn(|k| bend.second[k].abs() + bend.second_change[k]))
    }

    /// An upper bound on the largest `|g.error|` of a part with these corners: the largest one that the second derivatives
    /// in the middle give, and what their change adds.
    pub(super) fn largest(&self, bend: &Bend, g: DVec3, part: &[Corner; 3]) -> f64 {
        let at_corners: [f64; 3] = from_fn(|k| g.dot(part[k].error));
        let most = at_corners
            .iter()
            .fold(0.0, |most: f64, at| most.max(at.abs()));
        let plain = most + self.bulge(bend);
        let [xx, xy, yy] = bend.second;
        let bulges: [f64; 3] = from_fn(|k| {
            let side = part[(k + 2) % 3].at - part[(k + 1) % 3].at;
            -(xx * side.x * side.x + 2.0 * xy * side.x * side.y + yy * side.y * side.y) / 8.0
        });
        let change = self.over_box(bend.second_change);
        let close = quadratic::largest(at_corners, bulges) + change;
        if close <= plain { close } else { plain }
    }

    /// How much these second derivatives make of the steps of the whole box, divided by 8.
    fn over_box(&self, second: [f64; 3]) -> f64 {
        let (x, y) = (self.half.x, self.half.y);
        let whole = 0.5 * (second[0] * x * x + 2.0 * second[1] * x * y + second[2] * y * y);
        if whole.is_nan() { f64::INFINITY } else { whole }
    }

    /// How much `g.P` bends along a side.
    pub(super) fn along(&self, bend: &Bend, side: DVec2) -> f64 {
        let (of, side) = (
            |k: usize| bend.second[k].abs() + bend.second_change[k],
            side.abs(),
        );
        of(0) * side.x * side.x + 2.0 * of(1) * side.x * side.y + of(2) * side.y * side.y
    }

    /// How many times any length of the shape's own frame may be stretched in the box.
    pub(super) fn steepest(&self, sight: &Sight) -> f64 {
        let jacobian = sight.jacobian_vector(self.toward).length() + sight.gamma_beta * self.turn;
        sight.scale * (1.0 + jacobian)
    }
}
