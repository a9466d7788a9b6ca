//! Lorentz transformations against products of 4x4 matrices in 300 digits.
//!
//! The library composes in SL(2,C) from rapidities and half angles; the reference multiplies the
//! matrices of the boosts and takes the product apart. Limits: see `common/mod.rs`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::oracle::{self, Big, big, big_vector, small};
use crate::common::{RELATIVE, Random, TURN, Worst};
use photosurface::light_cone::{PhotosurfaceMap, View};
use photosurface::spacetime::{Event, Lorentz, WorldLine};
use photosurface::{DVec3, Velocity};

/// A pair of boosts, first and second, and what their directions make of rounding.
struct Pair {
    first: Velocity,
    second: Velocity,
}

impl Pair {
    /// All pairs of slow and fast, and of directions that are anywhere, perpendicular, nearly equal
    /// and nearly opposite, down to the neighbouring float.
    fn all() -> Vec<Self> {
        let rapidities = [1e-9, 0.1, 1.0, 3.0, 10.0, 30.0, 150.0];
        let between = [1e-16, 1e-12, 1e-8, 1e-4, 0.1, 1.0, FRAC_PI_2];
        let mut random = Random::new(3);
        let mut pairs = Vec::new();
        for first_rapidity in rapidities {
            for second_rapidity in rapidities.into_iter().chain([first_rapidity + 1e-9]) {
                for angle in between.into_iter().chain(between.map(|angle| PI - angle)) {
                    let direction = random.direction();
                    let aside = direction.cross(random.direction()).normalize();
                    let other = direction * angle.cos() + aside * angle.sin();
                    pairs.push(Self {
                        first: Velocity::from_rapidity(first_rapidity, direction).expect("valid"),
                        second: Velocity::from_rapidity(second_rapidity, other).expect("valid"),
                    });
                }
            }
        }
        pairs
    }

    fn describe(&self) -> String {
        format!("{:?} then {:?}", self.first, self.second)
    }

    fn composed(&self) -> Lorentz {
        Lorentz::boost(self.first).then(&Lorentz::boost(self.second))
    }
}

/// The rapidity, the direction and the rotation that a product of Lorentz matrices amounts to.
fn decompose(matrix: &oracle::Matrix) -> (Big, oracle::Vector, oracle::Matrix) {
    // Row 0 is (gamma, -gamma beta n); exp(eta) = gamma + gamma beta.
    let minus_gamma_beta_n: oracle::Vector = std::array::from_fn(|i| matrix[0][i + 1].clone());
    let gamma_beta = oracle::length(&minus_gamma_beta_n);
    let rapidity = (matrix[0][0].clone() + &gamma_beta).ln();
    let direction = minus_gamma_beta_n.map(|component| -component / &gamma_beta);

    // Undo the boost: I + (gamma - 1) n n^T in space, gamma beta n where space and time mix.
    let gamma = &matrix[0][0];
    let boost_back: oracle::Matrix = std::array::from_fn(|row| {
        std::array::from_fn(|column| match (row, column) {
            (0, 0) => gamma.clone(),
            (0, i) | (i, 0) => gamma_beta.clone() * &direction[i - 1],
            (i, j) => {
                let unit = big(if i == j { 1.0 } else { 0.0 });
                unit + (gamma.clone() - big(1.0)) * &direction[i - 1] * &direction[j - 1]
            }
        })
    });
    let rotation = oracle::product(matrix, &boost_back);
    (rapidity, direction, rotation)
}

/// The largest distance between where two rotations turn the axes.
fn rotation_error(transformation: &Lorentz, exact: &oracle::Matrix) -> f64 {
    let axes = DVec3::AXES.iter().enumerate();
    axes.map(|(column, axis)| {
        let exact: oracle::Vector = std::array::from_fn(|row| exact[row + 1][column + 1].clone());
        oracle::vector_error(transformation.rotation() * *axis, &exact)
    })
    .fold(0.0, f64::max)
}

