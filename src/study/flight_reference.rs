//! The end of a flight to about 30 digits, by another way than that of [`Flight`].
//!
//! # Derivation
//!
//! `X' = e_0`, `e_0' = a_i e_i`, `e_i' = a_i e_0 + (w x e)_i`, in scene components. For one component of the four vectors,
//! `g` that of the four-velocity `e_0` and `p` the three of the own axes, this is `g' = a.p`, `p' = a g + p x w`: four
//! systems of one kind. In the one for the time components `g` is the Lorentz factor and `p` the observer's celerity in its
//! own axes, so that the turn rate of coordinated steering, `w = n x a / beta`, is `p x a g / (p.p)`. All functions are
//! power series in the proper time, whose coefficients follow one from the other; each step is as long as the last ones of
//! them allow.
//!
//! Nothing is shared with the closed forms: there are neither eigenvalues nor angles nor rapidities, and the numbers have
//! twice the digits.
//!
//! # Reference
//!
//! À. Jorba, M. Zou, *A software package for the numerical integration of ODEs by means of high-order Taylor methods*,
//! Exp. Math. 14 (2005), 99.

use std::array::from_fn;

use glam::DVec3;

use super::StudyError;
use super::twofold::{TWOFOLD_EPSILON, Twofold};
use crate::spacetime::{Event, Flight, Lorentz, Moment, Segment, Steering, Velocity};

/// The degree of the series.
const DEGREE: usize = 28;

/// The size of the last terms of a series, relative to the first one.
const LAST_TERM: f64 = 1e-33;

/// The largest number of steps of a flight. The second of work that they take is for some 7000 radians of turns and of
/// rapidity.
const MAX_STEPS: usize = 10_000;

/// Up to this rapidity an observer is at rest, and an acceleration of which so small a part is across the motion does not
/// turn an observer who comes to rest: what coordinated steering means there is a convention, and this is the flight's.
const AT_REST: f64 = 1e-12;
const STRAIGHT: f64 = 1e-9;

/// The end of a flight: the displacement from the start, and of each scene component those of the four-velocity and of the
/// own axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlightEnd {
    displacement: [Twofold; 4],
    rows: [Row; 4],
}

/// One scene component of the four-velocity and of the own axes x, y, z.
type Row = [Twofold; 4];

/// How far one end is from another, in scene components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Apart {
    pub(super) time: f64,
    pub(super) position: f64,
    /// The largest difference of a component of the four-velocity and the axes, over the Lorentz factor.
    pub(super) axes: f64,
}

/// The end of a flight and what it is off by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlightReference {
    pub(super) end: FlightEnd,
    /// The difference to the end by steps of twice the length, which are off by more.
    pub(super) uncertainty: Apart,
}

impl FlightReference {
    pub(super) fn new(flight: &Flight) -> Result<Self, StudyError> {
        let start = FlightEnd::start(&flight.moment(0.0).scene_to_observer());
        let coarse = start.flown(flight, 1.0)?;
        let end = start.flown(flight, 0.5)?;
        let Apart {
            time,
            position,
            axes,
        } = coarse.apart(&end);
        let least = TWOFOLD_EPSILON * end.size();
        Ok(Self {
            end,
            uncertainty: Apart {
                time: time.max(least),
                position: position.max(least),
                axes: axes.max(TWOFOLD_EPSILON),
            },
        })
    }
}

impl FlightEnd {
    /// The end of a flight without segments: what the numbers of the start say, to all digits.
    fn start(scene_to_observer: &Lorentz) -> Self {
        let velocity = scene_to_observer.boost_velocity();
        let (gamma, gamma_beta) = match velocity.rapidity() < 1.0 {
            true => Twofold::cosh_sinh(velocity.rapidity()),
            false => {
                let stretch = Twofold::from(velocity.stretch());
                let (half, back) = (Twofold::from(0.5), Twofold::ONE / stretch);
                ((stretch + back) * half, (stretch - back) * half)
            }
        };
        let ahead = unit(velocity.heading().to_array().map(Twofold::from));
        // Own axes are those of the scene, turned back and then boosted.
        let [x, y, z, w] = unit(scene_to_observer.rotation().to_array().map(Twofold::from));
        let two = Twofold::from(2.0);
        let axes = [
            [
                Twofold::ONE - two * (y * y + z * z),
                two * (x * y - w * z),
                two * (x * z + w * y),
            ],
            [
                two * (x * y + w * z),
                Twofold::ONE - two * (x * x + z * z),
                two * (y * z - w * x),
            ],
            [
                two * (x * z - w * y),
                two * (y * z + w * x),
                Twofold::ONE - two * (x * x + y * y),
            ],
        ];
        let along = axes.map(|axis| dot(axis, ahead));
        let row = |component: usize| -> Row {
            from_fn(|column| match (component, column) {
                (0, 0) => gamma,
                (0, k) => gamma_beta * along[k - 1],
                (i, 0) => gamma_beta * ahead[i - 1],
                (i, k) => axes[k - 1][i - 1] + (gamma - Twofold::ONE) * along[k - 1] * ahead[i - 1],
            })
        };
        Self {
            displacement: Default::default(),
            rows: from_fn(row),
        }
    }

