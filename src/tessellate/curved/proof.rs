//! Proven bounds on the distance between a flat triangle and the true curved photosurface.
//!
//! # What is proven
//!
//! Let `M` be the mesh and `S` the photosurface of a round shape. Each triangle has a patch of `S` over it, by a chart whose
//! parameters are the weights of its corners; together, in the charts of the pieces, they map `M` onto `S` once.
//!
//! **Same weights.** If no place of a patch is farther than `b` from the place of the triangle with the same weights, then
//! each place of `M` has one of `S` within `b`, and the other way round ([`Proof::of_points`]).
//!
//! **Along normals.** Sliding along the surface costs nothing. Let `N` be the normal of the flat triangle and `f = N.error`
//! the height of the patch over its plane. In the weights that the patch and its neighbourhood have in that plane, as
//! seen along `N`, the patch is the graph of a function if weights and weights in the plane differ by a map that brings
//! no two places closer than by a fixed factor (`is_graph`). From each place `x` of the triangle a line in the direction
//! `n(x)`, the mean of the corners' seen normals, then meets the graph in exactly one place, where the graph's height is at
//! most `h`, the largest `|f|` over the triangle and so much around it as lines and weights reach. That place is within
//! `h / min(N.n)` of `x`. It depends on `x` alone, also on an edge between two triangles, and changes with `x`
//! continuously; along the surface it can be moved to the place with the same weights. So these places cover `S` as often
//! as those do, once, and the bound holds both ways ([`Proof::of_surface`]).
//!
//! **Rims.** A triangle with a chord of a rim has a chart in which that side follows the arc, and is compared at the same
//! weights. On a lid the side is a parabola with the arc's ends and middle. With the sagitta `s` of an arc of radius `R` no
//! place of the parabola is farther than `s^2 / (7 R)` from the arc.
//!
//! Where neighbours are compared in these two ways, the places that belong to one place of their common edge differ: both
//! are within its bound, and so is the way between them along the surface, but for its bend, which [`MIXED`] has room for.

use std::array::from_fn;

use glam::{DVec2, DVec3};

use super::bent::{Arc, Bent};
use super::chart::Facet;
use super::patch::{Bend, Corner, Patch};
use super::sight::About;
use super::sight::Sight;

/// The corners of a whole triangle.
const WHOLE: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

/// The largest part of a triangle's size by which the patch may be looked at around the triangle.
const WIDEST: f64 = 0.4;

/// The least cosine between the normals of a triangle and of its corners.
const LEAST_COSINE: f64 = 0.1;

/// How much the weights of a patch and those in the plane may differ per weight, summed over the three corners; at 2 two
/// places might fall together.
const MOST_SHIFT: f64 = 1.2;

/// Room for the sum of the terms that keep lines from meeting a graph twice.
const SLOPE_ROOM: f64 = 0.9;

/// Room for the bend of the way between the places that two neighbours take for one place of their edge.
const MIXED: f64 = 1.002;

/// How often a part is halved, and how many places of a triangle are looked at in one way.
const HALVINGS: u32 = 40;
const CONDITION_HALVINGS: u32 = 8;
const MOST_LOOKS: u32 = 600;

/// A triangle of which something is proven.
pub(super) struct Proof<'a> {
    chart: Bent,
    straight: Bent,
    sight: &'a Sight,
    seen: [DVec3; 3],
    /// How many places have been looked at, and up to how many parts are halved.
    looks: u32,
    most: u32,
}

/// What has to hold for the patch to be a graph.
struct Conditions {
    /// The gradients of the three weights in the triangle's plane, and its normal.
    gradients: [DVec3; 3],
    normal: DVec3,
    /// The least cosine between the normal and those of the corners.
    cosine: f64,
    /// How far lines reach aside, in weights.
    lines: [f64; 3],
    /// How much lines lean, in weights per length.
    lean: f64,
    /// How far around the triangle the patch is looked at, in weights.
    wide: f64,
}

/// Where the conditions are met in a part.
enum Met {
    Everywhere,
    Nowhere,
    Unknown,
}

