//! Smooth pieces of round shapes: places, normals and derivatives, and bounds of the derivatives over a box.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::Spot;
use crate::shape::sphere::turn;

/// A smooth piece of a round shape about the y axis. Angles about the axis count in turns, as in
/// [`direction_of_turn`](crate::shape::surface::direction_of_turn).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Piece {
    /// A sphere without parameters: a spot is a unit vector.
    Ball { radius: f64 },
    /// A sphere; the parameters are longitude in turns and the part of half a turn from the north pole.
    Globe { radius: f64 },
    /// A torus; the parameters are turns about the axis and turns about the tube, from the innermost circle over the top.
    Tube { major: f64, minor: f64 },
    /// The side of a cylinder; the parameters are turns and height.
    Side { radius: f64, height: f64 },
    /// The side of a cone; the parameters are turns and the part of the way from the tip to the rim.
    Slope { radius: f64, height: f64 },
    /// A flat lid at a height, which faces up (1) or down (-1); the parameters are x and z.
    Lid { radius: f64, height: f64, up: f64 },
}

/// A place of a surface with its first derivatives by two parameters, and the second ones: `uu`, `uv`, `vv`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub(crate) place: DVec3,
    pub(crate) first: [DVec3; 2],
    pub(crate) second: [DVec3; 3],
}

/// The directions away from the axis and along the turn.
pub(crate) fn axes_of_turn(turns: f64) -> (DVec3, DVec3) {
    let (sin, cos) = (turns * TAU).sin_cos();
    (DVec3::new(-sin, 0.0, -cos), DVec3::new(-cos, 0.0, sin))
}

impl Piece {
    /// The periods of the two parameters; 0 for none.
    pub(crate) fn periods(&self) -> [f64; 2] {
        match self {
            Self::Globe { .. } | Self::Side { .. } | Self::Slope { .. } => [1.0, 0.0],
            Self::Tube { .. } => [1.0, 1.0],
            Self::Ball { .. } | Self::Lid { .. } => [0.0, 0.0],
        }
    }

    /// Whether the first parameter of a spot has no meaning: at a pole of a globe and at the tip of a cone.
    pub(crate) fn is_pole(&self, spot: &Spot) -> bool {
        spot.is_fixed && matches!(self, Self::Globe { .. } | Self::Slope { .. })
    }

    /// The parameters of a spot.
    pub(crate) fn parameters(&self, spot: &Spot) -> DVec2 {
        match *self {
            _ if spot.rim == 0 => spot.at.truncate(),
            Self::Lid { radius, .. } => {
                let out = axes_of_turn(spot.at.x).0 * radius;
                DVec2::new(out.x, out.z)
            }
            Self::Side { height, .. } => {
                let half = 0.5 * height;
                DVec2::new(spot.at.x, if spot.rim == 1 { half } else { -half })
            }
            _ => DVec2::new(spot.at.x, 1.0),
        }
    }

    /// The place of a spot.
    pub(crate) fn place_of(&self, spot: &Spot) -> DVec3 {
        match *self {
            Self::Ball { radius } => spot.at * radius,
            _ => self.place(self.parameters(spot)),
        }
    }

    /// The unit normal at a spot, away from the inside.
    pub(crate) fn normal_of(&self, spot: &Spot) -> DVec3 {
        let q = self.parameters(spot);
        match *self {
            Self::Ball { .. } => spot.at,
            Self::Globe { .. } => {
                let (sin, cos) = (q.y * PI).sin_cos();
                sin * axes_of_turn(q.x).0 + cos * DVec3::Y
            }
            Self::Tube { .. } => {
                let (sin, cos) = (q.y * TAU).sin_cos();
                -cos * axes_of_turn(q.x).0 + sin * DVec3::Y
            }
            Self::Side { .. } => axes_of_turn(q.x).0,
            Self::Slope { radius, height } => {
                (height * axes_of_turn(q.x).0 + radius * DVec3::Y) / radius.hypot(height)
            }
            Self::Lid { up, .. } => DVec3::Y * up,
        }
    }

    /// The place with these parameters; a ball has none.
    pub(crate) fn place(&self, q: DVec2) -> DVec3 {
        let out = || axes_of_turn(q.x).0;
        match *self {
            Self::Ball { .. } => DVec3::NAN,
            Self::Globe { radius } => {
                let (sin, cos) = (q.y * PI).sin_cos();
                radius * (sin * out() + cos * DVec3::Y)
            }
            Self::Tube { major, minor } => {
                let (sin, cos) = (q.y * TAU).sin_cos();
                (major - minor * cos) * out() + minor * sin * DVec3::Y
            }
            Self::Side { radius, .. } => radius * out() + q.y * DVec3::Y,
            Self::Slope { radius, height } => {
                radius * q.y * out() + height * (0.5 - q.y) * DVec3::Y
            }
            Self::Lid { height, .. } => DVec3::new(q.x, height, q.y),
        }
    }

