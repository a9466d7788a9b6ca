//! The coordinated turn: the direction of motion keeps its place in the observer's own axes.
//!
//! # Derivation
//!
//! Let `n` be the direction of motion in the observer's own axes, `a_par` and `a_perp` the parts of the acceleration
//! along and across it, `eta` the rapidity in the scene frame. With the turn rate `w = n x a_perp / beta` the four-velocity
//! of the scene in the observer's own axes, `(cosh eta, -sinh eta n)`, changes by `eta' = a_par` alone. In the scene the
//! direction of motion turns by `phi' = a_perp / sinh(eta)` about `b = n x a_perp / |a_perp|`, so that
//!
//! ```text
//! eta = eta0 + a_par tau,      phi = a_perp / a_par  ln( tanh(eta / 2) / tanh(eta0 / 2) )
//! ```
//!
//! and the axes, which a pure boost makes of those of the scene turned by `phi` about `b`, are known in closed form. The
//! place is the integral of `sinh(eta) (n cos phi + c sin phi)`, `c = a_perp / |a_perp|`: elementary at constant speed, a
//! circle; otherwise by Gauss and Legendre's rule of 16 points on pieces so short that it is right to rounding.

use glam::{DQuat, DVec3};

use super::error::MAX_TURN_AT_CHANGING_SPEED;
use super::smooth::{sinc_below_1, sinhc};
use crate::spacetime::{Event, Lorentz, Rotation, length, unit};

/// Up to this rapidity an observer is at rest: what is left of a speed that an earlier segment took away.
const AT_REST: f64 = 1e-12;

/// An acceleration whose part across the motion is so much smaller than the whole one does not turn an observer who
/// comes to rest: it is what rounding leaves of a straight one.
const STRAIGHT: f64 = 1e-9;

/// A coordinated turn, from the observer's velocity at its beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coordinated {
    start: Lorentz,
    /// Direction of motion and that of the acceleration across it, both in the observer's own axes at the beginning.
    ahead_own: DVec3,
    aside_own: DVec3,
    rapidity: f64,
    along: f64,
    across: f64,
}

/// How an observer flies who is steered so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// Without turning: at rest, or straight ahead.
    Straight,
    /// In a turn.
    Turn(Coordinated),
    /// To a stop in a turn, where its turn rate would be infinite.
    Stop,
}

/// The end of a part of the turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turned {
    /// To the frame in which the displacement is given.
    pub(super) scene_to_frame: Lorentz,
    /// The displacement from the beginning.
    pub(super) displacement_frame: Event,
    /// To the observer's frame at the end.
    pub(super) scene_to_end: Lorentz,
}

impl Course {
    /// The course of an observer in the frame of `scene_to_start`, with this acceleration in its own axes for so much
    /// proper time.
    pub(super) fn new(scene_to_start: &Lorentz, acceleration: DVec3, proper_time: f64) -> Self {
        let velocity = scene_to_start.boost_velocity();
        let ahead_own = scene_to_start.rotation() * velocity.direction();
        let along = acceleration.dot(ahead_own);
        let sideways = acceleration - ahead_own * along;
        let across = length(sideways);
        let rapidity = velocity.rapidity();
        let (Some(aside_own), true) = (unit(sideways), rapidity > AT_REST) else {
            return Self::Straight;
        };
        if rapidity + along * proper_time <= AT_REST {
            return match across <= STRAIGHT * length(acceleration) {
                true => Self::Straight,
                false => Self::Stop,
            };
        }
        Self::Turn(Coordinated {
            start: *scene_to_start,
            ahead_own,
            aside_own,
            rapidity,
            along,
            across,
        })
    }
}

impl Course {
    /// The turn rate at the beginning, in the observer's own axes.
    pub(super) fn turn_rate(&self) -> DVec3 {
        match self {
            Self::Straight | Self::Stop => DVec3::ZERO,
            Self::Turn(turn) => turn.turn_rate(),
        }
    }
}

impl Coordinated {
    /// The angle, in radians, by which the direction of motion has turned in the scene after `proper_time`.
    pub(super) fn angle(&self, proper_time: f64) -> f64 {
        let gained = self.along * proper_time;
        // tanh(eta/2) / tanh(eta0/2) = 1 + sinh(gained/2) / (cosh(eta/2) sinh(eta0/2))
        let (half, later) = (0.5 * self.rapidity, 0.5 * (self.rapidity + gained));
        let per_gained = 0.5 * sinhc(0.5 * gained.abs()) / (later.cosh() * half.sinh());
        let logarithm = match per_gained * gained {
            0.0 => 1.0,
            ratio => ratio.ln_1p() / ratio,
        };
        self.across * proper_time * per_gained * logarithm
    }

    /// The rapidity in the scene after `proper_time`.
    pub(super) fn rapidity(&self, proper_time: f64) -> f64 {
        self.rapidity + self.along * proper_time
    }

    /// Whether the speed changes in a turn of more than [`MAX_TURN_AT_CHANGING_SPEED`].
    pub(super) fn turns_too_much(&self, proper_time: f64) -> bool {
        self.along * proper_time != 0.0 && !(self.angle(proper_time) <= MAX_TURN_AT_CHANGING_SPEED)
    }

