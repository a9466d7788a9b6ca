//! The gap of a flat edge or triangle, in closed form and rounded up.
//!
//! The photosurface map is linear in the offset `d` from the observer except for a term `gamma beta r`
//! with `r = |d|`. What an edge or a triangle misses when it is mapped by its corners alone is therefore
//! `gamma beta` times the *gap* of the interpolated distances,
//!
//! ```text
//! e(lambda) = sum lambda_i r_i - |sum lambda_i d_i| >= 0,
//! ```
//!
//! a quantity of the rest frame, zero at the corners and concave between them. Here is its maximum.
//!
//! # Derivation
//!
//! Take `D_i = (r_i, d_i)` as events on the light cone and `X = sum lambda_i D_i = (t, x)`. For a unit
//! vector `G`, `t - |x| <= t - G.x = sum lambda_i (r_i - G.d_i)`, with equality where `x` points along
//! `G`. So **every** `G` gives a bound, the largest `r_i - G.d_i`, and the one that makes all of them
//! equal, if the place where `x` is along `G` is between the corners, gives the maximum: `e` is the
//! number for which a light-like `K = (1, G)` with `K.D_i = e` for all `i` exists (`.` with the signature
//! `+---`).
//!
//! **Edge**, with `P = D_a.D_b = r_a r_b - a.b`: at the place `X = rho K + e (1, 0)` with `rho = |x|`,
//! the products with `D_a` and `D_b` are `lambda_b P = e (rho + r_a)` and `lambda_a P = e (rho + r_b)`,
//! and `X.X = 2 lambda_a lambda_b P = e (e + 2 rho)`. Hence
//!
//! ```text
//! e = P / (r_a + r_b + 2 rho),        rho = sqrt((r_a r_b + a.b) / 2).
//! ```
//!
//! It has no cancellation left but in `P` and `rho`, and there `P (r_a r_b + a.b) = |a x b|^2` helps. In
//! terms of the angle `theta` at the observer, `P = 2 r_a r_b sin^2(theta / 2)` and
//! `rho = sqrt(r_a r_b) cos(theta / 2)`. The place always is between the ends.
//!
//! **Triangle**, with `p`, `q`, `s` the products `P` of the edges opposite `a`, `b`, `c`: split `K` into
//! `e V` in the span of the `D_i` and a part across. `V.D_i = 1` is solved by the inverse of the matrix
//! of the products, which gives `V.V = Delta / (2 p q s)` and `V.(1, 0)` as below; the unit vector across
//! has the time component `T / sqrt(2 p q s)`. `K.K = 0` and `K.(1, 0) = 1` make
//!
//! ```text
//! e = 2 p q s / (r_a p (q + s - p) + r_b q (s + p - q) + r_c s (p + q - s) + |T| sqrt(Delta)),
//! Delta = 2 (p q + q s + s p) - p^2 - q^2 - s^2,        T = a.(b x c),
//! ```
//!
//! at a place with `rho = |T| / sqrt(Delta)` and weights
//! `lambda_a ~ p (q (r_b + rho) + s (r_c + rho) - p (r_a + rho))`. `T^2` also is
//! `Delta(r_a p, r_b q, r_c s) - 2 p q s`, which has the digits where the triangle is small on the sky,
//! while the triple product has them where the observer is close to its plane.
//!
//! If that place is outside, the maximum is that of the edge with the largest gap. It is so exactly when
//! the edge's own `G` gives no more for the third corner than for the edge (a concave function has one
//! maximum), for edge `ab` when
//!
//! ```text
//! J = q (r_b + rho_ab) + p (r_a + rho_ab) - s (r_c + rho_ab) <= 0,
//! r_c - G.c = e_ab + J / (rho_ab (r_a + r_b + 2 rho_ab)).
//! ```
//!
//! **At most twice the edges.** Let `m` be the largest gap of an edge, so that
//! `p <= m (r_b + r_c + 2 rho_bc)`. From `e (t + |x|) = X.X = 2 sum lambda_b lambda_c p` (the sum over the
//! edges) follows `e <= 2 m` if `2 sum lambda_b lambda_c rho_bc <= |x| + sum lambda_a^2 r_a`. Let
//! `S = sum lambda_b lambda_c <= 1/3` and `y_a = lambda_a r_a`. By Cauchy the square of the left is at most
//! `4 S sum lambda_b lambda_c rho_bc^2 = S (|x|^2 + Q)`, `Q = (sum y)^2 - 2 sum y^2`. `S` and `Q` as
//! quadratic forms of `lambda` and `y` are inverse to each other and Lorentzian, so `S Q <= (lambda.y)^2`
//! (reverse Cauchy), and the square is at most `|x|^2 / 3 + (sum lambda_a^2 r_a)^2`. The factor 2 is
//! attained by an equilateral triangle with the observer at its centre.

