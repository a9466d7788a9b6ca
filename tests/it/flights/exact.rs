//! Flights by closed forms against an integration with 256 bits, and against themselves in other segments.
//!
//! # What rounding may do
//!
//! A rounding at segment `k` of relative size `epsilon` in the frame there changes what follows by
//! `L_k epsilon (displacement or four-velocity from there on, in that frame)`, where the Lorentz matrix `L_k` back to the
//! scene stretches by at most `exp(eta_k)`. The *natural scale* of a result is the sum of these over all segments, each
//! times one more than the angle and the rapidity that the segment goes through, which are themselves known to rounding.
//! The tests allow [`ULPS`] units in the last place of it.

use dashu_float::{FBig, round::mode::HalfEven};
use photosurface::light_cone::View;
use photosurface::scene::Rotation;
use photosurface::spacetime::{
    Event, Flight, FlightError, Integrator, Lorentz, Segment, Steering, WorldLine,
};
use photosurface::{DQuat, DVec3, Moment, Velocity};

use crate::common::{Random, Worst};

pub(super) type Big = FBig<HalfEven, 2>;

/// Units in the last place of the natural scale; the worst seen is 1.5.
const ULPS: f64 = 2.0;

/// 77 digits, of which `exp(2 * 40)` takes 35.
const BITS: usize = 256;

pub(super) fn big(value: f64) -> Big {
    let exact = Big::try_from(value).expect("finite");
    exact.with_precision(BITS).value()
}

pub(super) fn small(value: &Big) -> f64 {
    value.to_f64().value()
}

/// The observer's four-velocity and axes, and its place, as columns in the scene frame.
#[derive(Clone)]
pub(super) struct State([[Big; 5]; 4]);

impl State {
    /// The axes of a pure boost, turned.
    pub(super) fn new(velocity: Velocity, rotation: DQuat) -> Self {
        let growth = big(velocity.rapidity()).exp();
        let shrink = big(1.0) / &growth;
        let (gamma, celerity) = (
            (growth.clone() + &shrink) / big(2.0),
            (growth - shrink) / big(2.0),
        );
        let n = velocity.heading().to_array().map(big);
        let square: Big = n.iter().fold(big(0.0), |sum, x| sum + x.clone() * x);
        let length = square.sqrt();
        let n = n.map(|x| x / &length);
        let boosted = |v: [Big; 3]| -> [Big; 4] {
            let along = (0..3).fold(big(0.0), |sum, i| sum + n[i].clone() * &v[i]);
            let space = |i: usize| v[i].clone() + (gamma.clone() - big(1.0)) * &along * &n[i];
            [celerity.clone() * &along, space(0), space(1), space(2)]
        };
        let [x, y, z, w] = rotation.to_array().map(big);
        let square = [&x, &y, &z, &w]
            .iter()
            .fold(big(0.0), |sum, &q| sum + q.clone() * q);
        let two = big(2.0) / square;
        let one = || big(1.0);
        let axes = [
            [
                one() - two.clone() * (y.clone() * &y + z.clone() * &z),
                two.clone() * (x.clone() * &y + z.clone() * &w),
                two.clone() * (x.clone() * &z - y.clone() * &w),
            ],
            [
                two.clone() * (x.clone() * &y - z.clone() * &w),
                one() - two.clone() * (x.clone() * &x + z.clone() * &z),
                two.clone() * (y.clone() * &z + x.clone() * &w),
            ],
            [
                two.clone() * (x.clone() * &z + y.clone() * &w),
                two.clone() * (y.clone() * &z - x.clone() * &w),
                one() - two * (x.clone() * &x + y.clone() * &y),
            ],
        ];
        let axes = axes.map(boosted);
        let row = |i: usize| {
            let flow = match i {
                0 => gamma.clone(),
                i => celerity.clone() * &n[i - 1],
            };
            let [a, b, c] = &axes;
            [flow, a[i].clone(), b[i].clone(), c[i].clone(), big(0.0)]
        };
        Self([row(0), row(1), row(2), row(3)])
    }

