//! OFF files: text with vertices, then faces.
//!
//! The format is small enough to be read here, in all its variants of text and with the line of every fault.
//!
//! Source: Geomview manual, version 1.9, *OFF Files*.

use glam::{DVec2, DVec3, DVec4};

use super::far::checked;
use super::note::{Note, plural};
use super::surface::Surface;
use super::text::{
    as_bytes_of_ascii, lines, number, shown, split_statement, without_comment, without_mark, words,
};
use super::{DataProblem, Findings, ReadError};
use crate::material::Model;
use crate::mesh::MeshError;

const VARIANTS: &str = "OFF, COFF, NOFF, CNOFF or one of these behind ST, of text";

/// What the vertices of a file have, by the word that it begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Variant {
    has_texture_coordinates: bool,
    has_colors: bool,
    has_normals: bool,
}

impl Variant {
    /// The variant of a word, and what stands behind it without a space, as in some collections of models.
    fn of(word: &[u8]) -> Option<(Self, &[u8])> {
        let (has_texture_coordinates, rest) = without(word, b"ST");
        let (has_colors, rest) = without(rest, b"C");
        let (has_normals, rest) = without(rest, b"N");
        let rest = rest.strip_prefix(b"OFF")?;
        let variant = Self {
            has_texture_coordinates,
            has_colors,
            has_normals,
        };
        Some((variant, rest))
    }
}

fn without<'a>(word: &'a [u8], prefix: &[u8]) -> (bool, &'a [u8]) {
    let rest = word.strip_prefix(prefix);
    (rest.is_some(), rest.unwrap_or(word))
}

/// Whether a file starts as an OFF file with its word does.
pub(super) fn is_off(start: &[u8]) -> bool {
    let text = as_bytes_of_ascii(without_mark(start));
    let first = full_lines(&text).next();
    let (word, _) = first.map_or((&b""[..], &b""[..]), |(_, line)| split_statement(line));
    let variant = Variant::of(word);
    variant.is_some_and(|(_, rest)| rest.iter().all(u8::is_ascii_digit))
}

/// Lines with more than a comment, without it, and their numbers.
fn full_lines(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let lines = (1..).zip(lines(text));
    let lines = lines.map(|(number, line)| (number, without_comment(line).trim_ascii()));
    lines.filter(|(_, line)| !line.is_empty())
}

/// Reads the bytes of an OFF file; its part is called `name`.
pub(super) fn read_off(bytes: &[u8], name: &str) -> Result<(Model, Findings), ReadError> {
    let text = as_bytes_of_ascii(bytes);
    let mut notes = vec![];
    let surface = read_surface(&text, &mut notes)?;
    let (vertices, place) = (surface.positions.len(), format!("part {name:?}"));
    let part = surface.into_part(name.to_owned(), &mut notes);
    let part = part.map_err(|problem| ReadError::Mesh { place, problem })?;
    let Some(part) = part else {
        let skipped: String = notes.iter().map(|note| format!("; {note}")).collect();
        let instead = format!("{}{skipped}", plural(vertices, "vertex"));
        return Err(ReadError::NoTriangles { instead });
    };
    let model = Model {
        parts: vec![part],
        ..Model::default()
    };
    let files = vec![];
    Ok((checked(model)?, Findings { notes, files }))
}

