//! Effects on the light of surfaces in pictures.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::lighting::{LitBy, Shifts};
use super::shading::Reflected;
use crate::effects::{SeenLight, tone, within_gamut};
use crate::scene::{Effects, Emission, Exposure, Stops};

/// The effects that pictures show, and their exposure. Copies share what is worked out once.
#[derive(Clone)]
pub struct PictureEffects {
    light: Arc<SeenLight>,
    searchlight: bool,
    exposure: Stops,
}

impl PictureEffects {
    /// The effects of a scene. An exposure that is to be found is 0 stops until it is: see
    /// [`PictureEffects::with_exposure`].
    pub fn new(effects: Effects) -> Self {
        let exposure = match effects.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => Stops::default(),
        };
        Self {
            light: Arc::new(SeenLight::new(effects.doppler, effects.searchlight)),
            searchlight: effects.searchlight,
            exposure,
        }
    }

    /// The same effects in pictures of another exposure.
    #[must_use]
    pub fn with_exposure(self, exposure: Stops) -> Self {
        Self { exposure, ..self }
    }

    /// What becomes of light on its way.
    pub(super) fn shifts(&self) -> Shifts {
        Shifts {
            any: self.light.is_shifted(),
            brightness: self.searchlight,
        }
    }

    /// Light that a surface of a linear colour emits, before the exposure; `doppler` is `None` of what has no motion.
    pub(super) fn of_surface(&self, color: Vec3, doppler: Option<f64>) -> DVec3 {
        let color = color.as_dvec3();
        match doppler {
            Some(factor) => self.light.seen(color, self.light.daylight(), factor),
            None => color,
        }
    }

    /// The light of the lamp at the eye, which is at rest with the surface, before the exposure.
    pub(super) fn of_head_light(
        &self,
        color: Vec3,
        reflected: Reflected,
        doppler: Option<f64>,
    ) -> DVec3 {
        self.of_surface(color, doppler) * reflected.tinted
            + self.of_surface(Vec3::ONE, doppler) * reflected.white
    }

    /// The light of another lamp, before the exposure.
    pub(super) fn of_lamp(&self, color: Vec3, lit: &LitBy, doppler: f64) -> DVec3 {
        let seen = |color: DVec3| self.light.seen(color * lit.color, lit.lamp, doppler);
        let mut light = DVec3::ZERO;
        if lit.reflected.tinted > 0.0 {
            light += seen(color.as_dvec3()) * lit.reflected.tinted;
        }
        if lit.reflected.white > 0.0 {
            light += seen(DVec3::ONE) * lit.reflected.white;
        }
        light
    }

    /// The light of a black body, before the exposure.
    pub(super) fn of_black_body(&self, emission: Emission, doppler: Option<f64>) -> DVec3 {
        let (temperature, luminance) = (emission.temperature(), emission.luminance());
        self.light
            .glow(temperature, luminance, doppler.unwrap_or(1.0))
    }

    /// The light of all surfaces along a ray as a screen shows it: linear, channels from 0 to 1.
    pub(super) fn shown(&self, light: DVec3) -> Vec3 {
        tone(within_gamut(light * self.exposure.factor())).as_vec3()
    }
}
