//! The gap of a flat edge or triangle: a closed form, rounded up.
//!
//! The photosurface map takes the offset `d` of a point from the observer, in the rest frame, to a position in the
//! observer's frame. The map is linear in `d` except for a term `gamma beta r` along the motion, with `r = |d|`. A flat
//! output triangle interpolates its mapped corners linearly. At the point with the weights `lambda_i` it therefore lies
//! beside the photosurface by `gamma beta` times the *gap* of the interpolated distances,
//!
//! ```text
//! e(lambda) = sum lambda_i r_i - |sum lambda_i d_i| >= 0.
//! ```
//!
//! The gap is a length in the rest frame. As a function of the weights it is zero at the corners and concave between
//! them. This file computes its maximum over an edge and over a triangle. The *worst point* is the point where the gap
//! is largest.
//!
//! # Derivation
//!
//! Write the corners as events `D_i = (r_i, d_i)` on the light cone, and the interpolated point as
//! `X = sum lambda_i D_i = (t, x)`, so that `e = t - |x|`. For every unit vector `G`,
//! `t - |x| <= t - G.x = sum lambda_i (r_i - G.d_i)`, with equality where `x` points along `G`. Hence **every** unit
//! vector `G` gives an upper bound: the largest of the numbers `r_i - G.d_i`. The bound is the maximum itself if `G`
//! makes these numbers equal and if the point whose `x` points along `G` lies between the corners. The maximum is
//! therefore the number `e` for which a light-like vector `K = (1, G)` with `K.D_i = e` for all `i` exists. The dot
//! between such four-vectors has the signature `+---`.
//!
//! **Edge** from `a` to `b`. Let `P = D_a.D_b = r_a r_b - a.b`, and let `rho = |x|` be the distance of the worst point,
//! so that `X = rho K + e (1, 0)`. The products of `X` with `D_a` and `D_b` give `lambda_b P = e (rho + r_a)` and
//! `lambda_a P = e (rho + r_b)`; the square of `X` gives `X.X = 2 lambda_a lambda_b P = e (e + 2 rho)`. Hence
//!
//! ```text
//! e = P / (r_a + r_b + 2 rho),        rho = sqrt((r_a r_b + a.b) / 2).
//! ```
//!
//! In this formula only `P` and `rho` can lose digits by cancellation; the identity `P (r_a r_b + a.b) = |a x b|^2`
//! avoids the loss. With the angle `theta` between the two ends, seen from the observer,
//! `P = 2 r_a r_b sin^2(theta / 2)` and `rho = sqrt(r_a r_b) cos(theta / 2)`. The worst point always lies between the
//! ends.
//!
//! **Triangle** with the corners `a`, `b`, `c`. Let `p`, `q`, `s` be the products `P` of the edges opposite `a`, `b`,
//! `c`. Split `K` into a part `e V` in the span of the `D_i` and a part across that span. The inverse of the matrix of
//! the products `D_i.D_j` solves `V.D_i = 1`; the solution has `V.V = Delta / (2 p q s)` and a component `V.(1, 0)`
//! that is the first part of the denominator below, divided by `2 p q s`. The unit vector across the span has the time
//! component `T / sqrt(2 p q s)`. The conditions `K.K = 0` and `K.(1, 0) = 1` then give
//!
//! ```text
//! e = 2 p q s / (r_a p (q + s - p) + r_b q (s + p - q) + r_c s (p + q - s) + |T| sqrt(Delta)),
//! Delta = 2 (p q + q s + s p) - p^2 - q^2 - s^2,        T = a.(b x c).
//! ```
//!
//! The worst point has the distance `rho = |T| / sqrt(Delta)` and the weights
//! `lambda_a ~ p (q (r_b + rho) + s (r_c + rho) - p (r_a + rho))`, and likewise for `b` and `c`. `T^2` also equals
//! `Delta(r_a p, r_b q, r_c s) - 2 p q s`, where `Delta(x, y, z)` is the same expression in `x`, `y`, `z` instead of
//! `p`, `q`, `s`. This second form is accurate where the triangle is small on the observer's sky; the triple product
//! `a.(b x c)` is accurate where the observer is close to the triangle's plane.
//!
//! If that point lies outside the triangle, the maximum is the largest gap of an edge. This is the case exactly when
//! the vector `G` of that edge gives the third corner no larger number `r_i - G.d_i` than the ends of the edge, because
//! a concave function has only one maximum. For the edge `ab` the condition is
//!
//! ```text
//! J = q (r_b + rho_ab) + p (r_a + rho_ab) - s (r_c + rho_ab) <= 0,
//! r_c - G.c = e_ab + J / (rho_ab (r_a + r_b + 2 rho_ab)).
//! ```
//!
//! **A triangle's gap is at most twice the largest gap of its edges.** Let `m` be the largest gap of an edge, so that
//! `p <= m (r_b + r_c + 2 rho_bc)`. From `e (t + |x|) = X.X = 2 sum lambda_b lambda_c p` (a sum over the edges) follows
//! `e <= 2 m` if `2 sum lambda_b lambda_c rho_bc <= |x| + sum lambda_a^2 r_a`. To prove this condition, let
//! `S = sum lambda_b lambda_c <= 1/3` and `y_a = lambda_a r_a`. By the Cauchy-Schwarz inequality the square of the
//! condition's left side is at most `4 S sum lambda_b lambda_c rho_bc^2 = S (|x|^2 + Q)` with
//! `Q = (sum y)^2 - 2 sum y^2`. The quadratic forms `S` of `lambda` and `Q` of `y` are inverse to each other and
//! Lorentzian, so `S Q <= (lambda.y)^2` (the reverse Cauchy-Schwarz inequality), and the square is at most
//! `|x|^2 / 3 + (sum lambda_a^2 r_a)^2`. An equilateral triangle with the observer at its centre attains the factor 2.