fn read_surface(text: &[u8], notes: &mut Vec<Note>) -> Result<Surface, ReadError> {
    let mut lines = full_lines(text);
    let mut last = 1;
    let mut next = |expected: &dyn Fn() -> String| {
        let Some((line, text)) = lines.next() else {
            let expected = expected();
            return Err(ReadError::Line {
                line: last,
                problem: DataProblem::End { expected },
            });
        };
        last = line;
        Ok((line, text))
    };
    let (line, first) = next(&|| VARIANTS.into())?;
    let (word, rest) = split_statement(first);
    let (variant, counts) = match Variant::of(word) {
        Some((variant, b"")) => (variant, rest),
        Some((variant, rest)) if rest.iter().all(u8::is_ascii_digit) => {
            (variant, &first[word.len() - rest.len()..])
        }
        _ if number_of(word).is_some() => (Variant::default(), first),
        _ => {
            return Err(ReadError::Line {
                line,
                problem: DataProblem::word(word, VARIANTS),
            });
        }
    };
    if counts == b"BINARY" {
        let expected = "counts: only OFF files of text are read, MeshLab converts binary ones";
        let problem = DataProblem::word(counts, expected);
        return Err(ReadError::Line { line, problem });
    }
    let (line, counts) = match counts {
        b"" => next(&|| "how many vertices and faces there are".into())?,
        _ => (line, counts),
    };
    let [vertices, faces] =
        read_counts(counts).map_err(|problem| ReadError::Line { line, problem })?;
    check_room(vertices, faces, text.len())?;

    let mut surface = Surface::default();
    let mut extra = 0;
    for vertex in 0..vertices {
        let (line, text) = next(&|| format!("vertex {vertex} of {vertices}"))?;
        let added = add_vertex(text, variant, &mut surface);
        extra += added.map_err(|problem| ReadError::Line { line, problem })?;
    }
    scale_colors(&mut surface.colors);
    let mut painted = 0;
    for face in 0..faces {
        let (line, text) = next(&|| format!("face {face} of {faces}"))?;
        let added = add_face(text, vertices, &mut surface);
        let more = added.map_err(|problem| ReadError::Line { line, problem })?;
        painted += usize::from(more > 0);
    }
    if extra > 0 {
        notes.push(Note::PassedOver {
            what: "numbers behind those of a vertex",
            count: extra,
            first_line: None,
        });
    }
    if painted > 0 {
        let what = format!("colours of {}", plural(painted, "face"));
        notes.push(Note::NotCarried { what });
    }
    Ok(surface)
}

/// How many vertices and faces there are; how many edges there are, which is often wrong, does not matter.
fn read_counts(text: &[u8]) -> Result<[usize; 2], DataProblem> {
    let mut words = words(text);
    let mut counts = [0; 2];
    for (found, count) in counts.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| DataProblem::Count {
            found,
            expected: "how many vertices and how many faces there are".into(),
        })?;
        let number = std::str::from_utf8(word).ok().and_then(|n| n.parse().ok());
        *count = number.ok_or_else(|| DataProblem::word(word, "a whole number"))?;
    }
    Ok(counts)
}

/// Checks that so many bytes can be what is declared: three digits and what parts them for a vertex, one for a face.
fn check_room(vertices: usize, faces: usize, left: usize) -> Result<(), ReadError> {
    for (count, element, size) in [(vertices, "vertex", 6), (faces, "face", 2)] {
        let needed = count as u128 * size;
        // The last line need not end.
        if needed > left as u128 + 1 {
            return Err(ReadError::Data(DataProblem::CutOff {
                count: count as u64,
                element: element.into(),
                needed,
                left,
            }));
        }
    }
    if vertices > u32::MAX as usize {
        return Err(ReadError::Mesh {
            place: "the file".into(),
            problem: MeshError::TooManyVertices(vertices),
        });
    }
    Ok(())
}

/// Adds a vertex: its place, then normal, colour and texture coordinates as far as the variant has them. A colour has three
/// or four numbers. Returns how many numbers are left over.
fn add_vertex(text: &[u8], variant: Variant, surface: &mut Surface) -> Result<usize, DataProblem> {
    let numbers = numbers(text)?;
    let mut rest = &numbers[..];
    let mut take = |count: usize| {
        let split = rest.split_at_checked(count);
        let (taken, more) = split.ok_or_else(|| DataProblem::Count {
            found: numbers.len(),
            expected: variant.numbers(),
        })?;
        rest = more;
        Ok(taken)
    };
    surface.positions.push(DVec3::from_slice(take(3)?));
    if variant.has_normals {
        surface.normals.push(DVec3::from_slice(take(3)?));
    }
    if variant.has_colors {
        let rgb = DVec3::from_slice(take(3)?);
        let behind = if variant.has_texture_coordinates {
            2
        } else {
            0
        };
        let base = if variant.has_normals { 9 } else { 6 };
        // Without an opacity, as many programs write it; NaN stands for all of it.
        let opacity = match numbers.len() > base + behind {
            true => take(1)?[0],
            false => f64::NAN,
        };
        surface.colors.push(rgb.extend(opacity));
    }
    if variant.has_texture_coordinates {
        let pair = DVec2::from_slice(take(2)?);
        surface.texture_coordinates.push(pair);
    }
    Ok(rest.len())
}

