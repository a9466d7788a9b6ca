//! The notes of one file: each once, and what is said of many things alike in one line.

use std::collections::{HashMap, HashSet};

use super::Note;

/// What a note says of one of many things.
struct Subject<'a> {
    /// Such as `mesh "a"`, as the text has it.
    shown: String,
    /// One of them, and several.
    nouns: (&'static str, &'static str),
    name: &'a mut String,
    /// How much of it there is, in the notes that say it.
    count: Option<&'a mut usize>,
}

impl Note {
    /// What it is about, where it may as well be about others of the same file.
    fn subject(&mut self) -> Option<Subject<'_>> {
        const NODES: (&str, &str) = ("node", "nodes");
        const MATERIALS: (&str, &str) = ("material", "materials");
        const IMAGES: (&str, &str) = ("image", "images");
        const PARTS: (&str, &str) = ("part", "parts");
        let (shown, nouns, name, count) = match self {
            Self::Hidden { node } | Self::Flat { node } | Self::Skin { node } => {
                (format!("node {node:?}"), NODES, node, None)
            }
            Self::PointsAndLines { place, count } if place.starts_with("node ") => {
                (place.clone(), NODES, place, Some(count))
            }
            Self::NoPositions { place } | Self::Empty { place } => {
                (place.clone(), mesh_or_part(place), place, None)
            }
            Self::LeftOver { place, count } => {
                (place.clone(), mesh_or_part(place), place, Some(count))
            }
            Self::Attributes { mesh, .. }
            | Self::Morph { mesh, .. }
            | Self::Unplaced { mesh, .. } => (mesh.clone(), mesh_or_part(mesh), mesh, None),
            Self::ColorsClamped { mesh, count }
            | Self::NoWeights { mesh, count }
            | Self::Weights { mesh, count }
            | Self::FacetNormals { mesh, count }
            | Self::Normals { mesh, count } => {
                (mesh.clone(), mesh_or_part(mesh), mesh, Some(count))
            }
            Self::TextureCoordinates { part, count } => {
                (format!("part {part:?}"), PARTS, part, Some(count))
            }
            Self::Material { material, .. } | Self::BumpAsNormals { material } => {
                (format!("material {material:?}"), MATERIALS, material, None)
            }
            Self::UnknownMaterial { name } => (format!("material {name:?}"), MATERIALS, name, None),
            Self::FactorClamped { place, .. } => (place.clone(), MATERIALS, place, None),
            Self::Image { image, .. }
            | Self::ImageConverted { image, .. }
            | Self::ImageScaled { image } => (format!("image {image}"), IMAGES, image, None),
            _ => return None,
        };
        Some(Subject {
            shown,
            nouns,
            name,
            count,
        })
    }
}

/// What such a place is: `mesh "a"`, `part "a"`, `meshes[2].primitives[0]`.
fn mesh_or_part(place: &str) -> (&'static str, &'static str) {
    match place {
        _ if place.starts_with("part ") => ("part", "parts"),
        _ if place.contains(".primitives[") => ("primitive", "primitives"),
        _ => ("mesh", "meshes"),
    }
}

