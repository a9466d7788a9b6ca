//! A flight: an observer who fires engines and turns, segment by segment.

use std::sync::Arc;

use glam::DVec3;

use super::coordinated::Course;
use super::integrator::Step;
use super::pieces::Pieces;
use super::stepped::{Method, Stepped};
use super::{FlightError, Integrator, Segment, Steering};
use crate::spacetime::Moment;
use crate::spacetime::exact::two_sum;

/// The flight of an observer: what it is at any of its proper times.
///
/// Proper times are counted from the moment of the start. Before it and after the last segment the observer coasts, axes
/// unturned.
///
/// # Accuracy
///
/// By [`Integrator::Exact`] a flight is known to rounding: one long segment and the many short ones that it is made of
/// lead to the same moments (`tests/it/flights/exact.rs`, which also compares with 256 bits). Its axes are orthonormal
/// whatever the number of segments. A moment takes a time that grows with the logarithm of the number of segments.
///
/// # Example
///
/// A rocket with the thrust of a falling stone, 1.03 per year, is after 12 years of its own time 113,242 light years away:
///
/// ```
/// use photosurface::spacetime::{Event, Flight, Integrator, Lorentz, Segment};
/// use photosurface::{DVec3, Moment};
///
/// let thrust = Segment::free(12.0, DVec3::X * 1.03, DVec3::ZERO)?;
/// let start = Moment::new(Event::default(), Lorentz::IDENTITY);
/// let flight = Flight::new(start, vec![thrust], Integrator::Exact)?;
/// let away = flight.moment(12.0).event().position.x;
/// assert!((away - 113_242.344614).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    start: Moment,
    segments: Arc<[Segment]>,
    integrator: Integrator,
    /// The proper time at the beginning of each segment, and that at the end of the last one.
    times: Arc<[f64]>,
    way: Way,
}

/// The states of a flight that are known beforehand.
#[derive(Clone, Debug, PartialEq)]
enum Way {
    Exact(Arc<Pieces>),
    Stepped(Arc<Stepped>),
}

impl Flight {
    /// The flight of the observer who is `start` at proper time 0; without segments the observer coasts.
    ///
    /// # Errors
    ///
    /// A segment that ends faster than [`MAX_RAPIDITY`](crate::spacetime::MAX_RAPIDITY), a coordinated turn that comes
    /// to rest, or an integrator with too many steps.
    pub fn new(
        start: Moment,
        segments: Vec<Segment>,
        integrator: Integrator,
    ) -> Result<Self, FlightError> {
        let mut times = Vec::with_capacity(segments.len() + 1);
        let mut time = CompensatedSum::default();
        times.push(0.0);
        for segment in &segments {
            time.add(segment.proper_time());
            times.push(time.value());
        }
        if !time.value().is_finite() {
            return Err(FlightError::Endless);
        }
        let scene_to_start = start.scene_to_observer();
        let stepped = |method, step: Step| {
            Stepped::new(&scene_to_start, &segments, method, step.get()).map(Arc::new)
        };
        let way = match integrator {
            Integrator::Exact => Way::Exact(Arc::new(Pieces::new(&scene_to_start, &segments)?)),
            Integrator::Euler(step) => Way::Stepped(stepped(Method::Euler, step)?),
            Integrator::RungeKutta4(step) => Way::Stepped(stepped(Method::RungeKutta4, step)?),
        };
        Ok(Self {
            start,
            segments: segments.into(),
            integrator,
            times: times.into(),
            way,
        })
    }

    /// The observer at `proper_time`, counted from the start.
    pub fn moment(&self, proper_time: f64) -> Moment {
        let last = self.times[self.segments.len()];
        match self.segment_at(proper_time) {
            Some(segment) => {
                let rest = proper_time - self.times[segment];
                match &self.way {
                    Way::Exact(pieces) => pieces.moment(&self.start, segment, rest),
                    Way::Stepped(stepped) => stepped.moment(&self.start, segment, rest),
                }
            }
            None if proper_time < last || self.segments.is_empty() => {
                self.start.coasted(proper_time)
            }
            None => {
                let end = match &self.way {
                    Way::Exact(pieces) => pieces.end(&self.start),
                    Way::Stepped(stepped) => stepped.end(&self.start),
                };
                match proper_time - last {
                    0.0 => end,
                    after => end.coasted(after),
                }
            }
        }
    }

    /// The proper acceleration at `proper_time`, in the observer's own axes; that of the segment that begins, where one
    /// ends and another begins.
    pub fn acceleration(&self, proper_time: f64) -> DVec3 {
        let segment = self.segment_at(proper_time);
        segment.map_or(DVec3::ZERO, |segment| self.segments[segment].acceleration())
    }

    /// The turn rate at `proper_time`, in radians per proper time, in the observer's own axes; as
    /// [`Flight::acceleration`].
    pub fn turn_rate(&self, proper_time: f64) -> DVec3 {
        let Some(segment) = self.segment_at(proper_time) else {
            return DVec3::ZERO;
        };
        let segment = &self.segments[segment];
        match segment.steering() {
            Steering::Free { turn_rate } => turn_rate,
            Steering::Coordinated => {
                let now = self.moment(proper_time).scene_to_observer();
                Course::new(&now, segment.acceleration(), 0.0).turn_rate()
            }
        }
    }

    /// The proper time that all segments last together.
    pub fn proper_time(&self) -> f64 {
        self.times[self.segments.len()]
    }

    /// The segments, in their order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The proper time at which each segment begins, counted from the start, and that at which the last one ends.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// How the flight is computed.
    pub fn integrator(&self) -> Integrator {
        self.integrator
    }

    /// The index of the segment that has begun and not ended.
    fn segment_at(&self, proper_time: f64) -> Option<usize> {
        let begun = self.times.partition_point(|&time| time <= proper_time);
        (1..=self.segments.len())
            .contains(&begun)
            .then(|| begun - 1)
    }
}

/// A sum of many numbers, rounded as if once: A. Neumaier, Z. angew. Math. Mech. 54 (1974), 39.
#[derive(Clone, Copy, Debug, Default)]
struct CompensatedSum {
    sum: f64,
    rest: f64,
}

impl CompensatedSum {
    fn add(&mut self, number: f64) {
        let (sum, rounded) = two_sum(self.sum, number);
        self.sum = sum;
        self.rest += rounded;
    }

    fn value(&self) -> f64 {
        self.sum + self.rest
    }
}
