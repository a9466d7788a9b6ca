//! Errors of placed scenes and their photosurfaces.

use thiserror::Error;

use crate::light_cone::MAX_DELAYED_RAPIDITY;
use crate::scene::InvalidScene;
use crate::spacetime::MAX_RAPIDITY;

/// Reasons why a scene and its models make no placed scene, or why a placed scene has no photosurfaces.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlacedSceneError {
    /// The number of models is not the number of objects.
    #[error("there are {models} models for {objects} objects, expected one for each")]
    Models {
        /// Number of objects of the scene.
        objects: usize,
        /// Number of models.
        models: usize,
    },
    /// A scene with each object under several models is not valid.
    #[error(transparent)]
    Scene(#[from] InvalidScene),
    /// A mesh has a vertex whose position is not finite in the object's rest frame.
    #[error("part \"{part}\" of object \"{object}\" has a vertex that is not finite")]
    NotFinite {
        /// The object in the scene.
        object: String,
        /// The part of its model.
        part: String,
    },
    /// A model is not the one that its object's shape makes.
    #[error(
        "the model of object \"{object}\" is not that of its shape, expected the one that `load_models` makes"
    )]
    Shape {
        /// The object in the scene.
        object: String,
    },
    /// A velocity that is composed of others has a rapidity above [`MAX_RAPIDITY`].
    #[error("the rapidity of {who} is {rapidity}, expected at most {MAX_RAPIDITY}")]
    TooFast {
        /// The observer, or the name of the object.
        who: String,
        /// The rapidity of its velocity.
        rapidity: f64,
    },
    /// An object is too fast for the model without contraction.
    #[error(
        "object \"{object}\" has the rapidity {rapidity:.6} relative to the observer, expected at most \
         {MAX_DELAYED_RAPIDITY} for the model \"delayed\""
    )]
    Delayed {
        /// The object in the scene.
        object: String,
        /// The relative rapidity at the step at which it is found too large.
        rapidity: f64,
    },
    /// What stands for an object without contraction is too large.
    #[error(
        "object \"{object}\" without contraction reaches {reach:.1e} from the observer, expected at most 1e150; \
         expected a lower speed or another model"
    )]
    Reach {
        /// The object in the scene.
        object: String,
        /// The largest distance of its stand-in from the observer, in scene units.
        reach: f64,
    },
    /// The scene has no such step.
    #[error("step {step} of a scene with {steps} steps, expected less than {steps}")]
    Step {
        /// The step, counted from 0.
        step: usize,
        /// Number of steps of the scene.
        steps: usize,
    },
}
