//! The metric in which triangles of one size are equally far from the photosurface, and how many of them theory needs.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::sight::About;
use super::sight::Sight;
use crate::shape::{Piece, Spot};

/// How many times longer than wide a triangle is wanted, squared, at most: where a surface hardly bends in one direction,
/// how much it bends soon changes.
const MOST_STRETCH: f64 = 400.0;

/// The step, in lengths of the shape's own frame, by which second derivatives by texture coordinates are found.
const STEP: f64 = 1e-3;

/// The area of an equilateral triangle with sides of length 1, and how much smaller the best triangles of a saddle are than
/// those of a bowl.
const UNIT_AREA: f64 = 0.433_012_701_892_219_3;
const SADDLE: f64 = 0.580_947_501_931_112_5;

/// How a photosurface bends at a spot, in a basis of unit tangents of the shape's own frame.
struct BendAt {
    tangents: [DVec3; 2],
    /// The lower triangle that makes seen tangents from unit ones.
    seen: DMat2,
    /// The components of the second derivative, in unit tangents as seen.
    components: Vec<DMat2>,
}

/// The metric at a spot, for all of `sights` together: a side of length 1 is that of an equilateral triangle that is as
/// far from the photosurface as is allowed.
pub(super) fn metric(piece: &Piece, spot: &Spot, sights: &[Sight], about: About) -> DMat3 {
    let (mut sum, mut most, mut total) = (DMat3::ZERO, 0.0f64, 0.0);
    for sight in sights {
        let bend = BendAt::new(piece, spot, sight, about);
        let squares = bend
            .components
            .iter()
            .fold(DMat2::ZERO, |sum, q| sum + *q * *q);
        let size = not_too_long(square_root(squares));
        let allowed = sight.allowed_at(sight.seen(piece.place_of(spot)).length());
        let of_unit = bend.seen * size * bend.seen.transpose() * (6.0 * allowed).recip();
        let [t, u] = bend.tangents;
        let trace = of_unit.x_axis.x + of_unit.y_axis.y;
        if !trace.is_finite() {
            continue;
        }
        sum += outer(t, t) * of_unit.x_axis.x
            + (outer(t, u) + outer(u, t)) * of_unit.x_axis.y
            + outer(u, u) * of_unit.y_axis.y;
        (most, total) = (most.max(trace), total + trace);
    }
    if total > 0.0 {
        sum * (most / total)
    } else {
        sum
    }
}

/// How many triangles a piece needs at a spot, per area of the shape's own frame: the fewest by theory, and those of the
/// metric.
pub(super) fn density(piece: &Piece, spot: &Spot, sight: &Sight, about: About) -> [f64; 2] {
    let bend = BendAt::new(piece, spot, sight, about);
    let area = bend.seen.determinant().abs();
    let allowed = sight.allowed_at(sight.seen(piece.place_of(spot)).length());
    let factor = area / (6.0 * allowed * UNIT_AREA);
    let of_one = |q: &DMat2| {
        let determinant = q.determinant();
        determinant.abs().sqrt() * if determinant < 0.0 { SADDLE } else { 1.0 }
    };
    let least = bend.components.iter().map(of_one).fold(0.0, f64::max);
    let squares = bend
        .components
        .iter()
        .fold(DMat2::ZERO, |sum, q| sum + *q * *q);
    let wanted = not_too_long(square_root(squares))
        .determinant()
        .max(0.0)
        .sqrt();
    [least, wanted].map(|number| match (number * factor).is_finite() {
        true => number * factor,
        false => 0.0,
    })
}

