//! The chunks of a GLB: a header, the JSON, and the data, which is there before the JSON is known.
//!
//! In a file the data goes to its final place at once: room is left for the JSON in front of it, and what the JSON does
//! not take of that is filled with the spaces that a JSON chunk may end in. Where the JSON outgrows its room the data
//! moves.
//!
//! Source: Khronos, glTF 2.0 specification, section 4.4 (GLB file format).

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

use crate::write::WriteError;
use crate::write::text::LongText;

/// The header and that of the JSON.
const BEFORE_JSON: u64 = 12 + 8;
const BEFORE_DATA: u64 = 8;

/// Data that is written at a time.
const BUFFER: usize = 1 << 18;

/// The JSON of a file, in pieces.
pub(super) struct Json(pub(super) Vec<LongText>);

impl Json {
    fn len(&self) -> u64 {
        self.0.iter().map(LongText::len).sum()
    }

    pub(super) fn write_to(self, out: &mut dyn Write) -> io::Result<()> {
        self.0.into_iter().try_for_each(|text| text.write_to(out))
    }
}

/// Writes everything in front of `bytes` bytes of data; the chunk of the JSON has `room`.
///
/// # Errors
///
/// More than 4 GiB, or the writer fails.
pub(super) fn write_front(
    out: &mut dyn Write,
    json: Json,
    room: u64,
    bytes: u64,
) -> Result<(), WriteError> {
    let padded = bytes.next_multiple_of(4);
    let all = BEFORE_JSON + room + BEFORE_DATA + padded;
    check_size(all)?;
    let [magic, json_kind, data_kind] = [*b"glTF", *b"JSON", *b"BIN\0"].map(u32::from_le_bytes);
    for word in [magic, 2, all as u32, room as u32, json_kind] {
        out.write_all(&word.to_le_bytes())?;
    }
    let spaces = room - json.len();
    json.write_to(out)?;
    io::copy(&mut io::repeat(b' ').take(spaces), out)?;
    for word in [padded as u32, data_kind] {
        out.write_all(&word.to_le_bytes())?;
    }
    Ok(())
}

/// Whether a GLB can be as large.
///
/// # Errors
///
/// More than 4 GiB.
pub(super) fn check_size(bytes: u64) -> Result<(), WriteError> {
    let limit = u64::from(u32::MAX);
    if bytes > limit {
        return Err(WriteError::TooLarge {
            format: "GLB",
            bytes,
            limit,
        });
    }
    Ok(())
}

/// The room that a JSON takes by itself.
pub(super) fn min_room(json: &Json) -> u64 {
    json.len().next_multiple_of(4)
}

/// What the data ends in.
pub(super) fn padding(bytes: u64) -> &'static [u8] {
    &[0; 4][..(bytes.next_multiple_of(4) - bytes) as usize]
}

/// How much room is left for the JSON.
#[derive(Clone, Copy, Debug)]
struct Reserve {
    /// While there is no more data than this it waits in memory, and the JSON gets what it takes.
    held: usize,
    /// For what is there once: the scene, materials.
    once: u64,
    /// For each mesh, where none has been described yet. Most take about two thirds of this.
    for_each: u64,
}

const RESERVE: Reserve = Reserve {
    held: 1 << 22,
    once: 1 << 16,
    for_each: 1 << 12,
};

/// How much more room is left for the JSON than that of meshes like those before would take: numbers get longer.
const ROOM_TO_GROW: f64 = 1.125;

/// A GLB in a file, in the making.
pub(super) struct InPlace<'a> {
    file: &'a mut File,
    /// Meshes that there will be.
    expected: usize,
    /// Those that there are, and how much JSON about them.
    described: (usize, u64),
    reserve: Reserve,
    /// Data that is not in the file yet.
    held: Vec<u8>,
    /// For the JSON; `None` as long as all data is held.
    room: Option<u64>,
}

/// No more room than this is left for the JSON of meshes, however many are expected: half of all that a GLB can have.
const MAX_ROOM: f64 = (1_u64 << 31) as f64;

impl<'a> InPlace<'a> {
    pub(super) fn new(file: &'a mut File, expected: usize) -> Self {
        Self {
            file,
            expected,
            described: (0, 0),
            reserve: RESERVE,
            held: vec![],
            room: None,
        }
    }

    /// What the JSON has come to.
    pub(super) fn describe(&mut self, meshes: usize, bytes: u64) {
        self.described = (meshes, bytes);
    }

    fn expected_json(&self) -> u64 {
        let for_each = match self.described {
            (0, _) => self.reserve.for_each as f64,
            (meshes, bytes) => ROOM_TO_GROW * bytes as f64 / meshes as f64,
        };
        let of_all = (for_each * self.expected as f64).min(MAX_ROOM);
        self.reserve.once + of_all as u64
    }

