//! The photosurface map for many points at once, several in one instruction where the processor has vector
//! instructions.
//!
//! `pulp` detects the vector instructions at run time. A block whose points are all in the safe range (neither tiny nor
//! huge) goes through the map without branches. Any other block goes through the map for single points, point by point.
//! The results are the same, bit for bit, in both ways.

use glam::DVec3;
use pulp::{Arch, NullaryFnOnce};

use super::block::{Accumulated, BLOCK, Block};
use super::safe_range::SafeRangeMap;
use super::{Extremes, View};
use crate::spacetime::exact::{Fused, Product, Split};
use crate::spacetime::length;

/// Points in the rest frame, with slices for their positions and normals in the observer's frame.
pub(crate) struct Batch<'a> {
    pub(crate) rest: &'a [DVec3],
    /// Where each point is seen, in the observer's frame; as many as there are points at rest.
    pub(crate) seen: &'a mut [DVec3],
    /// Normals in the rest frame, each of unit length or zero, and a slice for the normals in the observer's frame.
    pub(crate) normals: Option<(&'a [DVec3], &'a mut [DVec3])>,
}

impl Batch<'_> {
    fn check(&self) {
        assert_eq!(self.rest.len(), self.seen.len(), "a place for each point");
        if let Some((rest, seen)) = &self.normals {
            let lengths = (rest.len(), seen.len());
            assert_eq!(
                lengths,
                (self.rest.len(), self.rest.len()),
                "one normal for each point"
            );
        }
    }
}

impl View {
    /// Maps all points of a batch. The results equal those of [`View::seen_position`] and [`View::seen_normal`], bit
    /// for bit, unless a coordinate other than zero is below `1e-250`, where products lose digits.
    ///
    /// # Panics
    ///
    /// If the slices of the batch do not have the same length.
    pub(crate) fn see(&self, batch: Batch<'_>) -> Extremes {
        batch.check();
        self.see_by_blocks::<true>(batch, true)
    }

    /// Does the same for whoever knows the extremes.
    ///
    /// # Panics
    ///
    /// As [`View::see`].
    pub(crate) fn see_again(&self, batch: Batch<'_>) {
        batch.check();
        match batch.normals.is_some() {
            true => self.see_by_blocks::<true>(batch, false),
            false => self.see_by_blocks::<false>(batch, false),
        };
    }

    /// Writes to `seen` where all points of `positions_rest` are seen, in the observer's frame. It does the same as
    /// [`View::seen_position`] for each point, in a fraction of the time (`cargo bench --bench bandwidth`).
    ///
    /// # Accuracy
    ///
    /// The results equal those of [`View::seen_position`], bit for bit, except for points with a coordinate other than
    /// zero below `1e-250`.
    ///
    /// # Panics
    ///
    /// If `seen` and `positions_rest` do not have the same length, as in [`slice::copy_from_slice`].
    pub fn seen_positions(&self, positions_rest: &[DVec3], seen: &mut [DVec3]) {
        assert_eq!(positions_rest.len(), seen.len(), "a place for each point");
        let batch = Batch {
            rest: positions_rest,
            seen,
            normals: None,
        };
        self.see_by_blocks::<false>(batch, false);
    }

    /// Without `ALL` only the positions are computed; the extremes have a meaning `with_extremes` and `ALL`.
    fn see_by_blocks<const ALL: bool>(&self, batch: Batch<'_>, with_extremes: bool) -> Extremes {
        let Some(safe_map) = self.map().safe_range_map() else {
            return self.see_one_by_one(batch);
        };
        let blocks = Blocks::<ALL> {
            view: self,
            safe_map,
            batch,
            with_extremes,
        };
        match Arch::new() {
            // A processor without fused multiply-add instructions would call a function for each fused product.
            Arch::Scalar => blocks.run::<Split>(),
            arch => arch.dispatch(blocks),
        }
    }

    fn see_one_by_one(&self, batch: Batch<'_>) -> Extremes {
        let mut extremes = Extremes::NONE;
        for (&rest, seen) in batch.rest.iter().zip(batch.seen) {
            *seen = self.seen_position(rest);
            let distance = length(*seen);
            extremes = extremes.and(Extremes {
                low: *seen,
                high: *seen,
                nearest: distance,
                farthest: distance,
                farthest_rest: length(rest),
                forwardness: self.forwardness(rest),
            });
        }
        if let Some((normals, seen)) = batch.normals {
            for ((&rest, &normal), seen) in batch.rest.iter().zip(normals).zip(seen) {
                *seen = self.seen_normal(rest, normal);
            }
        }
        extremes
    }
}

