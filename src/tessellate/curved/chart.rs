//! Charts of the triangles of a round shape: the curved patch over a triangle, by two parameters.

use std::array::from_fn;

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::sight::About;
use super::steps::{Derivatives, Steps, lesser};
use crate::shape::{Jet, MAX_SPAN, Piece, Spot, axes_of_turn};

/// A patch of a round shape with two parameters, which are linear functions of the weights of a triangle's corners.
#[derive(Clone, Copy, Debug)]
pub(super) enum Chart {
    /// The parameters of the piece.
    OfPiece(Piece),
    /// The side of a cone, unrolled: the parameters are the part of the way from the tip, times the turns from `turns`;
    /// and that part. No angle matters at the tip.
    Unrolled {
        radius: f64,
        height: f64,
        turns: f64,
    },
    /// A ball: the parameters are lengths in the plane of the flat triangle between unit vectors, from which rays from the
    /// centre meet the ball.
    Rays {
        radius: f64,
        origin: DVec3,
        axes: [DVec3; 2],
    },
}

/// A triangle of a round shape: a chart and the parameters of the corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) chart: Chart,
    pub(super) corners: [DVec2; 3],
}

impl Facet {
    /// The triangle between three spots of a piece.
    pub(super) fn new(piece: &Piece, spots: [&Spot; 3], about: About) -> Self {
        if let Piece::Ball { radius } = *piece {
            let [a, b, c] = spots.map(|spot| spot.at);
            let along = (b - a).normalize_or_zero();
            let across = (b - a).cross(c - a).normalize_or_zero().cross(along);
            let at = |p: DVec3| DVec2::new((p - a).dot(along), (p - a).dot(across));
            let corners = [DVec2::ZERO, at(b), at(c)];
            let axes = [along, across];
            return Self {
                chart: Chart::Rays {
                    radius,
                    origin: a,
                    axes,
                },
                corners,
            };
        }
        let mut corners = spots.map(|spot| piece.parameters(spot));
        let pole = (0..3).find(|&k| piece.is_pole(spots[k]));
        let first = if pole == Some(0) { 1 } else { 0 };
        let periods = piece.periods();
        for (axis, period) in periods.into_iter().enumerate() {
            for k in 0..3 {
                if period > 0.0 && k != first {
                    let step = corners[first][axis] - corners[k][axis];
                    corners[k][axis] += step.round();
                }
            }
        }
        if let Some(pole) = pole {
            corners[pole].x = 0.5 * (corners[(pole + 1) % 3].x + corners[(pole + 2) % 3].x);
        }
        if let (Piece::Slope { radius, height }, About::Surface) = (*piece, about) {
            let turns = (corners[0].x + corners[1].x + corners[2].x) / 3.0;
            let unrolled = corners.map(|q| DVec2::new(q.y * (q.x - turns), q.y));
            return Self {
                chart: Chart::Unrolled {
                    radius,
                    height,
                    turns,
                },
                corners: unrolled,
            };
        }
        Self {
            chart: Chart::OfPiece(*piece),
            corners,
        }
    }

    /// The corner that is the tip of a cone, unrolled.
    pub(super) fn tip(&self) -> Option<usize> {
        let is_unrolled = matches!(self.chart, Chart::Unrolled { .. });
        (0..3).find(|&k| is_unrolled && self.corners[k].y == 0.0)
    }

    /// The parameters at these weights of the corners.
    pub(super) fn at(&self, weights: [f64; 3]) -> DVec2 {
        let [a, b, c] = self.corners;
        a * weights[0] + b * weights[1] + c * weights[2]
    }
}

impl Chart {
    /// The place with these parameters.
    pub(super) fn place(&self, q: DVec2) -> DVec3 {
        match *self {
            Self::OfPiece(piece) => piece.place(q),
            Self::Unrolled {
                radius,
                height,
                turns,
            } => {
                let out = axes_of_turn(turns + aside(q)).0;
                radius * q.y * out + height * (0.5 - q.y) * DVec3::Y
            }
            Self::Rays {
                radius,
                origin,
                axes,
            } => (origin + axes[0] * q.x + axes[1] * q.y).normalize_or_zero() * radius,
        }
    }

    /// The place with its derivatives.
    pub(super) fn jet(&self, q: DVec2) -> Jet {
        match *self {
            Self::OfPiece(piece) => piece.jet(q),
            Self::Unrolled {
                radius,
                height,
                turns,
            } => {
                let aside = aside(q);
                let (out, along) = axes_of_turn(turns + aside);
                let bend = if q.y > 0.0 {
                    -out * (radius * TAU * TAU / q.y)
                } else {
                    DVec3::ZERO
                };
                Jet {
                    place: radius * q.y * out + height * (0.5 - q.y) * DVec3::Y,
                    first: [
                        radius * TAU * along,
                        radius * (out - along * (TAU * aside)) - height * DVec3::Y,
                    ],
                    second: [bend, -bend * aside, bend * (aside * aside)],
                }
            }
            Self::Rays {
                radius,
                origin,
                axes,
            } => {
                let y = origin + axes[0] * q.x + axes[1] * q.y;
                let r = y.length();
                let out = y / r;
                let along = axes.map(|axis| out.dot(axis));
                let across: [DVec3; 2] = from_fn(|k| axes[k] - out * along[k]);
                let second = |i: usize, j: usize| {
                    let turned = across[j] * along[i] + across[i] * along[j];
                    (turned + out * across[i].dot(across[j])) * (-radius / (r * r))
                };
                Jet {
                    place: out * radius,
                    first: from_fn(|k| across[k] * (radius / r)),
                    second: [second(0, 0), second(0, 1), second(1, 1)],
                }
            }
        }
    }

