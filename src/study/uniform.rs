//! What dividing every triangle into four, over and over, would take instead.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::measured::{Pair, largest, mix};
use super::random::Random;
use crate::mesh::Mesh;
use crate::pipeline::{PlacedScene, SurfaceOptions, Unrefined};
use crate::tessellate::{Allowance, triangle_gap};

/// Deeper than this nothing is divided: what an observer touches may have a gap after any number of halvings.
const MAX_LEVELS: u32 = 40;

/// What uniform subdivision takes for the same bound.
///
/// Each mesh, of each part at each step, is divided as often as it has to be and no more: all of its triangles into
/// four, by the middles of their sides. It starts from what the sky's triangulation starts from, so that round shapes
/// are as fine as their curvature asks for already.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UniformCost {
    /// Most levels of any mesh.
    pub levels: u32,
    /// Triangles of all meshes together; there may be more than anyone could make.
    pub triangles: f64,
    /// What came out, where it was carried out.
    pub run: Option<UniformRun>,
}

/// What uniform subdivision gives, as lengths in the observer's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UniformRun {
    /// Proven: the largest gap of all triangles.
    pub gap: f64,
    /// Measured: the largest gap at random places.
    pub error: f64,
}

/// What uniform subdivision of the meshes of a placed scene takes; carried out, with so many `samples`, where that makes no more
/// triangles than `most`.
pub(super) fn uniform_cost(
    placed: &PlacedScene,
    wanted: SurfaceOptions,
    most: u64,
    samples: usize,
) -> UniformCost {
    let mut cost = UniformCost {
        levels: 0,
        triangles: 0.0,
        run: None,
    };
    let mut divided = vec![];
    for step in 0..placed.scene().steps().len() {
        for unrefined in placed.unrefined(step, wanted) {
            let levels: Vec<u32> = unrefined
                .parts
                .iter()
                .map(|(_, part)| levels(&unrefined, part.mesh()))
                .collect();
            for ((_, part), &levels) in unrefined.parts.iter().zip(&levels) {
                cost.levels = cost.levels.max(levels);
                cost.triangles += triangles(part.mesh(), levels);
            }
            if cost.triangles <= most as f64 {
                divided.push((unrefined, levels));
            }
        }
    }
    if cost.triangles <= most as f64 {
        let mut run = UniformRun {
            gap: 0.0,
            error: 0.0,
        };
        for (unrefined, levels) in &divided {
            for ((_, part), &levels) in unrefined.parts.iter().zip(levels) {
                let pieces = Pieces::new(unrefined, part.mesh(), levels);
                let share = triangles(part.mesh(), levels) / cost.triangles;
                run.gap = run.gap.max(pieces.gap());
                run.error = run
                    .error
                    .max(pieces.error((samples as f64 * share).ceil() as usize));
            }
        }
        cost.run = Some(run);
    }
    cost
}

fn triangles(mesh: &Mesh, levels: u32) -> f64 {
    mesh.triangle_count() as f64 * 4f64.powi(levels as i32)
}

/// How often all triangles of a mesh have to be divided, so that every piece is within what is allowed.
///
/// No piece has a larger gap than what it is a piece of (`r` is convex, its chord plane above that of the piece), so
/// what is within the allowance needs no look at its pieces: the levels are exact, and known without making them.
fn levels(unrefined: &Unrefined<'_>, mesh: &Mesh) -> u32 {
    if unrefined.view.relative_velocity().rapidity() == 0.0 {
        return 0;
    }
    let observer = unrefined.view.observer_rest();
    let levels = mesh.triangles().par_iter().map(|corners| {
        let offsets = corners.map(|corner| mesh.positions()[corner as usize] - observer);
        levels_of(offsets, &unrefined.allowance, 0)
    });
    levels.max().unwrap_or(0)
}

fn levels_of(offsets: [DVec3; 3], allowance: &Allowance, done: u32) -> u32 {
    let [a, b, c] = offsets;
    if done == MAX_LEVELS || triangle_gap(a, b, c) <= allowance.between(&offsets) {
        return done;
    }
    let pieces = quarters(offsets).into_iter();
    let levels = pieces.map(|piece| levels_of(piece, allowance, done + 1));
    levels.fold(done, u32::max)
}

/// By the middles of the sides.
fn quarters([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| 0.5 * (from + to));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
}

/// The pieces of a mesh, none of which is kept.
struct Pieces<'a> {
    unrefined: &'a Unrefined<'a>,
    mesh: &'a Mesh,
    levels: u32,
}

impl<'a> Pieces<'a> {
    fn new(unrefined: &'a Unrefined<'a>, mesh: &'a Mesh, levels: u32) -> Self {
        Self {
            unrefined,
            mesh,
            levels,
        }
    }

    /// The largest gap of all pieces, as a length in the observer's frame.
    fn gap(&self) -> f64 {
        let observer = self.unrefined.view.observer_rest();
        let gaps = self.mesh.triangles().par_iter().map(|corners| {
            let offsets = corners.map(|corner| self.mesh.positions()[corner as usize] - observer);
            largest_gap(offsets, self.levels)
        });
        let gamma_beta = self.unrefined.view.relative_velocity().gamma_beta();
        gamma_beta * gaps.reduce(|| 0.0, f64::max)
    }

    /// The largest distance between what is seen and what is drawn, at random places of random pieces.
    fn error(&self, samples: usize) -> f64 {
        let view = &self.unrefined.view;
        let triangles = self.mesh.triangles();
        if triangles.is_empty() {
            return 0.0;
        }
        let place = |_: usize, random: &mut Random| {
            let corners = triangles[random.below(triangles.len())];
            let mut piece = corners.map(|corner| self.mesh.positions()[corner as usize]);
            for _ in 0..self.levels {
                piece = quarters(piece)[random.below(4)];
            }
            let weights = random.weights();
            Pair {
                seen: view.seen_position(mix(piece, weights)),
                drawn: mix(piece.map(|corner| view.seen_position(corner)), weights),
            }
        };
        let [error] = largest(samples, place, |pair| [pair.distance()]);
        error
    }
}

fn largest_gap(offsets: [DVec3; 3], levels: u32) -> f64 {
    if levels == 0 {
        let [a, b, c] = offsets;
        return triangle_gap(a, b, c);
    }
    let pieces = quarters(offsets).into_iter();
    pieces
        .map(|piece| largest_gap(piece, levels - 1))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the design of the refinement was measured against: a plate of side 2 at a distance `h`.
    #[test]
    fn a_plate_takes_as_many_as_was_found_by_other_means() {
        let levels = |h: f64, e: f64| {
            let [a, b, c, d] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, y]| DVec3::new(x, y, -h));
            let halves = [[a, b, c], [a, c, d]];
            let levels = halves.map(|half| levels_of(half, &Allowance::Everywhere(e), 0));
            levels[0].max(levels[1])
        };
        for (h, expected) in [
            (1.0, 32_768),
            (0.1, 524_288),
            (0.01, 2_097_152),
            (0.001, 33_554_432),
        ] {
            assert_eq!(2 * 4u64.pow(levels(h, 1e-4)), expected, "{h}");
        }
    }

    #[test]
    fn one_level_less_is_not_enough() {
        let offsets = [[-1.0, -1.0, -0.3], [1.0, -1.0, -0.3], [1.0, 1.0, -2.0]].map(DVec3::from);
        for e in [1e-2, 1e-3, 1e-4] {
            let levels = levels_of(offsets, &Allowance::Everywhere(e), 0);
            assert!(largest_gap(offsets, levels) <= e);
            assert!(largest_gap(offsets, levels - 1) > e);
        }
    }
}
