//! A Minkowski diagram of the observer's worldline, as numbers: figures 2 and 5 of Rau, Weiskopf, Ruder, *Special
//! Relativity in Virtual Reality* (1998), for any scene and any flight.

use std::ops::RangeInclusive;

use glam::DVec3;
use thiserror::Error;

use crate::light_cone::View;
use crate::plot::round_step;
use crate::scene::{Object, Place, Scene};
use crate::spacetime::{Event, Flight, Lorentz, Moment, WorldLine, length, unit};

/// A worldline has about so many ticks.
const TICKS: f64 = 10.0;

/// A worldline is drawn with an error of at most this part of its extent.
const FLATNESS: f64 = 1.0 / 4000.0;

/// A worldline is first divided into so many pieces, and then each of them at most so many times into halves.
const PIECES: u32 = 32;
const MAX_HALVINGS: u32 = 12;

/// An event that is less than this part of the worldline's extent beside the plane is in it, but for rounding.
const ROUNDING: f64 = 1e-9;

/// Coordinates up to this one have sums and differences that are numbers.
const MAX_COORDINATE: f64 = 1e300;

/// What a diagram shows.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramSettings {
    /// Proper times between which the observer's worldline is drawn. It also reaches all times of `at`; where that is a
    /// single one it is drawn for as long before and after as the light that is seen has been under way.
    pub proper_times: RangeInclusive<f64>,
    /// Proper times of the moments with light cones, momentary axes and emission events.
    pub at: Vec<f64>,
    /// The direction of space that the diagram has beside time, in the scene frame, a vector of any length. With `None`
    /// that from the observer's first place to the farthest one; if the observer stays, that to the farthest emission
    /// event.
    pub direction: Option<DVec3>,
    /// Points whose worldlines and emission events are drawn; if there are none, the origins of all objects.
    pub points: Vec<DiagramPoint>,
}

/// A point at rest in the rest frame of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramPoint {
    /// The name of the object.
    pub object: String,
    /// The place in the object's rest frame, whose origin is the object's.
    pub position_rest: Place,
}

/// Why there is no diagram.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DiagramError {
    /// A point of an object that the scene does not have.
    #[error("the scene has no object \"{0}\", expected one of: {1}; as OBJECT or OBJECT:X,Y,Z")]
    Object(String, String),
    /// The zero vector, or one that is not finite.
    #[error("the direction is {0}, expected a vector other than zero with finite coordinates")]
    Direction(DVec3),
    /// A time that is not finite.
    #[error("the proper time is {0}, expected a finite number")]
    ProperTime(f64),
    /// The observer gets farther than numbers go.
    #[error(
        "at proper time {0:?} the observer is farther than {MAX_COORDINATE:e}, too far for a diagram"
    )]
    ObserverTooFar(f64),
    /// Light comes from farther than numbers go.
    #[error(
        "at proper time {1:?} light arrives from \"{0}\" from farther than {MAX_COORDINATE:e}, too far for a diagram"
    )]
    PointTooFar(String, f64),
}

/// A Minkowski diagram of the observer's worldline.
///
/// All events are in the scene frame and have all coordinates. The plane of the diagram holds the time axis, the place of
/// the observer at proper time 0 and the direction; [`WorldlineDiagram::off_plane`] says how far an event is beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldlineDiagram {
    /// The title of the scene.
    pub title: Option<String>,
    /// The direction of space, of length 1.
    pub direction: DVec3,
    /// Events along the observer's worldline, in their order.
    pub worldline: Vec<Event>,
    /// Round proper times along it.
    pub ticks: Vec<DiagramTick>,
    /// The chosen moments.
    pub moments: Vec<DiagramMoment>,
    /// The chosen points.
    pub points: Vec<PointLine>,
    /// For every moment and every point the event that is seen.
    pub emissions: Vec<Emission>,
    /// A place in the plane.
    base: DVec3,
    /// The extent of the worldline and all emission events.
    extent: f64,
}

/// A round proper time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagramTick {
    /// The observer's proper time.
    pub proper_time: f64,
    /// Where and when that is.
    pub event: Event,
    /// The observer's four-velocity there.
    pub four_velocity: Event,
}

/// A chosen moment of the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagramMoment {
    /// The observer's proper time.
    pub proper_time: f64,
    /// Where and when the observer is.
    pub event: Event,
    /// The direction of the observer's own axis of time: the four-velocity.
    pub time_axis: Event,
    /// The direction, in the plane of the diagram, in which events have the same time for the observer.
    pub space_axis: Event,
}

/// The worldline of a point of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLine {
    /// The object's name, with the place in its rest frame unless that is the origin.
    pub name: String,
    /// Where the point is when.
    pub world_line: WorldLine,
}

