//! The gap of edges and triangles against references that know none of its formulas.
//!
//! The reference works on the line and in the plane: the chord of `hypot(h, s)` is farthest above it at
//! `s = h q / sqrt(1 - q^2)`, an affine function with in-plane gradient `g` at `h g / sqrt(1 - |g|^2)` from the
//! foot of the perpendicular. With 780 digits nothing has to be arranged so as not to cancel. The reference
//! itself must contain every sample of the definition.

use crate::common::Random;
use crate::common::oracle::{
    self, Big, Vector, cross, difference, dot, scaled, small, square_root, sum,
};
use photosurface::DVec3;
use photosurface::tessellate::{edge_gap, triangle_gap, triangle_gap_place};

/// How far above the true gap that of an edge may be, relatively: derived at `edge_gap`.
const EDGE_SLACK: f64 = 32.0 * f64::EPSILON;

type Corners = [DVec3; 3];

/// Exactly `value`, for 780 digits.
fn exact(value: f64) -> Big {
    Big::try_from(value)
        .expect("finite")
        .with_precision(2600)
        .value()
}

fn exact_vector(vector: DVec3) -> Vector {
    vector.to_array().map(exact)
}

fn zero() -> Big {
    exact(0.0)
}

/// What 780 digits may get wrong in a difference of distances like those of `corners`.
fn reference_error(corners: &[DVec3]) -> Big {
    let farthest = corners.iter().map(|corner| corner.abs().max_element());
    exact(1e-300) * exact(1e-300) * exact(1e-100) * exact(farthest.fold(0.0, f64::max))
}

fn larger(a: Big, b: Big) -> Big {
    if a > b { a } else { b }
}

/// The gap at the place with `weights`, by definition.
fn gap_at<const N: usize>(corners: [&Vector; N], weights: [&Big; N]) -> Big {
    let mut distance = zero();
    let mut place = [zero(), zero(), zero()];
    for (corner, weight) in corners.into_iter().zip(weights) {
        distance += oracle::length(corner) * weight;
        place = sum(&place, &scaled(corner, weight));
    }
    distance - oracle::length(&place)
}

fn true_edge_gap(a: &Vector, b: &Vector) -> Big {
    let along = difference(b, a);
    let length = oracle::length(&along);
    if length == zero() {
        return zero();
    }
    let (r_a, r_b) = (oracle::length(a), oracle::length(b));
    let slope = (r_b - &r_a) / &length;
    let start = dot(a, &along) / &length;
    let height = square_root(&larger(dot(a, a) - start.clone() * &start, zero()));
    let flat = square_root(&larger(exact(1.0) - slope.clone() * &slope, zero()));
    larger(r_a - slope * start - height * flat, zero())
}

fn true_triangle_gap([a, b, c]: &[Vector; 3]) -> Big {
    let edges = larger(
        true_edge_gap(a, b),
        larger(true_edge_gap(b, c), true_edge_gap(a, c)),
    );
    let (to_b, to_c) = (difference(b, a), difference(c, a));
    let normal = cross(&to_b, &to_c);
    let area = dot(&normal, &normal);
    if area == zero() {
        return edges;
    }
    let r_a = oracle::length(a);
    let gradient = sum(
        &scaled(
            &cross(&to_c, &normal),
            &((oracle::length(b) - &r_a) / &area),
        ),
        &scaled(
            &cross(&normal, &to_b),
            &((oracle::length(c) - &r_a) / &area),
        ),
    );
    let flat = exact(1.0) - dot(&gradient, &gradient);
    if flat <= zero() {
        return edges;
    }
    let flat = square_root(&flat);
    let foot = scaled(&normal, &(dot(&normal, a) / &area));
    let height = oracle::length(&foot);
    let place = sum(&foot, &scaled(&gradient, &(height.clone() / &flat)));
    let from_a = difference(&place, a);
    let weight_b = dot(&cross(&from_a, &to_c), &normal) / &area;
    let weight_c = dot(&cross(&to_b, &from_a), &normal) / &area;
    let weight_a = exact(1.0) - &weight_b - &weight_c;
    if weight_a < zero() || weight_b < zero() || weight_c < zero() {
        return edges;
    }
    let at_foot = r_a + dot(&gradient, &difference(&foot, a));
    larger(at_foot - height * flat, edges)
}

