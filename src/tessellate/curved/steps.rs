//! How far the parameters of a chart go in a part of a triangle, and bounds of what derivatives make of that.

use glam::DVec2;

use super::frame::largest_size;

/// How far and how the parameters of a chart go in a part, in steps of the part's frame, whose places are in the unit disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    /// How far each parameter goes from that in the middle, and all together.
    pub(super) half: DVec2,
    pub(super) reach: f64,
    /// The most that each parameter changes per step, and all together.
    pub(super) sizes: DVec2,
    pub(super) length: f64,
    /// The sum of the squares of these changes, as fractions of their most, is at most this.
    pub(super) spread: f64,
    /// The second derivatives.
    pub(super) bend: DVec2,
}

impl Steps {
    /// For parameters with these first derivatives in the middle, by the two directions of the frame, and second derivatives
    /// that do not change.
    pub(super) fn new([u, v]: [DVec2; 2], [uu, uv, vv]: [DVec2; 3]) -> Self {
        let rows = [DVec2::new(u.x, v.x), DVec2::new(u.y, v.y)];
        let bend = (uu * uu + 2.0 * uv * uv + vv * vv).map(f64::sqrt);
        let size = DVec2::new(rows[0].length(), rows[1].length());
        let sizes = size + bend;
        let length = largest_size([u.length_squared(), u.dot(v), v.length_squared()]);
        let parallel = rows[0].dot(rows[1]).abs() / (size.x * size.y);
        let spread = (1.0 + parallel).sqrt() + (bend / sizes).length();
        Self {
            half: size + 0.5 * bend,
            reach: length + 0.5 * bend.length(),
            sizes,
            length: length + bend.length(),
            spread: lesser(spread * spread, 2.0),
            bend,
        }
    }
}

/// What the derivatives of a chart make of unit steps in a part's frame, at most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    /// The first ones, of the second derivatives of the parameters.
    pub(super) of_bend: f64,
    /// The second ones, of two first derivatives of the parameters, and of a first and a second one.
    pub(super) second: f64,
    pub(super) mixed: f64,
    /// The third ones, of three first derivatives.
    pub(super) third: f64,
}

impl Derivatives {
    pub(super) const UNKNOWN: Self = Self {
        of_bend: f64::INFINITY,
        second: f64::INFINITY,
        mixed: f64::INFINITY,
        third: f64::INFINITY,
    };
}

/// The smaller of two bounds; one that is not a number is none.
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    match a <= b {
        true => a,
        false if b.is_nan() => f64::INFINITY,
        false => b,
    }
}