    fn turn_rate(&self) -> DVec3 {
        self.ahead_own.cross(self.aside_own) * (self.across / self.rapidity.tanh())
    }

    /// The observer after `proper_time`.
    pub(super) fn after(&self, proper_time: f64) -> Turned {
        let angle = self.angle(proper_time);
        let axis_own = self.ahead_own.cross(self.aside_own);
        let own_to_scene_axes = self.start.rotation().inverse();
        let turn_scene = DQuat::from_axis_angle((own_to_scene_axes * axis_own).normalize(), angle);
        let velocity = self.start.boost_velocity();
        let gained = self.along * proper_time;
        let stretch = velocity.stretch() * gained.exp();
        let velocity = velocity
            .with_signed_rapidity(self.rapidity(proper_time), stretch)
            .turned(turn_scene);
        let rotation = self.start.rotation() * turn_scene.inverse();
        let scene_to_end = Lorentz::boost(velocity).turned(Rotation::of_any_length(rotation));
        // Beside something as fast as itself the observer moves little while it turns little.
        let turns_little = angle * self.rapidity.max(self.rapidity(proper_time)).sinh() <= 1.0;
        let (scene_to_frame, celerity_0) = match turns_little {
            true => (self.start, Some(self.rapidity)),
            false => {
                let scene_axes = Rotation::of_any_length(self.start.rotation());
                (Lorentz::IDENTITY.turned(scene_axes), None)
            }
        };
        Turned {
            scene_to_frame,
            displacement_frame: self.displacement(proper_time, celerity_0),
            scene_to_end,
        }
    }

    /// The displacement in the frame of the scene with axes turned as the observer's at the beginning, or, with the
    /// `rapidity` there, in the observer's frame at the beginning.
    fn displacement(&self, proper_time: f64, rapidity: Option<f64>) -> Event {
        let (time, ahead, aside) = match self.along * proper_time == 0.0 {
            true => self.circle(proper_time, rapidity),
            false => self.integral(proper_time, rapidity),
        };
        Event::new(time, self.ahead_own * ahead + self.aside_own * aside)
    }

    /// At constant speed: time, and the way ahead and aside.
    fn circle(&self, proper_time: f64, rapidity: Option<f64>) -> (f64, f64, f64) {
        let angle = self.angle(proper_time);
        let (sinh, cosh) = (self.rapidity.sinh(), self.rapidity.cosh());
        let sinc = 1.0 - sinc_below_1(angle);
        // (1 - cos phi) / phi
        let aside = match angle {
            0.0 => 0.0,
            angle => 2.0 * (0.5 * angle).sin().powi(2) / angle,
        };
        let (time, ahead) = match rapidity {
            None => (cosh, sinh * sinc),
            Some(_) => {
                let late = sinc_below_1(angle);
                (1.0 + sinh * sinh * late, -cosh * sinh * late)
            }
        };
        (
            time * proper_time,
            ahead * proper_time,
            sinh * aside * proper_time,
        )
    }

    /// At changing speed.
    fn integral(&self, proper_time: f64, rapidity: Option<f64>) -> (f64, f64, f64) {
        let mut sum = (0.0, 0.0, 0.0);
        let mut pieces = vec![(0.0, proper_time)];
        while let Some((from, to)) = pieces.pop() {
            let middle = from + 0.5 * (to - from);
            if !self.is_short(from, to) && middle > from && middle < to {
                pieces.extend([(middle, to), (from, middle)]);
                continue;
            }
            let half = 0.5 * (to - from);
            for (node, weight) in GAUSS_LEGENDRE_16 {
                for sign in [-1.0, 1.0] {
                    let (time, ahead, aside) =
                        self.four_velocity(middle + sign * node * half, rapidity);
                    let weight = weight * half;
                    sum.0 += weight * time;
                    sum.1 += weight * ahead;
                    sum.2 += weight * aside;
                }
            }
        }
        sum
    }

    /// Whether the rule is right to rounding on a piece: far enough from rest, where the turn rate is infinite, and from
    /// the poles of the hyperbolic functions.
    fn is_short(&self, from: f64, to: f64) -> bool {
        let (start, end) = (self.rapidity(from), self.rapidity(to));
        let gained = (end - start).abs();
        gained <= start.min(end) && gained <= 1.0 && self.angle(to) - self.angle(from) <= 1.0
    }

    /// The four-velocity: time, ahead, aside.
    fn four_velocity(&self, proper_time: f64, rapidity: Option<f64>) -> (f64, f64, f64) {
        let (now, angle) = (self.rapidity(proper_time), self.angle(proper_time));
        let (sinh, gained) = (now.sinh(), self.along * proper_time);
        match rapidity {
            None => (now.cosh(), sinh * angle.cos(), sinh * angle.sin()),
            Some(first) => {
                let late = 2.0 * (0.5 * angle).sin().powi(2) * sinh;
                (
                    gained.cosh() + first.sinh() * late,
                    gained.sinh() - first.cosh() * late,
                    sinh * angle.sin(),
                )
            }
        }
    }
}

/// Nodes and weights of Gauss and Legendre's rule of 16 points on [-1, 1]; each node stands for its negative too.
///
/// Reference: M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, table 25.4.
#[rustfmt::skip]
const GAUSS_LEGENDRE_16: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_59),
    (0.458_016_777_657_227_39, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_8, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_79),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_893),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];
