//! The closed surface of a round shape, and the coarsest triangles between vertices on it.

use glam::DVec3;

use super::Piece;
use crate::shape::Shape;

/// How many parts a rim has at least, and how many turns an edge may span at most: a quarter, so that all angles are told
/// apart.
pub(crate) const LEAST_PARTS: usize = 8;
pub(crate) const MAX_SPAN: f64 = 0.25;

/// A place on a round shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    /// On a ball a unit vector, on a rim the turns in `x`, elsewhere the two parameters of its piece in `x` and `y`.
    pub(crate) at: DVec3,
    /// The rim that it is on, 1 or 2; 0 inside of a piece.
    pub(crate) rim: u8,
    /// True for poles and tips, which stay vertices.
    pub(crate) is_fixed: bool,
}

/// A closed surface of pieces, with triangles whose corners are on it.
///
/// The first piece holds the rims; rim 1 is that with the second piece, rim 2 that with the third one.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) spots: Vec<Spot>,
    /// Counter-clockwise, seen from outside.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The piece of each triangle.
    pub(crate) of: Vec<u8>,
}

impl Spot {
    /// A spot inside of a piece.
    pub(crate) fn inside(at: DVec3) -> Self {
        Self {
            at,
            rim: 0,
            is_fixed: false,
        }
    }

    /// A spot on a rim.
    pub(crate) fn on_rim(turns: f64, rim: u8) -> Self {
        Self {
            at: DVec3::new(turns.rem_euclid(1.0), 0.0, 0.0),
            rim,
            is_fixed: false,
        }
    }

    fn fixed(at: DVec3) -> Self {
        Self {
            is_fixed: true,
            ..Self::inside(at)
        }
    }
}

impl Shape {
    /// The pieces of a round shape; none of a flat one. A sphere has angles as parameters if these matter
    /// (`has_angles`), as for a picture on it.
    pub(crate) fn pieces(&self, has_angles: bool) -> Vec<Piece> {
        let lid = |radius, height, up| Piece::Lid {
            radius,
            height: 0.5 * up * height,
            up,
        };
        match self {
            Self::Sphere(shape) => {
                let radius = shape.radius.get();
                match has_angles {
                    true => vec![Piece::Globe { radius }],
                    false => vec![Piece::Ball { radius }],
                }
            }
            Self::Torus(shape) => vec![Piece::Tube {
                major: shape.major_radius().get(),
                minor: shape.minor_radius().get(),
            }],
            Self::Cylinder(_) | Self::Rod(_) => {
                let (radius, height) = match self {
                    Self::Rod(shape) => (shape.radius.get(), shape.length.get()),
                    Self::Cylinder(shape) => (shape.radius.get(), shape.height.get()),
                    _ => (0.0, 0.0),
                };
                vec![
                    Piece::Side { radius, height },
                    lid(radius, height, 1.0),
                    lid(radius, height, -1.0),
                ]
            }
            Self::Cone(shape) => {
                let (radius, height) = (shape.radius.get(), shape.height.get());
                vec![Piece::Slope { radius, height }, lid(radius, height, -1.0)]
            }
            Self::Cuboid(_) | Self::Grid(_) | Self::Lattice(_) => vec![],
        }
    }
}

impl Shape {
    /// Whether the shape is round and has no resolution of its own.
    pub(crate) fn is_curved(&self) -> bool {
        !self.has_resolution() && !self.pieces(false).is_empty()
    }

    /// The largest distance of a place of a round shape from the origin of its own frame, or somewhat more.
    pub(crate) fn reach(&self) -> f64 {
        let pieces = self.pieces(false).into_iter();
        pieces.map(|piece| piece.reach()).fold(0.0, f64::max) * (1.0 + 1e-12)
    }

    /// The number of triangles of the coarsest body of a round shape.
    pub(crate) fn coarsest_curved(&self) -> usize {
        Body::coarsest(&self.pieces(false)).triangles.len()
    }
}