use glam::DVec3;

const EPSILON: f64 = f64::EPSILON;

/// Squares of distances between these go through the plain formulas: no product over- or underflows that
/// counts.
const PLAIN: std::ops::RangeInclusive<f64> = two_to(-200)..=two_to(200);

/// An upper bound of the gap of the edge from `a` to `b`, both relative to the observer in the rest frame:
/// of the maximum over `0 <= lambda <= 1` of
/// `(1 - lambda) |a| + lambda |b| - |(1 - lambda) a + lambda b|`.
///
/// The same for `(b, a)`, bit for bit.
///
/// # Derivation
///
/// `P / (r_a + r_b + sqrt(2 (r_a r_b + a.b)))` with `P = r_a r_b - a.b`; see the head of this file's module.
///
/// # Accuracy
///
/// `true <= result <= (1 + 32 epsilon) true + 1e-160 min(|a|, |b|) + 5e-324` for all finite offsets: the
/// analysis of each rounding is with the code, `tests/it/tessellation/gap.rs` compares with 300 digits. Zero for an
/// edge without length and for one that ends at the observer. NaN or infinity if a coordinate is not finite.
pub fn edge_gap(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = if before(b, a) { (b, a) } else { (a, b) };
    let (a2, b2) = (a.length_squared(), b.length_squared());
    if PLAIN.contains(&a2) && PLAIN.contains(&b2) {
        Edge::new(a, a2.sqrt(), b, b2.sqrt()).gap
    } else {
        far_edge_gap(a, b)
    }
}

/// An upper bound of the gap of the triangle with corners `a`, `b`, `c` relative to the observer, in the
/// rest frame: of the maximum of `sum lambda_i r_i - |sum lambda_i d_i|` over the whole triangle.
///
/// The same for the corners in any order, bit for bit, and never below [`edge_gap`] of an edge.
///
/// # Derivation
///
/// See the head of this file's module. The plane's own maximum with every rounding error counted against
/// it, unless the maximum is certain to be on an edge; but at most what the direction from the
/// observer to the worst place of the worst edge proves, and at most twice the worst edge's gap.
///
/// # Accuracy
///
/// Never below the true value. Never more than `2 (1 + 32 epsilon)` times it, but for the floor of
/// [`edge_gap`], whatever the triangle (both proven). Measured in `tests/it/tessellation/gap.rs`: above the true gap by
/// less than 1e-12 of it for triangles with angles on the observer's sky of at least 3 degrees and distances within a
/// factor of 10; by less than 1e-8 of it for needles, observers on or next to a corner, an edge, the face or the
/// plane, neighbouring floats. The factor 2 is needed only where distances from the observer differ by 1e30. NaN or
/// infinity if a coordinate is not finite.
pub fn triangle_gap(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = sorted([a, b, c]);
    let squares = [a, b, c].map(DVec3::length_squared);
    if squares.iter().all(|square| PLAIN.contains(square)) {
        Triangle::new([a, b, c], squares.map(f64::sqrt)).gap()
    } else {
        far_triangle_gap([a, b, c])
    }
}

