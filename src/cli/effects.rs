//! Flags for effects beside shapes, which override those of the scene.

use photosurface::Scene;
use photosurface::effects::{Doppler, Spectrum};
use photosurface::scene::{Effects, Exposure};

use super::messages::Verbosity;

/// Effects, and the exposure.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Effects (override the scene)")]
pub(super) struct EffectArgs {
    /// Show the Doppler effect: "spectrum", the colours of the shifted light, at the brightness that surfaces have at rest;
    /// "ramp", the Doppler factor as a colour, blue above 1 and red below; "none" [default: none]
    #[arg(long, value_enum)]
    doppler: Option<DopplerName>,
    /// Show the searchlight effect: how much brighter or darker the shifted light is to the eye; with --doppler spectrum, the
    /// whole shifted spectrum
    #[arg(long)]
    searchlight: bool,
    /// Show no searchlight effect, also where the scene has it
    #[arg(long, conflicts_with = "searchlight")]
    no_searchlight: bool,
    /// Make pictures, and colours of vertices, brighter by a number of stops, each a factor of 2; pictures by "auto" as bright
    /// as a screen can show, all of them alike; without effect on the colours of a ramp [default: 0]
    #[arg(long, value_name = "STOPS|auto", value_parser = exposure, allow_hyphen_values = true)]
    exposure: Option<Exposure>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum DopplerName {
    Spectrum,
    Ramp,
    None,
}

impl EffectArgs {
    fn doppler(&self, of_scene: Doppler) -> Doppler {
        match (self.doppler, of_scene) {
            // With what the scene says of spectra.
            (None, doppler) | (Some(DopplerName::Spectrum), doppler @ Doppler::Spectrum(_)) => {
                doppler
            }
            (Some(DopplerName::Spectrum), _) => Doppler::Spectrum(Spectrum::default()),
            (Some(DopplerName::Ramp), _) => Doppler::Ramp,
            (Some(DopplerName::None), _) => Doppler::None,
        }
    }

    /// The scene with the effects that the flags say.
    pub(super) fn scene(&self, scene: Scene) -> Scene {
        let effects = scene.effects();
        scene.with_effects(Effects {
            doppler: self.doppler(effects.doppler),
            searchlight: self.searchlight || effects.searchlight && !self.no_searchlight,
            exposure: self.exposure.unwrap_or(effects.exposure),
        })
    }
}

/// Says what a ramp leaves out.
pub(super) fn tell_of_ramp(scene: &Scene, verbosity: Verbosity) {
    let effects = scene.effects();
    let is_less = effects != effects.shown() || !scene.lamps().is_empty();
    if effects.doppler == Doppler::Ramp && is_less {
        verbosity.note(format_args!(
            "the ramp is a scale: its colours are seen by the lamp at the eye, without the searchlight effect, exposure and lamps"
        ));
    }
}

/// A number of stops, or `auto`.
fn exposure(text: &str) -> anyhow::Result<Exposure> {
    Ok(text.parse()?)
}

#[cfg(test)]
mod tests {
    use clap::{Args, FromArgMatches};

    use super::*;

    fn with_flags(effects: &str, flags: &[&str]) -> Effects {
        let scene = format!(
            r#"{{ "effects": {effects}, "objects": [{{ "name": "s", "shape": {{ "sphere": {{ "radius": 1 }} }} }}] }}"#
        );
        let scene = Scene::from_json(&scene).unwrap();
        let command = EffectArgs::augment_args(clap::Command::new("render"));
        let words = std::iter::once("render").chain(flags.iter().copied());
        let matches = command.try_get_matches_from(words).unwrap();
        let args = EffectArgs::from_arg_matches(&matches).unwrap();
        args.scene(scene).effects()
    }

    #[test]
    fn flags_override_the_scene() {
        let scene = r#"{ "doppler": { "kelvin": 3000 }, "exposure": 2 }"#;
        let as_it_is = with_flags(scene, &[]);
        assert!(matches!(as_it_is.doppler, Doppler::Spectrum(_)) && !as_it_is.searchlight);
        assert_eq!(with_flags(scene, &["--doppler", "spectrum"]), as_it_is);
        let all = with_flags(
            scene,
            &["--doppler=ramp", "--searchlight", "--exposure=-1.5"],
        );
        assert_eq!(all.doppler, Doppler::Ramp);
        assert!(all.searchlight);
        assert_eq!(all.exposure, "-1.5".parse().unwrap());
        let none = with_flags(scene, &["--doppler=none", "--exposure", "auto"]);
        assert_eq!(
            (none.doppler, none.exposure),
            (Doppler::None, Exposure::Auto)
        );
        assert_eq!(
            with_flags("{}", &["--doppler=spectrum"]).doppler,
            Doppler::Spectrum(Spectrum::default())
        );
        let bright = r#"{ "doppler": "spectrum", "searchlight": true }"#;
        let without = with_flags(bright, &["--no-searchlight"]);
        assert_eq!(without, with_flags(r#"{ "doppler": "spectrum" }"#, &[]));
        assert!(with_flags(bright, &[]).searchlight);
        assert!(!with_flags("{}", &["--no-searchlight"]).searchlight);
    }
}
