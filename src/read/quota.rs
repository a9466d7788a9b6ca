//! How much may be made of a file in all: copies, zeros without data and data that is named again and again would
//! else make gigabytes of a kilobyte.

use std::cell::Cell;

use super::AccessorProblem;

/// So much may be made of any file, however small: copies of meshes that take 800 MB.
const MIN: u64 = 1 << 25;
/// So many zeros, which no exporter writes many of.
const MIN_ZEROS: u64 = 1 << 24;
/// So much of each byte of a larger one. What is stored once takes at most one for each byte, and meshes whose hundred
/// materials share all vertices about this.
const FOR_EACH_BYTE: u64 = 16;

/// Counts vectors, indices and letters, or zeros: what memory is taken for.
pub(super) struct Quota {
    limit: u64,
    taken: Cell<u64>,
}

impl Quota {
    /// That of a file with so many bytes, those of its buffers among them.
    pub(super) fn of(bytes: u64) -> Self {
        Self::at_least(MIN, bytes)
    }

    /// That of the zeros in accessors without data.
    pub(super) fn of_zeros(bytes: u64) -> Self {
        Self::at_least(MIN_ZEROS, bytes)
    }

    fn at_least(least: u64, bytes: u64) -> Self {
        Self {
            limit: least.max(bytes.saturating_mul(FOR_EACH_BYTE)),
            taken: Cell::new(0),
        }
    }

    /// Takes so much, before memory is taken for it.
    ///
    /// # Errors
    ///
    /// More than is left.
    pub(super) fn take(&self, more: u64) -> Result<(), AccessorProblem> {
        let (found, limit) = (self.taken.get().saturating_add(more), self.limit);
        if found > limit {
            return Err(AccessorProblem::TooMuch { found, limit });
        }
        self.taken.set(found);
        Ok(())
    }
}
