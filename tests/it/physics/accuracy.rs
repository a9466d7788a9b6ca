//! The photosurface map against a reference in 300 digits.
//!
//! The oracle (`common/oracle.rs`) solves the light-cone equation in the scene frame and knows none of
//! the formulas under test. What is given to both is taken as exact, except that the oracle
//! brings the direction of motion to unit length, which `f64` can do only to its last place.
//!
//! # Where the limits come from
//!
//! What is given counts as given: no rounding of it is an excuse. Positions, times and Doppler factors may be
//! off by `MAP`, other results by `RELATIVE` of the terms that they are sums of. Only normals are different: what
//! their own last place means close behind a fast observer is a fact about the map, not about the program
//! (`normal_limit` in `common/mod.rs`).

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::oracle::{self, Big, Oracle, big, big_vector, small};
use crate::common::{RELATIVE, Random, TURN, Worst, normal_limit};
use photosurface::light_cone::PhotosurfaceMap;
use photosurface::spacetime::Event;
use photosurface::{DVec3, Velocity};

/// What positions, times of emission and Doppler factors may be off by, relative to themselves: half an epsilon
/// for each of the roundings in a row that count fully. These are, close behind the observer where `w` makes up all of
/// the result and comes from a square: twice those of the cross product (1.5), of its length (3.5), and
/// of the heading's (1); then those of the larger coordinate, the ratio, two factors, `exp(eta)` and the sum.
/// Elsewhere it is less: 45 degrees from straight behind, where plain products begin, they count
/// `tan(67.5 degrees) = 2.4` times.
const MAP: f64 = 8.0 * f64::EPSILON;

/// One point and one observer who is moving past it.
struct Case {
    velocity: Velocity,
    offset: DVec3,
    /// Whether the motion is along an axis, so that products with its direction are exact.
    along_axis: bool,
}

impl Case {
    fn describe(&self) -> String {
        format!(
            "rapidity {}, direction {}, offset {:?}",
            self.velocity.rapidity(),
            self.velocity.direction(),
            self.offset.to_array()
        )
    }

    /// The size of the possible turn of the offset.
    fn turn(&self) -> f64 {
        if self.along_axis { 0.0 } else { TURN }
    }

    fn distance(&self) -> f64 {
        self.offset.length()
    }

    /// Sine of the angle between offset and motion.
    fn sin_theta(&self) -> f64 {
        self.velocity.direction().cross(self.offset).length() / self.distance()
    }
}

/// Observers from rest to `1 - beta = 1e-13`, points 1e-9 to 1e9 away, straight ahead, straight
/// behind, all but straight, and anywhere.
fn for_each_case(mut visit: impl FnMut(&Case, &mut Random)) {
    let rapidities = [
        0.0, 1e-8, 0.01, 0.5, 1.0, 2.0, 3.5, 5.0, 7.5, 10.0, 12.5, 15.0,
    ];
    let from_straight = [0.0, 1e-12, 1e-7, 1e-3, 0.1, 0.7];
    let mut random = Random::new(1);
    for rapidity in rapidities {
        let axes = [DVec3::X, DVec3::NEG_Y, DVec3::Z].map(|axis| (axis, true));
        let mut directions = axes.to_vec();
        directions.extend((0..4).map(|_| (random.direction(), false)));
        for (direction, along_axis) in directions {
            let velocity = Velocity::from_rapidity(rapidity, direction).expect("valid");
            let ahead = from_straight.iter().copied();
            let behind = from_straight.iter().map(|angle| PI - angle);
            for angle in ahead.chain([FRAC_PI_2]).chain(behind) {
                let n = velocity.direction();
                let aside = n.cross(random.direction()).normalize();
                // The sine by hand: sin(PI) is not zero.
                let sine = if angle == PI { 0.0 } else { angle.sin() };
                let distance = 10f64.powf(random.between(-9.0, 9.0));
                let case = Case {
                    velocity,
                    offset: (n * angle.cos() + aside * sine) * distance,
                    along_axis,
                };
                visit(&case, &mut random);
            }
        }
    }
}

#[test]
fn positions_seen_are_right_to_a_few_units_in_the_last_place() {
    let mut axis = Worst::new("position, motion along an axis");
    let mut anywhere = Worst::new("position, any motion");
    for_each_case(|case, _| {
        let map = PhotosurfaceMap::new(&case.velocity);
        let seen = Oracle::observer_moves(&case.velocity)
            .see(&big_vector(case.offset))
            .position();
        let size = small(&oracle::length(&seen));
        let limit = MAP * size;
        let error = oracle::vector_error(map.seen_position(case.offset), &seen);
        let worst = if case.along_axis {
            &mut axis
        } else {
            &mut anywhere
        };
        worst.record(error, limit, size, || case.describe());
    });
    axis.check();
    anywhere.check();
}

