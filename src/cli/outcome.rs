//! What a run of export or render has made.

use std::path::PathBuf;

use photosurface::jobs::Tally;

use super::status::Status;
use super::work::Plan;

/// What a run has made, or would make.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) status: Status,
    /// All files, those with the data of `.gltf` files too.
    pub(super) files: Vec<PathBuf>,
    /// How many of them were finished before.
    pub(super) resumed: usize,
    pub(super) tally: Tally,
    /// What would be read and written, if only that was asked for.
    pub(super) plan: Option<Plan>,
}

impl Default for Outcome {
    fn default() -> Self {
        Self {
            status: Status::Done,
            files: vec![],
            resumed: 0,
            tally: Tally::default(),
            plan: None,
        }
    }
}

impl Outcome {
    /// What would be read and written.
    pub(super) fn planned(plan: Plan) -> Self {
        Self {
            plan: Some(plan),
            ..Self::default()
        }
    }

    /// Prints the plan, if there is one; how the run ended.
    pub(super) fn told(self) -> anyhow::Result<Status> {
        match self.plan {
            Some(plan) => plan.print().map(|()| Status::Done),
            None => Ok(self.status),
        }
    }
}