impl Variant {
    /// The numbers of a vertex in words.
    fn numbers(self) -> String {
        let more = [
            (self.has_normals, ", a normal"),
            (self.has_colors, ", a colour"),
            (self.has_texture_coordinates, ", texture coordinates"),
        ];
        let more = more.into_iter().filter(|(has, _)| *has);
        let more: String = more.map(|(_, words)| words).collect();
        format!("three coordinates{more} of a vertex")
    }
}

/// Brings colours to the range from 0 to 1: where any number of them is above 1, all are from 0 to 255.
fn scale_colors(colors: &mut [DVec4]) {
    let above = |color: &DVec4| color.to_array().iter().any(|&number| number > 1.0);
    let full = if colors.iter().any(above) { 255.0 } else { 1.0 };
    for color in colors {
        *color /= full;
        if color.w.is_nan() {
            color.w = 1.0;
        }
    }
}

/// Adds a face, and returns how many numbers are behind its corners.
fn add_face(text: &[u8], vertices: usize, surface: &mut Surface) -> Result<usize, DataProblem> {
    let mut words = words(text);
    let first = words.next().unwrap_or_default();
    let arity: Option<u32> = std::str::from_utf8(first).ok().and_then(|n| n.parse().ok());
    let arity = arity.ok_or_else(|| DataProblem::word(first, "how many corners the face has"))?;
    for found in 0..arity as usize {
        let word = words.next().ok_or_else(|| DataProblem::Count {
            found,
            expected: format!("{arity} corners"),
        })?;
        let corner = std::str::from_utf8(word).ok().and_then(|n| n.parse().ok());
        let corner = corner.filter(|&corner: &u32| (corner as usize) < vertices);
        surface
            .polygons
            .add_corner(corner.ok_or_else(|| DataProblem::Corner {
                found: shown(&word[..word.len().min(80)]).into_owned(),
                vertices,
            })?);
    }
    surface.polygons.end(arity as usize);
    Ok(words.count())
}

fn numbers(text: &[u8]) -> Result<Vec<f64>, DataProblem> {
    words(text)
        .map(|word| number_of(word).ok_or_else(|| DataProblem::word(word, "a finite number")))
        .collect()
}