/// Directions count as they were given, and nothing cancels: only relative roundings are left.
#[test]
fn rapidities_compose_to_a_few_units_in_the_last_place() {
    let mut worst = Worst::new("composed rapidity");
    for pair in Pair::all() {
        let product = oracle::product(&oracle::boost(&pair.second), &oracle::boost(&pair.first));
        let (rapidity, ..) = decompose(&product);
        let size = small(&rapidity);
        let limit = RELATIVE * size;
        let error = oracle::error(pair.composed().boost_velocity().rapidity(), &rapidity);
        worst.record(error, limit, size, || pair.describe());
    }
    worst.check();
}

/// The direction is that of `v`, turned by the rotation's half, neither of which cancels.
#[test]
fn directions_compose_to_a_few_units_in_the_last_place() {
    let mut directions = Worst::new("composed direction");
    let mut rotations = Worst::new("Wigner rotation");
    for pair in Pair::all() {
        let product = oracle::product(&oracle::boost(&pair.second), &oracle::boost(&pair.first));
        let (_, direction, rotation) = decompose(&product);
        let composed = pair.composed();

        let error = oracle::vector_error(composed.boost_velocity().direction(), &direction);
        directions.record(error, RELATIVE, 1.0, || pair.describe());

        let error = rotation_error(&composed, &rotation);
        rotations.record(error, RELATIVE, 1.0, || pair.describe());
    }
    directions.check();
    rotations.check();
}

/// The matrix of what the library computed.
fn matrix_of(transformation: &Lorentz) -> oracle::Matrix {
    let columns = DVec3::AXES.map(|axis| big_vector(transformation.rotation() * axis));
    let rotation: oracle::Matrix = std::array::from_fn(|row| {
        std::array::from_fn(|column| match (row, column) {
            (0, 0) => big(1.0),
            (0, _) | (_, 0) => big(0.0),
            (i, j) => columns[j - 1][i - 1].clone(),
        })
    });
    oracle::product(&rotation, &oracle::boost(&transformation.boost_velocity()))
}

fn largest_difference(a: &oracle::Matrix, b: &oracle::Matrix) -> f64 {
    let entries = a.iter().flatten().zip(b.iter().flatten());
    entries
        .map(|(a, b)| small(&(a.clone() - b)).abs())
        .fold(0.0, f64::max)
}

/// A boost is a matrix of norm `exp(eta)`. Each is given, and each product rounded, as if its direction
/// were turned by `TURN` and its rapidity and rotation changed by `RELATIVE` times themselves.
#[test]
fn chains_of_boosts_act_like_products_of_matrices() {
    let mut chains = Worst::new("three boosts in a row");
    let mut inverses = Worst::new("three boosts and back");
    let mut random = Random::new(4);
    for _ in 0..1000 {
        let mut whole = Lorentz::IDENTITY;
        let mut exact = oracle::boost(&Velocity::ZERO);
        let mut total = 0.0;
        for _ in 0..3 {
            let rapidity = random.between(0.0, 30.0);
            let velocity = Velocity::from_rapidity(rapidity, random.direction()).expect("valid");
            whole = whole.then(&Lorentz::boost(velocity));
            exact = oracle::product(&oracle::boost(&velocity), &exact);
            total += rapidity;
        }
        let change = 3.0 * (2.0 * TURN + RELATIVE * (1.0 + total));
        let error = largest_difference(&matrix_of(&whole), &exact);
        chains.record(error, change * total.exp(), total.exp(), || {
            format!("{whole:?}")
        });

        // Going back there is one boost and one rotation of a direction.
        let there_and_back = oracle::product(&matrix_of(&whole.inverse()), &matrix_of(&whole));
        let error = largest_difference(&there_and_back, &oracle::boost(&Velocity::ZERO));
        let size = (2.0 * whole.boost_velocity().rapidity()).exp();
        inverses.record(error, 2.0 * TURN * size, size, || format!("{whole:?}"));
    }
    chains.check();
    inverses.check();
}

