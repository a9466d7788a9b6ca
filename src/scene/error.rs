//! Why well-formed values do not make a scene.

use thiserror::Error;

use crate::spacetime::{FlightError, SegmentError};

/// Maximum number of evenly spaced steps of one scene: a guard against slips of the pen.
pub(super) const MAX_STEPS: usize = 100_000;

/// Why well-formed values do not make a scene.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum InvalidScene {
    /// Nothing to see.
    #[error("the scene has no objects, expected at least one")]
    NoObjects,
    /// An object without a name.
    #[error("objects[{0}] has an empty name, expected a name for the output")]
    EmptyName(usize),
    /// Two objects of one name.
    #[error("two objects are named \"{0}\", expected a name of its own for each")]
    RepeatedName(String),
    /// No source or two.
    #[error("object \"{name}\" has {found} \"file\" and \"shape\", expected one of them")]
    Source {
        /// Which object.
        name: String,
        /// What it has.
        found: &'static str,
    },
    /// Looks given for something that brings its own.
    #[error(
        "object \"{name}\" comes from a file, which has its own colours; \"{field}\" is for shapes"
    )]
    LooksOfFile {
        /// Which object.
        name: String,
        /// The key that does not belong.
        field: &'static str,
    },
    /// Normals asked for of something that brings its own.
    #[error("object \"{0}\" is a shape, which has its own normals; \"normals\" is for files")]
    NormalsOfShape(String),
    /// A lamp that rides on nothing.
    #[error("lamps[{0}] rides on \"{1}\", expected the name of an object")]
    LampObject(usize, String),
    /// No steps at all.
    #[error("the list of steps is empty, expected at least one proper time")]
    NoSteps,
    /// Too many or too few evenly spaced steps.
    #[error("count is {0}, expected 1 to {MAX_STEPS} steps")]
    StepCount(usize),
    /// A step that is not a number.
    #[error("step {0} is {1}, expected a finite proper time")]
    Step(usize, f64),
    /// An acceleration in g in a scene that does not say what its units are.
    #[error(
        "flight[{0}] has \"acceleration_g\", which needs \"units\" like {{ \"length_m\": 299792458 }}; without them \
         expected \"acceleration\""
    )]
    NoUnits(usize),
    /// An acceleration that is beyond `f64` in units of the scene.
    #[error("flight[{0}]: {1}")]
    Segment(usize, SegmentError),
    /// A flight that is not possible.
    #[error(transparent)]
    Flight(#[from] FlightError),
}
