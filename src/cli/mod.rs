//! The command line: one file per command, and what they share.

mod accuracy;
mod args;
mod camera;
mod check;
mod command;
mod cost;
mod cost_output;
mod cost_tables;
mod drawing;
mod effects;
mod example;
mod export;
mod file_camera;
mod film;
mod flight;
mod flight_tables;
mod guides;
mod hints;
mod input;
mod messages;
mod models;
mod output;
mod page;
mod provenance;
mod quoting;
mod render;
mod schema;
mod serve;
mod speeds;
mod status;
mod tables;
mod values;
mod wording;

pub(crate) use command::run;
