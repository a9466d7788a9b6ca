//! A binary STL file: a header, how many facets there are, 50 bytes for each facet.

use glam::DVec3;

use super::solid::Solid;
use crate::read::note::{Note, plural};
use crate::read::{DataProblem, ReadError};

/// Bytes of the header, in which some programs write their name.
const HEADER: usize = 80;
/// Bytes before the first facet.
const START: usize = HEADER + 4;
/// Bytes of a facet: a normal and three corners of three numbers each, and two bytes more.
const FACET: usize = 50;

/// How many facets a file declares; `None` if it is too short for a header.
fn declared(start: &[u8]) -> Option<u64> {
    let count = start.get(HEADER..START)?;
    let count: [u8; 4] = count.try_into().ok()?;
    Some(u32::from_le_bytes(count).into())
}

/// Whether a file of so many bytes that starts so is exactly as long as it declares.
pub(super) fn is_exactly_binary(start: &[u8], length: usize) -> bool {
    declared(start).is_some_and(|count| START as u64 + count * FACET as u64 == length as u64)
}

pub(super) fn read_binary(bytes: &[u8], notes: &mut Vec<Note>) -> Result<Vec<Solid>, ReadError> {
    let cut_off = |count: u64, needed: usize| {
        ReadError::Data(DataProblem::CutOff {
            count,
            element: "facet".into(),
            needed: u128::from(count) * FACET as u128 + needed as u128,
            left: bytes.len(),
        })
    };
    let count = declared(bytes).ok_or_else(|| cut_off(0, START))?;
    let (facets, rest) = usize::try_from(count)
        .ok()
        .and_then(|count| bytes[START..].split_at_checked(count.checked_mul(FACET)?))
        .ok_or_else(|| cut_off(count, START))?;
    let mut solid = Solid::default();
    let mut painted = 0;
    for (index, facet) in (0..).zip(facets.chunks_exact(FACET)) {
        let number = |i: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|byte| facet[4 * i + byte]);
            f64::from(f32::from_le_bytes([a, b, c, d]))
        };
        let [normal, corners @ ..] =
            [0, 3, 6, 9].map(|i| DVec3::new(number(i), number(i + 1), number(i + 2)));
        if let Some(corner) = corners.iter().find(|corner| !corner.is_finite()) {
            return Err(ReadError::Element {
                element: "facet".into(),
                index,
                problem: DataProblem::NotFinite {
                    property: "a corner".into(),
                    found: corner.to_string(),
                },
            });
        }
        solid.add(normal, &corners);
        painted += usize::from(facet[FACET - 2..] != [0, 0]);
    }
    if painted > 0 {
        let facets = plural(painted, "facet");
        let what = format!("the two spare bytes of {facets}, which some programs use for colours");
        notes.push(Note::NotCarried { what });
    }
    if !rest.is_empty() {
        let what = format!("{} behind the last facet", plural(rest.len(), "byte"));
        notes.push(Note::NotCarried { what });
    }
    Ok(vec![solid])
}
