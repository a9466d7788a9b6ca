//! Lamps that light a scene.

use glam::DVec3;
use thiserror::Error;

use super::Place;
use crate::effects::Temperature;
use crate::shape::Color;
use crate::spacetime::{Velocity, unit};

/// A lamp: a point, a sun infinitely far away, or light from all around.
///
/// Its light travels with the speed of light from where the lamp was; a surface in motion has it from an aberrated direction
/// and, where a scene asks for the Doppler or the searchlight effect, shifted.
///
/// # Units
///
/// A white matte surface at rest with the lamp, facing it, has the luminance 1 at distance 1 from a point of intensity 1, and
/// in the light of a sun or of surroundings of irradiance 1: pi is divided out.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    source: LampSource,
    temperature: Temperature,
    color: Option<Color>,
}

/// Where the light of a lamp comes from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LampSource {
    /// A point.
    Point(PointLamp),
    /// A sun at rest in the scene frame, infinitely far away.
    Sun {
        /// The unit direction in which its light travels, in the scene frame.
        direction: DVec3,
        /// Irradiance of a surface that faces it, at rest in the scene frame.
        irradiance: f64,
    },
    /// Surroundings at rest in the scene frame, the same in all directions there.
    Ambient {
        /// Irradiance of a surface at rest in the scene frame.
        irradiance: f64,
    },
}

/// A lamp that is a point, as bright in all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLamp {
    position: Place,
    intensity: f64,
    carrier: Carrier,
    flash: Option<Flash>,
}

/// How a lamp moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Carrier {
    /// By itself: where its position says at scene time 0.
    Own(Velocity),
    /// With the object of this name: where its position says in the object's rest frame.
    Object(String),
}

/// The times between which a lamp shines, in its own proper time: that is 0 at scene time 0, or as that of the object on
/// which it rides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flash {
    from: f64,
    to: f64,
}

/// Why numbers do not make a lamp.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LampError {
    /// No source or several.
    #[error("a lamp has {0}, expected exactly one of \"point\", \"sun\" and \"ambient\"")]
    Sources(&'static str),
    /// A strength that is negative or not finite.
    #[error("the {0} is {1:?}, expected a finite number >= 0")]
    Strength(&'static str, f64),
    /// A direction without direction.
    #[error("the direction is {0}, expected a finite vector that is not zero")]
    Direction(DVec3),
    /// A flash that does not begin before it ends.
    #[error(
        "the flash is from {0:?} to {1:?}, expected finite proper times, the first one before the second"
    )]
    Flash(f64, f64),
    /// Two colours.
    #[error("a lamp has both \"kelvin\" and \"color\", expected at most one of them")]
    TwoColors,
    /// Two motions.
    #[error("a lamp has both \"velocity\" and \"object\", expected at most one of them")]
    TwoMotions,
    /// Something that only a point has.
    #[error("\"{0}\" is for lamps that are a \"point\"")]
    OnlyOfPoints(&'static str),
}

impl Lamp {
    fn of(source: LampSource) -> Self {
        Self {
            source,
            temperature: Temperature::DAYLIGHT,
            color: None,
        }
    }

    /// A point of daylight at `position` in the scene, at rest.
    ///
    /// # Errors
    ///
    /// An intensity that is negative or not finite.
    pub fn point(position: Place, intensity: f64) -> Result<Self, LampError> {
        let point = PointLamp {
            position,
            intensity: strength("intensity", intensity)?,
            carrier: Carrier::Own(Velocity::ZERO),
            flash: None,
        };
        Ok(Self::of(LampSource::Point(point)))
    }

    /// Daylight that travels in one direction, of any length, everywhere.
    ///
    /// # Errors
    ///
    /// No direction, or an irradiance that is negative or not finite.
    pub fn sun(direction: DVec3, irradiance: f64) -> Result<Self, LampError> {
        Ok(Self::of(LampSource::Sun {
            direction: unit(direction).ok_or(LampError::Direction(direction))?,
            irradiance: strength("irradiance", irradiance)?,
        }))
    }

