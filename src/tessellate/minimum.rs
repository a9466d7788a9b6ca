//! The fewest triangles that theory allows for a tolerance.

use glam::DVec3;

use super::gap::{exponent, scaled, times_two_to};
use super::{Allowance, Motion};

/// `1.5 sqrt(3)`: an equilateral triangle with the gap `e` at its middle has the area `1.5 sqrt(3) e` in the gap metric
/// (see [`minimum_triangles`]).
pub(super) const AREA_OF_GAP: f64 = 2.598_076_211_353_316;

/// Relative numerical error of the integrals, at most (`the_minimum_is_as_accurate_as_it_says`).
pub(super) const MINIMUM_ERROR: f64 = 0.02;

/// The share of a gap may differ so many times between places of a piece on which a single quadrature is enough.
const STEEP: f64 = 1.25;

/// Limit on the halvings of a triangle because of the share alone: the share of a piece as small as this counts little.
const MAX_HALVINGS_OF_SHARE: u32 = 20;

/// For a triangle whose longest side is less than this fraction of its distance, a single quadrature is enough.
const SMALL: f64 = 0.5;

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
/// rest frame; `h` is the distance of the triangle's plane, `r` that of a point, `allowed` the allowed gap there. With a
/// motion the result is that for the surface: the integrand is multiplied by the share of the gap (`motion`).
///
/// # Derivation
///
/// The second derivative of `r` along a vector `v` is `|v_across|^2 / r`, where `v_across` is the part of `v` across
/// the line of sight. The *gap metric*, which measures gaps, is therefore `r` times the metric of the sky; for a plane
/// at the distance `h` its area element is `h / r^2 dA`. Among triangles with the same gap the equilateral one has the
/// largest area in this metric.
///
/// As a surface, the photosurface of a plane is `gamma beta r` above a plane, along the motion; it is convex. The
/// integral of section 6.2 of Pottmann, Krasauskas, Hamann, Joy, Seibold, *On piecewise linear approximation of
/// quadratic functions* (J. Geom. Graph. 4 (2000), 31), that of the root of its Gaussian curvature, is the same integral
/// times the share: both principal curvatures are those of the gap, seen along the normal.
///
/// # Accuracy
///
/// The relative error is at most [`MINIMUM_ERROR`] for triangles of any size: the quadrature has degree 2 on pieces
/// smaller than half their distance. The result is zero if a coordinate is not finite.
pub(crate) fn minimum_triangles(
    offsets: [DVec3; 3],
    allowance: &Allowance,
    motion: Option<&Motion>,
) -> f64 {
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
    let share = |m: DVec3| match motion {
        Some(motion) => motion.share(twice_area, m.normalize()),
        None => 1.0,
    };
    let is_steep = motion.is_some();
    match allowance {
        Allowance::Everywhere(allowed) => {
            let mean = mean_inverse_square([a, b, c], 0, is_steep, &share);
            times_two_to(half * mean, exponent) / allowed
        }
        Allowance::Angle { .. } => {
            let weight = |m: DVec3| share(m) / allowance.between(&[scaled(m, exponent)]);
            let mean = mean_inverse_square([a, b, c], 0, is_steep, &weight);
            times_two_to(half * mean, exponent)
        }
    }
}

