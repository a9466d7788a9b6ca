//! What the accuracy of a flight costs: closed forms, Runge and Kutta's method and Euler's, against a reference of more
//! digits.

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Instant;

use serde::Serialize;

use super::StudyError;
use super::flight_reference::{Apart, FlightReference};
use super::median::median;
use crate::scene::Scene;
use crate::spacetime::{Flight, FlightError, Integrator, Moment, Segment};

/// Each time is measured over so many seconds at least: one run by closed forms is about as short as a clock's tick.
const LEAST_SECONDS: f64 = 1e-3;

/// Relative errors below this are rounding in part, which has no order.
const ROUNDING: f64 = 1e-12;

/// How a flight is integrated for an [`IntegratorStudy`].
#[derive(Clone, Debug, PartialEq)]
pub struct IntegratorSettings {
    /// Numbers of steps of the whole flight, for Euler's method and for that of Runge and Kutta.
    pub steps: Vec<NonZeroUsize>,
    /// How often each time is measured; times are medians.
    pub repeats: NonZeroUsize,
}

impl Default for IntegratorSettings {
    /// From 10 to 10,000 steps.
    fn default() -> Self {
        let steps = [10, 30, 100, 300, 1000, 3000, 10_000];
        Self {
            steps: steps
                .map(|steps| NonZeroUsize::new(steps).expect("above zero"))
                .to_vec(),
            repeats: NonZeroUsize::MIN.saturating_add(2),
        }
    }
}

/// What the accuracy of a scene's flight costs.
///
/// The error is that of the observer at the end of the flight, where it is largest, against a reference with about 30
/// digits: power series of degree 28, step by step. The reference is computed twice, with steps of two lengths; the
/// difference is the uncertainty that the study tells.
///
/// # Example
///
/// ```
/// use photosurface::Scene;
/// use photosurface::study::{IntegratorSettings, IntegratorStudy, Method};
///
/// let scene = Scene::from_json(
///     r#"{ "observer": { "flight": [{ "proper_time": 2, "acceleration": [0, 0, -1], "turn_rate": [0, 0.5, 0] }] },
///          "objects": [ { "name": "box", "shape": { "box": { "size": [1, 1, 1] } } } ] }"#,
/// )?;
/// let study = IntegratorStudy::new(&scene, &IntegratorSettings::default())?;
/// let exact = study.rows[0].run.expect("closed forms have no steps that are too long");
/// assert_eq!(study.rows[0].method, Method::Exact);
/// assert!(exact.relative_error < 1e-14 && exact.axes_error < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IntegratorStudy {
    /// The scene's title.
    pub title: Option<String>,
    /// How long the flight takes, in the observer's proper time.
    pub proper_time: f64,
    /// The number of segments.
    pub segments: usize,
    /// The displacement from the start to the end of the flight, in scene units: the scene time, and the place's x, y, z.
    pub displacement: [f64; 4],
    /// The Lorentz factor at the end, in the scene frame.
    pub gamma: f64,
    /// How often each time was measured.
    pub repeats: usize,
    /// What the reference's event is off by its own estimate, as [`IntegratorRun::event_error`].
    pub event_uncertainty: f64,
    /// What the reference's velocity and axes are off by its own estimate, as [`IntegratorRun::axes_error`].
    pub axes_uncertainty: f64,
    /// Closed forms, then each method with the numbers of steps, the fewest first.
    pub rows: Vec<IntegratorCost>,
}

/// A way to compute a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Closed forms.
    Exact,
    /// Euler's method.
    Euler,
    /// The classical method of Runge and Kutta.
    Rk4,
}

/// What a flight by one method with one number of steps costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IntegratorCost {
    /// How the flight is computed.
    pub method: Method,
    /// The flight's proper time over that of a step; a segment that is no multiple of the step ends with a shorter one.
    /// `None` for closed forms.
    pub steps: Option<usize>,
    /// The proper time of one step.
    pub step: Option<f64>,
    /// `None` where the steps are so long that the observer becomes faster than any flight may be.
    pub run: Option<IntegratorRun>,
}

/// The cost and the errors of a flight that was carried out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IntegratorRun {
    /// The time from the segments to the observer at the end.
    pub seconds: f64,
    /// Error of the scene time at the end, in scene units.
    pub time_error: f64,
    /// Error of the place at the end, a length in the scene frame.
    pub position_error: f64,
    /// Error of the event at the end: the root of the sum of the squares of the two.
    pub event_error: f64,
    /// The error of the event over the displacement, of which time and place are added in the same way.
    pub relative_error: f64,
    /// Error of the velocity and the axes at the end: the largest error of a component in the scene frame of the
    /// four-velocity and of the unit vectors along the observer's own axes, over the Lorentz factor.
    pub axes_error: f64,
    /// The power of the step with which the error of the event fell from the row before; `None` without such a row, and
    /// where the error is down to rounding.
    pub order: Option<f64>,
}

