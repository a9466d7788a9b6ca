//! Positions in `f64` as a file holds them: an `f64` offset and small `f32` numbers relative to it.

use glam::{DVec3, Vec3};

use super::WriteError;

/// Positions relative to an offset, at one step or at several.
#[derive(Debug)]
pub(super) struct Packed {
    /// Added to what is local it gives the position; for the node's translation.
    pub(super) offset: DVec3,
    /// What is left of the positions at the first step.
    pub(super) local: Local,
    /// For each later step, what is to be added to that.
    pub(super) differences: Vec<Local>,
}

/// Small numbers with their bounds.
#[derive(Debug)]
pub(super) struct Local {
    pub(super) values: Vec<[f32; 3]>,
    /// Exactly the smallest of the values.
    pub(super) min: [f32; 3],
    /// Exactly the largest of the values.
    pub(super) max: [f32; 3],
}

/// Splits positions into an offset and what is left, so that the numbers left are as small as they can be; `steps`
/// are the same vertices at several steps, at least one.
///
/// # Accuracy
///
/// The offset is the middle of the bounds, rounded to a multiple of a sixteenth of the extent at most:
/// programs that read it as `f32` still read it exactly while it is within a million extents. Each
/// coordinate is then rounded once, to `f32`: by at most 2^-24 of half the extent and an eighth of that. Those of
/// later steps are sums of two, of which the difference, at most twice as large, is rounded, and the sum by whoever
/// adds.
///
/// # Errors
///
/// No positions, or a number that `f32` cannot hold: too large, or an extent so small that it vanishes.
pub(super) fn pack(name: &str, steps: &[&[DVec3]]) -> Result<Packed, WriteError> {
    let mut bounds: Option<(DVec3, DVec3)> = None;
    for positions in steps {
        check(name, positions)?;
        for &p in *positions {
            let (low, high) = bounds.unwrap_or((p, p));
            bounds = Some((low.min(p), high.max(p)));
        }
    }
    let Some((low, high)) = bounds else {
        return Err(WriteError::Empty(name.to_owned()));
    };
    let half_extent = (0.5 * high - 0.5 * low).max_element();
    if half_extent > 0.0 && half_extent < f64::from(f32::MIN_POSITIVE) {
        return Err(WriteError::TooSmall {
            name: name.to_owned(),
            extent: 2.0 * half_extent,
            limit: 2.0 * f64::from(f32::MIN_POSITIVE),
        });
    }
    let offset = rounded_to_eighths(0.5 * low + 0.5 * high, half_extent);
    let first = steps[0];
    let local = Local::new(first.iter().map(|&p| (p - offset).as_vec3()));
    let difference = |later: &&[DVec3]| {
        let from_first = later.iter().zip(&local.values);
        Local::new(
            from_first
                .map(|(&p, &start)| (p - offset - DVec3::from(start.map(f64::from))).as_vec3()),
        )
    };
    Ok(Packed {
        offset,
        differences: steps[1..].iter().map(difference).collect(),
        local,
    })
}

/// Refuses positions that are no numbers, or beyond `f32`.
fn check(name: &str, positions: &[DVec3]) -> Result<(), WriteError> {
    let too_large = |p: &DVec3| !(p.abs().max_element() <= f64::from(f32::MAX));
    let Some(vertex) = positions.iter().position(too_large) else {
        return Ok(());
    };
    let name = name.to_owned();
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

impl Local {
    /// Of at least one vector.
    pub(super) fn new(vectors: impl Iterator<Item = Vec3>) -> Self {
        let values: Vec<[f32; 3]> = vectors.map(Vec3::into).collect();
        let (mut min, mut max) = (values[0], values[0]);
        for value in &values {
            for axis in 0..3 {
                min[axis] = min[axis].min(value[axis]);
                max[axis] = max[axis].max(value[axis]);
            }
        }
        Self { values, min, max }
    }
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

    #[test]
    fn far_away_details_survive() {
        let corner = DVec3::new(1e9 + 0.25, -3e8, 7.0);
        let positions = [
            corner,
            corner + DVec3::new(1e-3, 2e-3, 0.0),
            corner + DVec3::new(0.0, 0.0, 3e-3),
        ];
        let packed = pack("far", &[&positions]).unwrap();
        for (position, local) in positions.iter().zip(&packed.local.values) {
            let back = packed.offset + DVec3::from(local.map(f64::from));
            // Half a unit of f32 at 1.7e-3, and one of f64 at 1e9 from adding up here.
            let allowed = 1.7e-3 / f64::from(1 << 24) * 2.0 + 1.2e-7;
            assert!((back - *position).length() <= allowed);
        }
    }

    #[test]
    fn the_offset_is_exact_in_f32_within_a_million_extents() {
        for distance in [0.0, 1.0, 123.456, 5e5] {
            let middle = DVec3::new(distance, -distance / 3.0, 0.1);
            let packed = pack("near", &[&[middle - 0.7, middle + 0.7]]).unwrap();
            assert_eq!(
                packed.offset.as_vec3().as_dvec3(),
                packed.offset,
                "{distance}"
            );
            assert!(
                DVec3::from(packed.local.max.map(f64::from)).max_element()
                    <= 0.7 * 1.125 * (1.0 + 1e-7)
            );
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
        let slices: Vec<&[DVec3]> = steps.iter().map(Vec::as_slice).collect();
        let packed = pack("moving", &slices).unwrap();
        // Half of what it moves and is wide, and an eighth of that.
        let reach = 0.5 * 1.125 * 4e3 + 1.0;
        for (positions, difference) in steps[1..].iter().zip(&packed.differences) {
            for ((position, &start), &more) in positions
                .iter()
                .zip(&packed.local.values)
                .zip(&difference.values)
            {
                let sum = Vec3::from(start) + Vec3::from(more);
                let error = (packed.offset + sum.as_dvec3() - *position)
                    .abs()
                    .max_element();
                assert!(error <= 3.0 * reach * 2f64.powi(-24), "{error}");
            }
        }
    }

    #[test]
    fn what_f32_cannot_hold_is_refused() {
        let huge = pack("a", &[&[DVec3::ZERO, DVec3::new(0.0, 1e39, 0.0)]]).unwrap_err();
        assert!(
            huge.to_string()
                .contains("vertex 1 of the photosurface \"a\" is 1e39"),
            "{huge}"
        );
        assert!(pack("a", &[&[DVec3::NAN]]).is_err());
        assert!(pack("a", &[&[DVec3::ZERO, DVec3::splat(1e-40)]]).is_err());
        assert!(pack("a", &[&[]]).is_err());
        let point = pack("a", &[&[DVec3::splat(3.3)]]).unwrap();
        assert_eq!(
            (point.offset, point.local.values[0]),
            (DVec3::splat(3.3), [0.0; 3])
        );
    }
}