    /// The place with its derivatives by the parameters; a ball has none.
    pub(crate) fn jet(&self, q: DVec2) -> Jet {
        let (out, along) = axes_of_turn(q.x);
        let flat = [DVec3::ZERO; 3];
        match *self {
            Self::Ball { .. } => Jet {
                place: DVec3::NAN,
                first: [DVec3::NAN; 2],
                second: [DVec3::NAN; 3],
            },
            Self::Globe { radius } => {
                let (sin, cos) = (q.y * PI).sin_cos();
                let place = radius * (sin * out + cos * DVec3::Y);
                Jet {
                    place,
                    first: [
                        radius * sin * TAU * along,
                        radius * PI * (cos * out - sin * DVec3::Y),
                    ],
                    second: [
                        -radius * sin * TAU * TAU * out,
                        radius * cos * TAU * PI * along,
                        -PI * PI * place,
                    ],
                }
            }
            Self::Tube { major, minor } => {
                let (sin, cos) = (q.y * TAU).sin_cos();
                let distance = major - minor * cos;
                Jet {
                    place: distance * out + minor * sin * DVec3::Y,
                    first: [
                        distance * TAU * along,
                        minor * TAU * (sin * out + cos * DVec3::Y),
                    ],
                    second: [
                        -distance * TAU * TAU * out,
                        minor * sin * TAU * TAU * along,
                        minor * TAU * TAU * (cos * out - sin * DVec3::Y),
                    ],
                }
            }
            Self::Side { radius, .. } => Jet {
                place: radius * out + q.y * DVec3::Y,
                first: [radius * TAU * along, DVec3::Y],
                second: [-radius * TAU * TAU * out, DVec3::ZERO, DVec3::ZERO],
            },
            Self::Slope { radius, height } => Jet {
                place: self.place(q),
                first: [radius * q.y * TAU * along, radius * out - height * DVec3::Y],
                second: [
                    -radius * q.y * TAU * TAU * out,
                    radius * TAU * along,
                    DVec3::ZERO,
                ],
            },
            Self::Lid { .. } => Jet {
                place: self.place(q),
                first: [DVec3::X, DVec3::Z],
                second: flat,
            },
        }
    }

    /// Upper bounds on the sizes of the derivatives over the box of half size `half` around `q`: of the second ones
    /// `uu`, `uv`, `vv`, and of the third ones `uuu`, `uuv`, `uvv`, `vvv`.
    pub(crate) fn bounds(&self, q: DVec2, half: DVec2) -> ([f64; 3], [f64; 4]) {
        match *self {
            Self::Ball { .. } => ([f64::INFINITY; 3], [f64::INFINITY; 4]),
            Self::Globe { radius } => {
                let (sin, cos) = (q.y * PI).sin_cos();
                let [sin, cos] = [sin, cos].map(|x| (x.abs() + half.y * PI).min(1.0));
                let second = [
                    radius * sin * TAU * TAU,
                    radius * cos * TAU * PI,
                    radius * PI * PI,
                ];
                let [uu, uv, vv] = second;
                let uvv = radius * sin * TAU * PI * PI;
                (second, [uu * TAU, uv * TAU, uvv, vv * PI])
            }
            Self::Tube { major, minor } => {
                let (sin, cos) = (q.y * TAU).sin_cos();
                let turned = half.y * TAU;
                let distance = major + minor * (turned - cos).min(1.0);
                let [sin, cos] = [sin, cos].map(|x| (x.abs() + turned).min(1.0));
                let square = TAU * TAU;
                let second = [distance * square, minor * sin * square, minor * square];
                let [uu, uv, vv] = second;
                let uvv = minor * cos * TAU.powi(3);
                (second, [uu * TAU, uv * TAU, uvv, vv * TAU])
            }
            Self::Side { radius, .. } => {
                let uu = radius * TAU * TAU;
                ([uu, 0.0, 0.0], [uu * TAU, 0.0, 0.0, 0.0])
            }
            Self::Slope { radius, .. } => {
                let uu = radius * (q.y.abs() + half.y) * TAU * TAU;
                let uv = radius * TAU;
                ([uu, uv, 0.0], [uu * TAU, uv * TAU, 0.0, 0.0])
            }
            Self::Lid { .. } => ([0.0; 3], [0.0; 4]),
        }
    }

    /// The largest distance of a place from the origin.
    pub(crate) fn reach(&self) -> f64 {
        match *self {
            Self::Ball { radius } | Self::Globe { radius } => radius,
            Self::Tube { major, minor } => major + minor,
            Self::Side { radius, height } | Self::Slope { radius, height } => {
                radius.hypot(0.5 * height)
            }
            Self::Lid { radius, height, .. } => radius.hypot(height),
        }
    }

    /// The curvatures of the surface at a place with this normal, in the directions of the turn and of the profile, where
    /// those away from the normal count as positive.
    pub(crate) fn curvatures(&self, place: DVec3, normal: DVec3) -> [f64; 2] {
        let out = DVec3::new(place.x, 0.0, place.z);
        let of_turn = || normal.dot(out) / out.length_squared();
        match *self {
            Self::Ball { radius } | Self::Globe { radius } => [radius.recip(); 2],
            Self::Tube { minor, .. } => [of_turn(), minor.recip()],
            Self::Side { .. } | Self::Slope { .. } => [of_turn(), 0.0],
            Self::Lid { .. } => [0.0; 2],
        }
    }

