//! The statements of an OBJ file: its vertices, and its faces by part.
//!
//! What does not bear on the shape is read as leniently as other programs read it, and what is ignored is
//! counted; positions and the corners of faces have to be right. References are followed when all of the file
//! is read, since some programs write faces before vertices.
//!
//! Source: *Object Files (.obj)*, Wavefront Advanced Visualizer manual, appendix B1.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::read::note::{Note, plural};
use crate::read::notes::add_note;
use crate::read::text::{
    as_bytes_of_ascii, lines, number, shown, split_statement, without_comment,
};
use crate::read::{ObjProblem, ReadError};

/// What an OBJ file says.
#[derive(Default)]
pub(super) struct Statements {
    pub(super) positions: Vec<DVec3>,
    /// As the file has them; one for each position if any has one, else none.
    pub(super) colors: Vec<DVec3>,
    /// NaN where the file has no numbers.
    pub(super) texture_coordinates: Vec<DVec2>,
    /// Zero where the file has no numbers.
    pub(super) normals: Vec<DVec3>,
    /// Those with faces, in the order of their first ones.
    pub(super) parts: Vec<Faces>,
    /// Names behind `usemtl`, in the bytes of the file.
    pub(super) materials: Names,
    /// What stands behind each `mtllib`, each once.
    pub(super) libraries: Names,
    /// How many faces had fewer than three corners.
    pub(super) empty_faces: usize,
    /// Of groups and objects.
    pub(super) names: Names,
    /// Of objects, which may have groups of equal names.
    object: u32,
    name: u32,
    /// Of what follows now.
    pub(super) material: Option<u32>,
    /// The part of each object, name and material.
    known: HashMap<(u32, u32, Option<u32>), usize>,
    points_and_lines: usize,
    curves: usize,
    oddities: Oddities,
    /// The corner with the highest `v`, and its line.
    highest: Option<(u32, usize, String)>,
}

/// The faces of one name and material.
pub(super) struct Faces {
    /// Which of the file's names of groups and objects: a file of many parts may have one long name for all.
    pub(super) name: u32,
    /// Which of the file's materials.
    pub(super) material: Option<u32>,
    /// `v`, `vt` and `vn` of all corners, from 1, or 0 where there is none.
    pub(super) corners: Vec<[u32; 3]>,
    /// How many corners each face has.
    pub(super) arities: Vec<u32>,
}

/// Different names, in the order of their first use.
#[derive(Default)]
pub(super) struct Names {
    numbers: HashMap<Arc<[u8]>, u32>,
    pub(super) all: Vec<Arc<[u8]>>,
}

impl Names {
    fn number(&mut self, name: &[u8]) -> u32 {
        if let Some(&number) = self.numbers.get(name) {
            return number;
        }
        let number = self.all.len() as u32;
        let name: Arc<[u8]> = name.into();
        self.all.push(name.clone());
        self.numbers.insert(name, number);
        number
    }
}

