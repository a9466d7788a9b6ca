//! What effects cost, measured on a small sample.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;

use super::exposure::of_pixels;
use super::picture_settings::{PictureMethod, PictureSettings, PictureView};
use crate::effects::{Doppler, SeenLight, tone, within_gamut};
use crate::pipeline::PlacedScene;
use crate::render::{Scenery, Viewpoint};
use crate::scene::{Exposure, Scene};

/// Lights that are worked out for one measurement: some milliseconds.
const SAMPLE: u32 = 20_000;

/// Rays for one measurement of lamps, each with rays for shadows.
const LIT_SAMPLE: usize = 2_000;

/// What an effect of a scene costs on this computer, now: an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectCost {
    /// Its name in scenes.
    pub effect: &'static str,
    /// Wall-clock time before the first colour, in seconds.
    pub start_seconds: f64,
    /// Wall-clock time for each colour of a vertex or ray, in seconds, with all threads at work.
    pub seconds_each: f64,
}

impl EffectCost {
    /// The effects that a scene calls for, and its lamps, each measured by itself; none if it calls for none.
    pub fn of(placed: &PlacedScene) -> Vec<Self> {
        let mut costs = Self::of_scene(placed.scene());
        if !placed.scene().lamps().is_empty() {
            costs.extend(Self::of_lamps(placed));
        }
        costs
    }

    /// The lamps of a scene: the time for some rays of the observer's picture, with and without them.
    fn of_lamps(placed: &PlacedScene) -> Option<Self> {
        let scene = placed.scene();
        let moment = scene.moment(0)?;
        let picture = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
        let cameras = picture.camera.observer_cameras(placed).ok()?;
        let directions = of_pixels(cameras.first()?, LIT_SAMPLE);
        let mut scenery = Scenery::new();
        for (object, parts) in placed.objects() {
            for (_, part) in parts {
                scenery.add_at_rest(object, part);
            }
        }
        let look = |scenery: &Scenery, directions: &[DVec3]| {
            let start = Instant::now();
            let met = scenery.luminances(Viewpoint::Observer(&moment), directions);
            (start.elapsed().as_secs_f64(), met.len())
        };
        let (without, met) = look(&scenery, &directions);
        scenery.set_lamps(scene);
        // Before the first ray there is something to do for lamps, some of it once for all pictures.
        let first = &directions[..directions.len().min(1)];
        let (start_seconds, _) = look(&scenery, first);
        // Whatever else the computer does only adds to a time.
        let least = |directions: &[DVec3]| {
            let times = [(); 3].map(|()| look(&scenery, directions).0);
            times.into_iter().fold(f64::INFINITY, f64::min)
        };
        let (each_time, with) = (least(first), least(&directions));
        Some(Self {
            effect: "lamps",
            start_seconds,
            seconds_each: (with - each_time - without).max(0.0) / met.max(1) as f64,
        })
    }

    fn of_scene(scene: &Scene) -> Vec<Self> {
        let effects = scene.effects().shown();
        let mut costs = Vec::new();
        if effects.doppler != Doppler::None {
            let light = SeenLight::new(effects.doppler, false);
            let color = |color, factor| light.seen(color, light.daylight(), factor);
            costs.push(Self::measured("doppler", color));
        }
        if effects.searchlight {
            let light = SeenLight::new(Doppler::None, true);
            let color = |color, factor| light.seen(color, light.daylight(), factor);
            costs.push(Self::measured("searchlight", color));
        }
        let mut emissions = scene.objects().iter().filter_map(|object| object.emission);
        if let Some(emission) = emissions.next() {
            let light = SeenLight::new(effects.doppler, effects.searchlight);
            let (temperature, luminance) = (emission.temperature(), emission.luminance());
            let color = |_, factor| light.glow(temperature, luminance, factor);
            costs.push(Self::measured("emission", color));
        }
        if effects.exposure != Exposure::default() {
            let factor = match effects.exposure {
                Exposure::Stops(stops) => stops.factor(),
                Exposure::Auto => 1.0,
            };
            costs.push(Self::measured("exposure", |color, _| {
                tone(within_gamut(color * factor))
            }));
        }
        costs
    }

    /// Wall-clock time for so many vertices or rays, in seconds.
    pub fn seconds(&self, count: f64) -> f64 {
        self.start_seconds + self.seconds_each * count
    }

    fn measured(effect: &'static str, color: impl Fn(DVec3, f64) -> DVec3) -> Self {
        let start = Instant::now();
        black_box(color(DVec3::new(0.1, 0.5, 0.9), 1.3));
        let start_seconds = start.elapsed().as_secs_f64();
        // Of which the making of the sample is no part.
        let seconds = (sampled(color) - sampled(|color, _| color)).max(0.0);
        let threads = rayon::current_num_threads() as f64;
        Self {
            effect,
            start_seconds,
            seconds_each: seconds / f64::from(SAMPLE) / threads,
        }
    }
}

/// Wall-clock time of one thread for the whole sample, in seconds.
fn sampled(color: impl Fn(DVec3, f64) -> DVec3) -> f64 {
    let start = Instant::now();
    for number in 0..SAMPLE {
        let part = |by: f64| (f64::from(number) * by).fract();
        let surface = DVec3::new(part(0.618), part(0.414), part(0.732));
        black_box(color(surface, 0.5 + 1.5 * part(0.236)));
    }
    start.elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_scene_calls_for_has_a_cost() {
        let costs = |effects: &str, emission: &str| {
            let scene = format!(
                r#"{{ "effects": {effects}, "objects": [{{ "name": "s", "shape": {{ "sphere": {{ "radius": 1 }} }} {emission} }}] }}"#
            );
            let costs = EffectCost::of_scene(&Scene::from_json(&scene).unwrap());
            for cost in &costs {
                assert!(
                    cost.start_seconds >= 0.0 && cost.seconds_each >= 0.0,
                    "{cost:?}"
                );
                assert!(cost.seconds(1e6) >= cost.seconds(1e3));
            }
            costs.iter().map(|cost| cost.effect).collect::<Vec<_>>()
        };
        assert!(costs("{}", "").is_empty());
        let all = r#"{ "doppler": "spectrum", "searchlight": true, "exposure": "auto" }"#;
        assert_eq!(costs(all, ""), ["doppler", "searchlight", "exposure"]);
        // A ramp is a scale, which no other effect changes.
        let ramp = r#"{ "doppler": "ramp", "searchlight": true, "exposure": "auto" }"#;
        assert_eq!(costs(ramp, ""), ["doppler"]);
        assert_eq!(
            costs("{}", r#", "emission": { "kelvin": 3000 }"#),
            ["emission"]
        );
    }
}
