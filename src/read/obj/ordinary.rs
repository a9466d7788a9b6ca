//! The ordinary OBJ file, read by the crate `tobj`.
//!
//! There are two readers because `tobj` is made for files as they should be: it loses what this program keeps or says
//! (names that are not UTF-8, the faces of one material apart from each other, colours of some vertices, the line of an
//! error), and it gives the numbers of an ordinary file without any of that. A scan of the lines decides whether a file is
//! ordinary, so that both readers understand the same by it, and records its names; `tobj` reads its numbers. Every
//! other file, and every file that `tobj` refuses, is read statement by statement, which also words the errors. Both
//! give the same models, bit by bit.

use std::cell::Cell;
use std::path::Path;

use glam::{DVec2, DVec3};

use super::lines::{Faces, Statements};
use crate::read::text::{split_statement, words};

/// Characters of a number at most. With an exponent of two digits it is finite.
const MAX_NUMBER: usize = 40;
/// Bytes of a name at most: `tobj` copies it for every part.
const MAX_NAME: usize = 100;

/// What an ordinary file says; `None` for any other.
pub(super) fn read_ordinary(file: &[u8]) -> Option<Statements> {
    let scan = Scan::new(file)?;
    let options = tobj::LoadOptions::default();
    let first = Cell::new(true);
    let library = |_: &Path| {
        let names = match first.take() {
            true => &scan.statements.materials.all[..],
            false => &[],
        };
        let names = names.iter().map(|name| String::from_utf8_lossy(name));
        let materials: Vec<tobj::Material> = names
            .map(|name| tobj::Material {
                name: name.into_owned(),
                ..tobj::Material::default()
            })
            .collect();
        let numbers = materials.iter().enumerate();
        let numbers = numbers.map(|(i, m)| (m.name.clone(), i)).collect();
        Ok((materials, numbers))
    };
    let (models, _) = tobj::load_obj_buf(&mut &*file, &options, library).ok()?;
    scan.filled(&models)
}

/// What the lines of an ordinary file say without their numbers.
#[derive(Default)]
struct Scan {
    /// With parts that have no corners yet.
    statements: Statements,
    /// How many `v`, `vt` and `vn` there are so far.
    counts: [u32; 3],
    /// The highest reference to each.
    highest: [u32; 3],
    /// Which of the three every corner has; no corner so far if it has no `v`.
    form: [bool; 3],
    /// Whether an `o`, a `g` or another material stands behind the last face.
    is_cut: bool,
}

impl Scan {
    fn new(file: &[u8]) -> Option<Self> {
        let mut scan = Self {
            is_cut: true,
            ..Self::default()
        };
        scan.statements.begin();
        for line in file.split(|&byte| byte == b'\n') {
            scan.add(line.strip_suffix(b"\r").unwrap_or(line))?;
        }
        let follows = |(highest, count): (&u32, &u32)| highest <= count;
        let all_follow = scan.highest.iter().zip(&scan.counts).all(follows);
        (all_follow && scan.form[0]).then_some(scan)
    }

    /// Takes in a line; `None` if it is not ordinary.
    fn add(&mut self, line: &[u8]) -> Option<()> {
        let is_ordinary = |&byte: &u8| matches!(byte, b'\t' | b' '..=b'~');
        if !line.iter().all(is_ordinary) || line.ends_with(b"\\") {
            return None;
        }
        if line.is_empty() || line[0] == b'#' {
            return Some(());
        }
        if line[0].is_ascii_whitespace() || line.contains(&b'#') {
            return None;
        }
        let (statement, rest) = split_statement(line);
        match statement {
            b"v" => self.add_numbers(0, rest),
            b"vt" => self.add_numbers(1, rest),
            b"vn" => self.add_numbers(2, rest),
            b"f" => self.add_face(rest),
            b"s" => Some(()),
            b"o" | b"g" | b"usemtl" | b"mtllib" if rest.len() <= MAX_NAME => {
                let before = self.statements.material;
                self.statements.add_name(statement, rest);
                let is_name = matches!(statement, b"o" | b"g");
                self.is_cut |= is_name || before != self.statements.material;
                Some(())
            }
            _ => None,
        }
    }