    /// Upper bounds of what derivatives make of steps, everywhere in a part around these parameters; infinite at the tip of a
    /// cone. `first` are the sizes of the first derivatives there.
    ///
    /// # Derivation
    ///
    /// **Unrolled**: with `t` the part of the way and `w` the turns aside, the place is linear in the parameters but for
    /// `t out(w)`. Its second derivatives are `-tau^2 / t out` times 1, `-w`, `w^2`; those of `w` are `1/t` and `-w/t`.
    ///
    /// **Rays**: second derivatives are sums of `2 (out.v) v_across + |v_across|^2 out` for steps `v`, divided by `r^2`. On
    /// a line at the distance `p` from the centre, at the angle `a` from its foot, the third derivative has the components
    /// `(6 cos^4 sin^2 - 3 cos^6) / p^3` and `6 cos^5 sin / p^3`. With `p = r cos` their squares add up to
    /// `cos^2 (36 sin^4 + 9 cos^4) / r^6`, at most `9 / r^6`. A symmetric form of three vectors is largest where they are
    /// one.
    pub(super) fn bounds(&self, q: DVec2, first: [f64; 2], steps: &Steps) -> Derivatives {
        let (second, third) = match *self {
            Self::OfPiece(piece) => piece.bounds(q, steps.half),
            Self::Unrolled { radius, .. } => {
                let (t, w) = least_and_aside(q, steps.half);
                if t <= 0.0 {
                    ([f64::INFINITY; 3], [f64::INFINITY; 4])
                } else {
                    let uu = radius * TAU * TAU / t;
                    let turned = TAU * w;
                    let third = [
                        TAU,
                        1.0 + turned,
                        w * (2.0 + turned),
                        w * w * (3.0 + turned),
                    ];
                    (
                        [uu, uu * w, uu * w * w],
                        third.map(|factor| factor * uu / t),
                    )
                }
            }
            Self::Rays {
                radius,
                origin,
                axes,
            } => {
                let y = origin + axes[0] * q.x + axes[1] * q.y;
                let (middle, reach) = (y.length(), steps.reach);
                let r = middle - reach;
                if r <= 0.0 {
                    return Derivatives::UNKNOWN;
                }
                // The direction out turns by at most reach / r.
                let along = DVec2::from_array(axes.map(|axis| y.dot(axis))).length();
                let along = (along / middle + reach / r).min(1.0);
                let second = radius / (r * r) * (1.0 + 4.0 * along * along).sqrt();
                let (length, bend) = (steps.length, steps.bend.length());
                return Derivatives {
                    of_bend: radius / r * bend,
                    second: second * length * length,
                    mixed: second * length * bend,
                    third: 4.0 * radius / (r * r * r) * length.powi(3),
                };
            }
        };
        let turns = self.turns(q, steps.half);
        let longest = |k: usize| {
            let change = second[k] * steps.half.x + second[k + 1] * steps.half.y;
            first[k] + lesser(change, turns[k])
        };
        let (DVec2 { x, y }, bend) = (steps.sizes, steps.bend);
        let [uu, uv, vv] = [second[0] * x * x, second[1] * x * y, second[2] * y * y];
        let spread = steps.spread;
        let half = 0.5 * (uu + vv);
        let largest = half + (0.25 * (uu - vv) * (uu - vv) + uv * uv).sqrt();
        let [a, b, c, d] = [
            third[0] * x * x * x,
            third[1] * x * x * y,
            third[2] * x * y * y,
            third[3] * y * y * y,
        ];
        // The largest x^2 y with x^2 + y^2 = 1 is 2 / sqrt(27).
        let together = a.max(d) * spread + 1.1548 * (b + c) * spread * spread.sqrt();
        Derivatives {
            of_bend: longest(0) * bend.x + longest(1) * bend.y,
            second: lesser(largest * spread, uu + 2.0 * uv + vv),
            mixed: second[0] * x * bend.x
                + second[1] * (x * bend.y + y * bend.x)
                + second[2] * y * bend.y,
            third: lesser(together, a + 3.0 * (b + c) + d),
        }
    }

    /// How much the first derivatives change at most between the middle of a box and any place of it, where that is known
    /// without second derivatives; infinite elsewhere.
    pub(super) fn turns(&self, q: DVec2, half: DVec2) -> [f64; 2] {
        match *self {
            Self::Unrolled { radius, .. } => {
                let turned = 2.0 * TAU * least_and_aside(q, half).1;
                [radius * TAU * turned, radius * turned * (2.0 + turned)]
            }
            _ => [f64::INFINITY; 2],
        }
    }
}

/// The turns from the middle of an unrolled chart.
fn aside(q: DVec2) -> f64 {
    if q.y != 0.0 { q.x / q.y } else { 0.0 }
}

/// The least part of the way from the tip in a box, and the most turns aside; a triangle never spans more than
/// [`MAX_SPAN`].
fn least_and_aside(q: DVec2, half: DVec2) -> (f64, f64) {
    let least = (q.y - half.y).max(0.0);
    (least, ((q.x.abs() + half.x) / least).min(MAX_SPAN))
}