/// About where in the triangle the gap is largest: the weights of the corners, none negative, sum 1 but for
/// rounding.
///
/// To insert a point there, not to prove anything: an approximation, best where the gap is well defined. A third each
/// where a coordinate is not finite.
pub fn triangle_gap_place(a: DVec3, b: DVec3, c: DVec3) -> [f64; 3] {
    let mut corners = [a, b, c];
    if !corners.iter().all(|corner| corner.is_finite()) {
        return [1.0 / 3.0; 3];
    }
    let largest = corners.iter().fold(0.0, |largest: f64, corner| {
        largest.max(corner.abs().max_element())
    });
    if !(two_to(-60)..=two_to(60)).contains(&largest) {
        let exponent = exponent(DVec3::splat(largest));
        corners = corners.map(|corner| scaled(corner, -exponent));
    }
    let distances = corners.map(DVec3::length);
    match distances.iter().position(|&r| !(r >= two_to(-90))) {
        // Next to the observer the gap grows in proportion to the distance from that corner.
        Some(near) => {
            let (i, j) = ((near + 1) % 3, (near + 2) % 3);
            let mut weights = [0.0; 3];
            if distances[i] >= two_to(-90) && distances[j] >= two_to(-90) {
                let edge = Edge::new(corners[i], distances[i], corners[j], distances[j]);
                [weights[i], weights[j]] = edge.place(distances[i], distances[j]);
            } else {
                (weights[i], weights[j]) = (0.5, 0.5);
            }
            weights
        }
        None => Triangle::new(corners, distances).place(),
    }
}

/// What two ends have in common.
///
/// # Rounding
///
/// In units of `u = epsilon / 2` and to first order: distances 2.5; `cross` 3 in each component, so
/// 9 in its square; `r_a r_b` 6, `a.b` 3 of `r_a r_b`, so 10 in `wide`, which is at least `r_a r_b`. The other
/// of `P` and `2 rho^2` is 20. An acute edge has `P` to 20, `rho` to 6, its gap to 20 + 8 + 1 = 29; an obtuse
/// one `P` to 10, `rho` to 11, its gap to 10 + 13 + 1 = 24. 15 epsilon and the rounding of the product that
/// adds them cover both.
struct Edge {
    cross: DVec3,
    /// `P = r_a r_b - a.b`, to `10 epsilon` of itself
    product: f64,
    /// The distance of the worst place, to `6 epsilon` of itself
    rho: f64,
    /// Rounded up.
    gap: f64,
}

impl Edge {
    /// Both distances squared in [`PLAIN`].
    fn new(a: DVec3, r_a: f64, b: DVec3, r_b: f64) -> Self {
        // Below this the square has lost digits; far below anything a distance's last place can show.
        const FLOOR: f64 = two_to(-960);
        let cross = cross(a, b);
        let square = cross.length_squared();
        let dot = a.dot(b);
        let wide = r_a * r_b + dot.abs();
        let (product, twice_rho_squared) = if dot >= 0.0 {
            (square.max(FLOOR) / wide, wide)
        } else {
            (wide, square / wide)
        };
        let rho = (0.5 * twice_rho_squared).sqrt();
        let gap = if a == b {
            0.0
        } else {
            product / (r_a + r_b + 2.0 * rho) * (1.0 + 15.0 * EPSILON)
        };
        Self {
            cross,
            product,
            rho,
            gap,
        }
    }

    /// The weights of its ends at the worst place.
    fn place(&self, r_a: f64, r_b: f64) -> [f64; 2] {
        let sum = r_a + r_b + 2.0 * self.rho;
        [(r_b + self.rho) / sum, (r_a + self.rho) / sum]
    }
}

/// A triangle with all distances squared in [`PLAIN`].
struct Triangle {
    corners: [DVec3; 3],
    distances: [f64; 3],
    /// Each opposite the corner of its index.
    edges: [Edge; 3],
}

impl Triangle {
    /// Bit for bit that of the same corners in another order only if they are sorted.
    fn new(corners: [DVec3; 3], distances: [f64; 3]) -> Self {
        let edge =
            |i: usize, j: usize| Edge::new(corners[i], distances[i], corners[j], distances[j]);
        Self {
            corners,
            distances,
            edges: [edge(1, 2), edge(0, 2), edge(0, 1)],
        }
    }

