//! What a triangle is divided into.

use glam::DVec3;

/// A point on the boundary of the triangle, or inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Weights of the triangle's corners.
    pub(super) weights: DVec3,
    /// Offset from the observer.
    pub(super) offset: DVec3,
    /// Bit `i` for a point on the side from corner `i` to the next; corners have two.
    pub(super) sides: u8,
}

/// What a triangle was divided into.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    /// Weights of the points inside; they follow those of the boundary.
    pub(super) inside: Vec<DVec3>,
    /// Triangles between the points of the boundary, in their order, and those inside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The largest gap of any of them.
    pub(super) gap: f64,
    /// Whether every gap is within what is allowed.
    pub(super) complete: bool,
    /// Whether more points would have been added if more had been granted.
    pub(super) is_short: bool,
}
