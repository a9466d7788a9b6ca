//! What may become of colours under the Doppler effect.

use super::Temperature;

/// What the Doppler effect does to the colours of surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Doppler {
    /// Nothing: every surface has its colour at rest.
    #[default]
    None,
    /// Spectra are shifted: the colours that an eye would see.
    Spectrum(Spectrum),
    /// The Doppler factor as a colour of its own, in place of colours and textures: see [`ramp_color`](super::ramp_color).
    Ramp,
}

/// What is known of spectra beyond colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// The temperature of the daylight in which surfaces have their own colours.
    pub daylight: Temperature,
    /// The reflectance at wavelengths above 730 nanometres.
    pub infrared: Beyond,
    /// The reflectance at wavelengths below 380 nanometres.
    pub ultraviolet: Beyond,
}

/// The reflectance at wavelengths of which colours say nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Beyond {
    /// That of the last wavelength of which they do.
    #[default]
    Edge,
    /// None.
    Dark,
}
