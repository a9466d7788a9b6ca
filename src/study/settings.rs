//! What a study looks at, and how closely.

use std::num::{NonZeroU32, NonZeroUsize};

use super::{RaySettings, StudyError};
use crate::scene::Tolerance;

/// What is measured of each tolerance beside its runs: the error, and uniform subdivision.
pub(super) const MEASUREMENTS: usize = 2;

/// The tolerances and pictures that a study looks at, and how closely.
#[derive(Clone, Debug)]
pub struct CostSettings {
    /// Of meshes: all in one unit, none twice, in any order; none for no meshes.
    pub tolerances: Vec<Tolerance>,
    /// Pictures by rays, if there are to be any.
    pub rays: Option<RaySettings>,
    /// How often each tolerance and each number of rays is carried out; times are medians.
    pub repeats: NonZeroUsize,
    /// What would take more triangles is predicted, and not made.
    pub max_triangles: u64,
    /// At about how many random places the error of each tolerance is measured.
    pub samples: NonZeroUsize,
    /// Uniform subdivision is counted, and not carried out, where it makes more triangles.
    pub max_uniform_triangles: u64,
}

impl Default for CostSettings {
    /// Meshes alone, from a tenth to a millionth of the diagonal.
    fn default() -> Self {
        let fraction = |number| Tolerance::relative(number).expect("finite and positive");
        let tolerances = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
        Self {
            tolerances: tolerances.map(fraction).to_vec(),
            rays: None,
            repeats: NonZeroUsize::MIN.saturating_add(2),
            max_triangles: 3_000_000,
            samples: NonZeroUsize::MIN.saturating_add(199_999),
            max_uniform_triangles: 2_000_000,
        }
    }
}

impl CostSettings {
    /// How many runs, measurements and pictures [`CostStudy::new`](super::CostStudy::new) does.
    pub fn pieces(&self) -> usize {
        let repeats = self.repeats.get();
        let rays = self.rays.as_ref();
        self.tolerances.len() * (repeats + MEASUREMENTS)
            + rays.map_or(0, |rays| rays.pieces(repeats))
    }
}

/// The loosest first.
pub(super) fn in_order(tolerances: &[Tolerance]) -> Result<Vec<Tolerance>, StudyError> {
    let mut sorted = tolerances.to_vec();
    sorted.sort_by(|a, b| b.number().total_cmp(&a.number()));
    for pair in sorted.windows(2) {
        if pair[0].unit() != pair[1].unit() {
            return Err(StudyError::MixedUnits(pair[0], pair[1]));
        }
        if pair[0] == pair[1] {
            return Err(StudyError::Repeated(pair[0]));
        }
    }
    Ok(sorted)
}

/// The fewest first.
pub(super) fn rising(samples: &[NonZeroU32]) -> Result<Vec<u32>, StudyError> {
    let mut sorted: Vec<u32> = samples.iter().map(|samples| samples.get()).collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(StudyError::RepeatedSamples(pair[0])),
        None => Ok(sorted),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_put_in_order_or_refused() {
        let relative = |number| Tolerance::relative(number).unwrap();
        let absolute = |number| Tolerance::absolute(number).unwrap();
        let sorted = in_order(&[1e-3, 1e-1, 1e-2].map(relative)).unwrap();
        assert_eq!(sorted, [1e-1, 1e-2, 1e-3].map(relative));
        let error = |tolerances: &[Tolerance]| in_order(tolerances).unwrap_err().to_string();
        assert!(error(&[absolute(1.0), relative(0.5)]).contains("abs:1.000e0 and 5.000e-1"));
        assert!(error(&[absolute(1.0), absolute(1.0)]).contains("abs:1.000e0 is given twice"));
    }
}