    /// After `proper_time` of constant acceleration and turn rate: times the exponential of
    /// `[[K, e_0], [0, 0]] proper_time`.
    fn after(&self, acceleration: [Big; 3], turn_rate: [Big; 3], proper_time: &Big) -> Self {
        let zero = || big(0.0);
        let [a, w] = [&acceleration, &turn_rate].map(|v| v.clone().map(|x| x * proper_time));
        let generator = [
            [
                zero(),
                a[0].clone(),
                a[1].clone(),
                a[2].clone(),
                proper_time.clone(),
            ],
            [a[0].clone(), zero(), -w[2].clone(), w[1].clone(), zero()],
            [a[1].clone(), w[2].clone(), zero(), -w[0].clone(), zero()],
            [a[2].clone(), -w[1].clone(), w[0].clone(), zero(), zero()],
            std::array::from_fn(|_| zero()),
        ];
        let size = generator
            .iter()
            .flatten()
            .map(|x| small(x).abs())
            .fold(0.0, f64::max);
        let halvings = (size.log2().ceil() + 6.0).max(0.0) as i32;
        let part = big(2f64.powi(-halvings));
        let generator = generator.map(|row| row.map(|x| x * &part));
        // I + G (I + G/2 (I + G/3 ...)); entries below 2^-5 after scaling.
        let mut exponential = identity();
        for term in (1..=34).rev() {
            exponential = product(&generator, &exponential);
            for (i, row) in exponential.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    let one = if i == j { 1.0 } else { 0.0 };
                    *entry = entry.clone() / big(f64::from(term)) + big(one);
                }
            }
        }
        for _ in 0..halvings {
            exponential = product(&exponential, &exponential);
        }
        Self(std::array::from_fn(|i| times(&self.0[i], &exponential)))
    }

    fn during(&self, segment: &Segment, proper_time: &Big) -> Self {
        let Steering::Free { turn_rate } = segment.steering() else {
            panic!("coordinated steering has tests of its own");
        };
        let [a, w] = [segment.acceleration(), turn_rate].map(|v| v.to_array().map(big));
        self.after(a, w, proper_time)
    }

    pub(super) fn column(&self, k: usize) -> [Big; 4] {
        std::array::from_fn(|i| self.0[i][k].clone())
    }

    /// `later - self` in this observer's frame: products with its axes.
    fn displacement_own(&self, later: &Self) -> [f64; 4] {
        let [from, to] = [self, later].map(|state| state.column(4));
        let difference: [Big; 4] = std::array::from_fn(|i| to[i].clone() - &from[i]);
        self.components(&difference)
    }

    pub(super) fn components(&self, vector: &[Big; 4]) -> [f64; 4] {
        std::array::from_fn(|k| {
            let axis = self.column(k);
            let space = (1..4).fold(big(0.0), |sum, i| sum + axis[i].clone() * &vector[i]);
            let product = space - axis[0].clone() * &vector[0];
            small(&product) * if k == 0 { -1.0 } else { 1.0 }
        })
    }

    fn gamma(&self) -> f64 {
        small(&self.0[0][0])
    }
}

fn identity() -> [[Big; 5]; 5] {
    std::array::from_fn(|i| std::array::from_fn(|j| big(if i == j { 1.0 } else { 0.0 })))
}

fn times(row: &[Big; 5], matrix: &[[Big; 5]; 5]) -> [Big; 5] {
    std::array::from_fn(|j| (0..5).fold(big(0.0), |sum, k| sum + row[k].clone() * &matrix[k][j]))
}

fn product(a: &[[Big; 5]; 5], b: &[[Big; 5]; 5]) -> [[Big; 5]; 5] {
    std::array::from_fn(|i| times(&a[i], b))
}

