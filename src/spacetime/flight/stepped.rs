//! Flight step by step: the methods of Euler and of Runge and Kutta, which show what accuracy costs.
//!
//! They integrate the tetrad and the place in the observer's frame at the beginning, `dL/dtau = L K`, `dX/dtau = L e_0`,
//! and keep no law of conservation: what Euler's four-velocity loses of its length is part of its error.

use glam::{DMat3, DQuat, DVec3};

use super::error::MAX_STEPS;
use super::{FlightError, Segment, Steering};
use crate::spacetime::{Event, Lorentz, MAX_RAPIDITY, Moment, Rotation, Velocity, length, unit};

/// So many steps lie between two states that are kept.
const KEPT: usize = 1024;

/// A method that takes steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    Euler,
    RungeKutta4,
}

/// The states of a flight at some of its steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stepped {
    method: Method,
    step: f64,
    /// The scene's four-velocity in the observer's frame at the beginning.
    scene_start: [f64; 4],
    /// For each segment its beginning and the states kept in it, the first at its beginning.
    segments: Vec<(Segment, Vec<State>)>,
    end: State,
}

/// Place and tetrad in the observer's frame at the beginning: the four-velocity and the observer's own axes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    place: [f64; 4],
    tetrad: [[f64; 4]; 4],
}

/// The change of a state, per proper time.
type Slope = State;

impl Stepped {
    /// All steps of a flight that begins in the frame of `scene_to_start`.
    pub(super) fn new(
        scene_to_start: &Lorentz,
        segments: &[Segment],
        method: Method,
        step: f64,
    ) -> Result<Self, FlightError> {
        let counts = segments
            .iter()
            .map(|segment| (segment.proper_time() / step).ceil());
        let steps: f64 = counts.sum();
        if !(steps <= MAX_STEPS) {
            return Err(FlightError::Steps { steps });
        }
        let scene = scene_to_start.inverse().boost_velocity();
        let [x, y, z] = (scene.direction() * scene.gamma_beta()).to_array();
        let mut stepped = Self {
            method,
            step,
            scene_start: [scene.gamma(), x, y, z],
            segments: Vec::with_capacity(segments.len()),
            end: State::START,
        };
        for (index, segment) in segments.iter().enumerate() {
            let mut kept = vec![stepped.end];
            stepped.end = stepped.advanced(
                stepped.end,
                segment,
                segment.proper_time(),
                |count, state| {
                    if count % KEPT == 0 {
                        kept.push(*state);
                    }
                },
            );
            stepped.segments.push((*segment, kept));
            let rapidity = scene_to_start
                .then(&stepped.end.own_to_next())
                .boost_velocity()
                .rapidity();
            if !(rapidity <= MAX_RAPIDITY && stepped.end.is_finite()) {
                return Err(FlightError::TooFast {
                    segment: index,
                    rapidity,
                });
            }
        }
        Ok(stepped)
    }

    /// The observer who flew so from `start`, `proper_time` after the beginning of a segment.
    pub(super) fn moment(&self, start: &Moment, segment: usize, proper_time: f64) -> Moment {
        let (segment, kept) = &self.segments[segment];
        let between = self.step * KEPT as f64;
        let index = ((proper_time / between) as usize).min(kept.len() - 1);
        let rest = (proper_time - index as f64 * between).max(0.0);
        let state = self.advanced(kept[index], segment, rest, |_, _| ());
        start.flown(state.displacement(), &state.own_to_next())
    }

    /// The observer at the end of the last segment.
    pub(super) fn end(&self, start: &Moment) -> Moment {
        start.flown(self.end.displacement(), &self.end.own_to_next())
    }

    /// A state after so much proper time of a segment, in steps of which the last may be shorter; `kept` hears of each
    /// full one.
    fn advanced(
        &self,
        mut state: State,
        segment: &Segment,
        proper_time: f64,
        mut kept: impl FnMut(usize, &State),
    ) -> State {
        // What rounding leaves of the last step is not a step.
        let full = (proper_time / self.step + 1e-9).floor();
        for count in 1..=full as usize {
            state = self.stepped(state, segment, self.step);
            kept(count, &state);
        }
        let rest = proper_time - full * self.step;
        match full == 0.0 || rest > 1e-9 * self.step {
            true => self.stepped(state, segment, rest),
            false => state,
        }
    }

