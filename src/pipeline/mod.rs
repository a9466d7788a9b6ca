//! The pipeline: a scene and its models in, the photosurface of every part at every step out.

mod budget;
mod error;
mod facts;
mod morph;
mod names;
mod plan;
mod seen;
mod stage;

pub use budget::Prediction;
pub use error::StageError;
pub use facts::{Facts, SceneFacts};
pub use names::step_label;
pub(crate) use plan::Unrefined;
pub use seen::VertexData;
pub use stage::{Photosurface, Stage, Wanted};