fn norm(vector: [f64; 4]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// `exp` of the rapidity of something with this Lorentz factor, at least 1.
fn stretch(gamma: f64) -> f64 {
    let gamma = gamma.max(1.0);
    gamma + (gamma * gamma - 1.0).sqrt()
}

/// A random flight of so many segments and at most `rapidity` of boosts.
pub(super) fn random_flight(random: &mut Random, count: usize, rapidity: f64) -> Vec<Segment> {
    let each = rapidity / count as f64;
    let segment = |random: &mut Random| {
        let acceleration = random.direction() * 10f64.powf(random.between(-3.0, 2.0));
        let size = acceleration.length();
        // Up to twice the even share, in which `a tau` is the most that a segment adds.
        let proper_time = random.between(0.0, 2.0) * each / size + 1e-9;
        let turn = match random.between(0.0, 6.0) as u32 {
            0 => DVec3::ZERO,
            // Along the acceleration, and for itself.
            1 => acceleration / size * 10f64.powf(random.between(-12.0, 6.0)),
            2 | 3 => random.direction() * 10f64.powf(random.between(-12.0, 6.0)),
            // All but null: as large as the acceleration and across it, but for a little on either side.
            _ => {
                let near = |random: &mut Random| {
                    let little = 10f64.powf(random.between(-17.0, -1.0));
                    little * random.between(-1.0, 1.0).signum()
                };
                let across = acceleration.any_orthogonal_vector().normalize() * size;
                across * (1.0 + near(random)) + acceleration * near(random)
            }
        };
        let acceleration = match random.between(0.0, 10.0) as u32 {
            0 => DVec3::ZERO,
            _ => acceleration,
        };
        // No more than a million radians, of which rounding leaves ten digits.
        let longest = 1e6 / turn.length().max(1e-6);
        Segment::free(proper_time.min(longest), acceleration, turn).expect("finite")
    };
    (0..count).map(|_| segment(random)).collect()
}

/// The states at the beginnings of all segments, then the one at the end.
pub(super) fn all_states(start: State, segments: &[Segment]) -> Vec<State> {
    let mut states = vec![start];
    for segment in segments {
        let before = states.last().expect("the start");
        states.push(before.during(segment, &big(segment.proper_time())));
    }
    states
}

/// The states at the beginnings of all segments that have begun, then the one at `proper_time`.
pub(super) fn states_until(all: &[State], segments: &[Segment], proper_time: f64) -> Vec<State> {
    let mut left = big(proper_time);
    for (index, segment) in segments.iter().enumerate() {
        let whole = big(segment.proper_time());
        if left <= whole {
            let last = all[index].during(segment, &left);
            return all[..=index].iter().cloned().chain([last]).collect();
        }
        left -= whole;
    }
    all.to_vec()
}

/// Natural scales of the four-velocity and axes, and of the place, at the last state.
fn natural_scales(states: &[State], segments: &[Segment], proper_time: f64) -> (f64, f64) {
    let last = states.last().expect("one state");
    let (mut frame, mut place) = (0.0, 0.0);
    for (index, pair) in states.windows(2).enumerate() {
        let segment = &segments[index];
        let Steering::Free { turn_rate } = segment.steering() else {
            panic!("coordinated steering has tests of its own");
        };
        let rate = segment.acceleration().length() + turn_rate.length();
        // The time within the last segment is the difference of times since the start.
        let time = if index + 2 == states.len() {
            proper_time
        } else {
            segment.proper_time()
        };
        let known = 1.0 + rate * time;
        let ways = pair.iter().map(|state| {
            let back = stretch(state.gamma());
            let [gamma, ..] = state.components(&last.column(0));
            let way = norm(state.displacement_own(last));
            (back * stretch(gamma), back * way)
        });
        let (frames, places) = ways.fold((0.0f64, 0.0f64), |(a, b), (c, d)| (a.max(c), b.max(d)));
        frame += known * frames;
        place += known * places;
    }
    (frame, place + proper_time * stretch(last.gamma()))
}

fn four(event: Event) -> [f64; 4] {
    let Event { time, position } = event;
    [time, position.x, position.y, position.z]
}

/// Errors of a moment: of its frame, four-velocity and axes, and of its place.
fn errors(moment: &Moment, exact: &State) -> (f64, f64) {
    let velocity = moment.velocity();
    let celerity = velocity.direction() * velocity.gamma_beta();
    let [x, y, z] = moment.axes();
    let columns = [Event::new(velocity.gamma(), celerity), x, y, z];
    let off = |found: Event, exact: [Big; 4]| {
        norm(std::array::from_fn(|i| {
            small(&(big(four(found)[i]) - &exact[i]))
        }))
    };
    let frame = columns
        .into_iter()
        .enumerate()
        .map(|(k, column)| off(column, exact.column(k)));
    (
        frame.fold(0.0, f64::max),
        off(moment.event(), exact.column(4)),
    )
}

#[test]
fn random_flights_are_right_to_rounding() {
    let mut random = Random::new(14);
    let mut frames = Worst::new("flights: frame, units of the natural scale");
    let mut places = Worst::new("flights: place, units of the natural scale");
    for case in 0..200 {
        let count = match case % 40 {
            0 => 1000,
            1..=9 => 100,
            10..=24 => 10,
            _ => 1,
        };
        let rapidity = random.between(0.1, 40.0);
        let segments = random_flight(&mut random, count, rapidity);
        let velocity = Velocity::from_rapidity(random.between(0.0, 3.0), random.direction())
            .expect("slow enough");
        let turn = DQuat::from_axis_angle(random.direction(), random.between(-3.0, 3.0));
        let rotation = Rotation::new(turn).expect("a unit quaternion");
        let start = Moment::new(Event::default(), Lorentz::boost(velocity)).turned(rotation);
        let flight = Flight::new(start, segments.clone(), Integrator::Exact).expect("possible");
        let all = all_states(State::new(velocity, rotation.get()), &segments);
        for part in [1.0, random.between(0.0, 1.0)] {
            let proper_time = part * flight.proper_time();
            let states = states_until(&all, &segments, proper_time);
            let last = states.last().expect("the start");
            let (frame, place) = errors(&flight.moment(proper_time), last);
            let (frame_scale, place_scale) = natural_scales(&states, &segments, proper_time);
            let story = || format!("case {case}, {count} segments, rapidity {rapidity}");
            let limit = ULPS * f64::EPSILON;
            frames.record(frame, limit * frame_scale, frame_scale, story);
            places.record(place, limit * place_scale, place_scale, story);
        }
    }
    frames.check();
    places.check();
}

/// Axes are columns of a Lorentz matrix to the rounding of their own size.
fn assert_orthonormal(moment: &Moment, limit: f64) {
    let velocity = moment.velocity();
    let celerity = velocity.direction() * velocity.gamma_beta();
    let [x, y, z] = moment.axes();
    let columns = [Event::new(velocity.gamma(), celerity), x, y, z].map(four);
    for (i, a) in columns.iter().enumerate() {
        for (j, b) in columns.iter().enumerate() {
            let product = (1..4).map(|k| a[k] * b[k]).sum::<f64>() - a[0] * b[0];
            let expected = match (i, j) {
                (0, 0) => -1.0,
                (i, j) if i == j => 1.0,
                _ => 0.0,
            };
            let size = norm(*a) * norm(*b);
            let error = (product - expected).abs();
            assert!(
                error <= limit * size,
                "{i} {j}: {product}, off by {error:e}"
            );
        }
    }
}

#[test]
fn axes_stay_orthonormal_through_100_000_segments() {
    let mut random = Random::new(15);
    let segment = |random: &mut Random| {
        let turn = random.direction() * random.between(0.0, 3.0);
        Segment::free(0.01, random.direction(), turn).expect("finite")
    };
    let segments: Vec<Segment> = (0..100_000).map(|_| segment(&mut random)).collect();
    let start = Moment::new(Event::default(), Lorentz::IDENTITY);
    let flight = Flight::new(start, segments, Integrator::Exact).expect("possible");
    assert!((flight.proper_time() - 1000.0).abs() < 1e-9);
    for proper_time in [0.005, 123.456, 1000.0] {
        assert_orthonormal(&flight.moment(proper_time), 8.0 * f64::EPSILON);
    }
}

/// One segment, and the many short ones that it is made of, each of them asked for at many times.
///
/// All types of flight, and coordinated turns at constant and at changing speed. The limit is that of one rounding at
/// each of the short segments, at rapidities of at most 4.
#[test]
fn one_long_segment_is_many_short_ones() {
    let x = Velocity::from_beta(0.6, DVec3::X).expect("below 1");
    type OfDuration = Box<dyn Fn(f64) -> Segment>;
    let free = |a: DVec3, w: DVec3| -> OfDuration {
        Box::new(move |time| Segment::free(time, a, w).expect("finite"))
    };
    let coordinated = |a: DVec3| -> OfDuration {
        Box::new(move |time| Segment::coordinated(time, a).expect("finite"))
    };
    let cases: [(&str, OfDuration); 10] = [
        ("linear", free(DVec3::new(0.3, 0.2, -0.1), DVec3::ZERO)),
        ("screw", free(DVec3::X, DVec3::X * 0.7)),
        ("rotational", free(DVec3::Y * 0.5, DVec3::Z * 2.0)),
        (
            "general",
            free(DVec3::new(0.5, 0.2, 0.0), DVec3::new(0.0, 0.1, 0.7)),
        ),
        ("null", free(DVec3::X, DVec3::Z)),
        (
            "next to null",
            free(DVec3::X, DVec3::new(-1e-9, 0.0, 1.0 - 1e-9)),
        ),
        ("coordinated", coordinated(DVec3::Y * 0.3)),
        (
            "coordinated, faster",
            coordinated(DVec3::new(0.3, 0.2, 0.1)),
        ),
        (
            "coordinated, slower",
            coordinated(DVec3::new(-0.15, 0.2, 0.1)),
        ),
        ("turn", free(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0))),
    ];
    for (name, segment) in cases {
        let start = || Moment::new(Event::new(0.5, DVec3::ONE), Lorentz::boost(x));
        let long = Flight::new(start(), vec![segment(4.0)], Integrator::Exact).expect("possible");
        for count in [2, 7, 1000] {
            let short = (0..count).map(|_| segment(4.0 / f64::from(count)));
            let short = Flight::new(start(), short.collect(), Integrator::Exact).expect("possible");
            let limit = 4f64.exp() * f64::from(count + 16) * f64::EPSILON;
            for proper_time in [-1.0, 0.0, 0.3, 1.999, 3.5, 4.0, 5.0] {
                let [long, short] = [&long, &short].map(|flight| flight.moment(proper_time));
                let off = norm(four(long.event() - short.event()));
                assert!(
                    off <= limit,
                    "{name} {count} {proper_time}: place off by {off:e}"
                );
                for (a, b) in long.axes().into_iter().zip(short.axes()) {
                    let off = norm(four(a - b));
                    assert!(
                        off <= limit,
                        "{name} {count} {proper_time}: axes off by {off:e}"
                    );
                }
            }
        }
    }
}

