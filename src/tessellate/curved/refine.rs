//! What the front has left: edges divided and turned, vertices taken away and moved, by the distance from the photosurface.

use std::array::from_fn;
use std::collections::BinaryHeap;

use super::change::Division;
use super::chart::Facet;
use super::estimate::Estimate;
use super::front::Turn;
use super::net::{NONE, Net, half_edges_of, next, previous, triangle_of};
use super::sight::About;
use crate::shape::{Piece, Spot};

/// An edge is turned and a vertex moved only if the worse of its triangles becomes better than this fraction.
const BETTER: f64 = 0.999;

/// Triangles below these fractions of the allowed distance are not worth a turn or a move.
const GOOD: f64 = 0.05;
const GOOD_TO_STAY: f64 = 0.3;

/// Up to this fraction of the allowed distance there is room for taking a vertex of a triangle away.
const SLACK: f64 = 0.9;

/// The allowed fraction up to which vertices are taken away.
const FULL: f64 = 0.98;

/// The step of moved vertices, as a part of the way to the opposite side.
const STEP: f64 = 0.2;

/// Limit on turns of edges after one change.
const TURNS: usize = 200;

/// Which side of a triangle is divided that is not proven.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// The worst one if the triangle is estimated to be too far away, otherwise that which is seen longest.
    Worst,
    /// That which is seen longest: the triangles become small and round as they are seen.
    LongestAsSeen,
    /// That which is longest at rest: what is seen short may be long there, and bend.
    LongestAtRest,
}

