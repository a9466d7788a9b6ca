//! Positions in `f64` as a file holds them: an `f64` offset and small `f32` numbers relative to it.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::WriteError;
use crate::mesh::Mesh;

/// Numbers that a thread looks through at a time. Ten times fewer cost more to hand out than to look through; what is
/// shorter is looked through at once.
const PER_JOB: usize = 1 << 15;

/// How positions, at one step or at several, become small numbers; made before any of them is.
#[derive(Debug)]
pub(super) struct Packing {
    /// Added to what is local it gives the position; for the node's translation.
    pub(super) offset: DVec3,
    /// The bounds of the positions at the first step.
    first: (DVec3, DVec3),
}

impl Packing {
    /// Splits positions into an offset and what is left, so that the numbers left are as small as they can be; `steps`
    /// are the same vertices at several steps, at least one. `around` is the box around all that shares corners with
    /// them, and has to share the offset: equal positions are then equal numbers, whoever adds them up and however.
    ///
    /// # Accuracy
    ///
    /// The offset is the middle of that box, rounded to a multiple of a sixteenth of its extent at most:
    /// programs that read it as `f32` still read it exactly while it is within a million extents. Each
    /// coordinate is then rounded once, to `f32`: by at most 2^-24 of half the extent and an eighth of that. Those of
    /// later steps are sums of two, of which the difference, at most twice as large, is rounded, and the sum by whoever
    /// adds.
    ///
    /// # Errors
    ///
    /// No positions, or a number that `f32` cannot hold: too large, or an extent so small that it vanishes.
    pub(super) fn new(
        name: &str,
        steps: &[&Mesh],
        around: Option<(DVec3, DVec3)>,
    ) -> Result<Self, WriteError> {
        let bounds = steps.iter().map(|step| checked_bounds(name, step));
        let bounds: Vec<_> = bounds.collect::<Result<_, _>>()?;
        let first = *bounds
            .first()
            .ok_or_else(|| WriteError::Empty(name.to_owned()))?;
        let own = bounds.into_iter().fold(first, joined);
        // A box that is none, or not around everything, would make numbers that are none.
        let around = around.filter(|(low, high)| low.is_finite() && high.is_finite());
        let (low, high) = around.map_or(own, |around| joined(own, around));
        let half_extent = (0.5 * high - 0.5 * low).max_element();
        if half_extent > 0.0 && half_extent < f64::from(f32::MIN_POSITIVE) {
            return Err(WriteError::TooSmall {
                name: name.to_owned(),
                extent: 2.0 * half_extent,
                limit: 2.0 * f64::from(f32::MIN_POSITIVE),
            });
        }
        let offset = rounded_to_eighths(0.5 * low + 0.5 * high, half_extent);
        Ok(Self { offset, first })
    }

    /// What is left of a position at the first step.
    pub(super) fn local(&self, position: DVec3) -> [f32; 3] {
        (position - self.offset).as_vec3().to_array()
    }

    /// What is to be added to that to have the position of the same vertex at a later step.
    pub(super) fn difference(&self, first: DVec3, later: DVec3) -> [f32; 3] {
        let local = Vec3::from(self.local(first)).as_dvec3();
        (later - self.offset - local).as_vec3().to_array()
    }

    /// Exactly the smallest and the largest of what is left at the first step.
    pub(super) fn local_bounds(&self) -> Bounds<3> {
        // Both roundings, of the difference and to f32, keep the order of numbers: the least of what is left is what
        // is left of the least.
        let (low, high) = self.first;
        Bounds::of(self.local(low)).joined(Bounds::of(self.local(high)))
    }
}

/// The smallest and the largest of each number of small vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds<const N: usize> {
    pub(super) min: [f32; N],
    pub(super) max: [f32; N],
}

impl<const N: usize> Bounds<N> {
    /// Of the vectors with the indices from 0 to below `count`, at least one.
    pub(super) fn of_all(count: usize, vector: impl Fn(usize) -> [f32; N] + Sync) -> Self {
        let first = Self::of(vector(0));
        let of = |index| Self::of(vector(index));
        if count <= PER_JOB {
            return (1..count).map(of).fold(first, Self::joined);
        }
        let all = (1..count).into_par_iter().with_min_len(PER_JOB);
        all.map(of).reduce(|| first, Self::joined)
    }

