//! Slanted boxes around slivers.
//!
//! The box along the axes around a long thin triangle is nearly all empty, and those of its neighbours in a fan all
//! overlap: a ray through one would ask them all. A box along the longest edge holds little but the triangle, and one around
//! a bundle of slivers little but the bundle.

use glam::{DMat3, DVec3};

use super::bounds::Bounds;
use super::ray::{Ray, Slabs};
use crate::spacetime::unit;

/// A triangle whose longest edge is longer than so many of its heights is a sliver.
const SLENDER: f64 = 8.0;

/// A slanted box costs about three times what a plain one does: it has to be smaller by more than that to pay.
const WORTH: f64 = 1.0 / 3.0;

/// A box whose edges are along axes of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slant {
    /// From offsets from the tree's middle to coordinates along the axes.
    to_axes: DMat3,
    bounds: Bounds,
}

/// A long thin triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliver {
    /// Its longest edge.
    long: DVec3,
    /// At right angles to it, of any length.
    normal: DVec3,
}

impl Sliver {
    /// The sliver that a triangle is, if it is one.
    pub(super) fn of([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let edges = [b - a, c - b, a - c];
        let long = edges.into_iter().fold(DVec3::ZERO, |long, edge| {
            if edge.length_squared() > long.length_squared() {
                edge
            } else {
                long
            }
        });
        let normal = (b - a).cross(c - a);
        // The longest edge times its height is twice the area.
        (normal.length() * SLENDER < long.length_squared()).then_some(Self { long, normal })
    }
}

impl Slant {
    /// A box around triangles, most of which are slivers, if one is much smaller than `plain`; `middle` is that of
    /// the tree.
    pub(super) fn around(
        triangles: impl Iterator<Item = [DVec3; 3]> + Clone,
        slivers: impl Iterator<Item = Sliver>,
        middle: DVec3,
        plain: &Bounds,
    ) -> Option<Self> {
        let mut longest: Option<Sliver> = None;
        let mut sum = DVec3::ZERO;
        for sliver in slivers {
            // Edges have no sense of their own.
            let same_sense = longest.is_none_or(|longest| longest.long.dot(sliver.long) >= 0.0);
            sum += sliver.long * if same_sense { 1.0 } else { -1.0 };
            if longest.is_none_or(|l| l.long.length_squared() < sliver.long.length_squared()) {
                let turned = if same_sense {
                    sliver.long
                } else {
                    -sliver.long
                };
                longest = Some(Sliver {
                    long: turned,
                    ..sliver
                });
            }
        }
        let longest = longest?;
        let along = |long: DVec3| {
            let to_axes = axes(long, longest.normal)?;
            let bounds = Bounds::around(
                triangles
                    .clone()
                    .flatten()
                    .map(|corner| to_axes * (corner - middle)),
            );
            Some(Self { to_axes, bounds })
        };
        let both = [longest.long, sum].into_iter().filter_map(along);
        let smaller = both.min_by(|a, b| a.bounds.half_area().total_cmp(&b.bounds.half_area()))?;
        (smaller.bounds.half_area() < plain.half_area() * WORTH).then_some(smaller)
    }

    /// The distance at which a ray enters the box, larger by `margin` on all sides.
    pub(super) fn enters(&self, ray: &Ray, middle: DVec3, margin: f64) -> Option<f64> {
        let origin = self.to_axes * (ray.origin() - middle);
        let slabs = Slabs::new(origin, self.to_axes * ray.direction(), margin);
        slabs.enters(self.bounds.low, self.bounds.high)
    }
}

/// Rows along `long`, at right angles to it within the plane of the sliver, and along the normal.
fn axes(long: DVec3, normal: DVec3) -> Option<DMat3> {
    let x = unit(long)?;
    // Also where the sliver is so thin that it has no normal.
    let across = unit(unit(normal).unwrap_or_default().cross(x));
    let y = across.unwrap_or_else(|| x.any_orthonormal_vector());
    Some(DMat3::from_cols(x, y, x.cross(y)).transpose())
}