impl Net<'_> {
    /// Turns an edge if that lessens the larger distance of its two triangles.
    fn improve(&mut self, half_edge: u32) -> Option<[usize; 2]> {
        let twin = self.twin(half_edge);
        let (t0, t1) = (triangle_of(half_edge), triangle_of(twin));
        let now = self.estimates[t0].whole.max(self.estimates[t1].whole);
        if now < GOOD {
            return None;
        }
        let made = self.turned(half_edge)?;
        let of = self.of[t0];
        let [_, d, c] = made[0];
        if self.divided.contains(&[c.min(d), c.max(d)]) {
            return None;
        }
        if !made.iter().all(|&corners| self.is_sound(corners, of)) {
            return None;
        }
        let [bc, ca, ad, db] = [
            next(half_edge),
            previous(half_edge),
            next(twin),
            previous(twin),
        ]
        .map(|e| self.is_rim(e));
        // The sides opposite the corners of [a, d, c] and of [d, b, c].
        let first = self.assess(made[0], of, [false, ca, ad]);
        if !(first.whole < BETTER * now) {
            return None;
        }
        let second = self.assess(made[1], of, [bc, false, db]);
        if !(second.whole < BETTER * now) {
            return None;
        }
        let turned = self.turn(half_edge, made);
        (self.estimates[turned[0]], self.estimates[turned[1]]) = (first, second);
        Some(turned)
    }

    /// Turns edges, these and those beside turned ones, but none at the vertex `but`; returns the triangles that have changed.
    fn improve_around(&mut self, mut edges: Vec<u32>, but: Option<u32>) -> Vec<usize> {
        let (mut changed, mut left) = (vec![], TURNS + edges.len());
        while let Some(half_edge) = edges.pop() {
            left -= 1;
            if left == 0 {
                break;
            }
            let is_kept =
                but.is_some_and(|v| self.start(half_edge) == v || self.end(half_edge) == v);
            if is_kept || !self.alive[triangle_of(half_edge)] {
                continue;
            }
            if let Some([t0, t1]) = self.improve(half_edge) {
                changed.extend([t0, t1]);
                edges.extend([3 * t0, 3 * t0 + 2, 3 * t1, 3 * t1 + 1].map(|e| e as u32));
            }
        }
        changed
    }

    /// Turns all edges that are better turned.
    fn improve_all(&mut self) {
        for half_edge in 0..3 * self.triangles.len() as u32 {
            if self.alive[triangle_of(half_edge)] && half_edge < self.twin(half_edge) {
                self.improve(half_edge);
            }
        }
    }

    /// Divides the worst sides until every triangle is near enough, or until there are more triangles than `most`.
    pub(super) fn refine(&mut self, most: usize) {
        self.improve_all();
        let all = (0..self.triangles.len()).filter(|&t| self.alive[t]);
        let mut queue: BinaryHeap<Turn> = all.map(|t| Turn(self.estimates[t].whole, t)).collect();
        while let Some(Turn(distance, triangle)) = queue.pop() {
            if !(distance > 1.0) || self.triangles.len() > most {
                return;
            }
            if self.alive[triangle] && self.estimates[triangle].whole == distance {
                for changed in self.divide(triangle) {
                    queue.push(Turn(self.estimates[changed].whole, changed));
                }
            }
        }
    }

    /// Divides the worst side of a triangle, and turns edges around it; returns the triangles that have changed.
    pub(super) fn divide(&mut self, triangle: usize) -> Vec<usize> {
        let worst = opposite_largest(triangle, self.estimates[triangle].sides);
        self.divide_at(worst, |net, half_edge| {
            net.keep_divided(half_edge);
            let made = net.split(half_edge);
            made.into_iter().for_each(|triangle| net.update(triangle));
            // Turned edges at the new vertex might make the same triangle again, and again.
            let changed =
                net.improve_around(half_edges_of(&made), Some(net.vertices.len() as u32 - 1));
            made.into_iter().chain(changed).collect()
        })
    }

    /// Divides a side of a triangle that is not proven; returns the triangles that have changed. `bound` is the bound of its
    /// distance as a fraction of what is allowed.
    pub(super) fn cut(
        &mut self,
        triangle: usize,
        (number, bound): (usize, f64),
        side: Side,
    ) -> Vec<usize> {
        let longest = match side {
            Side::Worst if self.estimates[triangle].whole > 1.0 => return self.divide(triangle),
            Side::Worst | Side::LongestAsSeen => {
                opposite_largest(triangle, self.lengths_as_seen(triangle, bound))
            }
            Side::LongestAtRest => opposite_largest(triangle, self.lengths_at_rest(triangle)),
        };
        self.divide_at(longest, |net, half_edge| {
            let made = net.split_as_seen(half_edge, number);
            made.into_iter().for_each(|triangle| net.update(triangle));
            made.to_vec()
        })
    }

    /// Divides a side by `split`, or what is better divided or turned in its place; returns the triangles that have changed.
    fn divide_at(
        &mut self,
        half_edge: u32,
        split: impl FnOnce(&mut Self, u32) -> Vec<usize>,
    ) -> Vec<usize> {
        match self.division(half_edge) {
            Division::Of(half_edge) => split(self, half_edge),
            Division::Turn(half_edge, made) => {
                self.keep_divided(half_edge);
                let turned = self.turn(half_edge, made);
                turned
                    .into_iter()
                    .for_each(|triangle| self.update(triangle));
                turned.to_vec()
            }
        }
    }

    /// Keeps turns of edges from bringing this one back.
    fn keep_divided(&mut self, half_edge: u32) {
        let (a, b) = (self.start(half_edge), self.end(half_edge));
        self.divided.insert([a.min(b), a.max(b)]);
    }

    /// How long the sides of a triangle are, opposite each corner, in the shape's own frame.
    fn lengths_at_rest(&self, triangle: usize) -> [f64; 3] {
        let corners = self.triangles[triangle];
        let places = corners.map(|corner| self.vertices[corner as usize].place);
        from_fn(|k| places[(k + 1) % 3].distance(places[(k + 2) % 3]))
    }

    /// How long the sides of a triangle are seen, opposite each corner, in units of the distance that is allowed. Chords of rims
    /// count half, as they are right already, unless they are what is wrong.
    pub(super) fn lengths_as_seen(&self, triangle: usize, bound: f64) -> [f64; 3] {
        let corners = self.triangles[triangle];
        let rims = self.rims_of(triangle);
        let Estimate { whole, sides } = self.estimates[triangle];
        from_fn(|k| {
            let lengths = self.task.sights.iter().enumerate().map(|(number, sight)| {
                let seen = self.seen_by(number, corners);
                (seen[(k + 2) % 3] - seen[(k + 1) % 3]).length() / sight.allowed(seen)
            });
            let is_right = rims[k] && sides[k] * bound <= whole;
            lengths.fold(0.0, f64::max) * if is_right { 0.5 } else { 1.0 }
        })
    }

    /// Takes away vertices and moves others, so that fewer triangles are near enough.
    pub(super) fn tidy(&mut self) {
        self.thin();
        self.smooth();
        self.improve_all();
        self.thin();
    }

    /// Takes away each vertex without which all triangles are still near enough.
    fn thin(&mut self) {
        for vertex in 0..self.vertices.len() as u32 {
            let Vertices { out, spot } = self.state_of(vertex);
            if out == NONE || spot.is_fixed {
                continue;
            }
            let star = self.star(vertex);
            let has_room = |e: &u32| self.estimates[triangle_of(*e)].whole < SLACK;
            if !star.iter().all(has_room) {
                continue;
            }
            let mut best: Option<(f64, u32)> = None;
            for &half_edge in &star {
                let most = best.map_or(FULL, |(worst, _)| worst);
                match self.without_start(&star, half_edge, most) {
                    Some(worst) if worst < most => best = Some((worst, half_edge)),
                    _ => {}
                }
            }
            if let Some((_, half_edge)) = best {
                let changed = self.collapse(half_edge);
                self.improve_around(half_edges_of(&changed), None);
            }
        }
    }

    fn state_of(&self, vertex: u32) -> Vertices {
        let vertex = &self.vertices[vertex as usize];
        Vertices {
            out: vertex.out,
            spot: vertex.spot,
        }
    }

    /// The largest estimate of the triangles around the start of an edge if it fell together with the end; `None` if that
    /// would be more than `most` or is not possible.
    fn without_start(&self, star: &[u32], half_edge: u32, most: f64) -> Option<f64> {
        let kept = self.end(half_edge);
        let start = &self.vertices[self.start(half_edge) as usize].spot;
        if start.rim > 0 && !self.is_rim(half_edge) {
            return None;
        }
        let around: Vec<u32> = star.iter().map(|&e| self.end(e)).collect();
        let shared = self
            .star(kept)
            .into_iter()
            .filter(|&e| around.contains(&self.end(e)));
        if shared.count() != 2 {
            return None;
        }
        let twin = self.twin(half_edge);
        let removed = [triangle_of(half_edge), triangle_of(twin)];
        // Half-edges of removed triangles, and what lies beyond them afterwards.
        let beyond = |e: u32| match e {
            e if e == previous(half_edge) => self.twin(next(half_edge)),
            e if e == next(twin) => self.twin(previous(twin)),
            e => e,
        };
        let left = star.iter().filter(|&&e| !removed.contains(&triangle_of(e)));
        let left: Vec<([u32; 3], u32)> = left
            .map(|&e| ([kept, self.end(e), self.start(previous(e))], e))
            .collect();
        if !left
            .iter()
            .all(|&(corners, e)| self.is_sound(corners, self.of[triangle_of(e)]))
        {
            return None;
        }
        let mut worst = 0.0;
        for (corners, e) in left {
            let of = self.of[triangle_of(e)];
            let is_rim = |e: u32| of != self.of[triangle_of(beyond(self.twin(e)))];
            let rims = [is_rim(next(e)), is_rim(previous(e)), is_rim(e)];
            worst = f64::max(worst, self.assess(corners, of, rims).whole);
            if !(worst < most) {
                return None;
            }
        }
        Some(worst)
    }

    /// Moves each vertex towards the side opposite it in the worst of its triangles, where that lessens the largest distance.
    fn smooth(&mut self) {
        for vertex in 0..self.vertices.len() as u32 {
            let Vertices { out, spot } = self.state_of(vertex);
            if out == NONE || spot.is_fixed {
                continue;
            }
            let star = self.star(vertex);
            let distance = |e: &u32| self.estimates[triangle_of(*e)].whole;
            let worst = star.iter().fold(star[0], |worst, e| {
                if distance(e) > distance(&worst) {
                    *e
                } else {
                    worst
                }
            });
            let now = distance(&worst);
            if now < GOOD_TO_STAY {
                continue;
            }
            if let Some(moved) = self.moved(spot, worst) {
                self.move_if_better(vertex, moved, &star, now);
            }
        }
    }

    /// The spot of a vertex, the start of a half-edge, after a step towards the opposite side.
    fn moved(&self, spot: Spot, half_edge: u32) -> Option<Spot> {
        let ends = [half_edge, previous(half_edge)];
        if spot.rim > 0 {
            let along = ends.into_iter().find(|&e| self.is_rim(e))?;
            let other =
                [self.start(along), self.end(along)].map(|v| self.vertices[v as usize].spot);
            let other = other.into_iter().find(|other| other.at != spot.at)?;
            let turn = other.at.x - spot.at.x;
            return Some(Spot::on_rim(
                spot.at.x + 0.5 * STEP * (turn - turn.round()),
                spot.rim,
            ));
        }
        let piece = self.piece_of(triangle_of(half_edge));
        let corners = [
            self.start(half_edge),
            self.end(half_edge),
            self.start(previous(half_edge)),
        ];
        let [own, b, c] = corners.map(|v| self.vertices[v as usize].place);
        let place = own + STEP * (0.5 * (b + c) - own);
        let moved = match piece {
            Piece::Ball { .. } | Piece::Lid { .. } | Piece::Slope { .. } => piece.spot_near(place),
            _ => {
                let spots = corners.map(|v| &self.vertices[v as usize].spot);
                let facet = Facet::new(piece, spots, About::Points);
                let mut at = facet.at([1.0 - STEP, 0.5 * STEP, 0.5 * STEP]);
                for (axis, period) in piece.periods().into_iter().enumerate() {
                    if period > 0.0 {
                        at[axis] = at[axis].rem_euclid(1.0);
                    }
                }
                Spot::inside(at.extend(0.0))
            }
        };
        Some(moved)
    }

    fn move_if_better(&mut self, vertex: u32, spot: Spot, star: &[u32], now: f64) {
        let v = vertex as usize;
        let sights = self.task.sights.len();
        let own = v * sights..(v + 1) * sights;
        let old = (
            self.vertices[v],
            self.seen[own.clone()].to_vec(),
            self.normals[own.clone()].to_vec(),
        );
        let (mut moved, seen, normals) = self.task.look_at(spot, self.of[triangle_of(star[0])]);
        moved.out = self.vertices[v].out;
        self.vertices[v] = moved;
        self.seen[own.clone()].copy_from_slice(&seen);
        self.normals[own.clone()].copy_from_slice(&normals);
        let mut estimates = vec![];
        let is_better = star.iter().all(|&e| {
            let triangle = triangle_of(e);
            let (corners, of) = (self.triangles[triangle], self.of[triangle]);
            if !self.is_sound(corners, of) {
                return false;
            }
            let estimate = self.assess(corners, of, self.rims_of(triangle));
            estimates.push((triangle, estimate));
            estimate.whole < BETTER * now
        });
        if is_better {
            for (triangle, estimate) in estimates {
                self.estimates[triangle] = estimate;
            }
        } else {
            self.vertices[v] = old.0;
            self.seen[own.clone()].copy_from_slice(&old.1);
            self.normals[own].copy_from_slice(&old.2);
        }
    }
}

/// What decides whether a vertex may be moved or taken away.
struct Vertices {
    out: u32,
    spot: Spot,
}

/// The side of a triangle with the largest of these numbers, one for the side opposite each corner.
fn opposite_largest(triangle: usize, numbers: [f64; 3]) -> u32 {
    let larger = |best: usize, k: usize| {
        if numbers[k] > numbers[best] { k } else { best }
    };
    (3 * triangle + ((0..3).fold(0, larger) + 1) % 3) as u32
}
