//! All tests of what the crate and its command do from outside, in one program: `cargo test --test it`.
//!
//! A word after it chooses tests by their path, as in `cargo test --test it golden`. `tests/README.md` says what is
//! checked by what.
//!
//! All tests share one process and run side by side. A test that changes or measures the process itself runs in
//! one of its own (`common/alone.rs`).

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot be set up has failed"
)]

mod common;

mod physics {
    mod accuracy;
    mod hard_cases;
    mod known_answers;
    mod lessons;
    mod lorentz;
    mod moments;
    mod moving_objects;
    mod odd_numbers;
    mod penrose_terrell;
    mod properties;
}

mod effects {
    mod colours;
    mod exports;
    mod lamps;
    mod models;
    mod pictures;
}

mod flights {
    mod commands;
    mod diagram;
    mod exact;
    mod known_answers;
    mod predictions;
    mod seen;
}

mod tessellation {
    mod certificates;
    mod covering;
    mod curves;
    mod gap;
    mod properties;
    mod surface;
}

mod import {
    mod access;
    mod as_written;
    mod limits;
    mod models;
    mod storage;
    mod text;
}

mod export {
    mod animation;
    mod camera;
    mod crowd;
    mod hard_properties;
    mod jobs;
    mod large;
    mod materials;
    mod seams;
}

mod render {
    mod films;
    mod gallery;
    mod golden;
    mod lamps;
    mod one_call;
    mod overview;
    mod pictures;
}

mod cli {
    mod accuracy;
    mod check;
    mod commands;
    mod documents;
    mod faults;
    mod films;
    mod flags;
    mod flight;
    mod measures;
    mod models;
    mod normals;
    mod parts;
    mod planned;
    mod render;
    mod sweep;
}

mod page {
    mod content;
    mod files;
    mod serve;
    mod taken_apart;
}

mod cost {
    mod integrators;
    mod meshes;
    mod rays;
}

mod crosscheck;
mod fuzz_corpus;
mod page_in_browser;
mod regression;
mod rooms;
