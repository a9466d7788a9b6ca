//! Where positions are, and whether all of them are somewhere.

use glam::DVec3;
use pulp::{Arch, NullaryFnOnce};

/// Where some positions are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    pub(super) is_finite: bool,
}

impl Extent {
    /// That of these positions and of those that are `known`.
    pub(crate) fn around(known: Option<Self>, positions: &[DVec3]) -> Option<Self> {
        if let Some(extent) = Self::at_once(positions) {
            return Some(known.map_or(extent, |known| known.with(extent)));
        }
        let first = known.or_else(|| positions.first().copied().map(Self::of_one))?;
        let others = positions.iter().copied().map(Self::of_one);
        Some(others.fold(first, Self::with))
    }

    /// That of positions whose order does not matter: all are finite, and neither end of any axis is at a zero, of which
    /// there are two.
    fn at_once(positions: &[DVec3]) -> Option<Self> {
        let &first = positions.first()?;
        let (low, high) = Arch::new().dispatch(Ends { positions, first });
        // What is not a number is neither less nor more than anything, and shows in no end.
        let is_plain = |end: DVec3| end.is_finite() && end.to_array().iter().all(|&x| x != 0.0);
        (is_plain(low) && is_plain(high)).then_some(Self {
            low,
            high,
            is_finite: true,
        })
    }

    fn of_one(position: DVec3) -> Self {
        Self {
            low: position,
            high: position,
            is_finite: position.is_finite(),
        }
    }

    /// That of both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            is_finite: self.is_finite & other.is_finite,
        }
    }
}

/// The lowest and the highest of each coordinate, several in one instruction where the processor can; no numbers where one
/// of the coordinates is none.
struct Ends<'a> {
    positions: &'a [DVec3],
    first: DVec3,
}

/// Number of positions that are compared together.
const LANES: usize = 8;

impl NullaryFnOnce for Ends<'_> {
    type Output = (DVec3, DVec3);

    #[inline(always)]
    fn call(self) -> (DVec3, DVec3) {
        let (mut low, mut high) = ([self.first; LANES], [self.first; LANES]);
        // Zero as long as all are finite.
        let mut rest = [DVec3::ZERO; LANES];
        let (blocks, last) = self.positions.as_chunks::<LANES>();
        for block in blocks {
            for lane in 0..LANES {
                let position = block[lane];
                low[lane] = lower(position, low[lane]);
                high[lane] = -lower(-position, -high[lane]);
                rest[lane] += position - position;
            }
        }
        for (lane, &position) in last.iter().enumerate() {
            low[lane] = lower(position, low[lane]);
            high[lane] = -lower(-position, -high[lane]);
            rest[lane] += position - position;
        }
        let (mut lowest, mut highest, mut all) = (low[0], high[0], rest[0]);
        for lane in 1..LANES {
            lowest = lower(low[lane], lowest);
            highest = -lower(-high[lane], -highest);
            all += rest[lane];
        }
        (lowest + all, highest + all)
    }
}

#[inline(always)]
fn lower(one: DVec3, other: DVec3) -> DVec3 {
    let lower = |one: f64, other: f64| if one < other { one } else { other };
    DVec3::new(
        lower(one.x, other.x),
        lower(one.y, other.y),
        lower(one.z, other.z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_at_once_are_the_same_as_one_by_one() {
        let place = |k: u32| {
            let turn = f64::from(k) + 0.5;
            DVec3::new(turn.sin(), 3.0 + turn.cos(), -turn - 0.5)
        };
        let odd = [
            DVec3::ZERO,
            -DVec3::ZERO,
            DVec3::new(1.0, f64::NAN, 1.0),
            DVec3::new(1.0, 1.0, f64::INFINITY),
            DVec3::new(f64::NEG_INFINITY, 1.0, 1.0),
        ];
        for count in [0, 1, 7, 8, 9, 100, 1003] {
            let plain: Vec<DVec3> = (0..count).map(place).collect();
            assert_eq!(Extent::at_once(&plain).is_some(), count > 0);
            for odd in odd.iter().copied().map(Some).chain([None]) {
                for at in [0, plain.len() / 2, plain.len()] {
                    let mut positions = plain.clone();
                    positions.splice(at..at, odd);
                    let ones = positions.iter().copied().map(Extent::of_one);
                    let expected = ones.reduce(Extent::with);
                    let found = Extent::around(None, &positions);
                    let bits = |place: DVec3| place.to_array().map(f64::to_bits);
                    let numbers = |e: Extent| (bits(e.low), bits(e.high), e.is_finite);
                    assert_eq!(found.map(numbers), expected.map(numbers), "{positions:?}");
                }
            }
        }
    }
}
