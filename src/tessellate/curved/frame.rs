//! The frame of a part of a triangle, and what linear maps and forms make of its unit steps.

use glam::DVec2;

/// The frame of a part of a triangle: its corners are on the unit circle, a third of a turn apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The weights in the middle.
    pub(super) middle: DVec2,
    /// The changes of the weights per unit in the two directions.
    pub(super) axes: [DVec2; 2],
}

impl Frame {
    /// The corners in every frame.
    pub(super) const CORNERS: [DVec2; 3] = [
        DVec2::new(1.0, 0.0),
        DVec2::new(-0.5, 0.866_025_403_784_438_6),
        DVec2::new(-0.5, -0.866_025_403_784_438_6),
    ];

    pub(super) fn new([a, b, c]: [DVec2; 3]) -> Self {
        let middle = (a + b + c) / 3.0;
        Self {
            middle,
            axes: [a - middle, (b - c) / 3f64.sqrt()],
        }
    }

    /// A change of the weights in this frame.
    pub(super) fn step(&self, by: DVec2) -> DVec2 {
        let [e, f] = self.axes;
        DVec2::new(by.x * f.y - by.y * f.x, e.x * by.y - e.y * by.x) / (e.x * f.y - e.y * f.x)
    }

    /// The side opposite a corner, in every frame.
    pub(super) fn side(k: usize) -> DVec2 {
        Self::CORNERS[(k + 2) % 3] - Self::CORNERS[(k + 1) % 3]
    }
}

/// A form of second derivatives of a step.
pub(super) fn form([uu, uv, vv]: [f64; 3], DVec2 { x, y }: DVec2) -> f64 {
    uu * x * x + 2.0 * uv * x * y + vv * y * y
}

/// The largest size of such a form of a unit step.
pub(super) fn largest_form([uu, uv, vv]: [f64; 3]) -> f64 {
    let half = 0.5 * (uu - vv);
    (0.5 * (uu + vv)).abs() + (half * half + uv * uv).sqrt()
}

/// The largest size of a linear map of the plane, from the products of its columns.
pub(super) fn largest_size([uu, uv, vv]: [f64; 3]) -> f64 {
    let half = 0.5 * (uu - vv);
    (0.5 * (uu + vv) + (half * half + uv * uv).sqrt()).sqrt()
}
