//! The fewest triangles that theory allows for a tolerance, and about how many the program will make.

use glam::DVec3;

use super::chart::{Chart, Plane};
use super::edge::predicted_edge_pieces;
use super::gap::{exponent, scaled, times_two_to};
use super::{Allowance, triangle_gap};

/// `1.5 sqrt(3)`: an equilateral triangle with the gap `e` at its middle has the area `1.5 sqrt(3) e` in the gap metric
/// (see [`minimum_triangles`]).
pub(super) const AREA_OF_GAP: f64 = 2.598_076_211_353_316;

/// For a triangle whose longest side is less than this fraction of its distance, a single quadrature is enough.
const SMALL: f64 = 0.5;

/// Away from the boundary refinement makes about this many times the number of triangles that theory asks for.
const TYPICAL_RATIO: f64 = 1.1;

/// In charts flatter than the sky refinement makes about this many times the number of triangles that the chart's
/// metric asks for; measured: 1.2 to 1.7.
const FLAT_RATIO: f64 = 1.6;

/// Limit on the halvings of a triangle that reaches the observer; the remaining piece contributes almost nothing.
const MAX_HALVINGS: u32 = 60;

/// A triangle with at least this ratio of length to width, and far enough from the observer, is integrated as a line of
/// varying width. Halving it would only give more slivers side by side, without end.
const SLIVER: f64 = 1000.0;

/// Smallest distance of such a sliver from the observer, in units of its width.
const FAR: f64 = 16.0;

/// Limit on the halvings of a line near the observer: the number of exponents of `f64`.
const MAX_HALVINGS_OF_LINE: u32 = 1100;

/// The fewest triangles, for a small tolerance, that keep the gap `e` of each within the allowance: the integral of
/// `h / (r^2 allowed)` over the triangle, divided by `1.5 sqrt(3)`. The corners are offsets from the observer in the
/// rest frame; `h` is the distance of the triangle's plane, `r` that of a point, `allowed` the allowed gap there.
///
/// # Derivation
///
/// The second derivative of `r` along a vector `v` is `|v_across|^2 / r`, where `v_across` is the part of `v` across
/// the line of sight. The *gap metric*, which measures gaps, is therefore `r` times the metric of the sky; for a plane
/// at the distance `h` its area element is `h / r^2 dA`. Among triangles with the same gap the equilateral one has the
/// largest area in this metric.
///
/// # Accuracy
///
/// The result has about three correct digits for triangles of any size: the quadrature has degree 2 on pieces smaller
/// than half their distance. It is zero if a coordinate is not finite.
pub(crate) fn minimum_triangles(offsets: [DVec3; 3], allowance: &Allowance) -> f64 {
    let largest = offsets.iter().fold(0.0, |largest: f64, offset| {
        largest.max(offset.abs().max_element())
    });
    if !(largest > 0.0 && offsets.iter().all(|offset| offset.is_finite())) {
        return 0.0;
    }
    // The integral is proportional to the size. At unit size neither squares nor sums overflow; an overflow would make
    // the halving endless.
    let exponent = exponent(DVec3::splat(largest));
    let [a, b, c] = offsets.map(|offset| scaled(offset, -exponent));
    // h times twice the area is the triple product of the corners, 6 times the volume of the tetrahedron with the
    // observer. It is divided among pieces of the triangle in proportion to their areas.
    let twice_area = (b - a).cross(c - a);
    let height_times_twice_area = a.dot(twice_area).abs();
    if height_times_twice_area == 0.0 {
        return 0.0;
    }
    let half = 0.5 * height_times_twice_area / AREA_OF_GAP;
    match allowance {
        Allowance::Everywhere(allowed) => {
            times_two_to(half * mean_inverse_square([a, b, c], 0, &|_| 1.0), exponent) / allowed
        }
        Allowance::Angle { .. } => {
            let inverse = |m: DVec3| 1.0 / allowance.between(&[scaled(m, exponent)]);
            times_two_to(half * mean_inverse_square([a, b, c], 0, &inverse), exponent)
        }
    }
}

