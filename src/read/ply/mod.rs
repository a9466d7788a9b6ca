//! PLY files: text and both orders of bytes.
//!
//! The crates for PLY keep a value of their own for each element, of elements that nobody asks for too, and lose the place
//! of an error in binary files; a declared length is all that this reader has to check before it takes memory.
//!
//! Source: G. Turk, *The PLY Polygon File Format* (1994).

mod data;
mod header;
mod model;

pub(super) use header::is_ply;
pub(super) use model::read_ply;
