//! Why a placed scene has no photosurfaces.

use thiserror::Error;

/// Why a scene and models make no placed scene, or a placed scene no photosurfaces.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PlacedSceneError {
    /// Not one model for each object.
    #[error("there are {models} models for {objects} objects, expected one for each")]
    Models {
        /// How many objects the scene has.
        objects: usize,
        /// How many models there are.
        models: usize,
    },
    /// A mesh that was moved to where there are no numbers.
    #[error("part \"{part}\" of object \"{object}\" has a vertex that is not finite")]
    NotFinite {
        /// The object in the scene.
        object: String,
        /// The part of its model.
        part: String,
    },
    /// A step that the scene does not have.
    #[error("step {step} of a scene with {steps} steps, expected less than {steps}")]
    Step {
        /// The step, counted from 0.
        step: usize,
        /// How many there are.
        steps: usize,
    },
}
