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
        let [low, high] = ends(positions)?;
        Self::of_ends(low, high)
    }

    /// That of positions between these ends, of which nothing is known if a number is missing or zero.
    pub(super) fn of_ends(low: DVec3, high: DVec3) -> Option<Self> {
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

/// The lowest and the highest of each coordinate; no numbers where one of the coordinates is none. `None` of no vectors.
pub(super) fn ends<V: Triple>(vectors: &[V]) -> Option<[V; 2]> {
    let &first = vectors.first()?;
    Some(Arch::new().dispatch(Ends { vectors, first }))
}

/// Three numbers of either precision.
pub(super) trait Triple: Copy {
    /// The lower one of each.
    fn lower(self, other: Self) -> Self;
    /// The higher one of each.
    fn higher(self, other: Self) -> Self;
    /// Zero if all are finite, added to something.
    fn rest_and(self, sum: Self) -> Self;
    fn sum(self, other: Self) -> Self;
    const ZERO: Self;
}

impl Triple for DVec3 {
    const ZERO: Self = Self::ZERO;

    #[inline(always)]
    fn lower(self, other: Self) -> Self {
        let [a, b] = [self, other].map(|vector| vector.to_array());
        Self::from_array(std::array::from_fn(
            |i| if a[i] < b[i] { a[i] } else { b[i] },
        ))
    }

    #[inline(always)]
    fn higher(self, other: Self) -> Self {
        let [a, b] = [self, other].map(|vector| vector.to_array());
        Self::from_array(std::array::from_fn(
            |i| if a[i] > b[i] { a[i] } else { b[i] },
        ))
    }

    #[inline(always)]
    fn rest_and(self, sum: Self) -> Self {
        sum + 0.0 * self
    }

    #[inline(always)]
    fn sum(self, other: Self) -> Self {
        self + other
    }
}

impl Triple for [f32; 3] {
    const ZERO: Self = [0.0; 3];

    #[inline(always)]
    fn lower(self, other: Self) -> Self {
        std::array::from_fn(|i| {
            if self[i] < other[i] {
                self[i]
            } else {
                other[i]
            }
        })
    }

    #[inline(always)]
    fn higher(self, other: Self) -> Self {
        std::array::from_fn(|i| {
            if self[i] > other[i] {
                self[i]
            } else {
                other[i]
            }
        })
    }

    #[inline(always)]
    fn rest_and(self, sum: Self) -> Self {
        std::array::from_fn(|i| sum[i] + 0.0 * self[i])
    }

    #[inline(always)]
    fn sum(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
}

/// The ends of vectors, several compared in one instruction where the processor can.
struct Ends<'a, V> {
    vectors: &'a [V],
    first: V,
}

/// Number of vectors that are compared together.
const LANES: usize = 8;

impl<V: Triple> NullaryFnOnce for Ends<'_, V> {
    type Output = [V; 2];

    #[inline(always)]
    fn call(self) -> [V; 2] {
        let (mut low, mut high) = ([self.first; LANES], [self.first; LANES]);
        // Zero as long as all are finite.
        let mut rest = [V::ZERO; LANES];
        let (blocks, last) = self.vectors.as_chunks::<LANES>();
        for block in blocks {
            for lane in 0..LANES {
                low[lane] = block[lane].lower(low[lane]);
                high[lane] = block[lane].higher(high[lane]);
                rest[lane] = block[lane].rest_and(rest[lane]);
            }
        }
        for (lane, &vector) in last.iter().enumerate() {
            low[lane] = vector.lower(low[lane]);
            high[lane] = vector.higher(high[lane]);
            rest[lane] = vector.rest_and(rest[lane]);
        }
        let (mut lowest, mut highest, mut all) = (low[0], high[0], rest[0]);
        for lane in 1..LANES {
            lowest = low[lane].lower(lowest);
            highest = high[lane].higher(highest);
            all = rest[lane].sum(all);
        }
        [lowest.sum(all), highest.sum(all)]
    }
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