    /// Daylight from all around.
    ///
    /// # Errors
    ///
    /// An irradiance that is negative or not finite.
    pub fn ambient(irradiance: f64) -> Result<Self, LampError> {
        let irradiance = strength("irradiance", irradiance)?;
        Ok(Self::of(LampSource::Ambient { irradiance }))
    }

    /// The same with the light of a black body of this temperature.
    #[must_use]
    pub fn with_temperature(mut self, temperature: Temperature) -> Self {
        (self.temperature, self.color) = (temperature, None);
        self
    }

    /// The same with daylight behind a filter of this colour.
    #[must_use]
    pub fn with_color(mut self, color: Color) -> Self {
        (self.temperature, self.color) = (Temperature::DAYLIGHT, Some(color));
        self
    }

    /// The same in motion.
    ///
    /// # Errors
    ///
    /// A lamp that is no point.
    pub fn carried(mut self, carrier: Carrier) -> Result<Self, LampError> {
        match &mut self.source {
            LampSource::Point(point) => point.carrier = carrier,
            _ if matches!(carrier, Carrier::Own(_)) => {
                return Err(LampError::OnlyOfPoints("velocity"));
            }
            _ => return Err(LampError::OnlyOfPoints("object")),
        }
        Ok(self)
    }

    /// The same, shining for a while only.
    ///
    /// # Errors
    ///
    /// A lamp that is no point.
    pub fn flashing(mut self, flash: Flash) -> Result<Self, LampError> {
        match &mut self.source {
            LampSource::Point(point) => point.flash = Some(flash),
            _ => return Err(LampError::OnlyOfPoints("flash")),
        }
        Ok(self)
    }

    /// Where its light comes from.
    pub fn source(&self) -> &LampSource {
        &self.source
    }

    /// The temperature of its light at rest.
    pub fn temperature(&self) -> Temperature {
        self.temperature
    }

    /// The colour of the filter before it, if it has one.
    pub fn color(&self) -> Option<Color> {
        self.color
    }
}

impl PointLamp {
    /// In the scene frame at scene time 0, or in the rest frame of the object on which it rides.
    pub fn position(&self) -> Place {
        self.position
    }

    /// Luminance, at distance 1, of a white matte surface that faces the lamp and is at rest with it.
    pub fn intensity(&self) -> f64 {
        self.intensity
    }

    /// How it moves.
    pub fn carrier(&self) -> &Carrier {
        &self.carrier
    }

    /// When it shines, if not always.
    pub fn flash(&self) -> Option<Flash> {
        self.flash
    }
}

impl Flash {
    /// A flash between two proper times of the lamp.
    ///
    /// # Errors
    ///
    /// Times that are not finite, or not one before the other.
    pub fn new(from: f64, to: f64) -> Result<Self, LampError> {
        match from.is_finite() && to.is_finite() && from < to {
            true => Ok(Self { from, to }),
            false => Err(LampError::Flash(from, to)),
        }
    }

    /// Whether the lamp shines at its proper time `time`.
    pub fn is_on(&self, time: f64) -> bool {
        (self.from..self.to).contains(&time)
    }
}

fn strength(name: &'static str, value: f64) -> Result<f64, LampError> {
    match value >= 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(LampError::Strength(name, value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_points_move_and_flash() {
        let sun = Lamp::sun(DVec3::X, 1.0).unwrap();
        let flash = Flash::new(0.0, 1.0).unwrap();
        assert_eq!(
            sun.clone().flashing(flash),
            Err(LampError::OnlyOfPoints("flash"))
        );
        let own = Carrier::Own(Velocity::ZERO);
        assert_eq!(sun.carried(own), Err(LampError::OnlyOfPoints("velocity")));
        assert!(Flash::new(0.0, f64::INFINITY).is_err() && Flash::new(1.0, 0.0).is_err());
        assert!(Lamp::ambient(f64::NAN).is_err());
    }
}
