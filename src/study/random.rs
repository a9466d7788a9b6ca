//! Random numbers that are the same on every run.

use glam::DVec3;

/// SplitMix64 (Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, 2014).
pub(super) struct Random(u64);

impl Random {
    /// Numbers that differ from those of any other seed.
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Even in `[0, 1)`.
    pub(super) fn fraction(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number below `count`, which is not zero.
    pub(super) fn below(&mut self, count: usize) -> usize {
        ((self.fraction() * count as f64) as usize).min(count - 1)
    }

    /// Weights of the corners of a triangle, even on it.
    pub(super) fn weights(&mut self) -> DVec3 {
        let (mut u, mut v) = (self.fraction(), self.fraction());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        DVec3::new(1.0 - u - v, u, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_spread_over_what_was_asked_for() {
        let mut random = Random::new(1);
        let mut counts = [0usize; 4];
        let mut sum = DVec3::ZERO;
        for _ in 0..40_000 {
            counts[random.below(4)] += 1;
            let weights = random.weights();
            assert!(weights.min_element() >= 0.0 && (weights.element_sum() - 1.0).abs() < 1e-15);
            sum += weights;
        }
        // Five standard deviations: of a count sqrt(40000 * 3/16) = 87, of a mean weight sqrt(1/18 / 40000) = 0.0012.
        assert!(
            counts.iter().all(|&count| count.abs_diff(10_000) < 433),
            "{counts:?}"
        );
        let mean = sum / 40_000.0;
        assert!(
            (mean - DVec3::splat(1.0 / 3.0)).abs().max_element() < 0.006,
            "{mean}"
        );
    }
}