impl Body {
    /// The body with the fewest vertices on its rims.
    pub(crate) fn coarsest(pieces: &[Piece]) -> Self {
        let rims = (0..Self::rims(pieces)).map(|_| Self::even_rim(LEAST_PARTS));
        Self::new(pieces, &rims.collect::<Vec<_>>())
    }

    /// The coarsest triangles between vertices on the pieces; `rims` holds the turns of the vertices on each rim, in their
    /// order.
    pub(crate) fn new(pieces: &[Piece], rims: &[Vec<f64>]) -> Self {
        match pieces.first() {
            Some(Piece::Ball { .. } | Piece::Globe { .. }) => sphere(&pieces[0]),
            Some(Piece::Tube { .. }) => torus(),
            Some(Piece::Slope { .. }) => cone(&rims[0]),
            _ => cylinder(&rims[0], &rims[1]),
        }
    }

    /// How many rims these pieces have.
    pub(crate) fn rims(pieces: &[Piece]) -> usize {
        pieces.len().saturating_sub(1)
    }

    /// The turns of equally spread vertices on a rim.
    pub(crate) fn even_rim(parts: usize) -> Vec<f64> {
        (0..parts).map(|k| k as f64 / parts as f64).collect()
    }
}

fn spot(u: f64, v: f64) -> Spot {
    Spot::inside(DVec3::new(u, v, 0.0))
}

/// An octahedron with its tips at the poles.
fn sphere(piece: &Piece) -> Body {
    let around = [DVec3::NEG_Z, DVec3::NEG_X, DVec3::Z, DVec3::X];
    let spots = match piece {
        Piece::Ball { .. } => [DVec3::Y]
            .into_iter()
            .chain(around)
            .chain([DVec3::NEG_Y])
            .collect(),
        _ => {
            let quarters = (0..4).map(|k| DVec3::new(f64::from(k) / 4.0, 0.5, 0.0));
            [DVec3::ZERO]
                .into_iter()
                .chain(quarters)
                .chain([DVec3::Y])
                .collect::<Vec<_>>()
        }
    };
    let spots = spots.into_iter().enumerate().map(|(k, at)| match k {
        0 | 5 => Spot::fixed(at),
        _ => Spot::inside(at),
    });
    let triangles: Vec<[u32; 3]> = (0..4)
        .flat_map(|k| {
            let (a, b) = (1 + k, 1 + (k + 1) % 4);
            [[0, a, b], [5, b, a]]
        })
        .collect();
    Body {
        spots: spots.collect(),
        of: vec![0; triangles.len()],
        triangles,
    }
}

/// Six parts around the axis, four around the tube.
fn torus() -> Body {
    const AROUND: u32 = 6;
    const TUBE: u32 = 4;
    let id = |i: u32, j: u32| (i % AROUND) * TUBE + j % TUBE;
    let mut body = Body {
        spots: vec![],
        triangles: vec![],
        of: vec![],
    };
    for i in 0..AROUND {
        for j in 0..TUBE {
            body.spots.push(spot(
                f64::from(i) / f64::from(AROUND),
                f64::from(j) / f64::from(TUBE),
            ));
            body.triangles
                .push([id(i, j), id(i, j + 1), id(i + 1, j + 1)]);
            body.triangles
                .push([id(i, j), id(i + 1, j + 1), id(i + 1, j)]);
        }
    }
    body.of = vec![0; body.triangles.len()];
    body
}