/// What the rounding up of one kind of triangle costs at most.
#[derive(Default)]
struct Slack {
    edge: f64,
    triangle: f64,
    worst: Corners,
}

impl Slack {
    /// Checks one triangle and its edges; takes down how far they are above the true gap.
    #[track_caller]
    fn check(&mut self, kind: &str, corners: Corners) {
        let [a, b, c] = corners;
        let big = corners.map(exact_vector);
        let nearest = corners
            .map(DVec3::length)
            .into_iter()
            .fold(f64::MAX, f64::min);
        let gap = triangle_gap(a, b, c);
        let truth = true_triangle_gap(&big);
        let over = self.above(kind, corners, gap, &truth, nearest);
        assert!(
            over <= 1.0 + 4.0 * EDGE_SLACK,
            "{kind}: {gap:e} is more than twice {:e} at {corners:?}",
            small(&truth)
        );
        if over > self.triangle {
            (self.triangle, self.worst) = (over, corners);
        }
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let edge = edge_gap(corners[i], corners[j]);
            let reversed = edge_gap(corners[j], corners[i]);
            assert_eq!(edge.to_bits(), reversed.to_bits(), "{kind}: {corners:?}");
            assert!(
                gap >= edge,
                "{kind}: {gap:e} below the edge's {edge:e} at {corners:?}"
            );
            let nearer = corners[i].length().min(corners[j].length());
            let truth = true_edge_gap(&big[i], &big[j]);
            let over = self.above(kind, corners, edge, &truth, nearer);
            assert!(
                over <= EDGE_SLACK,
                "{kind}: edge {i}-{j}: {edge:e} over {:e} by {over:e} at {corners:?}",
                small(&truth)
            );
            self.edge = self.edge.max(over);
        }
        for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let [a, b, c] = order.map(|i: usize| corners[i]);
            let other = triangle_gap(a, b, c);
            assert_eq!(
                gap.to_bits(),
                other.to_bits(),
                "{kind}: {corners:?}, {order:?}"
            );
        }
        let weights = triangle_gap_place(a, b, c);
        assert!(
            weights.iter().all(|weight| (0.0..=1.0).contains(weight))
                && (weights.iter().sum::<f64>() - 1.0).abs() < 4.0 * f64::EPSILON,
            "{kind}: weights {weights:?} at {corners:?}"
        );
    }

    /// By how much `gap` is above `truth`, relatively, beyond the absolute floor.
    #[track_caller]
    fn above(&self, kind: &str, corners: Corners, gap: f64, truth: &Big, nearest: f64) -> f64 {
        let truth = &(truth - reference_error(&corners));
        assert!(
            gap.is_finite() && exact(gap) >= *truth,
            "{kind}: {gap:e} is below the true {:e} at {corners:?}",
            small(truth)
        );
        let floor = exact(2e-160 * nearest.min(1e140)) + exact(4.0 * f64::from_bits(1));
        let over = exact(gap) - truth - floor;
        if over <= zero() {
            0.0
        } else if *truth <= zero() {
            f64::INFINITY
        } else {
            small(&(over / truth))
        }
    }

    fn print(&self, kind: &str) {
        println!(
            "{kind}: edges over by at most {:.1} epsilon, triangles by {:.1e} ({:?})",
            self.edge / f64::EPSILON,
            self.triangle,
            self.worst.map(|corner| corner.to_array())
        );
    }
}

fn power(random: &mut Random, low: f64, high: f64) -> f64 {
    10f64.powf(random.between(low, high))
}

