//! How a flight is computed.

use thiserror::Error;

/// How a flight is computed from its accelerations.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Integrator {
    /// By closed forms, to rounding.
    #[default]
    Exact,
    /// By Euler's method, as Rau, Weiskopf and Ruder do: errors as the step. Nothing says whether the step is short enough.
    Euler(Step),
    /// By the classical method of Runge and Kutta: errors as the fourth power of the step. Nothing says whether the step is
    /// short enough.
    RungeKutta4(Step),
}

/// The proper time of one step of an integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step(f64);

/// Why a number is not the step of an integrator.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the step is {0}, expected a finite proper time > 0")]
pub struct IntegratorError(f64);

impl Integrator {
    /// [`Integrator::Euler`] with steps of `proper_time`.
    ///
    /// # Errors
    ///
    /// A step that is not finite and above zero.
    pub fn euler(proper_time: f64) -> Result<Self, IntegratorError> {
        Step::new(proper_time).map(Self::Euler)
    }

    /// [`Integrator::RungeKutta4`] with steps of `proper_time`.
    ///
    /// # Errors
    ///
    /// A step that is not finite and above zero.
    pub fn runge_kutta_4(proper_time: f64) -> Result<Self, IntegratorError> {
        Step::new(proper_time).map(Self::RungeKutta4)
    }
}

impl Step {
    fn new(proper_time: f64) -> Result<Self, IntegratorError> {
        match proper_time > 0.0 && proper_time.is_finite() {
            true => Ok(Self(proper_time)),
            false => Err(IntegratorError(proper_time)),
        }
    }

    /// The proper time of one step.
    pub fn get(self) -> f64 {
        self.0
    }
}
