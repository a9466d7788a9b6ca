//! Where, when and in which colour a moving observer sees a point: the backward light cone.
//!
//! `map` is the mathematics of one observer and one rest frame, `safe_range` the part of it that has no branches; `view`
//! places it in a scene where both move, `batch` sees all points of a mesh at once, a `block` at a time.

mod batch;
mod block;
mod extremes;
mod map;
mod safe_range;
mod view;

pub(crate) use batch::Batch;
pub(crate) use extremes::Extremes;
pub use map::PhotosurfaceMap;
pub use view::View;
