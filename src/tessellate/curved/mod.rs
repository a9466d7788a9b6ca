//! Round shapes: triangles with vertices on the exact surface, along the bend of its photosurface, with a proven bound.
//!
//! A `sight` is how one observer sees the shape. `metric` says which triangles are wanted where. A `net` of triangles
//! starts with few of them, with `rims` divided already; a `front` adds vertices, `refine` divides what that has left and
//! takes away and moves vertices. `chart` and `bent` describe the curved patch over a triangle; `patch` bounds its
//! derivatives over a part of it, in the part's `frame`, along `steps` of the chart; `proof` bounds the distance of both,
//! `bounds` does that for the triangles of a net. `triangulate` puts it together, and `attempts` says what is tried;
//! `carried` takes bounds to other sights, and `minimum` says how many triangles are needed.

#![allow(
    clippy::needless_range_loop,
    reason = "corners, sides and axes share one index"
)]

mod attempts;
mod bent;
mod bounds;
mod carried;
mod change;
mod chart;
mod estimate;
mod frame;
mod front;
mod metric;
mod minimum;
mod net;
mod patch;
mod proof;
mod quadratic;
mod refine;
mod rims;
mod sight;
mod steps;
mod triangulate;

pub(crate) use attempts::{triangulate, triangulate_within};
pub(crate) use carried::Carried;
pub(crate) use minimum::needed;
pub(crate) use sight::{About, Allowed, Sight};
pub(crate) use triangulate::{Triangulated, triangulate_about};