/// A triangle with corners `n + size (x, y)` on the sky, at the given distances.
fn on_the_sky(random: &mut Random, size: f64, flat: [[f64; 2]; 3], distances: [f64; 3]) -> Corners {
    let n = random.direction();
    let right = n.cross(random.direction()).normalize();
    let up = n.cross(right);
    std::array::from_fn(|i| {
        let [x, y] = flat[i];
        (n + (right * x + up * y) * size).normalize() * distances[i]
    })
}

/// Corners with angles of at least 20 degrees in the plane, so 3 degrees on the sky.
fn sane(random: &mut Random) -> [[f64; 2]; 3] {
    loop {
        let corners: [DVec3; 3] = std::array::from_fn(|_| {
            DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.0)
        });
        let angle = |i: usize| {
            let [at, left, right] = [i, (i + 1) % 3, (i + 2) % 3].map(|i| corners[i]);
            (left - at).angle_between(right - at).to_degrees()
        };
        if (0..3).all(|i| angle(i) >= 20.0) {
            return corners.map(|corner| [corner.x, corner.y]);
        }
    }
}

/// A name and how to make one.
type Kind = (&'static str, fn(&mut Random) -> Corners);

fn kinds() -> Vec<Kind> {
    vec![
        ("sane on the sky", |random| {
            let distance = power(random, -9.0, 9.0);
            let size = power(random, -8.0, 0.0);
            let distances = std::array::from_fn(|_| distance * power(random, -0.5, 0.5));
            let flat = sane(random);
            on_the_sky(random, size, flat, distances)
        }),
        ("sane on the sky, any distances", |random| {
            let size = power(random, -8.0, 0.0);
            let distances = std::array::from_fn(|_| power(random, -9.0, 9.0));
            let flat = sane(random);
            on_the_sky(random, size, flat, distances)
        }),
        ("needle on the sky", |random| {
            let distance = power(random, -9.0, 9.0);
            let size = power(random, -8.0, 0.0);
            let spread = random.between(0.0, 1.0);
            let distances = std::array::from_fn(|_| distance * power(random, -spread, spread));
            let thin = power(random, -10.0, 0.0);
            let flat = sane(random).map(|[x, y]| [x, thin * y]);
            on_the_sky(random, size, flat, distances)
        }),
        ("needle in space", |random| {
            let distance = power(random, -9.0, 9.0);
            let (length, width) = (power(random, -6.0, 1.0), power(random, -12.0, 0.0));
            let (start, along) = (random.direction(), random.direction() * length);
            let aside = random.direction() * width * length;
            let part = random.between(-0.5, 1.5);
            [start, start + along, start + along * part + aside].map(|corner| corner * distance)
        }),
        ("anywhere", |random| {
            let distance = power(random, -9.0, 9.0);
            let size = power(random, -9.0, 2.0);
            let start = random.direction();
            std::array::from_fn(|_| (start + random.direction() * size) * distance)
        }),
        ("observer all but in the plane", |random| {
            let distance = power(random, -9.0, 9.0);
            let off = power(random, -20.0, -1.0);
            let (a, b) = (random.direction(), random.direction());
            let c = a * random.between(-2.0, 2.0) + b * random.between(-2.0, 2.0);
            [a, b, c + random.direction() * off].map(|corner| corner * distance)
        }),
        ("observer in the face or next to it", |random| {
            let distance = power(random, -9.0, 9.0);
            let off = random.direction() * power(random, -20.0, -1.0);
            let (a, b) = (random.direction(), random.direction());
            let c = a * random.between(-2.0, 0.0) + b * random.between(-2.0, 0.0);
            [a, b, c].map(|corner| (corner + off) * distance)
        }),
        ("observer on an edge or next to it", |random| {
            let distance = power(random, -9.0, 9.0);
            let off = random.direction() * power(random, -20.0, -1.0);
            let (a, c) = (random.direction(), random.direction());
            let b = a * -power(random, -3.0, 3.0);
            [a, b, c].map(|corner| (corner + off) * distance)
        }),
        ("observer on a corner or next to it", |random| {
            let distance = power(random, -9.0, 9.0);
            let near = [0.0, power(random, -40.0, -1.0)][(random.between(0.0, 2.0)) as usize];
            let a = random.direction() * near;
            [a, random.direction(), random.direction()].map(|corner| corner * distance)
        }),
        ("neighbouring floats", |random| {
            let a = random.direction() * power(random, -9.0, 9.0);
            let mut near = || {
                DVec3::from_array(a.to_array().map(|x| {
                    f64::from_bits(x.to_bits().wrapping_add(random.between(0.0, 4.0) as u64))
                }))
            };
            [a, near(), near()]
        }),
        ("collinear", |random| {
            let distance = power(random, -9.0, 9.0);
            let start = DVec3::new(1.0, 3.0, -2.0);
            let step = DVec3::new(0.25, -0.5, 0.125);
            let mut at = || (start + step * random.between(-8.0, 8.0).round()) * distance;
            [at(), at(), at()]
        }),
        ("towards the observer", |random| {
            let n = random.direction();
            let mut at = || n * power(random, -9.0, 9.0);
            [at(), at(), at()]
        }),
        ("huge and tiny", |random| {
            let exponent = [-1080, -1040, -900, -500, 500, 900, 1000];
            let exponent = exponent[random.between(0.0, 7.0) as usize];
            let start = random.direction();
            let size = power(random, -6.0, 1.0);
            std::array::from_fn(|_| {
                (start + random.direction() * size)
                    * 2f64.powi(exponent / 2)
                    * 2f64.powi(exponent - exponent / 2)
            })
        }),
        ("each of its own size", |random| {
            std::array::from_fn(|_| random.direction() * power(random, -320.0, 150.0))
        }),
    ]
}

#[test]
fn gaps_are_rounded_up_and_by_little() {
    for (kind, make) in kinds() {
        let mut random = Random::new(3);
        let mut slack = Slack::default();
        for _ in 0..400 {
            slack.check(kind, make(&mut random));
        }
        slack.print(kind);
        let limit = match kind {
            "sane on the sky" => 1e-12,
            // One corner as good as at the observer: only twice the worst edge is certain.
            "each of its own size" => 1.0 + 4.0 * EDGE_SLACK,
            _ => 1e-8,
        };
        assert!(slack.triangle < limit, "{kind}: {:e}", slack.triangle);
    }
}

/// The reference finds the maximum in the plane; here is the definition itself, at thousands of places,
/// most of them where the gap is largest.
#[test]
fn the_bound_contains_every_sample() {
    let mut random = Random::new(4);
    let mut closest: f64 = f64::INFINITY;
    for (kind, make) in kinds() {
        for _ in 0..12 {
            let corners = make(&mut random);
            let big = corners.each_ref().map(|corner| exact_vector(*corner));
            let [a, b, c] = &big;
            let gap = triangle_gap(corners[0], corners[1], corners[2]);
            let truth = true_triangle_gap(&big);
            let edge = edge_gap(corners[0], corners[1]);
            let place = triangle_gap_place(corners[0], corners[1], corners[2]);
            let error = reference_error(&corners);
            let mut largest = zero();
            for sample in 0..60 {
                // Ever closer to the place where the gap is largest.
                let nearness = 0.5f64.powi(sample % 30) * f64::from(u8::from(sample != 0));
                let mix = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
                let (low, high) = (mix[0].min(mix[1]), mix[0].max(mix[1]));
                let anywhere = [low, high - low, 1.0 - high];
                let part = |i: usize| place[i] + nearness * (anywhere[i] - place[i]);
                let (first, second) = (exact(part(0).max(0.0)), exact(part(1).max(0.0)));
                let third = larger(exact(1.0) - &first - &second, zero());
                let total = first.clone() + &second + &third;
                let [first, second, third] = [first, second, third].map(|part| part / &total);
                let weights = [&first, &second, &third];
                let at = gap_at([a, b, c], weights) - &error;
                assert!(
                    exact(gap) >= at && truth.clone() + &error >= at,
                    "{kind}: bound {gap:e}, reference {:e}, but {:e} with weights {:?} at {corners:?}",
                    small(&truth),
                    small(&at),
                    weights.map(small)
                );
                largest = larger(largest, at);
                let lambda = exact(random.between(0.0, 1.0));
                let at = gap_at([a, b], [&(exact(1.0) - &lambda), &lambda]) - &error;
                assert!(
                    exact(edge) >= at,
                    "{kind}: bound {edge:e}, but {:e} with weight {} of {:?}, {:?}",
                    small(&at),
                    small(&lambda),
                    corners[0],
                    corners[1]
                );
            }
            if kind.starts_with("sane") {
                closest = closest.min(small(&(largest / truth)));
            }
        }
    }
    println!("sane triangles have a sample with at least {closest} of the maximum");
    assert!(
        closest > 0.999_999,
        "the place of the largest gap is not there: {closest}"
    );
}

/// `error <= digits` of what is stated, and nothing below it.
#[track_caller]
fn assert_just_above(bound: f64, truth: f64) {
    let over = bound / truth - 1.0;
    assert!((-1e-16..1e-13).contains(&over), "{bound} for {truth}");
}

#[test]
fn known_gaps() {
    let (a, b) = (DVec3::new(-1.0, 1.0, 0.2), DVec3::new(2.0, 0.5, 0.0));
    assert_just_above(edge_gap(a, b), 0.856_432_267_421_311_1);
    let gap = triangle_gap(
        DVec3::new(-1.0, 1.0, 0.5),
        DVec3::new(2.0, 1.0, -1.0),
        DVec3::new(0.0, 1.0, 2.0),
    );
    assert_just_above(gap, 0.934_214_931_441_975_2);
    let symmetric = edge_gap(DVec3::new(-0.5, 3.0, 0.0), DVec3::new(0.5, 3.0, 0.0));
    assert_just_above(symmetric, 0.041_381_265_149_109_84);
    // Around the observer: the distance of the corners, and twice the gap of an edge.
    let around = [0.0, 1.0, 2.0].map(|third| {
        let (sine, cosine) = (third * std::f64::consts::TAU / 3.0).sin_cos();
        DVec3::new(cosine, sine, 0.0)
    });
    assert_just_above(edge_gap(around[0], around[1]), 0.5);
    assert_just_above(triangle_gap(around[0], around[1], around[2]), 1.0);
}

/// An edge seen symmetrically at distance `h`: the length that keeps the gap after a boost below 1e-3, and the gap of one of
/// length 1 at distance 1.
#[test]
fn known_sizes_of_edges() {
    for (beta, longest, unsplit) in [
        (0.5, 0.1177, 0.0681),
        (0.9, 0.06225, 0.2437),
        (0.95, 0.05128, 0.3591),
        (0.99, 0.03376, 0.8284),
        (0.999, 0.01892, 2.6373),
    ] {
        let gamma_beta = beta / f64::sqrt((1.0 - beta) * (1.0 + beta));
        let gap = |length: f64| {
            let half = DVec3::X * (0.5 * length);
            gamma_beta * edge_gap(DVec3::Y - half, DVec3::Y + half)
        };
        // The table is for the simple bound L^2 / 8 d, in four digits; the gap itself is smaller by about
        // L^2 / 16 d^2 of it.
        let share = gap(longest) / 1e-3;
        let expected = 1.0 - longest * longest / 16.0;
        assert!((share - expected).abs() < 6e-4, "beta {beta}: {share}");
        assert!(
            (gap(1.0) - unsplit).abs() < 6e-5,
            "beta {beta}: {}",
            gap(1.0)
        );
    }
}

#[test]
fn gaps_without_size() {
    let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-3.0, 0.1, 0.0));
    for same in [a, DVec3::ZERO, DVec3::splat(1e-320), DVec3::splat(1e300)] {
        assert_eq!(edge_gap(same, same), 0.0);
        assert!(triangle_gap(same, same, same) <= 1e-160 * same.x);
    }
    assert_eq!(edge_gap(a, DVec3::ZERO), 0.0);
    assert_eq!(triangle_gap(a, b, DVec3::ZERO), edge_gap(a, b));
    assert!(edge_gap(a, 2.0 * a) < 1e-280);
    // Through the observer: the most an edge can have, half its length.
    let through = edge_gap(a, -a);
    assert_just_above(through, a.length());
}

