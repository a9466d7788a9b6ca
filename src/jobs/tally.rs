//! Totals of the photosurfaces that a job has made.

use crate::pipeline::Facts;

/// Totals of the photosurfaces that a job has made: their number, their triangles, and whether they are within their
/// tolerances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Number of photosurfaces.
    pub photosurfaces: usize,
    /// Number of triangles in files: a mesh that all steps share counts once.
    pub triangles: usize,
    /// Number of photosurfaces that are not proven to be within their tolerances.
    pub uncertified: usize,
    /// Among these, the photosurface with the largest ratio of its proven bound to its tolerance.
    pub worst: Option<Facts>,
}

impl Tally {
    /// Whether all photosurfaces are proven to be within their tolerances.
    pub fn is_certified(&self) -> bool {
        self.uncertified == 0
    }

    /// Adds one photosurface with `triangles` triangles.
    pub(super) fn add(&mut self, facts: &Facts, triangles: usize) {
        self.photosurfaces += 1;
        self.triangles += triangles;
        if facts.certificate.complete {
            return;
        }
        self.uncertified += 1;
        self.compare(facts);
    }

    /// Adds everything that another tally holds.
    pub fn merge(&mut self, other: Self) {
        self.photosurfaces += other.photosurfaces;
        self.triangles += other.triangles;
        self.uncertified += other.uncertified;
        if let Some(worst) = other.worst {
            self.compare(&worst);
        }
    }

    /// Keeps a photosurface if it is worse than the worst so far.
    fn compare(&mut self, facts: &Facts) {
        let excess = |facts: &Facts| facts.certificate.total / facts.certificate.tolerance;
        // Written so that NaN counts as the worst.
        let better = |worst: &Facts| excess(facts) <= excess(worst);
        if !self.worst.as_ref().is_some_and(better) {
            self.worst = Some(facts.clone());
        }
    }
}
