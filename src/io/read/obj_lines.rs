//! The lines of an OBJ file, checked and completed for `tobj`.
//!
//! `tobj` names no line in its errors; it makes triangles of `l` lines with three points; it gives
//! colours to the wrong vertices where only some have one, and loses count where only some corners have
//! a normal or a texture coordinate. So every line is checked first, and written again such that
//! none of that can arise: all vertices with a colour, all corners with all three indices, counted from 1.
//!
//! Source: *Object Files (.obj)*, Wavefront Advanced Visualizer manual, appendix B1.

use std::collections::BTreeSet;

use super::{ObjProblem, ReadError};

/// What `tobj` can read, and what it cannot tell.
#[derive(Default)]
pub(super) struct Prepared {
    /// An OBJ file that says the same. The first `vt` is NaN and the first `vn` zero; they stand for those
    /// that corners lack.
    pub(super) text: String,
    /// Whether any vertex had a colour.
    pub(super) has_colors: bool,
    /// Names after `usemtl`.
    pub(super) materials: BTreeSet<String>,
    /// How many lines had points or lines.
    pub(super) points_and_lines: usize,
    /// How many had curves or curved surfaces.
    pub(super) curves: usize,
    /// How many faces had fewer than three corners.
    pub(super) empty_faces: usize,
    /// How many of `v`, `vt` and `vn` there are so far.
    counts: [usize; 3],
}

/// Checks and completes a file.
pub(super) fn prepare(file: &str) -> Result<Prepared, ReadError> {
    let mut prepared = Prepared {
        text: "vt NaN NaN\nvn 0 0 0\n".to_owned(),
        ..Prepared::default()
    };
    let mut lines = file.lines().enumerate();
    while let Some((index, line)) = lines.next() {
        // A backslash at the end continues a line.
        let mut line = line
            .split('#')
            .next()
            .unwrap_or_default()
            .trim_end()
            .to_owned();
        while line.ends_with('\\') {
            line.pop();
            let Some((_, more)) = lines.next() else {
                break;
            };
            line.push(' ');
            line.push_str(more.split('#').next().unwrap_or_default().trim_end());
        }
        prepared.add(&line).map_err(|problem| ReadError::ObjLine {
            line: index + 1,
            problem,
        })?;
    }
    Ok(prepared)
}

impl Prepared {
    fn add(&mut self, line: &str) -> Result<(), ObjProblem> {
        let (statement, rest) = line
            .trim()
            .split_once(char::is_whitespace)
            .unwrap_or((line.trim(), ""));
        match statement {
            "v" => self.add_vertex(rest)?,
            "vt" => {
                self.counts[1] += 1;
                let numbers = numbers("vt", rest, "1 to 3", &[1, 2, 3])?;
                let second = numbers.get(1).copied().unwrap_or_default();
                self.write("vt", &[numbers[0], second]);
            }
            "vn" => {
                self.counts[2] += 1;
                let numbers = numbers("vn", rest, "3", &[3])?;
                self.write("vn", &numbers);
            }
            "f" | "fo" => self.add_face(rest)?,
            "p" | "l" => self.points_and_lines += 1,
            "curv" | "curv2" | "surf" => self.curves += 1,
            "usemtl" if !rest.trim().is_empty() => {
                self.materials.insert(rest.trim().to_owned());
                self.text += &format!("usemtl {}\n", rest.trim());
            }
            "mtllib" | "o" | "g" => self.text += &format!("{statement} {}\n", rest.trim()),
            _ => {}
        }
        Ok(())
    }

    fn add_vertex(&mut self, rest: &str) -> Result<(), ObjProblem> {
        self.counts[0] += 1;
        let numbers = numbers("v", rest, "3, 4 or 6", &[3, 4, 6])?;
        let mut vertex = [1.0; 6];
        match numbers[..] {
            [_, _, _, 0.0] => return Err(ObjProblem::AtInfinity),
            [x, y, z, w] => vertex[..3].copy_from_slice(&[x / w, y / w, z / w]),
            _ => vertex[..numbers.len()].copy_from_slice(&numbers),
        }
        self.has_colors |= numbers.len() == 6;
        self.write("v", &vertex);
        Ok(())
    }

    fn write(&mut self, statement: &str, numbers: &[f64]) {
        self.text += statement;
        for number in numbers {
            self.text += &format!(" {number}");
        }
        self.text.push('\n');
    }