impl Conditions {
    /// Where a part with this patch and these bends, of its height and of the weights, keeps to the conditions.
    fn met(&self, part: &[Corner; 3], patch: &Patch, height: &Bend, weights: &[Bend; 3]) -> Met {
        // In its plane the flat triangle has the gradients of the weights themselves.
        const OWN: [DVec2; 3] = [DVec2::NEG_ONE, DVec2::X, DVec2::Y];
        const SIDES: [DVec2; 3] = [DVec2::X, DVec2::Y, DVec2::new(-1.0, 1.0)];
        let steepest = SLOPE_ROOM * (1.0 - 0.5 * MOST_SHIFT) * self.cosine;
        let [a, b, c] = weights;
        let shifted = [(a, OWN[0]), (b, OWN[1]), (c, OWN[2])];
        // The largest shift and slope along any side: in the middle, and anywhere.
        let (mut shift, mut slope) = ([0.0f64; 2], [0.0f64; 2]);
        for side in SIDES {
            let shifts = patch.slope(&shifted, side, MOST_SHIFT);
            let slopes = patch.slope(&[(height, DVec2::ZERO)], side, steepest / self.lean);
            for k in 0..2 {
                shift[k] = shift[k].max(shifts[k]);
                slope[k] = slope[k].max(slopes[k]);
            }
        }
        let fits = |k: usize| shift[k] <= MOST_SHIFT && self.lean * slope[k] <= steepest;
        let moved = |k: usize| {
            let at_corners = part
                .iter()
                .map(|corner| self.gradients[k].dot(corner.error).abs());
            at_corners.fold(0.0, f64::max) + self.lines[k]
        };
        let most = |k: usize| patch.largest(&weights[k], self.gradients[k], part) + self.lines[k];
        if fits(1) && (0..3).all(|k| most(k) <= self.wide) {
            return Met::Everywhere;
        }
        match fits(0) && (0..3).all(|k| moved(k) <= self.wide) {
            true => Met::Unknown,
            false => Met::Nowhere,
        }
    }
}

impl<'a> Proof<'a> {
    /// The triangle with these seen corners; `rims` tells how the sides opposite each corner follow the arcs of rims.
    pub(super) fn new(
        facet: Facet,
        about: About,
        sight: &'a Sight,
        seen: [DVec3; 3],
        rims: [Option<Arc>; 3],
    ) -> Self {
        let straight = Bent::straight(facet);
        let chart = match about {
            About::Surface => Bent::new(facet, sight, seen, rims),
            About::Points => straight,
        };
        Self {
            chart,
            straight,
            sight,
            seen,
            looks: 0,
            most: MOST_LOOKS,
        }
    }

    /// How many places have been looked at.
    pub(super) fn looks(&self) -> u64 {
        u64::from(self.looks)
    }

    /// An upper bound on the distance of places with the same weights; where there is none within `limit`, any number above
    /// it.
    pub(super) fn of_points(&mut self, limit: f64) -> f64 {
        let part = WHOLE.map(|at| self.corner(at));
        let axes = self.axes();
        self.over(part, &axes, limit, HALVINGS)
    }

    /// An upper bound on the distance of the triangle and the patch as surfaces; where there is none within `limit`, any
    /// number above it. `normals` are those of the photosurface at the corners; that of a tip is any other one.
    pub(super) fn of_surface(&mut self, normals: [DVec3; 3], limit: f64) -> f64 {
        let along_normals = self.along_normals(normals, limit);
        if along_normals <= limit {
            return along_normals;
        }
        along_normals.min(self.of_any_chart(limit))
    }

    /// An upper bound on the distance of places with the same weights, in the chart that is better for it; where there is none
    /// within `limit`, any number above it.
    pub(super) fn of_any_chart(&mut self, limit: f64) -> f64 {
        self.most = self.looks + MOST_LOOKS;
        let bent = self.of_points(limit / MIXED) * MIXED;
        if bent <= limit {
            return bent;
        }
        self.most = self.looks + MOST_LOOKS;
        self.chart = self.straight;
        bent.min(self.of_points(limit / MIXED) * MIXED)
    }

    /// The same for a triangle at rest with one corner in the tip of a cone. Each place of the patch is as far from that of the
    /// triangle as the place of the opposite side on the same ruling, times the part of the way from the tip, since both are
    /// linear along it and meet in the tip. So that side tells all.
    pub(super) fn of_tip_at_rest(&mut self, tip: usize, limit: f64) -> f64 {
        let [i, j] = [(tip + 1) % 3, (tip + 2) % 3];
        let side = self.seen[i].distance(self.seen[j]);
        let way = self.seen[i].distance(self.seen[tip]);
        // A part beside it that is about as wide as long.
        let inwards = (0.5 * side / way).min(0.5);
        let middle = 0.5 * (WHOLE[i] + WHOLE[j]);
        let inside = middle.lerp(WHOLE[tip], inwards);
        self.chart = self.straight;
        let part = [WHOLE[i], WHOLE[j], inside].map(|at| self.corner(at));
        let axes = self.axes();
        self.over(part, &axes, limit / MIXED, HALVINGS) * MIXED
    }

