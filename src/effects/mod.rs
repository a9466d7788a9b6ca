//! What light does to colours: pure functions of numbers, for meshes and pictures alike.
//!
//! Nothing here knows of places, meshes or light cones: each side comes to its numbers in its own way, and stays a
//! witness of the other.

mod cie_1931;
mod color;
mod gamut;
mod lamps;
mod ramp;
mod spectrum;

pub(crate) use color::{byte_of_linear, linear_of_byte, linear_of_srgb};
pub use gamut::{luminance, tone, within_gamut};
pub use lamps::{
    Arrival, PointLight, arrival, far_irradiance, from_point, held, point_irradiance,
    sky_irradiance,
};
pub use ramp::{RAMP_OCTAVES, ramp_color};
pub use spectrum::{Daylight, Reflectance, TemperatureError, black_body_color};
