//! Scenes as users ask for them: the observer, the objects, the steps; read from JSON and checked.
//!
//! A scene is text and numbers only. Files that it names are read by the room `jobs`.

mod attributes;
mod built_in;
mod effects;
mod emission;
mod error;
mod flight;
mod flight_plan;
mod forms;
mod json;
mod lamp;
mod lamp_form;
mod marker;
mod measure;
mod nearest;
mod object;
mod observer;
mod orientation;
mod place;
mod scale;
mod scene;
mod steps;
mod tolerance;
mod units;

pub use attributes::{Attribute, Attributes, UnknownAttribute};
pub use built_in::{BUILT_IN_SCENES, BuiltInScene};
pub use effects::{Effects, EffectsError, Exposure, Stops};
pub use emission::{Emission, EmissionError};
pub use error::InvalidScene;
pub use flight_plan::FlightPlan;
pub use json::SceneError;
pub use lamp::{Carrier, Flash, Lamp, LampError, LampSource, PointLamp};
pub use marker::{MarkerRadius, MarkerRadiusError};
pub use measure::{Measure, UnknownMeasure};
pub use object::{Object, Source};
pub use observer::Observer;
pub use place::{Place, PlaceError, Time, TimeError};
pub use scale::Scale;
pub use scene::Scene;
pub use steps::even_steps;
pub use tolerance::{Tolerance, ToleranceError, Unit};
pub use units::{Units, UnitsError};

pub use crate::spacetime::{Rotation, RotationError};
