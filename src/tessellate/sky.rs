//! Refinement of one triangle: a Delaunay triangulation on the sky of an observer at rest with the object.
//!
//! The stereographic chart of the triangle's own plane is `w = q / (hypot(q, h) + h)`, where `q` is the in-plane offset
//! from the foot of the perpendicular through the observer and `h` the distance of the plane. Circles on the sky are
//! circles in this chart, so the planar Delaunay triangulation of the chart is the spherical one of the sky. The gap
//! metric, which is `r` times the metric of the sky (`minimum`), is `4 h |dw|^2 / (1 - |w|^4)` in the chart.
//!
//! Points are added until no triangle's gap exceeds the allowance. Two choices keep the number of triangles small. The
//! next triangle to be divided is the one whose shortest edge is nearest to the ideal length. The new point makes an
//! equilateral triangle on that edge (P.-E. Bern's and A. Üngör's off-centres, in the order of an advancing front).
//! Good triangles thus grow from good edges, and bad ones are left to the end.

use glam::{DVec2, DVec3};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{
    ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation,
    mitigate_underflow,
};

use super::along::{Along, PlanePoint, gap_along};
use super::chart::{Chart, Plane};
use super::gap::triangle_gap_place;
use super::pieces::{Corner, Pieces};
use super::queue::{Queue, Task};
use super::rims::Judge;
use super::strip::strip;
use super::{Allowance, triangle_gap};

/// The gap at which new triangles aim, as a fraction of the allowed gap. The rest is room for the last few triangles,
/// which have to fit between others.
const AIM: f64 = 0.96;

/// A point nearer to an edge of the boundary than this would make a thin triangle. The unit is twice the edge's length.
const TOO_NEAR: f64 = 0.225;

/// How many charts are tried, each flatter than the one before, before a plain strip is used instead. If the observer
/// is in the triangle's plane, the first chart is almost a line, and faces next to the boundary may turn over; each
/// flatter chart needs more points.
const CHARTS: i32 = 8;

/// The same for the measure of surfaces: what that does not prove soon counts with its gap, which takes less time.
const CHARTS_OF_SURFACE: i32 = 3;

/// If the granted points are too few, the allowance is multiplied by this factor; if that does not suffice, by a factor
/// 4 times as large, and so on.
const LOOSER: f64 = 4.0;
const LOOSEST: f64 = 1e100;

/// How many points a triangle may have inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grant {
    pub(super) granted: usize,
    /// Whether the triangle gets no other turn with more points.
    pub(super) is_last: bool,
}