#[test]
fn what_is_not_finite_gives_nothing_certain() {
    let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-3.0, 0.1, 0.0));
    for wrong in [f64::NAN, f64::INFINITY] {
        assert!(!edge_gap(a, DVec3::new(0.0, wrong, 1.0)).is_finite());
        assert!(!triangle_gap(a, b, DVec3::new(0.0, wrong, 1.0)).is_finite());
    }
}

/// `e <= L / 2`, `e <= L^2 / (8 d)` with the distance `d` of the nearest place, and for a triangle at most
/// twice the worst edge: all up to the rounding up.
#[test]
fn gaps_keep_to_the_simple_bounds() {
    let up = 1.0 + 2.0 * EDGE_SLACK;
    for (kind, make) in kinds() {
        let mut random = Random::new(5);
        for _ in 0..200 {
            let corners = make(&mut random);
            let mut worst = 0.0f64;
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (corners[i], corners[j]);
                let gap = edge_gap(a, b);
                let (a, b) = (exact_vector(a), exact_vector(b));
                let along = difference(&b, &a);
                let squared = dot(&along, &along);
                let floor = exact(1e-150) * (oracle::length(&a) + oracle::length(&b))
                    + exact(4.0 * f64::from_bits(1));
                let half = exact(0.5 * up) * square_root(&squared) + &floor;
                assert!(
                    exact(gap) <= half,
                    "{kind}: {gap:e} over L / 2 at {corners:?}"
                );
                let (from_a, from_b) = (-dot(&a, &along), dot(&b, &along));
                let nearest = if from_a <= zero() {
                    oracle::length(&a)
                } else if from_b <= zero() {
                    oracle::length(&b)
                } else {
                    oracle::length(&cross(&a, &b)) / square_root(&squared)
                };
                let by_distance = exact(0.125 * up) * squared;
                assert!(
                    (exact(gap) - &floor) * nearest <= by_distance,
                    "{kind}: {gap:e} over L^2 / 8 d at {corners:?}"
                );
                worst = worst.max(gap);
            }
            let gap = triangle_gap(corners[0], corners[1], corners[2]);
            assert!(
                worst <= gap && gap <= 2.0 * worst,
                "{kind}: {gap:e}, {worst:e}"
            );
        }
    }
}

/// Powers of two change nothing but the exponent, so the plain and the far formulas agree.
#[test]
fn gaps_scale_with_the_triangle() {
    let mut random = Random::new(6);
    for _ in 0..500 {
        let corners: Corners =
            std::array::from_fn(|_| random.direction() * power(&mut random, -3.0, 3.0));
        let gap = triangle_gap(corners[0], corners[1], corners[2]);
        for exponent in [-900, -300, 20, 300, 900] {
            let scale = 2f64.powi(exponent);
            let [a, b, c] = corners.map(|corner| corner * scale);
            let over = triangle_gap(a, b, c) / scale / gap - 1.0;
            assert!(
                (0.0..1e-14).contains(&over),
                "2^{exponent}: {over:e} at {corners:?}"
            );
        }
    }
}
