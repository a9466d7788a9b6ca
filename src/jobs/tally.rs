//! What a job has made, in sum.

use crate::pipeline::Facts;

/// What a job has made, in sum: how much, and how far it is from its tolerances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// How many photosurfaces.
    pub photosurfaces: usize,
    /// Their triangles, as files have them: where all steps share one mesh, they count once.
    pub triangles: usize,
    /// How many photosurfaces are not proven to be within their tolerances.
    pub uncertified: usize,
    /// The photosurface, of those, whose proven bound is the largest multiple of its tolerance.
    pub worst: Option<Facts>,
}

impl Tally {
    /// Whether all photosurfaces are proven to be within their tolerances.
    pub fn is_certified(&self) -> bool {
        self.uncertified == 0
    }

    /// Counts one photosurface more, and so many triangles.
    pub(super) fn add(&mut self, facts: &Facts, triangles: usize) {
        self.photosurfaces += 1;
        self.triangles += triangles;
        if facts.certificate.complete {
            return;
        }
        self.uncertified += 1;
        let excess = |facts: &Facts| facts.certificate.total / facts.certificate.tolerance;
        // Written so that NaN is worse than anything.
        let better = |worst: &Facts| excess(facts) <= excess(worst);
        if !self.worst.as_ref().is_some_and(better) {
            self.worst = Some(facts.clone());
        }
    }
}
