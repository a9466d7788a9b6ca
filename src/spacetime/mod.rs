//! Special relativity without objects or light: velocities, events, frames, worldlines, moments, flights, models.
//!
//! Conventions: c = 1; the Minkowski interval is `-t^2 + x^2 + y^2 + z^2`; transformations are
//! passive, they turn the coordinates of one frame into those of another.

mod event;
pub(crate) mod exact;
mod flight;
mod light;
mod lorentz;
mod moment;
mod rotation;
mod vector;
mod velocity;
mod view_model;
mod world_line;

pub use event::Event;
pub use flight::{
    Flight, FlightError, Integrator, IntegratorError, Segment, SegmentError, Steering, Step,
};
pub(crate) use light::MovedLight;
pub use lorentz::Lorentz;
pub use moment::Moment;
pub use rotation::{LookingError, Rotation, RotationError};
pub(crate) use vector::{harmless_scale, heading, length, unit};
pub(crate) use velocity::VelocityKey;
pub use velocity::{MAX_RAPIDITY, Velocity, VelocityError};
pub use view_model::{UnknownModel, ViewModel};
pub use world_line::WorldLine;
