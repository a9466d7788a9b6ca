//! The light of the lamps of a scene on its surfaces.
//!
//! A place that the observer sees is an event: where its light left. Of each lamp the event is found on the past light cone
//! of that one, in the lamp's rest frame; direction, strength and shift of the light follow in the rest frame of the surface
//! ([`crate::effects::arrival`]), in which it is scattered, and whatever is in between casts its shadow ([`super::shadows`]).

use glam::DVec3;

use super::aberration::Aberration;
use super::body::Body;
use super::shading::{Facing, Finish, Reflected, from_all_around, from_lamp};
use super::shadows::{LitPlace, Shadows, Way};
use crate::effects::{
    Arrival, Lamplight, arrival, far_irradiance, from_point, held, point_irradiance, sky_irradiance,
};
use crate::scene::{Carrier, Flash, Lamp, LampSource, Scene};
use crate::spacetime::{Event, Lorentz, Moment, Velocity, ViewModel, WorldLine, unit};

/// The lamps of a scene, each with its motion.
#[derive(Clone)]
pub(super) struct Lamps(Vec<StandingLamp>);

#[derive(Clone)]
struct StandingLamp {
    kelvin: f64,
    /// Of a filter before the lamp.
    color: DVec3,
    source: Source,
}

#[derive(Clone)]
enum Source {
    Point(Point),
    Sun { travel: DVec3, irradiance: f64 },
    Ambient { irradiance: f64 },
}

#[derive(Clone)]
struct Point {
    line: WorldLine,
    /// In the rest frame of the line.
    place: DVec3,
    intensity: f64,
    flash: Option<Flash>,
    /// The object on which it rides.
    rider: Option<String>,
}

impl Lamps {
    /// The lamps of a scene, if it has some.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let lamps: Vec<_> = scene
            .lamps()
            .iter()
            .map(|lamp| standing(scene, lamp))
            .collect();
        (!lamps.is_empty()).then_some(Self(lamps))
    }
}

fn standing(scene: &Scene, lamp: &Lamp) -> StandingLamp {
    let source = match *lamp.source() {
        LampSource::Point(ref point) => {
            let position = point.position().get();
            let own = |velocity| WorldLine {
                origin: Event::new(0.0, position),
                velocity,
            };
            let (line, place, rider) = match point.carrier() {
                Carrier::Own(velocity) => (own(*velocity), DVec3::ZERO, None),
                Carrier::Object(name) => {
                    let mut objects = scene.objects().iter();
                    let object = objects.find(|object| object.name == *name);
                    let object =
                        object.expect("a scene holds no lamp on an object that it has not");
                    (object.world_line(), position, Some(name.clone()))
                }
            };
            Source::Point(Point {
                line,
                place,
                intensity: point.intensity(),
                flash: point.flash(),
                rider,
            })
        }
        LampSource::Sun {
            direction,
            irradiance,
        } => Source::Sun {
            travel: direction,
            irradiance,
        },
        LampSource::Ambient { irradiance } => Source::Ambient { irradiance },
    };
    StandingLamp {
        kelvin: lamp.temperature().kelvin(),
        color: lamp.color().map_or(DVec3::ONE, |color| {
            DVec3::from_array(color.linear().map(f64::from))
        }),
        source,
    }
}

/// Lamps, surfaces and what casts shadows, for one moment of the observer.
pub(super) struct Lighting<'a> {
    lamps: Vec<PlacedLamp<'a>>,
    /// Of the surfaces; their light is asked for by number.
    velocities: Vec<Velocity>,
    /// From their frames to that of the observer.
    to_observer: Vec<Lorentz>,
    shadows: Shadows<'a>,
}

struct PlacedLamp<'a> {
    lamp: &'a StandingLamp,
    /// Of a point.
    aberration: Option<Aberration>,
    /// The time of the observation in the lamp's frame.
    observed: f64,
    /// From the lamp's frame to those of surfaces and of what casts shadows, by number.
    to_surfaces: Vec<Lorentz>,
    to_occluders: Vec<Lorentz>,
}

/// A place of a surface that lamps light.
pub(super) struct Surface<'a> {
    pub(super) place: LitPlace<'a>,
    /// The number of its frame.
    pub(super) frame: usize,
    /// In its rest frame.
    pub(super) facing: Facing,
    pub(super) finish: Finish,
    /// The part of the light from all around that gets there.
    pub(super) open: f64,
}

/// What becomes of light on its way.
#[derive(Clone, Copy)]
pub(super) struct Shifts {
    /// Whether anything does.
    pub(super) any: bool,
    /// Whether its brightness changes.
    pub(super) brightness: bool,
}

/// Light of a lamp that a surface sends to the eye.
pub(super) struct LitBy {
    pub(super) lamp: Lamplight,
    /// Of the filter before the lamp.
    pub(super) color: DVec3,
    pub(super) reflected: Reflected,
}

