//! Where `f64` loses all digits if nothing is done about it: `fixtures/hard_cases.json`, references in 6000 bits.
//!
//! `cargo test --test it hard_cases -- --nocapture` prints a table of the errors, in units in the last place of
//! what they are errors of, beside those of the formulas in textbooks: `gamma (d_par + beta r)` with `beta` and `gamma`
//! as numbers, products of 4x4 matrices, differences of distances.
//!
//! # Where the limits come from
//!
//! `UNITS` units in the last place: the roundings that follow each other, half a unit each, as counted at `MAP` in
//! `tests/it/physics/accuracy.rs`; of a position relative to its distance, of a Doppler factor, a rapidity, a gap to
//! itself, of directions and rotations to 1. Three quantities have another natural size:
//!
//! - one scene, `AS_GIVEN`, may be off, beyond that, by what half a unit in the last place of the scene's own numbers
//!   does: half an epsilon times the size of every vector and speed given, times the derivative of the place
//!   seen by it (`conditioning` in `fixtures/hard_cases.py`). So far off is what is seen exactly in a scene whose
//!   numbers are the given ones before they were rounded;
//! - a normal is a sum of terms that may cancel, and its own last place may count more close behind a fast
//!   observer: `normal_limit` in `common/mod.rs`;
//! - a gap is compared with itself and what it changes by where each corner is moved by its own length, which is
//!   `lambda_i |d_i - r_i x / |x||` at the worst place `x`: where the angle `theta` between corners is small this is
//!   `1 / theta` times the gap. It is rounded up on purpose, that of a triangle by up to `PLANE_UNITS` of itself.

use crate::common::normal_limit;
use photosurface::light_cone::{PhotosurfaceMap, View};
use photosurface::spacetime::{Event, Lorentz, WorldLine};
use photosurface::tessellate::{edge_gap, triangle_gap};
use photosurface::{DVec3, Velocity};
use serde_json::Value;

const UNITS: f64 = 8.0;

/// The one scene of which less is known than 8 units: 1e9 before, half a unit in the last place is 6e-8, of which gamma
/// 1e6 makes more than what is left of the way.
const AS_GIVEN: &str = "a fast thing met after 1e9";

/// What is added to the gap of a triangle so that it is never too small: 34 epsilon for `2 p q s`, 32 for the terms it
/// is divided by, in size up to 4 times their sum where no angle is obtuse (else the maximum is on an edge); and as
/// much again for the roundings it is added for.
const PLANE_UNITS: f64 = 2.0 * (34.0 + 4.0 * 32.0);

/// Errors below this are the spacing of subnormal numbers, not relative ones.
const SUBNORMAL: f64 = 4.0 * 5e-324;

fn fixture() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/hard_cases.json");
    let text = std::fs::read_to_string(path).expect("the fixture is there");
    serde_json::from_str(&text).expect("the fixture is JSON")
}

fn cases<'a>(fixture: &'a Value, kind: &str, least: usize) -> &'a [Value] {
    let cases = fixture[kind].as_array().expect("a list of cases");
    assert!(cases.len() >= least, "only {} cases of {kind}", cases.len());
    cases
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| number(&value[i])))
}

fn velocity(value: &Value) -> Velocity {
    let direction = vector(&value["direction"]);
    let of = |key: &str| value.get(key).map(number);
    let made = match (
        of("rapidity"),
        of("gamma"),
        of("one_minus_beta"),
        of("beta"),
    ) {
        (Some(rapidity), ..) => Velocity::from_rapidity(rapidity, direction),
        (_, Some(gamma), ..) => Velocity::from_gamma(gamma, direction),
        (_, _, Some(one_minus_beta), _) => Velocity::from_one_minus_beta(one_minus_beta, direction),
        (.., beta) => Velocity::from_beta(beta.expect("some speed"), direction),
    };
    made.expect("a velocity")
}

/// How far a number is from a reference of two.
fn difference(found: f64, reference: &Value) -> f64 {
    (found - number(&reference[0])) - number(&reference[1])
}

fn distance(found: DVec3, reference: &Value) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|i| difference(found[i], &reference[i]));
    // Without squares, which may vanish or overflow.
    x.hypot(y).hypot(z)
}

