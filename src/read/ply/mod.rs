//! PLY files: text and both orders of bytes.
//!
//! The crates for PLY keep a value for every element, also of kinds that nobody asks for. Here a declared length is compared
//! with the file before memory is taken for it.
//!
//! Source: G. Turk, *The PLY Polygon File Format* (1994).

mod data;
mod header;
mod model;

pub(super) use header::is_ply;
pub(super) use model::read_ply;
