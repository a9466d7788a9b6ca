//! One triangle refined: a Delaunay triangulation on the sky of an observer at rest.
//!
//! In the stereographic chart of the triangle's own plane, `w = q / (hypot(q, h) + h)` for the in-plane
//! offset `q` from the foot of the perpendicular, circles of the sky are circles, so that a planar Delaunay
//! triangulation there is the spherical one. The metric in which gaps are measured, `r` times that of the
//! sky, is `4 h |dw|^2 / (1 - |w|^4)` in it.
//!
//! Points are added until no triangle's gap exceeds what is allowed. Which triangle comes first and where its
//! point goes is what makes the mesh cheap: the one whose shortest edge is nearest to the ideal length, and
//! the point that makes an equilateral triangle on that edge (P.-E. Bern's and A. Üngör's off-centres, in the
//! order of an advancing front). Perfect triangles grow from perfect edges; flaws are left to the end.

use glam::{DVec2, DVec3};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{
    ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation,
    mitigate_underflow,
};

use super::along::{PlanePoint, gap_along};
use super::chart::{Chart, Plane};
use super::gap::triangle_gap_place;
use super::pieces::{Corner, Pieces};
use super::queue::{Queue, Task};
use super::strip::strip;
use super::{Allowance, triangle_gap};

/// The gap that new triangles aim at, as a part of what is allowed: a little room for the last few, which
/// have to fit between others.
const AIM: f64 = 0.96;

/// A point this near to an edge of the boundary, against the edge's length, would make a flat triangle.
const TOO_NEAR: f64 = 0.225;

/// How many charts are tried, each flatter than the one before, before the plain strip is taken. Where the observer is in
/// the triangle's plane, the first is all but a line, in which faces next to the boundary may turn over; each flatter
/// one needs more points.
const CHARTS: i32 = 8;

/// Where the points that are granted are too few, so many times as much is allowed; then 4 times that factor, and so on.
const LOOSER: f64 = 4.0;
const LOOSEST: f64 = 1e100;

/// How many points a triangle may have inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grant {
    pub(super) granted: usize,
    /// Whether there will never be more.
    pub(super) is_last: bool,
}

/// Divides the triangle between three positions, whose boundary is `boundary` (counter-clockwise, from corner 0
/// on), until every gap is within the allowance or so many points have been added as make sense for it, `max_points`
/// and what a flatter chart takes; never more than `granted`. Where those are too few and `is_last` says that there will
/// be no more, gaps are larger by one factor.
pub(super) fn divide(
    positions: [DVec3; 3],
    observer: DVec3,
    boundary: &[Corner],
    allowance: &Allowance,
    max_points: usize,
    Grant { granted, is_last }: Grant,
) -> Pieces {
    let Some(plane) = Plane::new(positions.map(|position| position - observer)) else {
        return strip(boundary, allowance);
    };
    let (mut looser, mut step) = (1.0, LOOSER);
    let mut best: Option<Pieces> = None;
    loop {
        let aimed = match looser {
            1.0 => *allowance,
            _ => allowance.times(looser),
        };
        let limits = [max_points, granted];
        let made = divide_on_sky(plane, positions, observer, boundary, &aimed, limits);
        let Some(pieces) = made else { break };
        let (is_complete, is_short) = (pieces.complete, pieces.is_short);
        if looser == 1.0 && (is_complete || !is_short) {
            return Pieces {
                is_short: false,
                ..pieces
            };
        }
        if best.as_ref().is_none_or(|best| pieces.gap < best.gap) {
            best = Some(Pieces {
                complete: false,
                is_short: true,
                ..pieces
            });
        }
        if is_complete || !is_short || !is_last || looser > LOOSEST {
            break;
        }
        looser *= step;
        step *= LOOSER;
    }
    best.unwrap_or_else(|| strip(boundary, allowance))
}

/// The same with one allowance; `None` where every chart has faces that are turned over. The limits are the points that
/// make sense, and those granted.
fn divide_on_sky(
    plane: Plane,
    positions: [DVec3; 3],
    observer: DVec3,
    boundary: &[Corner],
    allowance: &Allowance,
    [max_points, granted]: [usize; 2],
) -> Option<Pieces> {
    let smallest = boundary
        .iter()
        .fold(f64::INFINITY, |s, c| s.min(allowance.between(&[c.offset])));
    let mut best: Option<Pieces> = None;
    for flattening in 0..CHARTS {
        let chart = Chart::new(plane, allowance, smallest, flattening);
        let mut front = match Front::new(chart, positions, observer, boundary, allowance) {
            Some(front) => front,
            None => continue,
        };
        let most = max_points + chart.points(allowance);
        let is_short = front.advance(most.min(granted)) && granted < most;
        let Some(mut pieces) = front.finish() else {
            continue;
        };
        pieces.is_short = is_short;
        if pieces.complete {
            return Some(pieces);
        }
        if best.as_ref().is_none_or(|best| pieces.gap < best.gap) {
            best = Some(pieces);
        }
        if is_short {
            // A flatter chart takes more points.
            break;
        }
    }
    best
}

