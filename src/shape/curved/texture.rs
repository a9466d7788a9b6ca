//! Where places of round shapes lie on a picture.

use glam::DVec2;

use super::{Piece, Spot};
use crate::shape::round::checker_rows;
use crate::shape::sphere::texture_toward;
use crate::shape::{Cone, Cylinder, Shape};

impl Shape {
    /// The texture coordinates of the corners of a triangle of a round shape, as of one continuous chart: those of a
    /// triangle that reaches across the seam leave the range from 0 to the number of repetitions.
    pub(crate) fn texture_of(&self, piece: &Piece, corners: [&Spot; 3]) -> [DVec2; 3] {
        let (around, down, across) = self.repeats();
        let at = |spot: &Spot| match *piece {
            Piece::Ball { .. } => texture_toward(spot.at),
            Piece::Globe { .. } | Piece::Tube { .. } => spot.at.truncate(),
            Piece::Side { height, .. } => {
                let q = piece.parameters(spot);
                DVec2::new(q.x, 0.5 - q.y / height)
            }
            Piece::Slope { .. } => piece.parameters(spot),
            Piece::Lid { radius, up, .. } => {
                let q = piece.parameters(spot);
                DVec2::new(q.x, q.y * up) / (2.0 * radius) + 0.5
            }
        };
        let mut places = corners.map(at);
        if let Piece::Lid { .. } = piece {
            return places.map(|place| place * across);
        }
        let is_pole = |k: &usize| corners[*k].is_fixed && !matches!(piece, Piece::Tube { .. });
        let pole = (0..3).find(is_pole);
        let first = if pole == Some(0) { 1 } else { 0 };
        let wraps_down = matches!(piece, Piece::Tube { .. });
        for k in 0..3 {
            let step = places[first] - places[k];
            places[k].x += step.x.round();
            if wraps_down {
                places[k].y += step.y.round();
            }
        }
        if let Some(pole) = pole {
            places[pole].x = 0.5 * (places[(pole + 1) % 3].x + places[(pole + 2) % 3].x);
        }
        places.map(|place| DVec2::new(place.x * around, place.y * down))
    }
}

impl Shape {
    /// How often a picture repeats: around and down the first piece, and across a lid.
    fn repeats(&self) -> (f64, f64, f64) {
        let of_side = |columns: u32, length: f64, radius: f64, across: f64| {
            let rows = checker_rows(length, radius, columns);
            (f64::from(columns) / 2.0, rows / 2.0, across)
        };
        match self {
            Self::Cylinder(shape) => of_side(
                Cylinder::COLUMNS,
                shape.height.get(),
                shape.radius.get(),
                4.0,
            ),
            // Four cells around and two across.
            Self::Rod(shape) => of_side(4, shape.length.get(), shape.radius.get(), 1.0),
            Self::Cone(shape) => {
                let (radius, height) = (shape.radius.get(), shape.height.get());
                of_side(Cone::COLUMNS, radius.hypot(height), radius, 4.0)
            }
            _ => (1.0, 1.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::Body;
    use super::*;

    /// Vertices of the shape's own mesh have the texture coordinates that are found for their places.
    #[test]
    fn pictures_lie_where_those_of_meshes_do() {
        let shapes = [
            Shape::sphere(1.0),
            Shape::torus(1.0, 0.25),
            Shape::cylinder(1.0, 2.0),
            Shape::rod(3.0, 0.1),
            Shape::cone(1.0, 2.0),
        ];
        for shape in shapes.map(Result::unwrap) {
            let mesh = shape.mesh().unwrap();
            for corners in mesh.triangles() {
                let corners = corners.map(|k| k as usize);
                let of = |k: usize| (mesh.positions()[k], mesh.normals().unwrap()[k]);
                let pieces = shape.pieces(true);
                let fits = |piece: &&Piece| {
                    corners.iter().all(|&k| {
                        let (place, normal) = of(k);
                        let spot = piece.spot_near(place);
                        (piece.place_of(&spot) - place).length() < 1e-9
                            && (piece.normal_of(&spot) - normal).length() < 1e-6
                    })
                };
                let Some(piece) = pieces.iter().find(fits) else {
                    // A pole or the tip of a cone.
                    continue;
                };
                let spots = corners.map(|k| piece.spot_near(of(k).0));
                let found = shape.texture_of(piece, [0, 1, 2].map(|k| &spots[k]));
                let expected = corners.map(|k| mesh.texture_coordinates()[0][k].as_dvec2());
                let is_pole = |k: usize| spots[k].at.y * (1.0 - spots[k].at.y) < 1e-9;
                // Whole turns may differ.
                let (around, ..) = shape.repeats();
                let shift = expected[0] - found[0];
                if (0..3).any(|k| matches!(piece, Piece::Globe { .. }) && is_pole(k)) {
                    continue;
                }
                for k in 0..3 {
                    let off = expected[k] - found[k] - shift;
                    assert!(off.length() < 1e-5 * around.max(4.0), "{shape:?} {off} {k}");
                }
                let turns = shift.x
                    / if matches!(piece, Piece::Lid { .. }) {
                        1.0
                    } else {
                        around
                    };
                assert!((turns - turns.round()).abs() < 1e-5 && shift.y.fract().abs() < 1e-5);
            }
        }
        assert_eq!(Body::rims(&Shape::cone(1.0, 1.0).unwrap().pieces(false)), 1);
        let pole = texture_toward(DVec3::Y);
        assert_eq!(pole.y, 0.0);
    }
}
