//! Flights: what an accelerated observer is at any of its proper times.

mod constant;
mod coordinated;
mod error;
mod flight;
mod integrator;
mod pieces;
mod segment;
mod smooth;
mod stepped;

pub use error::{FlightError, SegmentError};
pub use flight::Flight;
pub use integrator::{Integrator, IntegratorError, Step};
pub use segment::{Segment, Steering};
