//! Elements at even distances in a run of bytes, taken up by several threads a piece at a time.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::ReadError;
use super::bytes::Bytes;
use crate::mesh::flattened;

/// Elements that a thread takes at a time: enough to outweigh a read, and still at hand when they are decoded.
const JOB: usize = 1024;
/// The same of elements that are only copied.
const JOB_OF_WORDS: usize = 4096;

/// Where the elements are; all of them are there.
pub(super) struct Run<'a> {
    pub(super) bytes: Bytes<'a>,
    /// The first byte of the first element.
    pub(super) start: usize,
    /// Bytes from one element to the next.
    pub(super) stride: usize,
    /// Bytes of an element.
    pub(super) size: usize,
    pub(super) count: usize,
}

impl Run<'_> {
    /// What `make` makes of the bytes of each element.
    pub(super) fn map<T>(&self, make: impl Fn(&[u8]) -> T + Sync) -> Result<Vec<T>, ReadError>
    where
        T: Copy + Default + Send,
    {
        if self.count == 0 {
            // Then the distances may be anything.
            return Ok(vec![]);
        }
        if self.count <= JOB {
            let mut buffer = vec![];
            let elements = self.elements(0, JOB, &mut buffer)?;
            return Ok(elements.map(make).collect());
        }
        let failure = OnceLock::new();
        let jobs = (0..self.count.div_ceil(JOB)).into_par_iter();
        // Arrays have a known place in the result, so that nothing has to be put together afterwards.
        let pieces = jobs.map_init(Vec::new, |buffer, job| {
            let mut piece = [T::default(); JOB];
            match self.elements(job * JOB, JOB, buffer) {
                Ok(elements) => {
                    for (value, element) in piece.iter_mut().zip(elements) {
                        *value = make(element);
                    }
                }
                // Any of them will do.
                Err(error) => drop(failure.set(error)),
            }
            piece
        });
        let values = flattened(pieces.collect(), self.count);
        failure.into_inner().map_or(Ok(values), Err)
    }

    /// What `make` makes of each element, which is so many words, and whether `is_sound` holds for all of them.
    pub(super) fn words<T, const WORDS: usize>(
        &self,
        make: impl Fn([u8; 4]) -> T + Sync,
        is_sound: impl Fn([T; WORDS]) -> bool + Sync,
    ) -> Result<(Vec<[T; WORDS]>, bool), ReadError>
    where
        T: Copy + Default + Send,
    {
        debug_assert_eq!(self.size, 4 * WORDS);
        let put = |value: &mut [T; WORDS], words: &[[u8; 4]; WORDS]| {
            *value = words.map(&make);
            is_sound(*value)
        };
        let fill = |values: &mut [[T; WORDS]], job: usize, buffer: &mut Vec<u8>| {
            if self.count == 0 {
                return Ok(true);
            }
            let first = job * JOB_OF_WORDS;
            let mut are_sound = true;
            if self.stride == self.size {
                let (words, _) = self.bytes_of(first, JOB_OF_WORDS, buffer)?.as_chunks();
                let (elements, _) = words.as_chunks();
                for (value, words) in values.iter_mut().zip(elements) {
                    are_sound &= put(value, words);
                }
                return Ok(are_sound);
            }
            for (value, bytes) in
                values
                    .iter_mut()
                    .zip(self.elements(first, JOB_OF_WORDS, buffer)?)
            {
                let (words, _) = bytes.as_chunks();
                let (elements, _) = words.as_chunks();
                are_sound &= put(value, &elements[0]);
            }
            Ok(are_sound)
        };
        // Zeros come with the memory of them, which then is filled where it is.
        let mut values = vec![[T::default(); WORDS]; self.count];
        if self.count <= JOB_OF_WORDS {
            let are_sound = fill(&mut values, 0, &mut vec![])?;
            return Ok((values, are_sound));
        }
        let jobs = values.par_chunks_mut(JOB_OF_WORDS).enumerate();
        let filled = jobs.map_init(Vec::new, |buffer, (job, values)| fill(values, job, buffer));
        // Of several errors any will do.
        let are_sound = filled.try_reduce(|| true, |one, other| Ok(one & other))?;
        Ok((values, are_sound))
    }

    /// The bytes of each of the elements from number `first` on, `most` at most.
    fn elements<'b>(
        &'b self,
        first: usize,
        most: usize,
        buffer: &'b mut Vec<u8>,
    ) -> Result<impl Iterator<Item = &'b [u8]>, ReadError> {
        let elements = self.bytes_of(first, most, buffer)?.chunks(self.stride);
        Ok(elements.map(|element| &element[..self.size]))
    }

    /// The bytes from the first to the last of these.
    fn bytes_of<'b>(
        &'b self,
        first: usize,
        most: usize,
        buffer: &'b mut Vec<u8>,
    ) -> Result<&'b [u8], ReadError> {
        let count = most.min(self.count - first);
        let start = self.start + first * self.stride;
        let end = start + (count - 1) * self.stride + self.size;
        self.bytes.part(start..end, buffer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_found_at_any_distance_and_in_any_number() {
        let all: Vec<u8> = (0..20_000u32).flat_map(u32::to_le_bytes).collect();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), &all).unwrap();
        for (start, stride, size) in [(0, 4, 4), (8, 12, 4), (4, 12, 8), (4, 4, 1)] {
            for count in [0, 1, JOB - 1, JOB, JOB + 1, 3 * JOB, 6000] {
                for bytes in [
                    Bytes::Held(all.as_slice().into()),
                    Bytes::open(file.path(), u64::MAX).unwrap(),
                ] {
                    let run = Run {
                        bytes,
                        start,
                        stride,
                        size,
                        count,
                    };
                    let mut expected = vec![];
                    for element in 0..count {
                        let first = start + element * stride;
                        expected.push((all[first], all[first + size - 1]));
                    }
                    let found = run.map(|bytes| (bytes[0], bytes[size - 1])).unwrap();
                    assert!(found == expected, "{start} {stride} {size} {count}");
                }
            }
        }
    }

    #[test]
    fn a_file_cut_short_while_it_is_read_is_an_error() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), vec![1; 100_000]).unwrap();
        let bytes = Bytes::open(file.path(), u64::MAX).unwrap();
        file.as_file().set_len(60_000).unwrap();
        let run = Run {
            bytes,
            start: 0,
            stride: 10,
            size: 10,
            count: 10_000,
        };
        let error = run.map(|bytes| bytes[0]).unwrap_err();
        assert!(matches!(error, ReadError::File { path, .. } if path == file.path()));
    }
}
