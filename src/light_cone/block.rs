//! A block of points, stored coordinate by coordinate, so that the compiler can use vector instructions for the loops.

use glam::DVec3;

use super::safe_range::{SafeRangeMap, SeenPoint, forwardness, is_in_safe_range, size};
use super::{Extremes, View};
use crate::spacetime::exact::Product;

/// Number of points in a block: enough for the longest vector registers, and few enough that reading the next points
/// overlaps with the computation.
pub(super) const BLOCK: usize = 32;

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

    #[inline(always)]
    fn load(&mut self, vectors: &[DVec3; BLOCK]) {
        for (index, &vector) in vectors.iter().enumerate() {
            self.set(index, vector);
        }
    }

    #[inline(always)]
    pub(super) fn store(&self, vectors: &mut [DVec3; BLOCK]) {
        for (index, vector) in vectors.iter_mut().enumerate() {
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

/// The points of a block, at rest and as the observer sees them. One instance serves for all blocks, because clearing a
/// new one would take time.
pub(super) struct Block {
    rest: Columns,
    pub(super) position: Columns,
    pub(super) normal: Columns,
    distance: Numbers,
    lean: Numbers,
    across: Columns,
    distance_at_rest: Numbers,
    square_rest: Numbers,
    /// Size of each point's offset from the observer, by [`size`].
    size: Numbers,
}

impl Block {
    pub(super) const ZERO: Self = Self {
        rest: Columns::ZERO,
        position: Columns::ZERO,
        normal: Columns::ZERO,
        distance: [0.0; BLOCK],
        lean: [0.0; BLOCK],
        across: Columns::ZERO,
        distance_at_rest: [0.0; BLOCK],
        square_rest: [0.0; BLOCK],
        size: [0.0; BLOCK],
    };

    /// Maps the points of a block; without `ALL` only their positions.
    #[inline(always)]
    pub(super) fn see<P: Product, const ALL: bool>(
        &mut self,
        view: &View,
        safe_map: &SafeRangeMap,
        rest: &[DVec3; BLOCK],
    ) {
        let (observer, turn) = (view.observer_rest(), view.turn());
        self.rest.load(rest);
        for index in 0..BLOCK {
            let rest = self.rest.get(index);
            let offset = rest - observer;
            let seen_point = safe_map.see::<P>(offset);
            self.position.set(index, turn * seen_point.position);
            self.size[index] = size(offset);
            if ALL {
                self.distance[index] = seen_point.distance;
                self.lean[index] = seen_point.lean;
                self.across.set(index, seen_point.across);
                self.distance_at_rest[index] = seen_point.distance_at_rest;
                self.square_rest[index] = rest.length_squared();
            }
        }
    }

    /// Whether no point is tiny or huge; if one is, the other results have no meaning.
    #[inline(always)]
    pub(super) fn is_in_safe_range(&self) -> bool {
        let mut others = 0;
        for index in 0..BLOCK {
            others += u64::from(!is_in_safe_range(self.size[index]));
        }
        others == 0
    }

    /// The normals in the observer's frame at the points of the block, from the normals `rest` in the rest frame.
    #[inline(always)]
    pub(super) fn see_normals(
        &mut self,
        view: &View,
        safe_map: &SafeRangeMap,
        rest: &[DVec3; BLOCK],
    ) {
        let turn = view.turn();
        self.rest.load(rest);
        for index in 0..BLOCK {
            let seen_point = SeenPoint {
                position: self.position.get(index),
                distance: self.distance[index],
                lean: self.lean[index],
                across: self.across.get(index),
                distance_at_rest: self.distance_at_rest[index],
            };
            let normal = safe_map.seen_normal(&seen_point, self.rest.get(index));
            self.normal.set(index, turn * normal);
        }
    }
}

/// The extremes over all blocks, separately for each index in a block.
pub(super) struct Accumulated {
    low: Columns,
    high: Columns,
    nearest: Numbers,
    farthest: Numbers,
    square_rest: Numbers,
    lean: Numbers,
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
            lean: all(0.0),
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
        raise(&mut self.lean, &block.lean);
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
            forwardness: forwardness(most(&self.lean)),
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