/// About how many triangles a triangle will be divided into; the corners are offsets from the observer in the rest
/// frame.
///
/// A polygon with `b` points on its boundary and `i` points inside has `b - 2 + 2 i` triangles. The number `b` is
/// known; the points inside add about as many triangles as theory asks for.
pub(crate) fn predicted_pieces(offsets: [DVec3; 3], allowance: &Allowance) -> f64 {
    let [a, b, c] = offsets;
    let sides = [(a, b), (b, c), (c, a)];
    let boundary = sides.map(|(from, to)| predicted_edge_pieces(from, to, allowance));
    let allowed = allowance.between(&offsets);
    let inside = if triangle_gap(a, b, c) <= allowed {
        0.0
    } else {
        pieces_inside(offsets, minimum_triangles(offsets, allowance), allowance)
    };
    boundary.iter().sum::<f64>() - 2.0 + inside
}

/// About how many triangles the points inside add when a triangle is divided. Usually this is about `minimum`, the
/// number that theory asks for. If the observer is in the triangle's plane or next to it, it is the number that a chart
/// flatter than the sky needs.
pub(super) fn pieces_inside(offsets: [DVec3; 3], minimum: f64, allowance: &Allowance) -> f64 {
    let inside = TYPICAL_RATIO * minimum;
    let Some(plane) = Plane::new(offsets) else {
        return inside;
    };
    let [a, b, c] = offsets;
    let places = [a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
    let allowed = places.map(|place| allowance.between(&[place]));
    let smallest = allowed.into_iter().fold(f64::INFINITY, f64::min);
    let chart = Chart::new(plane, allowance, smallest, 0);
    if chart.height == plane.height && chart.power == 0.0 {
        return inside;
    }
    let raised = plane.away * (chart.height - plane.height);
    let weight = |raised_offset: DVec3| {
        let offset = raised_offset - raised;
        chart.effective_height(plane.place(offset)) / allowance.between(&[offset])
    };
    let offsets = offsets.map(|offset| offset + raised);
    let largest = offsets.iter().fold(0.0, |largest: f64, offset| {
        largest.max(offset.abs().max_element())
    });
    if !(largest > 0.0 && offsets.iter().all(|offset| offset.is_finite())) {
        return inside;
    }
    // As in `minimum_triangles`, nothing overflows at unit size; here the size cancels.
    let exponent = exponent(DVec3::splat(largest));
    let [a, b, c] = offsets.map(|offset| scaled(offset, -exponent));
    let area = 0.5 * (b - a).cross(c - a).length();
    let weight = |unit_offset: DVec3| weight(scaled(unit_offset, exponent));
    FLAT_RATIO * area / AREA_OF_GAP * mean_inverse_square([a, b, c], 0, &weight)
}

/// The mean of `weight / r^2` over a triangle; `r` is the distance from the observer at the origin.
fn mean_inverse_square([a, b, c]: [DVec3; 3], halvings: u32, weight: &dyn Fn(DVec3) -> f64) -> f64 {
    let edges =
        [(a, b, c), (b, c, a), (c, a, b)].map(|(p, q, r)| ((q - p).length_squared(), p, q, r));
    let longest = edges
        .iter()
        .fold(&edges[0], |l, e| if e.0 > l.0 { e } else { l });
    let middles = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
    let nearest = middles
        .iter()
        .fold(f64::INFINITY, |r, m| r.min(m.length_squared()));
    // This branch also ends the recursion where a coordinate is NaN.
    if !(longest.0 > SMALL * SMALL * nearest) || halvings == MAX_HALVINGS {
        let floor = f64::MIN_POSITIVE.sqrt();
        return middles
            .iter()
            .map(|m| weight(*m) / m.length_squared().max(floor))
            .sum::<f64>()
            / 3.0;
    }
    let &(longest, p, q, r) = longest;
    let width = (q - p).cross(r - p).length() / longest.sqrt();
    let (mut m, mut parts) = ((p + q) * 0.5, [0.5, 0.5]);
    if longest > (SLIVER * width).powi(2) {
        let length = longest.sqrt();
        let along = (q - p) / length;
        let at = -p.dot(along);
        // Next to an end, the foot of the perpendicular has a rounding error relative to the whole length.
        let foot = p + along * at.clamp(0.0, length);
        let nearest = [q, foot].into_iter().fold(p, |nearest, place| {
            let is_nearer = place.length_squared() < nearest.length_squared();
            if is_nearer { place } else { nearest }
        });
        let distance = nearest.length();
        if distance > FAR * width {
            return mean_inverse_square_of_sliver(p, q, r, weight);
        }
        // One cut separates the part near the observer from the rest.
        let near = 2.0 * (FAR * width + distance);
        m = nearest + along * near.copysign(0.5 * length - at);
        // Each part is computed on its own, because one of them may be tiny.
        parts = [(m - p).length() / length, (q - m).length() / length];
    }
    parts[0] * mean_inverse_square([p, m, r], halvings + 1, weight)
        + parts[1] * mean_inverse_square([m, q, r], halvings + 1, weight)
}

/// The mean of `weight / r^2` over a sliver: its longest edge goes from `p` to `q`, and the third corner `r` is next to
/// that edge.
fn mean_inverse_square_of_sliver(
    p: DVec3,
    q: DVec3,
    r: DVec3,
    weight: &dyn Fn(DVec3) -> f64,
) -> f64 {
    let along = q - p;
    let part = ((r - p).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let foot = p + along * part;
    // The width grows from zero to its largest value at the third corner, and falls to zero again. Its mean is half the
    // largest value, so that the widths 0 and 2 have the mean 1.
    part * mean_along([p, foot], [0.0, 2.0], 0, weight)
        + (1.0 - part) * mean_along([foot, q], [2.0, 0.0], 0, weight)
}

/// The mean of `width weight / r^2` over a line from `p` to `q`, along which the width changes linearly.
fn mean_along(
    [p, q]: [DVec3; 2],
    [from, to]: [f64; 2],
    halvings: u32,
    weight: &dyn Fn(DVec3) -> f64,
) -> f64 {
    let (middle, width) = ((p + q) * 0.5, 0.5 * from + 0.5 * to);
    let small = (q - p).length_squared() <= SMALL * SMALL * middle.length_squared();
    if small || halvings == MAX_HALVINGS_OF_LINE {
        // Simpson's rule.
        let floor = f64::MIN_POSITIVE.sqrt();
        let at = |place: DVec3, width: f64| match width {
            0.0 => 0.0,
            _ => width * weight(place) / place.length_squared().max(floor),
        };
        return (at(p, from) + 4.0 * at(middle, width) + at(q, to)) / 6.0;
    }
    0.5 * (mean_along([p, middle], [from, width], halvings + 1, weight)
        + mean_along([middle, q], [width, to], halvings + 1, weight))
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// In the past slivers were halved into slivers side by side, a million of them for one facet.
    #[test]
    fn slivers_take_few_pieces_and_have_the_minimum_of_the_closed_form() {
        // A strip from -1 to 1 of width w at distance d: the mean of 1 / r^2 is atan(1 / d) / d.
        for (w, d) in [(1e-5, 1e-3), (1e-9, 1e-6), (1e-30, 1e-25), (1e-70, 1e-40)] {
            let corners = |w: f64| {
                [
                    [(-1.0, 0.0), (1.0, 0.0), (-1.0, w)],
                    [(1.0, 0.0), (1.0, w), (-1.0, w)],
                ]
            };
            let taken = Cell::new(0);
            let count = |_: DVec3| {
                taken.set(taken.get() + 1);
                1.0
            };
            let strip = corners(w).map(|triangle| triangle.map(|(x, y)| DVec3::new(x, y, d)));
            let means = strip.map(|triangle| mean_inverse_square(triangle, 0, &count));
            assert!(taken.get() < 5_000, "{w:e} at {d:e}: {}", taken.get());
            let (found, expected) = (0.5 * (means[0] + means[1]), (1.0 / d).atan() / d);
            assert!(
                (found / expected - 1.0).abs() < 1e-2,
                "{w:e} at {d:e}: {found:e}"
            );
        }
    }

    #[test]
    fn a_plate_has_the_minimum_of_the_closed_form() {
        // The reference for a square of side 2 at distance h is its integral in polar form: 8 * integral over 0..45
        // degrees of h / 2 ln(1 + 1 / (h cos)^2).
        for h in [1.0f64, 0.1, 0.01, 0.001] {
            let steps = 20_000;
            let expected: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) / f64::from(steps) * std::f64::consts::FRAC_PI_4)
                .map(|angle| 0.5 * h * (1.0 / (h * angle.cos()).powi(2)).ln_1p())
                .sum::<f64>()
                * 8.0
                * std::f64::consts::FRAC_PI_4
                / f64::from(steps);
            let corner = |x, y| DVec3::new(x, y, h);
            let triangles = [
                [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)],
                [corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            ];
            let found: f64 = triangles
                .map(|t| minimum_triangles(t, &Allowance::Everywhere(1.0 / AREA_OF_GAP)))
                .iter()
                .sum();
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{h}: {found} {expected}"
            );
        }
    }

    /// In the past squares of such coordinates overflowed, and sums of the largest ones too: NaN was halved 2^60 times.
    #[test]
    fn the_minimum_goes_with_the_size_of_a_triangle() {
        let corners = [
            DVec3::new(-0.9, -0.5, 0.25),
            DVec3::new(0.9, -0.5, 0.25),
            DVec3::new(0.0, 0.9, 0.5),
        ];
        let expected = minimum_triangles(corners, &Allowance::Everywhere(1e-3));
        for exponent in [-1000, -600, -200, 200, 600, 1023] {
            let scale = 2f64.powi(exponent);
            let found = minimum_triangles(
                corners.map(|corner| corner * scale),
                &Allowance::Everywhere(1e-3 * scale),
            );
            assert_eq!(found, expected, "2^{exponent}");
        }
        let far = corners.map(|corner| corner * f64::MAX);
        assert_eq!(
            minimum_triangles(far, &Allowance::Everywhere(1e-3)),
            f64::INFINITY
        );
        assert_eq!(
            minimum_triangles(
                [DVec3::X, DVec3::Y, DVec3::INFINITY],
                &Allowance::Everywhere(1e-3)
            ),
            0.0
        );
        assert_eq!(
            minimum_triangles(
                [DVec3::X, DVec3::Y, DVec3::NAN],
                &Allowance::Everywhere(1e-3)
            ),
            0.0
        );
    }

    /// In the past squares also overflowed for an observer next to the triangle's plane, and NaN was halved again and
    /// again.
    #[test]
    fn pieces_in_flat_charts_go_with_the_size_of_a_triangle() {
        let corners = [
            DVec3::new(-0.9, -0.5, 1e-6),
            DVec3::new(0.9, -0.5, 1e-6),
            DVec3::new(0.0, 0.9, 1e-6),
        ];
        let pieces = |scale: f64| {
            let corners = corners.map(|corner| corner * scale);
            pieces_inside(corners, 0.0, &Allowance::Everywhere(1e-3 * scale))
        };
        let expected = pieces(1.0);
        assert!(expected > 10.0, "{expected}");
        for exponent in [-200, 200] {
            let found = pieces(2f64.powi(exponent));
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "2^{exponent}: {found} {expected}"
            );
        }
        let taken = Cell::new(0);
        let count = |_: DVec3| {
            taken.set(taken.get() + 1);
            1.0
        };
        mean_inverse_square([DVec3::NAN, DVec3::X, DVec3::Y], 0, &count);
        assert_eq!(taken.get(), 3);
        // The computation ends even for a size that no chart can represent.
        pieces(2f64.powi(1010));
    }

    #[test]
    fn planes_through_the_observer_need_no_division() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(minimum_triangles(flat, &Allowance::Everywhere(1e-3)), 0.0);
        let degenerate = [DVec3::X, DVec3::X + DVec3::Y, DVec3::X - DVec3::Y];
        assert_eq!(
            minimum_triangles(degenerate, &Allowance::Everywhere(1e-3)),
            0.0
        );
    }
}