/// Beside something as fast as itself an observer moves little, however fast both are: what one long segment at high
/// rapidity leads to is known there as well as if the observer had started from rest.
#[test]
fn a_flight_beside_something_fast_keeps_its_digits() {
    let thrust = |time: f64| Segment::free(time, DVec3::NEG_Z, DVec3::ZERO).expect("finite");
    for rapidity in [10.0, 40.0, 150.0] {
        let fast = Velocity::from_rapidity(rapidity, DVec3::NEG_Z).expect("not too fast");
        // Up to the speed of the object, then beside it for a while, a little to the right.
        let aside = Segment::free(0.5, DVec3::X, DVec3::ZERO).expect("finite");
        let start = Moment::new(Event::default(), Lorentz::IDENTITY);
        let segments = vec![thrust(rapidity), aside];
        let flight = Flight::new(start, segments, Integrator::Exact).expect("possible");
        let object = WorldLine {
            origin: Event::default(),
            velocity: fast,
        };
        let place = |time: f64| View::new(&flight.moment(time), &object).observer_rest();
        // In the object's rest frame: 1 - cosh(rapidity) along the motion, then cosh - 1 aside.
        let moved = place(rapidity + 0.5) - place(rapidity);
        let size = f64::exp(rapidity) * f64::EPSILON;
        assert!(
            (moved.x - (0.5f64.cosh() - 1.0)).abs() <= 4.0 * f64::EPSILON,
            "{rapidity}: {moved}"
        );
        assert!(moved.z.abs() <= 32.0 * size, "{rapidity}: {moved}");
        let behind = place(rapidity).z;
        let expected = rapidity.cosh() - 1.0;
        assert!(
            (behind / expected - 1.0).abs() <= 400.0 * f64::EPSILON,
            "{rapidity}: {behind} {expected}"
        );
    }
}