/// A point to be added.
struct New {
    /// Where in the chart.
    w: DVec2,
    /// Weights of the triangle's corners.
    weights: DVec3,
    /// A vertex near it.
    hint: FixedVertexHandle,
}

/// A triangulation that grows.
struct Front<'a> {
    chart: Chart,
    positions: [DVec3; 3],
    observer: DVec3,
    allowance: &'a Allowance,
    triangulation: ConstrainedDelaunayTriangulation<Point2<f64>>,
    /// What is known of the vertices of the triangulation, which are small and stay together so.
    points_in_plane: Vec<PlanePoint>,
    /// And their weights of the triangle's corners.
    weights: Vec<DVec3>,
    tasks: Queue,
    /// For each face its flaw; NaN where nothing is to do. Tasks that
    /// say otherwise are out of date.
    flaws: Vec<(f32, FixedFaceHandle<InnerTag>)>,
    boundary: &'a [Corner],
}

impl<'a> Front<'a> {
    /// The triangulation of the boundary alone; `None` where rounding throws points of it together.
    fn new(
        chart: Chart,
        positions: [DVec3; 3],
        observer: DVec3,
        boundary: &'a [Corner],
        allowance: &'a Allowance,
    ) -> Option<Self> {
        let mut front = Self {
            chart,
            positions,
            observer,
            allowance,
            triangulation: ConstrainedDelaunayTriangulation::new(),
            points_in_plane: boundary
                .iter()
                .map(|corner| PlanePoint::new(&chart.plane, corner.offset))
                .collect(),
            weights: boundary.iter().map(|corner| corner.weights).collect(),
            tasks: Queue::new(),
            flaws: vec![],
            boundary,
        };
        let mut handles = Vec::with_capacity(boundary.len());
        for index in 0..boundary.len() {
            let w = chart.place_to_chart(front.points_in_plane[index].place);
            let handle = front.triangulation.insert(to_point(w)).ok()?;
            if handle.index() != index {
                return None;
            }
            handles.push(handle);
        }
        for (index, &handle) in handles.iter().enumerate() {
            let next = handles[(index + 1) % handles.len()];
            if !front.triangulation.can_add_constraint(handle, next) {
                return None;
            }
            front.triangulation.add_constraint(handle, next);
        }
        let faces: Vec<_> = front
            .triangulation
            .inner_faces()
            .map(|face| (face.fix(), face.vertices().map(|vertex| vertex.fix())))
            .collect();
        for (face, vertices) in faces {
            front.consider(face, vertices);
        }
        Some(front)
    }

    /// Adds points until nothing is left to do, or `max_points` have been added; whether something may be left to do.
    fn advance(&mut self, max_points: usize) -> bool {
        let mut added = 0;
        let mut around = vec![];
        while added < max_points
            && let Some(task) = self.tasks.pop()
        {
            let (flaw, face) = self.flaws[task.face as usize];
            if flaw != task.flaw {
                continue;
            }
            let Some(New { w, weights, hint }) = self.new_point(face) else {
                continue;
            };
            let count = self.triangulation.num_vertices();
            let Ok(handle) = self.triangulation.insert_with_hint(to_point(w), hint) else {
                continue;
            };
            if self.triangulation.num_vertices() == count {
                continue;
            }
            let offset = mix(self.positions, weights) - self.observer;
            self.points_in_plane
                .push(PlanePoint::new(&self.chart.plane, offset));
            self.weights.push(weights);
            added += 1;
            let edges = self.triangulation.vertex(handle).out_edges();
            around.extend(edges.filter_map(|edge| {
                let face = edge.face().as_inner()?.fix();
                Some((face, [handle, edge.to().fix(), edge.next().to().fix()]))
            }));
            for (face, vertices) in around.drain(..) {
                self.consider(face, vertices);
            }
        }
        added == max_points
    }

    /// Sets a task if the face has too large a gap.
    fn consider(&mut self, face: FixedFaceHandle<InnerTag>, vertices: [FixedVertexHandle; 3]) {
        let flaw = self.flaw(vertices);
        if self.flaws.len() <= face.index() {
            self.flaws.resize(face.index() + 1, (f32::NAN, face));
        }
        self.flaws[face.index()] = (flaw.unwrap_or(f32::NAN), face);
        if let Some(flaw) = flaw {
            self.tasks.push(Task {
                face: face.index() as u32,
                flaw,
            });
        }
    }

