//! A closed net of triangles with corners on a round shape: who is beside whom, and how good each triangle is.

use std::collections::{HashMap, HashSet};

use glam::{DMat3, DVec2, DVec3};

use super::chart::Facet;
use super::estimate::Estimate;
use super::metric::metric;
use super::sight::About;
use super::sight::Sight;
use crate::shape::{Body, MAX_SPAN, Piece, Spot};

/// Stands for no half-edge.
pub(super) const NONE: u32 = u32::MAX;

/// The least cosine between a triangle's normal and those of the photosurface at its corners.
const LEAST_COSINE: f64 = 0.3;

/// What is looked at: the pieces of the shape, who sees them, and what a tolerance is about.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) pieces: &'a [Piece],
    pub(super) sights: &'a [Sight],
    pub(super) about: About,
    /// The wanted length of sides, in the metric in which an equilateral triangle of length 1 is as far from the
    /// photosurface as is allowed.
    pub(super) aim: f64,
}

/// A vertex, with what is computed once for it. On a rim normals and metrics are those of the first piece and of the lid.
#[derive(Clone, Copy)]
pub(super) struct Vertex {
    pub(super) spot: Spot,
    pub(super) place: DVec3,
    pub(super) metric: [DMat3; 2],
    /// A half-edge that starts at the vertex; [`NONE`] of one that was taken away.
    pub(super) out: u32,
}

/// A spot and its place.
pub(super) type Placed<'a> = (&'a Spot, DVec3);

/// The net. Half-edge `3 t + k` goes from corner `k` of triangle `t` to the next one.
pub(super) struct Net<'a> {
    pub(super) task: Task<'a>,
    pub(super) vertices: Vec<Vertex>,
    /// Where each sight sees a vertex, and the normals of the photosurface there: those of all sights follow each other.
    pub(super) seen: Vec<DVec3>,
    pub(super) normals: Vec<[DVec3; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The piece of each triangle.
    pub(super) of: Vec<u8>,
    pub(super) twins: Vec<u32>,
    pub(super) estimates: Vec<Estimate>,
    /// False for triangles that were taken away.
    pub(super) alive: Vec<bool>,
    /// The ends of edges that were divided, the smaller one first: no turned edge may bring them back.
    pub(super) divided: HashSet<[u32; 2]>,
}

pub(super) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 {
        half_edge - 2
    } else {
        half_edge + 1
    }
}

pub(super) fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) {
        half_edge + 2
    } else {
        half_edge - 1
    }
}

pub(super) fn triangle_of(half_edge: u32) -> usize {
    half_edge as usize / 3
}

/// The half-edges of triangles.
pub(super) fn half_edges_of(triangles: &[usize]) -> Vec<u32> {
    triangles
        .iter()
        .flat_map(|&t| [0, 1, 2].map(|k| (3 * t + k) as u32))
        .collect()
}

impl Task<'_> {
    /// Which of two normals and metrics belongs to a piece.
    pub(super) fn side_of(piece: u8) -> usize {
        usize::from(piece > 0)
    }

    fn pieces_at(&self, spot: &Spot, piece: u8) -> [&Piece; 2] {
        match spot.rim {
            0 => [&self.pieces[piece as usize]; 2],
            rim => [&self.pieces[0], &self.pieces[rim as usize]],
        }
    }

    /// The vertex at a spot, and what each sight sees there.
    pub(super) fn look_at(&self, spot: Spot, piece: u8) -> (Vertex, Vec<DVec3>, Vec<[DVec3; 2]>) {
        let pieces = self.pieces_at(&spot, piece);
        let place = pieces[0].place_of(&spot);
        let metric_of = |piece: &Piece| match piece.is_pole(&spot) {
            // The angles there say nothing.
            true => DMat3::ZERO,
            false => metric(piece, &spot, self.sights, self.about),
        };
        let first = metric_of(pieces[0]);
        let metric = [
            first,
            if spot.rim > 0 {
                metric_of(pieces[1])
            } else {
                first
            },
        ];
        let seen = self.sights.iter().map(|sight| sight.seen(place)).collect();
        let normals = self.sights.iter().map(|sight| {
            let normal_of = |piece: &Piece| sight.seen_normal(place, piece.normal_of(&spot));
            let first = normal_of(pieces[0]);
            [
                first,
                if spot.rim > 0 {
                    normal_of(pieces[1])
                } else {
                    first
                },
            ]
        });
        (
            Vertex {
                spot,
                place,
                metric,
                out: NONE,
            },
            seen,
            normals.collect(),
        )
    }
}

