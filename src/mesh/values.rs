//! Work on many values at once, and vectors of unit length.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::spacetime::unit;

/// Values a thread takes at a time: enough to outweigh handing them over.
pub(crate) const VALUES_PER_JOB: usize = 4096;

/// The values with these indices.
pub(super) fn pick<T: Copy + Send + Sync>(values: &[T], indices: &[u32]) -> Arc<Vec<T>> {
    let jobs = indices.par_iter().with_min_len(VALUES_PER_JOB);
    let picked: Vec<T> = jobs.map(|&index| values[index as usize]).collect();
    picked.into()
}

/// The first `count` of the values of these arrays, each of which was written in its own place in the result.
pub(crate) fn flattened<T, const N: usize>(arrays: Vec<[T; N]>, count: usize) -> Vec<T> {
    let mut values = arrays.into_flattened();
    values.truncate(count);
    values
}

/// Makes something else of every value.
pub(super) fn change<T: Copy + Send + Sync>(values: &mut [T], new: impl Fn(T) -> T + Sync) {
    let jobs = values.par_iter_mut().with_min_len(VALUES_PER_JOB);
    jobs.for_each(|value| *value = new(*value));
}

/// Makes something else of every value; those who share the values keep them as they are.
pub(super) fn change_shared<T: Copy + Send + Sync>(
    values: &mut Arc<Vec<T>>,
    new: impl Fn(T) -> T + Sync,
) {
    match Arc::get_mut(values) {
        Some(values) => change(values, new),
        None => {
            let jobs = values.par_iter().with_min_len(VALUES_PER_JOB);
            let changed: Vec<T> = jobs.map(|&value| new(value)).collect();
            *values = changed.into();
        }
    }
}

/// A vector brought to unit length, or zero where there is none.
///
/// Where nothing overflows and nothing is lost below the smallest numbers, a root does without the detour by powers
/// of two and is as good.
#[inline]
pub(crate) fn unit_or_zero(vector: DVec3) -> DVec3 {
    const ORDINARY: std::ops::Range<f64> = 1e-100..1e100;
    let square = vector.length_squared();
    match ORDINARY.contains(&square) {
        true => vector * square.sqrt().recip(),
        false => unit(vector).unwrap_or(DVec3::ZERO),
    }
}

/// The normal of a flat triangle. One without area has none; any unit vector keeps files valid.
pub(super) fn flat_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    unit((b - a).cross(c - a)).unwrap_or(DVec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In units of rounding, half of `EPSILON`: the square of the length is off by at most 3, its root by 2.5, the
    /// reciprocal by 3.5, the result by 4.5; the long way has one division more and takes the length of its
    /// result: 5.5. The length found of a unit vector is off by another 2.5.
    #[test]
    fn the_short_way_to_a_unit_vector_is_as_good_as_the_long_one() {
        for i in 0..100_000u32 {
            let angle = f64::from(i) * 0.618;
            let scale = 10f64.powi((i % 120) as i32 - 60);
            let vector = DVec3::new(angle.sin(), (3.1 * angle).cos(), (7.7 * angle).sin()) * scale;
            let (short, long) = (unit_or_zero(vector), unit(vector).unwrap());
            assert!((short - long).abs().max_element() <= 5.0 * f64::EPSILON);
            assert!((short.length() - 1.0).abs() <= 3.5 * f64::EPSILON);
        }
        assert_eq!(unit_or_zero(DVec3::ZERO), DVec3::ZERO);
        assert_eq!(unit_or_zero(DVec3::X * 1e-310), DVec3::X);
        assert_eq!(unit_or_zero(DVec3::NEG_Y * 1e300), DVec3::NEG_Y);
    }
}
