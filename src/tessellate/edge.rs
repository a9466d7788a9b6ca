//! The edge rule: the points that divide an edge depend on its two ends alone.

use glam::DVec3;

use super::{Allowance, edge_gap};

/// Allowed gap of an edge as a fraction of the allowed gap of a triangle.
///
/// The gap of an equilateral triangle's edge is three quarters of the gap of the triangle. A smaller fraction makes
/// smaller triangles along the edges of the mesh than inside; a larger one leaves the triangles inside no room to be
/// equilateral. On the plates of the benchmark the fractions 0.6 and 0.9 cost 3 to 40 per cent more triangles.
pub(super) const EDGE_SHARE: f64 = 0.75;

/// Number of pieces of the quadrature along an edge. The result is checked, so more digits are not needed.
const SAMPLES: usize = 64;

/// Whether an edge has to be divided; its ends are offsets from the observer, in the rest frame.
pub(super) fn needs_division(a: DVec3, b: DVec3, allowance: &Allowance) -> bool {
    edge_gap(a, b) > EDGE_SHARE * allowance.between(&[a, b])
}

/// About how many pieces an edge will be divided into: the gap of a piece is proportional to the square of its length.
pub(super) fn predicted_edge_pieces(a: DVec3, b: DVec3, allowance: &Allowance) -> f64 {
    let excess = edge_gap(a, b) / (EDGE_SHARE * allowance.between(&[a, b]));
    excess.sqrt().ceil().max(1.0)
}

/// Where to divide the edge between the positions `a` and `b`, as increasing parameters from 0 at `a` to 1 at `b`;
/// empty if the edge need not be divided. All positions, also that of `observer`, are in the rest frame.
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
    allowance: &Allowance,
    most: usize,
) -> Option<Vec<f64>> {
    let (offset_a, offset_b) = (a - observer, b - observer);
    if !needs_division(offset_a, offset_b, allowance) {
        return Some(vec![]);
    }
    if most == 0 {
        return None;
    }
    let fits = |parameters: &[f64]| {
        let mut from = offset_a;
        parameters.iter().chain([&1.0]).all(|&parameter| {
            let to = point_between(a, b, parameter) - observer;
            !needs_division(std::mem::replace(&mut from, to), to, allowance)
        })
    };
    // Most edges are short compared with their distance: one cut in the middle is enough.
    if fits(&[0.5]) {
        return Some(vec![0.5]);
    }

    let scale = Scale::new(offset_a, offset_b, allowance);
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
    fn new(a: DVec3, b: DVec3, allowance: &Allowance) -> Self {
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
            1.0 / (t.cosh().sqrt() * allowance.between(&[here]).sqrt())
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
        let total = self.cumulative[SAMPLES] * self.distance.sqrt();
        (total / (8.0 * EDGE_SHARE).sqrt())
            .ceil()
            .min(MAX_PIECES as f64) as usize
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