struct Blocks<'a, const ALL: bool> {
    view: &'a View,
    safe_map: &'a SafeRangeMap,
    batch: Batch<'a>,
    with_extremes: bool,
}

impl<const ALL: bool> NullaryFnOnce for Blocks<'_, ALL> {
    type Output = Extremes;

    #[inline(always)]
    fn call(self) -> Extremes {
        self.run::<Fused>()
    }
}

impl<const ALL: bool> Blocks<'_, ALL> {
    #[inline(always)]
    fn run<P: Product>(self) -> Extremes {
        let Batch {
            rest,
            seen,
            normals,
        } = self.batch;
        let (normals_rest, normals_seen) = normals.unzip();
        let (rest, last_rest) = rest.as_chunks();
        let (seen, last_seen) = seen.as_chunks_mut();
        let (normals_rest, last_normals_rest) = normals_rest.unwrap_or_default().as_chunks();
        let (normals_seen, last_normals_seen) = normals_seen.unwrap_or_default().as_chunks_mut();

        let mut work = Work::<ALL> {
            view: self.view,
            safe_map: self.safe_map,
            block: Block::ZERO,
            of_blocks: Accumulated::new(),
            of_others: Extremes::NONE,
            with_extremes: self.with_extremes,
        };
        let mut normals = normals_rest.iter().zip(normals_seen);
        for (rest, seen) in rest.iter().zip(seen) {
            work.see::<P>(rest, seen, normals.next());
        }
        if !last_rest.is_empty() {
            let mut seen = [DVec3::ZERO; BLOCK];
            let mut normals_seen = [DVec3::ZERO; BLOCK];
            let normals_rest = padded(last_normals_rest);
            let normals = Some((&normals_rest, &mut normals_seen));
            let normals = normals.filter(|_| !last_normals_rest.is_empty());
            work.see::<P>(&padded(last_rest), &mut seen, normals);
            last_seen.copy_from_slice(&seen[..last_seen.len()]);
            last_normals_seen.copy_from_slice(&normals_seen[..last_normals_seen.len()]);
        }
        work.of_blocks.extremes().and(work.of_others)
    }
}

/// A whole block, filled up with copies of the last vector. The copies do not change the extremes.
fn padded(vectors: &[DVec3]) -> [DVec3; BLOCK] {
    let mut block = [vectors.last().copied().unwrap_or_default(); BLOCK];
    block[..vectors.len()].copy_from_slice(vectors);
    block
}

/// A block being mapped, and the extremes of the points so far.
struct Work<'a, const ALL: bool> {
    view: &'a View,
    safe_map: &'a SafeRangeMap,
    block: Block,
    of_blocks: Accumulated,
    of_others: Extremes,
    with_extremes: bool,
}

