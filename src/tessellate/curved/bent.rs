//! A chart of a triangle in which flat and curved places with equal parameters lie opposite each other.

use std::array::from_fn;

use glam::{DVec2, DVec3};

use super::chart::{Chart, Facet};
use super::sight::Sight;
use crate::shape::Jet;

/// How often the middle of a side is moved.
const MOVES: usize = 2;

/// A chart whose parameters are the weights of the second and the third corner. In the middle of each side it is bent, so
/// that the curved place is seen beside the flat one along the flat triangle's normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    facet: Facet,
    /// How far the middle of the side opposite each corner is moved, in parameters of the facet's chart.
    moved: [DVec2; 3],
}

/// How a side follows the arc of a rim.
#[derive(Clone, Copy, Debug)]
pub(super) enum Arc {
    /// As it is.
    OfFacet,
    /// By a parabola whose middle is moved so far.
    Moved(DVec2),
}

impl Bent {
    /// The weights as they are.
    pub(super) fn straight(facet: Facet) -> Self {
        Self {
            facet,
            moved: [DVec2::ZERO; 3],
        }
    }

    /// The triangle is `seen` with these corners; a side opposite a corner that is a chord of a rim is bent into its arc.
    pub(super) fn new(
        facet: Facet,
        sight: &Sight,
        seen: [DVec3; 3],
        rims: [Option<Arc>; 3],
    ) -> Self {
        let mut bent = Self::straight(facet);
        let normal = (seen[1] - seen[0])
            .cross(seen[2] - seen[0])
            .normalize_or_zero();
        let flat = |vector: DVec3| vector - normal * normal.dot(vector);
        let [a, b, c] = facet.corners;
        let size = (a - b).abs().max((b - c).abs()).max((c - a).abs());
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            match rims[k] {
                Some(Arc::Moved(by)) => {
                    bent.moved[k] = by;
                    continue;
                }
                Some(Arc::OfFacet) => continue,
                None => {}
            }
            let (middle, opposite) = (
                0.5 * (facet.corners[i] + facet.corners[j]),
                0.5 * (seen[i] + seen[j]),
            );
            for _ in 0..MOVES {
                let q = middle + bent.moved[k];
                let jet = facet.chart.jet(q);
                let aside = flat(sight.seen_nearly(jet.place) - opposite);
                let offset = sight.offset(jet.place);
                let jacobian = sight.jacobian_vector(offset.normalize_or_zero());
                let [u, v] = jet.first.map(|first| {
                    let first = sight.at_rest(first);
                    flat(first + sight.motion * jacobian.dot(first))
                });
                let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
                let determinant = uu * vv - uv * uv;
                let (x, y) = (u.dot(aside), v.dot(aside));
                let step = DVec2::new(x * vv - y * uv, y * uu - x * uv) / determinant;
                if !(determinant > 1e-12 * uu * vv && step.abs().cmple(0.5 * size).all()) {
                    break;
                }
                bent.moved[k] -= step;
            }
        }
        bent
    }

    fn parameters(&self, w: DVec2) -> DVec2 {
        let l = [1.0 - w.x - w.y, w.x, w.y];
        let [a, b, c] = self.moved;
        self.facet.at(l) + 4.0 * (a * (l[1] * l[2]) + b * (l[2] * l[0]) + c * (l[0] * l[1]))
    }

    /// The derivatives of the parameters of the facet's chart.
    fn first(&self, w: DVec2) -> [DVec2; 2] {
        let l = [1.0 - w.x - w.y, w.x, w.y];
        let [p, q, r] = self.facet.corners;
        let [a, b, c] = self.moved;
        [
            q - p + 4.0 * ((a - b) * l[2] + c * (l[0] - l[1])),
            r - p + 4.0 * ((a - c) * l[1] + b * (l[0] - l[2])),
        ]
    }

    fn second(&self) -> [DVec2; 3] {
        let [a, b, c] = self.moved;
        [-8.0 * c, 4.0 * (a - b - c), -8.0 * b]
    }

    /// The place at these weights.
    pub(super) fn place(&self, w: DVec2) -> DVec3 {
        self.facet.chart.place(self.parameters(w))
    }

    /// The place with its derivatives, and bounds of second and third derivatives over a box, as [`Chart::bounds`]; last how
    /// much first derivatives change at most from the middle of the box.
    pub(super) fn look(&self, w: DVec2, half: DVec2) -> (Jet, [f64; 3], [f64; 4], [f64; 2]) {
        let chart: &Chart = &self.facet.chart;
        let q = self.parameters(w);
        let jet = chart.jet(q);
        let (first, second) = (self.first(w), self.second());
        let [u, v] = jet.first;
        let [uu, uv, vv] = jet.second;
        let of = |a: DVec2, b: DVec2, s: DVec2| {
            uu * (a.x * b.x) + uv * (a.x * b.y + a.y * b.x) + vv * (a.y * b.y) + u * s.x + v * s.y
        };
        let bent = Jet {
            place: jet.place,
            first: from_fn(|k| u * first[k].x + v * first[k].y),
            second: [
                of(first[0], first[0], second[0]),
                of(first[0], first[1], second[1]),
                of(first[1], first[1], second[2]),
            ],
        };
        // Sizes of the derivatives of the parameters in the box.
        let s = second.map(|s| s.abs());
        let change = [s[0] * half.x + s[1] * half.y, s[1] * half.x + s[2] * half.y];
        let f = [first[0].abs() + change[0], first[1].abs() + change[1]];
        let q_half = f[0] * half.x + f[1] * half.y;
        let (c, t) = chart.bounds(q, q_half);
        let turns = chart.turns(q, q_half);
        let sizes = [u.length(), v.length()];
        let longest = [
            sizes[0] + lesser(c[0] * q_half.x + c[1] * q_half.y, turns[0]),
            sizes[1] + lesser(c[1] * q_half.x + c[2] * q_half.y, turns[1]),
        ];
        let one = |s: DVec2| longest[0] * s.x + longest[1] * s.y;
        let two = |a: DVec2, b: DVec2| {
            c[0] * a.x * b.x + c[1] * (a.x * b.y + a.y * b.x) + c[2] * a.y * b.y
        };
        let three = |a: DVec2, b: DVec2, d: DVec2| {
            t[0] * a.x * b.x * d.x
                + t[1] * (a.x * b.x * d.y + a.x * b.y * d.x + a.y * b.x * d.x)
                + t[2] * (a.x * b.y * d.y + a.y * b.x * d.y + a.y * b.y * d.x)
                + t[3] * a.y * b.y * d.y
        };
        let of_second = [
            two(f[0], f[0]) + one(s[0]),
            two(f[0], f[1]) + one(s[1]),
            two(f[1], f[1]) + one(s[2]),
        ];
        let of_third = [
            three(f[0], f[0], f[0]) + 3.0 * two(s[0], f[0]),
            three(f[0], f[0], f[1]) + two(s[0], f[1]) + 2.0 * two(s[1], f[0]),
            three(f[0], f[1], f[1]) + two(s[2], f[0]) + 2.0 * two(s[1], f[1]),
            three(f[1], f[1], f[1]) + 3.0 * two(s[2], f[1]),
        ];
        let turned = from_fn(|k| {
            let by_chart = turns[0] * f[k].x + turns[1] * f[k].y;
            let by_bend = sizes[0] * change[k].x + sizes[1] * change[k].y;
            let by_second = of_second[k] * half.x + of_second[k + 1] * half.y;
            lesser(by_second, by_chart + by_bend)
        });
        (bent, of_second, of_third, turned)
    }
}

/// The smaller of two bounds; one that is not a number is none.
fn lesser(a: f64, b: f64) -> f64 {
    match a <= b {
        true => a,
        false if b.is_nan() => f64::INFINITY,
        false => b,
    }
}
