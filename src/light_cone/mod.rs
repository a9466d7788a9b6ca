//! The backward light cone: where, when and with which Doppler factor a moving observer sees a point.
//!
//! `map` is the photosurface map for one observer and one rest frame, and `safe_range` its version without branches.
//! `view` applies the map in a scene in which both the observer and the object move, `model_view` under a model. `batch` maps all points of a mesh
//! at once, a `block` at a time.

mod batch;
mod block;
mod extremes;
mod map;
mod model_view;
mod safe_range;
mod view;

pub(crate) use batch::Batch;
pub(crate) use extremes::Extremes;
pub use map::PhotosurfaceMap;
pub use model_view::{MAX_DELAYED_RAPIDITY, ModelView};
pub use view::View;
pub(crate) use view::facet_ball;
