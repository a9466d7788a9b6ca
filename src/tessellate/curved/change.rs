//! Changes of a net: an edge divided, a vertex added or taken away, an edge turned.

use glam::DVec2;

use super::bent::{Arc, Bent};
use super::estimate::Estimate;
use super::net::{NONE, Net, next, previous, triangle_of};
use crate::shape::{Piece, Spot};

/// How a triangle becomes smaller at one of its sides.
pub(super) enum Division {
    /// This side is divided.
    Of(u32),
    /// This side is turned, to make these triangles.
    Turn(u32, [[u32; 3]; 2]),
}

impl Net<'_> {
    fn link(&mut self, a: u32, b: u32) {
        self.twins[a as usize] = b;
        self.twins[b as usize] = a;
    }

    fn put(&mut self, triangle: usize, corners: [u32; 3]) {
        self.triangles[triangle] = corners;
        for (k, corner) in corners.into_iter().enumerate() {
            self.vertices[corner as usize].out = (3 * triangle + k) as u32;
        }
    }

    fn push(&mut self, corners: [u32; 3], of: u8) -> usize {
        let triangle = self.triangles.len();
        self.triangles.push(corners);
        self.of.push(of);
        self.twins.extend([NONE; 3]);
        self.estimates.push(Estimate::default());
        self.alive.push(true);
        self.put(triangle, corners);
        triangle
    }

    /// The half-edges beyond the two triangles at an edge: of an edge from `a` to `b` between `c` and `d` those beyond the
    /// sides `bc`, `ca`, `ad` and `db`.
    fn beyond(&self, half_edge: u32) -> [u32; 4] {
        let twin = self.twin(half_edge);
        let sides = [
            next(half_edge),
            previous(half_edge),
            next(twin),
            previous(twin),
        ];
        sides.map(|side| self.twin(side))
    }

    /// The spot in the middle of an edge.
    fn middle(&self, half_edge: u32) -> Spot {
        let (start, end) = (self.start(half_edge), self.end(half_edge));
        if self.is_rim(half_edge) {
            return self.middle_of_rim(start, end);
        }
        let piece = self.piece_of(triangle_of(half_edge));
        let [a, b] = [start, end].map(|vertex| self.vertices[vertex as usize].spot);
        if let Piece::Ball { .. } = piece {
            return piece.spot_near(0.5 * (a.at + b.at));
        }
        let (mut from, mut to) = (piece.parameters(&a), piece.parameters(&b));
        let periods = piece.periods();
        for axis in 0..2 {
            let step = to[axis] - from[axis];
            from[axis] += if periods[axis] > 0.0 {
                step.round()
            } else {
                0.0
            };
        }
        if piece.is_pole(&a) {
            from.x = to.x;
        } else if piece.is_pole(&b) {
            to.x = from.x;
        }
        let mut middle = 0.5 * (from + to);
        for axis in 0..2 {
            if periods[axis] > 0.0 {
                middle[axis] = middle[axis].rem_euclid(1.0);
            }
        }
        Spot::inside(middle.extend(0.0))
    }

    /// Divides an edge in its middle; returns the four triangles at the new vertex.
    pub(super) fn split(&mut self, half_edge: u32) -> [usize; 4] {
        let middle = self.middle(half_edge);
        self.split_at(half_edge, middle)
    }

    /// Divides an edge at a spot that the observer sees next to the middle of the edge, as seen; returns the four triangles.
    pub(super) fn split_as_seen(&mut self, half_edge: u32, number: usize) -> [usize; 4] {
        let middle = self.middle(half_edge);
        if self.is_rim(half_edge) {
            return self.split_at(half_edge, middle);
        }
        let triangle = triangle_of(half_edge);
        let corners = self.triangles[triangle];
        let k = (half_edge as usize + 2) % 3;
        let mut fixed = [Some(Arc::OfFacet); 3];
        fixed[k] = None;
        let facet = self.facet(corners, self.of[triangle]);
        let sight = &self.task.sights[number];
        let bent = Bent::new(facet, sight, self.seen_by(number, corners), fixed);
        let [_, x, y] = [0, 1, 2].map(|corner| if corner == k { 0.0 } else { 0.5 });
        let piece = self.piece_of(triangle);
        let spot = piece.spot_near(bent.place(DVec2::new(x, y)));
        let [a, b, c, d] = [
            half_edge,
            next(half_edge),
            previous(half_edge),
            previous(self.twin(half_edge)),
        ]
        .map(|e| self.start(e));
        let of = self.of[triangle];
        let m = self.add(spot, of);
        let is_sound = [[a, m, c], [m, b, c], [b, m, d], [m, a, d]]
            .iter()
            .all(|&made| self.may_be(made, of));
        self.take_last_vertex();
        self.split_at(half_edge, if is_sound { spot } else { middle })
    }

    /// How a triangle becomes smaller at a side. If a corner opposite the side is in its middle already, as after another
    /// triangle's side was divided there, dividing it would make the same triangles again, and again: then the triangle's
    /// longest side is divided, and if that is this one, it is turned, or if it cannot be, the next longest side is divided.
    pub(super) fn division(&self, half_edge: u32) -> Division {
        /// Corners nearer to the middle than this part of the side are in it.
        const NEAR: f64 = 1e-2;
        let place = |vertex: u32| self.vertices[vertex as usize].place;
        let length = |e: u32| place(self.start(e)).distance(place(self.end(e)));
        let twin = self.twin(half_edge);
        let middle = self.middle(half_edge);
        let middle = self.piece_of(triangle_of(half_edge)).place_of(&middle);
        let near = NEAR * length(half_edge);
        let is_in_it = |e: u32| place(self.start(e)).distance(middle) <= near;
        if ![previous(half_edge), previous(twin)]
            .into_iter()
            .any(is_in_it)
        {
            return Division::Of(half_edge);
        }
        let [one, two] = [next(half_edge), previous(half_edge)];
        let longest = if length(two) > length(one) { two } else { one };
        if length(longest) > length(half_edge) {
            return Division::Of(longest);
        }
        let of = self.of[triangle_of(half_edge)];
        let may_turn = |made: &[[u32; 3]; 2]| {
            let [_, d, c] = made[0];
            !self.divided.contains(&[c.min(d), c.max(d)])
                && made.iter().all(|&made| self.may_be(made, of))
        };
        match self.turned(half_edge).filter(may_turn) {
            Some(made) => Division::Turn(half_edge, made),
            None => Division::Of(longest),
        }
    }

    fn split_at(&mut self, half_edge: u32, spot: Spot) -> [usize; 4] {
        let twin = self.twin(half_edge);
        let (t0, t1) = (triangle_of(half_edge), triangle_of(twin));
        let (a, b) = (self.start(half_edge), self.start(twin));
        let (c, d) = (self.start(previous(half_edge)), self.start(previous(twin)));
        let [bc, ca, ad, db] = self.beyond(half_edge);
        let m = self.add(spot, self.of[t0]);
        self.put(t0, [a, m, c]);
        self.put(t1, [b, m, d]);
        let t2 = self.push([m, b, c], self.of[t0]);
        let t3 = self.push([m, a, d], self.of[t1]);
        let at = |triangle: usize, k: usize| (3 * triangle + k) as u32;
        for (x, y) in [
            (at(t0, 0), at(t3, 0)),
            (at(t0, 1), at(t2, 2)),
            (at(t0, 2), ca),
            (at(t2, 0), at(t1, 0)),
            (at(t2, 1), bc),
            (at(t1, 1), at(t3, 2)),
            (at(t1, 2), db),
            (at(t3, 1), ad),
        ] {
            self.link(x, y);
        }
        [t0, t1, t2, t3]
    }

    /// Puts a vertex into a triangle; returns the three triangles at it.
    pub(super) fn insert(&mut self, triangle: usize, spot: Spot) -> [usize; 3] {
        let of = self.of[triangle];
        let m = self.add(spot, of);
        let [a, b, c] = self.triangles[triangle];
        let at = |triangle: usize, k: usize| (3 * triangle + k) as u32;
        let [ab, bc, ca] = [0, 1, 2].map(|k| self.twin(at(triangle, k)));
        self.put(triangle, [a, b, m]);
        let t1 = self.push([b, c, m], of);
        let t2 = self.push([c, a, m], of);
        for (x, y) in [
            (at(triangle, 0), ab),
            (at(t1, 0), bc),
            (at(t2, 0), ca),
            (at(triangle, 1), at(t1, 2)),
            (at(t1, 1), at(t2, 2)),
            (at(t2, 1), at(triangle, 2)),
        ] {
            self.link(x, y);
        }
        [triangle, t1, t2]
    }

    /// The triangles that turning an edge would make; `None` if it is a chord of a rim, or if the new edge is there already.
    pub(super) fn turned(&self, half_edge: u32) -> Option<[[u32; 3]; 2]> {
        if self.is_rim(half_edge) {
            return None;
        }
        let twin = self.twin(half_edge);
        let (a, b) = (self.start(half_edge), self.start(twin));
        let (c, d) = (self.start(previous(half_edge)), self.start(previous(twin)));
        (c != d && !self.are_neighbours(c, d)).then_some([[a, d, c], [d, b, c]])
    }

    /// Turns an edge, so that it joins the two corners opposite it; returns the two triangles.
    pub(super) fn turn(&mut self, half_edge: u32, made: [[u32; 3]; 2]) -> [usize; 2] {
        let twin = self.twin(half_edge);
        let (t0, t1) = (triangle_of(half_edge), triangle_of(twin));
        let [bc, ca, ad, db] = self.beyond(half_edge);
        self.put(t0, made[0]);
        self.put(t1, made[1]);
        let at = |triangle: usize, k: usize| (3 * triangle + k) as u32;
        self.link(at(t0, 0), ad);
        self.link(at(t0, 1), at(t1, 2));
        self.link(at(t0, 2), ca);
        self.link(at(t1, 0), db);
        self.link(at(t1, 1), bc);
        [t0, t1]
    }

    /// Takes the start of an edge away, so that its triangles end at the other end; returns those that have changed.
    pub(super) fn collapse(&mut self, half_edge: u32) -> Vec<usize> {
        let twin = self.twin(half_edge);
        let (gone, kept) = (self.start(half_edge), self.end(half_edge));
        let star = self.star(gone);
        let removed = [triangle_of(half_edge), triangle_of(twin)];
        let [bc, ca, ad, db] = self.beyond(half_edge);
        let mut changed = vec![];
        for half_edge in star {
            let triangle = triangle_of(half_edge);
            if !removed.contains(&triangle) {
                let mut corners = self.triangles[triangle];
                corners[half_edge as usize % 3] = kept;
                self.put(triangle, corners);
                changed.push(triangle);
            }
        }
        for triangle in removed {
            self.alive[triangle] = false;
        }
        self.link(bc, ca);
        self.link(ad, db);
        for half_edge in [bc, ca, ad, db] {
            let triangle = triangle_of(half_edge);
            self.put(triangle, self.triangles[triangle]);
            if !changed.contains(&triangle) {
                changed.push(triangle);
            }
        }
        self.vertices[gone as usize].out = NONE;
        for &triangle in &changed {
            self.update(triangle);
        }
        changed
    }
}