/// How often something was ignored or replaced, and the first line with it.
#[derive(Default)]
struct Oddities(Vec<(&'static str, usize, usize)>);

impl Oddities {
    fn add(&mut self, what: &'static str, line: usize) {
        match self.0.iter_mut().find(|(known, ..)| *known == what) {
            Some((_, count, _)) => *count += 1,
            None => self.0.push((what, 1, line)),
        }
    }
}

/// Reads all statements.
pub(super) fn read_statements(file: &[u8]) -> Result<Statements, ReadError> {
    let file = as_bytes_of_ascii(file);
    let mut statements = Statements::default();
    statements.begin();
    let mut lines = lines(&file).enumerate();
    while let Some((index, line)) = lines.next() {
        let (statement, _) = split_statement(line);
        if statement.is_empty() || statement[0] == b'#' {
            continue;
        }
        let statement = statement.to_ascii_lowercase();
        // Names may have # in them.
        let is_name = matches!(&statement[..], b"o" | b"g" | b"usemtl" | b"mtllib");
        let significant = |line| match is_name {
            true => <[u8]>::trim_ascii_end(line),
            false => without_comment(line),
        };
        let mut line = Cow::from(significant(line));
        // A backslash at the end continues a line.
        while line.ends_with(b"\\") {
            let line = line.to_mut();
            line.pop();
            let Some((_, more)) = lines.next() else {
                break;
            };
            line.push(b' ');
            line.extend_from_slice(significant(more));
        }
        let rest = split_statement(&line).1;
        let added = statements.add(&statement, rest, index + 1);
        added.map_err(|problem| ReadError::ObjLine {
            line: index + 1,
            problem,
        })?;
    }
    statements.follow_references()?;
    Ok(statements)
}

impl Statements {
    /// Sets what holds before the first statement: an object and a group without a name.
    pub(super) fn begin(&mut self) {
        let none = self.names.number(b"");
        (self.object, self.name) = (none, none);
    }

    /// Takes in a statement that names what follows, or a library.
    pub(super) fn add_name(&mut self, statement: &[u8], rest: &[u8]) {
        match statement {
            b"usemtl" if !rest.is_empty() => self.material = Some(self.materials.number(rest)),
            b"mtllib" if !rest.is_empty() => _ = self.libraries.number(rest),
            b"o" => {
                self.object = self.names.number(rest);
                self.name = self.object;
            }
            b"g" => self.name = self.names.number(rest),
            _ => {}
        }
    }

    fn add(&mut self, statement: &[u8], rest: &[u8], line: usize) -> Result<(), ObjProblem> {
        match statement {
            b"v" => self.add_vertex(rest, line)?,
            b"vt" => self.add_texture_coordinate(rest, line),
            b"vn" => self.add_normal(rest, line),
            b"f" | b"fo" => self.add_face(rest, line)?,
            b"p" | b"l" => self.points_and_lines += 1,
            b"curv" | b"curv2" | b"surf" => self.curves += 1,
            _ => self.add_name(statement, rest),
        }
        Ok(())
    }

    fn add_vertex(&mut self, rest: &[u8], line: usize) -> Result<(), ObjProblem> {
        let rest = shown(rest);
        let mut words = rest.split_ascii_whitespace();
        let mut position = [0.0; 3];
        for (found, number) in position.iter_mut().enumerate() {
            let word = words.next().ok_or(ObjProblem::Count {
                statement: "v",
                found,
                expected: "at least 3",
            })?;
            *number = self::number(word).ok_or_else(|| ObjProblem::Number {
                found: word.to_owned(),
            })?;
        }
        self.positions.push(DVec3::from_array(position));
        let more: Vec<Option<f64>> = words.by_ref().take(3).map(number).collect();
        let color = match more[..] {
            [Some(r), Some(g), Some(b)] => Some(DVec3::new(r, g, b)),
            [] => None,
            [Some(1.0)] => None,
            [_] => {
                self.oddities.add("the fourth number of v", line);
                None
            }
            [_, _] => {
                self.oddities.add("two numbers behind those of v", line);
                None
            }
            _ => {
                let what = "a colour of v that is not three finite numbers";
                self.oddities.add(what, line);
                None
            }
        };
        if words.next().is_some() {
            self.oddities.add("numbers behind the colour of v", line);
        }
        if color.is_some() || !self.colors.is_empty() {
            self.colors.resize(self.positions.len() - 1, DVec3::ONE);
            self.colors.push(color.unwrap_or(DVec3::ONE));
        }
        Ok(())
    }

    fn add_texture_coordinate(&mut self, rest: &[u8], line: usize) {
        let rest = shown(rest);
        let mut words = rest.split_ascii_whitespace().map(number);
        let first = words.next().flatten();
        // One number is a place along a line.
        let second = words.next().unwrap_or(Some(0.0));
        let pair = first.zip(second).map(DVec2::from);
        if pair.is_none() {
            let what = "a vt that is not one to three finite numbers";
            self.oddities.add(what, line);
        }
        self.texture_coordinates.push(pair.unwrap_or(DVec2::NAN));
    }

    fn add_normal(&mut self, rest: &[u8], line: usize) {
        let rest = shown(rest);
        let numbers: Vec<Option<f64>> = rest.split_ascii_whitespace().take(3).map(number).collect();
        let normal = match numbers[..] {
            [Some(x), Some(y), Some(z)] => DVec3::new(x, y, z),
            _ => {
                let what = "a vn that is not three finite numbers";
                self.oddities.add(what, line);
                DVec3::ZERO
            }
        };
        self.normals.push(normal);
    }

    fn add_face(&mut self, rest: &[u8], line: usize) -> Result<(), ObjProblem> {
        let rest = shown(rest);
        let count = rest.split_ascii_whitespace().count();
        let has_area = count >= 3;
        if !has_area {
            self.empty_faces += 1;
        }
        let part = has_area.then(|| self.part());
        for word in rest.split_ascii_whitespace() {
            let corner = self.corner(word, line)?;
            if let Some(part) = part {
                self.parts[part].corners.push(corner);
            }
        }
        if let Some(part) = part {
            self.parts[part].arities.push(count as u32);
        }
        Ok(())
    }

    /// The part that faces go to now.
    pub(super) fn part(&mut self) -> usize {
        let key = (self.object, self.name, self.material);
        *self.known.entry(key).or_insert_with(|| {
            self.parts.push(Faces {
                name: self.name,
                material: self.material,
                corners: vec![],
                arities: vec![],
            });
            self.parts.len() - 1
        })
    }

    /// The three references of a corner, from 1; those that are beyond what there is so far are looked at later.
    fn corner(&mut self, word: &str, line: usize) -> Result<[u32; 3], ObjProblem> {
        let malformed = || ObjProblem::Corner {
            found: word.to_owned(),
        };
        let counts = [
            self.positions.len(),
            self.texture_coordinates.len(),
            self.normals.len(),
        ];
        let mut indices = [0; 3];
        let mut parts = word.split('/');
        for (i, part) in parts.by_ref().take(3).enumerate() {
            if part.is_empty() && i > 0 {
                continue;
            }
            let index: i64 = part.parse().map_err(|_| malformed())?;
            let from_1 = match index {
                ..0 => index.saturating_add(counts[i] as i64 + 1),
                _ => index,
            };
            match u32::try_from(from_1).ok().filter(|&from_1| from_1 > 0) {
                Some(from_1) => indices[i] = from_1,
                None if i == 0 => return Err(no_such_vertex(word, index, counts[0])),
                None => self.oddities.add(DANGLING, line),
            }
        }
        if parts.next().is_some() {
            return Err(malformed());
        }
        let highest = self.highest.as_ref().map_or(0, |highest| highest.0);
        if indices[0] as usize > counts[0] && indices[0] > highest {
            self.highest = Some((indices[0], line, word.to_owned()));
        }
        Ok(indices)
    }

    /// Checks the references of all corners, now that all is there that they may refer to.
    fn follow_references(&mut self) -> Result<(), ReadError> {
        if let Some((index, line, word)) = &self.highest
            && *index as usize > self.positions.len()
        {
            return Err(ReadError::ObjLine {
                line: *line,
                problem: no_such_vertex(word, i64::from(*index), self.positions.len()),
            });
        }
        let counts = [self.texture_coordinates.len(), self.normals.len()];
        let mut missing = 0;
        for corner in self.parts.iter_mut().flat_map(|part| &mut part.corners) {
            for (index, count) in corner[1..].iter_mut().zip(counts) {
                if *index as usize > count {
                    *index = 0;
                    missing += 1;
                }
            }
        }
        if missing > 0 {
            match self.oddities.0.iter_mut().find(|odd| odd.0 == DANGLING) {
                Some((_, count, _)) => *count += missing,
                None => self.oddities.0.push((DANGLING, missing, 0)),
            }
        }
        Ok(())
    }

    /// Names what is ignored.
    pub(super) fn note(&self, notes: &mut Vec<Note>) {
        let count = self.points_and_lines;
        if count > 0 {
            let place = "the file".to_owned();
            add_note(notes, Note::PointsAndLines { place, count });
        }
        let count = self.empty_faces;
        if count > 0 {
            add_note(notes, Note::EmptyFaces { count });
        }
        if self.curves > 0 {
            let what = plural(self.curves, "free-form curve or surface");
            add_note(notes, Note::NotCarried { what });
        }
        for &(what, count, first_line) in &self.oddities.0 {
            let note = Note::PassedOver {
                what,
                count,
                first_line: Some(first_line).filter(|&line| line > 0),
            };
            add_note(notes, note);
        }
        if !self.colors.is_empty() {
            add_note(notes, Note::ColorsFromSrgb);
        }
    }
}

/// A reference of a corner that leads nowhere.
const DANGLING: &str = "a vt or vn of a corner that is not there";

fn no_such_vertex(word: &str, index: i64, count: usize) -> ObjProblem {
    ObjProblem::Index {
        found: word.to_owned(),
        index,
        count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str) -> (Statements, Vec<String>) {
        let statements = read_statements(file.as_bytes()).unwrap();
        let mut notes = vec![];
        statements.note(&mut notes);
        (statements, notes.iter().map(ToString::to_string).collect())
    }

    fn message(file: &str) -> String {
        let error = read_statements(file.as_bytes()).err();
        error.expect("an error").to_string()
    }

    #[test]
    fn corners_are_counted_from_one_in_any_case_of_letters() {
        let (file, notes) = read("V 1 2 3\nv 4 5 6\nVT 0.5\nF 1 -1/-1 2//\nl 1 2 1\nP 1\n");
        assert_eq!(file.parts[0].corners, [[1, 0, 0], [2, 1, 0], [2, 0, 0]]);
        assert_eq!(file.parts[0].arities, [3]);
        assert_eq!(file.texture_coordinates, [DVec2::new(0.5, 0.0)]);
        let expected = ["the file: 2 primitives of points or lines skipped"];
        assert_eq!(notes, expected);
    }

    #[test]
    fn a_line_can_go_on() {
        // The first f is whole: "1 1 1" over two lines.
        assert_eq!(
            message("v 0 0 \\\n 0 # origin \\\nf 1 1\\\n1\nf 2"),
            "line 5: corner \"2\" refers to v 2, but only 1 are defined so far"
        );
    }

    #[test]
    fn a_number_sign_begins_a_comment_only_where_no_name_can_be() {
        let (file, _) = read(
            "# c \\\nv 0 0 0 # a\nv 0 0 1# b\nusemtl #f00\ng a #1\nf 1 2 1 # c\nusemtl #0f0\nf 1 2 1",
        );
        let names = file.materials.all.iter().map(|name| &name[..]);
        assert_eq!(names.collect::<Vec<_>>(), [b"#f00", b"#0f0"]);
        let name = &file.names.all[file.parts[0].name as usize];
        assert_eq!(name[..], b"a #1"[..]);
        assert_eq!(file.parts.len(), 2);
    }

    #[test]
    fn what_does_not_bear_on_the_shape_may_be_odd() {
        let (file, notes) = read(
            "v 0 0 0 2\nv 1 0 0 1\nv 0 1 0 1 0.5 0 1\nv 1 1 0 x 0 0\nv 2 0 0 0 1\n\
             vn nan 0 0\nvn 1 0\nvt inf 0\nvt\nf 1/9/9 2/0/1 3\n",
        );
        assert_eq!(file.positions[0], DVec3::ZERO);
        assert_eq!(file.colors[2], DVec3::new(1.0, 0.5, 0.0));
        assert_eq!(file.colors[3], DVec3::ONE);
        assert_eq!(file.normals, [DVec3::ZERO; 2]);
        assert!(file.texture_coordinates.iter().all(|uv| uv.is_nan()));
        assert_eq!(file.parts[0].corners, [[1, 0, 0], [2, 0, 1], [3, 0, 0]]);
        assert_eq!(
            notes,
            [
                "the fourth number of v: ignored once, in line 1",
                "numbers behind the colour of v: ignored once, in line 3",
                "a colour of v that is not three finite numbers: ignored once, in line 4",
                "two numbers behind those of v: ignored once, in line 5",
                "a vn that is not three finite numbers: ignored 2 times, first in line 6",
                "a vt that is not one to three finite numbers: ignored 2 times, first in line 8",
                "a vt or vn of a corner that is not there: ignored 3 times, first in line 10",
                "vertex colours: taken as sRGB, made linear",
            ]
        );
    }

    #[test]
    fn what_stands_behind_the_faces_counts_as_well() {
        let (file, notes) = read("f 1//1 2//1 3//1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n");
        assert_eq!(file.parts[0].corners, [[1, 0, 1], [2, 0, 1], [3, 0, 1]]);
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn parts_are_by_object_group_and_material() {
        let (file, _) = read(
            "v 0 0 0\nusemtl a\nf 1 1 1\nusemtl b\nf 1 1 1\nusemtl a\nf 1 1 1\n\
             g x\nf 1 1 1\no o\ng x\nf 1 1 1\ng\nusemtl b\nf 1 1 1\no o\ng x\nusemtl a\nf 1 1 1\n",
        );
        let parts = file.parts.iter();
        let parts: Vec<_> = parts
            .map(|part| {
                let name = &file.names.all[part.name as usize];
                (&name[..], part.material, part.arities.len())
            })
            .collect();
        let expected: [(&[u8], Option<u32>, usize); 5] = [
            (b"", Some(0), 2),
            (b"", Some(1), 1),
            (b"x", Some(0), 1),
            (b"x", Some(0), 2),
            (b"", Some(1), 1),
        ];
        assert_eq!(parts, expected);
    }

    #[test]
    fn errors_name_the_line() {
        assert_eq!(
            message("\nv 1 2 x\n"),
            "line 2: \"x\", expected a finite number"
        );
        assert_eq!(
            message("v 1 2 inf"),
            "line 1: \"inf\", expected a finite number"
        );
        assert_eq!(
            message("v 1 2"),
            "line 1: v has 2 numbers, expected at least 3"
        );
        assert_eq!(
            message("v 0 0 0\nf 1 1 -2"),
            "line 2: corner \"-2\" refers to v -2, but only 1 are defined so far"
        );
        assert!(message("v 0 0 0\nf 0/1 1 1").contains("refers to v 0"));
        assert!(message("f 1/1/1/1 1 1").contains("expected v, v/vt, v//vn or v/vt/vn"));
        assert!(message("f /1 1 1").contains("corner \"/1\""));
        assert!(message("v 0 0 0\nf -9223372036854775808 1 1").contains("refers to v -92"));
        assert!(message("v 0 0 0\nf 9223372036854775807 1 1").contains("refers to v 92"));
    }
}
