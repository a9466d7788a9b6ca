//! Small objects in batches: all cores make some of them while none has to be in memory for long.

use std::ops::Range;

/// About how many triangles the photosurfaces of a batch have together: enough to keep all cores busy, and only a few
/// megabytes.
const TRIANGLES_AT_ONCE: usize = 100_000;

/// The largest number of objects in a batch. Refinement may make much more of an object than of the one before.
const MAX_OBJECTS: usize = 64;

/// Divides objects, in their order, into batches. How large the next one is depends on how many triangles the objects of
/// the last one had.
#[derive(Debug)]
pub(super) struct Batches {
    next: usize,
    objects: usize,
    size: usize,
}

impl Batches {
    /// Batches of so many objects. The first one has one object.
    pub(super) fn of(objects: usize) -> Self {
        Self {
            next: 0,
            objects,
            size: 1,
        }
    }

    /// The next batch; `None` after the last object.
    pub(super) fn next(&mut self) -> Option<Range<usize>> {
        let first = self.next;
        self.next = self.objects.min(first + self.size);
        (first < self.next).then_some(first..self.next)
    }

    /// Takes notice of the largest number of triangles of an object of the last batch.
    pub(super) fn made(&mut self, largest: usize) {
        let fitting = TRIANGLES_AT_ONCE / largest.max(1);
        self.size = fitting.clamp(1, MAX_OBJECTS).min(2 * self.size);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sizes of all batches of objects with these numbers of triangles.
    fn sizes(triangles: &[usize]) -> Vec<usize> {
        let mut batches = Batches::of(triangles.len());
        let mut sizes = vec![];
        let mut next = 0;
        while let Some(batch) = batches.next() {
            assert_eq!(batch.start, next);
            next = batch.end;
            sizes.push(batch.len());
            batches.made(triangles[batch].iter().copied().max().unwrap());
        }
        assert_eq!(next, triangles.len());
        sizes
    }

    #[test]
    fn batches_have_many_small_objects_and_single_large_ones() {
        assert_eq!(sizes(&[]), [0; 0]);
        assert_eq!(sizes(&[1_000_000; 3]), [1; 3]);
        assert_eq!(sizes(&[20; 200]), [1, 2, 4, 8, 16, 32, 64, 64, 9]);
        assert_eq!(sizes(&[25_000; 10]), [1, 2, 4, 3]);
        let mut mixed = vec![0; 10];
        mixed[4] = 60_000;
        assert_eq!(sizes(&mixed), [1, 2, 4, 1, 2]);
    }
}
