//! `photosurface sweep`: many runs of one command in one process, from a list of overrides.

mod file;
mod rows;
mod run;
mod unique;

pub(super) use file::json_schema;
pub(super) use run::{SweepArgs, run};