    /// Takes in what stands behind a `v`, a `vt` or a `vn`.
    fn add_numbers(&mut self, kind: usize, rest: &[u8]) -> Option<()> {
        let mut count = 0;
        for word in words(rest) {
            count += 1;
            if !is_ordinary_number(word) {
                return None;
            }
        }
        self.counts[kind] = self.counts[kind].checked_add(1)?;
        (count == 3 || (kind == 1 && count == 2)).then_some(())
    }

    fn add_face(&mut self, rest: &[u8]) -> Option<()> {
        let mut arity = 0;
        for word in words(rest) {
            self.add_corner(word)?;
            arity += 1;
        }
        if arity < 3 {
            return None;
        }
        if self.is_cut {
            self.is_cut = false;
            let part = self.statements.part();
            // A part that goes on later would be several models of `tobj`.
            if !self.statements.parts[part].arities.is_empty() {
                return None;
            }
        }
        self.statements.parts.last_mut()?.arities.push(arity);
        Some(())
    }

    fn add_corner(&mut self, word: &[u8]) -> Option<()> {
        let mut form = [false; 3];
        for (i, part) in word.split(|&byte| byte == b'/').enumerate() {
            let has_part = form.get_mut(i)?;
            if part.is_empty() {
                // Only between two slashes.
                if i != 1 {
                    return None;
                }
                continue;
            }
            *has_part = true;
            let digits = part.strip_prefix(b"-").unwrap_or(part);
            let is_number = digits.len() <= 9 && digits.iter().all(u8::is_ascii_digit);
            let number = std::str::from_utf8(digits).ok().filter(|_| is_number)?;
            let number: u32 = number.parse().ok().filter(|&number| number > 0)?;
            match digits.len() < part.len() {
                true if number > self.counts[i] => return None,
                true => {}
                false => self.highest[i] = self.highest[i].max(number),
            }
        }
        // "1/" is not among the forms that all programs know.
        let has_slash_at_end = word.ends_with(b"/");
        if has_slash_at_end || (self.form[0] && self.form != form) {
            return None;
        }
        self.form = form;
        Some(())
    }

    /// The statements with the numbers of the models that `tobj` made, if they fit.
    fn filled(self, models: &[tobj::Model]) -> Option<Statements> {
        let [_, has_pairs, has_normals] = self.form;
        let mut file = self.statements;
        let mut parts = std::mem::take(&mut file.parts);
        let mut rest = parts.iter_mut();
        for tobj::Model { mesh, .. } in models {
            let count = mesh.indices.len();
            let fits = |has: bool, indices: &[u32]| !has || indices.len() == count;
            if !fits(has_pairs, &mesh.texcoord_indices) || !fits(has_normals, &mesh.normal_indices)
            {
                return None;
            }
            let lengths = [
                file.positions.len(),
                file.texture_coordinates.len(),
                file.normals.len(),
            ];
            let mut first = [0; 3];
            for (first, length) in first.iter_mut().zip(lengths) {
                *first = u32::try_from(length).ok()?.checked_add(1)?;
            }
            let mut place = 0;
            // A model may have several parts, a part has one model.
            while place < count {
                let part: &mut Faces = rest.next()?;
                let end = place
                    + part
                        .arities
                        .iter()
                        .map(|&arity| arity as usize)
                        .sum::<usize>();
                if end > count {
                    return None;
                }
                let corner = |i: usize| {
                    let from = |has: bool, indices: &[u32], first: u32| match has {
                        true => indices[i].checked_add(first),
                        false => Some(0),
                    };
                    Some([
                        from(true, &mesh.indices, first[0])?,
                        from(has_pairs, &mesh.texcoord_indices, first[1])?,
                        from(has_normals, &mesh.normal_indices, first[2])?,
                    ])
                };
                part.corners = (place..end).map(corner).collect::<Option<_>>()?;
                place = end;
            }
            let triples = mesh.positions.as_chunks().0.iter();
            file.positions
                .extend(triples.map(|&xyz| DVec3::from_array(xyz)));
            if has_pairs {
                let pairs = mesh.texcoords.as_chunks().0.iter();
                let pairs = pairs.map(|&uv| DVec2::from_array(uv));
                file.texture_coordinates.extend(pairs);
            }
            if has_normals {
                let triples = mesh.normals.as_chunks().0.iter();
                file.normals
                    .extend(triples.map(|&xyz| DVec3::from_array(xyz)));
            }
        }
        let is_whole = rest.next().is_none();
        file.parts = parts;
        is_whole.then_some(file)
    }
}