    /// How far the square of the shortest edge of a face with too large a gap is from that of the ideal length, as a part
    /// of the smaller one.
    fn flaw(&self, vertices: [FixedVertexHandle; 3]) -> Option<f32> {
        let indices = vertices.map(|vertex| vertex.index());
        if self.is_outside(indices) {
            return None;
        }
        let offsets = indices.map(|index| self.points_in_plane[index].offset);
        let allowed = self.allowance.between(&offsets);
        let [a, b, c] = vertices.map(|vertex| to_vec(self.triangulation.vertex(vertex).position()));
        let sides = [b - a, c - b, a - c].map(DVec2::length_squared);
        let points_in_plane = indices.map(|index| &self.points_in_plane[index]);
        let along = gap_along(&self.chart.plane, points_in_plane);
        let is_small = along.bound <= allowed
            || !along.is_sharp && triangle_gap(offsets[0], offsets[1], offsets[2]) <= allowed;
        if is_small {
            return None;
        }
        // An equilateral triangle with the circumradius R, R^2 / 2 the gap of its middle, has the side sqrt(3) R. The
        // metric is that of one corner, by chance: always the newest one would be the same side's too often.
        let corner = (indices[0] + indices[1] + indices[2]) % 3;
        let ideal = 6.0 * AIM * allowed / self.chart.metric([a, b, c][corner]);
        let shortest = sides[0].min(sides[1]).min(sides[2]);
        Some(((shortest - ideal).abs() / shortest.min(ideal)) as f32)
    }

    /// Three points on one side of the triangle: a face between the side and its arc in the chart.
    fn is_outside(&self, vertices: [usize; 3]) -> bool {
        // Points inside are on no side.
        let sides = |vertex: usize| self.boundary.get(vertex).map_or(0, |corner| corner.sides);
        sides(vertices[0]) & sides(vertices[1]) & sides(vertices[2]) != 0
    }

    /// Where to add a point for a face: in front of its shortest edge, or else where its middle is; and a vertex near it.
    fn new_point(&self, face: FixedFaceHandle<InnerTag>) -> Option<New> {
        let vertices = self.triangulation.face(face).vertices();
        let hint = vertices[0].fix();
        let w = self.ideal_point(vertices.map(|vertex| to_vec(vertex.position())));
        if w.length_squared() < 1.0 {
            let weights = self.chart.plane.weights(self.chart.chart_to_place(w));
            if weights.min_element() > 0.0
                && let Some(near) = self.room(w, hint)
            {
                return Some(New {
                    w,
                    weights,
                    hint: near,
                });
            }
        }
        // Next to the boundary: where the gap is largest, or the middle where that is on the boundary itself.
        let indices = vertices.map(|vertex| vertex.index());
        let [a, b, c] = indices.map(|index| self.points_in_plane[index].offset);
        let [u, v, w] = triangle_gap_place(a, b, c);
        let [a, b, c] = indices.map(|index| self.weights[index]);
        let worst = a * u + b * v + c * w;
        let weights = if worst.min_element() > 1e-9 {
            worst
        } else {
            (a + b + c) / 3.0
        };
        let offset = mix(self.positions, weights) - self.observer;
        let w = self.chart.place_to_chart(self.chart.plane.place(offset));
        (weights.min_element() > 0.0).then_some(New { w, weights, hint })
    }

    /// The point that makes an equilateral triangle of the ideal size on the shortest side of a
    /// counter-clockwise triangle; its circumcentre if that is nearer.
    fn ideal_point(&self, triangle: [DVec2; 3]) -> DVec2 {
        let sides = [0, 1, 2].map(|i| (triangle[i], triangle[(i + 1) % 3], triangle[(i + 2) % 3]));
        let length = |side: &(DVec2, DVec2, DVec2)| (side.1 - side.0).length_squared();
        let &(a, b, c) =
            sides.iter().fold(
                &sides[0],
                |s, side| if length(side) < length(s) { side } else { s },
            );
        let middle = (a + b) * 0.5;
        let half = (b - a).length() * 0.5;
        let inward = (b - a).perp() / (2.0 * half);
        let center = circumcenter(a, b, c);
        let to_center = (center - middle).dot(inward);

        let allowed = self.allowance.between(&[self.offset_near(middle)]);
        let height = |metric: f64| {
            let radius = (2.0 * AIM * allowed / metric).sqrt();
            if radius > half {
                radius + (radius * radius - half * half).sqrt()
            } else {
                half
            }
        };
        // Twice: the metric is that between the side and the point.
        let metric = self.chart.metric(middle);
        let apex = middle + inward * height(metric);
        let metric = (metric * self.chart.metric(apex)).sqrt();
        let height = height(metric);
        if height < to_center {
            middle + inward * height
        } else {
            center
        }
    }

