//! An STL file of text: statements, one to a line.

use glam::DVec3;

use super::solid::Solid;
use crate::read::text::{as_bytes_of_ascii, lines, number, shown, split_statement, without_mark};
use crate::read::{DataProblem, ReadError};

/// The first word of a text.
const SOLID: &[u8] = b"solid";

const EXPECTED: &str = "solid, facet, outer loop, vertex, endloop, endfacet or endsolid";

/// Whether a file starts as a text of STL does: with a word, and without bytes that no text has.
pub(super) fn is_text(start: &[u8]) -> bool {
    let start = &start[..start.len().min(512)];
    let text = as_bytes_of_ascii(without_mark(start));
    let text = without_mark(&text).trim_ascii_start();
    let first = text.get(..SOLID.len());
    let is_solid = first.is_some_and(|first| first.eq_ignore_ascii_case(SOLID));
    let is_word = text.get(SOLID.len()).is_none_or(u8::is_ascii_whitespace);
    let is_of_text = |&byte: &u8| byte >= b' ' || byte.is_ascii_whitespace() || byte == 0x0b;
    is_solid && is_word && text.iter().all(is_of_text)
}

/// A facet of which the end was not read yet.
#[derive(Default)]
struct Facet {
    normal: DVec3,
    corners: Vec<DVec3>,
}

pub(super) fn read_text(bytes: &[u8]) -> Result<Vec<Solid>, ReadError> {
    let bytes = as_bytes_of_ascii(bytes);
    let mut solids: Vec<Solid> = vec![];
    let mut facet: Option<Facet> = None;
    let mut last = 1;
    for (line, text) in (1..).zip(lines(&bytes)) {
        let (statement, rest) = split_statement(text);
        if statement.is_empty() || statement.starts_with(b"#") {
            continue;
        }
        last = line;
        let statement = statement.to_ascii_lowercase();
        let wrong = |problem| ReadError::Line { line, problem };
        let out_of_place = |expected| wrong(DataProblem::word(&statement, expected));
        match (&statement[..], &mut facet) {
            (b"solid", None) => solids.push(Solid::named(rest)),
            (b"facet", None) if !solids.is_empty() => {
                facet = Some(Facet {
                    normal: normal(rest),
                    corners: vec![],
                });
            }
            (b"vertex", Some(facet)) => facet.corners.push(vector(rest).map_err(wrong)?),
            // Which statement belongs where is told by those with numbers.
            (b"outer" | b"endloop", Some(_)) => {}
            (b"endfacet", Some(read)) => {
                let found = read.corners.len();
                if found < 3 {
                    let expected = "three corners or more, of three numbers each".into();
                    let found = 3 * found;
                    return Err(wrong(DataProblem::Count { found, expected }));
                }
                if let Some(solid) = solids.last_mut() {
                    solid.add(read.normal, &read.corners);
                }
                facet = None;
            }
            (b"endsolid", None) => {}
            (_, None) if solids.is_empty() => return Err(out_of_place("solid")),
            (_, Some(_)) => {
                return Err(out_of_place("outer loop, vertex, endloop or endfacet"));
            }
            (b"outer" | b"vertex" | b"endloop" | b"endfacet", None) => {
                return Err(out_of_place("facet, solid or endsolid"));
            }
            _ => return Err(out_of_place(EXPECTED)),
        }
    }
    let expected = match (&facet, solids.is_empty()) {
        (Some(_), _) => "endfacet",
        (None, true) => "solid",
        (None, false) => return Ok(solids),
    };
    Err(ReadError::Line {
        line: last,
        problem: DataProblem::End {
            expected: expected.into(),
        },
    })
}

/// The normal of a facet, zero where it makes no sense: the corners tell it too.
fn normal(rest: &[u8]) -> DVec3 {
    vector(split_statement(rest).1).unwrap_or(DVec3::ZERO)
}

fn vector(text: &[u8]) -> Result<DVec3, DataProblem> {
    let text = shown(text);
    let mut words = text.split_ascii_whitespace();
    let mut vector = [0.0; 3];
    for (found, value) in vector.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| DataProblem::Count {
            found,
            expected: "three coordinates".into(),
        })?;
        *value =
            number(word).ok_or_else(|| DataProblem::word(word.as_bytes(), "a finite number"))?;
    }
    Ok(vector.into())
}
