//! A bound of a triangle's gap along one direction, for a tenth of what the exact gap costs.

use glam::DVec3;

const EPSILON: f64 = f64::EPSILON;

/// Distances in which the squares and products below neither overflow nor vanish.
const PLAIN: std::ops::Range<f64> = 1e-60..1e60;

/// As much of a bound may be in doubt for it to count as the gap itself.
const DOUBT: f64 = 1e-6;

/// A bound of a triangle's gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    /// Proven: not below the gap. Infinity where nothing is known.
    pub(super) bound: f64,
    /// Whether the gap is very likely within a millionth of that.
    pub(super) is_sharp: bool,
}

impl Along {
    const UNKNOWN: Self = Self {
        bound: f64::INFINITY,
        is_sharp: false,
    };
}

/// A bound of the gap of the triangle of these offsets from the observer, whose lengths are known and whose plane has
/// about this normal.
///
/// # Derivation
///
/// For any direction `G` with `|G| <= 1` no point `x` of the triangle has a larger gap than the largest
/// `r_i - G.d_i` of a corner, as `|x| >= G.x`. The `G` for which that is the gap itself has the in-plane part `g` by
/// which the interpolated distance grows, and points to the place in the plane where it is larger than the distance by most;
/// where that place is beyond an edge, it points to the worst place of that edge. Here both are computed as roughly as it
/// goes, for whatever `G` comes out, the bound holds: a `G` longer than 1 by `x` counts with `x` times the largest distance.
///
/// # Accuracy
///
/// Distances to `2.5 u`, dot products to `3 u r`, the difference, the length of `G` and what is made of it to `4 u r`,
/// with `u` half an epsilon: less than `8 epsilon r` together, which is added. So where a gap is `r / 1e9` the bound is above it by
/// about a millionth of it.
pub(super) fn gap_along(offsets: [DVec3; 3], distances: [f64; 3], normal: DVec3) -> Along {
    let [a, b, c] = offsets;
    let [r_a, r_b, r_c] = distances;
    let farthest = r_a.max(r_b).max(r_c);
    if !(distances.iter().all(|r| PLAIN.contains(r))) {
        return Along::UNKNOWN;
    }
    let (to_b, to_c) = (b - a, c - a);
    let (bb, bc, cc) = (to_b.length_squared(), to_b.dot(to_c), to_c.length_squared());
    let inverse = 1.0 / (bb * cc - bc * bc);
    // What a vector in the plane with these products with the two edges is made of.
    let solve = |b: f64, c: f64| [(cc * b - bc * c) * inverse, (bb * c - bc * b) * inverse];

    let (rise_b, rise_c) = (r_b - r_a, r_c - r_a);
    let [slope_b, slope_c] = solve(rise_b, rise_c);
    let across_squared = 1.0 - (slope_b * rise_b + slope_c * rise_c);
    if !(across_squared > 0.0) {
        return Along::UNKNOWN;
    }
    let across = across_squared.sqrt();
    let height = a.dot(normal);
    let per_slope = height.abs() / across;
    let [weight_b, weight_c] = solve(
        per_slope * rise_b - a.dot(to_b),
        per_slope * rise_c - a.dot(to_c),
    );
    let weight_a = 1.0 - weight_b - weight_c;
    let least = weight_a.min(weight_b).min(weight_c);
    if least >= 0.0 {
        let direction = to_b * slope_b + to_c * slope_c + normal * across.copysign(height);
        let excesses = excesses(direction, offsets, distances);
        let low = excesses[0].min(excesses[1]).min(excesses[2]);
        bounded(direction, excesses, low, farthest)
    } else {
        let edge = |p: DVec3, r_p: f64, q: DVec3, r_q: f64| {
            let rho = (0.5 * (r_p * r_q + p.dot(q))).max(0.0).sqrt();
            let toward = p * (r_q + rho) + q * (r_p + rho);
            toward / toward.length()
        };
        let (direction, first, second) = if least == weight_a {
            (edge(b, r_b, c, r_c), 1, 2)
        } else if least == weight_b {
            (edge(a, r_a, c, r_c), 0, 2)
        } else {
            (edge(a, r_a, b, r_b), 0, 1)
        };
        let excesses = excesses(direction, offsets, distances);
        let low = excesses[first].min(excesses[second]);
        bounded(direction, excesses, low, farthest)
    }
}

fn excesses(direction: DVec3, offsets: [DVec3; 3], distances: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i: usize| distances[i] - direction.dot(offsets[i]))
}

/// What a direction proves; `low` is about the gap if the direction is the right one.
fn bounded(direction: DVec3, excesses: [f64; 3], low: f64, farthest: f64) -> Along {
    let largest = excesses[0].max(excesses[1]).max(excesses[2]);
    // sqrt(1 + x) <= 1 + x / 2
    let too_long = (0.5 * (direction.length_squared() - 1.0)).max(0.0);
    let rounding = (too_long + 8.0 * EPSILON) * farthest;
    let bound = (largest + rounding) * (1.0 + 2.0 * EPSILON);
    if bound.is_nan() || direction.is_nan() {
        return Along::UNKNOWN;
    }
    Along {
        bound,
        is_sharp: bound - low <= DOUBT * bound,
    }
}