#[test]
fn times_of_emission_are_right_to_a_few_units_in_the_last_place() {
    let mut axis = Worst::new("time of emission, motion along an axis");
    let mut anywhere = Worst::new("time of emission, any motion");
    for_each_case(|case, _| {
        let map = PhotosurfaceMap::new(&case.velocity);
        let sight = Oracle::observer_moves(&case.velocity).see(&big_vector(case.offset));
        let size = small(sight.emission_time()).abs();
        let limit = MAP * size;
        let error = oracle::error(map.emission_time(case.offset), sight.emission_time());
        let worst = if case.along_axis {
            &mut axis
        } else {
            &mut anywhere
        };
        worst.record(error, limit, size, || case.describe());
    });
    axis.check();
    anywhere.check();
}

#[test]
fn doppler_factors_are_right_to_a_few_units_in_the_last_place() {
    let mut axis = Worst::new("Doppler factor, motion along an axis");
    let mut anywhere = Worst::new("Doppler factor, any motion");
    for_each_case(|case, _| {
        let map = PhotosurfaceMap::new(&case.velocity);
        let factor =
            Oracle::observer_moves(&case.velocity).doppler_factor(&big_vector(case.offset));
        let size = small(&factor);
        let limit = MAP * size;
        let error = oracle::error(map.doppler_factor(case.offset), &factor);
        let worst = if case.along_axis {
            &mut axis
        } else {
            &mut anywhere
        };
        worst.record(error, limit, size, || case.describe());
    });
    axis.check();
    anywhere.check();
}

/// `J = I + n b^T - n n^T` with `b = D n + gamma beta d_across / r`: relative roundings cost
/// `RELATIVE` times `1 + |b|`; turning `d` or `n` changes `d_across / r` by as much, hence `J` by
/// `1 + D + 2 gamma beta` at most. Along an axis each entry of `J` is one product.
#[test]
fn jacobians_are_right_to_a_few_units_in_the_last_place() {
    let mut axis = Worst::new("Jacobian entry, motion along an axis");
    let mut anywhere = Worst::new("Jacobian, any motion");
    for_each_case(|case, _| {
        let oracle = Oracle::observer_moves(&case.velocity);
        let at = big_vector(case.offset);
        let jacobian = PhotosurfaceMap::new(&case.velocity).jacobian(case.offset);
        let mut squared_error = 0.0;
        let mut squared_size = 0.0;
        for (axis_index, direction) in DVec3::AXES.iter().enumerate() {
            let exact = oracle.derivative(&at, &big_vector(*direction));
            let column = jacobian.col(axis_index);
            for row in 0..3 {
                let size = small(&exact[row]).abs();
                let error = oracle::error(column[row], &exact[row]);
                if case.along_axis {
                    axis.record(error, RELATIVE * size, size, || {
                        format!("{}, row {row}, column {axis_index}", case.describe())
                    });
                }
                squared_error += error * error;
                squared_size += size * size;
            }
        }
        if !case.along_axis {
            let doppler = small(&oracle.doppler_factor(&at));
            let b = doppler.hypot(case.velocity.gamma_beta() * case.sin_theta());
            let limit = RELATIVE * (1.0 + b);
            anywhere.record(squared_error.sqrt(), limit, squared_size.sqrt(), || {
                case.describe()
            });
        }
    });
    axis.check();
    anywhere.check();
}

#[test]
fn normals_are_right_to_a_few_units_in_the_last_place() {
    let mut axis = Worst::new("normal, motion along an axis");
    let mut anywhere = Worst::new("normal, any motion");
    for_each_case(|case, random| {
        let n = case.velocity.direction();
        let normals = [
            random.direction(),
            n,
            n.any_orthonormal_vector(),
            -case.offset / case.distance(),
        ];
        for normal in normals {
            let exact =
                Oracle::observer_moves(&case.velocity).normal(&big_vector(case.offset), normal);
            let map = PhotosurfaceMap::new(&case.velocity);
            let limit = normal_limit(&case.velocity, case.offset, normal, RELATIVE, case.turn());
            let error = oracle::vector_error(map.seen_normal(case.offset, normal), &exact);
            let worst = if case.along_axis {
                &mut axis
            } else {
                &mut anywhere
            };
            worst.record(error, limit, 1.0, || {
                format!("{}, normal {:?}", case.describe(), normal.to_array())
            });
        }
    });
    axis.check();
    anywhere.check();
}

