//! How many triangles a round shape needs: by theory, and about how many it will get.
//!
//! Every smooth piece of a photosurface, with vertices on it and a small tolerance `e`, needs at least the integral of
//! `sqrt(|K|) / (c e)` over its area, with its Gaussian curvature `K`, `c = 3 sqrt(3) / 2` where `K > 0` and
//! `c = 2 sqrt(5)` where `K < 0` (Pottmann, Krasauskas, Hamann, Joy, Seibold: *On piecewise linear approximation of
//! quadratic functions*, 2000). Where texture coordinates matter the second derivative of the seen place takes the place of
//! the second fundamental form; each of its components gives a bound, and the largest counts.
//!
//! A rim with chords that are within `e` of its arc needs the integral of the square root of its second derivative across
//! it, divided by `8 e`. A piece with `b` chords on its rims and with the Euler characteristic `x` has at least `b - 2 x`
//! triangles, two more for the tip of a cone: that is all a surface needs that is bent in one direction only.

use glam::{DVec2, DVec3};

use super::metric::density;
use super::rims::chords_of_rims;
use super::sight::About;
use super::sight::Sight;
use crate::shape::{Piece, Shape, Spot};

/// The parameters of a piece are divided into so many cells each way at first, and into no more cells than this.
const FIRST: usize = 8;
const MOST_CELLS: usize = 1_500;

/// The error at which cells are no longer divided, as a fraction of the whole.
const SMALL: f64 = 0.01;

/// How many triangles are made for each that the metric asks for: the fronts meet, and round numbers fit nowhere. Of few
/// triangles more are made: about as many as along so many lines across the piece. Both are measured, for surfaces and for
/// points.
const MADE: [f64; 2] = [1.25, 1.1];
const LINES: [f64; 2] = [5.0, 2.5];

/// Places slide along a surface as seen, so that what is made of it lies between what surfaces and points ask for: so many
/// triangles more as this number times the square of the rapidity, times the square root of the number for points. Measured
/// from gamma 7 to 220. Up to the least rapidity that is a few per cent, and not worth a look at points.
const SLIDING: f64 = 0.5;
const LEAST_RAPIDITY: f64 = 2.0;

/// The numbers of triangles for one sight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needed {
    /// The fewest by theory.
    pub(crate) least: f64,
    /// The numerical error of that, estimated.
    pub(crate) error: f64,
    /// About how many will be made.
    pub(crate) predicted: f64,
}

/// How many triangles a round shape needs.
pub(crate) fn needed(shape: &Shape, sight: &Sight, about: About) -> Needed {
    let mut needed = needed_by(shape, sight, about);
    let rapidity = sight.gamma_beta.asinh();
    if about == About::Surface && rapidity > LEAST_RAPIDITY {
        let of_points = needed_by(shape, sight, About::Points).predicted;
        let more = SLIDING * rapidity * rapidity * of_points.sqrt();
        // What cannot be proven as a surface is proven as points.
        needed.predicted = (needed.predicted + more).min(of_points);
    }
    needed
}

/// The same, but for what slides.
fn needed_by(shape: &Shape, sight: &Sight, about: About) -> Needed {
    let pieces = &shape.pieces(about == About::Points)[..];
    let chords = chords_of_rims(pieces, sight);
    let of_measure = usize::from(about == About::Points);
    let mut needed = Needed {
        least: 0.0,
        error: 0.0,
        predicted: 0.0,
    };
    for (index, piece) in pieces.iter().enumerate() {
        let integral = Integral::over(piece, sight, about);
        // What the chords of the rims need.
        let of_rims = |count: &dyn Fn(usize) -> f64| match piece {
            Piece::Lid { .. } => (count(index - 1) - 2.0).max(1.0),
            Piece::Side { .. } => count(0) + count(1),
            Piece::Slope { .. } => count(0),
            Piece::Tube { .. } => 14.0,
            Piece::Ball { .. } | Piece::Globe { .. } => 4.0,
        };
        let least = of_rims(&|rim| chords[rim][0].max(3.0));
        needed.least += integral.sums[0].max(least);
        needed.error += integral.errors[0];
        // What bends in one direction only needs no vertices inside.
        let wanted = match integral.sums[0] < 1.0 {
            true => 0.0,
            false => integral.sums[1] + LINES[of_measure] * integral.sums[1].sqrt(),
        };
        needed.predicted += MADE[of_measure] * wanted + of_rims(&|rim| chords[rim][1]);
    }
    needed
}

