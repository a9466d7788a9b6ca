//! A queue of faces that have to be divided, those of the least flaw first.

/// Flaws between a power of two and the next are told apart in this many steps, as the first bits of a float.
const STEP_BITS: u32 = 5;

/// Smaller flaws are all alike.
const MIN: f32 = 1.0 / 16_777_216.0;

/// So are those larger than that by so many powers of two.
const OCTAVES: usize = 32;

const BUCKETS: usize = OCTAVES << STEP_BITS;

const NONE: u32 = u32::MAX;

/// Faces in buckets of nearly equal flaw; of one bucket, the last comes first.
///
/// A binary heap jumps to and fro in memory: the last face of a bucket is next to the one before, there too. The buckets are lists in one place, so that a queue for a few faces costs
/// little.
pub(super) struct Queue {
    /// A bit for every bucket that holds something.
    filled: [u64; BUCKETS / 64],
    /// The first entry of each bucket.
    first: [u32; BUCKETS],
    entries: Vec<Queued>,
    /// The first of the entries that hold nothing.
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
    /// How far it is from what is wanted, as a part of that.
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

/// The bits of positive floats are in the order of the floats.
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
        // One that goes in between, into the place of one that went out.
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