    fn of(vector: [f32; N]) -> Self {
        // No zero has a sign, whichever comes first.
        let vector = vector.map(|number| number + 0.0);
        Self {
            min: vector,
            max: vector,
        }
    }

    fn joined(self, other: Self) -> Self {
        let each = |of: fn(f32, f32) -> f32, a: [f32; N], b: [f32; N]| {
            std::array::from_fn(|axis| of(a[axis], b[axis]))
        };
        Self {
            min: each(f32::min, self.min, other.min),
            max: each(f32::max, self.max, other.max),
        }
    }
}

/// The bounds of the positions of a mesh; refuses none, and those that are not numbers or beyond `f32`.
fn checked_bounds(name: &str, mesh: &Mesh) -> Result<(DVec3, DVec3), WriteError> {
    let name = name.to_owned();
    let Some((low, high)) = mesh.bounds() else {
        return Err(WriteError::Empty(name));
    };
    if mesh.is_finite() && fits_f32(low) && fits_f32(high) {
        return Ok((low, high));
    }
    let positions = mesh.positions();
    let outside = |position: &DVec3| !fits_f32(*position);
    let vertex = positions.iter().position(outside);
    let vertex = vertex.expect("one of them does not fit");
    if !positions[vertex].is_finite() {
        return Err(WriteError::Overflow { name, vertex });
    }
    Err(WriteError::Range {
        name,
        quantity: "the position",
        vertex,
        value: positions[vertex].abs().max_element(),
        limit: f64::from(f32::MAX),
    })
}

/// Each coordinate by itself: the largest of several would not tell of one that is not a number.
fn fits_f32(position: DVec3) -> bool {
    let [x, y, z] = position.abs().to_array();
    let limit = f64::from(f32::MAX);
    (x <= limit) & (y <= limit) & (z <= limit)
}

/// The first number, of those from 0 to below `count`, that is outside the range of `f32` or none at all.
pub(super) fn first_beyond_f32(count: usize, value: impl Fn(usize) -> f64 + Sync) -> Option<usize> {
    let outside = |index: usize| !(value(index).abs() <= f64::from(f32::MAX));
    if count <= PER_JOB {
        return (0..count).find(|&index| outside(index));
    }
    let all = (0..count).into_par_iter().with_min_len(PER_JOB);
    all.find_first(|&index| outside(index))
}

