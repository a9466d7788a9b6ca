//! How many times the photosurface map stretches lengths near triangles at rest, at most.

use glam::DVec3;
use rayon::prelude::*;

use crate::light_cone::{View, facet_ball};

/// Cosines that differ by more belong to stretches whose difference no rounding hides, at any rapidity above [`SLOW`].
const TELLING: f64 = 1e-6;
const SLOW: f64 = 1e-3;

/// An upper bound on how many times the photosurface map stretches lengths near a triangle at rest. The bound holds in
/// a ball around the triangle's centroid that reaches twice as far as the corners, and so contains a curved surface
/// through the corners. For a triangle of a stand-in, ball and lengths are those of what it stands for.
pub(crate) fn local_stretch(view: &View, corners: [DVec3; 3]) -> f64 {
    view.facet_stretch_bound(corners)
}

/// The largest [`local_stretch`] of `count` triangles, 0 of none; `corners` has the corners of each.
///
/// The bound grows with the angle between the backward direction and the far side of the ball, as seen by the observer.
/// A cosine of that angle is quickly found, and leaves few triangles whose bound can be the largest.
pub(crate) fn largest_stretch(
    view: &View,
    count: usize,
    corners: impl Fn(usize) -> [DVec3; 3] + Sync,
) -> f64 {
    let exact = |index: usize| local_stretch(view, corners(index));
    let velocity = view.relative_velocity();
    if velocity.rapidity() == 0.0 && view.elongation() == 1.0 {
        // All triangles at rest have the same bound.
        return (0..count.min(1)).map(exact).fold(0.0, f64::max);
    }
    if !(velocity.rapidity() > SLOW) || view.elongation() != 1.0 {
        return (0..count)
            .into_par_iter()
            .map(exact)
            .reduce(|| 0.0, f64::max);
    }
    let (backward, observer) = (-velocity.direction(), view.observer_rest());
    // cos(a + b) with a the angle to the centre and b that under which the radius is seen; -1 stands for all beyond 180
    // degrees, and for what is not a number.
    let far_side = |index: usize| {
        let (middle, radius) = facet_ball(corners(index));
        let offset = middle - observer;
        let distance = offset.length();
        let (cosine, sine) = (backward.dot(offset) / distance, radius / distance);
        let across = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        let within = sine < 1.0 && -cosine <= ((1.0 - sine) * (1.0 + sine)).sqrt();
        match within {
            true => cosine * ((1.0 - sine) * (1.0 + sine)).sqrt() - across * sine,
            false => -1.0,
        }
    };
    let far_sides: Vec<f64> = (0..count).into_par_iter().map(far_side).collect();
    let farthest = far_sides.par_iter().copied().reduce(|| 1.0, f64::min);
    let near = (0..count)
        .into_par_iter()
        .filter(|&index| far_sides[index] <= farthest + TELLING);
    near.map(exact).reduce(|| 0.0, f64::max)
}