#[test]
fn impossible_flights_are_refused() {
    let start = || Moment::new(Event::default(), Lorentz::IDENTITY);
    let moving = || {
        let velocity = Velocity::from_beta(0.5, DVec3::X).expect("below 1");
        Moment::new(Event::default(), Lorentz::boost(velocity))
    };
    let free = |time, a, w| Segment::free(time, a, w);
    for odd in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(free(odd, DVec3::X, DVec3::ZERO).is_err(), "{odd}");
        assert!(Segment::coordinated(odd, DVec3::X).is_err(), "{odd}");
        assert!(Integrator::euler(odd).is_err() && Integrator::runge_kutta_4(odd).is_err());
    }
    for odd in [f64::NAN, f64::NEG_INFINITY] {
        assert!(free(1.0, DVec3::Y * odd, DVec3::ZERO).is_err(), "{odd}");
        assert!(free(1.0, DVec3::ZERO, DVec3::Y * odd).is_err(), "{odd}");
    }
    assert!(free(1e7, DVec3::ZERO, DVec3::X * 1e6).is_err());
    let refused = |start: Moment, segments: Vec<Segment>, integrator| {
        Flight::new(start, segments, integrator).expect_err("impossible")
    };
    let exact = Integrator::Exact;
    let thrust = |time| free(time, DVec3::X, DVec3::ZERO).expect("finite");
    for (segments, which) in [
        (vec![thrust(351.0)], 0),
        (vec![thrust(1e300)], 0),
        (vec![thrust(200.0), thrust(200.0)], 1),
        (
            vec![free(1e300, DVec3::X * 1e300, DVec3::ZERO).expect("finite")],
            0,
        ),
    ] {
        let error = refused(start(), segments, exact);
        let fast = matches!(error, FlightError::TooFast { segment, .. } if segment == which);
        assert!(fast, "{error}");
    }
    // Without any step between, Euler's method does not notice how fast the observer becomes.
    let flight = Flight::new(
        start(),
        vec![thrust(351.0)],
        Integrator::euler(1e9).expect("a step"),
    );
    let celerity = flight
        .expect("one step")
        .moment(351.0)
        .velocity()
        .gamma_beta();
    assert!((celerity / 351.0 - 1.0).abs() < 1e-14);
    let endless = vec![free(f64::MAX, DVec3::ZERO, DVec3::ZERO).expect("finite"); 2];
    assert_eq!(refused(start(), endless, exact), FlightError::Endless);
    let stop = Segment::coordinated(2.0, DVec3::new(-1.0, 1.0, 0.0)).expect("finite");
    assert_eq!(
        refused(moving(), vec![stop], exact),
        FlightError::StopsInTurn { segment: 0 }
    );
    let whirl = Segment::coordinated(1.0, DVec3::new(1e-9, 1e6, 0.0)).expect("finite");
    assert!(matches!(
        refused(moving(), vec![whirl], exact),
        FlightError::TooManyTurns { segment: 0, .. }
    ));
    let tiny = Integrator::euler(1e-12).expect("a step");
    assert!(matches!(
        refused(start(), vec![thrust(1.0)], tiny),
        FlightError::Steps { .. }
    ));
    // A straight brake through rest turns nothing, and no turn begins at rest.
    for acceleration in [DVec3::NEG_X, DVec3::X] {
        let brake = Segment::coordinated(2.0, acceleration).expect("finite");
        let flight = Flight::new(moving(), vec![brake], exact).expect("straight");
        let expected = 0.5f64.atanh() + 2.0 * acceleration.x;
        let velocity = flight.moment(2.0).velocity();
        let found = velocity.rapidity() * velocity.direction().x;
        assert!((found - expected).abs() < 4e-15, "{found} {expected}");
    }
    let from_rest = Segment::coordinated(2.0, DVec3::new(0.3, 0.4, 0.0)).expect("finite");
    let flight = Flight::new(start(), vec![from_rest], exact).expect("straight");
    let direction = flight.moment(2.0).velocity().direction();
    assert!((direction - DVec3::new(0.6, 0.8, 0.0)).length() < 4e-16);
}