/// Light-cone coordinates are multiplied by `exp(eta)` and `exp(-eta)`, so both the result and its
/// error may grow by `exp(eta)`: relative roundings of the event's own size.
#[test]
fn events_transform_like_columns_and_keep_their_interval() {
    let mut events = Worst::new("transformed event");
    let mut intervals = Worst::new("interval");
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let rapidity = random.between(0.0, 30.0);
        let velocity = Velocity::from_rapidity(rapidity, random.direction()).expect("valid");
        let event = Event::new(random.between(-5.0, 5.0), random.direction() * 3.0);
        let transformed = Lorentz::boost(velocity).apply(event);

        let [x, y, z] = big_vector(event.position);
        let [time, x, y, z] = oracle::apply(&oracle::boost(&velocity), &[big(event.time), x, y, z]);
        let error = oracle::error(transformed.time, &time)
            .hypot(oracle::vector_error(transformed.position, &[x, y, z]));
        let size = event.time.abs() + event.position.length();
        let case = || format!("{event:?}, {velocity:?}");
        let limit = RELATIVE * rapidity.exp() * size;
        events.record(error, limit, rapidity.exp() * size, case);

        // A product of two coordinates, each of which may be in error that much.
        let new_size = transformed.time.abs() + transformed.position.length();
        let difference = (transformed.interval() - event.interval()).abs();
        intervals.record(
            difference,
            2.0 * limit * new_size,
            new_size * new_size,
            case,
        );
    }
    events.check();
    intervals.check();
}

#[test]
fn collinear_boosts_compose_to_the_sum_of_rapidities_exactly() {
    let mut random = Random::new(6);
    for _ in 0..1000 {
        let direction = random.direction();
        // Multiples of 2^-40 up to 150: their sums and differences are numbers, too.
        let grid = |value: f64| (value * 2f64.powi(40)).round() * 2f64.powi(-40);
        let [a, b] = [150.0, 150.0].map(|most| grid(random.between(0.0, most)));
        let first = Velocity::from_rapidity(a, direction).expect("valid");
        let second = Velocity::from_rapidity(b, direction).expect("valid");

        let together = Lorentz::boost(first).then(&Lorentz::boost(second));
        assert_eq!(together, Lorentz::boost(together.boost_velocity()));
        assert_eq!(together.boost_velocity().rapidity(), a + b);
        assert_eq!(together.boost_velocity().direction(), first.direction());

        let relative = Lorentz::between(first, second);
        assert_eq!(relative, Lorentz::boost(relative.boost_velocity()));
        assert_eq!(relative.boost_velocity().rapidity(), (b - a).abs());
        let forward = first.direction() * (b - a).signum();
        assert_eq!(relative.boost_velocity().direction(), forward);
    }
}

/// 10,000 boosts along one direction of 0.001 have a rapidity of 10, but for the roundings of their sum;
/// 1000 boosts anywhere and the same back leave what 2000 roundings of compositions may.
#[test]
fn many_compositions_do_not_drift() {
    let steps = 10_000;
    let step = Lorentz::boost(Velocity::from_rapidity(1e-3, DVec3::X).expect("valid"));
    let mut whole = Lorentz::IDENTITY;
    for _ in 0..steps {
        whole = whole.then(&step);
    }
    let boost = whole.boost_velocity();
    let limit = f64::from(steps) * RELATIVE * 10.0;
    assert!((boost.rapidity() - 10.0).abs() <= limit, "{boost:?}");
    assert_eq!(boost.direction(), DVec3::X);

    // There by many ways and back: nothing is left but the roundings, which rapidities of 1 magnify by e at most.
    let mut random = Random::new(9);
    let mut there = Lorentz::IDENTITY;
    let mut ways = Vec::new();
    for _ in 0..1000 {
        let velocity = Velocity::from_rapidity(random.between(0.0, 1e-2), random.direction());
        let way = Lorentz::boost(velocity.expect("valid"));
        there = there.then(&way);
        ways.push(way);
    }
    for way in ways.iter().rev() {
        there = there.then(&way.inverse());
    }
    let left = there.boost_velocity().rapidity();
    assert!(left <= 2000.0 * 3.0 * (RELATIVE + TURN), "{left:e} is left");
    let turned = 2.0 * there.rotation().xyz().length();
    assert!(
        turned <= 2000.0 * 3.0 * (RELATIVE + TURN),
        "turned by {turned:e}"
    );
}

