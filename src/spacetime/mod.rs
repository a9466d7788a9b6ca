//! Special relativity without objects or light: velocities, events, frames, worldlines.
//!
//! Conventions: c = 1; the Minkowski interval is `-t^2 + x^2 + y^2 + z^2`; transformations are
//! passive, they turn the coordinates of one frame into those of another.

mod event;
mod lorentz;
mod velocity;
mod world_line;

pub use event::Event;
pub use lorentz::Lorentz;
pub use velocity::{MAX_RAPIDITY, Velocity, VelocityError};
pub use world_line::WorldLine;

use glam::DVec3;

/// The direction of `vector`, also where its square would overflow or underflow.
///
/// `None` for the zero vector and for a vector that is not finite.
pub(crate) fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if !(largest > 0.0 && vector.is_finite()) {
        return None;
    }
    // Two steps, because 1 / largest overflows for subnormal vectors.
    let scaled = if largest < f64::MIN_POSITIVE * 4.0 {
        vector * 2f64.powi(600)
    } else {
        vector
    };
    let scaled = scaled / scaled.abs().max_element();
    Some(scaled / scaled.length())
}