    /// The spot of the surface next to a place that is nearly on it.
    pub(crate) fn spot_near(&self, place: DVec3) -> Spot {
        let out = place.x.hypot(place.z);
        let at = match *self {
            Self::Ball { .. } => place.normalize_or(DVec3::Y),
            Self::Globe { .. } => DVec3::new(turn(place), out.atan2(place.y) / PI, 0.0),
            Self::Tube { major, .. } => {
                let tube = place.y.atan2(major - out) / TAU;
                DVec3::new(turn(place), tube.rem_euclid(1.0), 0.0)
            }
            Self::Side { height, .. } => {
                let half = 0.5 * height;
                DVec3::new(turn(place), place.y.clamp(-half, half), 0.0)
            }
            Self::Slope { radius, height } => {
                let along = out * radius + (0.5 * height - place.y) * height;
                let part = along / (radius * radius + height * height);
                DVec3::new(turn(place), part.clamp(0.0, 1.0), 0.0)
            }
            Self::Lid { .. } => DVec3::new(place.x, place.z, 0.0),
        };
        Spot::inside(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivatives against differences of places, and within their bounds.
    #[test]
    fn derivatives_are_those_of_the_places() {
        let pieces = [
            Piece::Globe { radius: 2.0 },
            Piece::Tube {
                major: 2.0,
                minor: 0.7,
            },
            Piece::Side {
                radius: 0.5,
                height: 3.0,
            },
            Piece::Slope {
                radius: 1.5,
                height: 3.0,
            },
            Piece::Lid {
                radius: 1.0,
                height: 0.5,
                up: 1.0,
            },
        ];
        for piece in pieces {
            for (x, y) in [(0.1, 0.3), (0.6, 0.8), (0.93, 0.11)] {
                let (q, h) = (DVec2::new(x, y), 1e-4);
                let at = |i: f64, j: f64| piece.place(q + h * DVec2::new(i, j));
                let jet = piece.jet(q);
                let first = [
                    (at(1.0, 0.0) - at(-1.0, 0.0)) / (2.0 * h),
                    (at(0.0, 1.0) - at(0.0, -1.0)) / (2.0 * h),
                ];
                let second = [
                    (at(1.0, 0.0) + at(-1.0, 0.0) - 2.0 * jet.place) / (h * h),
                    (at(1.0, 1.0) + at(-1.0, -1.0) - at(1.0, -1.0) - at(-1.0, 1.0)) / (4.0 * h * h),
                    (at(0.0, 1.0) + at(0.0, -1.0) - 2.0 * jet.place) / (h * h),
                ];
                let (bounds, _) = piece.bounds(q, DVec2::splat(0.05));
                for k in 0..2 {
                    assert!((jet.first[k] - first[k]).length() < 1e-4, "{piece:?} {k}");
                }
                for k in 0..3 {
                    assert!((jet.second[k] - second[k]).length() < 1e-4, "{piece:?} {k}");
                    assert!(jet.second[k].length() <= bounds[k] * (1.0 + 1e-12));
                }
                let spot = piece.spot_near(jet.place);
                assert!((piece.place_of(&spot) - jet.place).length() < 1e-12);
                let normal = piece.normal_of(&spot);
                assert!(jet.first.iter().all(|t| t.dot(normal).abs() < 1e-12));
            }
        }
    }

    /// Second derivatives change by no more than the bounds of the third ones allow.
    #[test]
    fn third_derivatives_are_bounded() {
        let pieces = [
            Piece::Globe { radius: 2.0 },
            Piece::Tube {
                major: 2.0,
                minor: 0.7,
            },
            Piece::Slope {
                radius: 1.5,
                height: 3.0,
            },
        ];
        for piece in pieces {
            for step in 0..200 {
                let wave = |f: f64| 0.5 + 0.5 * (f64::from(step) * f).sin();
                let (q, half) = (DVec2::new(wave(0.7), wave(1.3)), DVec2::new(0.03, 0.05));
                let (_, [uuu, uuv, uvv, vvv]) = piece.bounds(q, half);
                let off = half * DVec2::new(2.0 * wave(2.9) - 1.0, 2.0 * wave(0.41) - 1.0);
                let (middle, aside) = (piece.jet(q), piece.jet(q + off));
                let [du, dv] = off.abs().to_array();
                let allowed = [
                    uuu * du + uuv * dv,
                    uuv * du + uvv * dv,
                    uvv * du + vvv * dv,
                ];
                for k in 0..3 {
                    let change = (aside.second[k] - middle.second[k]).length();
                    assert!(change <= allowed[k] * (1.0 + 1e-9) + 1e-12, "{piece:?} {k}");
                }
            }
        }
    }
}
