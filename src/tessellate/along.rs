//! A bound on a triangle's gap from a single direction, for a fraction of the cost of the exact gap.

use glam::{DVec2, DVec3};

use super::chart::Plane;

const EPSILON: f64 = f64::EPSILON;

/// Range of distances from the observer for which the squares and products below neither overflow nor vanish.
const PLAIN: std::ops::Range<f64> = 1e-60..1e60;

/// A bound counts as the gap itself if at most this fraction of it is uncertain.
const DOUBT: f64 = 1e-6;

/// An upper bound on a triangle's gap, in the rest frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    /// Proven to be at least the gap; infinity where nothing is known.
    pub(super) bound: f64,
    /// Whether the gap is very likely within a millionth of the bound.
    pub(super) is_sharp: bool,
    /// The vector `G` of the bound, hardly longer than 1; zero where nothing is known.
    pub(super) direction: DVec3,
    /// The in-plane gradient of the interpolated distance, shorter than 1.
    pub(super) slope: DVec3,
}

impl Along {
    const UNKNOWN: Self = Self {
        bound: f64::INFINITY,
        is_sharp: false,
        direction: DVec3::ZERO,
        slope: DVec3::ZERO,
    };
}

/// A point of a triangle's plane, with its distance from the observer and its coordinates in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanePoint {
    /// Offset from the observer, in the rest frame.
    pub(super) offset: DVec3,
    /// Length of the offset.
    pub(super) distance: f64,
    /// Approximate coordinates in the plane.
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

/// A bound on the gap of a triangle in a plane.
///
/// # Derivation
///
/// For every vector `G` with `|G| <= 1`, no point `x` of the triangle has a larger gap than the largest `r_i - G.d_i`
/// of a corner, because `|x| >= G.x`. For the best `G` this bound is the gap itself. The in-plane part of that `G` is
/// the gradient `g` of the interpolated distance, and `G` points from the observer to the point `h g / sqrt(1 - g^2)`
/// of the plane, where `h` is the distance of the plane; if that point is beyond an edge, `G` points to the worst point
/// of that edge instead. This function computes `G` only roughly, because the bound holds for any `G`. If the length of
/// `G` exceeds 1, the excess times the largest distance is added to the bound.
///
/// # Accuracy
///
/// With `u` for half an epsilon and `r` for the largest distance, the errors are `2.5 u r` for a distance, `3 u r` for
/// a dot product, and `4 u r` for the difference, the length of `G` and the numbers computed from it. Together they are
/// less than `8 epsilon r`, which is added to the bound. Where the gap is `r / 1e9`, the bound is therefore above it by
/// about a millionth of the gap.
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
    let slope = plane.x * slope.x + plane.y * slope.y;
    let direction = if is_inside {
        slope + plane.away * across
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
    // The gap at the worst point is a weighted mean of the numbers `r_i - G.d_i` of the corners around it.
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
        direction,
        slope,
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

    /// `triangle_gap` is tested elsewhere; it is accurate to 1e-12 for most of these triangles.
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
            // For a smaller gap the rounding error is more than a millionth of it.
            all += usize::from(gap > 1e-8 * corners[0].length());
            if along.is_sharp {
                sharp += 1;
                assert!(
                    along.bound <= gap * (1.0 + 2.0 * DOUBT),
                    "{corners:?}: {along:?} {gap}"
                );
            }
        }
        // Most bounds have to be sharp; otherwise the program would compute the exact gap anyway.
        assert!(all > 2000 && sharp > all / 2, "{sharp} of {all}");
    }

    /// With a plane that is not the plane of the corners the bound is larger, but still a bound.
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
