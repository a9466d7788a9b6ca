//! Positions and normals of vertices: at hand, or computed piece by piece where they are wanted.
//!
//! What can be computed from what is at hand need not be in memory: of a large mesh, which is looked through a few times,
//! computing it again takes less time than making room for it.

use std::fmt;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use super::extent::Extent;
use super::triangles::Triangles;
use super::values::{flat_normal, flattened};
use super::vectors::{Places, Vectors};

/// A mesh with more vertices than this computes them where they are wanted, if it can. Of a smaller one they take little
/// memory, which is at hand from one step to the next.
pub(crate) const MANY_VERTICES: usize = 1 << 18;

/// Number of vertices that are computed at a time: few enough for the cache of a core. Pieces that begin at multiples of it
/// are the same however a mesh is cut into them.
pub(crate) const VERTICES_AT_ONCE: usize = 256;

/// Writes the positions of the vertices from a given number on, and their normals where they are asked for.
pub(crate) type Compute = dyn Fn(usize, &mut [DVec3], Option<&mut [DVec3]>) + Send + Sync;

/// Positions and normals of vertices; a clone shares them.
#[derive(Clone, Debug)]
pub(super) enum Vertices {
    Held {
        positions: Arc<Vectors>,
        normals: Option<Arc<Vectors>>,
    },
    Computed(Arc<Computed>),
}

/// Vertices that are computed when they are wanted.
pub(super) struct Computed {
    count: usize,
    has_normals: bool,
    source: Source,
    /// All positions and normals, once someone has asked for a slice.
    all: OnceLock<(Vec<DVec3>, Vec<DVec3>)>,
}

enum Source {
    /// Three vertices for each of these triangles, with the normal of the triangle.
    Facets {
        positions: Arc<Vectors>,
        triangles: Arc<Triangles>,
    },
    Image(Box<Compute>),
}

impl fmt::Debug for Computed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (all, _) = self.all();
        f.debug_list().entries(all).finish()
    }
}

impl Default for Vertices {
    fn default() -> Self {
        Self::Held {
            positions: Arc::default(),
            normals: None,
        }
    }
}

impl Vertices {
    pub(super) fn held(positions: impl Into<Vectors>, normals: Option<Vectors>) -> Self {
        Self::Held {
            positions: Arc::new(positions.into()),
            normals: normals.map(Arc::new),
        }
    }

    /// The vertices of flat triangles, three for each.
    pub(super) fn of_facets(positions: Arc<Vectors>, triangles: Arc<Triangles>) -> Self {
        let computed = Computed {
            count: 3 * triangles.len(),
            has_normals: true,
            source: Source::Facets {
                positions,
                triangles,
            },
            all: OnceLock::new(),
        };
        Self::Computed(computed.into())
    }

    /// The images of `count` vertices.
    pub(super) fn image(count: usize, has_normals: bool, compute: Box<Compute>) -> Self {
        let computed = Computed {
            count,
            has_normals,
            source: Source::Image(compute),
            all: OnceLock::new(),
        };
        Self::Computed(computed.into())
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Held { positions, .. } => positions.len(),
            Self::Computed(computed) => computed.count,
        }
    }

    /// Where the positions and the normals are held, 0 where there are none.
    pub(super) fn addresses(&self) -> [usize; 2] {
        match self {
            Self::Held { positions, normals } => [
                Arc::as_ptr(positions) as usize,
                normals
                    .as_ref()
                    .map_or(0, |normals| Arc::as_ptr(normals) as usize),
            ],
            Self::Computed(computed) => [Arc::as_ptr(computed) as usize; 2],
        }
    }

    pub(super) fn has_normals(&self) -> bool {
        match self {
            Self::Held { normals, .. } => normals.is_some(),
            Self::Computed(computed) => computed.has_normals,
        }
    }

    pub(super) fn positions(&self) -> &[DVec3] {
        match self {
            Self::Held { positions, .. } => positions.as_slice(),
            Self::Computed(computed) => &computed.all().0,
        }
    }

    pub(super) fn normals(&self) -> Option<&[DVec3]> {
        match self {
            Self::Held { normals, .. } => normals.as_ref().map(|normals| normals.as_slice()),
            Self::Computed(computed) => computed.has_normals.then(|| &computed.all().1[..]),
        }
    }

    /// The positions, and the normals if they are asked for, of the vertices from number `first` on. `first` is a multiple
    /// of [`VERTICES_AT_ONCE`].
    pub(super) fn read(
        &self,
        first: usize,
        places: &mut [DVec3],
        directions: Option<&mut [DVec3]>,
    ) {
        match self {
            Self::Held { positions, normals } => {
                positions.read(first, places);
                if let Some((normals, directions)) = normals.as_ref().zip(directions) {
                    normals.read(first, directions);
                }
            }
            Self::Computed(computed) => computed.read(first, places, directions),
        }
    }

    /// Where some vertices are, if that is quickly told.
    pub(super) fn extent_at_once(&self, part: Range<usize>) -> Option<Extent> {
        match self {
            Self::Held { positions, .. } => positions.extent_at_once(part),
            Self::Computed(_) => None,
        }
    }

    /// The places of shared vertices and triangles between them, which have the same corners as the triangles of the mesh,
    /// one by one; `None` where the mesh has no others than its own.
    pub(super) fn facets(&self) -> Option<(Places<'_>, &Arc<Triangles>)> {
        match self {
            Self::Computed(computed) => match &computed.source {
                Source::Facets {
                    positions,
                    triangles,
                } => Some((positions.places(), triangles)),
                Source::Image(_) => None,
            },
            Self::Held { .. } => None,
        }
    }

    /// The places of the vertices.
    pub(super) fn places(&self) -> Places<'_> {
        match self {
            Self::Held { positions, .. } => positions.places(),
            Self::Computed(computed) => Places::Double(&computed.all().0),
        }
    }

    /// All of them at hand, each for itself.
    pub(super) fn into_held(self) -> (Arc<Vectors>, Option<Arc<Vectors>>) {
        match self {
            Self::Held { positions, normals } => (positions, normals),
            Self::Computed(computed) => {
                let (positions, normals) = computed.all();
                let copy = |vectors: &[DVec3]| Arc::new(Vectors::from(vectors.to_vec()));
                let normals = computed.has_normals.then(|| copy(normals));
                (copy(positions), normals)
            }
        }
    }
}