/// The event at which the light that is seen at one moment left a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// The index of the moment.
    pub moment: usize,
    /// The index of the point.
    pub point: usize,
    /// Where and when the light left the point.
    pub event: Event,
    /// Where the observer sees the point: the same place in the observer's frame, at the time of the observation. It is not
    /// finite where that is beyond `f64`.
    pub seen: Event,
}

impl WorldlineDiagram {
    /// The diagram of the observer's worldline in a scene.
    ///
    /// # Errors
    ///
    /// A point of an object that is not there, a direction without direction, a time that is not finite, or an event that
    /// is beyond numbers.
    pub fn new(scene: &Scene, settings: &DiagramSettings) -> Result<Self, DiagramError> {
        let flight = scene.flight();
        let (mut from, mut to) = (*settings.proper_times.start(), *settings.proper_times.end());
        for &time in [from, to].iter().chain(&settings.at) {
            if !time.is_finite() {
                return Err(DiagramError::ProperTime(time));
            }
            (from, to) = (from.min(time), to.max(time));
        }
        let chosen = chosen_points(scene, &settings.points)?;
        let points: Vec<PointLine> = chosen.iter().map(Chosen::line).collect();
        let mut emissions = vec![];
        let (mut longest_way, mut farthest) = (0.0, DVec3::ZERO);
        for (index, &time) in settings.at.iter().enumerate() {
            let moment = flight.moment(time);
            let now = event_at(flight, time)?;
            for (point, chosen) in chosen.iter().enumerate() {
                let emission = chosen.emission(&moment, (index, point));
                if !is_near(emission.event) {
                    return Err(DiagramError::PointTooFar(points[point].name.clone(), time));
                }
                let way = emission.event - now;
                if -way.time > longest_way {
                    (longest_way, farthest) = (-way.time, way.position);
                }
                emissions.push(emission);
            }
        }
        if from == to {
            let under_way = if longest_way > 0.0 { longest_way } else { 1.0 };
            let own = under_way / flight.moment(from).velocity().gamma();
            (from, to) = (from - own, to + own);
        }
        let worldline = sampled(flight, from, to, &settings.at)?;
        let direction = match settings.direction {
            Some(given) => unit(given).ok_or(DiagramError::Direction(given))?,
            None => farthest_direction(&worldline, farthest),
        };
        let base = event_at(flight, 0.0)?.position;
        let moments: Result<Vec<_>, _> = settings
            .at
            .iter()
            .map(|&time| {
                let velocity = flight.moment(time).velocity();
                let along = velocity.beta() * velocity.direction().dot(direction);
                Ok(DiagramMoment {
                    proper_time: time,
                    event: event_at(flight, time)?,
                    time_axis: velocity.four_velocity(),
                    space_axis: Event::new(along, direction),
                })
            })
            .collect();
        let events = worldline
            .iter()
            .chain(emissions.iter().map(|emission| &emission.event));
        let extent = events.fold(0.0, |extent: f64, event| {
            extent.max(size(*event - worldline[0]))
        });
        Ok(Self {
            title: scene.title().map(str::to_owned),
            direction,
            ticks: ticks(flight, from, to)?,
            worldline,
            moments: moments?,
            points,
            emissions,
            base,
            extent,
        })
    }

    /// The coordinate of an event along the direction.
    pub fn along(&self, event: Event) -> f64 {
        event.position.dot(self.direction)
    }

    /// How far an event is beside the plane of the diagram; 0 also where rounding alone puts it there.
    pub fn off_plane(&self, event: Event) -> f64 {
        let away = event.position - self.base;
        let beside = length(away - self.direction * away.dot(self.direction));
        match beside > ROUNDING * self.extent {
            true => beside,
            false => 0.0,
        }
    }
}

/// A point with its object.
struct Chosen<'a> {
    object: &'a Object,
    position_rest: DVec3,
}

impl Chosen<'_> {
    fn line(&self) -> PointLine {
        let Self {
            object,
            position_rest,
        } = self;
        let line = object.world_line();
        let to_scene = Lorentz::boost(line.velocity.reversed());
        let offset = to_scene.apply(Event::new(0.0, *position_rest));
        let name = match *position_rest == DVec3::ZERO {
            true => object.name.clone(),
            false => format!("{} {position_rest}", object.name),
        };
        PointLine {
            name,
            world_line: WorldLine {
                origin: line.origin + offset,
                ..line
            },
        }
    }

    /// The event that is seen at a moment.
    ///
    /// # Derivation
    ///
    /// In the object's rest frame light needs the distance as time. From there the boost to the scene frame has the speed
    /// of the object alone, so that no digits are lost to that of the observer.
    fn emission(&self, moment: &Moment, (index, point): (usize, usize)) -> Emission {
        let line = self.object.world_line();
        let view = View::new(moment, &line);
        let away = self.position_rest - view.observer_rest();
        let to_scene = Lorentz::boost(line.velocity.reversed());
        let now = moment.event();
        let seen = Event::new(0.0, view.seen_position(self.position_rest));
        Emission {
            moment: index,
            point,
            event: now + to_scene.apply(Event::new(-length(away), away)),
            seen: now + moment.scene_to_observer().inverse().apply(seen),
        }
    }
}

