//! The bound of the surface measure: how far a flat output triangle is from the photosurface of its facet as a surface.
//!
//! Lengths here are *as gaps*: rest-frame lengths that become lengths in the observer's frame by the factor
//! `gamma beta`, as the gap itself does.
//!
//! # Derivation
//!
//! In the observer's frame the photosurface of a facet's whole plane is `gamma beta |d| n` above a plane, along the
//! motion `n`. Because `|d|` is convex, the set `C` of all points above it, in the direction of `n`, is convex, and
//! every output triangle, which interpolates `|d|`, lies in `C`. Let `x(d)` be the point of the mesh for the point `d`
//! of the facet, at the gap `g(d)` from the place `P(d)` where `d` is seen, and `N(d)` the outward unit normal of the
//! photosurface at `P(d)`. A ray from `x(d)` along `N(d)` leaves `C` before it crosses the tangent plane at `P(d)`, so
//! its length is at most `g |n.N|`, exactly; it ends at the seen place `P(f(d))` of a point of the plane. The map `f` is
//! continuous across output triangles of one plane, because gap and normal are.
//!
//! Two things remain: points that `f` moves out of the facets in that plane, and points of the facets that `f` does not
//! reach. A *rim* is an edge beyond which the surface does not go on in the same plane: the edge of a mesh, or a crease.
//! The seen rim and its chord in the mesh lie in a plane that contains `n`; the same argument in this plane bounds the
//! distance between them, both ways, by the *rim cost*: the edge's gap times its share (`motion`), with the tangent of
//! the seen rim or of the chord. (Where the seen rim turns by 90 degrees or more against its chord, the rim cost is the
//! whole gap.)
//!
//! - *A point of a facet that `f` does not reach*: all `d` can be moved to `f(d)` in straight lines. The degree of `f` is
//!   that of the identity except where such a line from a rim passes, so the point is on the line of a point `p` of a
//!   rim. It is then seen between `P(p)` and the end of the ray of `p`, inside the triangle of `x(p)`, `P(p)` and the
//!   point where the ray crosses the tangent plane. Each corner of this triangle is within the rim cost, or within the
//!   length of the ray, of the chord.
//! - *A point of the mesh whose ray ends beyond a rim*: projected along `n` the ray is a straight line in the rest frame.
//!   If the ray makes an acute angle with the outward normals of all output triangles that it passes, it stays between
//!   them and the photosurface, and so it crosses the plane of the rim between the chord and the seen rim. From there
//!   the seen rim is within the rim cost. The distance is at most the length of the ray plus the rim cost.
//!
//! Angles are acute where the facet is *upright*: where no normal of its plane's photosurface, at any place, is more
//! than 35 degrees from the facet's own (for a plane that holds the motion all of them are the same). The normal of an
//! output triangle is `N` with the gradient of its interpolated distance in place of `q`, so this holds for it as well.
//! Elsewhere every output triangle is examined: the normals on it are within 32 degrees of its own, and those along the
//! ray within 45 degrees of the first. An output triangle for which this does not hold counts with its gap, and so do
//! triangles whose own facet has no certain normal: for them `f` is the identity, and between the two kinds it changes
//! along the ray, whose every place is within the larger one of both bounds. A ray that would pass such a triangle ends at
//! the first of its sides: that side is a rim (`Judge::cut`).
//!
//! If the plane holds the motion, `C` is flat. All bounds are continuous in the plane's direction, so they hold there as
//! well.

use glam::DVec3;

use super::along::{Along, PlanePoint};
use super::{Motion, edge_gap};

const EPSILON: f64 = f64::EPSILON;

/// Tangent of the largest angle between a normal of an upright facet and those of its photosurface: 35 degrees.
const UPRIGHT: f64 = 0.7;

/// Tangent of the largest angle between a normal on an output triangle and that of its supporting plane, 16.7 degrees,
/// and cosine of the angle between the latter and its own, 15.1 degrees; both together are less than 32 degrees.
const PLAIN: f64 = 0.3;
const PLAIN_COSINE: f64 = 0.9655;

/// Sine of the largest angle between normals along a ray: 44.5 degrees.
const STEADY: f64 = 0.7;

/// A facet whose normal is less certain than this has no bound.
const UNCERTAIN: f64 = 1e-6;