    /// A vertex next to a point of the chart, if that is in a face of the triangle, not too near to the boundary.
    fn room(&self, w: DVec2, hint: FixedVertexHandle) -> Option<FixedVertexHandle> {
        match self
            .triangulation
            .locate_with_hint(Point2::new(w.x, w.y), hint)
        {
            PositionInTriangulation::OnFace(face) => {
                let face = self.triangulation.face(face);
                let vertices = face.vertices();
                if self.is_outside(vertices.map(|vertex| vertex.index())) {
                    return None;
                }
                let has_room = face
                    .adjacent_edges()
                    .iter()
                    .filter(|edge| edge.is_constraint_edge())
                    .all(|edge| {
                        let (a, b) = (to_vec(edge.from().position()), to_vec(edge.to().position()));
                        // Height over length.
                        (b - a).perp_dot(w - a).abs() > 2.0 * TOO_NEAR * (b - a).length_squared()
                    });
                has_room.then(|| vertices[0].fix())
            }
            PositionInTriangulation::OnEdge(edge) => {
                let edge = self.triangulation.directed_edge(edge);
                (!edge.is_constraint_edge()).then(|| edge.from().fix())
            }
            _ => None,
        }
    }

    fn offset_near(&self, w: DVec2) -> DVec3 {
        let weights = self.chart.plane.weights(self.chart.chart_to_place(w));
        mix(self.positions, weights) - self.observer
    }

    /// The triangles; `None` where they do not cover the triangle exactly once, as rounding may bring about.
    ///
    /// They do if no face is turned over and the faces have the boundary of the triangle for their boundary: each of
    /// its edges once, from one point to the next, and no other edge without a face on either side.
    fn finish(self) -> Option<Pieces> {
        let mut pieces = Pieces {
            inside: self.weights[self.boundary.len()..].to_vec(),
            triangles: Vec::with_capacity(self.triangulation.num_inner_faces()),
            complete: true,
            ..Pieces::default()
        };
        let mut edges_on_boundary = 0;
        for face in self.triangulation.inner_faces() {
            let vertices = face.vertices().map(|vertex| vertex.index());
            if self.is_outside(vertices) {
                continue;
            }
            for edge in face.adjacent_edges() {
                if !edge.is_constraint_edge() {
                    let beyond = edge.rev().face().as_inner()?;
                    if self.is_outside(beyond.vertices().map(|vertex| vertex.index())) {
                        return None;
                    }
                } else if (edge.from().index() + 1) % self.boundary.len() == edge.to().index() {
                    edges_on_boundary += 1;
                } else {
                    return None;
                }
            }
            let [a, b, c] = vertices.map(|vertex| {
                let weights = self.weights[vertex];
                DVec2::new(weights.y, weights.z)
            });
            if !((b - a).perp_dot(c - a) > 0.0) {
                return None;
            }
            let points_in_plane = vertices.map(|vertex| &self.points_in_plane[vertex]);
            let offsets = points_in_plane.map(|point| point.offset);
            // Most are known to be smaller than one that was met before.
            let bound = gap_along(&self.chart.plane, points_in_plane).bound;
            if !(bound <= pieces.gap && bound <= self.allowance.between(&offsets)) {
                pieces.measure(offsets, self.allowance);
            }
            pieces.triangles.push(vertices.map(|vertex| vertex as u32));
        }
        (edges_on_boundary == self.boundary.len()).then_some(pieces)
    }
}

impl Pieces {
    /// Takes the gap of one triangle into account.
    pub(super) fn measure(&mut self, offsets: [DVec3; 3], allowance: &Allowance) {
        let gap = triangle_gap(offsets[0], offsets[1], offsets[2]);
        self.gap = self.gap.max(gap);
        self.complete &= gap <= allowance.between(&offsets);
    }
}

fn mix([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a * weights.x + b * weights.y + c * weights.z
}

fn to_vec(point: Point2<f64>) -> DVec2 {
    DVec2::new(point.x, point.y)
}

fn to_point(w: DVec2) -> Point2<f64> {
    mitigate_underflow(Point2::new(w.x, w.y))
}

fn circumcenter(a: DVec2, b: DVec2, c: DVec2) -> DVec2 {
    let (b, c) = (b - a, c - a);
    let twice = 2.0 * b.perp_dot(c);
    a + DVec2::new(
        c.y * b.length_squared() - b.y * c.length_squared(),
        b.x * c.length_squared() - c.x * b.length_squared(),
    ) / twice
}
