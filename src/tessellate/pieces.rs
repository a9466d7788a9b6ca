//! The points and output triangles into which a source triangle is divided.

use glam::DVec3;

/// A point on the boundary of the source triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// Weights of the source triangle's corners.
    pub(super) weights: DVec3,
    /// Offset from the observer, in the rest frame.
    pub(super) offset: DVec3,
    /// Bit `i` is set if the point is on the side from corner `i` to the next corner; a corner has two bits.
    pub(super) sides: u8,
}

/// The pieces of a divided source triangle.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    /// Weights of the source triangle's corners at each point inside. In `triangles` the points inside follow those on
    /// the boundary.
    pub(super) inside: Vec<DVec3>,
    /// Output triangles, as indices of the points on the boundary, in their order, and then of the points inside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The largest gap of an output triangle, in the rest frame.
    pub(super) gap: f64,
    /// A bound on the same as surfaces, as a gap.
    pub(super) surface: f64,
    /// What it costs that rays must not pass some of the output triangles, as a gap; zero if there are none.
    pub(super) cut: f64,
    /// Whether the gap of every output triangle is within the allowance.
    pub(super) complete: bool,
    /// Whether more points would have been added if the grant had been larger.
    pub(super) is_short: bool,
}
