//! The pipeline: a scene and its models in, the photosurface of every part at every step out.

mod budget;
mod error;
mod facts;
mod morph;
mod names;
mod photosurface;
mod placed;
mod plan;
mod seen;
mod stage;
mod wanted;

pub use budget::Prediction;
pub use error::StageError;
pub use facts::{Facts, SceneFacts};
pub use names::step_label;
pub use photosurface::Photosurface;
pub(crate) use plan::Unrefined;
pub use seen::VertexData;
pub use stage::Stage;
pub use wanted::Wanted;