/// Whether a word can be no other than a finite number or an error.
fn is_ordinary_number(word: &[u8]) -> bool {
    let mut parts = word.splitn(2, |&byte| matches!(byte, b'e' | b'E'));
    let mantissa = parts.next().unwrap_or_default();
    let exponent = parts.next().unwrap_or_default();
    let exponent = exponent.strip_prefix(b"-").unwrap_or(exponent);
    let exponent = exponent.strip_prefix(b"+").unwrap_or(exponent);
    let of_mantissa = |byte: &u8| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+');
    word.len() <= MAX_NUMBER
        && mantissa.iter().all(of_mantissa)
        && exponent.len() <= 2
        && exponent.iter().all(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::super::lines::read_statements;
    use super::super::model::model_of;
    use super::*;
    use crate::read::uri::Folder;

    /// Checks that both readers give the same model and notes of an ordinary file.
    fn check(file: &[u8], folder: &Path, name: &str) {
        let ordinary = read_ordinary(file).unwrap_or_else(|| panic!("{name} is not ordinary"));
        let by_statements = read_statements(file).unwrap();
        let model = |statements| {
            let made = model_of(statements, Folder::new(folder), "stem");
            let (model, findings) = made.unwrap_or_else(|error| panic!("{name}: {error}"));
            (model, findings.notes)
        };
        let ((one, notes), (other, other_notes)) = (model(ordinary), model(by_statements));
        assert_eq!(notes, other_notes, "{name}");
        assert_eq!(one, other, "{name}");
        // Of zeros the sign counts too.
        let bits = |model: &crate::material::Model| {
            let parts = model.parts.iter();
            let numbers = parts.flat_map(|part| part.mesh().positions());
            let numbers = numbers.flat_map(|p| p.to_array().map(f64::to_bits));
            numbers.collect::<Vec<_>>()
        };
        assert_eq!(bits(&one), bits(&other), "{name}");
    }

    #[test]
    fn both_readers_agree_on_the_plain_files_among_the_fixtures() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
        let mut ordinary = vec![];
        for folder in ["meshes", "text", "access"].map(|folder| root.join(folder)) {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.extension().is_none_or(|extension| extension != "obj") {
                    continue;
                }
                let file = std::fs::read(&path).unwrap();
                let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
                if read_ordinary(&file).is_some() {
                    check(&file, &folder, &name);
                    ordinary.push(name);
                }
            }
        }
        for name in ["quad", "concave", "negative_indices", "six_sides", "groups"] {
            assert!(
                ordinary.iter().any(|ordinary| ordinary == name),
                "{name}: {ordinary:?}"
            );
        }
        for name in [
            "bad_number",
            "lines",
            "alternating_small",
            "latin1",
            "nan_vn",
        ] {
            assert!(ordinary.iter().all(|ordinary| ordinary != name), "{name}");
        }
    }

    #[test]
    fn both_readers_agree_on_random_plain_files() {
        for seed in 0..300 {
            check(
                &random_file(seed),
                "nowhere".as_ref(),
                &format!("file {seed}"),
            );
        }
    }

    fn random_file(seed: u64) -> Vec<u8> {
        let mut state = seed;
        // Knuth's generator of the MMIX (*The Art of Computer Programming* 2, 3.3.4, table 1).
        let mut below = |limit: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005);
            state = state.wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as u32 % limit
        };
        let mut file = String::from("# made for a test\n");
        if below(2) == 0 {
            file += "mtllib gone.mtl\n";
        }
        let [has_pairs, has_normals] = [below(2) == 0, below(2) == 0];
        let end = ["\n", "\r\n"][below(2) as usize];
        let mut counts = [0; 3];
        for part in 0..1 + below(6) {
            for (kind, statement) in ["v", "vt", "vn"].into_iter().enumerate() {
                for _ in 0..3 + below(9) {
                    let words = if kind == 1 { 2 + below(2) } else { 3 };
                    file += statement;
                    for _ in 0..words {
                        let number = f64::from(below(2001)) / 100.0 - 10.0;
                        match below(4) {
                            0 => write!(file, " {number:e}"),
                            1 => write!(file, "\t{:+}", -number),
                            2 => write!(file, " {}", number / 7.0),
                            _ => write!(file, "  -0"),
                        }
                        .unwrap();
                    }
                    file += end;
                    counts[kind] += 1;
                }
            }
            match below(4) {
                0 => writeln!(file, "usemtl m{}", below(100) + 100 * part),
                1 => writeln!(file, "o object {part}\ns off\nusemtl m{}", below(3)),
                2 => writeln!(file, "g group{part}\ns 1"),
                _ => writeln!(file, "o {part}\ng {part} too\nusemtl m one"),
            }
            .unwrap();
            for _ in 0..1 + below(9) {
                file += "f";
                for _ in 0..3 + below(5) {
                    let mut index = |kind: usize| match below(3) {
                        0 => -i64::from(1 + below(counts[kind])),
                        _ => i64::from(1 + below(counts[kind])),
                    };
                    write!(file, " {}", index(0)).unwrap();
                    match (has_pairs, has_normals) {
                        (false, false) => Ok(()),
                        (true, false) => write!(file, "/{}", index(1)),
                        (false, true) => write!(file, "//{}", index(2)),
                        (true, true) => write!(file, "/{}/{}", index(1), index(2)),
                    }
                    .unwrap();
                }
                file += end;
            }
        }
        file.into_bytes()
    }

    #[test]
    fn several_groups_and_materials_in_a_large_file_agree() {
        let mut file = String::from("mtllib gone.mtl\n");
        let side = 60;
        for (x, y) in (0..side * side).map(|i| (i % side, i / side)) {
            writeln!(file, "v {x} {y} {}\nvt 0.{x} 0.{y}", f64::from(x * y).sin()).unwrap();
        }
        for y in 0..side - 1 {
            match y % 6 {
                0 => writeln!(file, "g row {y}\nusemtl m{}", y / 12),
                3 => writeln!(file, "usemtl n{y}"),
                _ => Ok(()),
            }
            .unwrap();
            for x in 0..side - 1 {
                let [a, b] = [y, y + 1].map(|y| y * side + x + 1);
                let [c, d] = [a + 1, b + 1];
                match x % 5 {
                    0 => writeln!(file, "f {a}/{a} {c}/{c} {b}/{b}"),
                    1 => writeln!(file, "f {a}/{a} {c}/{c} {d}/{d} {b}/{b}"),
                    _ => writeln!(file, "f {a}/{a} {c}/{c} {d}/{d} {b}/{b} {a}/{b}"),
                }
                .unwrap();
            }
        }
        check(file.as_bytes(), "nowhere".as_ref(), "large");
    }

    #[test]
    fn what_the_readers_might_understand_differently_is_not_plain() {
        let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
        let is_ordinary = |line: &str| {
            let file = format!("{corners}{line}\nf 1 2 3\n");
            read_ordinary(file.as_bytes()).is_some()
        };
        for line in [
            "",
            "#",
            "# v \\ x",
            "s off",
            "vt 1 2 3",
            "v 1e9 +2 -3.",
            "f -1 -2 -3",
        ] {
            assert!(is_ordinary(line), "{line:?}");
        }
        for line in [
            "v 1 2",
            "v 1 2 3 4",
            "v nan 0 0",
            "v 1e999 0 0",
            "V 1 2 3",
            " v 1 2 3",
            "v 1 2 3 # c",
            "vt 1",
            "vn 1 2",
            "vn 1 2 x",
            "f 1 2",
            "f 1/1 2/1 3/1",
            "f 1/ 2 3",
            "f 0 1 2",
            "f 1 2 4",
            "f -4 1 2",
            "l 1 2",
            "o a\\",
            "o \u{e9}",
            "\u{b}",
            "f 1 2 3\ng a\nf 1 2 3\ng b\nf 1 2 3\ng a",
            "usemtl a\u{0}",
            "f 1 2 3 # c",
            "# c \\",
        ] {
            assert!(!is_ordinary(line), "{line:?}");
        }
        let long = "n".repeat(MAX_NAME);
        assert!(is_ordinary(&format!("o {long}")));
        assert!(!is_ordinary(&format!("o {long}n")));
        assert!(read_ordinary(b"v 0 0 0\n").is_none());
    }
}