impl<'a> Lighting<'a> {
    /// For an observer at `moment`, surfaces that move with `velocities`, and shadows of `occluders`.
    pub(super) fn new(
        lamps: &'a Lamps,
        moment: &Moment,
        velocities: Vec<Velocity>,
        occluders: impl Iterator<Item = &'a Body>,
    ) -> Self {
        let shadows = Shadows::new(occluders, moment);
        let placed = lamps.0.iter().map(|lamp| {
            let line = match &lamp.source {
                Source::Point(point) => Some(point.line),
                Source::Sun { .. } | Source::Ambient { .. } => None,
            };
            let velocity = line.map_or(Velocity::ZERO, |line| line.velocity);
            let to = |other: Velocity| Lorentz::between(velocity, other);
            PlacedLamp {
                lamp,
                aberration: line.map(|line| Aberration::new(moment, &line, ViewModel::Seen)),
                observed: line.map_or(0.0, |line| moment.event_at_rest_with(&line).time),
                to_surfaces: velocities.iter().copied().map(to).collect(),
                to_occluders: shadows.velocities().map(to).collect(),
            }
        });
        let to_observer = velocities
            .iter()
            .map(|&velocity| moment.rest_to_observer(velocity));
        Self {
            lamps: placed.collect(),
            to_observer: to_observer.collect(),
            velocities,
            shadows,
        }
    }

    /// Where the observer sees the place whose offset from the observer is `offset_rest` in the frame of this number: the
    /// unit direction, and how far away.
    pub(super) fn seen(&self, frame: usize, offset_rest: DVec3) -> Option<(DVec3, f64)> {
        let distance = offset_rest.length();
        let there = arrival(&self.to_observer[frame], -unit(offset_rest)?);
        Some((-there.travel, distance * there.factor))
    }

    /// Calls `visit` with the light of all lamps on a surface.
    pub(super) fn light(&self, surface: &Surface, shifts: Shifts, mut visit: impl FnMut(LitBy)) {
        let shifted = shifts.brightness;
        for placed in &self.lamps {
            let StandingLamp {
                kelvin,
                color,
                ref source,
            } = *placed.lamp;
            let mut add = |factor: f64, reflected: Reflected| {
                if reflected.tinted > 0.0 || reflected.white > 0.0 {
                    visit(LitBy {
                        lamp: Lamplight {
                            kelvin,
                            factor: held(factor),
                        },
                        color,
                        reflected,
                    });
                }
            };
            match source {
                Source::Point(point) => {
                    if let Some((factor, light)) = self.of_point(placed, point, surface, shifted) {
                        add(factor, light);
                    }
                }
                &Source::Sun { travel, irradiance } => {
                    if let Some((factor, light)) = self.of_sun(placed, travel, surface, shifted) {
                        add(factor, light * irradiance);
                    }
                }
                Source::Ambient { irradiance } => {
                    let motion = self.velocities[surface.frame];
                    let light = from_all_around(
                        surface.finish,
                        surface.facing.eye_cosine(),
                        irradiance * surface.open,
                        irradiance * surface.open,
                    );
                    match shifts.any {
                        true => sky_irradiance(motion, surface.facing.normal, |part, factor| {
                            add(factor, light * part);
                        }),
                        false => add(1.0, light),
                    }
                }
            }
        }
    }

    /// The Doppler factor from the lamp to the surface, and the light.
    fn of_point(
        &self,
        placed: &PlacedLamp,
        point: &Point,
        surface: &Surface,
        shifted: bool,
    ) -> Option<(f64, Reflected)> {
        let ray = placed.aberration.as_ref()?.ray(surface.place.seen);
        let since = ray.stretch * surface.place.distance;
        let event = Event::new(placed.observed - since, ray.origin + ray.direction * since);
        let light = from_point(point.place, event)?;
        if point.flash.is_some_and(|flash| !flash.is_on(light.emitted)) {
            return None;
        }
        let Arrival { travel, factor } = arrival(&placed.to_surfaces[surface.frame], light.travel);
        let reflected = from_lamp(surface.finish, surface.facing, -travel);
        let irradiance = point_irradiance(light.distance, placed.lamp.kelvin, factor, shifted);
        let strength = (point.intensity * irradiance).min(f64::MAX);
        if reflected == Reflected::default() || !(strength > 0.0) {
            return None;
        }
        let way = |number: usize| {
            let there = arrival(&placed.to_occluders[number], light.travel);
            Way {
                to_lamp: -there.travel,
                distance: light.distance * there.factor,
            }
        };
        let rider = point.rider.as_deref();
        let dark = self.shadows.fall_on(surface.place, rider, way);
        (!dark).then(|| (factor, reflected * strength))
    }

    fn of_sun(
        &self,
        placed: &PlacedLamp,
        travel: DVec3,
        surface: &Surface,
        shifted: bool,
    ) -> Option<(f64, Reflected)> {
        let there = arrival(&placed.to_surfaces[surface.frame], travel);
        let reflected = from_lamp(surface.finish, surface.facing, -there.travel);
        let strength = far_irradiance(placed.lamp.kelvin, there.factor, shifted);
        if reflected == Reflected::default() || !(strength > 0.0) {
            return None;
        }
        let way = |number: usize| Way {
            to_lamp: -arrival(&placed.to_occluders[number], travel).travel,
            distance: f64::MAX,
        };
        let dark = self.shadows.fall_on(surface.place, None, way);
        (!dark).then(|| (there.factor, reflected * strength))
    }
}