    fn stepped(&self, state: State, segment: &Segment, step: f64) -> State {
        let slope = |state: &State| state.slope(segment, &self.scene_start);
        match self.method {
            Method::Euler => state.plus(&slope(&state), step),
            Method::RungeKutta4 => {
                let first = slope(&state);
                let second = slope(&state.plus(&first, 0.5 * step));
                let third = slope(&state.plus(&second, 0.5 * step));
                let fourth = slope(&state.plus(&third, step));
                let ends = state.plus(&first, step / 6.0).plus(&fourth, step / 6.0);
                ends.plus(&second, step / 3.0).plus(&third, step / 3.0)
            }
        }
    }
}

impl State {
    const START: Self = Self {
        place: [0.0; 4],
        tetrad: [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
    };

    fn plus(&self, slope: &Slope, step: f64) -> Self {
        let sum = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|i| a[i] + step * b[i]);
        Self {
            place: sum(self.place, slope.place),
            tetrad: std::array::from_fn(|k| sum(self.tetrad[k], slope.tetrad[k])),
        }
    }

    /// `dX/dtau = e_0`, `de_0/dtau = a_i e_i`, `de_i/dtau = a_i e_0 + (w x e)_i`.
    fn slope(&self, segment: &Segment, scene: &[f64; 4]) -> Slope {
        let acceleration = segment.acceleration();
        let turn_rate = match segment.steering() {
            Steering::Free { turn_rate } => turn_rate,
            Steering::Coordinated => self.coordinated_turn_rate(acceleration, scene),
        };
        let [flow, axes @ ..] = self.tetrad;
        let combined = |weights: DVec3| -> [f64; 4] {
            let weights = weights.to_array();
            std::array::from_fn(|i| (0..3).map(|k| weights[k] * axes[k][i]).sum())
        };
        let turned = DVec3::AXES.map(|axis| combined(turn_rate.cross(axis)));
        let boosted = acceleration.to_array();
        Slope {
            place: flow,
            tetrad: [
                combined(acceleration),
                std::array::from_fn(|i| boosted[0] * flow[i] + turned[0][i]),
                std::array::from_fn(|i| boosted[1] * flow[i] + turned[1][i]),
                std::array::from_fn(|i| boosted[2] * flow[i] + turned[2][i]),
            ],
        }
    }

    /// `w = n x a / beta`, from the scene's four-velocity in the observer's own axes; zero at rest.
    fn coordinated_turn_rate(&self, acceleration: DVec3, scene: &[f64; 4]) -> DVec3 {
        let product = |axis: &[f64; 4]| {
            let space: f64 = (1..4).map(|i| axis[i] * scene[i]).sum();
            space - axis[0] * scene[0]
        };
        let [flow, axes @ ..] = &self.tetrad;
        let scene_own = DVec3::from_array(std::array::from_fn(|k| product(&axes[k])));
        match unit(-scene_own) {
            Some(ahead) => ahead.cross(acceleration) * (-product(flow) / length(scene_own)),
            None => DVec3::ZERO,
        }
    }

    fn is_finite(&self) -> bool {
        let numbers = self.tetrad.iter().flatten().chain(&self.place);
        numbers.copied().all(f64::is_finite)
    }

    fn displacement(&self) -> Event {
        let [time, x, y, z] = self.place;
        Event::new(time, DVec3::new(x, y, z))
    }

    /// The Lorentz transformation that is nearest: the boost to the celerity, and the rotation that is nearest to what the
    /// boost back leaves of the axes.
    fn own_to_next(&self) -> Lorentz {
        let [[_, x, y, z], axes @ ..] = self.tetrad;
        let celerity = DVec3::new(x, y, z);
        let velocity = Velocity::of_celerity(celerity);
        // The boost back of what is across the four-velocity: x - t celerity / (1 + gamma).
        let back = celerity / (1.0 + velocity.gamma());
        let axes = axes.map(|[time, x, y, z]| DVec3::new(x, y, z) - back * time);
        let turn = DQuat::from_mat3(&orthonormal(axes));
        Lorentz::boost(velocity).turned(Rotation::of_any_length(turn.inverse()))
    }
}

/// The axes made orthogonal and of unit length, those first that differ least.
fn orthonormal([x, y, z]: [DVec3; 3]) -> DMat3 {
    // Newton's iteration for the orthogonal polar factor: N. J. Higham, SIAM J. Sci. Stat. Comput. 7 (1986), 1160.
    let mut matrix = DMat3::from_cols(x, y, z);
    for _ in 0..40 {
        let next = (matrix + matrix.inverse().transpose()) * 0.5;
        let change = (next - matrix)
            .to_cols_array()
            .into_iter()
            .map(f64::abs)
            .fold(0.0, f64::max);
        matrix = next;
        if !(change > 1e-15) {
            break;
        }
    }
    match matrix.is_finite() {
        true => matrix,
        false => DMat3::IDENTITY,
    }
}