fn number_of(word: &[u8]) -> Option<f64> {
    number(std::str::from_utf8(word).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str) -> (Model, Vec<String>) {
        let (model, findings) = read_off(file.as_bytes(), "stem").unwrap();
        (
            model,
            findings.notes.iter().map(ToString::to_string).collect(),
        )
    }

    fn message(file: &str) -> String {
        read_off(file.as_bytes(), "stem").unwrap_err().to_string()
    }

    #[test]
    fn the_first_word_tells_what_a_vertex_has() {
        let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
        // word, what stands behind each place, normals, colours, texture coordinates
        for (word, rest, normals, colors, pairs) in [
            ("OFF", "", false, false, false),
            ("NOFF", "0 1 0", true, false, false),
            ("COFF", "255 0 127.5 255", false, true, false),
            ("COFF", "1 0 0.5", false, true, false),
            ("CNOFF", "0 1 0 1 0 0.5 1", true, true, false),
            ("STOFF", "0.25 0.75", false, false, true),
            ("STCNOFF", "0 1 0 255 0 127.5 0.25 0.75", true, true, true),
        ] {
            let vertices = corners.map(|corner| format!("{corner} {rest}\n")).concat();
            let (model, notes) = read(&format!("{word}\n4 1 0\n{vertices}4 0 1 2 3\n"));
            let mesh = model.parts[0].mesh();
            assert_eq!(
                mesh.positions().len(),
                if normals { 4 } else { 6 },
                "{word}"
            );
            if normals {
                assert_eq!(mesh.normals().unwrap(), [DVec3::Y; 4]);
            }
            let found = mesh.colors().map(|colors| colors[0].to_array());
            let half = crate::effects::linear_of_srgb(0.5) as f32;
            assert_eq!(found, colors.then_some([1.0, 0.0, half, 1.0]), "{word}");
            let found = mesh.texture_coordinates().first();
            let found = found.map(|set| set[0].to_array());
            assert_eq!(found, pairs.then_some([0.25, 0.25]), "{word}");
            assert_eq!(notes.len(), usize::from(colors), "{notes:?}");
            assert!(is_off(format!("# c\n{word} # d\n").as_bytes()));
        }
    }

    #[test]
    fn files_as_they_are_in_collections_are_read() {
        let rest = "0 0 0 # a\n\t1e0 0 -0\r\n\r\n  0 +1 .0\n# b\n3\t0 1 2 255 0 0";
        for start in [
            "OFF\n3 1 0\n",
            "OFF 3 1\n",
            "OFF3 1 0\n",
            "\u{feff}# c\nOFF\n# d\n3 1 7\n",
            "3 1 0\n",
        ] {
            let (model, notes) = read(&format!("{start}{rest}"));
            assert_eq!(model.triangle_count(), 1);
            assert_eq!(notes, ["colours of 1 face: not copied"], "{start}");
        }
        let file: Vec<u8> = format!("\u{feff}OFF 3 1\n{rest}")
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        assert_eq!(read_off(&file, "a").unwrap().0.triangle_count(), 1);
        assert!(is_off(&file));
        assert!(!is_off(b"OFFICE\n"));
        assert!(!is_off(b"3 1 0\n"));
    }

    #[test]
    fn errors_name_the_line() {
        let corners = "0 0 0\n1 0 0\n0 1 0\n";
        for (file, words) in [
            ("", "line 1: the file ends, expected OFF, COFF"),
            ("4OFF\n1 1 1\n", "line 1: \"4OFF\", expected OFF, COFF"),
            (
                "OFF BINARY\n",
                "line 1: \"BINARY\", expected counts: only OFF files of text",
            ),
            ("OFF\n3\n", "line 2: 1 numbers, expected how many vertices"),
            ("OFF\n3 x\n", "line 2: \"x\", expected a whole number"),
            (
                "OFF\n4000000000 1 0\n0 0 0\n",
                "4000000000 vertex elements need at least",
            ),
            (
                "OFF\n0 4000000000 0\n0 0 0\n",
                "4000000000 face elements need at least",
            ),
            (
                &format!("OFF\n3 1 0\n{corners}"),
                "line 5: the file ends, expected face 0 of 1",
            ),
            (
                &format!("OFF\n4 1 0\n{corners}3 0 1 2\n"),
                "line 6: the file ends, expected face 0 of 1",
            ),
            (
                "OFF\n2 1 0\n0 0\n0 0 0\n3 0 0 0\n",
                "line 3: 2 numbers, expected three coordinates of a vertex",
            ),
            (
                "OFF\n2 1 0\n0 0 nan\n0 0 0\n3 0 0 0\n",
                "line 3: \"nan\", expected a finite number",
            ),
            (
                &format!("OFF\n3 1 0\n{corners}3 0 1 3\n"),
                "line 6: a corner at vertex 3, expected one of the 3",
            ),
            (
                &format!("OFF\n3 1 0\n{corners}3 0 1 -1\n"),
                "line 6: a corner at vertex -1",
            ),
            (
                &format!("OFF\n3 1 0\n{corners}4 0 1 2\n"),
                "line 6: 3 numbers, expected 4 corners",
            ),
            (
                &format!("OFF\n3 1 0\n{corners}4294967295 0 1 2\n"),
                "expected 4294967295 corners",
            ),
            (
                &format!("OFF\n3 1 0\n{corners}2 0 1\n"),
                "the file has 3 vertices; 1 face of fewer than three",
            ),
        ] {
            let found = message(file);
            assert!(found.contains(words), "{found}\n{words}");
        }
    }
}
