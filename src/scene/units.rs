//! What a scene's unit of length is in everyday units.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::forms::Keyed;
use crate::shape::Length;

/// The speed of light in metres per second, and standard gravity in metres per second squared, both exact: *The
/// International System of Units*, 9th edition (2019), and the 3rd General Conference on Weights and Measures (1901).
const SPEED_OF_LIGHT: f64 = 299_792_458.0;
const STANDARD_GRAVITY: f64 = 9.806_65;

/// The scene's units in everyday units. The unit of time is the time in which light travels the unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// The unit of length in metres; 299792458 makes the unit of time one second.
    pub length_m: Length,
}

impl Units {
    /// Standard gravity, 9.80665 m/s^2, in units of the scene: `c^2` per unit of length.
    pub fn gravity(&self) -> f64 {
        STANDARD_GRAVITY / SPEED_OF_LIGHT / SPEED_OF_LIGHT * self.length_m.get()
    }

    /// The unit of time in seconds.
    pub fn time_s(&self) -> f64 {
        self.length_m.get() / SPEED_OF_LIGHT
    }
}

impl Keyed for Units {
    const EXPECTED: &'static str = "units like { \"length_m\": 299792458 }";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In light years of Julian years a falling stone has 1.03.
    #[test]
    fn gravity_is_about_one_per_light_year() {
        let length_m = Length::new(299_792_458.0 * 365.25 * 86_400.0).unwrap();
        let units = Units { length_m };
        assert!((units.gravity() - 1.032_295_275_553_596_5).abs() < 4e-16);
        assert!((units.time_s() - 31_557_600.0).abs() < 1e-8);
    }
}