/// The mean of `weight / r^2` over a triangle; `r` is the distance from the observer at the origin. Pieces over which a
/// steep weight changes are halved as well.
pub(super) fn mean_inverse_square(
    [a, b, c]: [DVec3; 3],
    halvings: u32,
    is_steep: bool,
    weight: &dyn Fn(DVec3) -> f64,
) -> f64 {
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
        let weights = middles.map(weight);
        let changes = || {
            let (low, high) = [a, b, c]
                .map(weight)
                .into_iter()
                .chain(weights)
                .fold((f64::INFINITY, 0.0f64), |(low, high), weight| {
                    (low.min(weight), high.max(weight))
                });
            high > STEEP * low
        };
        if !(is_steep && halvings < MAX_HALVINGS_OF_SHARE && changes()) {
            let values = middles.iter().zip(weights);
            let values = values.map(|(m, weight)| weight / m.length_squared().max(floor));
            return values.sum::<f64>() / 3.0;
        }
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
    parts[0] * mean_inverse_square([p, m, r], halvings + 1, is_steep, weight)
        + parts[1] * mean_inverse_square([m, q, r], halvings + 1, is_steep, weight)
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

    use super::super::triangle_gap;
    use super::*;
    use crate::light_cone::PhotosurfaceMap;
    use crate::spacetime::Velocity;

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
            let means = strip.map(|triangle| mean_inverse_square(triangle, 0, false, &count));
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
                .map(|t| minimum_triangles(t, &Allowance::Everywhere(1.0 / AREA_OF_GAP), None))
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
        let expected = minimum_triangles(corners, &Allowance::Everywhere(1e-3), None);
        for exponent in [-1000, -600, -200, 200, 600, 1023] {
            let scale = 2f64.powi(exponent);
            let found = minimum_triangles(
                corners.map(|corner| corner * scale),
                &Allowance::Everywhere(1e-3 * scale),
                None,
            );
            assert_eq!(found, expected, "2^{exponent}");
        }
        let far = corners.map(|corner| corner * f64::MAX);
        assert_eq!(
            minimum_triangles(far, &Allowance::Everywhere(1e-3), None),
            f64::INFINITY
        );
        assert_eq!(
            minimum_triangles(
                [DVec3::X, DVec3::Y, DVec3::INFINITY],
                &Allowance::Everywhere(1e-3),
                None
            ),
            0.0
        );
        assert_eq!(
            minimum_triangles(
                [DVec3::X, DVec3::Y, DVec3::NAN],
                &Allowance::Everywhere(1e-3),
                None
            ),
            0.0
        );
    }

    #[test]
    fn what_is_no_number_is_halved_no_further() {
        let taken = Cell::new(0);
        let count = |_: DVec3| {
            taken.set(taken.get() + 1);
            1.0
        };
        mean_inverse_square([DVec3::NAN, DVec3::X, DVec3::Y], 0, false, &count);
        assert_eq!(taken.get(), 3);
    }

    #[test]
    fn planes_through_the_observer_need_no_division() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(
            minimum_triangles(flat, &Allowance::Everywhere(1e-3), None),
            0.0
        );
        let degenerate = [DVec3::X, DVec3::X + DVec3::Y, DVec3::X - DVec3::Y];
        assert_eq!(
            minimum_triangles(degenerate, &Allowance::Everywhere(1e-3), None),
            0.0
        );
    }

    /// The integral of the root of the Gaussian curvature over a photosurface, from differences of seen places alone.
    fn by_differences(map: &PhotosurfaceMap, [a, b, c]: [DVec3; 3]) -> f64 {
        const CELLS: u32 = 120;
        const STEP: f64 = 1e-3;
        let (u, v) = (b - a, c - a);
        let mut sum = 0.0;
        for i in 0..CELLS {
            for j in 0..CELLS - i {
                for (third, is_inside) in [(1.0, true), (2.0, i + j + 1 < CELLS)] {
                    if !is_inside {
                        continue;
                    }
                    let cell = f64::from(CELLS);
                    let at = |s: f64, t: f64| {
                        let (s, t) = (
                            (f64::from(i) + third / 3.0) / cell + s * STEP,
                            (f64::from(j) + third / 3.0) / cell + t * STEP,
                        );
                        map.seen_position(a + u * s + v * t)
                    };
                    let (here, across) = (at(0.0, 0.0), STEP * STEP);
                    let normal = (at(1.0, 0.0) - at(-1.0, 0.0)).cross(at(0.0, 1.0) - at(0.0, -1.0));
                    let normal = normal.normalize();
                    let of =
                        |s: f64, t: f64| (at(s, t) + at(-s, -t) - 2.0 * here).dot(normal) / across;
                    let (ss, tt) = (of(1.0, 0.0), of(0.0, 1.0));
                    let st = 0.5 * (of(1.0, 1.0) - ss - tt);
                    sum += (ss * tt - st * st).abs().sqrt() / (2.0 * cell * cell);
                }
            }
        }
        sum
    }

    #[test]
    fn the_minimum_of_surfaces_is_the_integral_of_the_curvature() {
        let triangles = [
            [[-1.0, -1.0, 0.5], [1.0, -1.0, 0.5], [0.2, 1.0, 0.5]],
            [[0.3, -0.2, 0.4], [1.3, 0.1, 0.9], [0.5, 1.0, -0.3]],
            [[2.0, 2.0, 1.0], [2.5, 2.0, 0.5], [2.0, 3.0, 0.0]],
        ];
        for triangle in triangles {
            let triangle = triangle.map(DVec3::from);
            for (gamma, direction) in [
                (1.25, DVec3::Z),
                (3.0, DVec3::X),
                (10.0, DVec3::new(-1.0, 0.3, 0.2)),
            ] {
                let velocity = Velocity::from_gamma(gamma, direction).unwrap();
                let map = PhotosurfaceMap::new(&velocity);
                let allowance = Allowance::Everywhere(1e-3 / velocity.gamma_beta());
                let motion = Motion::new(velocity);
                let found = minimum_triangles(triangle, &allowance, Some(&motion));
                let expected = by_differences(&map, triangle) / (AREA_OF_GAP * 1e-3);
                // The differences of the reference have an error of their own.
                let error = (found / expected - 1.0).abs();
                assert!(
                    error <= MINIMUM_ERROR || expected < 1e-3 && found < 1e-3,
                    "{gamma} {direction} {triangle:?}: {found} {expected}"
                );
            }
        }
    }

    /// Against a fine division of the same integrand, for triangles near and far.
    #[test]
    fn the_minimum_is_as_accurate_as_it_says() {
        let velocity = Velocity::from_gamma(20.0, DVec3::new(1.0, 0.1, 0.2)).unwrap();
        let motion = Motion::new(velocity);
        for motion in [None, Some(&motion)] {
            for step in 1..60 {
                let wave = |factor: f64| (f64::from(step) * factor).sin();
                let place = DVec3::new(1.5 * wave(1.7), 1.5 * wave(0.9), 0.1 + wave(0.31).powi(2));
                let size = 0.8f64.powi(step % 12);
                let corner =
                    |f: f64| place + size * DVec3::new(wave(2.3 + f), wave(1.1 + f), wave(f));
                let triangle = [corner(0.1), corner(0.57), corner(0.83)];
                let [a, b, c] = triangle;
                let normal = (b - a).cross(c - a);
                let found = minimum_triangles(triangle, &Allowance::Everywhere(1.0), motion);
                const CELLS: u32 = 400;
                let mut mean = 0.0;
                for i in 0..CELLS {
                    for j in 0..CELLS - i {
                        for third in [1.0, 2.0] {
                            if third == 2.0 && i + j + 1 == CELLS {
                                continue;
                            }
                            let [s, t] =
                                [i, j].map(|k| (f64::from(k) + third / 3.0) / f64::from(CELLS));
                            let at = a + (b - a) * s + (c - a) * t;
                            let share = motion.map_or(1.0, |m| m.share(normal, at.normalize()));
                            mean += share / at.length_squared() / f64::from(CELLS * CELLS);
                        }
                    }
                }
                let expected = 0.5 * a.dot(normal).abs() * mean / AREA_OF_GAP;
                assert!(
                    (found / expected - 1.0).abs() <= MINIMUM_ERROR,
                    "{step} {triangle:?}: {found} {expected}"
                );
            }
        }
    }

    /// Random triangulations of a plate, the best of many for each number of points: none has fewer triangles than the
    /// minimum for its own largest gap.
    #[test]
    fn no_triangulation_beats_the_minimum() {
        use spade::{DelaunayTriangulation, Point2, Triangulation};
        let velocity = Velocity::from_gamma(1.5, DVec3::new(0.3, 0.0, -1.0)).unwrap();
        let of_surface = Motion::new(velocity);
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let on_plate = |x: f64, y: f64| DVec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, -0.5);
        let plate = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| on_plate(x, y));
        let halves = [
            [plate[0], plate[1], plate[2]],
            [plate[0], plate[2], plate[3]],
        ];
        for (sides, inside) in [(3, 6), (4, 12), (6, 30)] {
            for motion in [None, Some(&of_surface)] {
                let mut best = (f64::INFINITY, 0);
                for _ in 0..300 {
                    let mut points = DelaunayTriangulation::<Point2<f64>>::new();
                    for i in 0..sides {
                        let part = f64::from(i) / f64::from(sides);
                        for (x, y) in [
                            (part, 0.0),
                            (1.0, part),
                            (1.0 - part, 1.0),
                            (0.0, 1.0 - part),
                        ] {
                            points.insert(Point2::new(x, y)).unwrap();
                        }
                    }
                    for _ in 0..inside {
                        points.insert(Point2::new(random(), random())).unwrap();
                    }
                    let gaps = points.inner_faces().map(|face| {
                        let [a, b, c] = face.positions().map(|p| on_plate(p.x, p.y));
                        let gap = triangle_gap(a, b, c);
                        let [u, v, w] = super::super::triangle_gap_place(a, b, c);
                        let worst = (a * u + b * v + c * w).normalize();
                        gap * motion.map_or(1.0, |motion| motion.share(DVec3::Z, worst))
                    });
                    let largest = gaps.fold(0.0, f64::max);
                    if largest < best.0 {
                        best = (largest, points.num_inner_faces());
                    }
                }
                let allowance = Allowance::Everywhere(best.0);
                let minimum = halves.map(|half| minimum_triangles(half, &allowance, motion));
                let minimum = minimum[0] + minimum[1];
                let made = best.1 as f64;
                assert!(
                    minimum <= made * (1.0 + MINIMUM_ERROR),
                    "{made} made, {minimum}"
                );
                assert!(minimum > 0.05 * made, "{made} made, {minimum}");
            }
        }
    }
}
