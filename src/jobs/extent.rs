//! The extent of a set of points, in space and on the observer's sky, which a camera has to frame.

use std::f64::consts::PI;

use glam::DVec3;

use crate::spacetime::harmless_scale;

/// Number of directions in which [`outermost`] searches for the farthest point. Neighbouring directions are about 20
/// degrees apart, so a round object extends beyond the points found by less than 2 % of its radius.
const DIRECTIONS: usize = 128;

/// The direction from the origin to the middle of the part of the sky that the points cover, as a unit vector; -z if
/// there are no points.
///
/// It differs from the direction to the middle of the points in space, because the observer may be in their midst.
pub(super) fn middle_of_sky(places: &[DVec3]) -> DVec3 {
    let directions = places
        .iter()
        .filter_map(|place| scaled(*place).try_normalize());
    // The middle of the bounds is used, not the mean, because one side may have more vertices than the other.
    let (low, high) = bounds(directions);
    (low + high).try_normalize().unwrap_or(DVec3::NEG_Z)
}

/// The smallest and the largest coordinates of all points.
pub(super) fn bounds(places: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    places.fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), place| (low.min(place), high.max(place)),
    )
}

/// The largest absolute value of a coordinate of any point.
pub(super) fn reach<'a>(places: impl Iterator<Item = &'a DVec3>) -> f64 {
    places
        .map(|place| place.abs().max_element())
        .fold(0.0, f64::max)
}

/// The points that are farthest out, one for each of [`DIRECTIONS`] directions. A frame depends only on these.
pub(super) fn outermost(places: Vec<DVec3>) -> Vec<DVec3> {
    if places.len() <= DIRECTIONS {
        return places;
    }
    let farthest = |direction: DVec3| {
        let by_distance = |a: &&DVec3, b: &&DVec3| a.dot(direction).total_cmp(&b.dot(direction));
        places.iter().max_by(by_distance).copied()
    };
    directions().filter_map(farthest).collect()
}

/// Unit vectors that are evenly spread over the sphere, along a spiral with the golden angle.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..DIRECTIONS).map(|index| {
        let height = (2.0 * index as f64 + 1.0) / DIRECTIONS as f64 - 1.0;
        let (sin, cos) = (index as f64 * PI * (3.0 - 5f64.sqrt())).sin_cos();
        let across = (1.0 - height * height).sqrt();
        DVec3::new(across * cos, height, across * sin)
    })
}

/// A vector with the same direction whose square neither overflows nor vanishes: the vector itself if its square does
/// neither.
pub(super) fn scaled(vector: DVec3) -> DVec3 {
    vector * harmless_scale(vector)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spacetime::length;

    #[test]
    fn outermost_places_stand_for_all() {
        let angles = (0..5000).map(|k| f64::from(k) * 2.399_963);
        let ball: Vec<_> = angles
            .map(|angle| DVec3::new(angle.cos(), (0.01 * angle).sin(), angle.sin()).normalize())
            .collect();
        let outer = outermost(ball.clone());
        assert!(outer.len() <= DIRECTIONS && outer.iter().all(|place| ball.contains(place)));
        // All points are within 1 of the origin. The farthest point along a neighbouring direction is therefore less
        // far by at most twice the distance between the two directions.
        for direction in [DVec3::X, DVec3::Y, DVec3::ONE.normalize()] {
            let farthest = |places: &[DVec3]| {
                let along = places.iter().map(|place| place.dot(direction));
                along.fold(f64::NEG_INFINITY, f64::max)
            };
            let between = directions().map(|other| other.distance(direction));
            let between = between.fold(f64::INFINITY, f64::min);
            assert!(between < 0.3, "{between}");
            assert!(
                farthest(&outer) >= farthest(&ball) - 2.0 * between,
                "{direction}"
            );
        }
        let few = vec![DVec3::ZERO; 3];
        assert_eq!(outermost(few.clone()), few);
    }

    /// A point whose square overflows or vanishes, because it is very far or very near, still counts with its correct
    /// direction.
    #[test]
    fn the_middle_of_the_sky_is_that_of_places_at_any_distance() {
        for distance in [1e-310, 1e-200, 1.0, 1e200, 1e305] {
            let places = [DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.6, -0.8, 0.0)];
            let places = places.map(|place| place * distance);
            let middle = middle_of_sky(&places);
            assert!(middle.distance(DVec3::X) < 1e-12, "{distance}");
            assert!(
                (length(places[0]) / distance - 1.0).abs() < 1e-9,
                "{distance}"
            );
        }
    }
}