/// The largest singular value of the brute-force Jacobian at `at`. One of them is 1: with the trace of
/// `J^T J` and the determinant the other two follow.
fn stretch(velocity: &Velocity, at: DVec3) -> Big {
    let oracle = Oracle::observer_moves(velocity);
    let at = big_vector(at);
    let [x, y, z] = DVec3::AXES.map(|axis| oracle.derivative(&at, &big_vector(axis)));
    let trace = oracle::dot(&x, &x) + oracle::dot(&y, &y) + oracle::dot(&z, &z);
    larger_singular_value(
        &(trace - big(1.0)),
        &oracle::dot(&oracle::cross(&x, &y), &z),
    )
}

/// Of two numbers the larger, by the sum of their squares and their product.
fn larger_singular_value(squares: &Big, product: &Big) -> Big {
    let discriminant = squares.clone() * squares - big(4.0) * product * product;
    // Equal but for the rounding of the oracle where nothing is stretched.
    let root = if discriminant > big(0.0) {
        discriminant.sqrt()
    } else {
        big(0.0)
    };
    ((squares.clone() + root) / big(2.0)).sqrt()
}

/// Rounding up costs 40 epsilon; an angle made larger by 16 epsilon, to be safe, adds half as much to `C` in
/// `C E`.
#[test]
fn stretching_at_a_point_is_bounded_by_little_more() {
    let mut axis = Worst::new("bound of the stretching, motion along an axis");
    let mut anywhere = Worst::new("bound of the stretching, any motion");
    let mut itself = Worst::new("stretching");
    for_each_case(|case, _| {
        let map = PhotosurfaceMap::new(&case.velocity);
        let exact = stretch(&case.velocity, case.offset);
        let bound = map.stretch_bound(case.offset, 0.0);
        assert!(big(bound) >= exact, "{bound} at {}", case.describe());
        let size = small(&exact);
        let limit = 4.0 * RELATIVE * size;
        let worst = if case.along_axis {
            &mut axis
        } else {
            &mut anywhere
        };
        worst.record(oracle::error(bound, &exact), limit, size, || {
            case.describe()
        });
        let error = oracle::error(map.stretch_at(case.offset), &exact);
        itself.record(error, RELATIVE * size, size, || case.describe());
    });
    axis.check();
    anywhere.check();
    itself.check();
}

/// The largest stretching in a ball is where a line from the observer touches it on the side of the
/// direction of motion; everywhere else it is less.
#[test]
fn stretching_in_a_ball_is_bounded_by_little_more() {
    let mut worst = Worst::new("bound of the stretching in a ball");
    for_each_case(|case, random| {
        let map = PhotosurfaceMap::new(&case.velocity);
        let part = 10f64.powf(random.between(-6.0, 0.1)).min(0.95);
        let radius = part * case.distance();
        let bound = map.stretch_bound(case.offset, radius);
        for _ in 0..4 {
            let shift = random.direction() * radius * random.between(0.0, 1.0).cbrt();
            let exact = stretch(&case.velocity, case.offset + shift);
            let at = shift.to_array();
            assert!(big(bound) >= exact, "{bound}, {}, {at:?}", case.describe());
        }
        let n = case.velocity.direction();
        let ahead = case.offset.normalize();
        // Straight ahead or behind, any direction aside is as good.
        let aside = ahead.cross(n).cross(ahead);
        let aside = if aside.length() > 1e-14 {
            aside.normalize()
        } else {
            ahead.any_orthonormal_vector()
        };
        let touching = case.offset * (1.0 - part * part)
            + aside * (radius * ((1.0 - part) * (1.0 + part)).sqrt());
        // Straight ahead lies inside the ball.
        let peak = if n.dot(ahead) > 0.0 && n.cross(ahead).length() < part {
            n * case.distance()
        } else {
            touching
        };
        let exact = stretch(&case.velocity, peak);
        let size = small(&exact);
        // The angle is known to some 10 epsilon, and the touching point of a large ball by 3 times that.
        let limit = 4.0 * RELATIVE * size + 30.0 * f64::EPSILON * case.velocity.rapidity().exp();
        worst.record(oracle::error(bound, &exact), limit, size, || {
            format!("radius {radius}, {}", case.describe())
        });
    });
    worst.check();
}

