//! The vertices of a round shape, one after the other: each makes a triangle of the wanted size on an edge that is right.
//!
//! The net is kept Delaunay in the metric. The next triangle to be divided is the one whose shortest side is nearest to the
//! wanted length. Good triangles grow from good edges, in the order of an advancing front.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::net::{Net, Placed, Task, half_edges_of, next, previous, triangle_of};
use crate::shape::Spot;

/// The least distance of a new vertex from others, in wanted lengths: one that makes a triangle, one in the middle of a
/// circle or of a long side, and any from a rim.
const CLOSE: f64 = 0.7;
const CLOSE_AT_CENTER: f64 = 0.5;
const CLOSE_TO_RIM: f64 = 0.45;

/// Up to this length a side carries a new triangle; from the second one on a vertex is put beside its start instead.
const SHORT: f64 = 1.6;
const LONG: f64 = 2.5;

/// A triangle that is farther from the photosurface than this, and whose sides are all shorter, is not one that the metric
/// knows; it is left to [`Net::refine`].
const KNOWN: f64 = 1.5;
const KNOWN_LENGTH: f64 = 1.75;

/// Limits on steps of a walk and on turns of edges after one change.
const STEPS: usize = 50;
const TURNS: usize = 500;

/// A number, the larger the sooner its triangle is looked at.
#[derive(PartialEq)]
pub(super) struct Turn(pub(super) f64, pub(super) usize);

impl Eq for Turn {}

impl PartialOrd for Turn {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Turn {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl Net<'_> {
    /// Adds vertices until each triangle that the metric knows is near enough, or until there are more triangles than
    /// `most`.
    pub(super) fn advance(&mut self, most: usize) {
        let mut queue: BinaryHeap<Turn> =
            (0..self.triangles.len()).map(|t| self.turn_of(t)).collect();
        let mut edges = half_edges_of(&(0..self.triangles.len()).collect::<Vec<_>>());
        let mut touched = vec![];
        self.settle(&mut edges, &mut touched);
        touched.into_iter().for_each(|triangle| {
            self.update(triangle);
            queue.push(self.turn_of(triangle));
        });
        while let Some(Turn(order, triangle)) = queue.pop() {
            if self.triangles.len() > most {
                return;
            }
            let is_current = order == self.turn_of(triangle).0;
            if !is_current || !(self.estimates[triangle].whole > 1.0) {
                continue;
            }
            let Some((home, spot)) = self.place_for_vertex(triangle) else {
                continue;
            };
            let made = self.insert(home, spot);
            let mut edges = made.map(|triangle| 3 * triangle as u32).to_vec();
            let mut touched = made.to_vec();
            self.settle(&mut edges, &mut touched);
            touched.sort_unstable();
            touched.dedup();
            for triangle in touched {
                self.update(triangle);
                queue.push(self.turn_of(triangle));
            }
        }
    }

    fn turn_of(&self, triangle: usize) -> Turn {
        Turn(
            -(self.shortest(triangle).0 / self.task.aim).ln().abs(),
            triangle,
        )
    }

    /// The length of the shortest side, and its half-edge.
    fn shortest(&self, triangle: usize) -> (f64, u32) {
        let sides = [0, 1, 2].map(|k| {
            let half_edge = (3 * triangle + k) as u32;
            (self.length_of(half_edge), half_edge)
        });
        sides.into_iter().fold(
            sides[0],
            |best, side| if side.0 < best.0 { side } else { best },
        )
    }

    fn length_of(&self, half_edge: u32) -> f64 {
        let of = self.of[triangle_of(half_edge)];
        self.length_squared(self.start(half_edge), self.end(half_edge), of)
            .sqrt()
    }

    /// A place for a new vertex that makes a triangle smaller, and the triangle that it is in.
    fn place_for_vertex(&self, triangle: usize) -> Option<(usize, Spot)> {
        let (length, half_edge) = self.shortest(triangle);
        let sides = [half_edge, next(half_edge), previous(half_edge)];
        let lengths = sides.map(|side| self.length_of(side));
        let longest = (0..3).fold(0, |k, other| {
            if lengths[other] > lengths[k] {
                other
            } else {
                k
            }
        });
        if lengths[longest] <= KNOWN_LENGTH * self.task.aim
            && self.estimates[triangle].whole >= KNOWN
        {
            return None;
        }
        let side = Task::side_of(self.of[triangle]);
        let corners = sides.map(|e| &self.vertices[self.start(e) as usize]);
        let [a, b, c] = corners.map(|vertex| vertex.place);
        let metrics = corners.map(|vertex| vertex.metric[side]);
        let along = b - a;
        let on_edge = if length < SHORT * self.task.aim {
            let metric = metrics[0] + metrics[1];
            let across = c - 0.5 * (a + b);
            let across = across - along * (along.dot(metric * across) / along.dot(metric * along));
            let height = (self.task.aim * self.task.aim - 0.25 * length * length)
                .max(0.25 * self.task.aim * self.task.aim)
                .sqrt();
            let size = (0.5 * across.dot(metric * across)).sqrt();
            Some(0.5 * (a + b) + across * (height / size).min(2.0))
        } else if length > LONG * self.task.aim {
            Some(a + along * (self.task.aim / length) + 0.02 * (c - 0.5 * (a + b)))
        } else {
            None
        };
        let metric = metrics[0] + metrics[1] + metrics[2];
        let (u, v) = (b - a, c - a);
        let (uu, uv, vv) = (u.dot(metric * u), u.dot(metric * v), v.dot(metric * v));
        let center =
            a + (u * (vv * (uu - uv)) + v * (uu * (vv - uv))) / (2.0 * (uu * vv - uv * uv));
        // In a long triangle both may be beside others, or on another one.
        let ends = [[a, b], [b, c], [c, a]][longest];
        let middle = (lengths[longest] > LONG * self.task.aim).then_some(0.5 * (ends[0] + ends[1]));
        let places = on_edge
            .map(|place| (place, CLOSE))
            .into_iter()
            .chain([(center, CLOSE_AT_CENTER)])
            .chain(middle.map(|place| (place, CLOSE_AT_CENTER)));
        places
            .filter(|(place, _)| place.is_finite())
            .find_map(|(place, close)| self.room_at(triangle, place, close * self.task.aim, a))
    }

