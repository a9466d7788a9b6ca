//! Flights against numbers that others can recompute: matrix exponentials of 30 digits and closed forms.

use std::f64::consts::TAU;

use photosurface::spacetime::{Event, Flight, Integrator, Lorentz, Segment};
use photosurface::{DVec3, Moment, Velocity};

fn start(velocity: Velocity) -> Moment {
    Moment::new(Event::default(), Lorentz::boost(velocity))
}

fn free(proper_time: f64, acceleration: DVec3, turn_rate: DVec3) -> Segment {
    Segment::free(proper_time, acceleration, turn_rate).expect("finite")
}

fn flight(start: Moment, segments: Vec<Segment>) -> Flight {
    Flight::new(start, segments, Integrator::Exact).expect("a possible flight")
}

/// One segment from rest.
fn from_rest(segment: Segment) -> Flight {
    flight(start(Velocity::ZERO), vec![segment])
}

fn along_x(beta: f64) -> Velocity {
    Velocity::from_beta(beta, DVec3::X).expect("below 1")
}

fn four(event: Event) -> [f64; 4] {
    let Event { time, position } = event;
    [time, position.x, position.y, position.z]
}

fn four_velocity(moment: &Moment) -> [f64; 4] {
    let velocity = moment.velocity();
    let celerity = velocity.direction() * velocity.gamma_beta();
    four(Event::new(velocity.gamma(), celerity))
}

#[track_caller]
fn assert_close(found: [f64; 4], expected: [f64; 4], limit: f64) {
    let error = (0..4).map(|i| (found[i] - expected[i]).abs());
    let error = error.fold(0.0, f64::max);
    assert!(error <= limit, "{found:?}\n{expected:?}\noff by {error:e}");
}

/// The numbers are written with 12 digits.
#[test]
fn a_rocket_with_the_thrust_of_a_falling_stone() {
    let rocket = from_rest(free(20.0, DVec3::X * 1.03, DVec3::ZERO));
    for (proper_time, time, distance, gamma) in [
        (1.0, 1.18643634667, 0.562171259839, 1.57903639763),
        (2.0, 3.74685234972, 2.89972028166, 3.98671189011),
        (5.0, 83.7017917049, 82.7365484085, 86.2186448608),
        (12.0, 113243.315484, 113242.344614, 116640.614953),
    ] {
        let moment = rocket.moment(proper_time);
        let event = moment.event();
        for (found, expected) in [
            (event.time, time),
            (event.position.x, distance),
            (moment.velocity().gamma(), gamma),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
        }
        assert!((moment.velocity().rapidity() - 1.03 * proper_time).abs() < 4e-15);
        assert_eq!((event.position.y, event.position.z), (0.0, 0.0));
    }
}

#[test]
fn the_general_type() {
    let (a, w) = (DVec3::new(0.5, 0.2, 0.0), DVec3::new(0.0, 0.1, 0.7));
    let moment = from_rest(free(2.0, a, w)).moment(2.0);
    let event = [
        2.370_855_142_445_496,
        0.752_965_083_888_677_6,
        0.821_533_411_213_344_2,
        -0.054_846_595_972_260_72,
    ];
    let velocity = [
        1.540_789_224_187_007_6,
        0.604_869_523_776_181,
        1.001_246_587_211_173_5,
        -0.075_296_508_388_867_76,
    ];
    let x_axis = [1.1267604735, 0.5342852497, 1.3985306230, -0.1680491986];
    let z_axis = [0.1110931165, 0.1680491986, 0.1432572403, 0.9816203495];
    assert_close(four(moment.event()), event, 1e-15);
    assert_close(four_velocity(&moment), velocity, 1e-15);
    let [x, _, z] = moment.axes().map(four);
    assert_close(x, x_axis, 1e-10);
    assert_close(z, z_axis, 1e-10);
}

/// Neither grows nor turns: time and way are polynomials of degree 3.
#[test]
fn the_null_type() {
    let null = from_rest(free(5.0, DVec3::X, DVec3::Z));
    for tau in [1e-9f64, 0.1, 1.0, 3.0, 5.0] {
        let moment = null.moment(tau);
        let cube = tau.powi(3) / 6.0;
        let expected = [tau + cube, tau * tau / 2.0, cube, 0.0];
        assert_close(
            four(moment.event()),
            expected,
            4.0 * f64::EPSILON * expected[0],
        );
        let expected = [1.0 + tau * tau / 2.0, tau, tau * tau / 2.0, 0.0];
        assert_close(
            four_velocity(&moment),
            expected,
            8.0 * f64::EPSILON * expected[0],
        );
    }
}

/// A circle of radius 1 at 0.6 c, towards whose centre the same side of the observer points.
#[test]
fn a_circle_closes_with_its_axes() {
    let lap = 8.377_580_409_572_783;
    let circle = flight(
        start(along_x(0.6)),
        vec![free(lap, DVec3::Y * 0.5625, DVec3::Z * 0.9375)],
    );
    let moment = circle.moment(lap);
    assert_close(
        four(moment.event()),
        [10.471975511965977, 0.0, 0.0, 0.0],
        1e-14,
    );
    assert_close(four_velocity(&moment), [1.25, 0.75, 0.0, 0.0], 4e-15);
    let [_, y, z] = moment.axes().map(four);
    assert_close(y, [0.0, 0.0, 1.0, 0.0], 4e-15);
    assert_close(z, [0.0, 0.0, 0.0, 1.0], 4e-15);
    // Half way round, two radii apart.
    let half = circle.moment(0.5 * lap).event();
    assert!(
        (half.position - DVec3::Y * 2.0).length() < 1e-14,
        "{half:?}"
    );
}