fn size(vector: DVec3) -> f64 {
    vector.x.hypot(vector.y).hypot(vector.z)
}

/// The errors of one quantity: ours, the naive ones, and the worst of ours.
struct Table {
    quantity: &'static str,
    rows: usize,
    worst: f64,
    worst_case: String,
    naive_useless: usize,
    naive_worst: f64,
}

impl Table {
    fn new(quantity: &'static str) -> Self {
        println!("\n{quantity}: ours and naive, in units in the last place");
        Self {
            quantity,
            rows: 0,
            worst: 0.0,
            worst_case: String::new(),
            naive_useless: 0,
            naive_worst: 0.0,
        }
    }

    #[track_caller]
    fn row(&mut self, name: &str, [ours, naive]: [f64; 2], size: f64, units: f64) {
        let in_units = |error: f64| {
            if error <= SUBNORMAL {
                0.0
            } else {
                error / (size * f64::EPSILON)
            }
        };
        let (ours, naive) = (in_units(ours), in_units(naive));
        println!("{ours:12.3} {naive:12.3e}  {name}");
        assert!(
            ours <= units,
            "{} of {name}: off by {ours:e} units in the last place, limit {units}",
            self.quantity
        );
        self.rows += 1;
        if ours >= self.worst {
            (self.worst, self.worst_case) = (ours, name.to_owned());
        }
        self.naive_worst = self.naive_worst.max(naive);
        // Not one digit is left; NaN is worse than that.
        self.naive_useless += usize::from(!(naive < 0.1 / f64::EPSILON));
    }

    fn finish(self) {
        println!(
            "{}: {} cases, worst {:.3} units in the last place ({}); naive: no digit right in {}",
            self.quantity, self.rows, self.worst, self.worst_case, self.naive_useless
        );
        assert!(self.naive_worst > 1e6, "nothing hard in it");
    }
}

/// The formulas as textbooks have them.
mod naive {
    use super::{DVec3, Velocity};

    pub(super) type Matrix = [[f64; 4]; 4];

    pub(super) fn position(velocity: &Velocity, d: DVec3) -> DVec3 {
        let (n, r) = (velocity.direction(), d.length());
        let (beta, gamma) = (velocity.beta(), velocity.rapidity().cosh());
        let parallel = n.dot(d);
        (d - n * parallel) + n * (gamma * (parallel + beta * r))
    }

    pub(super) fn doppler(velocity: &Velocity, d: DVec3) -> f64 {
        let cosine = velocity.direction().dot(d) / d.length();
        velocity.rapidity().cosh() * (1.0 + velocity.beta() * cosine)
    }

    pub(super) fn normal(velocity: &Velocity, d: DVec3, normal: DVec3) -> DVec3 {
        let n = velocity.direction();
        let (gamma, gamma_beta) = (velocity.rapidity().cosh(), velocity.rapidity().sinh());
        let a = n * (gamma - 1.0) + d * (gamma_beta / d.length());
        (normal - a * (n.dot(normal) / doppler(velocity, d))).normalize()
    }

    pub(super) fn boost(velocity: &Velocity) -> Matrix {
        let n = velocity.direction();
        let gamma = 1.0 / (1.0 - velocity.beta() * velocity.beta()).sqrt();
        let gamma_beta = gamma * velocity.beta();
        std::array::from_fn(|i| {
            std::array::from_fn(|j| match (i, j) {
                (0, 0) => gamma,
                (0, k) | (k, 0) => -gamma_beta * n[k - 1],
                _ => f64::from(u8::from(i == j)) + (gamma - 1.0) * n[i - 1] * n[j - 1],
            })
        })
    }