/// Room for the roundings of a few products.
const UP: f64 = 1.0 + 64.0 * EPSILON;

/// A flat facet at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facet {
    motion: Motion,
    /// Unit normal.
    pub(super) normal: DVec3,
    /// Upper bound on the absolute value of the normal's component along the motion.
    incline: f64,
    /// Upper bound on the error of a seen normal `N`.
    rounding: f64,
    is_upright: bool,
    /// Lower bound on the length of `N` anywhere in the plane of an upright facet; 0 for others.
    least: f64,
}

/// The bounds for one output triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// Length of the longest ray, as a gap.
    pub(super) ray: f64,
    /// How far, at most, a ray leads in the rest frame.
    pub(super) reach: f64,
}

impl Facet {
    /// The facet whose corners have these offsets from the observer; `None` if its normal is not certain.
    pub(super) fn new(motion: &Motion, [a, b, c]: [DVec3; 3]) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let across = ab.cross(ac);
        let area = across.length();
        let longest = ab.length().max(ac.length()).max((c - b).length());
        let farthest = a.length().max(b.length()).max(c.length());
        let error = 16.0 * EPSILON * (farthest / area) * longest;
        if !(error < UNCERTAIN) {
            return None;
        }
        let normal = across / area;
        let (gamma, gamma_beta) = (motion.gamma, motion.gamma_beta);
        let incline = motion.direction.dot(normal).abs() + error;
        let within = (1.0 - incline * incline).max(0.0).sqrt() + error;
        // In an upright facet's plane the part of N along the facet's normal is at least this.
        let least = gamma
            - (gamma - 1.0) * incline * incline
            - gamma_beta * within
            - 16.0 * (EPSILON + error) * gamma;
        let sideways = incline * ((gamma - 1.0) * within + gamma_beta);
        let is_upright = least > 0.0 && sideways <= UPRIGHT * least;
        Some(Self {
            motion: *motion,
            normal,
            incline,
            rounding: 16.0 * (EPSILON + error) * gamma,
            is_upright,
            least: if is_upright { least } else { 0.0 },
        })
    }

    pub(super) fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Whether gaps hardly lead away from the photosurface, wherever they are.
    pub(super) fn holds_the_motion(&self) -> bool {
        const HARDLY: f64 = 1e-6;
        self.incline <= HARDLY * self.least
    }

    /// The share of a gap at this offset from the observer: not rounded up.
    pub(super) fn share(&self, offset: DVec3) -> f64 {
        self.motion.share(self.normal, offset.normalize_or_zero())
    }

    /// The largest gap of triangles on a piece of an edge between these offsets that will hardly count with their gaps: on
    /// the piece the normals of the photosurface turn little, and so they do along a ray; zero where they turn too much.
    pub(super) fn plain_gap(&self, offsets: &[DVec3]) -> f64 {
        /// Sine of the angle by which normals may turn along an edge: half of what they may within a triangle.
        const TURN: f64 = 0.15;
        if self.is_upright {
            return f64::INFINITY;
        }
        let normals = offsets.iter().map(|offset| {
            self.motion
                .seen_normal(self.normal, offset.normalize_or_zero())
        });
        let mut first: Option<DVec3> = None;
        let gaps = normals.zip(offsets).map(|(normal, offset)| {
            let length = normal.length();
            let from = *first.get_or_insert(normal);
            let turns = normal.cross(from).length() > TURN * length * from.length();
            if turns || !(normal.dot(from) > 0.0) {
                return 0.0;
            }
            // As `is_steady`, with room.
            let reach = 0.5 * STEADY * length * offset.length() / self.motion.gamma_beta;
            0.5 * length * reach / self.motion.gamma_beta
        });
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// About how far a ray of this length, as a gap, leads in the rest frame.
    pub(super) fn reach_of(&self, ray: f64) -> f64 {
        2.0 * self.motion.gamma_beta * ray / self.incline
    }

    /// The bounds for an output triangle in this facet; `None` if it has to count with its gap.
    pub(super) fn across(&self, along: &Along, corners: [&PlanePoint; 3]) -> Option<Across> {
        let gap = along.bound;
        if !gap.is_finite() {
            return None;
        }
        let (mut ray, mut least) = (f64::INFINITY, 0.0);
        if self.is_upright {
            ray = gap * (self.incline / self.least);
            least = self.least;
        }
        if let Some((of_triangle, least_here)) = self.examined(along, corners) {
            ray = ray.min(of_triangle);
            least = least_here.max(least);
        } else if !self.is_upright {
            return None;
        }
        let reach = 2.0 * self.motion.gamma_beta * gap / least * UP;
        if !self.is_upright {
            let nearest = corners
                .iter()
                .fold(f64::INFINITY, |near, corner| near.min(corner.distance));
            let nearest = nearest * (1.0 - 4.0 * EPSILON) - gap - reach;
            let is_steady =
                nearest > 0.0 && self.motion.gamma_beta * (reach / nearest) <= STEADY * least;
            if !is_steady {
                return None;
            }
        }
        Some(Across {
            ray: ray * UP,
            reach,
        })
    }

    /// The longest ray, as a gap, and the shortest normal `N`, of an output triangle on which normals differ little.
    ///
    /// # Derivation
    ///
    /// For every vector `G` with `|G| <= 1` the plane above which `|d|` is at least `G.d` supports `C`. Its normal is that
    /// of a point in the direction `G`, and no point of the triangle is farther from it than the bound of `gap_along` for
    /// the same `G`, times the share for `G`. A ray leaves `C` before it crosses this plane, at the distance divided by
    /// the cosine of the angle between both normals.
    ///
    /// The vector `r N` is linear in `d` and `r`. With `r = R - e`, where `R` interpolates the distances of the corners,
    /// it is the interpolation of `r N` between the corners minus `e` times `N` for `q = 0`. This bounds its direction and
    /// its length from the corners.
    fn examined(&self, along: &Along, corners: [&PlanePoint; 3]) -> Option<(f64, f64)> {
        let axis = self.motion.seen_normal(self.normal, along.direction);
        let length = axis.length();
        let axis = axis / length;
        let own = self.motion.seen_normal(self.normal, along.slope);
        if !(own.dot(axis) >= PLAIN_COSINE * own.length() && self.rounding < 0.01 * length) {
            return None;
        }
        let parts = |normal: DVec3| {
            let along = normal.dot(axis);
            (along, (normal - axis * along).length())
        };
        let (mut shortest, mut slope, mut farthest) = (f64::INFINITY, 0.0f64, 0.0f64);
        for corner in corners {
            let normal = self
                .motion
                .seen_normal(self.normal, corner.offset / corner.distance);
            let (along, sideways) = parts(normal);
            shortest = shortest.min(corner.distance * (along - self.rounding));
            slope = slope.max((sideways + self.rounding) / (along - self.rounding));
            farthest = farthest.max(corner.distance);
        }
        let (along_base, sideways_base) = parts(self.motion.seen_normal(self.normal, DVec3::ZERO));
        let gap = along.bound;
        let least = shortest - gap * (along_base + self.rounding).max(0.0);
        let sideways = slope * shortest + gap * (sideways_base + self.rounding);
        let tangent = sideways / least;
        if !(shortest > 0.0 && least > 0.0 && tangent <= PLAIN) {
            return None;
        }
        let share = (self.incline / (length - self.rounding)).min(1.0);
        Some((
            gap * share * (1.0 + tangent * tangent).sqrt(),
            least / farthest,
        ))
    }
}

/// The rim cost of an output edge between two offsets from the observer, as a gap.
pub(super) fn rim_cost(motion: &Motion, a: DVec3, b: DVec3) -> f64 {
    let gap = edge_gap(a, b);
    let (r_a, r_b) = (a.length(), b.length());
    let length = (b - a).length();
    let along = (b - a) / length;
    let (slope_a, slope_b) = (along.dot(a) / r_a, along.dot(b) / r_b);
    if !(slope_a.is_finite() && slope_b.is_finite()) {
        return gap;
    }
    let chord = motion.edge_part(along, (r_b - r_a) / length);
    let across = along.cross(motion.direction).length_squared();
    let turns_little = |slope: f64| across + motion.edge_part(along, slope) * chord > 0.0;
    if !(turns_little(slope_a) && turns_little(slope_b)) {
        return gap;
    }
    gap * motion.edge_share(along, (slope_a, slope_b)) * UP
}
