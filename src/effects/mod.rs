//! What light does to colours: pure functions of numbers, for meshes and pictures alike.
//!
//! Nothing here knows of places, meshes or light cones: each side comes to its numbers in its own way, and stays a
//! witness of the other.

mod color;

pub(crate) use color::{byte_of_linear, linear_of_byte, linear_of_srgb};