/// Axes that are carried along a circle without turning come back turned: gamma - 1 turns against it, here a quarter.
#[test]
fn thomas_precession_at_0_6_c_is_a_quarter_of_a_turn_per_lap() {
    let lap = 8.377_580_409_572_783;
    // The centre turns round the observer, whose axes do not: so many short pushes.
    let turned_after = |pushes: usize| {
        let pushed = (0..pushes).map(|push| {
            let middle = (push as f64 + 0.5) / pushes as f64;
            let angle = 0.9375 * lap * middle;
            let towards = DVec3::new(-angle.sin(), angle.cos(), 0.0);
            free(lap / pushes as f64, towards * 0.5625, DVec3::ZERO)
        });
        let circle = flight(start(along_x(0.6)), pushed.collect());
        let moment = circle.moment(lap);
        let rotation = moment.scene_to_observer().rotation();
        (moment, rotation.to_scaled_axis())
    };
    let (moment, turned) = turned_after(20_000);
    // Pushes of constant direction are off by the square of their length.
    let limit = 20.0 * (lap / 20_000.0f64).powi(2);
    assert!((moment.event().position).length() < limit);
    // Coordinates turn against the axes, which turn by -90 degrees.
    let error = (turned - DVec3::Z * (TAU / 4.0)).length();
    assert!(error < limit, "{turned}, off by {error:e}");
    assert!(
        error > limit / 1000.0,
        "the limit is far from what it limits"
    );
}

#[test]
fn a_coordinated_turn_keeps_its_speed_and_its_nose() {
    let a = DVec3::Y * 0.3;
    let event = [2.5, 1.345_042_670_436_605_2, 0.568_674_919_974_064_8, 0.0];
    for turn in [
        free(2.0, a, DVec3::Z * 0.5),
        Segment::coordinated(2.0, a).expect("finite"),
    ] {
        let flown = flight(start(along_x(0.6)), vec![turn]);
        let moment = flown.moment(2.0);
        assert_close(four(moment.event()), event, 2e-15);
        assert!((moment.velocity().gamma() - 1.25).abs() < 2e-15);
        // The direction of motion in own axes stays x.
        let nose = moment.scene_to_observer().rotation() * moment.velocity().direction();
        assert!((nose - DVec3::X).length() < 1e-15, "{nose}");
        assert!((flown.turn_rate(1.0) - DVec3::Z * 0.5).length() < 1e-15);
    }
    let steady = flight(start(along_x(0.6)), vec![free(2.0, a, DVec3::ZERO)]);
    let moment = steady.moment(2.0);
    let event = [
        2.652_723_258_951_005_5,
        1.591_633_955_370_603_1,
        0.618_217_394_140_892_4,
        0.0,
    ];
    assert_close(four(moment.event()), event, 2e-15);
    let velocity = [
        1.481_831_522_802_834_7,
        0.889_098_913_681_700_8,
        0.636_653_582_148_241_3,
        0.0,
    ];
    assert_close(four_velocity(&moment), velocity, 2e-15);
}

/// The errors of the integrators on the general type; the numbers are written with 3 digits.
#[test]
fn integrators_err_as_their_orders_say() {
    let (a, w) = (DVec3::new(0.5, 0.2, 0.0), DVec3::new(0.0, 0.1, 0.7));
    let exact = from_rest(free(2.0, a, w)).moment(2.0).event();
    let error = |integrator: Integrator| {
        let segments = vec![free(2.0, a, w)];
        let flight = Flight::new(start(Velocity::ZERO), segments, integrator).expect("possible");
        (flight.moment(2.0).event() - exact).position.length()
    };
    for (steps, expected) in [(20, 7.36e-2), (200, 7.37e-3), (2000, 7.37e-4)] {
        let found = error(Integrator::euler(2.0 / f64::from(steps)).expect("a step"));
        assert!((found / expected - 1.0).abs() < 2e-3, "{steps}: {found:e}");
    }
    for (steps, expected) in [(5, 2.9e-5), (10, 1.76e-6), (20, 1.08e-7), (40, 6.7e-9)] {
        let found = error(Integrator::runge_kutta_4(2.0 / f64::from(steps)).expect("a step"));
        assert!((found / expected - 1.0).abs() < 2e-2, "{steps}: {found:e}");
    }
}

/// The flight of the paper's Figs 7 to 9.
#[test]
fn the_flight_of_the_paper() {
    let segments = vec![
        free(2.1, DVec3::NEG_Z * 0.26085503293665, DVec3::ZERO),
        free(1.6, DVec3::NEG_Z * 0.32718303025942, DVec3::ZERO),
    ];
    let ahead = Velocity::from_beta(0.95, DVec3::NEG_Z).expect("below 1");
    let flown = flight(start(ahead), segments);
    for (proper_time, beta, rapidity, distance, time) in [
        (0.0, 0.95, 1.83178082306482, 0.0, 0.0),
        (
            2.1,
            0.983,
            2.37957639223179,
            8.60207752304855,
            8.86098900382717,
        ),
        (
            3.7,
            0.994,
            2.90306924064686,
            8.60207752304855 + 11.2963528324796,
            8.86098900382717 + 11.4116864164835,
        ),
    ] {
        let moment = flown.moment(proper_time);
        assert!((moment.velocity().beta() - beta).abs() < 1e-14);
        assert!((moment.velocity().rapidity() - rapidity).abs() < 1e-13);
        assert_close(four(moment.event()), [time, 0.0, 0.0, -distance], 1e-12);
    }
}
