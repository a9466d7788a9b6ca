//! A caller of a job that counts its pieces and may end it.

use std::sync::atomic::{AtomicUsize, Ordering};

use photosurface::{Cancelled, Progress};

/// Hears how many pieces there are and how many are done, and ends the job as soon as `end` are.
pub(crate) struct Pieces {
    begun: AtomicUsize,
    done: AtomicUsize,
    end: usize,
}

impl Pieces {
    pub(crate) fn until(end: usize) -> Self {
        Self {
            begun: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            end,
        }
    }

    pub(crate) fn begun_and_done(&self) -> (usize, usize) {
        let read = |number: &AtomicUsize| number.load(Ordering::SeqCst);
        (read(&self.begun), read(&self.done))
    }
}

impl Progress for Pieces {
    fn begin(&self, pieces: usize) {
        let before = self.begun.swap(pieces, Ordering::SeqCst);
        assert_eq!(before, 0, "a job begins once");
    }

    fn advance(&self, pieces: usize) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(pieces, Ordering::SeqCst) + pieces;
        if done < self.end {
            Ok(())
        } else {
            Err(Cancelled)
        }
    }
}
