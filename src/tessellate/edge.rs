//! The edge rule: where an edge is divided depends on its two ends alone.

use glam::DVec3;

use super::{Allowance, edge_gap};

/// What part of a triangle's gap its edges may have.
///
/// An equilateral triangle's edge has three quarters of the gap of its middle. Less makes more triangles
/// along the edges of the mesh than inside, more leaves those inside no room to be equilateral: 0.6 and 0.9
/// cost 3 to 40 per cent more triangles on the plates of the benchmark.
pub(super) const EDGE_SHARE: f64 = 0.75;

/// Pieces of the integral along an edge; the result is checked, so that no more digits are needed.
const SAMPLES: usize = 64;

/// Whether an edge has to be divided.
pub(super) fn needs_division(a: DVec3, b: DVec3, allowance: &Allowance) -> bool {
    edge_gap(a, b) > EDGE_SHARE * allowance.between(&[a, b])
}

/// About how many pieces an edge will be divided into: the gap of a piece goes with the square of its length.
pub(super) fn predicted_edge_pieces(a: DVec3, b: DVec3, allowance: &Allowance) -> f64 {
    let excess = edge_gap(a, b) / (EDGE_SHARE * allowance.between(&[a, b]));
    excess.sqrt().ceil().max(1.0)
}

/// Where to divide the edge between two positions as seen by `observer`, as parameters from 0 at `a` to 1 at
/// `b`, in order; empty where it need not be divided.
///
/// The pieces have nearly equal gaps. In the line's plane with the observer, at distance `h` from it,
/// `r'' = h^2 / r^3`, so a piece of length `L` has the gap `h^2 L^2 / (8 r^3)`: equal pieces of the integral of
/// `h r^(-3/2)` have equal gaps, and as `s = h sinh t` turns it into that of `(cosh t)^(-1/2)`, it is smooth even
/// where the line passes close by. The exact gap of each piece decides; if one is too large, one piece more.
///
/// The caller gives the ends in a canonical order; the result is a function of them and nothing else, or `None` where
/// it would have more than `most` parameters.
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
    // Most edges are short against their distance: one cut in the middle will do.
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
            // As fine as numbers go: the gap that is left is in the certificate.
            return Some(scale.parameters_within_reach(pieces));
        }
        if fits(&parameters) {
            return Some(parameters);
        }
        pieces += 1 + pieces / 16;
    }
}

/// More pieces than this are a tolerance that cannot be meant.
const MAX_PIECES: usize = 1 << 20;

/// The point of an edge at a parameter; the ends themselves at 0 and 1.
pub(super) fn point_between(a: DVec3, b: DVec3, parameter: f64) -> DVec3 {
    if parameter == 1.0 {
        b
    } else {
        a + (b - a) * parameter
    }
}

/// The integral along an edge in which pieces of equal length have equal gaps.
struct Scale {
    /// Distance of the line from the observer, not zero.
    distance: f64,
    /// Where along the line, counted from the point nearest to the observer, the edge begins.
    start: f64,
    /// How long the edge is.
    length: f64,
    /// `asinh(s / distance)` at the ends.
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
        // Where the line hits the observer any small distance stands for none: the exact gap decides.
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

    /// How many pieces are about enough.
    fn pieces(&self) -> usize {
        let total = self.cumulative[SAMPLES] * self.distance.sqrt();
        (total / (8.0 * EDGE_SHARE).sqrt())
            .ceil()
            .min(MAX_PIECES as f64) as usize
    }

    /// The inner ends of `pieces` pieces of equal integral.
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

    /// The same without what rounding has thrown together.
    fn parameters_within_reach(&self, pieces: usize) -> Vec<f64> {
        let mut parameters = self.parameters(pieces);
        parameters.retain(|&parameter| 0.0 < parameter && parameter < 1.0);
        parameters.dedup_by(|next, before| *next <= *before);
        parameters
    }
}