    /// The corner opposite the edge with the largest gap.
    fn apex(&self) -> usize {
        let [a, b, c] = [0, 1, 2].map(|i: usize| self.edges[i].gap);
        if a >= b && a >= c {
            0
        } else if b >= c {
            1
        } else {
            2
        }
    }

    /// `J` of the module's head for the worst edge, and the sum of the sizes of its terms.
    fn beyond_edge(&self, apex: usize) -> (f64, f64) {
        let (i, j) = others(apex);
        let rho = self.edges[apex].rho;
        let term = |i: usize| self.edges[i].product * (self.distances[i] + rho);
        let (plus, minus) = (term(i) + term(j), term(apex));
        (plus - minus, plus + minus)
    }

    fn gap(&self) -> f64 {
        let apex = self.apex();
        let edge = &self.edges[apex];
        // Products to 20 u, distance + rho to 12 u, their product to 33 u, the sum to 35 u.
        let (beyond, size) = self.beyond_edge(apex);
        let beyond = beyond + 20.0 * EPSILON * size;
        if beyond <= 0.0 {
            return edge.gap;
        }
        let (i, j) = others(apex);
        let toward_edge = if edge.rho > two_to(-300) {
            let per_gap = (self.distances[i] + self.distances[j] + 2.0 * edge.rho) * edge.rho;
            (edge.gap + beyond / per_gap * (1.0 + 32.0 * EPSILON)) * (1.0 + EPSILON)
        } else {
            f64::INFINITY
        };
        // In this order: a NaN is passed over.
        self.gap_of_plane()
            .min(toward_edge)
            .min(2.0 * edge.gap)
            .max(edge.gap)
    }

    /// An upper bound of the gap at the worst place in the triangle's plane, if there is one; else, or if
    /// nothing is certain, anything.
    ///
    /// # Rounding
    ///
    /// Products of edges to `20 u`, distances to `2.5 u`. A product of `n` factors adds `n u`, the sums here at
    /// most `5 u` of the sum of the sizes of their terms. Of a difference, the error of both is taken off.
    fn gap_of_plane(&self) -> f64 {
        let [p, q, s] = [0, 1, 2].map(|i: usize| self.edges[i].product);
        let [r_a, r_b, r_c] = self.distances;
        let largest = p.max(q).max(s);
        if largest < two_to(-400) {
            return f64::INFINITY;
        }
        // 45 u of the square of the sum.
        let sum = p + q + s;
        let delta = delta(p, q, s) - 24.0 * EPSILON * (sum * sum);
        let product = 2.0 * (p * q) * s;

        // 52 u of the square of the sum, 63 u of the product, which is not larger.
        let (x, y, z) = (r_a * p, r_b * q, r_c * s);
        let sum = x + y + z;
        let from_edges = self::delta(x, y, z) - product - 64.0 * EPSILON * (sum * sum);
        // 6 u of the sum of sizes.
        let (a, cross) = (self.corners[0], self.edges[0].cross);
        let from_corners =
            a.dot(cross).abs() - (4.0 * EPSILON * a.abs().dot(cross.abs()) + two_to(-800));
        let triple = from_edges.max(0.0).sqrt().max(from_corners);

        // Each term to 50 u of its size, their sum to 55 u.
        let narrow = x * (q + s - p) + y * (s + p - q) + z * (p + q - s);
        let size = x * (q + s + p) + y * (s + p + q) + z * (p + q + s);
        let across = delta.max(0.0).sqrt() * triple * (1.0 - 4.0 * EPSILON);
        let below = narrow + across - 32.0 * EPSILON * size;
        if below > 0.0 {
            (product * (1.0 + 34.0 * EPSILON) + two_to(-1000)) / (below * (1.0 - 4.0 * EPSILON))
        } else {
            f64::INFINITY
        }
    }