use glam::DVec3;

const EPSILON: f64 = f64::EPSILON;

/// Range of squared distances for which the plain formulas are used: no product that affects the result overflows or
/// underflows there.
const PLAIN: std::ops::RangeInclusive<f64> = two_to(-200)..=two_to(200);

/// An upper bound on the gap of the edge from `a` to `b`, a length in the rest frame; `a` and `b` are offsets from the
/// observer, also in the rest frame. The gap is the maximum over `0 <= lambda <= 1` of
/// `(1 - lambda) |a| + lambda |b| - |(1 - lambda) a + lambda b|`.
///
/// The result for `(b, a)` is the same, bit for bit.
///
/// # Derivation
///
/// The gap is `P / (r_a + r_b + sqrt(2 (r_a r_b + a.b)))` with `P = r_a r_b - a.b`; the comment at the top of this file
/// derives it.
///
/// # Accuracy
///
/// `true <= result <= (1 + 32 epsilon) true + 1e-160 min(|a|, |b|) + 5e-324` for all finite offsets. Comments in the
/// code bound each rounding error; `tests/it/tessellation/gap.rs` compares the results with references of 300 digits.
/// The result is zero for an edge without length and for an edge that ends at the observer. It is NaN or infinite if a
/// coordinate is not finite.
pub fn edge_gap(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = if before(b, a) { (b, a) } else { (a, b) };
    let (a2, b2) = (a.length_squared(), b.length_squared());
    if PLAIN.contains(&a2) && PLAIN.contains(&b2) {
        Edge::new(a, a2.sqrt(), b, b2.sqrt()).gap
    } else {
        far_edge_gap(a, b)
    }
}

