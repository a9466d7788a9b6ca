//! The pipeline: it makes the photosurface of every part at every step from a scene and its models.

mod blurred;
mod bounds;
mod budget;
mod certifying;
mod error;
mod facts;
mod forecast;
mod inside;
mod limits;
mod making;
mod mapped_mesh;
mod moment_facts;
mod morph;
mod names;
mod photosurface;
mod placed_object;
mod placed_scene;
mod plan;
mod predicting;
mod side_by_side;
mod surface_options;
mod together;
mod vertex_data;

pub use blurred::Blurred;
pub use bounds::Bounds;
pub use budget::Prediction;
pub use error::PlacedSceneError;
pub use facts::{Facts, SceneFacts, SegmentFacts};
pub use inside::Around;
pub use moment_facts::MomentFacts;
pub use names::step_label;
pub use photosurface::Photosurface;
pub use placed_scene::PlacedScene;
pub(crate) use plan::Unrefined;
pub use surface_options::SurfaceOptions;
pub use vertex_data::{VertexData, VertexValues};