/// A moment is the same whether one asks for it first or last, and so is the acceleration.
#[test]
fn any_proper_time_may_be_asked_for() {
    let segments: Vec<Segment> = (0..64)
        .map(|index| {
            let a = DVec3::X * f64::from(index % 5 - 2);
            Segment::free(0.25, a, DVec3::Y).expect("finite")
        })
        .collect();
    let start = Moment::new(Event::default(), Lorentz::IDENTITY);
    for integrator in [
        Integrator::Exact,
        Integrator::euler(0.01).expect("a step"),
        Integrator::runge_kutta_4(0.1).expect("a step"),
    ] {
        let flight = Flight::new(start.clone(), segments.clone(), integrator).expect("possible");
        assert_eq!(flight.times().len(), 65);
        assert_eq!(flight.acceleration(0.3), DVec3::NEG_X);
        assert_eq!(flight.acceleration(-0.3), DVec3::ZERO);
        assert_eq!(flight.acceleration(16.0), DVec3::ZERO);
        assert_eq!(flight.turn_rate(1.0), DVec3::Y);
        // Continuous where segments meet, and where the flight begins and ends.
        for &time in flight.times() {
            let [before, at, after] = [time - 1e-9, time, time + 1e-9].map(|t| flight.moment(t));
            for other in [before, after] {
                let jump = norm(four(at.event() - other.event()));
                assert!(jump < 1e-7, "{integrator:?} {time}: {jump:e}");
                let turned = at.axes()[0] - other.axes()[0];
                assert!(
                    norm(four(turned)) < 1e-7,
                    "{integrator:?} {time}: {turned:?}"
                );
            }
        }
    }
}