/// The integrals of two densities over a piece, and the estimated errors.
struct Integral {
    sums: [f64; 2],
    errors: [f64; 2],
}

/// A cell of parameters: its corner and size, its sums, and how much these changed when it was divided off.
struct Cell {
    low: DVec2,
    size: DVec2,
    sums: [f64; 2],
    change: [f64; 2],
}

impl Integral {
    fn over(piece: &Piece, sight: &Sight, about: About) -> Self {
        let cell = |low: DVec2, size: DVec2, change: [f64; 2]| {
            let (spot, area) = spot_and_area(piece, low + 0.5 * size);
            let sums =
                density(piece, &spot, sight, about).map(|number| number * area * size.x * size.y);
            Cell {
                low,
                size,
                sums,
                change,
            }
        };
        let each = DVec2::splat(1.0 / FIRST as f64);
        let mut cells: Vec<Cell> = (0..FIRST * FIRST)
            .map(|k| {
                cell(
                    each * DVec2::new((k % FIRST) as f64, (k / FIRST) as f64),
                    each,
                    [f64::INFINITY; 2],
                )
            })
            .collect();
        loop {
            let whole = cells
                .iter()
                .map(|cell| cell.sums[0] + cell.sums[1])
                .sum::<f64>();
            let change = |cell: &Cell| cell.change[0] + cell.change[1];
            let error: f64 = cells.iter().map(change).sum();
            if error <= SMALL * whole || whole == 0.0 || cells.len() > MOST_CELLS {
                break;
            }
            // All cells with more than their share of the error are divided.
            let share = 0.5 * SMALL * whole / cells.len() as f64;
            let (divided, kept): (Vec<Cell>, Vec<Cell>) =
                cells.into_iter().partition(|cell| change(cell) > share);
            if divided.is_empty() {
                cells = kept;
                break;
            }
            cells = kept;
            for old in divided {
                let half = 0.5 * old.size;
                let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
                let quarters = corners.map(|corner| cell(old.low + corner * half, half, [0.0; 2]));
                let of = |k: usize| quarters.iter().map(|quarter| quarter.sums[k]).sum::<f64>();
                // A middle rule with half the step has a third of the difference left as its error.
                let change = [0, 1].map(|k| (of(k) - old.sums[k]).abs() / 12.0);
                cells.extend(
                    quarters
                        .into_iter()
                        .map(|quarter| Cell { change, ..quarter }),
                );
            }
        }
        let sum = |of: &dyn Fn(&Cell) -> f64| cells.iter().map(of).sum::<f64>();
        Self {
            sums: [0, 1].map(|k| sum(&|cell| cell.sums[k])),
            errors: [0, 1].map(|k| sum(&|cell| cell.change[k].min(cell.sums[k]))),
        }
    }
}

/// The spot at coordinates from 0 to 1, and the area of the shape's own frame per unit of both.
fn spot_and_area(piece: &Piece, at: DVec2) -> (Spot, f64) {
    let (piece_of_angles, q, scale) = match *piece {
        Piece::Ball { radius } => (Piece::Globe { radius }, at, 1.0),
        Piece::Side { height, .. } => (*piece, DVec2::new(at.x, (at.y - 0.5) * height), height),
        Piece::Lid { radius, .. } => {
            // Polar coordinates of the lid.
            let (sin, cos) = (at.x * std::f64::consts::TAU).sin_cos();
            let out = radius * at.y;
            let spot = Spot::inside(DVec3::new(out * cos, out * sin, 0.0));
            return (spot, std::f64::consts::TAU * radius * out);
        }
        other => (other, at, 1.0),
    };
    let jet = piece_of_angles.jet(q);
    let area = jet.first[0].cross(jet.first[1]).length() * scale;
    let spot = match piece {
        Piece::Ball { .. } => Spot::inside(jet.place.normalize_or_zero()),
        _ => Spot::inside(q.extend(0.0)),
    };
    (spot, area)
}