    /// The end of all segments, by steps of so many times the length that the series allow.
    fn flown(mut self, flight: &Flight, step_factor: f64) -> Result<Self, StudyError> {
        let max_steps = (MAX_STEPS as f64 / step_factor) as usize;
        let mut steps = 0;
        for segment in flight.segments() {
            let coordinated = self.turns(segment);
            let mut rest = Twofold::from(segment.proper_time());
            while rest.value() > 0.0 {
                steps += 1;
                let series = Series::new(&self, segment, coordinated);
                let longest = step_factor * series.step();
                // A flight that is beyond these numbers has no step either.
                if steps > max_steps || !(longest > 0.0) {
                    return Err(StudyError::LongFlight);
                }
                let step = match rest.value() <= longest {
                    true => rest,
                    false => Twofold::from(longest),
                };
                self = series.after(&self, step);
                rest = rest - step;
            }
        }
        match self.size().is_finite() {
            true => Ok(self),
            false => Err(StudyError::LongFlight),
        }
    }

    /// Whether the steering of a segment that begins here turns the observer as the motion does.
    fn turns(&self, segment: &Segment) -> bool {
        let [_, celerity @ ..] = self.rows[0].map(Twofold::value);
        let (celerity, acceleration) = (DVec3::from_array(celerity), segment.acceleration());
        let rapidity = celerity.length().asinh();
        if segment.steering() != Steering::Coordinated || rapidity <= AT_REST {
            return false;
        }
        let ahead = celerity.normalize();
        let stops = rapidity + ahead.dot(acceleration) * segment.proper_time() <= AT_REST;
        let across = ahead.cross(acceleration).length();
        !(stops && across <= STRAIGHT * acceleration.length())
    }

    /// How far the moment is from this end, its event counted from the moment's origin.
    pub(super) fn apart_from(&self, moment: &Moment) -> Apart {
        let legs = moment.displacements_in(Velocity::ZERO);
        let displacement = legs.fold(Event::default(), |sum, leg| sum + leg);
        let velocity = moment.velocity();
        let celerity = velocity.direction() * velocity.gamma_beta();
        let [x, y, z] = moment.axes().map(components);
        let flow = components(Event::new(velocity.gamma(), celerity));
        self.apart(&Self {
            displacement: components(displacement).map(Twofold::from),
            rows: from_fn(|i| [flow[i], x[i], y[i], z[i]].map(Twofold::from)),
        })
    }

    /// How far another end is from this one.
    fn apart(&self, other: &Self) -> Apart {
        let [time, x, y, z] = from_fn(|i| (other.displacement[i] - self.displacement[i]).value());
        let pairs = self.rows.iter().flatten().zip(other.rows.iter().flatten());
        let largest = pairs
            .map(|(a, b)| (*b - *a).value().abs())
            .fold(0.0, f64::max);
        Apart {
            time: time.abs(),
            position: DVec3::new(x, y, z).length(),
            axes: largest / self.gamma(),
        }
    }

    /// The displacement in the scene frame, rounded.
    pub(super) fn displacement(&self) -> Event {
        let [time, x, y, z] = self.displacement.map(Twofold::value);
        Event::new(time, DVec3::new(x, y, z))
    }

    /// The Lorentz factor in the scene frame.
    pub(super) fn gamma(&self) -> f64 {
        self.rows[0][0].value()
    }

    /// The length of the displacement, in time and space alike.
    pub(super) fn size(&self) -> f64 {
        let Event { time, position } = self.displacement();
        time.hypot(position.length())
    }
}

impl Apart {
    /// In time and space alike.
    pub(super) fn event(&self) -> f64 {
        self.time.hypot(self.position)
    }
}

/// Power series of all rows in the proper time from some moment on, which is in units of `1 / rate`.
struct Series {
    /// A power of two near the largest rate of change.
    rate: f64,
    rows: [Vec<Row>; 4],
}

