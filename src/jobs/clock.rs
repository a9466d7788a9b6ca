//! Times that the stages of a job take.

use std::time::Instant;

use crate::write::StageTime;

/// Wall-clock time of each stage, in seconds; times of stages with the same name add up. Work in the background does
/// not count.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    last: Instant,
    stages: Vec<StageTime>,
}

impl Clock {
    /// A clock that starts now; `stages` have already finished.
    pub(super) fn after(stages: &[StageTime]) -> Self {
        Self {
            last: Instant::now(),
            stages: stages.to_vec(),
        }
    }

    /// Adds the time since the last call, or since the start, to the stage `name`.
    pub(super) fn stop(&mut self, name: &'static str) {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        self.last = now;
        match self.stages.iter_mut().find(|stage| stage.name == name) {
            Some(stage) => stage.seconds += seconds,
            None => self.stages.push(StageTime { name, seconds }),
        }
    }

    /// The same clock, restarted after a pause that does not count.
    pub(super) fn resumed(&self) -> Self {
        Self::after(&self.stages)
    }

    pub(super) fn stages(&self) -> &[StageTime] {
        &self.stages
    }
}
