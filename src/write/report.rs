//! The report: what was made, in words and numbers, for programs that read no `extras`.

use serde::Serialize;

use crate::pipeline::{Facts, SceneFacts};

/// What was made and how long it took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The scene.
    pub scene: SceneFacts,
    /// Every photosurface written, in the order of steps and scene.
    pub objects: Vec<Facts>,
    /// The stages that ran, in their order; what is not named was not done.
    pub stages: Vec<StageTime>,
}

/// How long a stage took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// Which stage.
    pub name: &'static str,
    /// Wall clock. Where stages overlap, that of the one which the others waited for: together they are what the
    /// whole took.
    pub seconds: f64,
}

impl Report {
    /// The report as JSON text.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a report is names and numbers")
    }
}
