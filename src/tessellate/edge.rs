//! The edge rule: the points that divide an edge depend on its two ends and on the planes of all facets that share it.

use glam::DVec3;

use super::across::Facet;
use super::{Allowance, Motion, edge_gap};

/// Allowed gap of an edge as a fraction of the allowed gap of a triangle.
///
/// The gap of an equilateral triangle's edge is three quarters of the gap of the triangle. A smaller fraction makes
/// smaller triangles along the edges of the mesh than inside; a larger one leaves the triangles inside no room to be
/// equilateral. On the plates of the benchmark the fractions 0.6 and 0.9 cost 3 to 40 per cent more triangles.
pub(super) const EDGE_SHARE: f64 = 0.75;

/// Under the surface measure: the rim cost of an edge as a fraction of the tolerance. The rest is for the rays of the
/// triangles beside it.
const RIM_SHARE: f64 = 0.5;

/// The same fraction where all facets of the edge hold the motion, so that their rays have no length.
const RIM_SHARE_ALONE: f64 = 0.9;

/// Under the surface measure: the same as [`EDGE_SHARE`] for an edge that is no rim, of what [`RIM_SHARE`] leaves.
const FREE_SHARE: f64 = EDGE_SHARE * (1.0 - RIM_SHARE);

/// An edge whose facets need few pieces, and count with their gaps, stays whole up to this multiple of its allowed gap.
/// Divided edges on all sides of a triangle that is hardly too large would make four of it where two suffice.
pub(super) const SPARED: f64 = 0.95 / EDGE_SHARE;

/// Number of pieces of the quadrature along an edge. The result is checked, so more digits are not needed.
const SAMPLES: usize = 64;

/// How large gaps along an edge may be: the same for every triangle of the edge, because it takes the smallest of what
/// its facets allow.
pub(super) struct EdgeRule<'a> {
    pub(super) allowance: &'a Allowance,
    /// The motion, under the surface measure.
    pub(super) motion: Option<&'a Motion>,
    /// The facets of all triangles that share the edge, under the surface measure; `None` for those that count with
    /// their gaps.
    pub(super) facets: &'a [Option<Facet>],
    /// Whether the surface goes on in one plane beyond the edge.
    pub(super) is_free: bool,
}

impl EdgeRule<'_> {
    /// The allowed gap of a piece between these offsets from the observer, of an edge with a unit direction.
    pub(super) fn allowed(&self, offsets: &[DVec3], along: DVec3) -> f64 {
        let allowed = self.allowance.between(offsets);
        let Some(motion) = self.motion else {
            return EDGE_SHARE * allowed;
        };
        let of_facet = |facet: &Option<Facet>| {
            let Some(facet) = facet else {
                return EDGE_SHARE;
            };
            let shares = offsets.iter().map(|&offset| facet.share(offset));
            let inside = FREE_SHARE / shares.fold(0.0, f64::max);
            let share = match self.is_free {
                true => inside,
                false => inside.min(rim_share(facet) / rim_gap_share(motion, offsets, along)),
            };
            let plain = EDGE_SHARE * (facet.plain_gap(offsets) / allowed);
            share.min(plain.max(EDGE_SHARE))
        };
        let shares = self.facets.iter().map(of_facet);
        allowed * shares.reduce(f64::min).unwrap_or(EDGE_SHARE)
    }
}

fn rim_share(facet: &Facet) -> f64 {
    if facet.holds_the_motion() {
        RIM_SHARE_ALONE
    } else {
        RIM_SHARE
    }
}

/// The share of the gap that leads away from a rim between these offsets.
pub(super) fn rim_gap_share(motion: &Motion, offsets: &[DVec3], along: DVec3) -> f64 {
    let slopes = offsets
        .iter()
        .map(|offset| along.dot(offset.normalize_or_zero()));
    let range = slopes.fold((1.0f64, -1.0f64), |(low, high), slope| {
        (low.min(slope), high.max(slope))
    });
    motion.edge_share(along, range)
}

