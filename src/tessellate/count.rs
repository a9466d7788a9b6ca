//! A count that may not exceed a limit.

use std::sync::atomic::{AtomicU64, Ordering};

/// A count to which many threads add and which must not exceed a limit.
///
/// Whether the sum exceeds the limit does not depend on the number of threads; which thread notices it first does.
pub(super) struct Count {
    sum: AtomicU64,
    most: u64,
}

impl Count {
    pub(super) fn up_to(most: u64) -> Self {
        Self {
            sum: AtomicU64::new(0),
            most,
        }
    }

    /// The remainder up to the limit.
    pub(super) fn left(&self) -> u64 {
        self.most.saturating_sub(self.sum.load(Ordering::Relaxed))
    }

    /// Adds to the count; whether the sum is within the limit.
    #[must_use]
    pub(super) fn add(&self, count: u64) -> bool {
        let before = self.sum.fetch_add(count, Ordering::Relaxed);
        before.saturating_add(count) <= self.most
    }
}