    /// The same for a triangle with a chord of a rim, of which no place of a side is farther from its arc than `beside`, in
    /// the shape's own frame.
    pub(super) fn of_rim(&mut self, beside: f64, limit: f64) -> f64 {
        let part = WHOLE.map(|at| self.corner(at));
        let patch = Patch::new(&self.chart, self.sight, &part);
        let beside = beside * patch.steepest(self.sight);
        self.of_points((limit - beside) / MIXED) * MIXED + beside
    }

    fn corner(&mut self, at: DVec2) -> Corner {
        self.looks += 1;
        let offset = self.sight.offset(self.chart.place(at));
        let [a, b, c] = self.seen;
        let flat = a * (1.0 - at.x - at.y) + b * at.x + c * at.y;
        Corner {
            at,
            offset,
            error: self.sight.seen_at(offset) - flat,
        }
    }

    /// Unit vectors at right angles, the first along the triangle's normal, the second along the motion as far as it can be.
    fn axes(&self) -> [DVec3; 3] {
        let [a, b, c] = self.seen;
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::X);
        let motion = self.sight.motion - normal * normal.dot(self.sight.motion);
        let along = motion.try_normalize().filter(|_| motion.length() > 1e-3);
        let along = along.unwrap_or_else(|| normal.any_orthonormal_vector());
        [normal, along, normal.cross(along)]
    }

    /// The gradients of the three weights in the plane of the triangle.
    fn gradients(&self) -> Option<[DVec3; 3]> {
        let [a, b, c] = self.seen;
        let area = (b - a).cross(c - a);
        let square = area.length_squared();
        let found = [c - b, a - c, b - a].map(|side| area.cross(side) / square);
        found.iter().all(|g| g.is_finite()).then_some(found)
    }

    fn along_normals(&mut self, normals: [DVec3; 3], limit: f64) -> f64 {
        let [a, b, c] = self.seen;
        let Some(normal) = (b - a).cross(c - a).try_normalize() else {
            return f64::INFINITY;
        };
        let Some(gradients) = self.gradients() else {
            return f64::INFINITY;
        };
        let cosine = normals.iter().map(|n| n.dot(normal)).fold(1.0, f64::min) * (1.0 - 1e-12);
        if !(cosine > LEAST_COSINE) {
            return f64::INFINITY;
        }
        let lines = gradients.map(|g| {
            let lean = normals.iter().map(|n| g.dot(*n).abs()).fold(0.0, f64::max);
            lean * limit / cosine
        });
        let lean = |n: &DVec3| 0.5 * gradients.iter().map(|g| g.dot(*n).abs()).sum::<f64>();
        let shift = |corner: &Corner| gradients.map(|g| g.dot(corner.error).abs());
        let near = widened(0.05).map(|at| self.corner(at));
        let guess = near
            .iter()
            .map(shift)
            .fold([0.0; 3], |a, b| from_fn(|k| f64::max(a[k], b[k])));
        let guess = (0..3).map(|k| guess[k] + lines[k]).fold(0.0, f64::max);
        let wide = 1.5 * guess + 0.02;
        if !(wide < WIDEST) {
            return f64::INFINITY;
        }
        let conditions = Conditions {
            lean: normals.iter().map(lean).fold(0.0, f64::max),
            gradients,
            normal,
            cosine,
            lines,
            wide,
        };
        let part = widened(wide).map(|at| self.corner(at));
        let height = self.height(part, &conditions, limit * cosine, HALVINGS, false);
        height.map_or(f64::INFINITY, |height| height / cosine)
    }

    /// An upper bound on the height of the patch over a part; where there is none within `limit`, any number above it. `None`
    /// if the part does not keep to the conditions; `is_graph` says that it is known to keep to them.
    fn height(
        &mut self,
        part: [Corner; 3],
        conditions: &Conditions,
        limit: f64,
        halvings: u32,
        is_graph: bool,
    ) -> Option<f64> {
        let normal = conditions.normal;
        let at_corners = part.iter().map(|corner| normal.dot(corner.error).abs());
        let at_corners = at_corners.fold(0.0, f64::max);
        if at_corners > limit {
            return Some(at_corners);
        }
        let patch = Patch::new(&self.chart, self.sight, &part);
        let height = patch.bend(self.sight, normal);
        let is_last = halvings == 0 || self.looks > self.most;
        if !is_graph {
            let weights: [Bend; 3] = from_fn(|k| patch.bend(self.sight, conditions.gradients[k]));
            match conditions.met(&part, &patch, &height, &weights) {
                Met::Everywhere => {}
                Met::Nowhere => return None,
                Met::Unknown if is_last || halvings + CONDITION_HALVINGS <= HALVINGS => {
                    return None;
                }
                Met::Unknown => {
                    let halves = self.halves(&part, &patch, &weights);
                    return self.higher(halves, conditions, limit, halvings - 1, false);
                }
            }
        }
        let bound = patch.largest(&height, normal, &part).max(at_corners);
        if bound <= limit || is_last {
            return Some(bound);
        }
        let halves = self.halves(&part, &patch, &[height]);
        self.higher(halves, conditions, limit, halvings - 1, true)
    }

    /// The larger bound of two parts, as [`Self::height`].
    fn higher(
        &mut self,
        [a, b]: [[Corner; 3]; 2],
        conditions: &Conditions,
        limit: f64,
        halvings: u32,
        is_graph: bool,
    ) -> Option<f64> {
        let of_one = self.height(a, conditions, limit, halvings, is_graph)?;
        if of_one > limit {
            return Some(of_one);
        }
        let of_other = self.height(b, conditions, limit, halvings, is_graph)?;
        Some(of_one.max(of_other))
    }

    /// The halves of a part, whose longest side is divided: that which bends most, where that is known.
    fn halves(&mut self, part: &[Corner; 3], patch: &Patch, bends: &[Bend]) -> [[Corner; 3]; 2] {
        let bent = |k: usize| {
            bends
                .iter()
                .map(|bend| patch.along(bend, k))
                .fold(0.0, f64::max)
        };
        let mut sizes: [f64; 3] = from_fn(bent);
        if bends.iter().any(|bend| patch.is_vague(bend)) {
            sizes = from_fn(|k| (part[(k + 2) % 3].offset - part[(k + 1) % 3].offset).length());
        }
        let k = (0..3).fold(0, |best, k| if sizes[k] > sizes[best] { k } else { best });
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let middle = self.corner(0.5 * (part[i].at + part[j].at));
        let (mut a, mut b) = (*part, *part);
        (a[j], b[i]) = (middle, middle);
        [a, b]
    }

    /// An upper bound on the largest error over a part, from its components along three `axes` at right angles; where there
    /// is none within `limit`, any number above it.
    fn over(&mut self, part: [Corner; 3], axes: &[DVec3; 3], limit: f64, halvings: u32) -> f64 {
        let lengths = part.iter().map(|corner| corner.error.length());
        let at_corners = lengths.fold(0.0, f64::max);
        if at_corners > limit {
            return at_corners;
        }
        let patch = Patch::new(&self.chart, self.sight, &part);
        let bends: [Bend; 3] = from_fn(|k| patch.bend(self.sight, axes[k]));
        let length = |of: &dyn Fn(usize) -> f64| DVec3::from_array(from_fn(of)).length();
        let bulge = length(&|k| patch.bulge(&bends[k]));
        let each = length(&|k| patch.largest(&bends[k], axes[k], &part));
        let bound = (at_corners + bulge).min(each);
        if bound <= limit || halvings == 0 || self.looks > self.most {
            return bound.max(at_corners);
        }
        let [a, b] = self.halves(&part, &patch, &bends);
        let of_one = self.over(a, axes, limit, halvings - 1);
        if of_one > limit {
            return of_one;
        }
        of_one.max(self.over(b, axes, limit, halvings - 1))
    }
}

/// The corners of a triangle that holds all places whose weights are at least `-wide`.
fn widened(wide: f64) -> [DVec2; 3] {
    let (far, aside) = (1.0 + 2.0 * wide, -wide);
    [
        DVec2::new(aside, aside),
        DVec2::new(far, aside),
        DVec2::new(aside, far),
    ]
}