/// About how many pieces a side of a facet will be divided into, as if it were a rim: the gap of a piece is proportional
/// to the square of its length.
pub(super) fn predicted_edge_pieces(
    a: DVec3,
    b: DVec3,
    rule: &EdgeRule<'_>,
    is_spared: bool,
) -> f64 {
    let allowed = rule.allowed(&[a, b], (b - a).normalize_or_zero());
    let excess = edge_gap(a, b) / allowed;
    let is_of_points = allowed <= EDGE_SHARE * rule.allowance.between(&[a, b]);
    if is_spared && is_of_points && excess <= SPARED {
        return 1.0;
    }
    excess.sqrt().ceil().max(1.0)
}

/// The fewest pieces into which the edge between two offsets has to be divided so that the gap of each is at most
/// `allowed`; for more than two pieces by theory, with room for its numerical error.
pub(super) fn fewest_pieces(
    a: DVec3,
    b: DVec3,
    gap: f64,
    allowed: &dyn Fn(&[DVec3], DVec3) -> f64,
) -> f64 {
    let along = (b - a).normalize_or_zero();
    let times = gap / allowed(&[0.5 * (a + b)], along);
    if !(times > 1.0) {
        return 1.0;
    }
    if times <= 4.0 {
        return 2.0;
    }
    let scale = Scale::new(a, b, &|here| allowed(&[here], along));
    (0.98 * scale.exact_pieces()).ceil().max(2.0)
}

/// Where to divide the edge between the positions `a` and `b`, as increasing parameters from 0 at `a` to 1 at `b`: at
/// least one. All positions, also that of `observer`, are in the rest frame.
///
/// The pieces have nearly equal gaps. Let `h` be the distance of the edge's line from the observer and `s` the length
/// along the line from its point nearest to the observer. The distance `r` has the second derivative `r'' = h^2 / r^3`,
/// so a piece of length `L` has the gap `h^2 L^2 / (8 r^3)`. Pieces over which `h r^(-3/2)` has equal integrals
/// therefore have equal gaps. The substitution `s = h sinh t` turns this integral into that of `(cosh t)^(-1/2)`, which
/// is smooth even where the line passes close to the observer. The exact gap of each piece decides; if one is too
/// large, the number of pieces grows.
///
/// The caller gives the ends in a canonical order, so that the result is the same for every triangle of the edge. It is
/// `None` if more than `most` parameters would be needed.
pub(super) fn division(
    a: DVec3,
    b: DVec3,
    observer: DVec3,
    rule: &EdgeRule<'_>,
    most: usize,
) -> Option<Vec<f64>> {
    let (offset_a, offset_b) = (a - observer, b - observer);
    let along = (b - a).normalize_or_zero();
    let needs_division =
        |from: DVec3, to: DVec3| edge_gap(from, to) > rule.allowed(&[from, to], along);
    if most == 0 {
        return None;
    }
    let fits = |parameters: &[f64]| {
        let mut from = offset_a;
        parameters.iter().chain([&1.0]).all(|&parameter| {
            let to = point_between(a, b, parameter) - observer;
            !needs_division(std::mem::replace(&mut from, to), to)
        })
    };
    // Most edges are short compared with their distance: one cut in the middle is enough.
    if fits(&[0.5]) {
        return Some(vec![0.5]);
    }

    let scale = Scale::new(offset_a, offset_b, &|here| rule.allowed(&[here], along));
    let mut pieces = scale.pieces().max(2);
    loop {
        if pieces - 1 > most {
            return None;
        }
        let parameters = scale.parameters(pieces);
        let distinct = parameters.windows(2).all(|pair| pair[0] < pair[1]);
        let inside = parameters
            .iter()
            .all(|&parameter| 0.0 < parameter && parameter < 1.0);
        if !(distinct && inside) || pieces > MAX_PIECES {
            // The division is as fine as `f64` or the limit allows. The certificate states the remaining gap.
            return Some(scale.parameters_within_reach(pieces));
        }
        if fits(&parameters) {
            return Some(parameters);
        }
        pieces += 1 + pieces / 16;
    }
}

