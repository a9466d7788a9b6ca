//! Bounds of a triangle's gap and of the triangles it needs that cost next to nothing, to pass over most of many
//! triangles.

use glam::DVec3;

/// Squares of distances beyond this may overflow or vanish in what follows.
const PLAIN: std::ops::RangeInclusive<f64> = 1e-200..=1e200;

/// Of squares of sides: where the shortest is less than this part of the longest, the largest angle is not known well.
const NEEDLE: f64 = 1e-6;

/// Room for the roundings: of a dozen operations, and of the angle of what is all but a needle, of a thousand epsilon.
const UP: f64 = 1.0 + 1e-11;

/// What is known at once of a triangle that is small against its distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ceilings {
    /// Never below its gap.
    pub(crate) gap: f64,
    /// Never below the integral of `2 h / r^2` over it, `h` the distance of its plane.
    pub(crate) area: f64,
}

impl Ceilings {
    /// Of a triangle that is not small against its distance.
    pub(crate) const UNKNOWN: Self = Self {
        gap: f64::INFINITY,
        area: f64::INFINITY,
    };
}

/// Both bounds of the triangle with corners `a`, `b`, `c` relative to the observer; infinity where the triangle is not
/// small against its distance. Without a branch.
///
/// # Derivation
///
/// In the triangle's plane no second derivative of the distance `r` is larger than `1/r`. With `m` its largest there and
/// all corners within `R` of a point `o`, `u = m |x - o|^2 / 2` minus `r` is convex, and so above itself when it is
/// interpolated between the corners; what interpolating does to `u` alone is at most `m R^2 / 2`. The smallest circle
/// has `R = L / 2`, `L` the longest side, where the angle `C` across is obtuse, else `R = L / (2 sin C)`; in any
/// triangle `R^2 <= L^2 / 3` (Jung). Nothing in the triangle is nearer than `|a| - L`.
#[inline(always)]
pub(crate) fn ceilings([a, b, c]: [DVec3; 3]) -> Ceilings {
    let distance_squared = a.length_squared();
    let (ab, ac) = (b - a, c - a);
    let [p, q, s] = [ab, ac, c - b].map(DVec3::length_squared);
    let longest = larger(larger(p, q), s);
    let shortest = -larger(larger(-p, -q), -s);
    let middle = larger(larger(smaller(p, q), smaller(q, s)), smaller(p, s));
    // 2 |v| |w| cos C of the two shorter sides, squared over 4 of their squares: cos^2 C, from 0 to 1/4.
    let twice_product = larger(shortest + middle - longest, 0.0);
    let four_sines = 4.0 - twice_product * twice_product / (shortest * middle);
    let four_sines = if shortest >= NEEDLE * longest {
        larger(four_sines, 3.0)
    } else {
        3.0
    };
    let nearest = distance_squared.sqrt() - longest.sqrt();
    let twice_volume = a.dot(ab.cross(ac)).abs();
    // The volume's roundings are of its terms.
    let rounded = 64.0 * f64::EPSILON * distance_squared.sqrt() * longest;
    // Written so that NaN is refused.
    let known = PLAIN.contains(&distance_squared) && 4.0 * longest <= distance_squared;
    if known {
        Ceilings {
            gap: longest / (2.0 * four_sines * nearest) * UP,
            area: (twice_volume + rounded) / (nearest * nearest) * UP,
        }
    } else {
        Ceilings::UNKNOWN
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::super::triangle_gap;
    use super::*;

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
                ceilings(corners).gap,
                triangle_gap(corners[0], corners[1], corners[2]),
            );
            assert!(ceiling >= gap, "{corners:?}: {ceiling} {gap}");
            tightest = tightest.max(gap / ceiling);
        }
        assert!(tightest > 0.5, "{tightest}");
    }

    /// Small triangles of every shape across the line of sight: there the ceiling is the gap, but for the little by
    /// which the near side is nearer, wherever the largest angle is known well.
    #[test]
    fn across_the_line_of_sight_the_ceiling_is_the_gap() {
        let size = 1e-4;
        let at = |x: f64, y: f64| DVec3::new(size * x, size * y, 1.0);
        for i in 0..=40 {
            for j in 1..=40 {
                // All shapes whose longest side is the one from (0, 0) to (1, 0), with obtuse, right and acute angles.
                let (x, y) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                if x.hypot(y) > 1.0 || (1.0 - x).hypot(y) > 1.0 {
                    continue;
                }
                let [a, b, c] = [at(0.0, 0.0), at(1.0, 0.0), at(x, y)];
                for corners in [[a, b, c], [b, c, a], [c, b, a]] {
                    let [p, q, r] = corners;
                    let (ceiling, gap) = (ceilings(corners).gap, triangle_gap(p, q, r));
                    assert!(ceiling >= gap, "{x} {y}: {ceiling} {gap}");
                    // The longest side and its square against the distance, three times.
                    assert!(
                        ceiling <= gap * (1.0 + 3.0 * size),
                        "{x} {y}: {ceiling} {gap}"
                    );
                }
            }
        }
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
            assert_eq!(ceilings(corners).gap, f64::INFINITY, "{corners:?}");
        }
        // A point has no angles.
        assert_eq!(ceilings([DVec3::X; 3]).gap, 0.0);
    }
}