impl Computed {
    fn all(&self) -> &(Vec<DVec3>, Vec<DVec3>) {
        // Not while the lock is held: a thread that waits for others in here may take up work that asks too.
        match self.all.get() {
            Some(all) => all,
            None => {
                let all = self.compute_all();
                self.all.get_or_init(|| all)
            }
        }
    }

    fn compute_all(&self) -> (Vec<DVec3>, Vec<DVec3>) {
        // Arrays have a known place in the result, so that all threads write to it directly.
        let jobs = (0..self.count.div_ceil(VERTICES_AT_ONCE)).into_par_iter();
        let array = |job: usize| {
            let first = job * VERTICES_AT_ONCE;
            let count = VERTICES_AT_ONCE.min(self.count - first);
            let mut positions = [DVec3::ZERO; VERTICES_AT_ONCE];
            let mut normals = [DVec3::ZERO; VERTICES_AT_ONCE];
            let directions = self.has_normals.then_some(&mut normals[..count]);
            self.compute(first, &mut positions[..count], directions);
            (positions, normals)
        };
        match self.has_normals {
            true => {
                let (positions, normals): (Vec<_>, Vec<_>) = jobs.map(array).unzip();
                (
                    flattened(positions, self.count),
                    flattened(normals, self.count),
                )
            }
            false => {
                let positions = jobs.map(|job| array(job).0).collect();
                (flattened(positions, self.count), vec![])
            }
        }
    }

    fn read(&self, first: usize, positions: &mut [DVec3], normals: Option<&mut [DVec3]>) {
        let Some((all_positions, all_normals)) = self.all.get() else {
            return self.compute(first, positions, normals);
        };
        let part = first..first + positions.len();
        positions.copy_from_slice(&all_positions[part.clone()]);
        if let Some(normals) = normals {
            normals.copy_from_slice(&all_normals[part]);
        }
    }

    fn compute(&self, first: usize, positions: &mut [DVec3], mut normals: Option<&mut [DVec3]>) {
        match &self.source {
            Source::Image(compute) => compute(first, positions, normals),
            Source::Facets {
                positions: places,
                triangles,
            } => {
                let places = places.places();
                // A piece may begin and end within a triangle.
                let (mut vertex, end) = (first, first + positions.len());
                while vertex < end {
                    let corners = triangles.at(vertex / 3).map(|corner| places.at(corner));
                    let normal = normals.as_ref().map(|_| flat_normal(corners));
                    for &corner in &corners[vertex % 3..] {
                        if vertex == end {
                            break;
                        }
                        positions[vertex - first] = corner;
                        if let Some((normals, normal)) = normals.as_mut().zip(normal) {
                            normals[vertex - first] = normal;
                        }
                        vertex += 1;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles between `count` places, some of which are the same.
    fn strip(count: u32) -> (Arc<Vectors>, Arc<Triangles>) {
        let place = |k: u32| [(k as f32).sin(), (k / 2) as f32, -0.0];
        let triangles: Vec<[u32; 3]> = (0..count - 2).map(|k| [k, k + 1, k + 2]).collect();
        let places = Vectors::single((0..count).map(place).collect());
        (Arc::new(places), Arc::new(triangles.into()))
    }

    #[test]
    fn facets_are_the_same_all_at_once_and_piece_by_piece() {
        for count in [3, 342, 343, 344, 1025, 5000] {
            let (places, triangles) = strip(count);
            let (mut positions, mut normals) = (vec![], vec![]);
            for &corners in triangles.as_slice() {
                let corners = corners.map(|corner| places.places().at(corner));
                positions.extend(corners);
                normals.extend([flat_normal(corners); 3]);
            }
            let vertices = || Vertices::of_facets(places.clone(), triangles.clone());
            let (by_pieces, at_once) = (vertices(), vertices());
            assert_eq!(at_once.positions(), positions);
            assert_eq!(at_once.normals().unwrap(), normals);
            // Then they are at hand, and read from there.
            for vertices in [&by_pieces, &at_once] {
                assert_eq!(vertices.len(), positions.len());
                for first in (0..positions.len()).step_by(VERTICES_AT_ONCE) {
                    let length = VERTICES_AT_ONCE.min(positions.len() - first);
                    let part = first..first + length;
                    let mut places = vec![DVec3::NAN; length];
                    vertices.read(first, &mut places, None);
                    assert_eq!(places, positions[part.clone()]);
                    let mut directions = places.clone();
                    vertices.read(first, &mut places, Some(&mut directions));
                    assert_eq!(places, positions[part.clone()]);
                    assert_eq!(directions, normals[part]);
                }
            }
            assert!(matches!(&by_pieces, Vertices::Computed(all) if all.all.get().is_none()));
        }
    }
}