/// The chosen points, or the origins of all objects if none is chosen.
fn chosen_points<'a>(
    scene: &'a Scene,
    points: &[DiagramPoint],
) -> Result<Vec<Chosen<'a>>, DiagramError> {
    let objects = scene.objects();
    if points.is_empty() {
        let origin = |object| Chosen {
            object,
            position_rest: DVec3::ZERO,
        };
        return Ok(objects.iter().map(origin).collect());
    }
    let of_object = |point: &DiagramPoint| {
        let object = objects.iter().find(|object| object.name == point.object);
        let names = || objects.iter().map(|object| object.name.as_str());
        let object = object.ok_or_else(|| {
            let names = names().collect::<Vec<_>>().join(", ");
            DiagramError::Object(point.object.clone(), names)
        })?;
        Ok(Chosen {
            object,
            position_rest: point.position_rest.get(),
        })
    };
    points.iter().map(of_object).collect()
}

/// The observer's event at a proper time.
fn event_at(flight: &Flight, proper_time: f64) -> Result<Event, DiagramError> {
    let event = flight.moment(proper_time).event();
    match is_near(event) {
        true => Ok(event),
        false => Err(DiagramError::ObserverTooFar(proper_time)),
    }
}

fn is_near(event: Event) -> bool {
    let Event { time, position } = event;
    // A NaN is not near.
    time.abs() <= MAX_COORDINATE && position.abs().cmple(DVec3::splat(MAX_COORDINATE)).all()
}

/// Length and time of a difference of events, whichever is more.
fn size(difference: Event) -> f64 {
    difference.time.abs().max(length(difference.position))
}

/// Events so close to each other that straight lines between them are the worldline, as far as one can see.
fn sampled(flight: &Flight, from: f64, to: f64, at: &[f64]) -> Result<Vec<Event>, DiagramError> {
    let part = |n: u32| from + (to - from) * (f64::from(n) / f64::from(PIECES));
    let mut times: Vec<f64> = (0..=PIECES).map(part).collect();
    let between = |time: &&f64| (from..=to).contains(*time);
    times.extend(flight.times().iter().chain(at).filter(between));
    times.sort_by(f64::total_cmp);
    times.dedup();
    let coarse: Result<Vec<_>, _> = times
        .iter()
        .map(|&time| event_at(flight, time).map(|event| (time, event)))
        .collect();
    let coarse = coarse?;
    let first = coarse[0].1;
    let extent = coarse.iter().fold(0.0, |extent: f64, (_, event)| {
        extent.max(size(*event - first))
    });
    let mut events = vec![first];
    for ends in coarse.windows(2) {
        // Pieces that are left to do, the earliest last.
        let mut pieces = vec![(ends[0], ends[1], MAX_HALVINGS)];
        while let Some((start, end, halvings)) = pieces.pop() {
            let time = 0.5 * start.0 + 0.5 * end.0;
            let middle = (time, event_at(flight, time)?);
            let chord = start.1 * 0.5 + end.1 * 0.5;
            if halvings == 0 || size(middle.1 - chord) <= FLATNESS * extent {
                events.push(end.1);
            } else {
                pieces.push((middle, end, halvings - 1));
                pieces.push((start, middle, halvings - 1));
            }
        }
    }
    Ok(events)
}

/// The direction from the first place to the farthest one, else that of `light`, else x.
fn farthest_direction(worldline: &[Event], light: DVec3) -> DVec3 {
    let first = worldline[0].position;
    let mut farthest = DVec3::ZERO;
    for event in worldline {
        let away = event.position - first;
        if length(away) > length(farthest) {
            farthest = away;
        }
    }
    let duration = size(worldline[worldline.len() - 1] - worldline[0]);
    let has_moved = length(farthest) > ROUNDING * duration;
    let direction = unit(if has_moved { farthest } else { light }).unwrap_or(DVec3::X);
    // Along an axis, but for rounding.
    let axis = direction.abs().cmpgt(DVec3::splat(1.0 - ROUNDING));
    match axis.any() {
        true => direction.round(),
        false => direction,
    }
}

/// Round proper times between two, with the observer there.
fn ticks(flight: &Flight, from: f64, to: f64) -> Result<Vec<DiagramTick>, DiagramError> {
    let step = round_step((to - from) / TICKS);
    let first = (from / step).ceil();
    let count = ((to / step).floor() - first).clamp(0.0, 2.0 * TICKS) as u32;
    let tick = |number: u32| {
        let proper_time = (first + f64::from(number)) * step;
        Ok(DiagramTick {
            proper_time,
            event: event_at(flight, proper_time)?,
            four_velocity: flight.moment(proper_time).velocity().four_velocity(),
        })
    };
    (0..=count).map(tick).collect()
}