/// An upper bound on the gap of the triangle with the corners `a`, `b`, `c`, a length in the rest frame; the corners
/// are offsets from the observer, also in the rest frame. The gap is the maximum of
/// `sum lambda_i r_i - |sum lambda_i d_i|` over the whole triangle.
///
/// The result is the same for the corners in any order, bit for bit, and never below [`edge_gap`] of any of the edges.
///
/// # Derivation
///
/// The comment at the top of this file derives the formulas. If the maximum is certain to lie on an edge, the result is
/// the gap of that edge. Otherwise it is the smallest of three upper bounds: the closed form for the triangle's plane,
/// with every rounding error added; the bound that the vector `G` of the worst edge gives; and twice the gap of the
/// worst edge.
///
/// # Accuracy
///
/// Proven for every triangle: the result is never below the true gap, and never above `2 (1 + 32 epsilon)` times the
/// true gap, apart from the two absolute terms in the accuracy of [`edge_gap`]. Measured in
/// `tests/it/tessellation/gap.rs`: the result exceeds the true gap by less than 1e-12 of it for triangles whose angles
/// on the observer's sky are at least 3 degrees and whose corners' distances are within a factor of 10; and by less
/// than 1e-8 of it for needles, for corners at neighbouring floats, and for an observer on or next to a corner, an
/// edge, the face or the plane. The factor 2 is reached only where distances from the observer differ by a factor of
/// 1e30. The result is NaN or infinite if a coordinate is not finite.
pub fn triangle_gap(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = sorted([a, b, c]);
    let squares = [a, b, c].map(DVec3::length_squared);
    if squares.iter().all(|square| PLAIN.contains(square)) {
        Triangle::new([a, b, c], squares.map(f64::sqrt)).gap()
    } else {
        far_triangle_gap([a, b, c])
    }
}

/// The approximate worst point of the triangle, where the gap is largest, as the weights of the corners. No weight is
/// negative, and the sum is 1 up to rounding.
///
/// The point serves for inserting a vertex and proves nothing. It is most accurate where the gap is well conditioned.
/// If a coordinate is not finite, each weight is a third.
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
        // A corner next to the observer: the gap grows in proportion to the distance from that corner, so the worst
        // point lies on the opposite edge.
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

/// The quantities of an edge that depend on both ends.
///
/// # Rounding
///
/// The relative errors, in units of `u = epsilon / 2` and to first order, are at most: 2.5 for a distance; 3 for each
/// component of `cross`, hence 9 for its square; 6 for `r_a r_b`; 3 for `a.b`, relative to `r_a r_b`; hence 10 for
/// `wide`, which is at least `r_a r_b`. One of `P` and `2 rho^2` is `wide`; the other one is `square / wide`, with an
/// error of 20. If the angle at the observer is acute, `P` has an error of 20, `rho` of 6, and the gap of 20 + 8 + 1 =
/// 29. If it is obtuse, `P` has an error of 10, `rho` of 11, and the gap of 10 + 13 + 1 = 24. The factor
/// `1 + 15 epsilon` covers both and its own rounding.
struct Edge {
    cross: DVec3,
    /// `P = r_a r_b - a.b`, with a relative error of at most `10 epsilon`.
    product: f64,
    /// The distance of the worst point from the observer, with a relative error of at most `6 epsilon`.
    rho: f64,
    /// The gap of the edge, rounded up.
    gap: f64,
}

impl Edge {
    /// The squares of both distances have to be in [`PLAIN`].
    fn new(a: DVec3, r_a: f64, b: DVec3, r_b: f64) -> Self {
        // A square below `FLOOR` has lost digits. `FLOOR` is far below one unit in the last place of any distance.
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

    /// The weights of the two ends at the worst point.
    fn place(&self, r_a: f64, r_b: f64) -> [f64; 2] {
        let sum = r_a + r_b + 2.0 * self.rho;
        [(r_b + self.rho) / sum, (r_a + self.rho) / sum]
    }
}

/// A triangle whose squared distances are all in [`PLAIN`].
struct Triangle {
    corners: [DVec3; 3],
    distances: [f64; 3],
    /// The edge of each index is opposite the corner of that index.
    edges: [Edge; 3],
}

impl Triangle {
    /// The corners have to be sorted: only then are the results the same, bit for bit, for any order of the caller's
    /// corners.
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

    /// `J` for the worst edge, as derived at the top of this file, and the sum of the absolute values of its terms.
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
        // Relative errors: a product has 20 u, a distance plus rho 12 u, the product of these two 33 u, the sum 35 u.
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
        // The order matters: `f64::min` passes over a NaN of `gap_of_plane`.
        self.gap_of_plane()
            .min(toward_edge)
            .min(2.0 * edge.gap)
            .max(edge.gap)
    }

