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

/// The largest gap `e` of a mesh as seen from `observer`, both in the rest frame; never below the true one.
///
/// Same result for any number of threads: it is the largest of all, each taken as the smaller one of
/// [`triangle_gap`] and its ceiling, and who is passed over has a ceiling that is not above it.
pub(crate) fn largest_gap(mesh: &Mesh, observer: DVec3) -> f64 {
    largest_gap_of_others(mesh, observer, f64::INFINITY, 0.0)
}

/// The triangles, in their order, whose gap may be above a limit.
pub(super) fn triangles_above(mesh: &Mesh, observer: DVec3, limit: f64) -> Vec<u32> {
    let jobs = mesh.triangles().par_chunks(TRIANGLES_PER_JOB).enumerate();
    let above = jobs.map(|(job, triangles)| {
        let mut above = vec![];
        let mut index = (job * TRIANGLES_PER_JOB) as u32;
        glance(mesh.positions(), triangles, observer, |ceilings, _| {
            if !(ceilings.gap <= limit) {
                above.push(index);
            }
            index += 1;
        });
        above
    });
    above.collect::<Vec<Vec<u32>>>().concat()
}

/// The largest of the gaps of all triangles but those of [`triangles_above`] the limit, and of one that is known.
pub(super) fn largest_gap_of_others(mesh: &Mesh, observer: DVec3, limit: f64, known: f64) -> f64 {
    // The bits of floats that are not negative are in the order of the floats.
    let largest = AtomicU64::new(known.abs().to_bits());
    let jobs = mesh.triangles().par_chunks(TRIANGLES_PER_JOB);
    jobs.for_each(|triangles| {
        glance(
            mesh.positions(),
            triangles,
            observer,
            |ceilings, corners| {
                if ceilings.gap <= f64::from_bits(largest.load(Ordering::Relaxed))
                    || !(ceilings.gap <= limit)
                {
                    return;
                }
                let [a, b, c] = corners();
                let gap = triangle_gap(a, b, c).min(ceilings.gap);
                // NaN is above all numbers here, too.
                largest.fetch_max(gap.abs().to_bits(), Ordering::Relaxed);
            },
        );
    });
    f64::from_bits(largest.into_inner())
}

/// The sum of [`minimum_triangles`] over a mesh as seen from `observer`, at least one for each triangle there is.
pub(crate) fn least_triangles(mesh: &Mesh, observer: DVec3, allowance: &Allowance) -> f64 {
    let enough = match allowance {
        Allowance::Everywhere(allowed) => 2.0 * AREA_OF_GAP * allowed,
        Allowance::Angle { .. } => 0.0,
    };
    let jobs = mesh.triangles().par_chunks(TRIANGLES_PER_JOB);
    let sums = jobs.map(|triangles| {
        let mut sum = 0.0;
        glance(
            mesh.positions(),
            triangles,
            observer,
            |ceilings, corners| {
                sum += if ceilings.area < enough {
                    1.0
                } else {
                    minimum_triangles(corners(), allowance).max(1.0)
                };
            },
        );
        sum
    });
    // Added up in their order: the same sum for any number of threads.
    sums.collect::<Vec<f64>>().iter().sum()
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
        for observer in [
            DVec3::ZERO,
            DVec3::new(0.1, 0.2, 5.0),
            DVec3::new(1e3, 0.0, 0.0),
        ] {
            let gaps = each(&mesh, observer, |[a, b, c]| triangle_gap(a, b, c));
            let largest = gaps.into_iter().fold(0.0, f64::max);
            assert_eq!(largest_gap(&mesh, observer), largest, "{observer}");
            for allowed in [1e-2, 1e-4, 1e-6].map(Allowance::Everywhere) {
                let least = each(&mesh, observer, |c| minimum_triangles(c, &allowed).max(1.0));
                let (expected, found) = (
                    least.iter().sum::<f64>(),
                    least_triangles(&mesh, observer, &allowed),
                );
                assert!(
                    (found / expected - 1.0).abs() < 1e-13,
                    "{observer}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn a_mesh_without_triangles_needs_none() {
        let mesh = Mesh::new(vec![DVec3::X], vec![]).unwrap();
        assert_eq!(largest_gap(&mesh, DVec3::ZERO), 0.0);
        assert_eq!(
            least_triangles(&mesh, DVec3::ZERO, &Allowance::Everywhere(1.0)),
            0.0
        );
    }
}