fn cylinder(upper: &[f64], lower: &[f64]) -> Body {
    let (n, m) = (upper.len() as u32, lower.len() as u32);
    let spots = upper.iter().map(|&turns| Spot::on_rim(turns, 1));
    let spots = spots
        .chain(lower.iter().map(|&turns| Spot::on_rim(turns, 2)))
        .collect();
    let mut triangles = vec![];
    // Joins the rims like a zip: always the step to the vertex that comes first.
    let turns = |rim: &[f64], k: u32| rim[k as usize % rim.len()] + f64::from(k / rim.len() as u32);
    let (mut i, mut j) = (0, 0);
    while i < n || j < m {
        let [next_upper, next_lower] = [turns(upper, i + 1), turns(lower, j + 1)];
        if j == m || (i < n && next_upper <= next_lower) {
            triangles.push([i % n, n + j % m, (i + 1) % n]);
            i += 1;
        } else {
            triangles.push([i % n, n + j % m, n + (j + 1) % m]);
            j += 1;
        }
    }
    let mut of = vec![0; triangles.len()];
    lid(&mut triangles, 0, n, true);
    of.resize(triangles.len(), 1);
    lid(&mut triangles, n, m, false);
    of.resize(triangles.len(), 2);
    Body {
        spots,
        triangles,
        of,
    }
}

fn cone(rim: &[f64]) -> Body {
    let n = rim.len() as u32;
    let tip = Spot::fixed(DVec3::ZERO);
    let spots = [tip]
        .into_iter()
        .chain(rim.iter().map(|&turns| Spot::on_rim(turns, 1)));
    let mut triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    let mut of = vec![0; triangles.len()];
    lid(&mut triangles, 1, n, false);
    of.resize(triangles.len(), 1);
    Body {
        spots: spots.collect(),
        triangles,
        of,
    }
}

/// Triangles between `n` vertices of a rim from number `first` on, each about as large as its neighbours: every second
/// vertex of those that are left is cut off, again and again.
fn lid(triangles: &mut Vec<[u32; 3]>, first: u32, n: u32, up: bool) {
    let mut left: Vec<u32> = (first..first + n).collect();
    while left.len() > 2 {
        let mut kept = vec![];
        let mut k = 0;
        while k < left.len() {
            kept.push(left[k]);
            let [a, b] = [1, 2].map(|step| left.get(k + step).copied());
            match (a, b) {
                (Some(a), b) if left.len() > 3 || b.is_some() => {
                    let b = b.unwrap_or(left[0]);
                    triangles.push(if up { [left[k], a, b] } else { [b, a, left[k]] });
                    k += 2;
                }
                _ => k += 1,
            }
        }
        left = kept;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// Every edge is in two triangles, in opposite directions, and triangles face outwards.
    #[test]
    fn bodies_are_closed_and_face_outwards() {
        let shapes = [
            Shape::sphere(1.0),
            Shape::torus(1.0, 0.25),
            Shape::cylinder(1.0, 2.0),
            Shape::rod(10.0, 0.1),
            Shape::cone(1.0, 2.0),
        ];
        for shape in shapes.map(Result::unwrap) {
            for has_angles in [false, true] {
                for (n, m) in [(8, 8), (9, 8), (13, 40), (101, 64)] {
                    let pieces = shape.pieces(has_angles);
                    let body = Body::new(&pieces, &[Body::even_rim(n), Body::even_rim(m)]);
                    let sides = body
                        .triangles
                        .iter()
                        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
                    let sides: Vec<_> = sides.collect();
                    let all: HashSet<_> = sides.iter().copied().collect();
                    assert_eq!(all.len(), sides.len(), "{shape:?}");
                    assert!(all.iter().all(|&[a, b]| all.contains(&[b, a])), "{shape:?}");
                    let mut volume = 0.0;
                    for (corners, &of) in body.triangles.iter().zip(&body.of) {
                        let piece = &pieces[of as usize];
                        let [a, b, c] = corners.map(|k| piece.place_of(&body.spots[k as usize]));
                        volume += a.dot(b.cross(c)) / 6.0;
                        let normal = corners.map(|k| piece.normal_of(&body.spots[k as usize]));
                        let mean: DVec3 = normal.iter().sum();
                        if !body.spots[corners[0] as usize].is_fixed {
                            assert!(
                                (b - a).cross(c - a).dot(mean) > 0.0,
                                "{shape:?} {corners:?}"
                            );
                        }
                    }
                    assert!(volume > 0.0);
                    assert!(body.triangles.len() >= shape.coarsest_curved());
                }
            }
        }
    }
}