    /// An upper bound on the gap at the worst point of the triangle's whole plane. If there is no such point, or if
    /// rounding leaves it uncertain, the result has no meaning and may be infinite or NaN.
    ///
    /// # Rounding
    ///
    /// A product of an edge has a relative error of `20 u`, a distance of `2.5 u`. Multiplying `n` factors adds `n u`;
    /// each sum here adds at most `5 u` of the sum of the absolute values of its terms. The error of both operands is
    /// subtracted from each difference, so that the denominator is rounded down.
    fn gap_of_plane(&self) -> f64 {
        let [p, q, s] = [0, 1, 2].map(|i: usize| self.edges[i].product);
        let [r_a, r_b, r_c] = self.distances;
        let largest = p.max(q).max(s);
        if largest < two_to(-400) {
            return f64::INFINITY;
        }
        // The error of `delta` is at most 45 u of the square of the sum.
        let sum = p + q + s;
        let delta = delta(p, q, s) - 24.0 * EPSILON * (sum * sum);
        let product = 2.0 * (p * q) * s;

        // The errors are at most 52 u of the square of the sum and 63 u of the product, which is not larger than that
        // square.
        let (x, y, z) = (r_a * p, r_b * q, r_c * s);
        let sum = x + y + z;
        let from_edges = self::delta(x, y, z) - product - 64.0 * EPSILON * (sum * sum);
        // The error is at most 6 u of the sum of the absolute values of the terms.
        let (a, cross) = (self.corners[0], self.edges[0].cross);
        let from_corners =
            a.dot(cross).abs() - (4.0 * EPSILON * a.abs().dot(cross.abs()) + two_to(-800));
        let triple = from_edges.max(0.0).sqrt().max(from_corners);

        // Each term has an error of at most 50 u of its absolute value, their sum of at most 55 u of `size`.
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

/// [`edge_gap`] for squared distances outside [`PLAIN`]; the ends are already in order.
///
/// `P` and `rho^2` are bilinear in the two ends, so each end is scaled to unit size on its own. In sums with the larger
/// end, the smaller one is scaled back.
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
    // Ends with equal directions but different distances have a product `P` of zero. `unit.product` is its floor then,
    // which is the right bound here.
    let gap = unit.product / below * (1.0 + 16.0 * EPSILON);
    times_two_to(gap, smaller).next_up().min(ceiling)
}

/// An upper bound on the gap of an edge that is far from the observer compared with its length; infinity for any other
/// edge.
///
/// The second derivative of the distance `r` along the edge is nowhere larger than `1/r`, so the gap is at most
/// `length^2 / (8 r)` with the smallest `r`. This bound has no floor: at a distance of 1e300 the floor of the closed
/// form is larger than most scenes.
fn far_ceiling(a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let exponent = exponent(along);
    let length = times_two_to(scaled(along, -exponent).length(), exponent);
    let nearest = a.abs().max_element() - length;
    // Written so that a length that overflows gives infinity.
    if nearest > 0.5 * a.abs().max_element() {
        (length * (length / (8.0 * nearest)) * (1.0 + 16.0 * EPSILON)).next_up()
    } else {
        f64::INFINITY
    }
}

/// [`triangle_gap`] for squared distances outside [`PLAIN`]; the corners are sorted.
///
/// The triangle is scaled to unit size. If a corner is still too near to the observer for the plain formulas, it is
/// treated as if it were at the observer: this changes the gap by at most twice the corner's distance, and a triangle
/// with a corner at the observer has the gap of the opposite edge.
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

/// An upper bound on the distance of the corner nearest to the observer.
fn nearest(corners: [DVec3; 3]) -> f64 {
    corners
        .map(|corner| 1.8 * corner.abs().max_element())
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// The cross product `a x b`; each component has a relative error of at most 3 `u`.
///
/// Each component is a determinant by Kahan's method, written without a fused multiply-add, which is slow where the
/// processor has none. The error is at most 1.5 units in the last place (Jeannerod, Louvet, Muller, Math. Comp. 82
/// (2013), 2245).
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

/// A rounded product and its exact rounding error (Dekker 1971).
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

/// Whether `a` precedes `b`, ordered by x, then y, then z.
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

/// `2^n`, if that is a normal number.
const fn two_to(n: i32) -> f64 {
    assert!(n > -1023 && n < 1024);
    f64::from_bits(((1023 + n) as u64) << 52)
}

/// The binary exponent of the largest component of a nonzero vector.
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