    fn place(&self) -> [f64; 3] {
        let apex = self.apex();
        let (i, j) = others(apex);
        let mut weights = [0.0; 3];
        [weights[i], weights[j]] = self.edges[apex].place(self.distances[i], self.distances[j]);
        if self.beyond_edge(apex).0 <= 0.0 {
            return weights;
        }
        let [p, q, s] = [0, 1, 2].map(|i: usize| self.edges[i].product);
        let triple = self.corners[0].dot(self.edges[0].cross).abs();
        let rho = triple / delta(p, q, s).sqrt();
        let [x, y, z] = self.distances.map(|r| r + rho);
        let inside = [
            p * (q * y + s * z - p * x),
            q * (s * z + p * x - q * y),
            s * (p * x + q * y - s * z),
        ]
        .map(|weight| weight.max(0.0));
        let sum: f64 = inside.iter().sum();
        if sum > two_to(-900) && sum < f64::INFINITY && rho < f64::INFINITY {
            inside.map(|weight| weight / sum)
        } else {
            weights
        }
    }
}

/// `2 (x y + y z + z x) - x^2 - y^2 - z^2`
fn delta(x: f64, y: f64, z: f64) -> f64 {
    2.0 * (x * y + y * z + z * x) - (x * x + y * y + z * z)
}

fn others(corner: usize) -> (usize, usize) {
    ((corner + 1) % 3, (corner + 2) % 3)
}

/// [`edge_gap`] at distances beyond [`PLAIN`], in this order of the ends.
///
/// `P` and `rho^2` are bilinear: each end is brought to unit size by itself, the smaller one shrunk again
/// where it stands beside the larger.
#[cold]
fn far_edge_gap(a: DVec3, b: DVec3) -> f64 {
    if !(a.is_finite() && b.is_finite()) {
        return f64::NAN;
    }
    if a == DVec3::ZERO || b == DVec3::ZERO || a == b {
        return 0.0;
    }
    let ceiling = far_ceiling(a, b);
    let (exponent_a, exponent_b) = (exponent(a), exponent(b));
    let (a, b) = (scaled(a, -exponent_a), scaled(b, -exponent_b));
    let (larger, smaller) = (exponent_a.max(exponent_b), exponent_a.min(exponent_b));
    let (r_a, r_b) = (a.length(), b.length());
    let unit = Edge::new(a, r_a, b, r_b);
    let shrunk = |x: f64, exponent: i32| times_two_to(x, exponent - larger);
    let below = shrunk(r_a, exponent_a)
        + shrunk(r_b, exponent_b)
        + 2.0 * unit.rho * times_two_to(1.0, smaller - larger).sqrt();
    // Not `unit.product` of equal directions at different distances: that is the floor, which is right here.
    let gap = unit.product / below * (1.0 + 16.0 * EPSILON);
    times_two_to(gap, smaller).next_up().min(ceiling)
}

/// A gap that an edge far away against its length does not reach; infinity for one that is not.
///
/// No second derivative of the distance `r` along the edge is larger than `1/r`, which makes `length^2 / 8` over the
/// smallest `r`. It has no floor: at 1e300 that of the closed form is larger than most scenes.
fn far_ceiling(a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let exponent = exponent(along);
    let length = times_two_to(scaled(along, -exponent).length(), exponent);
    let nearest = a.abs().max_element() - length;
    // Written so that what overflows has none.
    if nearest > 0.5 * a.abs().max_element() {
        (length * (length / (8.0 * nearest)) * (1.0 + 16.0 * EPSILON)).next_up()
    } else {
        f64::INFINITY
    }
}