impl Series {
    fn new(begin: &FlightEnd, segment: &Segment, coordinated: bool) -> Self {
        let [gamma, celerity @ ..] = begin.rows[0];
        let turn_rate = match segment.steering() {
            _ if coordinated => {
                let celerity = DVec3::from_array(celerity.map(Twofold::value));
                let squared = celerity.length_squared();
                celerity.cross(segment.acceleration()) / squared * gamma.value()
            }
            Steering::Free { turn_rate } => turn_rate,
            Steering::Coordinated => DVec3::ZERO,
        };
        let largest = segment.acceleration().abs().max(turn_rate.abs());
        let rate = match largest.max_element() {
            0.0 => 1.0 / segment.proper_time(),
            largest => largest,
        };
        let rate = rate.log2().ceil().exp2();
        let a = (segment.acceleration() / rate)
            .to_array()
            .map(Twofold::from);
        let mut turn = match coordinated {
            true => vec![],
            false => vec![(turn_rate / rate).to_array().map(Twofold::from)],
        };
        let mut rows = begin.rows.map(|row| {
            let mut coefficients = Vec::with_capacity(DEGREE + 1);
            coefficients.push(row);
            coefficients
        });
        let mut turning = Turning::default();
        for degree in 0..DEGREE {
            if coordinated {
                turn.push(turning.next(&rows[0], a));
            }
            let over = Twofold::ONE / Twofold::from((degree + 1) as f64);
            for row in &mut rows {
                let [g, p @ ..] = row[degree];
                let mut slope = a.map(|a| a * g);
                for (turn, [_, p @ ..]) in turn.iter().zip(row.iter().rev()) {
                    let turned = cross(*p, *turn);
                    slope = from_fn(|i| slope[i] + turned[i]);
                }
                let [x, y, z] = slope;
                row.push([dot(a, p), x, y, z].map(|slope| slope * over));
            }
        }
        Self { rate, rows }
    }

    /// The longest proper time for which the series are right to all digits: the last two of their terms are then small.
    fn step(&self) -> f64 {
        let size = |degree: usize| {
            let row = self.rows.iter().flat_map(|row| row[degree]);
            row.map(|number| number.value().abs()).fold(0.0, f64::max)
        };
        let first = size(0);
        let longest = [DEGREE - 1, DEGREE]
            .map(|degree| (LAST_TERM * first / size(degree)).powf(1.0 / degree as f64));
        longest[0].min(longest[1]) / self.rate
    }

    /// The end of a flight that goes on from `begin` for a step.
    fn after(&self, begin: &FlightEnd, step: Twofold) -> FlightEnd {
        let time = step * Twofold::from(self.rate);
        let mut end = *begin;
        for component in 0..4 {
            let mut row = Row::default();
            let mut way = Twofold::default();
            for (degree, coefficients) in self.rows[component].iter().enumerate().rev() {
                row = from_fn(|i| row[i] * time + coefficients[i]);
                way = way * time + coefficients[0] / Twofold::from((degree + 1) as f64);
            }
            end.rows[component] = row;
            end.displacement[component] = end.displacement[component] + way * step;
        }
        end
    }
}

/// The turn rate of coordinated steering as a power series, `(p x a) g / (p.p)`.
#[derive(Default)]
struct Turning {
    squares: Vec<Twofold>,
    /// `g / (p.p)`
    quotients: Vec<Twofold>,
}

impl Turning {
    /// The next coefficient, from the time components up to its degree and the acceleration.
    fn next(&mut self, times: &[Row], a: [Twofold; 3]) -> [Twofold; 3] {
        let degree = times.len() - 1;
        let celerity = |degree: usize| -> [Twofold; 3] { from_fn(|i| times[degree][i + 1]) };
        let products = (0..=degree).map(|i| dot(celerity(i), celerity(degree - i)));
        self.squares
            .push(products.fold(Twofold::default(), |sum, product| sum + product));
        let known = self.quotients.iter().zip(self.squares.iter().rev());
        let rest = known.fold(times[degree][0], |rest, (quotient, square)| {
            rest - *quotient * *square
        });
        self.quotients.push(rest / self.squares[0]);
        let mut sum = [Twofold::default(); 3];
        for (i, quotient) in self.quotients.iter().enumerate() {
            let across = cross(celerity(degree - i), a);
            sum = from_fn(|k| sum[k] + across[k] * *quotient);
        }
        sum
    }
}

fn components(event: Event) -> [f64; 4] {
    let Event { time, position } = event;
    [time, position.x, position.y, position.z]
}

