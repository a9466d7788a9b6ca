//! A bound of a triangle's gap along one direction, for a fraction of what the exact gap costs.

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
pub(super) struct PlanePoint {
    /// Offset from the observer.
    pub(super) offset: DVec3,
    /// Its length.
    pub(super) distance: f64,
    /// About where in the plane it is.
    pub(super) place: DVec2,
}

impl PlanePoint {
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
pub(super) fn gap_along(plane: &Plane, [a, b, c]: [&PlanePoint; 3]) -> Along {
    if ![a, b, c]
        .iter()
        .all(|point| PLAIN.contains(&point.distance))
    {
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
    let excess = |point: &PlanePoint| point.distance - direction.dot(point.offset);
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

#[cfg(test)]
mod tests {
    use super::super::triangle_gap;
    use super::*;

    /// Triangles of many sizes and shapes, near and far from the foot of the plane and far outside of it.
    fn triangles() -> impl Iterator<Item = [DVec3; 3]> {
        (0..4000).map(|step| {
            let wave = |factor: f64| (f64::from(step) * factor).sin();
            let place = DVec3::new(3.0 * wave(1.7), 3.0 * wave(0.9), 0.02 + wave(0.31).powi(2));
            let size = 0.7f64.powi(step % 40);
            let corner = |shift: f64| {
                place + size * DVec3::new(wave(2.3 + shift), wave(1.1 + 2.0 * shift), wave(shift))
            };
            [corner(0.1), corner(0.57), corner(0.83)]
        })
    }

    fn along(corners: [DVec3; 3]) -> Option<Along> {
        let plane = Plane::new(corners)?;
        let [a, b, c] = corners.map(|corner| PlanePoint::new(&plane, corner));
        Some(gap_along(&plane, [&a, &b, &c]))
    }

    /// The exact gap is known to be right, to 1e-12 for triangles like most of these.
    #[test]
    fn the_bound_is_above_the_gap_and_mostly_sharp() {
        let (mut sharp, mut all) = (0, 0);
        for corners in triangles() {
            let Some(along) = along(corners) else {
                continue;
            };
            let gap = triangle_gap(corners[0], corners[1], corners[2]);
            assert!(
                along.bound >= gap * (1.0 - 1e-10),
                "{corners:?}: {along:?} {gap}"
            );
            // Rounding is more than a millionth of a smaller one.
            all += usize::from(gap > 1e-8 * corners[0].length());
            if along.is_sharp {
                sharp += 1;
                assert!(
                    along.bound <= gap * (1.0 + 2.0 * DOUBT),
                    "{corners:?}: {along:?} {gap}"
                );
            }
        }
        // Most, or the exact gap would be asked for after all.
        assert!(all > 2000 && sharp > all / 2, "{sharp} of {all}");
    }

    /// A plane that is not that of the corners makes the bound worse, never wrong.
    #[test]
    fn the_bound_holds_for_whatever_plane() {
        let mut different = 0;
        for corners in triangles() {
            let turned = corners.map(|corner| corner * 1.3 + DVec3::new(0.2, 0.0, corner.x * 0.01));
            let Some(plane) = Plane::new(turned) else {
                continue;
            };
            let [a, b, c] = corners.map(|corner| PlanePoint::new(&plane, corner));
            let bound = gap_along(&plane, [&a, &b, &c]).bound;
            let gap = triangle_gap(corners[0], corners[1], corners[2]);
            assert!(bound >= gap * (1.0 - 1e-10), "{corners:?}: {bound} {gap}");
            different += usize::from(bound > gap * 1.001);
        }
        assert!(different > 1000, "{different}");
    }

    #[test]
    fn what_is_no_number_or_beyond_squares_is_unknown() {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        let plane = Plane::new(corners).unwrap();
        for place in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::X * 1e200] {
            let [a, b, c] =
                [corners[0], corners[1], place].map(|corner| PlanePoint::new(&plane, corner));
            let along = gap_along(&plane, [&a, &b, &c]);
            assert!(along.bound == f64::INFINITY && !along.is_sharp, "{place}");
        }
    }
}