    fn add_face(&mut self, rest: &str) -> Result<(), ObjProblem> {
        let corners: Vec<[usize; 3]> = rest
            .split_whitespace()
            .map(|corner| self.corner(corner))
            .collect::<Result<_, _>>()?;
        if corners.len() < 3 {
            self.empty_faces += 1;
            return Ok(());
        }
        self.text.push('f');
        for [v, vt, vn] in corners {
            self.text += &format!(" {v}/{vt}/{vn}");
        }
        self.text.push('\n');
        Ok(())
    }

    /// The three indices of a corner as `text` has them.
    fn corner(&self, word: &str) -> Result<[usize; 3], ObjProblem> {
        let malformed = || ObjProblem::Corner {
            found: word.to_owned(),
        };
        let parts: Vec<&str> = word.split('/').collect();
        if parts.len() > 3 || parts[0].is_empty() {
            return Err(malformed());
        }
        // The substitutes come first.
        let mut indices = [0, 1, 1];
        for (i, part) in parts
            .iter()
            .enumerate()
            .filter(|(_, part)| !part.is_empty())
        {
            let index: i64 = part.parse().map_err(|_| malformed())?;
            let count = self.counts[i];
            let from_start = if index < 0 {
                index.checked_add(count as i64 + 1)
            } else {
                Some(index)
            };
            let in_range = from_start.filter(|&index| index >= 1 && index <= count as i64);
            let Some(index_from_1) = in_range else {
                return Err(ObjProblem::Index {
                    found: word.to_owned(),
                    what: ["v", "vt", "vn"][i],
                    index,
                    count,
                });
            };
            indices[i] = index_from_1 as usize + usize::from(i > 0);
        }
        Ok(indices)
    }
}

/// The numbers behind a statement, as many as `allowed`.
fn numbers(
    statement: &'static str,
    rest: &str,
    expected: &'static str,
    allowed: &[usize],
) -> Result<Vec<f64>, ObjProblem> {
    let numbers: Vec<f64> = rest
        .split_whitespace()
        .map(|word| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(ObjProblem::Number {
                found: word.to_owned(),
            }),
        })
        .collect::<Result<_, _>>()?;
    if !allowed.contains(&numbers.len()) {
        return Err(ObjProblem::Count {
            statement,
            found: numbers.len(),
            expected,
        });
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(file: &str) -> String {
        prepare(file).err().expect("an error").to_string()
    }

    #[test]
    fn corners_are_completed_and_counted_from_one() {
        let prepared =
            prepare("v 1 2 3\nv 4 5 6 2\nvt 0.5\nf 1 -1/-1 2//\nl 1 2 1\np 1\n").unwrap();
        assert_eq!(
            prepared.text,
            "vt NaN NaN\nvn 0 0 0\nv 1 2 3 1 1 1\nv 2 2.5 3 1 1 1\nvt 0.5 0\nf 1/1/1 2/2/1 2/1/1\n"
        );
        assert_eq!(prepared.points_and_lines, 2);
        assert!(!prepared.has_colors);
    }

    #[test]
    fn a_line_can_go_on() {
        let prepared = prepare("v 0 0 \\\n 0 # origin\nf 1 1\\\n1\nf 2").err();
        let error = prepared.expect("a corner that is not there").to_string();
        // The first f is whole: "1 1 1" over two lines.
        assert_eq!(
            error,
            "line 5: corner \"2\" asks for v 2, but there are 1 so far"
        );
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
            "line 1: v has 2 numbers, expected 3, 4 or 6"
        );
        assert_eq!(
            message("v 1 2 3 0"),
            "line 1: the fourth coordinate is 0, expected another number"
        );
        assert_eq!(
            message("v 0 0 0\nf 1 1 -2"),
            "line 2: corner \"-2\" asks for v -2, but there are 1 so far"
        );
        assert!(message("v 0 0 0\nf 1/0 1 1").contains("asks for vt 0"));
        assert!(message("f 1/1/1/1 1 1").contains("expected v, v/vt, v//vn or v/vt/vn"));
        assert!(message("f /1 1 1").contains("corner \"/1\""));
        assert!(message("v 0 0 0\nf -9223372036854775808 1 1").contains("asks for v -92"));
    }
}
