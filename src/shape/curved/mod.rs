//! Round shapes as exact surfaces: pieces with two parameters each, and the coarsest triangles between their vertices.
//!
//! A `body` is a closed surface of a few smooth `piece`s that meet at circular rims. A spot is a place on it. `texture`
//! says where a spot lies on a picture.

#![allow(
    clippy::needless_range_loop,
    reason = "corners, sides and axes share one index"
)]

mod body;
mod piece;
mod texture;

pub(crate) use body::{Body, LEAST_PARTS, MAX_SPAN, Spot};
pub(crate) use piece::{Jet, Piece, axes_of_turn};
