//! About how many triangles the program will make of a triangle.

use glam::DVec3;

use super::across::Facet;
use super::chart::{Chart, Plane};
use super::edge::{EdgeRule, predicted_edge_pieces};
use super::gap::{exponent, scaled};
use super::minimum::{AREA_OF_GAP, mean_inverse_square};
use super::{Allowance, Motion, minimum_triangles, triangle_gap};

/// Away from the boundary refinement makes about this many times the number of triangles that theory asks for.
const TYPICAL_RATIO: f64 = 1.1;

/// In charts flatter than the sky refinement makes about this many times the number of triangles that the chart's
/// metric asks for; measured: 1.2 to 1.7.
const FLAT_RATIO: f64 = 1.6;

/// About how many triangles a triangle will be divided into; the corners are offsets from the observer in the rest
/// frame.
///
/// A polygon with `b` points on its boundary and `i` points inside has `b - 2 + 2 i` triangles. The number `b` is
/// known; the points inside add about as many triangles as theory asks for.
pub(crate) fn predicted_pieces(
    offsets: [DVec3; 3],
    allowance: &Allowance,
    motion: Option<&Motion>,
) -> f64 {
    /// As in the edge rule.
    const FEW_PIECES: f64 = 2.0;
    let [a, b, c] = offsets;
    let sides = [(a, b), (b, c), (c, a)];
    let times = triangle_gap(a, b, c) / allowance.between(&offsets);
    let rule = EdgeRule {
        allowance,
        motion,
        facets: &[motion.and_then(|motion| Facet::new(motion, offsets))],
        is_free: false,
    };
    let pieces = |(from, to)| predicted_edge_pieces(from, to, &rule, times <= FEW_PIECES);
    let boundary = sides.map(pieces).iter().sum::<f64>();
    if !(times > 1.0) {
        return boundary - 2.0;
    }
    let minimum = minimum_triangles(offsets, allowance, None);
    let part = of_points(offsets, minimum, allowance, motion);
    // The largest side is divided where no other is.
    let boundary = match part == 1.0 {
        true => boundary.max(4.0),
        false => boundary,
    };
    boundary - 2.0 + part * pieces_inside(offsets, minimum, allowance)
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
    FLAT_RATIO * area / AREA_OF_GAP * mean_inverse_square([a, b, c], 0, false, &weight)
}

/// About what part of the points that the measure of points needs inside a triangle that of surfaces needs.
pub(super) fn of_points(
    offsets: [DVec3; 3],
    minimum: f64,
    allowance: &Allowance,
    motion: Option<&Motion>,
) -> f64 {
    /// Rims leave about half of the tolerance.
    const LEFT: f64 = 0.5;
    match motion {
        Some(_) if minimum > 0.0 => {
            (minimum_triangles(offsets, allowance, motion) / (LEFT * minimum)).min(1.0)
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        // The computation ends even for a size that no chart can represent.
        pieces(2f64.powi(1010));
    }
}