/// Once around a circle at 0.6 c in `steps` equal steps: each is the boost from the velocity before to the next, in
/// the axes that were carried along without turning. How far these have turned in the end.
fn carried_around(steps: u32) -> Lorentz {
    let velocity = |step: u32| {
        let (sine, cosine) = (TAU * f64::from(step) / f64::from(steps)).sin_cos();
        Velocity::from_beta(0.6, DVec3::new(cosine, sine, 0.0)).expect("valid")
    };
    let mut carried = Lorentz::boost(velocity(0));
    for step in 0..steps {
        let to_next = Lorentz::between(velocity(step), velocity(step + 1)).boost_velocity();
        let turned = carried.rotation() * to_next.direction();
        let next = Velocity::from_rapidity(to_next.rapidity(), turned).expect("valid");
        carried = carried.then(&Lorentz::boost(next));
    }
    carried
}

/// The angle about z by which axes have turned, against the sense of the flight: what stood still has turned with it.
fn turned_back(carried: &Lorentz) -> f64 {
    let still = carried.rotation() * DVec3::X;
    still.y.atan2(still.x)
}

/// Thomas's angle after one turn, `2 pi (gamma - 1)`: 90 degrees at 0.6 c. A polygon of `N` corners has Wigner's at each
/// of them, `tan(angle / 2) = sin(phi) / (k - cos(phi))` with `k = (gamma + 1) / (gamma - 1)` and `phi = 2 pi / N`,
/// which tends to it with `1 / N^2`. 100,000 compositions keep to it but for their roundings:
/// each is that of a product of boosts of `exp(2 eta) = 4` at most.
#[test]
fn a_hundred_thousand_compositions_turn_by_the_angle_of_thomas() {
    let of_polygon = |steps: u32| {
        let phi = TAU / f64::from(steps);
        f64::from(steps) * 2.0 * (phi.sin() / (9.0 - phi.cos())).atan()
    };
    let errors = [100, 200, 400, 800].map(|steps| {
        let turned = turned_back(&carried_around(steps));
        let limit = f64::from(steps) * 4.0 * (RELATIVE + TURN);
        assert!(
            (turned - of_polygon(steps)).abs() <= limit,
            "{steps}: {turned}"
        );
        (turned - FRAC_PI_2).abs()
    });
    for pair in errors.windows(2) {
        // The next term of the series is smaller by phi^2.
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.01, "{errors:?}");
    }

    let steps = 100_000;
    let carried = carried_around(steps);
    let limit = f64::from(steps) * 4.0 * (RELATIVE + TURN);
    let error = (turned_back(&carried) - of_polygon(steps)).abs();
    assert!(error <= limit, "{error:e} beyond {limit:e}");
    let boost = carried.boost_velocity();
    assert!((boost.rapidity() - 2f64.ln()).abs() <= limit, "{boost:?}");
    assert!(
        (boost.direction() - DVec3::X).length() <= limit,
        "{boost:?}"
    );
}