    pub(super) fn product(left: &Matrix, right: &Matrix) -> Matrix {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..4).map(|k| left[i][k] * right[k][j]).sum())
        })
    }

    pub(super) fn apply(matrix: &Matrix, event: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|i| (0..4).map(|k| matrix[i][k] * event[k]).sum())
    }

    /// The largest of a hundred differences of distances.
    pub(super) fn gap(corners: &[DVec3]) -> f64 {
        let of = |weights: &[f64]| {
            let pairs = || weights.iter().zip(corners);
            let place: DVec3 = pairs().map(|(&weight, &corner)| corner * weight).sum();
            pairs()
                .map(|(weight, corner)| weight * corner.length())
                .sum::<f64>()
                - place.length()
        };
        let steps = || (1..100).map(|step| f64::from(step) / 100.0);
        let gaps = steps().flat_map(|s| match corners.len() {
            2 => vec![of(&[1.0 - s, s])],
            _ => steps()
                .map(|t| of(&[1.0 - s, s * (1.0 - t), s * t]))
                .collect(),
        });
        gaps.fold(f64::NEG_INFINITY, f64::max)
    }
}

#[test]
fn positions_seen() {
    let mut table = Table::new("position");
    for case in cases(&fixture(), "map", 200) {
        let (velocity, offset) = (velocity(&case["velocity"]), vector(&case["offset"]));
        let found = PhotosurfaceMap::new(&velocity).seen_position(offset);
        let errors = [found, naive::position(&velocity, offset)];
        let errors = errors.map(|found| distance(found, &case["position"]));
        let size = number(&case["emission_time"][0]).abs();
        table.row(case["name"].as_str().expect("a name"), errors, size, UNITS);
    }
    table.finish();
}

#[test]
fn times_of_emission() {
    let mut table = Table::new("time of emission");
    for case in cases(&fixture(), "map", 200) {
        let (velocity, offset) = (velocity(&case["velocity"]), vector(&case["offset"]));
        let found = PhotosurfaceMap::new(&velocity).emission_time(offset);
        let errors = [found, -naive::position(&velocity, offset).length()];
        let errors = errors.map(|found| difference(found, &case["emission_time"]).abs());
        let size = number(&case["emission_time"][0]).abs();
        table.row(case["name"].as_str().expect("a name"), errors, size, UNITS);
    }
    table.finish();
}

#[test]
fn doppler_factors() {
    let mut table = Table::new("Doppler factor");
    for case in cases(&fixture(), "map", 200) {
        let (velocity, offset) = (velocity(&case["velocity"]), vector(&case["offset"]));
        let found = PhotosurfaceMap::new(&velocity).doppler_factor(offset);
        let errors = [found, naive::doppler(&velocity, offset)];
        let errors = errors.map(|found| difference(found, &case["doppler"]).abs());
        let size = number(&case["doppler"][0]);
        table.row(case["name"].as_str().expect("a name"), errors, size, UNITS);
    }
    table.finish();
}

#[test]
fn normals() {
    let mut table = Table::new("normal");
    for case in cases(&fixture(), "map", 200) {
        let (velocity, offset) = (velocity(&case["velocity"]), vector(&case["offset"]));
        let normal = vector(&case["normal"]);
        let found = PhotosurfaceMap::new(&velocity).seen_normal(offset, normal);
        let errors = [found, naive::normal(&velocity, offset, normal)];
        let errors = errors.map(|found| distance(found, &case["seen_normal"]));
        // Only the direction counts, and its square must not vanish.
        let near = offset / offset.abs().max_element();
        let unit = f64::EPSILON;
        let units = normal_limit(&velocity, near, normal, UNITS * unit, UNITS * unit) / unit;
        table.row(case["name"].as_str().expect("a name"), errors, 1.0, units);
    }
    table.finish();
}

