//! A queue of the faces that have to be divided; the face with the smallest flaw comes first.

/// The interval from a power of two to the next has `2^STEP_BITS` buckets, selected by the first bits of a float's
/// fraction.
const STEP_BITS: u32 = 5;

/// All flaws smaller than this share the first bucket.
const MIN: f32 = 1.0 / 16_777_216.0;

/// Number of powers of two above `MIN` that have buckets; all larger flaws share the last bucket.
const OCTAVES: usize = 32;

const BUCKETS: usize = OCTAVES << STEP_BITS;

const NONE: u32 = u32::MAX;

/// Faces in buckets of nearly equal flaws; within one bucket the face that was added last comes first.
///
/// A binary heap would jump to and fro in memory, whereas consecutive faces of a bucket are usually neighbours in
/// memory too. The buckets are linked lists in a single vector, so that a queue for a few faces costs little.
pub(super) struct Queue {
    /// One bit for each bucket, set if the bucket is not empty.
    filled: [u64; BUCKETS / 64],
    /// Index of the first entry of each bucket, or `NONE`.
    first: [u32; BUCKETS],
    entries: Vec<Queued>,
    /// Index of the first unused entry, or `NONE`.
    free: u32,
}

#[derive(Clone, Copy)]
struct Queued {
    task: Task,
    next: u32,
}

/// A face that has to be divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Task {
    pub(super) face: u32,
    /// Relative deviation of the face from the wanted one (see `Front::flaw` in `sky`).
    pub(super) flaw: f32,
}

impl Queue {
    pub(super) fn new() -> Self {
        Self {
            filled: [0; BUCKETS / 64],
            first: [NONE; BUCKETS],
            entries: vec![],
            free: NONE,
        }
    }

    pub(super) fn push(&mut self, task: Task) {
        let bucket = bucket(task.flaw);
        let entry = Queued {
            task,
            next: self.first[bucket],
        };
        self.first[bucket] = match self.entries.get_mut(self.free as usize) {
            Some(unused) => {
                let index = self.free;
                self.free = unused.next;
                *unused = entry;
                index
            }
            None => {
                self.entries.push(entry);
                (self.entries.len() - 1) as u32
            }
        };
        self.filled[bucket / 64] |= 1 << (bucket % 64);
    }

    pub(super) fn pop(&mut self) -> Option<Task> {
        let word = self.filled.iter().position(|&word| word != 0)?;
        let bucket = 64 * word + self.filled[word].trailing_zeros() as usize;
        let index = self.first[bucket];
        let Queued { task, next } = self.entries[index as usize];
        self.entries[index as usize].next = self.free;
        self.free = index;
        self.first[bucket] = next;
        if next == NONE {
            self.filled[word] &= self.filled[word] - 1;
        }
        Some(task)
    }
}

/// The bucket of a flaw. The bits of positive floats, read as integers, have the order of the floats.
fn bucket(flaw: f32) -> usize {
    let step = |flaw: f32| (flaw.to_bits() >> (f32::MANTISSA_DIGITS - 1 - STEP_BITS)) as usize;
    (step(flaw.max(MIN)) - step(MIN)).min(BUCKETS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_flaw_comes_first_and_of_equal_ones_the_last() {
        let mut queue = Queue::new();
        let flaws = [7.0, 0.0, f32::INFINITY, 1e-3, 1e30, 0.0, 40.0];
        for (face, flaw) in flaws.into_iter().enumerate() {
            queue.push(Task {
                face: face as u32,
                flaw,
            });
        }
        let mut faces = vec![];
        // A face is added between others and reuses the entry of a face that was removed.
        let first = queue.pop().map(|task| task.face);
        assert_eq!(first, Some(5));
        queue.push(Task {
            face: 9,
            flaw: 10.0,
        });
        while let Some(task) = queue.pop() {
            faces.push(task.face);
        }
        assert_eq!(faces, [1, 3, 0, 9, 6, 4, 2]);
        assert_eq!(queue.entries.len(), flaws.len());
        assert_eq!(queue.pop(), None);
    }

    #[test]
    fn flaws_of_a_few_per_cent_of_each_other_are_told_apart() {
        for flaw in [1e-6, 0.01, 1.0, 70.0] {
            assert!(bucket(flaw) < bucket(1.04 * flaw));
        }
        assert_eq!((bucket(0.0), bucket(1e-9)), (0, 0));
        assert_eq!(bucket(f32::INFINITY), BUCKETS - 1);
        assert_eq!(bucket(1e20), BUCKETS - 1);
    }
}
