//! What a whole mesh is before any refinement: its largest gap, and the fewest triangles that theory allows for it.
//!
//! Nearly all triangles of a fine mesh are known at a glance to have a smaller gap than one that was met before, and to
//! be enough by themselves; the others are looked at one by one.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::ceiling::{Ceilings, ceilings};
use super::minimum::AREA_OF_GAP;
use super::{Allowance, minimum_triangles, triangle_gap};
use crate::mesh::Mesh;

/// Triangles a thread takes at a time; always the same, so that sums do not depend on the threads.
const TRIANGLES_PER_JOB: usize = 16_384;

/// Triangles that are looked at at once: see `light_cone`.
const BLOCK: usize = 64;

/// What is known of a mesh after one look at all of its triangles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Survey {
    /// The triangles, in their order, whose gap may be above the limit.
    pub(crate) above: Vec<u32>,
    /// The largest gap `e` of all others; never below the true one.
    pub(crate) gap: f64,
    /// The fewest triangles that theory allows: the sum of [`minimum_triangles`], at least one for each triangle.
    pub(crate) minimum_triangles: f64,
}

/// Surveys a mesh as seen from `observer`, both in the rest frame: which triangles may have gaps above `limit`, and how
/// many it takes to keep all gaps within `allowance`.
///
/// Same result for any number of threads: the gap is the largest of all, each taken as the smaller one of
/// [`triangle_gap`] and its ceiling, and who is passed over has a ceiling that is not above it.
pub(crate) fn survey(mesh: &Mesh, observer: DVec3, limit: f64, allowance: &Allowance) -> Survey {
    let enough = match allowance {
        Allowance::Everywhere(allowed) => 2.0 * AREA_OF_GAP * allowed,
        Allowance::Angle { .. } => 0.0,
    };
    // The bits of floats that are not negative are in the order of the floats.
    let largest = AtomicU64::new(0);
    let jobs = mesh.triangles().par_chunks(TRIANGLES_PER_JOB).enumerate();
    let found = jobs.map(|(job, triangles)| {
        let mut above = vec![];
        let mut sum = 0.0;
        let mut index = (job * TRIANGLES_PER_JOB) as u32;
        let positions = mesh.positions();
        glance(positions, triangles, observer, |ceilings, corners| {
            sum += if ceilings.area < enough {
                1.0
            } else {
                minimum_triangles(corners(), allowance).max(1.0)
            };
            if !(ceilings.gap <= limit) {
                above.push(index);
            } else if !(ceilings.gap <= f64::from_bits(largest.load(Ordering::Relaxed))) {
                let [a, b, c] = corners();
                let gap = triangle_gap(a, b, c).min(ceilings.gap);
                largest.fetch_max(gap.abs().to_bits(), Ordering::Relaxed);
            }
            index += 1;
        });
        (above, sum)
    });
    let (above, sums): (Vec<Vec<u32>>, Vec<f64>) = found.unzip();
    Survey {
        above: above.concat(),
        gap: f64::from_bits(largest.into_inner()),
        // Added up in their order: the same sum for any number of threads.
        minimum_triangles: sums.iter().sum(),
    }
}

/// The largest gap `e` of a mesh as seen from `observer`, both in the rest frame; never below the true one.
pub(crate) fn largest_gap(mesh: &Mesh, observer: DVec3) -> f64 {
    let any = Allowance::Everywhere(f64::INFINITY);
    survey(mesh, observer, f64::INFINITY, &any).gap
}

/// Tells of each triangle, in their order, what is known at once, and its corners relative to the observer where they
/// are asked for.
fn glance(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    observer: DVec3,
    mut tell: impl FnMut(Ceilings, &dyn Fn() -> [DVec3; 3]),
) {
    let arch = Arch::new();
    let mut known = [Ceilings::UNKNOWN; BLOCK];
    for triangles in triangles.chunks(BLOCK) {
        arch.dispatch(Block {
            positions,
            triangles,
            observer,
            known: &mut known,
        });
        for (corners, &ceilings) in triangles.iter().zip(&known) {
            tell(ceilings, &|| {
                corners.map(|corner| positions[corner as usize] - observer)
            });
        }
    }
}

