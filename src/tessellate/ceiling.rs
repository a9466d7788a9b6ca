//! Very cheap bounds on a triangle's gap and on the number of triangles that it needs. They settle most triangles of a
//! large mesh.

use glam::DVec3;

use super::Motion;

/// Range of squared distances for which the products below neither overflow nor vanish.
const PLAIN: std::ops::RangeInclusive<f64> = 1e-200..=1e200;

/// Where the square of the shortest side is less than this fraction of the square of the longest side, the largest
/// angle is not known accurately.
const NEEDLE: f64 = 1e-6;

/// The square of the ratio of distance to size from which on a single place tells the integral.
const SMALL: f64 = 100.0;

/// Room for rounding errors: a dozen operations, and a thousand epsilon for the angle of a triangle that is almost a
/// needle.
const UP: f64 = 1.0 + 1e-11;

/// Cheap bounds for a triangle that is small compared with its distance from the observer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ceilings {
    /// An upper bound on the triangle's gap, a length in the rest frame.
    pub(crate) gap: f64,
    /// An upper bound on the integral of `2 h / r^2` over the triangle, where `h` is the distance of its plane from the
    /// observer and `r` that of the point; also a length in the rest frame.
    pub(crate) area: f64,
    /// The integral of `2 h share / r^2` over the triangle, to a hundredth, with the share of `motion`, or 1 for points;
    /// NaN for a triangle that is not small enough for a single place to tell it.
    pub(crate) integral: f64,
}

impl Ceilings {
    /// The bounds for a triangle that is not small compared with its distance.
    pub(crate) const UNKNOWN: Self = Self {
        gap: f64::INFINITY,
        area: f64::INFINITY,
        integral: f64::NAN,
    };
}

/// The bounds for the triangle whose corners have the offsets `a`, `b`, `c` from the observer, in the rest frame;
/// infinity where the triangle is not small compared with its distance. The computation has no branch.
///
/// # Derivation
///
/// In the triangle's plane no second derivative of the distance `r` is larger than `1/r`. Let `m` be the largest `1/r`
/// on the triangle, let all corners lie within the radius `R` of a point `o`, and let `u = m |x - o|^2 / 2`. The
/// function `u - r` is convex, so its interpolation between the corners is nowhere below the function itself. The gap
/// is therefore at most the interpolation of `u` minus `u`, which is at most `m R^2 / 2`. Let `L` be the longest side
/// and `C` the angle opposite. The smallest circle around the triangle has `R = L / 2` if `C` is obtuse, else
/// `R = L / (2 sin C)`; in any triangle `R^2 <= L^2 / 3` (Jung's theorem). No point of the triangle is nearer to the
/// observer than `|a| - L`.
#[inline(always)]
pub(crate) fn ceilings([a, b, c]: [DVec3; 3], motion: Option<&Motion>) -> Ceilings {
    let distance_squared = a.length_squared();
    let (ab, ac) = (b - a, c - a);
    let [p, q, s] = [ab, ac, c - b].map(DVec3::length_squared);
    let longest = larger(larger(p, q), s);
    let shortest = -larger(larger(-p, -q), -s);
    let middle = larger(larger(smaller(p, q), smaller(q, s)), smaller(p, s));
    // `twice_product` is 2 |v| |w| cos C for the two shorter sides v and w. Its square divided by 4 v^2 w^2 is cos^2 C,
    // from 0 to 1/4.
    let twice_product = larger(shortest + middle - longest, 0.0);
    let four_sines = 4.0 - twice_product * twice_product / (shortest * middle);
    let four_sines = if shortest >= NEEDLE * longest {
        larger(four_sines, 3.0)
    } else {
        3.0
    };
    let nearest = distance_squared.sqrt() - longest.sqrt();
    let normal = ab.cross(ac);
    let twice_volume = a.dot(normal).abs();
    let middle_of_all = a + (ab + ac) / 3.0;
    let middle_squared = middle_of_all.length_squared();
    let share = match motion {
        Some(motion) => motion.share(normal, middle_of_all / middle_squared.sqrt()),
        None => 1.0,
    };
    // The rounding error of the volume is relative to its terms.
    let rounded = 64.0 * f64::EPSILON * distance_squared.sqrt() * longest;
    // Written so that NaN gives `UNKNOWN`.
    let known = PLAIN.contains(&distance_squared) && 4.0 * longest <= distance_squared;
    if known {
        Ceilings {
            gap: longest / (2.0 * four_sines * nearest) * UP,
            area: (twice_volume + rounded) / (nearest * nearest) * UP,
            integral: match SMALL * longest <= distance_squared {
                true => twice_volume * share / middle_squared,
                false => f64::NAN,
            },
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
                ceilings(corners, None).gap,
                triangle_gap(corners[0], corners[1], corners[2]),
            );
            assert!(ceiling >= gap, "{corners:?}: {ceiling} {gap}");
            tightest = tightest.max(gap / ceiling);
        }
        assert!(tightest > 0.5, "{tightest}");
    }

    /// For small triangles of every shape across the line of sight the ceiling equals the gap wherever the largest
    /// angle is known accurately, except for a small excess because the near side is nearer.
    #[test]
    fn across_the_line_of_sight_the_ceiling_is_the_gap() {
        let size = 1e-4;
        let at = |x: f64, y: f64| DVec3::new(size * x, size * y, 1.0);
        for i in 0..=40 {
            for j in 1..=40 {
                // These are all shapes whose longest side is the one from (0, 0) to (1, 0), with obtuse, right and
                // acute angles.
                let (x, y) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                if x.hypot(y) > 1.0 || (1.0 - x).hypot(y) > 1.0 {
                    continue;
                }
                let [a, b, c] = [at(0.0, 0.0), at(1.0, 0.0), at(x, y)];
                for corners in [[a, b, c], [b, c, a], [c, b, a]] {
                    let [p, q, r] = corners;
                    let (ceiling, gap) = (ceilings(corners, None).gap, triangle_gap(p, q, r));
                    assert!(ceiling >= gap, "{x} {y}: {ceiling} {gap}");
                    // The room is three times the longest side divided by the distance.
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
            assert_eq!(ceilings(corners, None).gap, f64::INFINITY, "{corners:?}");
        }
        // A triangle that is a single point has no angles, and its gap is zero.
        assert_eq!(ceilings([DVec3::X; 3], None).gap, 0.0);
    }
}