    /// The spot next to a place and the triangle that it is in, if no other vertex is closer. Distances are those of the
    /// metric at the vertex at `near`, a corner of the triangle to start from.
    fn room_at(
        &self,
        triangle: usize,
        place: DVec3,
        close: f64,
        near: DVec3,
    ) -> Option<(usize, Spot)> {
        let of = self.of[triangle];
        let spot = self.task.pieces[of as usize].spot_near(place);
        let place = self.task.pieces[of as usize].place_of(&spot);
        let placed = (&spot, place);
        let home = self.triangle_at(triangle, placed)?;
        let corners = self.triangles[home];
        let around = corners.map(|corner| self.placed(corner));
        if self.of[home] != of
            || !(0..3).all(|k| self.faces_outwards([around[k], around[(k + 1) % 3], placed], of))
        {
            return None;
        }
        let side = Task::side_of(of);
        let metric = self.triangles[triangle].map(|corner| &self.vertices[corner as usize]);
        let metric = metric
            .into_iter()
            .find(|vertex| vertex.place == near)?
            .metric[side];
        let length = |step: DVec3| step.dot(metric * step).sqrt();
        let distance = |vertex: u32| length(self.vertices[vertex as usize].place - place);
        let opposite = [0, 1, 2].map(|k| self.start(previous(self.twin((3 * home + k) as u32))));
        if corners
            .into_iter()
            .chain(opposite)
            .any(|vertex| distance(vertex) <= close)
        {
            return None;
        }
        let beside_rim = (0..3).any(|k| {
            let half_edge = (3 * home + k) as u32;
            let [from, to] = [self.start(half_edge), self.end(half_edge)]
                .map(|v| self.vertices[v as usize].place);
            let along = to - from;
            let part = along.dot(metric * (place - from)) / along.dot(metric * along);
            self.is_rim(half_edge)
                && length(from + along * part.clamp(0.0, 1.0) - place)
                    < CLOSE_TO_RIM * self.task.aim
        });
        (!beside_rim).then_some((home, spot))
    }

    /// The triangle that a spot of a piece lies in, found by a walk; `None` beyond a rim.
    fn triangle_at(&self, start: usize, spot: Placed<'_>) -> Option<usize> {
        let (mut triangle, mut before) = (start, usize::MAX);
        for _ in 0..STEPS {
            let mut worst = (0.0, None);
            for k in 0..3 {
                let half_edge = (3 * triangle + k) as u32;
                let ends = [self.start(half_edge), self.end(half_edge)];
                let side = self.side_of_line(ends, spot, self.of[triangle]);
                if side < worst.0 && triangle_of(self.twin(half_edge)) != before {
                    worst = (side, Some(half_edge));
                }
            }
            let Some(half_edge) = worst.1 else {
                return Some(triangle);
            };
            if self.is_rim(half_edge) {
                return None;
            }
            before = triangle;
            triangle = triangle_of(self.twin(half_edge));
        }
        None
    }

    /// Turns edges until the net is Delaunay in the metric around the ones in the list; adds the triangles that have changed.
    fn settle(&mut self, edges: &mut Vec<u32>, touched: &mut Vec<usize>) {
        let mut left = TURNS + edges.len();
        while let Some(half_edge) = edges.pop() {
            left -= 1;
            if left == 0 {
                return;
            }
            if self.is_delaunay(half_edge) {
                continue;
            }
            let of = self.of[triangle_of(half_edge)];
            let Some(made) = self.turned(half_edge) else {
                continue;
            };
            if made.iter().all(|&corners| self.may_be(corners, of)) {
                let [t0, t1] = self.turn(half_edge, made);
                touched.extend([t0, t1]);
                edges.extend([3 * t0, 3 * t0 + 2, 3 * t1, 3 * t1 + 1].map(|e| e as u32));
            }
        }
    }

    /// Whether the two angles opposite an edge are together no more than half a turn, in the metric.
    fn is_delaunay(&self, half_edge: u32) -> bool {
        if self.is_rim(half_edge) {
            return true;
        }
        let twin = self.twin(half_edge);
        let side = Task::side_of(self.of[triangle_of(half_edge)]);
        let ends = [half_edge, twin, previous(half_edge), previous(twin)];
        let vertices = ends.map(|e| &self.vertices[self.start(e) as usize]);
        let metric = vertices[0].metric[side]
            + vertices[1].metric[side]
            + vertices[2].metric[side]
            + vertices[3].metric[side];
        let [a, b, c, d] = vertices.map(|vertex| vertex.place);
        let angle = |corner: DVec3| {
            let (x, y) = (a - corner, b - corner);
            let cosine = x.dot(metric * y);
            let sine = x.dot(metric * x) * y.dot(metric * y) - cosine * cosine;
            (cosine, sine.max(0.0).sqrt())
        };
        let ((cos_c, sin_c), (cos_d, sin_d)) = (angle(c), angle(d));
        let size = sin_c * sin_d + (cos_c * cos_d).abs();
        sin_c * cos_d + sin_d * cos_c >= -1e-9 * size
    }
}