/// At gamma 1e6 along one direction a fleet is at rest with its observer, and what is faster by a rapidity of 0.5
/// comes out as slow as that.
#[test]
fn a_fast_fleet_is_slow_to_one_of_its_own() {
    for direction in [DVec3::X, DVec3::new(1.0, 2.0, 3.0)] {
        let fleet = Velocity::from_gamma(1e6, direction).expect("valid");
        let relative = Lorentz::between(fleet, fleet);
        assert_eq!(relative, Lorentz::boost(relative.boost_velocity()));
        assert_eq!(relative.boost_velocity().rapidity(), 0.0);
        let origin = |place| WorldLine {
            origin: Event::new(0.0, place),
            velocity: fleet,
        };
        let across = direction.any_orthonormal_vector();
        let view = View::new(&origin(DVec3::ZERO).moment(2.0), &origin(DVec3::ZERO));
        for place in [direction, -direction, across] {
            assert_eq!(view.seen_position(place), place);
        }
        // Rapidities that are numbers, so that their difference is.
        let [slow, fast] =
            [14.5, 15.0].map(|eta| Velocity::from_rapidity(eta, direction).expect("valid"));
        let relative = Lorentz::between(slow, fast).boost_velocity();
        assert_eq!(relative.rapidity(), 0.5);
        assert_eq!(relative.direction(), slow.direction());
    }
}

/// Two stretches of about one size were multiplied, and where the product rounded below 1 a bound was below its own
/// lower bound: 30 of the 99 speeds of a hundredth, two hundredths... of that of light ended in a panic.
#[test]
fn equal_and_all_but_equal_velocities_are_at_rest_to_each_other() {
    let mut random = Random::new(12);
    let mut velocities = vec![];
    for direction in [
        DVec3::X,
        DVec3::NEG_Z,
        DVec3::new(1.0, 2.0, 3.0),
        random.direction(),
        random.direction(),
    ] {
        let speeds = (1..100).map(|n| Velocity::from_beta(f64::from(n) / 100.0, direction));
        let factors = (0..150).map(|n| Velocity::from_gamma(10f64.powi(n), direction));
        let rapidities = (0..700).map(|n| Velocity::from_rapidity(0.5 * f64::from(n), direction));
        let near_light = (1..300).map(|n| Velocity::from_one_minus_beta(10f64.powi(-n), direction));
        let all = speeds.chain(factors).chain(rapidities).chain(near_light);
        velocities.extend(all.map(|velocity| velocity.expect("valid")));
    }
    for &velocity in &velocities {
        let (eta, direction) = (velocity.rapidity(), velocity.heading());
        let neighbours = [eta.next_down().max(0.0), eta, eta.next_up()]
            .map(|eta| Velocity::from_rapidity(eta.min(350.0), direction).expect("valid"));
        let turned = direction.with_x(direction.x.next_up());
        let turned = Velocity::from_rapidity(eta, turned).expect("valid");
        for other in neighbours.into_iter().chain([velocity, turned]) {
            for (from, to) in [(velocity, other), (other, velocity)] {
                let case = format!("{from:?} and {to:?}");
                let relative = Lorentz::between(from, to).boost_velocity();
                assert!(
                    relative.stretch() >= 1.0 && relative.rapidity() >= 0.0,
                    "{case}"
                );
                if other == velocity {
                    assert_eq!(
                        (relative.rapidity(), relative.stretch()),
                        (0.0, 1.0),
                        "{case}"
                    );
                }
                if other != turned {
                    // Two rapidities and two stretches, each known to a few units in its last place.
                    let limit = 8.0 * f64::EPSILON * (1.0 + eta);
                    assert!(relative.rapidity() <= limit, "{case}: {relative:?}");
                    assert!(relative.stretch() <= 1.0 + limit, "{case}: {relative:?}");
                }
                let map = PhotosurfaceMap::new(&relative);
                for place in [direction, -direction, DVec3::new(0.3, -0.4, 0.5)] {
                    let stretch = map.stretch_at(place);
                    assert!(
                        (1.0..=relative.stretch()).contains(&stretch),
                        "{case}: {stretch}"
                    );
                }
            }
        }
    }
}