/// Limit on the pieces of an edge: a tolerance that needs more cannot be intended.
const MAX_PIECES: usize = 1 << 20;

/// The point of an edge at a parameter; at 0 and 1 it is exactly the end.
pub(super) fn point_between(a: DVec3, b: DVec3, parameter: f64) -> DVec3 {
    if parameter == 1.0 {
        b
    } else {
        a + (b - a) * parameter
    }
}

/// The integral along an edge whose equal parts belong to pieces with equal gaps.
struct Scale {
    /// Distance of the edge's line from the observer, in the rest frame; never zero.
    distance: f64,
    /// Signed distance along the line from its point nearest to the observer to the edge's first end.
    start: f64,
    /// Length of the edge.
    length: f64,
    /// `asinh(s / distance)` at the two ends, with `s` measured like `start`.
    range: [f64; 2],
    /// The integral up to each sample, `SAMPLES + 1` values.
    cumulative: Vec<f64>,
}

impl Scale {
    /// The scale between two offsets from the observer, for an allowed gap of pieces at a place.
    fn new(a: DVec3, b: DVec3, allowed: &dyn Fn(DVec3) -> f64) -> Self {
        let edge = b - a;
        let length = edge.length();
        let along = edge / length;
        let start = a.dot(along);
        // If the line passes through the observer, a small distance replaces zero: the exact gap decides later.
        let distance = a.cross(along).length().max(1e-12 * length);
        let range = [start, start + length].map(|s| (s / distance).asinh());
        let step = (range[1] - range[0]) / SAMPLES as f64;
        let foot = a - along * start;
        let density = |t: f64| {
            let here = foot + along * (distance * t.sinh());
            1.0 / (t.cosh().sqrt() * allowed(here).sqrt())
        };
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        let mut before = density(range[0]);
        for sample in 0..SAMPLES {
            let t = range[0] + step * sample as f64;
            let after = density(t + step);
            // Simpson's rule.
            sum += (before + 4.0 * density(t + 0.5 * step) + after) * step / 6.0;
            cumulative.push(sum);
            before = after;
        }
        Self {
            distance,
            start,
            length,
            range,
            cumulative,
        }
    }

    /// About how many pieces are enough.
    fn pieces(&self) -> usize {
        self.exact_pieces().ceil().min(MAX_PIECES as f64) as usize
    }

    /// The number of pieces with the allowed gap, by theory, as if pieces could be parts of pieces.
    fn exact_pieces(&self) -> f64 {
        let total = self.cumulative[SAMPLES] * self.distance.sqrt();
        total / 8f64.sqrt()
    }

    /// The parameters that divide the edge into `pieces` pieces with equal integrals.
    fn parameters(&self, pieces: usize) -> Vec<f64> {
        let step = (self.range[1] - self.range[0]) / SAMPLES as f64;
        let mut sample = 0;
        (1..pieces)
            .map(|piece| {
                let target = self.cumulative[SAMPLES] * piece as f64 / pieces as f64;
                while sample + 1 < SAMPLES && self.cumulative[sample + 1] < target {
                    sample += 1;
                }
                let (low, high) = (self.cumulative[sample], self.cumulative[sample + 1]);
                let t = self.range[0] + step * (sample as f64 + (target - low) / (high - low));
                (self.distance * t.sinh() - self.start) / self.length
            })
            .collect()
    }

    /// The same parameters without those that rounding has made equal or moved outside the edge.
    fn parameters_within_reach(&self, pieces: usize) -> Vec<f64> {
        let mut parameters = self.parameters(pieces);
        parameters.retain(|&parameter| 0.0 < parameter && parameter < 1.0);
        parameters.dedup_by(|next, before| *next <= *before);
        parameters
    }
}