impl<const ALL: bool> Work<'_, ALL> {
    #[inline(always)]
    fn see<P: Product>(
        &mut self,
        rest: &[DVec3; BLOCK],
        seen: &mut [DVec3; BLOCK],
        normals: Option<(&[DVec3; BLOCK], &mut [DVec3; BLOCK])>,
    ) {
        let block = &mut self.block;
        block.see::<P, ALL>(self.view, self.safe_map, rest);
        if !block.is_in_safe_range() {
            let batch = Batch {
                rest,
                seen,
                normals: normals.map(|(rest, seen)| (rest.as_slice(), seen.as_mut_slice())),
            };
            self.of_others = self.of_others.and(self.view.see_one_by_one(batch));
            return;
        }
        block.position.store(seen);
        if ALL && self.with_extremes {
            self.of_blocks.add(block);
        }
        if let Some((rest, seen)) = normals {
            block.see_normals(self.view, self.safe_map, rest);
            block.normal.store(seen);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spacetime::{Event, Velocity, WorldLine};

    fn view(rapidity: f64, place: DVec3) -> View {
        let line = |position, velocity| WorldLine {
            origin: Event::new(0.0, position),
            velocity,
        };
        let velocity = Velocity::from_rapidity(rapidity, DVec3::new(1.0, 2.0, -3.0)).unwrap();
        let object = Velocity::from_beta(0.3, DVec3::new(-1.0, 0.5, 0.2)).unwrap();
        View::new(
            &line(place, velocity).moment(0.25),
            &line(DVec3::ZERO, object),
        )
    }

    /// Points in all directions, some almost exactly ahead of or behind the observer. With `odd` some are tiny, huge,
    /// at the observer or not finite.
    fn points(count: usize, odd: bool, view: &View) -> Vec<DVec3> {
        let along = view.relative_velocity().direction();
        let point = |index: usize| {
            let turn = |factor: f64| (index as f64 * factor).fract() * std::f64::consts::TAU;
            let aside = DVec3::new(turn(0.618).sin(), turn(0.414).cos(), turn(0.732).sin());
            let offset = match index % 5 {
                0 => along + aside * 1e-9,
                1 => aside * 1e-12 - along,
                2 => along * -3.0,
                _ => aside,
            };
            let odd = odd && index % 97 == 96;
            view.observer_rest()
                + match index / 97 % 6 {
                    0 if odd => DVec3::ZERO,
                    1 if odd => offset * 1e-200,
                    2 if odd => offset * 1e160,
                    3 if odd => DVec3::NAN,
                    4 if odd => DVec3::INFINITY,
                    _ => offset,
                }
        };
        (0..count).map(point).collect()
    }

    fn bits(vectors: &[DVec3]) -> Vec<[u64; 3]> {
        let bits = |vector: &DVec3| vector.to_array().map(f64::to_bits);
        vectors.iter().map(bits).collect()
    }

    #[test]
    fn all_at_once_or_one_by_one_is_the_same_bit_for_bit() {
        for rapidity in [0.0, 1e-9, 0.5, 3.0, 20.0, 100.0, 300.0] {
            for odd in [false, true] {
                // The counts include an incomplete block and no point at all; the last count is large enough for all
                // kinds of odd points.
                for count in [0, 1, BLOCK, 600 + BLOCK / 2 + 1] {
                    let view = view(rapidity, DVec3::new(0.1, 0.2, 0.3));
                    let rest = points(count, odd, &view);
                    let kinds = rest.iter().filter(|point| !point.is_finite()).count();
                    assert_eq!(kinds, if odd && count > 500 { 2 } else { 0 });
                    let normals = rest.iter().enumerate();
                    let normals = normals.map(|(index, point)| match index % 50 {
                        7 => DVec3::ZERO,
                        _ => DVec3::new(point.z, point.x, point.y)
                            .try_normalize()
                            .unwrap_or(DVec3::X),
                    });
                    let normals: Vec<DVec3> = normals.collect();
                    let mut seen = vec![DVec3::ONE; count];
                    let mut seen_normals = seen.clone();
                    let extremes = view.see(Batch {
                        rest: &rest,
                        seen: &mut seen,
                        normals: Some((&normals, &mut seen_normals)),
                    });
                    let each = || rest.iter().zip(&normals);
                    let expected: Vec<DVec3> =
                        each().map(|(&p, _)| view.seen_position(p)).collect();
                    let case = format!("rapidity {rapidity}, {count} points, odd ones {odd}");
                    assert_eq!(bits(&seen), bits(&expected), "{case}");
                    let expected: Vec<DVec3> =
                        each().map(|(&p, &n)| view.seen_normal(p, n)).collect();
                    assert_eq!(bits(&seen_normals), bits(&expected), "{case}, normals");
                    check(&view, &rest, &seen, &extremes);
                }
            }
        }
    }

    fn check(view: &View, rest: &[DVec3], seen: &[DVec3], extremes: &Extremes) {
        if rest.is_empty() {
            assert_eq!(extremes, &Extremes::NONE);
            assert_eq!(extremes.bounds(), None);
            return;
        }
        let low = seen.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
        let high = seen
            .iter()
            .fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
        assert_eq!(extremes.bounds(), Some((low, high)));
        let near = |found: f64, expected: &mut dyn Iterator<Item = f64>, least: bool| {
            let pick = if least { f64::min } else { f64::max };
            let expected = expected.fold(if least { f64::INFINITY } else { 0.0 }, pick);
            let same = found == expected || (found / expected - 1.0).abs() < 1e-14;
            assert!(same, "{found} {expected}");
        };
        near(extremes.nearest, &mut seen.iter().map(|&p| length(p)), true);
        near(
            extremes.farthest,
            &mut seen.iter().map(|&p| length(p)),
            false,
        );
        near(
            extremes.farthest_rest,
            &mut rest.iter().map(|&p| length(p)),
            false,
        );
        let stretch = |point: &DVec3| view.stretch_toward(view.forwardness(*point));
        let stretches = &mut rest.iter().map(stretch);
        near(view.stretch_toward(extremes.forwardness), stretches, false);
    }

    #[test]
    fn places_alone_are_the_same() {
        let view = view(2.0, DVec3::ZERO);
        let rest = points(1000, false, &view);
        let mut seen = vec![DVec3::ZERO; rest.len()];
        view.seen_positions(&rest, &mut seen);
        let expected: Vec<DVec3> = rest
            .iter()
            .map(|&point| view.seen_position(point))
            .collect();
        assert_eq!(bits(&seen), bits(&expected));
    }
}