#[test]
fn compositions() {
    let fixture = fixture();
    let mut rapidities = Table::new("composed rapidity, exp(rapidity)");
    for case in cases(&fixture, "composition", 40) {
        let name = case["name"].as_str().expect("a name");
        let (first, second) = (velocity(&case["first"]), velocity(&case["second"]));
        let whole = Lorentz::boost(first).then(&Lorentz::boost(second));
        let boost = whole.boost_velocity();
        let matrix = naive::product(&naive::boost(&second), &naive::boost(&first));
        let errors = [boost.rapidity(), matrix[0][0].acosh()];
        let errors = errors.map(|found| difference(found, &case["rapidity"]).abs());
        rapidities.row(name, errors, number(&case["rapidity"][0]), UNITS);
        let growth = [
            boost.stretch(),
            matrix[0][0] + (matrix[0][0].powi(2) - 1.0).sqrt(),
        ];
        let errors = growth.map(|found| difference(found, &case["stretch"]).abs());
        rapidities.row(name, errors, number(&case["stretch"][0]), UNITS);
    }
    rapidities.finish();

    let mut directions = Table::new("composed direction, rotation of the axes");
    for case in cases(&fixture, "composition", 40) {
        let name = case["name"].as_str().expect("a name");
        let (first, second) = (velocity(&case["first"]), velocity(&case["second"]));
        let whole = Lorentz::boost(first).then(&Lorentz::boost(second));
        let matrix = naive::product(&naive::boost(&second), &naive::boost(&first));
        let row = DVec3::new(matrix[0][1], matrix[0][2], matrix[0][3]);
        let errors = [whole.boost_velocity().direction(), -row.normalize()];
        let errors = errors.map(|found| distance(found, &case["direction"]));
        directions.row(name, errors, 1.0, UNITS);
        for (axis, direction) in DVec3::AXES.into_iter().enumerate() {
            let turned = whole.rotation() * direction;
            let error = (0..3)
                .map(|row| difference(turned[row], &case["rotation"][row][axis]))
                .fold(0.0, f64::hypot);
            directions.row(name, [error, f64::NAN], 1.0, UNITS);
        }
    }
    directions.finish();
}

#[test]
fn scenes() {
    let mut table = Table::new("position in a scene");
    for case in cases(&fixture(), "scene", 9) {
        let event: [f64; 4] = [0, 1, 2, 3].map(|i| number(&case["event"][i]));
        let observer = WorldLine {
            origin: Event::new(event[0], DVec3::new(event[1], event[2], event[3])),
            velocity: velocity(&case["observer"]),
        };
        let object = WorldLine {
            origin: Event::new(0.0, vector(&case["origin"])),
            velocity: velocity(&case["object"]),
        };
        let vertex = vector(&case["vertex"]);
        let view = View::new(&observer.moment(0.0), &object);
        let found = view.seen_position(vertex);

        let to_rest = naive::boost(&object.velocity);
        let back = naive::boost(&object.velocity.reversed());
        let apart = observer.origin - object.origin;
        let [x, y, z] = apart.position.to_array();
        let [_, x, y, z] = naive::apply(&to_rest, [apart.time, x, y, z]);
        let d = vertex - DVec3::new(x, y, z);
        let matrix = naive::product(&naive::boost(&observer.velocity), &back);
        let [_, x, y, z] = naive::apply(&matrix, [-d.length(), d.x, d.y, d.z]);

        let errors = [found, DVec3::new(x, y, z)].map(|found| distance(found, &case["position"]));
        let name = case["name"].as_str().expect("a name");
        let seen = DVec3::from_array([0, 1, 2].map(|i| number(&case["position"][i][0])));
        let of_given = match name {
            AS_GIVEN => 0.5 * number(&case["natural"]) / size(seen),
            _ => 0.0,
        };
        table.row(name, errors, size(seen), UNITS + of_given);
    }
    table.finish();
}

#[test]
fn gaps() {
    let mut table = Table::new("gap");
    for case in cases(&fixture(), "gap", 13) {
        let corners: Vec<DVec3> = case["corners"]
            .as_array()
            .expect("corners")
            .iter()
            .map(vector)
            .collect();
        let (found, plane) = match corners[..] {
            [a, b] => (edge_gap(a, b), 0.0),
            [a, b, c] => (triangle_gap(a, b, c), PLANE_UNITS),
            _ => panic!("two or three corners"),
        };
        let name = case["name"].as_str().expect("a name");
        let error = difference(found, &case["gap"]);
        assert!(error >= 0.0, "{name}: the bound is below the gap");
        let naive = difference(naive::gap(&corners), &case["gap"]).abs();
        let (gap, natural) = (number(&case["gap"][0]), number(&case["natural"]));
        table.row(name, [error, naive], natural, UNITS + plane * gap / natural);
    }
    table.finish();
}
