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
    let blocks: Vec<Block<'_>> = places.chunks(BLOCK).map(Block::new).collect();
    directions()
        .filter_map(|direction| farthest(&blocks, direction))
        .collect()
}

/// So many points in a row, which are mostly near each other, are passed over together.
const BLOCK: usize = 64;

/// Points in a row, and the corners of the box around them.
struct Block<'a> {
    places: &'a [DVec3],
    low: DVec3,
    high: DVec3,
}

impl<'a> Block<'a> {
    fn new(places: &'a [DVec3]) -> Self {
        let (low, high) = match places.iter().all(|place| place.is_finite()) {
            true => bounds(places.iter().copied()),
            // What an infinite coordinate comes to along a direction is not always a number.
            false => (DVec3::NEG_INFINITY, DVec3::INFINITY),
        };
        Self { places, low, high }
    }

    /// How far along a direction a point of the block can be. Each step of the computation rounds up or down together with
    /// that of the point, so that the bound holds for computed numbers too.
    fn bound(&self, direction: DVec3) -> f64 {
        let corner = DVec3::select(direction.cmpge(DVec3::ZERO), self.high, self.low);
        corner.dot(direction)
    }
}

/// The last of the points that are farthest along a direction.
fn farthest(blocks: &[Block<'_>], direction: DVec3) -> Option<DVec3> {
    let along = |place: &DVec3| place.dot(direction);
    let last_of = |block: &Block<'_>| {
        let by_distance = |a: &&DVec3, b: &&DVec3| along(a).total_cmp(&along(b));
        block.places.iter().max_by(by_distance).copied()
    };
    let bounds: Vec<f64> = blocks.iter().map(|block| block.bound(direction)).collect();
    let first = (0..blocks.len()).max_by(|&a, &b| bounds[a].total_cmp(&bounds[b]))?;
    let floor = along(&last_of(&blocks[first])?);
    let mut best: Option<DVec3> = None;
    for (block, &bound) in blocks.iter().zip(&bounds) {
        // A bound that is not a number is less than nothing.
        if bound < floor {
            continue;
        }
        if let Some(place) = last_of(block)
            && best.is_none_or(|best| along(&place).total_cmp(&along(&best)).is_ge())
        {
            best = Some(place);
        }
    }
    best
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

/// The largest number up to `limit` that is 1, 2 or 5 times a power of ten.
pub(super) fn round_below(limit: f64) -> f64 {
    let exponent = limit.log10().floor();
    let power = 10f64.powi(exponent.abs() as i32);
    let round = |digit: f64| {
        if exponent < 0.0 {
            digit / power
        } else {
            digit * power
        }
    };
    let fitting = [5.0, 2.0].map(round).into_iter().find(|&n| n <= limit);
    fitting.unwrap_or(round(1.0))
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

    /// Passing over blocks changes nothing: the same points as by looking at each, where many are equally far, where some
    /// are infinite or not numbers, and wherever the farthest one is.
    #[test]
    fn blocks_that_are_passed_over_hold_no_farthest_point() {
        let number = |seed: u64| {
            let mixed = (seed ^ 0x9e37_79b9).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            (mixed ^ mixed >> 31).wrapping_mul(0x94d0_49bb_1331_11eb) >> 11
        };
        for (kind, odd) in [
            (0, DVec3::ZERO),
            (1, DVec3::NAN),
            (2, DVec3::INFINITY),
            (3, DVec3::new(f64::NEG_INFINITY, f64::NAN, -0.0)),
            (4, DVec3::splat(1e308)),
        ] {
            let coordinate = |seed: u64| match kind % 2 {
                // Few different numbers, so that many points are equally far.
                0 => (number(seed) % 5) as f64 - 2.0,
                _ => number(seed) as f64 / (1u64 << 53) as f64 - 0.5,
            };
            let mut places: Vec<DVec3> = (0..1000)
                .map(|k| {
                    DVec3::new(
                        coordinate(3 * k),
                        coordinate(3 * k + 1),
                        -coordinate(3 * k + 2),
                    )
                })
                .collect();
            places[333 + kind] = odd;
            let slowly = directions().map(|direction| {
                let along = |a: &&DVec3, b: &&DVec3| a.dot(direction).total_cmp(&b.dot(direction));
                *places.iter().max_by(along).unwrap()
            });
            let bits = |place: DVec3| place.to_array().map(f64::to_bits);
            let expected: Vec<_> = slowly.map(bits).collect();
            let found: Vec<_> = outermost(places.clone()).into_iter().map(bits).collect();
            assert_eq!(found, expected, "{kind}");
        }
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

    #[test]
    fn bars_have_round_lengths() {
        for (limit, expected) in [
            (1.0, 1.0),
            (1.99, 1.0),
            (4.9, 2.0),
            (7.0, 5.0),
            (0.03, 0.02),
            (99.0, 50.0),
            (0.5, 0.5),
        ] {
            assert_eq!(round_below(limit), expected);
        }
    }
}
