//! How long the stages of a job take.

use std::time::Instant;

use crate::write::StageTime;

/// Wall-clock time of each stage; times of one name add up. What goes on in the background meanwhile does not count.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    last: Instant,
    stages: Vec<StageTime>,
}

impl Clock {
    /// A clock that begins now, after these stages.
    pub(super) fn after(stages: &[StageTime]) -> Self {
        Self {
            last: Instant::now(),
            stages: stages.to_vec(),
        }
    }

    /// The stage `name` went on since the last call, or since the beginning.
    pub(super) fn stop(&mut self, name: &'static str) {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        self.last = now;
        match self.stages.iter_mut().find(|stage| stage.name == name) {
            Some(stage) => stage.seconds += seconds,
            None => self.stages.push(StageTime { name, seconds }),
        }
    }

    /// The same clock after a pause that does not count.
    pub(super) fn resumed(&self) -> Self {
        Self::after(&self.stages)
    }

    pub(super) fn stages(&self) -> &[StageTime] {
        &self.stages
    }
}
