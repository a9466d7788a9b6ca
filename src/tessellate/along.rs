//! A bound of a triangle's gap along one direction, for a tenth of what the exact gap costs.

use glam::{DVec2, DVec3};

use super::chart::Plane;

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

/// A point of a plane, and what is known of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    /// Offset from the observer.
    pub(super) offset: DVec3,
    /// Its length.
    pub(super) distance: f64,
    /// About where in the plane it is.
    pub(super) place: DVec2,
}

impl Spot {
    pub(super) fn new(plane: &Plane, offset: DVec3) -> Self {
        Self {
            offset,
            distance: offset.length(),
            place: plane.place(offset),
        }
    }
}

/// A bound of the gap of a triangle in a plane.
///
/// # Derivation
///
/// For any direction `G` with `|G| <= 1` no point `x` of the triangle has a larger gap than the largest
/// `r_i - G.d_i` of a corner, as `|x| >= G.x`. The `G` for which that is the gap itself has the in-plane part `g` by
/// which the interpolated distance grows, and points to the place `h g / sqrt(1 - g^2)` in the plane; where that is beyond
/// an edge, it points to the worst place of that edge. Here both are computed as roughly as it goes: the bound holds for
/// whatever `G` comes out, one longer than 1 by `x` counts with `x` times the largest distance.
///
/// # Accuracy
///
/// Distances to `2.5 u`, dot products to `3 u r`, the difference, the length of `G` and what is made of it to `4 u r`,
/// with `u` half an epsilon: less than `8 epsilon r` together, which is added. So where a gap is `r / 1e9` the bound
/// is above it by about a millionth of it.
pub(super) fn gap_along(plane: &Plane, [a, b, c]: [&Spot; 3]) -> Along {
    if ![a, b, c].iter().all(|spot| PLAIN.contains(&spot.distance)) {
        return Along::UNKNOWN;
    }
    let (to_b, to_c) = (b.place - a.place, c.place - a.place);
    let (rise_b, rise_c) = (b.distance - a.distance, c.distance - a.distance);
    let slope = (DVec2::new(to_c.y, -to_c.x) * rise_b - DVec2::new(to_b.y, -to_b.x) * rise_c)
        / to_b.perp_dot(to_c);
    let across_squared = 1.0 - slope.length_squared();
    if !(across_squared > 0.0) {
        return Along::UNKNOWN;
    }
    let across = across_squared.sqrt();
    let worst = slope * (plane.height / across);
    let (from_a, from_b, from_c) = (a.place - worst, b.place - worst, c.place - worst);
    let (in_a, in_b, in_c) = (
        from_b.perp_dot(from_c),
        from_c.perp_dot(from_a),
        from_a.perp_dot(from_b),
    );
    let is_inside = in_a >= 0.0 && in_b >= 0.0 && in_c >= 0.0;
    let (p, q, other) = if in_a <= in_b && in_a <= in_c {
        (b, c, a)
    } else if in_b <= in_c {
        (c, a, b)
    } else {
        (a, b, c)
    };
    let direction = if is_inside {
        plane.x * slope.x + plane.y * slope.y + plane.away * across
    } else {
        let rho = (0.5 * (p.distance * q.distance + p.offset.dot(q.offset)))
            .max(0.0)
            .sqrt();
        let toward = p.offset * (q.distance + rho) + q.offset * (p.distance + rho);
        toward * (1.0 / toward.length())
    };
    let excess = |spot: &Spot| spot.distance - direction.dot(spot.offset);
    let (of_p, of_q, of_other) = (excess(p), excess(q), excess(other));
    let largest = of_p.max(of_q).max(of_other);
    // At the worst place the gap is the mean of what it is between.
    let least = if is_inside {
        of_p.min(of_q).min(of_other)
    } else {
        of_p.min(of_q)
    };
    let farthest = a.distance.max(b.distance).max(c.distance);
    // sqrt(1 + x) <= 1 + x / 2
    let too_long = (0.5 * (direction.length_squared() - 1.0)).max(0.0);
    let bound = (largest + (too_long + 8.0 * EPSILON) * farthest) * (1.0 + 2.0 * EPSILON);
    if !direction.is_finite() {
        return Along::UNKNOWN;
    }
    Along {
        bound,
        is_sharp: bound - least <= DOUBT * bound,
    }
}