struct Block<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    observer: DVec3,
    known: &'a mut [Ceilings; BLOCK],
}

impl NullaryFnOnce for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // Coordinate by coordinate, so that the compiler can make vectors of them.
        let mut offsets = [[[0.0; BLOCK]; 3]; 3];
        for (index, corners) in self.triangles.iter().enumerate().take(BLOCK) {
            for (offsets, &corner) in offsets.iter_mut().zip(corners) {
                let offset = self.positions[corner as usize] - self.observer;
                offsets[0][index] = offset.x;
                offsets[1][index] = offset.y;
                offsets[2][index] = offset.z;
            }
        }
        for index in 0..BLOCK {
            let corner = |corner: usize| DVec3 {
                x: offsets[corner][0][index],
                y: offsets[corner][1][index],
                z: offsets[corner][2][index],
            };
            self.known[index] = ceilings([corner(0), corner(1), corner(2)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bumpy sheet close to the observer on one side and far on the other, in an order that hides the largest gap.
    fn sheet() -> Mesh {
        let cells = 60;
        let at = |i: u32, j: u32| {
            let (x, y) = (f64::from(i) / 10.0, f64::from(j) / 20.0);
            DVec3::new(x - 2.0, y - 1.4, 0.15 + 0.1 * (3.0 * x).sin() * y)
        };
        let positions = (0..=cells).flat_map(|i| (0..=cells).map(move |j| at(i, j)));
        let corner = |i: u32, j: u32| i * (cells + 1) + j;
        let cell = |i: u32, j: u32| {
            let [a, b, c, d] = [
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1),
            ];
            [[a, b, c], [a, c, d]]
        };
        let triangles = (0..cells).flat_map(|i| (0..cells).flat_map(move |j| cell(i, j)));
        Mesh::new(positions.collect(), triangles.collect()).unwrap()
    }

    fn each<T>(mesh: &Mesh, observer: DVec3, of: impl Fn([DVec3; 3]) -> T) -> Vec<T> {
        let corners = mesh.triangles().iter();
        let offsets = corners.map(|c| c.map(|corner| mesh.positions()[corner as usize] - observer));
        offsets.map(of).collect()
    }

    #[test]
    fn at_a_glance_or_one_by_one_is_the_same() {
        let mesh = sheet();
        let observers = [
            DVec3::ZERO,
            DVec3::new(0.1, 0.2, 5.0),
            DVec3::new(1e3, 0.0, 0.0),
        ];
        for observer in observers {
            let gaps = each(&mesh, observer, |[a, b, c]| triangle_gap(a, b, c));
            let largest = gaps.iter().copied().fold(0.0, f64::max);
            assert_eq!(largest_gap(&mesh, observer), largest, "{observer}");
            for allowed in [1e-2, 1e-4, 1e-6] {
                let allowance = Allowance::Everywhere(allowed);
                let least = each(&mesh, observer, |c| {
                    minimum_triangles(c, &allowance).max(1.0)
                });
                let expected = least.iter().sum::<f64>();
                let found = survey(&mesh, observer, 0.5 * allowed, &allowance);
                let ratio = found.minimum_triangles / expected;
                assert!((ratio - 1.0).abs() < 1e-13, "{observer}: {ratio}");

                let mut others = 0.0f64;
                for (index, &gap) in gaps.iter().enumerate() {
                    if found.above.binary_search(&(index as u32)).is_err() {
                        assert!(gap <= 0.5 * allowed, "{observer}, triangle {index}");
                        others = others.max(gap);
                    }
                }
                assert_eq!(found.gap, others, "{observer}");
                let needless = found
                    .above
                    .iter()
                    .filter(|&&t| gaps[t as usize] < 0.2 * allowed);
                assert!(
                    needless.count() <= mesh.triangles().len() / 10,
                    "{observer}"
                );
            }
        }
    }

    #[test]
    fn a_mesh_without_triangles_needs_none() {
        let mesh = Mesh::new(vec![DVec3::X], vec![]).unwrap();
        let found = survey(&mesh, DVec3::ZERO, 0.0, &Allowance::Everywhere(1.0));
        assert_eq!((found.gap, found.minimum_triangles), (0.0, 0.0));
        assert!(found.above.is_empty());
    }
}
