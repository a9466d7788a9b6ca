//! A bound of a triangle's gap that costs next to nothing, to pass over most of many triangles.

use glam::DVec3;

/// Squares of distances beyond this may overflow or vanish in what follows.
const PLAIN: std::ops::RangeInclusive<f64> = 1e-200..=1e200;

/// An upper bound of the gap of the triangle with corners `a`, `b`, `c` relative to the observer; infinity where the
/// triangle is not small against its distance.
///
/// # Derivation
///
/// In the triangle's plane no second derivative of the distance `r` is larger than `1/r`. With `m` its largest there and
/// all corners within `R` of a point `o`, `u = m |x - o|^2 / 2` minus `r` is convex, and so above itself when it is
/// interpolated between the corners; what interpolating does to `u` alone is at most `m R^2 / 2`. By Jung's theorem
/// `R^2 <= L^2 / 3`, `L` the longest edge, and nothing in the triangle is nearer than `|a| - L`.
pub(crate) fn gap_ceiling([a, b, c]: [DVec3; 3]) -> f64 {
    let distance_squared = a.length_squared();
    let squares = [b - a, c - b, a - c].map(DVec3::length_squared);
    let longest_squared = squares[0].max(squares[1]).max(squares[2]);
    // Written so that NaN is refused.
    if !(PLAIN.contains(&distance_squared) && 4.0 * longest_squared <= distance_squared) {
        return f64::INFINITY;
    }
    let nearest = distance_squared.sqrt() - longest_squared.sqrt();
    // A dozen roundings, of which the difference at most doubles the relative size.
    longest_squared / (6.0 * nearest) * (1.0 + 32.0 * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tessellate::triangle_gap;

    #[test]
    fn the_ceiling_is_above_the_gap_and_not_far() {
        let mut tightest: f64 = 0.0;
        for step in 0..2000 {
            let angle = |factor: f64| (f64::from(step) * factor).fract() * std::f64::consts::TAU;
            let place = DVec3::new(
                angle(0.618).sin(),
                angle(0.414).cos(),
                1.0 + angle(0.732).sin(),
            );
            let size = 0.5 * place.length() * 0.9f64.powi(step % 150);
            let corner = |shift: f64| {
                let (turn, tilt) = (angle(0.271 + shift), angle(0.577 + shift));
                place + 0.55 * size * DVec3::new(turn.cos(), turn.sin(), 0.3 * tilt.sin())
            };
            let corners = [corner(0.0), corner(0.13), corner(0.29)];
            let (ceiling, gap) = (
                gap_ceiling(corners),
                triangle_gap(corners[0], corners[1], corners[2]),
            );
            assert!(ceiling >= gap, "{corners:?}: {ceiling} {gap}");
            tightest = tightest.max(gap / ceiling);
        }
        assert!(tightest > 0.5, "{tightest}");
    }

    #[test]
    fn what_is_near_or_no_number_has_no_ceiling() {
        let near = [DVec3::X, DVec3::new(1.0, 2.0, 0.0), DVec3::Y];
        for corners in [
            near,
            [DVec3::ZERO; 3],
            [DVec3::NAN; 3],
            [DVec3::X * 1e160; 3],
        ] {
            assert_eq!(gap_ceiling(corners), f64::INFINITY, "{corners:?}");
        }
        assert_eq!(gap_ceiling([DVec3::X; 3]), 0.0);
    }
}
