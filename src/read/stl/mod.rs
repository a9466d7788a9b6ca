//! STL files: text and binary.
//!
//! The crate `stl_io` holds the coordinates of text in 32 bits, takes a binary file that begins with "solid " for text, reads
//! one solid of several and names no line.
//!
//! Source: M. Burns, *Automated Fabrication* (1993), section 6.5, on the StL format of 3D Systems.

mod binary;
mod model;
mod solid;
mod text;

pub(super) use model::{is_stl, read_stl};
