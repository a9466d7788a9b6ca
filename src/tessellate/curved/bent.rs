//! A chart of a triangle in which flat and curved places with equal parameters lie opposite each other.

use glam::{DVec2, DVec3};

use super::chart::{Chart, Facet};
use super::frame::Frame;
use super::sight::Sight;
use super::steps::{Steps, lesser};
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

    /// The place at the middle of a frame with its derivatives by the frame's directions, and bounds of second and third
    /// derivatives in the unit disc of the frame; last how much first derivatives change at most from the middle.
    pub(super) fn look(&self, frame: &Frame) -> Look {
        let chart: &Chart = &self.facet.chart;
        let q = self.parameters(frame.middle);
        let jet = chart.jet(q);
        let (by_weights, bend) = (self.first(frame.middle), self.second());
        let [e, f] = frame.axes;
        let q_first = frame
            .axes
            .map(|axis| by_weights[0] * axis.x + by_weights[1] * axis.y);
        let q_second = [(e, e), (e, f), (f, f)].map(|(a, b)| {
            bend[0] * (a.x * b.x) + bend[1] * (a.x * b.y + a.y * b.x) + bend[2] * (a.y * b.y)
        });
        let [u, v] = jet.first;
        let [uu, uv, vv] = jet.second;
        let of = |a: DVec2, b: DVec2, s: DVec2| {
            uu * (a.x * b.x) + uv * (a.x * b.y + a.y * b.x) + vv * (a.y * b.y) + u * s.x + v * s.y
        };
        let steps = Steps::new(q_first, q_second);
        let sizes = [u.length(), v.length()];
        let bounds = chart.bounds(q, sizes, &steps);
        let turns = chart.turns(q, steps.half);
        let by_turns = turns[0] * steps.sizes.x
            + turns[1] * steps.sizes.y
            + sizes[0] * steps.bend.x
            + sizes[1] * steps.bend.y;
        let second = bounds.second + bounds.of_bend;
        Look {
            jet: Jet {
                place: jet.place,
                first: q_first.map(|a| u * a.x + v * a.y),
                second: [
                    of(q_first[0], q_first[0], q_second[0]),
                    of(q_first[0], q_first[1], q_second[1]),
                    of(q_first[1], q_first[1], q_second[2]),
                ],
            },
            third: bounds.third + 3.0 * bounds.mixed,
            turned: lesser(second, by_turns),
            is_linear: second <= by_turns || by_turns.is_nan(),
        }
    }
}

/// A place with its derivatives by the directions of a frame, and bounds in the frame's unit disc.
pub(super) struct Look {
    pub(super) jet: Jet,
    /// Of the third derivatives along unit steps.
    pub(super) third: f64,
    /// How much the first derivatives change from the middle, and whether in a smaller disc they change less in proportion.
    pub(super) turned: f64,
    pub(super) is_linear: bool,
}