impl IntegratorStudy {
    /// Studies the flight of a scene's observer, whatever the scene's own integrator is.
    ///
    /// # Errors
    ///
    /// A scene without a flight; a flight that is not possible by closed forms, that needs too many steps, or that is too
    /// long for the reference.
    pub fn new(scene: &Scene, settings: &IntegratorSettings) -> Result<Self, StudyError> {
        let start = scene.flight().moment(0.0);
        let segments = scene.flight().segments();
        if segments.is_empty() {
            return Err(StudyError::NoFlight);
        }
        let flight = Flight::new(start.clone(), segments.to_vec(), Integrator::Exact)?;
        let reference = FlightReference::new(&flight)?;
        let mut steps = settings.steps.clone();
        steps.sort_unstable();
        steps.dedup();
        let studied = Studied {
            start,
            segments,
            proper_time: flight.proper_time(),
            reference,
            repeats: settings.repeats.get(),
        };
        let mut rows = vec![studied.row(Method::Exact, None)?];
        for method in [Method::Rk4, Method::Euler] {
            let first = rows.len();
            for &steps in &steps {
                let mut row = studied.row(method, Some(steps.get()))?;
                if let Some(before) = rows[first..].last() {
                    row.set_order(before);
                }
                rows.push(row);
            }
        }
        let displacement = reference.end.displacement();
        let [x, y, z] = displacement.position.to_array();
        Ok(Self {
            title: scene.title().map(str::to_owned),
            proper_time: flight.proper_time(),
            segments: segments.len(),
            displacement: [displacement.time, x, y, z],
            gamma: reference.end.gamma(),
            repeats: studied.repeats,
            event_uncertainty: reference.uncertainty.event(),
            axes_uncertainty: reference.uncertainty.axes,
            rows,
        })
    }

    /// The study as JSON text.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a study is names and numbers")
    }
}

/// What all rows of a study have in common.
struct Studied<'a> {
    start: Moment,
    segments: &'a [Segment],
    proper_time: f64,
    reference: FlightReference,
    repeats: usize,
}

impl Studied<'_> {
    fn row(&self, method: Method, steps: Option<usize>) -> Result<IntegratorCost, StudyError> {
        let step = steps.map(|steps| self.proper_time / steps as f64);
        let proper_time = step.unwrap_or(self.proper_time);
        let integrator = match method {
            Method::Exact => Integrator::Exact,
            Method::Euler => Integrator::euler(proper_time)?,
            Method::Rk4 => Integrator::runge_kutta_4(proper_time)?,
        };
        let run = match self.end(integrator) {
            Ok(end) => Some(self.run(integrator, &end)),
            Err(FlightError::TooFast { .. }) if steps.is_some() => None,
            Err(error) => return Err(error.into()),
        };
        Ok(IntegratorCost {
            method,
            steps,
            step,
            run,
        })
    }

    /// The observer at the end of the flight.
    fn end(&self, integrator: Integrator) -> Result<Moment, FlightError> {
        let segments = black_box(self.segments).to_vec();
        let flight = Flight::new(self.start.clone(), segments, integrator)?;
        Ok(flight.moment(flight.proper_time()))
    }

    fn run(&self, integrator: Integrator, end: &Moment) -> IntegratorRun {
        let seconds = (0..self.repeats).map(|_| {
            let (begun, mut runs) = (Instant::now(), 0);
            loop {
                // Its outcome is known: it is the same each time.
                let _ = black_box(self.end(integrator));
                runs += 1;
                let seconds = begun.elapsed().as_secs_f64();
                if seconds >= LEAST_SECONDS {
                    return seconds / f64::from(runs);
                }
            }
        });
        let seconds = median(seconds.collect());
        let apart = self.reference.end.apart_from(end);
        let Apart {
            time,
            position,
            axes,
        } = apart;
        IntegratorRun {
            seconds,
            time_error: time,
            position_error: position,
            event_error: apart.event(),
            relative_error: apart.event() / self.reference.end.size(),
            axes_error: axes,
            order: None,
        }
    }
}

impl IntegratorCost {
    /// Notes how the error fell from the row before, of the same method.
    fn set_order(&mut self, before: &Self) {
        let (Some(run), Some(run_before)) = (&mut self.run, &before.run) else {
            return;
        };
        let (Some(step), Some(step_before)) = (self.step, before.step) else {
            return;
        };
        let errors = (run.relative_error, run_before.relative_error);
        if errors.0 > ROUNDING && errors.1 > ROUNDING {
            run.order = Some((errors.0 / errors.1).ln() / (step / step_before).ln());
        }
    }
}