impl BendAt {
    /// # Derivation
    ///
    /// Along a step `v` of the surface at rest the place that is seen changes by `J v`, and its second derivative is
    /// `J X'' + gamma beta n |v_across|^2 / r`, with the part of `v` across the line of sight. For surfaces only the
    /// component along the photosurface's normal counts, and of `X''` that along the normal at rest.
    fn new(piece: &Piece, spot: &Spot, sight: &Sight, about: About) -> Self {
        let (place, normal) = (piece.place_of(spot), piece.normal_of(spot));
        let turn = DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X);
        let tangents = [turn, normal.cross(turn)];
        let offset = sight.offset(place);
        let r = offset.length();
        let toward = offset / r;
        let jacobian = sight.jacobian_vector(toward);
        let seen_of = |vector: DVec3| {
            let vector = sight.at_rest(vector);
            vector + sight.motion * jacobian.dot(vector)
        };
        let seen = tangents.map(seen_of);
        let length = seen[0].length();
        let slant = seen[0].dot(seen[1]) / length;
        let height = (seen[1].length_squared() - slant * slant).max(0.0).sqrt();
        let lower = DMat2::from_cols(DVec2::new(length, slant), DVec2::new(0.0, height));
        let components = match about {
            About::Surface => {
                let across = tangents.map(|tangent| {
                    let vector = sight.at_rest(tangent);
                    vector - toward * toward.dot(vector)
                });
                let seen_normal = seen[0].cross(seen[1]).normalize_or_zero();
                let bent = seen_normal.dot(seen_of(normal));
                let slid = seen_normal.dot(sight.motion) * sight.gamma_beta / r;
                let [first, second] = piece.curvatures(place, normal);
                let mixed = slid * across[0].dot(across[1]);
                vec![symmetric([
                    slid * across[0].length_squared() - bent * first,
                    mixed,
                    slid * across[1].length_squared() - bent * second,
                ])]
            }
            About::Points => by_parameters(piece, spot, sight, tangents),
        };
        let inverse = lower.inverse();
        let in_seen = |q: DMat2| inverse * q * inverse.transpose();
        Self {
            tangents,
            seen: lower,
            components: components.into_iter().map(in_seen).collect(),
        }
    }
}

/// The components of the second derivative of a seen place by the parameters of its piece, in unit tangents.
fn by_parameters(piece: &Piece, spot: &Spot, sight: &Sight, tangents: [DVec3; 2]) -> Vec<DMat2> {
    let q = piece.parameters(spot);
    let first = piece.jet(q).first;
    let step = first.map(|first| STEP / first.length().max(1e-9));
    let at =
        |i: f64, j: f64| sight.seen_nearly(piece.place(q + DVec2::new(i * step[0], j * step[1])));
    let middle = at(0.0, 0.0);
    let square = STEP * STEP;
    let uu = (at(1.0, 0.0) + at(-1.0, 0.0) - 2.0 * middle) / square;
    let vv = (at(0.0, 1.0) + at(0.0, -1.0) - 2.0 * middle) / square;
    let uv = (at(1.0, 1.0) + at(-1.0, -1.0) - at(1.0, -1.0) - at(-1.0, 1.0)) / (4.0 * square);
    let [u, v] = first.map(|first| first.normalize_or_zero());
    let to_unit = DMat2::from_cols(
        DVec2::new(tangents[0].dot(u), tangents[1].dot(u)),
        DVec2::new(tangents[0].dot(v), tangents[1].dot(v)),
    );
    let of_unit = to_unit.inverse();
    (0..3)
        .map(|k| of_unit.transpose() * symmetric([uu[k], uv[k], vv[k]]) * of_unit)
        .collect()
}

fn symmetric([xx, xy, yy]: [f64; 3]) -> DMat2 {
    DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy))
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The square root of a symmetric matrix without negative eigenvalues.
fn square_root(square: DMat2) -> DMat2 {
    let root = square.determinant().max(0.0).sqrt();
    let sum = (square.x_axis.x + square.y_axis.y + 2.0 * root).sqrt();
    match sum > 0.0 {
        true => (square + DMat2::IDENTITY * root) * sum.recip(),
        false => DMat2::ZERO,
    }
}

/// The same symmetric matrix, its smaller eigenvalue not below the [`MOST_STRETCH`]th part of the larger one.
fn not_too_long(matrix: DMat2) -> DMat2 {
    let half = 0.5 * (matrix.x_axis.x + matrix.y_axis.y);
    let apart = (half * half - matrix.determinant()).max(0.0).sqrt();
    let (large, small) = (half + apart, half - apart);
    let least = large / MOST_STRETCH;
    if !(small < least && apart > 0.0) {
        return matrix;
    }
    let of_small = (DMat2::IDENTITY * large - matrix) * (2.0 * apart).recip();
    matrix + of_small * (least - small)
}
