//! Why a placed scene has no photosurfaces.

use thiserror::Error;

use crate::spacetime::MAX_RAPIDITY;

/// Why a scene and models make no placed scene, or a placed scene no photosurfaces.
#[derive(Clone, Debug, PartialEq, Error)]
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
    /// A model that is not what the shape of its object makes.
    #[error(
        "the model of object \"{object}\" is not that of its shape, expected the one that `load_models` makes"
    )]
    Shape {
        /// The object in the scene.
        object: String,
    },
    /// A velocity that was composed of others and is faster than any that may be given.
    #[error("the rapidity of {who} is {rapidity}, expected at most {MAX_RAPIDITY}")]
    TooFast {
        /// The observer, or the object in the scene.
        who: String,
        /// Its rapidity.
        rapidity: f64,
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