fn joined(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> (DVec3, DVec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// `middle` rounded to a multiple of the power of two that is at most an eighth of `half_extent`.
fn rounded_to_eighths(middle: DVec3, half_extent: f64) -> DVec3 {
    if half_extent == 0.0 {
        return middle;
    }
    let grid = (half_extent.log2().floor() - 3.0).exp2();
    let rounded = (middle / grid).round() * grid;
    // Beyond 2^53 steps of the grid the division would overflow or round by itself.
    if rounded.is_finite() { rounded } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(positions: &[DVec3]) -> Mesh {
        // Of numbers that files cannot hold, too.
        Mesh::from_parts(positions.to_vec(), vec![], None, None, vec![], None)
    }

    #[test]
    fn far_away_details_survive() {
        let corner = DVec3::new(1e9 + 0.25, -3e8, 7.0);
        let positions = [
            corner,
            corner + DVec3::new(1e-3, 2e-3, 0.0),
            corner + DVec3::new(0.0, 0.0, 3e-3),
        ];
        let packing = Packing::new("far", &[&points(&positions)], None).unwrap();
        for position in &positions {
            let local = packing.local(*position);
            let back = packing.offset + DVec3::from(local.map(f64::from));
            // Half a unit of f32 at 1.7e-3, and one of f64 at 1e9 from adding up here.
            let allowed = 1.7e-3 / f64::from(1 << 24) * 2.0 + 1.2e-7;
            assert!((back - *position).length() <= allowed);
        }
    }

    #[test]
    fn the_offset_is_exact_in_f32_within_a_million_extents() {
        for distance in [0.0, 1.0, 123.456, 5e5] {
            let middle = DVec3::new(distance, -distance / 3.0, 0.1);
            let packing =
                Packing::new("near", &[&points(&[middle - 0.7, middle + 0.7])], None).unwrap();
            let offset = packing.offset;
            assert_eq!(offset.as_vec3().as_dvec3(), offset, "{distance}");
            let max = packing.local_bounds().max.map(f64::from);
            assert!(DVec3::from(max).max_element() <= 0.7 * 1.125 * (1.0 + 1e-7));
        }
    }

    #[test]
    fn later_steps_are_sums_within_three_roundings() {
        let steps: Vec<Vec<DVec3>> = (0..5)
            .map(|step| {
                let along = DVec3::new(1e3 * f64::from(step) - 7e4, 0.3, -0.1);
                (0..50)
                    .map(|i| along + DVec3::new(0.1, 0.2, 0.3) * f64::from(i).sqrt())
                    .collect()
            })
            .collect();
        let meshes: Vec<Mesh> = steps.iter().map(|step| points(step)).collect();
        let meshes: Vec<&Mesh> = meshes.iter().collect();
        let packing = Packing::new("moving", &meshes, None).unwrap();
        // Half of what it moves and is wide, and an eighth of that.
        let reach = 0.5 * 1.125 * 4e3 + 1.0;
        for positions in &steps[1..] {
            for (&first, &later) in steps[0].iter().zip(positions) {
                let start = Vec3::from(packing.local(first));
                let sum = start + Vec3::from(packing.difference(first, later));
                let error = (packing.offset + sum.as_dvec3() - later).abs();
                let error = error.max_element();
                assert!(error <= 3.0 * reach * 2f64.powi(-24), "{error}");
            }
        }
    }

    #[test]
    fn bounds_are_those_of_what_is_written_however_many_jobs_there_are() {
        for count in [1, 100, 3 * PER_JOB + 7] {
            let place = |index: usize| {
                let turn = index as f64;
                DVec3::new(turn.sin(), 1e-3 * turn.cos(), -0.0) + DVec3::new(1e5, 7.0, 0.0)
            };
            let positions: Vec<DVec3> = (0..count).map(place).collect();
            let packing = Packing::new("a", &[&points(&positions)], None).unwrap();
            let locals: Vec<[f32; 3]> = positions.iter().map(|&p| packing.local(p)).collect();
            let bounds = packing.local_bounds();
            let all = Bounds::of_all(count, |index| locals[index]);
            for axis in 0..3 {
                let coordinates = || locals.iter().map(|local| local[axis]);
                let min = coordinates().fold(f32::INFINITY, f32::min);
                let max = coordinates().fold(f32::NEG_INFINITY, f32::max);
                assert_eq!((bounds.min[axis], bounds.max[axis]), (min, max));
                assert_eq!((all.min[axis], all.max[axis]), (min, max));
            }
            let late = |bad: usize| move |index| if index >= bad { f64::NAN } else { 0.0 };
            assert_eq!(first_beyond_f32(count, late(count - 1)), Some(count - 1));
            assert_eq!(first_beyond_f32(count, late(count)), None);
        }
    }

    #[test]
    fn what_f32_cannot_hold_is_refused() {
        let huge = Packing::new(
            "a",
            &[&points(&[DVec3::ZERO, DVec3::new(0.0, 1e39, 0.0)])],
            None,
        )
        .unwrap_err();
        assert!(
            huge.to_string()
                .contains("vertex 1 of the photosurface \"a\" is 1e39"),
            "{huge}"
        );
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            // One coordinate that is not a number, the others 0.
            let place = DVec3::select(axis.cmpgt(DVec3::ZERO), DVec3::NAN, DVec3::ZERO);
            let message = Packing::new("a", &[&points(&[DVec3::ZERO, place])], None).unwrap_err();
            assert!(message.to_string().contains("vertex 1"), "{message}");
        }
        assert!(Packing::new("a", &[&points(&[DVec3::ZERO, DVec3::splat(1e-40)])], None).is_err());
        assert!(Packing::new("a", &[&points(&[])], None).is_err());
        let place = DVec3::splat(3.3);
        let point = Packing::new("a", &[&points(&[place])], None).unwrap();
        assert_eq!((point.offset, point.local(place)), (place, [0.0; 3]));
    }
}