/// [`triangle_gap`] at distances beyond [`PLAIN`], of sorted corners.
///
/// Brought to unit size. If a corner then is still as good as at the observer, it counts as there: that moves
/// the gap by at most twice its distance, and a triangle with a corner at the observer has the gap of
/// the edge opposite.
#[cold]
fn far_triangle_gap(corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    if !corners.iter().all(|corner| corner.is_finite()) {
        return f64::NAN;
    }
    let edges = edge_gap(b, c).max(edge_gap(a, c)).max(edge_gap(a, b));
    let largest = corners.map(|corner| corner.abs().max_element());
    let largest = largest[0].max(largest[1]).max(largest[2]);
    if largest == 0.0 {
        return 0.0;
    }
    let exponent = exponent(DVec3::splat(largest));
    let unit = corners.map(|corner| scaled(corner, -exponent));
    let squares = unit.map(DVec3::length_squared);
    let gap = if squares.iter().all(|square| PLAIN.contains(square)) {
        let gap = Triangle::new(unit, squares.map(f64::sqrt)).gap();
        times_two_to(gap, exponent).next_up()
    } else {
        let nearest = nearest(corners);
        if nearest == 0.0 {
            edges
        } else {
            (edges + 2.0 * nearest) * (1.0 + 2.0 * EPSILON)
        }
    };
    gap.min(2.0 * edges).max(edges)
}

/// The distance of the corner nearest to the observer, rounded up.
fn nearest(corners: [DVec3; 3]) -> f64 {
    corners
        .map(|corner| 1.8 * corner.abs().max_element())
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// `a x b`, each component to 3 `u` of itself.
///
/// Kahan's determinant; without a fused multiply-add, which is slow where the processor has none. Jeannerod,
/// Louvet, Muller, Math. Comp. 82 (2013), 2245: 1.5 units in the last place.
fn cross(a: DVec3, b: DVec3) -> DVec3 {
    let difference = |x: f64, y: f64, z: f64, w: f64| {
        let (left, left_rest) = two_product(x, y);
        let (right, right_rest) = two_product(z, w);
        ((left - right) + left_rest) - right_rest
    };
    DVec3::new(
        difference(a.y, b.z, a.z, b.y),
        difference(a.z, b.x, a.x, b.z),
        difference(a.x, b.y, a.y, b.x),
    )
}

/// A product and what its rounding left out (Dekker 1971).
fn two_product(x: f64, y: f64) -> (f64, f64) {
    let halves = |x: f64| {
        let shifted = 134_217_729.0 * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let product = x * y;
    let ((x_high, x_low), (y_high, y_low)) = (halves(x), halves(y));
    let rest = x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low);
    (product, rest)
}

/// An order of places: by x, then y, then z.
fn before(a: DVec3, b: DVec3) -> bool {
    if a.x != b.x {
        a.x < b.x
    } else if a.y != b.y {
        a.y < b.y
    } else {
        a.z < b.z
    }
}

fn sorted([mut a, mut b, mut c]: [DVec3; 3]) -> [DVec3; 3] {
    if before(b, a) {
        (a, b) = (b, a);
    }
    if before(c, b) {
        (b, c) = (c, b);
        if before(b, a) {
            (a, b) = (b, a);
        }
    }
    [a, b, c]
}

/// `2^n` for a normal number.
const fn two_to(n: i32) -> f64 {
    assert!(n > -1023 && n < 1024);
    f64::from_bits(((1023 + n) as u64) << 52)
}

/// The exponent of the largest component of a vector that is not zero.
pub(super) fn exponent(v: DVec3) -> i32 {
    let largest = v.abs().max_element();
    let of_normal = |x: f64| (x.to_bits() >> 52) as i32 - 1023;
    if largest < f64::MIN_POSITIVE {
        of_normal(largest * two_to(200)) - 200
    } else {
        of_normal(largest)
    }
}

/// `x 2^n`, exact unless the result is too small or too large for a normal number.
pub(super) fn times_two_to(x: f64, mut n: i32) -> f64 {
    let mut x = x;
    while n < -1000 {
        x *= two_to(-1000);
        n += 1000;
    }
    while n > 1000 {
        x *= two_to(1000);
        n -= 1000;
    }
    x * two_to(n)
}

pub(super) fn scaled(v: DVec3, n: i32) -> DVec3 {
    DVec3::new(
        times_two_to(v.x, n),
        times_two_to(v.y, n),
        times_two_to(v.z, n),
    )
}