fn dot(a: [Twofold; 3], b: [Twofold; 3]) -> Twofold {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [Twofold; 3], b: [Twofold; 3]) -> [Twofold; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The vector over its length.
fn unit<const N: usize>(vector: [Twofold; N]) -> [Twofold; N] {
    let squares = vector.iter().map(|x| *x * *x);
    let length = squares
        .fold(Twofold::default(), |sum, square| sum + square)
        .sqrt();
    vector.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spacetime::Integrator;

    /// 17/8 in Lorentz factor: the stretch is 4, and all numbers of the start are exact.
    fn reference(from_rest: bool, segments: Vec<Segment>) -> FlightReference {
        let velocity = match from_rest {
            true => Velocity::ZERO,
            false => Velocity::from_gamma(2.125, DVec3::X).unwrap(),
        };
        assert!([1.0, 4.0].contains(&velocity.stretch()));
        let start = Moment::new(Event::default(), Lorentz::boost(velocity));
        let flight = Flight::new(start, segments, Integrator::Exact).unwrap();
        FlightReference::new(&flight).unwrap()
    }

    fn free(proper_time: f64, acceleration: DVec3, turn_rate: DVec3) -> Segment {
        Segment::free(proper_time, acceleration, turn_rate).unwrap()
    }

    #[track_caller]
    fn assert_30_digits(found: Twofold, expected: Twofold) {
        let off = (found - expected).value().abs();
        assert!(
            off <= 1e-29 * expected.value().abs().max(1.0),
            "{found:?} {expected:?}"
        );
    }

    /// The type of which all functions are polynomials.
    #[test]
    fn the_null_type_is_a_polynomial() {
        let end = reference(true, vec![free(3.0, DVec3::X, DVec3::Z)]).end;
        let expected = [7.5, 4.5, 4.5, 0.0].map(Twofold::from);
        let velocity = [5.5, 3.0, 4.5, 0.0].map(Twofold::from);
        for i in 0..4 {
            assert_30_digits(end.displacement[i], expected[i]);
            assert_30_digits(end.rows[i][0], velocity[i]);
        }
    }

    /// Thrust of 1 for a proper time of 1: the hyperbolic sine and cosine of 1, to 32 digits in two numbers each.
    #[test]
    fn a_rocket_flies_a_hyperbola() {
        let FlightReference { end, uncertainty } =
            reference(true, vec![free(1.0, DVec3::X, DVec3::ZERO)]);
        let number = |high: f64, low: f64| Twofold::from(high) + Twofold::from(low);
        let sinh = number(1.175_201_193_643_801_4, 7.849_672_142_285_669e-17);
        let cosh = number(1.543_080_634_815_243_7, 6.606_796_775_006_833e-17);
        assert_30_digits(end.displacement[0], sinh);
        assert_30_digits(end.displacement[1], cosh - Twofold::ONE);
        assert_30_digits(end.rows[0][0], cosh);
        assert_30_digits(end.rows[0][1], sinh);
        let estimate = uncertainty.event().max(uncertainty.axes);
        assert!((1e-32..1e-29).contains(&estimate), "{uncertainty:?}");
    }

    /// Coordinated steering at constant speed, 15/17, has the turn rate 17/15 of the acceleration.
    #[test]
    fn coordinated_steering_leads_around_a_circle() {
        let acceleration = DVec3::Y * 0.9375;
        let steered = Segment::coordinated(7.0, acceleration).unwrap();
        let steered = reference(false, vec![steered]);
        let turned = reference(false, vec![free(7.0, acceleration, DVec3::Z * 1.0625)]);
        let apart = steered.end.apart(&turned.end);
        assert!(apart.event().max(apart.axes) < 1e-28, "{apart:?}");
    }

    /// Where the speed changes, the rapidity grows by what the acceleration along the motion adds: the stretch, 4 in the
    /// beginning, by `e`.
    #[test]
    fn coordinated_steering_keeps_the_direction_of_motion() {
        let steered = Segment::coordinated(4.0, DVec3::new(0.25, 0.5, -0.75)).unwrap();
        let FlightReference { end, uncertainty } = reference(false, vec![steered]);
        let (cosh, sinh) = Twofold::cosh_sinh(1.0);
        let (four, half) = (Twofold::from(4.0), Twofold::from(0.5));
        let (stretch, back) = (four * (cosh + sinh), (cosh - sinh) / four);
        let [gamma, ahead, up, right] = end.rows[0];
        assert_30_digits(gamma, (stretch + back) * half);
        assert_30_digits(ahead, (stretch - back) * half);
        assert!(up.value().abs().max(right.value().abs()) < 1e-29, "{end:?}");
        assert!(uncertainty.event() < 1e-28, "{uncertainty:?}");
    }

    #[test]
    fn steering_at_rest_is_straight() {
        let thrust = DVec3::new(0.5, 0.0, 0.25);
        let steered = reference(true, vec![Segment::coordinated(2.0, thrust).unwrap()]);
        let straight = reference(true, vec![free(2.0, thrust, DVec3::ZERO)]);
        assert_eq!(steered.end, straight.end);
        // Through rest and back along the same line.
        let brake = Segment::coordinated(8.0, DVec3::NEG_X).unwrap();
        let braked = reference(false, vec![brake]);
        let straight = reference(false, vec![free(8.0, DVec3::NEG_X, DVec3::ZERO)]);
        assert_eq!(braked.end, straight.end);
    }
}
