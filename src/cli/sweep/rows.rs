//! The table of a sweep: a row for each run.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::messages::{grouped, shown, size};
use crate::cli::tables::{csv, table};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Ended {
    /// Everything in its files is certified.
    Certified,
    /// Its files are written, and something in them is not certified.
    NotCertified,
    /// It wrote nothing, or not all.
    Failed,
}

/// What became of a run.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Row {
    /// The number of the run in the list, counted from 0.
    pub(super) run: usize,
    /// Its name.
    pub(super) name: String,
    /// How it ended.
    pub(super) ended: Ended,
    /// Wall-clock time, in seconds; absent with --no-times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) seconds: Option<f64>,
    /// Number of photosurfaces made.
    pub(super) photosurfaces: usize,
    /// Number of their triangles.
    pub(super) triangles: usize,
    /// Number of photosurfaces that are not certified.
    pub(super) uncertified: usize,
    /// Length of all files together.
    pub(super) bytes: u64,
    /// The files.
    pub(super) files: Vec<String>,
    /// Number of files that were finished before.
    pub(super) resumed: usize,
    /// What the user should know of the run.
    pub(super) notes: Vec<String>,
    /// Why the run failed, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) error: Option<String>,
}

/// Everything that is known of a sweep.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Table<'a> {
    /// The version of the program.
    pub(super) version: &'static str,
    /// The rows, in the order of the runs.
    pub(super) runs: &'a [Row],
}

impl Table<'_> {
    pub(super) fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("names and numbers")
    }

    pub(super) fn to_csv(&self) -> String {
        let columns = [
            ("run", "/run"),
            ("name", "/name"),
            ("ended", "/ended"),
            ("seconds", "/seconds"),
            ("photosurfaces", "/photosurfaces"),
            ("triangles", "/triangles"),
            ("uncertified", "/uncertified"),
            ("bytes", "/bytes"),
            ("file", "/files/0"),
            ("resumed", "/resumed"),
            ("error", "/error"),
        ];
        csv(columns, self.runs)
    }

    /// Prints the table for people.
    pub(super) fn print(&self, out: &mut dyn Write) -> anyhow::Result<()> {
        let headings = ["run", "triangles", "size", "seconds", "certified", "file"];
        let rows = self.runs.iter().map(|row| {
            let seconds = row.seconds.map(|seconds| format!("{seconds:.3}"));
            let certified = match row.ended {
                Ended::Certified => "yes".to_owned(),
                Ended::NotCertified => "no".to_owned(),
                Ended::Failed => "failed".to_owned(),
            };
            [
                shown(&row.name),
                grouped(row.triangles),
                size(row.bytes),
                seconds.unwrap_or_default(),
                certified,
                row.files
                    .first()
                    .map(|file| shown(file))
                    .unwrap_or_default(),
            ]
        });
        table(headings, rows, out)
    }
}
