//! Refinement of meshes at rest, so that their photosurfaces are within a tolerance of the true ones, with hardly more
//! triangles than theory requires.
//!
//! The program maps the corners of a flat triangle and joins them by a flat output triangle. In the observer's frame
//! the output triangle lies beside the true photosurface by `gamma beta e` along the motion, with the rest-frame gap
//! `e = sum lambda_i r_i - |sum lambda_i d_i|` (`gap`). Consider the sky of an observer at the same point who is at
//! rest with the object. All triangles that have one size on this sky, with lengths weighted by the square root of
//! their distance, have the same gap. The cheapest mesh is therefore a Delaunay triangulation on the sky with nearly
//! equilateral triangles (`sky`). The rule that divides an edge depends on its two ends only (`edge`), so that
//! neighbouring triangles always agree, bit for bit.

mod across;
mod adjacency;
mod allowance;
mod along;
mod ceiling;
mod certificate;
mod chart;
mod count;
mod curved;
mod edge;
mod edges;
mod gap;
mod minimum;
mod motion;
mod nearest;
mod outcomes;
mod outline;
mod pieces;
mod predicted;
mod queue;
mod refine;
mod rims;
mod room;
mod sky;
mod stretch;
mod strip;
mod survey;

pub(crate) use allowance::Allowance;
pub(crate) use certificate::{Bounds, Counts, Singles, rounding_bound};
pub use certificate::{Certificate, Precision};
pub(crate) use curved::{
    About, Allowed, Carried, Sight, Triangulated, needed, triangulate, triangulate_about,
    triangulate_within,
};
pub use gap::{edge_gap, triangle_gap, triangle_gap_place};
use minimum::minimum_triangles;
pub(crate) use motion::Motion;
pub(crate) use nearest::nearest_point;
pub(crate) use predicted::predicted_pieces;
pub(crate) use refine::{Refined, refine};
pub(crate) use room::shares;
pub(crate) use survey::{largest_gap, survey};

pub(crate) use stretch::{largest_stretch, local_stretch};