/// Behind an observer at rapidity 200 the stretching grows from 1 to `exp(200)` as the angle does from
/// `exp(-200)`; by `T = gamma^2 (1 + beta^2 + 2 beta cos) + 1` and the Doppler factor.
#[test]
fn stretching_is_bounded_by_little_more_at_extreme_rapidities() {
    let mut worst = Worst::new("bound of the stretching, extreme rapidity");
    let mut itself = Worst::new("stretching, extreme rapidity");
    for rapidity in [30.0, 100.0, 200.0] {
        let velocity = Velocity::from_rapidity(rapidity, DVec3::NEG_Y).expect("valid");
        let map = PhotosurfaceMap::new(&velocity);
        let growth = big(rapidity).exp();
        let shrink = big(1.0) / &growth;
        let gamma = (growth.clone() + &shrink) / big(2.0);
        let gamma_beta = (growth - &shrink) / big(2.0);
        for exponent in -100..=0 {
            for along in [-1.0, 1.0] {
                let offset = DVec3::new(0.6, along * 10f64.powi(-exponent), -0.8);
                let exact_offset = big_vector(offset);
                let cosine = -exact_offset[1].clone() / oracle::length(&exact_offset);
                let doppler = gamma.clone() + gamma_beta.clone() * &cosine;
                let squares = gamma.clone() * &gamma
                    + gamma_beta.clone() * &gamma_beta
                    + big(2.0) * &gamma * &gamma_beta * &cosine
                    + big(1.0);
                let exact = larger_singular_value(&squares, &doppler);
                let bound = map.stretch_bound(offset, 0.0);
                assert!(big(bound) >= exact, "{rapidity}, {offset}: {bound}");
                let size = small(&exact);
                worst.record(
                    oracle::error(bound, &exact),
                    4.0 * RELATIVE * size,
                    size,
                    || format!("rapidity {rapidity}, offset {offset}"),
                );
                let error = oracle::error(map.stretch_at(offset), &exact);
                itself.record(error, RELATIVE * size, size, || {
                    format!("rapidity {rapidity}, offset {offset}")
                });
            }
        }
    }
    worst.check();
    itself.check();
}

/// Along an axis the rapidity makes no difference: as far as the digits of the oracle go.
#[test]
fn positions_and_times_are_as_good_at_extreme_rapidities() {
    let mut worst = Worst::new("position and time, extreme rapidity");
    let mut random = Random::new(9);
    for rapidity in [30.0, 100.0, 200.0] {
        let velocity = Velocity::from_rapidity(rapidity, DVec3::NEG_Z).expect("valid");
        let map = PhotosurfaceMap::new(&velocity);
        for exponent in -40..=0 {
            // From straight ahead and behind to anywhere.
            let aside = DVec3::new(1.0, -0.7, 0.0) * 10f64.powi(exponent);
            for along in [-1.0, 1.0] {
                let offset = aside + DVec3::Z * along * random.between(0.5, 2.0);
                let sight = Oracle::observer_moves(&velocity).see(&big_vector(offset));
                let size = small(sight.emission_time()).abs();
                let position_error =
                    oracle::vector_error(map.seen_position(offset), &sight.position());
                let time_error = oracle::error(map.emission_time(offset), sight.emission_time());
                let error = position_error.max(time_error);
                worst.record(error, RELATIVE * size, size, || {
                    format!("rapidity {rapidity}, offset {:?}", offset.to_array())
                });
            }
        }
    }
    worst.check();
}

/// The oracle itself: an object that rushes at an observer at rest is the same physics as an observer
/// who rushes at an object at rest, and its two calculations have no number in common.
#[test]
fn the_oracle_agrees_with_itself_in_two_frames() {
    let mut random = Random::new(2);
    for rapidity in [0.3, 3.0, 15.0] {
        let velocity = Velocity::from_rapidity(rapidity, random.direction()).expect("valid");
        let vertex = big_vector(random.direction() * 3.0);
        let moving_observer = Oracle::observer_moves(&velocity).see(&vertex);
        let moving_object = Oracle::new(
            DVec3::ZERO,
            &velocity.reversed(),
            Event::default(),
            &Velocity::ZERO,
        )
        .see(&vertex);
        for (a, b) in moving_observer.event.iter().zip(&moving_object.event) {
            assert!(small(&(a.clone() - b)).abs() < 1e-200);
        }
    }
}

/// The textbook form `gamma (d_par + beta r)` behind an observer at `1 - beta = 1e-12`: it keeps six
/// digits, the map all but the last.
#[test]
fn a_point_behind_a_fast_observer_keeps_its_digits() {
    let velocity = Velocity::from_one_minus_beta(1e-12, DVec3::NEG_X).expect("valid");
    let offset = DVec3::new(1.0, 0.001, 0.0);
    let seen = Oracle::observer_moves(&velocity)
        .see(&big_vector(offset))
        .position();
    let size = small(&oracle::length(&seen));
    let map = PhotosurfaceMap::new(&velocity);
    assert!(oracle::vector_error(map.seen_position(offset), &seen) <= RELATIVE * size);

    let beta = 1.0 - 1e-12;
    let gamma = 1.0 / (1.0f64 - beta * beta).sqrt();
    let textbook = gamma * (offset.x - beta * offset.length());
    assert!(oracle::error(textbook, &seen[0]) > 1e4 * RELATIVE * size);
}