impl<'a> Net<'a> {
    /// The coarsest net of a body.
    pub(super) fn new(body: &Body, task: Task<'a>) -> Self {
        let mut net = Self {
            task,
            vertices: vec![],
            seen: vec![],
            normals: vec![],
            triangles: body.triangles.clone(),
            of: body.of.clone(),
            twins: vec![NONE; 3 * body.triangles.len()],
            estimates: vec![Estimate::default(); body.triangles.len()],
            alive: vec![true; body.triangles.len()],
            divided: HashSet::new(),
        };
        for &spot in &body.spots {
            net.add(spot, 0);
        }
        let mut between = HashMap::new();
        for half_edge in 0..net.twins.len() as u32 {
            between.insert([net.start(half_edge), net.end(half_edge)], half_edge);
        }
        for half_edge in 0..net.twins.len() as u32 {
            let (start, end) = (net.start(half_edge), net.end(half_edge));
            net.twins[half_edge as usize] =
                between.get(&[end, start]).copied().unwrap_or(half_edge);
            net.vertices[start as usize].out = half_edge;
        }
        for triangle in 0..net.triangles.len() {
            net.update(triangle);
        }
        net
    }

    /// Adds a vertex and returns its number.
    pub(super) fn add(&mut self, spot: Spot, piece: u8) -> u32 {
        let (vertex, seen, normals) = self.task.look_at(spot, piece);
        self.vertices.push(vertex);
        self.seen.extend(seen);
        self.normals.extend(normals);
        (self.vertices.len() - 1) as u32
    }

    /// Takes the vertex that was added last away, of which no triangle is made.
    pub(super) fn take_last_vertex(&mut self) {
        self.vertices.pop();
        let left = self.vertices.len() * self.task.sights.len();
        self.seen.truncate(left);
        self.normals.truncate(left);
    }

    /// The number of triangles.
    pub(super) fn count(&self) -> usize {
        self.alive.iter().filter(|alive| **alive).count()
    }

    pub(super) fn start(&self, half_edge: u32) -> u32 {
        self.triangles[triangle_of(half_edge)][half_edge as usize % 3]
    }

    pub(super) fn end(&self, half_edge: u32) -> u32 {
        self.start(next(half_edge))
    }

    pub(super) fn twin(&self, half_edge: u32) -> u32 {
        self.twins[half_edge as usize]
    }

    /// Whether an edge is the chord of a rim.
    pub(super) fn is_rim(&self, half_edge: u32) -> bool {
        self.of[triangle_of(half_edge)] != self.of[triangle_of(self.twin(half_edge))]
    }