/// Notes of one file as lines, in their order: what is said of several meshes, nodes, materials or images alike is said
/// once, with how many there are.
pub(super) fn lines(notes: &[Note]) -> Vec<String> {
    struct Line {
        /// The first note of its kind, with the counts of all.
        note: Note,
        alike: usize,
    }
    let mut lines: Vec<Line> = vec![];
    let mut known: HashMap<String, usize> = HashMap::new();
    for note in notes {
        let mut kind = note.clone();
        let mut more = 0;
        if let Some(subject) = kind.subject() {
            // Of each kind of place a line of its own.
            *subject.name = subject.nouns.0.to_owned();
            more = subject.count.map_or(0, std::mem::take);
        }
        let line = *known.entry(format!("{kind:?}")).or_insert(lines.len());
        if line == lines.len() {
            let note = note.clone();
            lines.push(Line { note, alike: 1 });
            continue;
        }
        let line = &mut lines[line];
        line.alike += 1;
        if let Some(count) = line.note.subject().and_then(|subject| subject.count) {
            *count += more;
        }
    }
    let text = |Line { mut note, alike }: Line| {
        let text = note.to_string();
        let subject = note.subject().filter(|_| alike > 1);
        let Some(Subject { shown, nouns, .. }) = subject else {
            return text;
        };
        match text.strip_prefix(&shown) {
            Some(rest) if rest.starts_with(':') => {
                format!("{alike} {}, the first {shown}{rest}", nouns.1)
            }
            _ => {
                let nouns = if alike == 2 { nouns.0 } else { nouns.1 };
                format!("{text}, and so {} more {nouns}", alike - 1)
            }
        }
    };
    lines.into_iter().map(text).collect()
}

/// Among so many of the last notes [`add_note`] looks for the one to be added.
const RECENT: usize = 64;

/// Adds a note unless it has been made lately: one mesh may be drawn many times. [`unique`] takes out the rest.
pub(super) fn add_note(notes: &mut Vec<Note>, note: Note) {
    if !notes.iter().rev().take(RECENT).any(|known| *known == note) {
        notes.push(note);
    }
}

/// Each note once, in the order in which they were made.
pub(super) fn unique(mut notes: Vec<Note>) -> Vec<Note> {
    let mut known = HashSet::new();
    notes.retain(|note| known.insert(format!("{note:?}")));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_one_line_and_made_once() {
        let note = Note::PointsAndLines {
            place: "node \"grid\"".into(),
            count: 2,
        };
        let mut notes = vec![];
        add_note(&mut notes, note.clone());
        add_note(&mut notes, note);
        assert_eq!(notes.len(), 1);
        assert_eq!(
            notes[0].to_string(),
            "node \"grid\": 2 primitives of points or lines skipped"
        );
    }

    #[test]
    fn what_is_said_of_many_is_said_once() {
        let mesh = |index: usize| format!("mesh \"m{index}\"");
        let attributes = |index, name: &str| Note::Attributes {
            mesh: mesh(index),
            names: vec![name.to_owned()],
        };
        let clamped = |index, count| Note::ColorsClamped {
            mesh: mesh(index),
            count,
        };
        let hidden = |node: &str| Note::Hidden { node: node.into() };
        let empty = |place: &str| Note::Empty {
            place: place.into(),
        };
        let notes = [
            attributes(0, "_A"),
            clamped(0, 2),
            hidden("a"),
            attributes(1, "_A"),
            attributes(1, "_B"),
            hidden("b: c"),
            clamped(2, 3),
            attributes(2, "_A"),
            hidden("d"),
            empty("meshes[3].primitives[0]"),
            empty("meshes[4]"),
        ];
        assert_eq!(
            lines(&notes),
            [
                "3 meshes, the first mesh \"m0\": _A not copied",
                "2 meshes, the first mesh \"m0\": 5 colours outside 0 to 1 clamped",
                "node \"a\" is not visible: skipped, and so 2 more nodes",
                "mesh \"m1\": _B not copied",
                "meshes[3].primitives[0]: has no triangles, skipped",
                "meshes[4]: has no triangles, skipped",
            ]
        );
        let alone: Vec<String> = notes[..3].iter().map(Note::to_string).collect();
        assert_eq!(lines(&notes[..3]), alone);
    }

    /// Each note is compared with a few others alone, or 20,000 hidden nodes would take minutes.
    #[test]
    fn a_note_made_long_ago_is_not_made_again() {
        let hidden = |number: usize| Note::Hidden {
            node: number.to_string(),
        };
        let mut notes = vec![];
        for number in (0..1000).chain(0..1000) {
            add_note(&mut notes, hidden(number));
        }
        let all: Vec<Note> = (0..1000).map(hidden).collect();
        assert_eq!(unique(notes), all);
    }
}