/// Divides the triangle between three positions, whose boundary is `boundary` (counter-clockwise, from corner 0 on),
/// until the gap of every piece is within the allowance, or until `max_points` points have been added, plus the extra
/// points of a flatter chart; the number never exceeds `granted`. If `granted` is too small and `is_last` is set, the
/// allowance of the whole triangle is multiplied by one factor. All positions are in the rest frame.
pub(super) fn divide(
    positions: [DVec3; 3],
    observer: DVec3,
    boundary: &[Corner],
    (allowance, judge): (&Allowance, Option<&Judge>),
    max_points: usize,
    Grant { granted, is_last }: Grant,
) -> Pieces {
    let strip = || {
        let pieces = strip(boundary, allowance);
        // No ray of a neighbour in the same plane must pass a strip.
        let cut = judge.map_or(0.0, |_| pieces.gap);
        Pieces { cut, ..pieces }
    };
    let Some(plane) = Plane::new(positions.map(|position| position - observer)) else {
        return strip();
    };
    let (mut looser, mut step) = (1.0, LOOSER);
    let mut best: Option<Pieces> = None;
    loop {
        let aimed = match looser {
            1.0 => *allowance,
            _ => allowance.times(looser),
        };
        let limits = [max_points, granted];
        let made = divide_on_sky(
            plane,
            positions,
            observer,
            boundary,
            (&aimed, judge),
            limits,
        );
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
    best.unwrap_or_else(strip)
}

/// Divides the triangle with one fixed allowance; `None` if faces are turned over in every chart. The two limits are
/// `max_points` and `granted` of [`divide`].
fn divide_on_sky(
    plane: Plane,
    positions: [DVec3; 3],
    observer: DVec3,
    boundary: &[Corner],
    (allowance, judge): (&Allowance, Option<&Judge>),
    [max_points, granted]: [usize; 2],
) -> Option<Pieces> {
    let smallest = boundary
        .iter()
        .fold(f64::INFINITY, |s, c| s.min(allowance.between(&[c.offset])));
    let mut best: Option<Pieces> = None;
    let charts = match judge {
        Some(_) => CHARTS_OF_SURFACE,
        None => CHARTS,
    };
    for flattening in 0..charts {
        let chart = Chart::new(plane, allowance, smallest, flattening);
        let mut front = match Front::new(chart, positions, observer, boundary, (allowance, judge)) {
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
    /// Coordinates in the chart.
    w: DVec2,
    /// Weights of the triangle's corners.
    weights: DVec3,
    /// A vertex near it.
    hint: FixedVertexHandle,
}

/// A growing triangulation of one source triangle, in a chart.
struct Front<'a> {
    chart: Chart,
    positions: [DVec3; 3],
    observer: DVec3,
    allowance: &'a Allowance,
    /// Under the surface measure.
    judge: Option<&'a Judge>,
    triangulation: ConstrainedDelaunayTriangulation<Point2<f64>>,
    /// The vertices of the triangulation as points of the plane. They are kept outside the triangulation, so that its
    /// own vertices are small and close together in memory.
    points_in_plane: Vec<PlanePoint>,
    /// Weights of the source triangle's corners at each vertex.
    weights: Vec<DVec3>,
    tasks: Queue,
    /// The flaw of each face; NaN if the face need not be divided. A task with a different flaw is out of date.
    flaws: Vec<(f32, FixedFaceHandle<InnerTag>)>,
    boundary: &'a [Corner],
}

impl<'a> Front<'a> {
    /// The triangulation of the boundary alone; `None` if rounding makes points of the boundary coincide.
    fn new(
        chart: Chart,
        positions: [DVec3; 3],
        observer: DVec3,
        boundary: &'a [Corner],
        (allowance, judge): (&'a Allowance, Option<&'a Judge>),
    ) -> Option<Self> {
        let mut front = Self {
            chart,
            positions,
            observer,
            allowance,
            judge,
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

    /// Adds points until no face has to be divided or `max_points` have been added; whether the latter is the case, so
    /// that faces may be left to divide.
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

    /// Adds a task for the face if its gap is too large.
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

    /// The flaw of a face whose gap is too large: the difference between the square of its shortest edge and the square
    /// of the ideal length, both in the chart, divided by the smaller of the two squares. `None` if the gap is within
    /// the allowance.
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
        if is_small || self.across(&along, indices) <= allowed {
            return None;
        }
        // In the gap metric an equilateral triangle with the circumradius R has the gap R^2 / 2 at its middle and the
        // side sqrt(3) R. The metric is evaluated at one corner, picked by the sum of the indices: the newest corner
        // would lie on the same side too often.
        let corner = (indices[0] + indices[1] + indices[2]) % 3;
        let allowed = self.allowed(allowed, offsets[corner], self.weights[indices[corner]]);
        let ideal = 6.0 * AIM * allowed / self.chart.metric([a, b, c][corner]);
        let shortest = sides[0].min(sides[1]).min(sides[2]);
        Some(((shortest - ideal).abs() / shortest.min(ideal)) as f32)
    }

    /// The bound of the surface measure on a face, as a gap; infinity if the face has to count with its gap.
    fn across(&self, along: &Along, indices: [usize; 3]) -> f64 {
        match self.judge {
            Some(judge) => judge.bound(
                along,
                indices.map(|index| &self.points_in_plane[index]),
                indices.map(|index| self.weights[index]),
            ),
            None => f64::INFINITY,
        }
    }

    /// The gap that a face near a place may have, where `allowed` is allowed to points.
    fn allowed(&self, allowed: f64, offset: DVec3, weights: DVec3) -> f64 {
        match self.judge {
            Some(judge) => judge.allowed(allowed, offset, weights),
            None => allowed,
        }
    }

    /// Whether a face is outside the source triangle. All three vertices of such a face are on one side of the source
    /// triangle; in the chart the face lies between the side's arc and its chord.
    fn is_outside(&self, vertices: [usize; 3]) -> bool {
        // A point inside the source triangle is on no side.
        let sides = |vertex: usize| self.boundary.get(vertex).map_or(0, |corner| corner.sides);
        sides(vertices[0]) & sides(vertices[1]) & sides(vertices[2]) != 0
    }

    /// The point to be added for a face: in front of its shortest edge if there is room, else at its worst point or at
    /// its middle.
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
        // Next to the boundary the new point is the worst point, where the gap is largest, or the middle of the face if
        // the worst point is on the boundary itself.
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

    /// The chart point that makes an equilateral triangle of the ideal size on the shortest side of a counter-clockwise
    /// triangle; the circumcentre of the triangle if that is nearer to the side.
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

        let weights = self.chart.plane.weights(self.chart.chart_to_place(middle));
        let offset = mix(self.positions, weights) - self.observer;
        let allowed = self.allowed(self.allowance.between(&[offset]), offset, weights);
        let height = |metric: f64| {
            let radius = (2.0 * AIM * allowed / metric).sqrt();
            if radius > half {
                radius + (radius * radius - half * half).sqrt()
            } else {
                half
            }
        };
        // The height is computed twice, the second time with the mean of the metric between the side and the point.
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

    /// A vertex near the chart point `w`, if `w` is inside the source triangle and not too near to its boundary.
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
                        // The condition compares the point's height above the edge with the edge's length.
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

    /// The pieces; `None` if they do not cover the source triangle exactly once, which rounding may cause.
    ///
    /// They cover it exactly once if no face is turned over and the boundary of all faces together is the boundary of
    /// the source triangle: each edge between neighbouring boundary points occurs once, and every other edge has a face
    /// on both sides.
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
            // The cheap bound shows for most faces that their gap is smaller than one measured before.
            let along = gap_along(&self.chart.plane, points_in_plane);
            let across = self.across(&along, vertices);
            if let Some(judge) = self.judge
                && across == f64::INFINITY
            {
                pieces.cut = pieces.cut.max(judge.cut(offsets));
            }
            let bound = along.bound;
            if bound <= pieces.gap && bound <= self.allowance.between(&offsets) {
                pieces.surface = pieces.surface.max(bound.min(across));
            } else {
                pieces.measure(offsets, self.allowance, across);
            }
            pieces.triangles.push(vertices.map(|vertex| vertex as u32));
        }
        (edges_on_boundary == self.boundary.len()).then_some(pieces)
    }
}

impl Pieces {
    /// Includes the gap of one output triangle, whose corners are offsets from the observer, and its bound as surfaces,
    /// as a gap.
    pub(super) fn measure(&mut self, offsets: [DVec3; 3], allowance: &Allowance, across: f64) {
        let gap = triangle_gap(offsets[0], offsets[1], offsets[2]);
        let surface = gap.min(across);
        self.gap = self.gap.max(gap);
        self.surface = self.surface.max(surface);
        self.complete &= surface <= allowance.between(&offsets);
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
