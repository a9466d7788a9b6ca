//! A block of points coordinate by coordinate, in loops of which the compiler makes vectors.

use glam::DVec3;

use super::plain::{PlainMap, is_plain, size};
use super::{Extremes, View};
use crate::spacetime::exact::Product;

/// Points that are taken at a time: enough for the longest vectors, few enough for the nearest cache.
pub(super) const BLOCK: usize = 64;

/// A number for each point of a block.
type Numbers = [f64; BLOCK];

/// A vector for each point of a block, component by component.
pub(super) struct Columns {
    x: Numbers,
    y: Numbers,
    z: Numbers,
}

impl Columns {
    const ZERO: Self = Self {
        x: [0.0; BLOCK],
        y: [0.0; BLOCK],
        z: [0.0; BLOCK],
    };

    /// The last vector again where there are too few: it changes nothing that all have in common.
    #[inline(always)]
    fn load(vectors: &[DVec3]) -> Self {
        let mut columns = Self::ZERO;
        let last = vectors.last().copied().unwrap_or_default();
        for index in 0..BLOCK {
            columns.set(index, *vectors.get(index).unwrap_or(&last));
        }
        columns
    }

    #[inline(always)]
    pub(super) fn store(&self, vectors: &mut [DVec3]) {
        for (index, vector) in vectors.iter_mut().enumerate().take(BLOCK) {
            *vector = self.get(index);
        }
    }

    #[inline(always)]
    fn get(&self, index: usize) -> DVec3 {
        DVec3 {
            x: self.x[index],
            y: self.y[index],
            z: self.z[index],
        }
    }

    #[inline(always)]
    fn set(&mut self, index: usize, vector: DVec3) {
        self.x[index] = vector.x;
        self.y[index] = vector.y;
        self.z[index] = vector.z;
    }
}

/// How the points of a block are seen.
pub(super) struct Block {
    size: Numbers,
    square_rest: Numbers,
    pub(super) position: Columns,
    distance: Numbers,
    forwardness_squared: Numbers,
    toward_across: Columns,
    doppler_factor: Numbers,
}

impl Block {
    #[inline(always)]
    pub(super) fn seen<P: Product>(view: &View, plain: &PlainMap, rest: &[DVec3]) -> Self {
        let (observer, turn) = (view.observer_rest(), view.turn());
        let rest = Columns::load(rest);
        let mut block = Self {
            size: [0.0; BLOCK],
            square_rest: [0.0; BLOCK],
            position: Columns::ZERO,
            distance: [0.0; BLOCK],
            forwardness_squared: [0.0; BLOCK],
            toward_across: Columns::ZERO,
            doppler_factor: [0.0; BLOCK],
        };
        for index in 0..BLOCK {
            let rest = rest.get(index);
            let offset = rest - observer;
            let sighting = plain.see::<P>(offset);
            block.size[index] = size(offset);
            block.square_rest[index] = rest.length_squared();
            block.position.set(index, turn * sighting.position);
            block.distance[index] = sighting.distance;
            block.forwardness_squared[index] = sighting.forwardness_squared;
            block.toward_across.set(index, sighting.toward_across);
            block.doppler_factor[index] = sighting.doppler_factor;
        }
        block
    }

    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        let mut others = 0;
        for index in 0..BLOCK {
            others += u64::from(!is_plain(self.size[index]));
        }
        others == 0
    }

    #[inline(always)]
    pub(super) fn normals(&self, view: &View, plain: &PlainMap, rest: &[DVec3]) -> Columns {
        let turn = view.turn();
        let mut columns = Columns::load(rest);
        for index in 0..BLOCK {
            let (toward_across, doppler_factor) =
                (self.toward_across.get(index), self.doppler_factor[index]);
            let normal = plain.seen_normal(toward_across, doppler_factor, columns.get(index));
            columns.set(index, turn * normal);
        }
        columns
    }
}

/// The extremes of blocks, of each place in them by itself.
pub(super) struct Accumulated {
    low: Columns,
    high: Columns,
    nearest: Numbers,
    farthest: Numbers,
    square_rest: Numbers,
    forwardness_squared: Numbers,
}

impl Accumulated {
    pub(super) fn new() -> Self {
        let all = |number: f64| [number; BLOCK];
        let columns = |number: f64| Columns {
            x: all(number),
            y: all(number),
            z: all(number),
        };
        Self {
            low: columns(f64::INFINITY),
            high: columns(f64::NEG_INFINITY),
            nearest: all(f64::INFINITY),
            farthest: all(0.0),
            square_rest: all(0.0),
            forwardness_squared: all(0.0),
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, block: &Block) {
        lower(&mut self.low.x, &block.position.x);
        lower(&mut self.low.y, &block.position.y);
        lower(&mut self.low.z, &block.position.z);
        raise(&mut self.high.x, &block.position.x);
        raise(&mut self.high.y, &block.position.y);
        raise(&mut self.high.z, &block.position.z);
        lower(&mut self.nearest, &block.distance);
        raise(&mut self.farthest, &block.distance);
        raise(&mut self.square_rest, &block.square_rest);
        raise(&mut self.forwardness_squared, &block.forwardness_squared);
    }

    pub(super) fn extremes(&self) -> Extremes {
        let least = |numbers: &Numbers| numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |numbers: &Numbers| numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let each = |columns: &Columns, of: &dyn Fn(&Numbers) -> f64| {
            DVec3::new(of(&columns.x), of(&columns.y), of(&columns.z))
        };
        Extremes {
            low: each(&self.low, &least),
            high: each(&self.high, &most),
            nearest: least(&self.nearest),
            farthest: most(&self.farthest),
            farthest_rest: most(&self.square_rest).sqrt(),
            forwardness: most(&self.forwardness_squared).sqrt(),
        }
    }
}

#[inline(always)]
fn lower(least: &mut Numbers, numbers: &Numbers) {
    for index in 0..BLOCK {
        let (old, new) = (least[index], numbers[index]);
        least[index] = if new < old { new } else { old };
    }
}

#[inline(always)]
fn raise(most: &mut Numbers, numbers: &Numbers) {
    for index in 0..BLOCK {
        let (old, new) = (most[index], numbers[index]);
        most[index] = if new > old { new } else { old };
    }
}
