//! Numbers of a mesh as the bytes of a file, a piece at a time: they never stand in memory as a whole.

use std::io::{self, Write};
use std::ops::Range;
use std::sync::mpsc::sync_channel;
use std::thread;

use crate::mesh::VERTICES_AT_ONCE;

/// Bytes that are converted at a time: they stay in the cache of a core until they are written.
const PIECE: usize = 1 << 18;

/// More threads than this make more than can be written.
const MAX_MAKERS: usize = 4;

/// What is shorter is converted and written on one thread: beginning another takes as long.
const WORTH_A_THREAD: usize = 4 * PIECE;

/// Pieces begin at multiples of so many items.
const ITEMS_AT_ONCE: usize = VERTICES_AT_ONCE;

/// Writes `count` items of so many four-byte words each, made by `convert` from their numbers; while some are written
/// the next are made.
///
/// # Errors
///
/// The writer fails.
pub(super) fn write_items<const WORDS: usize>(
    out: &mut impl Write,
    count: usize,
    convert: impl Fn(usize) -> [[u8; 4]; WORDS] + Sync,
) -> io::Result<()> {
    write_pieces(out, count, |first, items: &mut [[[u8; 4]; WORDS]]| {
        for (index, item) in (first..).zip(items) {
            *item = convert(index);
        }
    })
}

/// As [`write_items`], for items that `make` makes some at a time, from a multiple of [`ITEMS_AT_ONCE`] on.
///
/// # Errors
///
/// The writer fails.
pub(super) fn write_pieces<const WORDS: usize>(
    out: &mut impl Write,
    count: usize,
    make: impl Fn(usize, &mut [[[u8; 4]; WORDS]]) + Sync,
) -> io::Result<()> {
    let size = 4 * WORDS;
    let per_piece = (PIECE / size).next_multiple_of(ITEMS_AT_ONCE);
    let pieces = |from: usize, each: usize| {
        let firsts = (from * per_piece..count).step_by(each * per_piece);
        firsts.map(move |first| first..count.min(first + per_piece))
    };
    let make = |piece: Range<usize>, bytes: &mut Vec<u8>| {
        bytes.resize(piece.len() * size, 0);
        let (words, _) = bytes.as_chunks_mut();
        let (items, _) = words.as_chunks_mut();
        make(piece.start, items);
    };
    if count * size < WORTH_A_THREAD {
        let mut bytes = vec![];
        return pieces(0, 1).try_for_each(|piece| {
            make(piece, &mut bytes);
            out.write_all(&bytes)
        });
    }
    let makers = rayon::current_num_threads().clamp(1, MAX_MAKERS);
    thread::scope(|scope| {
        // Each maker makes every so many-th piece; two pieces of each go round: one is made while the other is written.
        let ends = (0..makers).map(|maker| {
            let (full, made) = sync_channel(1);
            let (written, empty) = sync_channel(2);
            for _ in 0..2 {
                written.send(vec![]).expect("there is room for both");
            }
            let (pieces, make) = (pieces(maker, makers), &make);
            scope.spawn(move || {
                for piece in pieces {
                    // Either fails when the writer did, and nobody waits any more.
                    let Ok(mut bytes) = empty.recv() else { return };
                    make(piece, &mut bytes);
                    if full.send(bytes).is_err() {
                        return;
                    }
                }
            });
            (made, written)
        });
        let ends: Vec<_> = ends.collect();
        for (made, written) in ends.iter().cycle() {
            // The maker of the piece that would come next has ended: there is none.
            let Ok(bytes) = made.recv() else {
                return Ok(());
            };
            out.write_all(&bytes)?;
            // When all are made nobody waits for another.
            let _ = written.send(bytes);
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_items_come_out_in_order_with_and_without_a_thread() {
        for count in [0, 1, PIECE / 4, PIECE, 2 * PIECE + 3] {
            let mut bytes = vec![];
            let convert = |index| [(index as u32).to_le_bytes()];
            write_items(&mut bytes, count, convert).unwrap();
            let (items, rest) = bytes.as_chunks();
            assert!(rest.is_empty());
            assert_eq!(items.len(), count);
            for (index, item) in items.iter().enumerate() {
                assert_eq!(u32::from_le_bytes(*item) as usize, index);
            }
        }
    }

    #[test]
    fn a_writer_that_fails_ends_it() {
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                self.0 = self
                    .0
                    .checked_sub(bytes.len())
                    .ok_or(io::ErrorKind::StorageFull)?;
                Ok(bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        for (count, room) in [(100, 10), (PIECE, 0), (PIECE, 3 * PIECE)] {
            let convert = |_| [[1; 4], [2; 4]];
            let failed = write_items(&mut Full(room), count, convert).unwrap_err();
            assert_eq!(failed.kind(), io::ErrorKind::StorageFull);
        }
    }
}
