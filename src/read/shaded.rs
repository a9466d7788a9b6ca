//! The normals of a model that was read, as the user asks for them.

use super::note::Note;
use super::{Findings, ReadError};
use crate::material::{Model, Normals};

/// Flat facets that cost fewer bytes than this in a file are not worth a note.
const WORTH_A_NOTE: u64 = 1_000_000;

/// A model with the normals that are asked for. Where parts without normals stay flat, which costs much room in a file,
/// the findings get a note.
///
/// # Errors
///
/// More corners than a `u32` index can tell apart.
pub fn with_normals(
    (model, mut findings): (Model, Findings),
    normals: Normals,
) -> Result<(Model, Findings), ReadError> {
    let [flat, smooth, none] = model.bytes_for_want_of_normals();
    if normals == Normals::Source && flat.saturating_sub(none) >= WORTH_A_NOTE {
        findings
            .notes
            .push(Note::FlatForWantOfNormals { flat, smooth, none });
    }
    let model = model.with_normals(normals);
    let model = model.map_err(|problem| ReadError::Mesh {
        place: format!("normals {normals}"),
        problem,
    })?;
    Ok((model, findings))
}
