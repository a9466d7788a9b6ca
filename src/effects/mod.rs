//! What light does to colours: pure functions of numbers, for meshes and pictures alike.
//!
//! Nothing here knows of meshes or light cones: each side comes to its numbers in its own way, and stays a
//! witness of the other.

mod cie_1931;
mod color;
mod color_table;
mod doppler;
mod gamut;
mod lamps;
mod planckian;
mod ramp;
mod seen_light;
mod shader_table;
mod spectrum;
mod temperature;

pub(crate) use color::{byte_of_linear, linear_of_byte, linear_of_srgb};
pub use doppler::{Beyond, Doppler, Spectrum};
pub use gamut::{luminance, tone, within_gamut, within_screen};
pub use lamps::{
    Arrival, PointLight, arrival, far_irradiance, from_point, held, point_irradiance,
    sky_irradiance,
};
pub use ramp::{RAMP_OCTAVES, ramp_color};
pub use seen_light::{Lamplight, SeenLight};
pub use shader_table::ShaderTable;
pub use spectrum::{Daylight, Reflectance, black_body_color};
pub use temperature::{Temperature, TemperatureError};
