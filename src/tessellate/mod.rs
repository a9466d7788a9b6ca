//! Enough triangles, and hardly more: meshes at rest refined so that their photosurfaces are within a
//! tolerance of the true ones.
//!
//! When the corners of a flat triangle are mapped and joined by a flat triangle, that lies beside the true
//! photosurface by `gamma beta e` along the motion, `e = sum lambda_i r_i - |sum lambda_i d_i|` (`gap`). In the
//! sky that an observer at rest with the object sees, all triangles of one size *on the sky*, weighted by
//! their distance, have one gap; so the cheapest mesh is a Delaunay triangulation of near-equilateral
//! triangles on the sky (`sky`). Edges are divided by a rule that knows nothing but their two ends (`edge`), so
//! that neighbours always agree, bit for bit.

mod allowance;
mod along;
mod ceiling;
mod certificate;
mod chart;
mod edge;
mod edges;
mod gap;
mod minimum;
mod nearest;
mod outline;
mod pieces;
mod queue;
mod refine;
mod room;
mod sky;
mod strip;
mod survey;

pub(crate) use allowance::Allowance;
pub(crate) use certificate::{Bounds, Counts, Singles, local_stretch, rounding_bound};
pub use certificate::{Certificate, Precision};
pub use gap::{edge_gap, triangle_gap, triangle_gap_place};
use minimum::minimum_triangles;
pub(crate) use minimum::predicted_pieces;
pub(crate) use nearest::nearest_point;
pub(crate) use refine::{Refined, refine};
pub(crate) use room::shares;
pub(crate) use survey::{largest_gap, survey};