    /// Puts everything in front of the data, of which there are so many bytes.
    ///
    /// # Errors
    ///
    /// More than 4 GiB, or the file cannot be read or written.
    pub(super) fn finish(mut self, json: Json, bytes: u64) -> Result<(), WriteError> {
        let taken = min_room(&json);
        self.write_all(padding(bytes))?;
        if let Some(room) = self.room {
            self.file.write_all(&self.held)?;
            self.held.clear();
            if taken > room {
                let length = bytes.next_multiple_of(4);
                move_up(
                    self.file,
                    BEFORE_JSON + room + BEFORE_DATA,
                    length,
                    taken - room,
                )?;
            }
        }
        self.file.rewind()?;
        let mut out = BufWriter::with_capacity(BUFFER, self.file);
        write_front(&mut out, json, taken.max(self.room.unwrap_or(0)), bytes)?;
        out.write_all(&self.held)?;
        Ok(out.flush()?)
    }
}

impl Write for InPlace<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let most = if self.room.is_some() {
            BUFFER
        } else {
            self.reserve.held
        };
        // What is large need not wait once it is known where it goes.
        let waits = self.room.is_none() || bytes.len() < BUFFER / 2;
        if waits && self.held.len() + bytes.len() <= most {
            self.held.extend_from_slice(bytes);
            return Ok(bytes.len());
        }
        if self.room.is_none() {
            let room = self.expected_json().next_multiple_of(4);
            let place = BEFORE_JSON + room + BEFORE_DATA;
            self.file.seek(SeekFrom::Start(place))?;
            self.room = Some(room);
        }
        self.file.write_all(&self.held)?;
        self.held.clear();
        self.held.shrink_to(BUFFER);
        if bytes.len() < BUFFER / 2 {
            self.held.extend_from_slice(bytes);
        } else {
            self.file.write_all(bytes)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Moves `length` bytes from `place` towards the end of the file, the last first.
fn move_up(file: &mut File, place: u64, length: u64, by: u64) -> io::Result<()> {
    let mut piece = vec![0; BUFFER];
    let mut left = length;
    while left > 0 {
        let bytes = &mut piece[..left.min(BUFFER as u64) as usize];
        left -= bytes.len() as u64;
        file.seek(SeekFrom::Start(place + left))?;
        file.read_exact(bytes)?;
        file.seek(SeekFrom::Start(place + left + by))?;
        file.write_all(bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn json(length: usize) -> Json {
        let text = format!("{{\"{}\":0}}", "a".repeat(length - 6));
        let (first, rest) = text.as_bytes().split_at(length / 2);
        Json(vec![first.to_vec().into(), rest.to_vec().into()])
    }

    fn written(data: &[u8], reserve: Reserve, described: (usize, u64)) -> Vec<u8> {
        let mut file = tempfile::tempfile().unwrap();
        let mut place = InPlace::new(&mut file, 10);
        place.reserve = reserve;
        for piece in data.chunks(100_001) {
            place.describe(described.0, described.1);
            place.write_all(piece).unwrap();
        }
        place.finish(json(3001), data.len() as u64).unwrap();
        let mut bytes = vec![];
        file.rewind().unwrap();
        file.read_to_end(&mut bytes).unwrap();
        bytes
    }

    /// The lengths that are said are those that are there; the JSON without the spaces behind it, and the data.
    fn chunks(glb: &[u8]) -> (&[u8], &[u8]) {
        let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&glb[..4], word(4), word(8)), (&b"glTF"[..], 2, glb.len()));
        let (room, kind) = (word(12), &glb[16..20]);
        assert_eq!((room % 4, kind), (0, &b"JSON"[..]));
        let (length, kind) = (word(20 + room), &glb[24 + room..28 + room]);
        assert_eq!((length, kind), (glb.len() - 28 - room, &b"BIN\0"[..]));
        (glb[20..20 + room].trim_ascii_end(), &glb[28 + room..])
    }

    #[test]
    fn a_file_is_the_same_but_for_spaces_whatever_room_there_was_for_its_json() {
        let data: Vec<u8> = (0..1_000_001u32).map(|i| (i % 251) as u8).collect();
        let plain = written(&data, RESERVE, (0, 0));
        let (json, all) = chunks(&plain);
        assert_eq!((json.len(), 20 + 3004), (3001, plain.len() - 8 - all.len()));
        assert_eq!(
            (&all[..data.len()], &all[data.len()..]),
            (&data[..], &[0; 3][..])
        );
        for (once, described, room) in [
            // As much as it takes, more, less, next to nothing; as those before took, with room to grow.
            (3004, (0, 0), 3004),
            (50_000, (0, 0), 50_000),
            (1000, (0, 0), 3004),
            (0, (0, 0), 3004),
            (1004, (2, 800), 1004 + 4500),
            (0, (4, 800), 3004),
        ] {
            for held in [0, 1000, 500_000] {
                let reserve = Reserve {
                    held,
                    once,
                    for_each: 0,
                };
                let glb = written(&data, reserve, described);
                assert!(chunks(&glb) == (json, all), "{once} {described:?} {held}");
                assert_eq!(glb.len(), plain.len() - 3004 + room);
            }
        }
    }

    #[test]
    fn more_than_a_glb_can_hold_is_refused() {
        let limit = u64::from(u32::MAX) - BEFORE_JSON - BEFORE_DATA - 20;
        assert!(write_front(&mut vec![], json(20), 20, limit - 3).is_ok());
        let refused = write_front(&mut vec![], json(20), 20, limit - 2);
        assert!(
            matches!(refused, Err(WriteError::TooLarge { .. })),
            "{refused:?}"
        );
    }
}