    pub(super) fn piece_of(&self, triangle: usize) -> &'a Piece {
        &self.task.pieces[self.of[triangle] as usize]
    }

    /// The half-edges that start at a vertex.
    pub(super) fn star(&self, vertex: u32) -> Vec<u32> {
        let first = self.vertices[vertex as usize].out;
        let mut star = vec![first];
        loop {
            let half_edge = self.twin(previous(star[star.len() - 1]));
            if half_edge == first {
                return star;
            }
            star.push(half_edge);
        }
    }

    /// Whether two vertices are the ends of an edge.
    pub(super) fn are_neighbours(&self, a: u32, b: u32) -> bool {
        self.star(a)
            .iter()
            .any(|&half_edge| self.end(half_edge) == b)
    }

    /// The square of the distance of two vertices in the metric of a piece.
    pub(super) fn length_squared(&self, a: u32, b: u32, piece: u8) -> f64 {
        let (a, b) = (&self.vertices[a as usize], &self.vertices[b as usize]);
        let (along, side) = (b.place - a.place, Task::side_of(piece));
        let [of_a, of_b] = [a, b].map(|vertex| along.dot(vertex.metric[side] * along));
        match (of_a, of_b) {
            (0.0, other) | (other, 0.0) => other,
            _ => 0.5 * (of_a + of_b),
        }
    }

    /// The triangle between three vertices, in a chart.
    pub(super) fn facet(&self, corners: [u32; 3], piece: u8) -> Facet {
        let spots = corners.map(|corner| &self.vertices[corner as usize].spot);
        Facet::new(&self.task.pieces[piece as usize], spots, self.task.about)
    }

    /// Where a sight sees the corners.
    pub(super) fn seen_by(&self, sight: usize, corners: [u32; 3]) -> [DVec3; 3] {
        corners.map(|corner| self.seen[corner as usize * self.task.sights.len() + sight])
    }

    /// The normals of the photosurface of a piece at the corners.
    pub(super) fn normals_by(&self, sight: usize, corners: [u32; 3], piece: u8) -> [DVec3; 3] {
        let side = Task::side_of(piece);
        corners.map(|corner| self.normals[corner as usize * self.task.sights.len() + sight][side])
    }

    /// The estimate for a triangle between three vertices; `rims` says which sides, opposite each corner, are chords of a
    /// rim.
    pub(super) fn assess(&self, corners: [u32; 3], piece: u8, rims: [bool; 3]) -> Estimate {
        let facet = self.facet(corners, piece);
        let on_rims = [0, 1, 2].map(|k| {
            rims[k].then(|| {
                let spot = self.middle_of_rim(corners[(k + 1) % 3], corners[(k + 2) % 3]);
                self.task.pieces[0].place_of(&spot)
            })
        });
        let sights = self.task.sights.iter().enumerate();
        let estimates = sights.map(|(number, sight)| {
            Estimate::new(
                &facet,
                sight,
                self.task.about,
                self.seen_by(number, corners),
                on_rims,
            )
        });
        estimates.fold(Estimate::default(), Estimate::max)
    }

    /// The middle of the arc of a rim between two vertices.
    pub(super) fn middle_of_rim(&self, a: u32, b: u32) -> Spot {
        let [a, b] = [a, b].map(|vertex| self.vertices[vertex as usize].spot);
        let step = b.at.x - a.at.x;
        Spot::on_rim(a.at.x + 0.5 * (step - step.round()), a.rim)
    }

    /// Which sides of a triangle, opposite each corner, are chords of a rim.
    pub(super) fn rims_of(&self, triangle: usize) -> [bool; 3] {
        [1, 2, 0].map(|k| self.is_rim((3 * triangle + k) as u32))
    }

    /// Assesses a triangle anew.
    pub(super) fn update(&mut self, triangle: usize) {
        let rims = self.rims_of(triangle);
        self.estimates[triangle] = self.assess(self.triangles[triangle], self.of[triangle], rims);
    }

    /// Twice the area of a triangle of spots, in a chart of the piece in which sides are straight: positive where it faces
    /// outwards.
    fn area(&self, piece: &Piece, corners: [Placed<'_>; 3]) -> f64 {
        let spots = corners.map(|(spot, _)| spot);
        let flat = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
        match *piece {
            Piece::Ball { .. } => spots[0].at.cross(spots[1].at).dot(spots[2].at),
            Piece::Globe { .. } => {
                let [a, b, c] = corners.map(|(_, place)| place);
                a.cross(b).dot(c)
            }
            Piece::Slope { .. } | Piece::Lid { .. } => {
                let [a, b, c] = corners.map(|(_, place)| DVec2::new(place.x, place.z));
                let up = if let Piece::Lid { up, .. } = *piece {
                    up
                } else {
                    1.0
                };
                -up * flat(a, b, c)
            }
            Piece::Side { .. } | Piece::Tube { .. } => {
                let mut q = spots.map(|spot| piece.parameters(spot));
                for (axis, period) in piece.periods().into_iter().enumerate() {
                    for k in 1..3 {
                        let step = q[0][axis] - q[k][axis];
                        q[k][axis] += if period > 0.0 { step.round() } else { 0.0 };
                    }
                }
                let outward = if let Piece::Side { .. } = piece {
                    1.0
                } else {
                    -1.0
                };
                outward * flat(q[0], q[1], q[2])
            }
        }
    }

    /// A vertex with its place.
    pub(super) fn placed(&self, vertex: u32) -> Placed<'_> {
        let vertex = &self.vertices[vertex as usize];
        (&vertex.spot, vertex.place)
    }

    /// On which side of the line from `a` to `b` a spot is: positive on the left, seen from outside.
    pub(super) fn side_of_line(&self, [a, b]: [u32; 2], spot: Placed<'_>, piece: u8) -> f64 {
        let corners = [self.placed(a), self.placed(b), spot];
        self.area(&self.task.pieces[piece as usize], corners)
    }

    /// Whether three spots of a piece make a triangle that faces outwards, is no line, neither as it is nor in the parameters of a
    /// cone where these matter, and spans no more than a quarter of a turn.
    pub(super) fn faces_outwards(&self, corners: [Placed<'_>; 3], piece: u8) -> bool {
        let piece = &self.task.pieces[piece as usize];
        if !(self.area(piece, corners) > 0.0) || is_line(corners.map(|(_, place)| place)) {
            return false;
        }
        let spots = corners.map(|(spot, _)| spot);
        let has_parameters =
            matches!(piece, Piece::Slope { .. }) && self.task.about == About::Points;
        if has_parameters && spots.into_iter().all(|spot| spot.rim > 0) {
            return false;
        }
        let periods = piece.periods();
        (0..3).all(|k| {
            let (a, b) = (spots[k], spots[(k + 1) % 3]);
            match *piece {
                Piece::Ball { .. } => return a.at.dot(b.at) > -0.01,
                // The middle of a longer side is next to that of the ball, from where a little aside is anywhere on it.
                Piece::Globe { radius } => {
                    let [p, q] = [corners[k].1, corners[(k + 1) % 3].1];
                    if !(p.dot(q) > -0.01 * radius * radius) {
                        return false;
                    }
                }
                _ => {}
            }
            if piece.is_pole(a) || piece.is_pole(b) {
                return true;
            }
            let step = piece.parameters(a) - piece.parameters(b);
            let fits = |axis: usize| (step[axis] - step[axis].round()).abs() <= MAX_SPAN + 1e-6;
            (0..2).all(|axis| periods[axis] == 0.0 || fits(axis))
        })
    }

    /// The same for vertices.
    pub(super) fn may_be(&self, corners: [u32; 3], piece: u8) -> bool {
        self.faces_outwards(corners.map(|corner| self.placed(corner)), piece)
    }

    /// Whether a triangle is so thin that rounding decides where it faces.
    pub(super) fn is_line(&self, triangle: usize) -> bool {
        is_line(self.triangles[triangle].map(|corner| self.vertices[corner as usize].place))
    }

    /// Whether such a triangle also faces, as seen, where the photosurface at its corners does.
    pub(super) fn is_sound(&self, corners: [u32; 3], piece: u8) -> bool {
        self.may_be(corners, piece)
            && (0..self.task.sights.len()).all(|sight| {
                let [a, b, c] = self.seen_by(sight, corners);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let normals = self.normals_by(sight, corners, piece);
                normals.iter().all(|n| n.dot(normal) > LEAST_COSINE)
            })
    }
}

/// Whether a triangle with these corners is.
fn is_line([a, b, c]: [DVec3; 3]) -> bool {
    /// How high a triangle is at least, as a fraction of its longest side.
    const LEAST_HEIGHT: f64 = 1e-8;
    let sides = [b - a, c - b, a - c];
    let longest = sides
        .map(DVec3::length_squared)
        .into_iter()
        .fold(0.0, f64::max);
    !(sides[0].cross(sides[1]).length_squared() > (LEAST_HEIGHT * longest).powi(2))
}
