//! An STL file as a model: every solid becomes a part.

use std::collections::HashMap;

use super::binary::{is_exactly_binary, read_binary};
use super::text::{is_text, read_text};
use crate::material::Model;
use crate::read::far::checked;
use crate::read::names::tell_apart;
use crate::read::note::{Note, plural};
use crate::read::text::shown;
use crate::read::{Findings, ReadError};

/// Whether a file of so many bytes that starts so is an STL file.
pub(in crate::read) fn is_stl(start: &[u8], length: usize) -> bool {
    is_exactly_binary(start, length) || is_text(start)
}

/// Reads the bytes of an STL file; solids without a name are called `name`.
///
/// A file whose length is that of as many facets as it declares is binary, whatever it begins with; else it is text if it
/// begins with the word `solid`.
pub(in crate::read) fn read_stl(bytes: &[u8], name: &str) -> Result<(Model, Findings), ReadError> {
    let mut notes = vec![];
    let solids = match !is_exactly_binary(bytes, bytes.len()) && is_text(bytes) {
        true => read_text(bytes)?,
        false => read_binary(bytes, &mut notes)?,
    };
    let count = solids.len();
    let mut named: HashMap<String, Vec<usize>> = HashMap::new();
    for (i, solid) in solids.iter().enumerate() {
        let own = shown(&solid.name);
        let name = if own.is_empty() { name } else { &own };
        named.entry(name.to_owned()).or_default().push(i);
    }
    let mut names = vec![String::new(); count];
    for (name, members) in named {
        let apart = tell_apart(&name, &vec![None; members.len()]);
        for (i, name) in members.into_iter().zip(apart) {
            names[i] = name;
        }
    }
    let mut parts = vec![];
    for (solid, name) in solids.into_iter().zip(names) {
        let mesh = format!("part {name:?}");
        let count = solid.contradictions;
        if count > 0 {
            let mesh = mesh.clone();
            notes.push(Note::FacetNormals { mesh, count });
        }
        let part = solid.surface.into_part(name, &mut notes);
        let part = part.map_err(|problem| ReadError::Mesh {
            place: mesh.clone(),
            problem,
        })?;
        if part.is_none() {
            notes.push(Note::Empty { place: mesh });
        }
        parts.extend(part);
    }
    if parts.is_empty() {
        let skipped: String = notes.iter().map(|note| format!("; {note}")).collect();
        let instead = format!("{}{skipped}", plural(count, "solid"));
        return Err(ReadError::NoTriangles { instead });
    }
    let model = Model {
        parts,
        ..Model::default()
    };
    let files = vec![];
    Ok((checked(model)?, Findings { notes, files }))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Facets in binary, with two spare bytes each.
    fn binary(start: &[u8], facets: &[[f32; 12]], spare: u16) -> Vec<u8> {
        let mut file = start.to_vec();
        file.resize(80, b' ');
        file.extend((facets.len() as u32).to_le_bytes());
        for facet in facets {
            file.extend(facet.iter().flat_map(|number| number.to_le_bytes()));
            file.extend(spare.to_le_bytes());
        }
        file
    }

    /// Two facets of a square; -0 and 0 are one place.
    const SQUARE: [[f32; 12]; 2] = [
        [0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 1., 0.],
        [0., 0., 1., -0., 0., 0., 1., 1., -0., 0., 1., 0.],
    ];

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

    fn read(file: &[u8]) -> (Model, Vec<String>) {
        let (model, findings) = read_stl(file, "stem").unwrap();
        (
            model,
            findings.notes.iter().map(ToString::to_string).collect(),
        )
    }

    fn message(file: &[u8]) -> String {
        read_stl(file, "stem").unwrap_err().to_string()
    }

    #[test]
    fn a_binary_file_may_begin_as_text_does() {
        for start in [&b"solid cube"[..], b"", b"\0\0"] {
            let file = binary(start, &SQUARE, 0);
            assert!(is_stl(&file[..84], file.len()));
            let (model, notes) = read(&file);
            let mesh = model.parts[0].mesh();
            assert_eq!(
                (model.parts[0].name.as_str(), mesh.triangles().len()),
                ("stem", 2)
            );
            assert_eq!(mesh.normals().unwrap(), [DVec3::Z; 6]);
            assert_eq!(notes, [""; 0]);
        }
        // Spare bytes and bytes behind the facets are told of.
        let mut file = binary(b"", &SQUARE, 0x8001);
        file.push(0);
        assert_eq!(
            read(&file).1,
            [
                "the two spare bytes of 2 facets, which some programs use for colours: not copied",
                "1 byte behind the last facet: not copied"
            ]
        );
    }

    #[test]
    fn corners_at_one_place_are_one_vertex_and_what_has_no_area_is_left_out() {
        let mut facets = SQUARE.to_vec();
        // Against its corners; without area.
        facets[1][2] = -1.0;
        facets.push([0., 0., 1., 0., 0., 0., -0., 0., 0., 1., 1., 0.]);
        let mut solid = super::super::solid::Solid::default();
        for facet in &facets {
            let [normal, corners @ ..] =
                [0, 3, 6, 9].map(|i| DVec3::from_array([0, 1, 2].map(|k| facet[i + k].into())));
            solid.add(normal, &corners);
        }
        assert_eq!(solid.surface.positions.len(), 4);
        assert_eq!(
            read(&binary(b"", &facets, 0)).1,
            [
                "part \"stem\": 1 facet normal against the order of the corners ignored",
                "1 triangle with two corners at one vertex skipped"
            ]
        );
    }

    #[test]
    fn text_is_read_as_programs_write_it() {
        let (model, notes) = read(
            format!("\u{feff}  SOLID a b\n{FACET}endsolid a b\r\n\r\nsolid\n{FACET}{FACET}endsolid\nsolid a b\n{FACET}")
                .as_bytes(),
        );
        let names: Vec<&str> = model.parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["a b_1", "stem", "a b_2"]);
        assert_eq!(model.parts[1].mesh().triangles().len(), 2);
        assert_eq!(notes, [""; 0]);
        // Other letters, tabs, polygons, 64 bits, no space behind the word, UTF-16.
        let text = "solid\nFacet Normal\nOUTER LOOP\n\tVERTEX 0.1 0 0\nvertex\t1 0 0\nvertex 1 1 0\nvertex 0 1e0 0\n\
                    endloop\nendfacet\nendsolid";
        for file in [
            text.as_bytes().to_vec(),
            text.encode_utf16().flat_map(u16::to_be_bytes).collect(),
        ] {
            let mesh = read(&file).0;
            assert_eq!(mesh.triangle_count(), 2);
            assert_eq!(mesh.bounds().unwrap().0, DVec3::ZERO);
            assert_eq!(mesh.parts[0].mesh().positions()[0].x, 0.1);
        }
    }

    #[test]
    fn errors_name_the_line_or_the_facet() {
        let mut square = SQUARE;
        square[1][5] = f32::NAN;
        let cut = &binary(b"", &SQUARE, 0)[..150];
        let many = [&[b' '; 80][..], &[0xff; 4], &[0; 100]].concat();
        for (file, words) in [
            (
                &b""[..],
                "0 facet elements need at least 84 bytes, but 0 are left",
            ),
            (b"solids\n", "need at least 84 bytes"),
            (
                cut,
                "2 facet elements need at least 184 bytes, but 150 are left: the file is cut off",
            ),
            (
                &many,
                "4294967295 facet elements need at least 214748364834 bytes, but 184",
            ),
            (
                &binary(b"", &square, 0),
                "facet 1: a corner is [-0, 0, NaN], expected a finite number",
            ),
            (
                b"solid\n",
                "no triangles, expected at least one; the file has 1 solid; part \"stem\": has no triangles, skipped",
            ),
            (
                b"solid\nfacet normal 0 0 1\nvertex 0 0\n",
                "line 3: 2 numbers, expected three coordinates",
            ),
            (
                b"solid\nfacet normal 0 0 1\nvertex 0 0 inf\n",
                "line 3: \"inf\", expected a finite number",
            ),
            (
                b"solid\nfacet normal 0 0 1\n\n",
                "line 2: the file ends, expected endfacet",
            ),
            (
                b"solid\nvertex 0 0 1\n",
                "line 2: \"vertex\", expected facet, solid or endsolid",
            ),
            (
                b"solid\nfacet\nfacet\n",
                "line 3: \"facet\", expected outer loop, vertex",
            ),
            (
                b"solid\nfacet\nendfacet\n",
                "line 3: 0 numbers, expected three corners",
            ),
            (b"solid\ncube\n", "line 2: \"cube\", expected solid, facet"),
        ] {
            let found = message(file);
            assert!(found.contains(words), "{found}\n{words}");
        }
    }
}
