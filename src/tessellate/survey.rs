//! A survey of a whole mesh before any refinement: its largest gap, and the fewest triangles that theory allows for it.
//!
//! For nearly all triangles of a fine mesh cheap bounds (`ceiling`) show that their gap is smaller than one found
//! before, and that theory asks for no more than the triangle itself. Only the other triangles are examined one by one.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::ceiling::{Ceilings, ceilings};
use super::minimum::AREA_OF_GAP;
use super::{Allowance, Motion, minimum_triangles, triangle_gap};
use crate::mesh::{Mesh, Places};

/// Number of triangles that a thread processes at a time. It is constant, so that sums do not depend on the number of
/// threads.
const TRIANGLES_PER_JOB: usize = 16_384;

/// Number of triangles whose cheap bounds are computed together in vector instructions, as in `light_cone`.
const BLOCK: usize = 64;

/// The result of a survey of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Survey {
    /// Indices of the triangles whose gap may exceed the limit, in increasing order.
    pub(crate) above: Vec<u32>,
    /// An upper bound on the largest gap `e` of all other triangles, in the rest frame.
    pub(crate) gap: f64,
    /// The fewest triangles that theory allows for any mesh: the sum of [`minimum_triangles`] over all triangles.
    pub(crate) minimum_triangles: f64,
    /// The same with each triangle counted as at least one.
    pub(crate) minimum_with_source: f64,
}

/// Surveys a mesh: which triangles may have gaps above `limit`, and how many triangles are needed to keep all gaps
/// within `allowance`; of points, or, where a motion is given, of surfaces. The mesh, the position `observer` and the
/// gaps are in the rest frame.
///
/// The result is the same for any number of threads. The gap of a triangle is the smaller one of [`triangle_gap`] and
/// its cheap bound, and the result is the largest of all. A triangle is skipped only if its cheap bound is not above a
/// gap found before, so skipping never changes the result.
pub(crate) fn survey(
    mesh: &Mesh,
    observer: DVec3,
    limit: f64,
    allowance: &Allowance,
    motion: Option<&Motion>,
) -> Survey {
    let enough = match allowance {
        Allowance::Everywhere(allowed) => 2.0 * AREA_OF_GAP * allowed,
        Allowance::Angle { .. } => 0.0,
    };
    // The bits of non-negative floats, read as integers, have the order of the floats.
    let largest = AtomicU64::new(0);
    let (places, triangles) = mesh.facets();
    let jobs = triangles.par_chunks(TRIANGLES_PER_JOB).enumerate();
    let found = jobs.map(|(job, triangles)| {
        let mut above = vec![];
        let (mut sum, mut with_source) = (0.0, 0.0);
        let mut index = (job * TRIANGLES_PER_JOB) as u32;
        glance(
            places,
            triangles,
            (observer, motion),
            |ceilings, corners| {
                if ceilings.area < enough && !ceilings.integral.is_nan() {
                    sum += ceilings.integral / enough;
                    with_source += 1.0;
                } else {
                    let minimum = minimum_triangles(corners(), allowance, motion);
                    sum += minimum;
                    with_source += minimum.max(1.0);
                }
                if !(ceilings.gap <= limit) {
                    above.push(index);
                } else if !(ceilings.gap <= f64::from_bits(largest.load(Ordering::Relaxed))) {
                    let [a, b, c] = corners();
                    let gap = triangle_gap(a, b, c).min(ceilings.gap);
                    largest.fetch_max(gap.abs().to_bits(), Ordering::Relaxed);
                }
                index += 1;
            },
        );
        (above, (sum, with_source))
    });
    let (above, sums): (Vec<Vec<u32>>, Vec<(f64, f64)>) = found.unzip();
    Survey {
        above: above.concat(),
        gap: f64::from_bits(largest.into_inner()),
        // The sums are added in the order of the jobs, so the result is the same for any number of threads.
        minimum_triangles: sums.iter().map(|(sum, _)| sum).sum(),
        minimum_with_source: sums.iter().map(|(_, sum)| sum).sum(),
    }
}

/// An upper bound on the largest gap `e` of a mesh, in the rest frame like the mesh and the position `observer`.
pub(crate) fn largest_gap(mesh: &Mesh, observer: DVec3) -> f64 {
    let any = Allowance::Everywhere(f64::INFINITY);
    survey(mesh, observer, f64::INFINITY, &any, None).gap
}

/// Calls `tell` for each triangle in its order, with its cheap bounds and a function that returns the offsets of its
/// corners from the observer.
fn glance(
    places: Places<'_>,
    triangles: &[[u32; 3]],
    (observer, motion): (DVec3, Option<&Motion>),
    mut tell: impl FnMut(Ceilings, &dyn Fn() -> [DVec3; 3]),
) {
    let arch = Arch::new();
    let mut known = [Ceilings::UNKNOWN; BLOCK];
    for triangles in triangles.chunks(BLOCK) {
        arch.dispatch(Block {
            places,
            triangles,
            observer,
            motion,
            known: &mut known,
        });
        for (corners, &ceilings) in triangles.iter().zip(&known) {
            tell(ceilings, &|| {
                corners.map(|corner| places.at(corner) - observer)
            });
        }
    }
}

struct Block<'a> {
    places: Places<'a>,
    triangles: &'a [[u32; 3]],
    observer: DVec3,
    motion: Option<&'a Motion>,
    known: &'a mut [Ceilings; BLOCK],
}

impl NullaryFnOnce for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // The offsets are stored coordinate by coordinate, so that the compiler can use vector instructions.
        let mut offsets = [[[0.0; BLOCK]; 3]; 3];
        self.places
            .write_offsets(self.triangles, self.observer, &mut offsets);
        for (index, known) in self.known.iter_mut().enumerate() {
            let corner = |corner: usize| DVec3 {
                x: offsets[corner][0][index],
                y: offsets[corner][1][index],
                z: offsets[corner][2][index],
            };
            *known = ceilings([corner(0), corner(1), corner(2)], self.motion);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bumpy sheet that is close to the observer on one side and far on the other. The order of its triangles does
    /// not show where the largest gap is.
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
                    minimum_triangles(c, &allowance, None).max(1.0)
                });
                let expected = least.iter().sum::<f64>();
                let found = survey(&mesh, observer, 0.5 * allowed, &allowance, None);
                let ratio = found.minimum_with_source / expected;
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
        let found = survey(&mesh, DVec3::ZERO, 0.0, &Allowance::Everywhere(1.0), None);
        let minima = (found.minimum_triangles, found.minimum_with_source);
        assert_eq!((found.gap, minima), (0.0, (0.0, 0.0)));
        assert!(found.above.is_empty());
    }
}
