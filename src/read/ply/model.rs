//! A PLY file as a model of one part.

use glam::{DVec2, DVec3, DVec4};

use super::data::{Data, Values};
use super::header::{Element, read_header};
use crate::material::Model;
use crate::mesh::MeshError;
use crate::read::far::checked;
use crate::read::note::{Note, plural};
use crate::read::surface::Surface;
use crate::read::text::{as_bytes_of_ascii, without_mark};
use crate::read::{DataProblem, Findings, ReadError};

/// Names of a vertex's two texture coordinates.
const TEXTURE_COORDINATES: [[&str; 2]; 4] = [
    ["s", "t"],
    ["u", "v"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
];
/// Names of a vertex's colour, and of its opacity.
const COLORS: [([&str; 3], &str); 3] = [
    (["red", "green", "blue"], "alpha"),
    (
        ["diffuse_red", "diffuse_green", "diffuse_blue"],
        "diffuse_alpha",
    ),
    (["r", "g", "b"], "a"),
];
/// Names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Ends a strip of triangles.
const END_OF_STRIP: f64 = -1.0;

/// Reads the bytes of a PLY file; its part is called `name`.
pub(in crate::read) fn read_ply(bytes: &[u8], name: &str) -> Result<(Model, Findings), ReadError> {
    let bytes = as_bytes_of_ascii(without_mark(bytes));
    let bytes = without_mark(&bytes);
    let header = read_header(bytes)?;
    let mut notes = vec![];
    let mut surface = Surface::default();
    let vertices = header.elements.iter().find(|e| e.name == "vertex");
    let count = vertices.map_or(0, |vertices| vertices.count);
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let place = format!("part {name:?}");
    let wrong = |problem| ReadError::Mesh {
        place: place.clone(),
        problem,
    };
    if count > u32::MAX as usize {
        return Err(wrong(MeshError::TooManyVertices(count)));
    }
    let mut data = Data::new(bytes, &header);
    let mut extra = 0;
    for element in &header.elements {
        let corners = element.find(&CORNERS, true);
        match (element.name.as_str(), corners) {
            ("vertex", _) => {
                let vertices = Vertices::of(element)?;
                vertices.reserve(count, &mut surface);
                data.each(element, None, |values| {
                    extra += values.extra;
                    vertices.take(element, values, &mut surface)
                })?;
                note_others(element, &vertices.used(), &mut notes);
            }
            ("face", Some(list)) => {
                data.each(element, Some(list), |values| {
                    extra += values.extra;
                    for &corner in &values.list {
                        surface.polygons.add_corner(vertex(corner, count)?);
                    }
                    surface.polygons.end(values.list.len());
                    Ok(())
                })?;
                note_others(element, &[list], &mut notes);
            }
            ("tristrips", Some(list)) => {
                data.each(element, Some(list), |values| {
                    for strip in values.list.split(|&corner| corner == END_OF_STRIP) {
                        add_strip(strip, count, &mut surface)?;
                    }
                    Ok(())
                })?;
                note_others(element, &[list], &mut notes);
            }
            _ => {
                data.skip(element)?;
                if element.count > 0 {
                    let what = format!("element {:?} ({})", element.name, element.count);
                    notes.push(Note::NotCarried { what });
                }
            }
        }
    }
    if extra > 0 {
        notes.push(Note::PassedOver {
            what: "numbers behind those of an element",
            count: extra,
            first_line: None,
        });
    }
    if data.left() > 0 {
        let what = format!("{} behind the last element", plural(data.left(), "byte"));
        notes.push(Note::NotCarried { what });
    }
    let of_surface = surface.into_part(name.to_owned(), &mut notes);
    let Some(part) = of_surface.map_err(wrong)? else {
        let skipped: String = notes.iter().map(|note| format!("; {note}")).collect();
        let vertices = plural(count, "vertex");
        let instead = match header
            .elements
            .iter()
            .any(|e| e.name == "face" && e.count > 0)
        {
            true => format!("{vertices}{skipped}"),
            false => format!(
                "{vertices} and no faces: a cloud of points has no surface, MeshLab makes one of it{skipped}"
            ),
        };
        return Err(ReadError::NoTriangles { instead });
    };
    let model = Model {
        parts: vec![part],
        ..Model::default()
    };
    let files = vec![];
    Ok((checked(model)?, Findings { notes, files }))
}

/// Which properties of a vertex are which attributes.
struct Vertices {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    /// With the value that is full light.
    color: Option<([usize; 3], f64)>,
    opacity: Option<(usize, f64)>,
    texture_coordinates: Option<[usize; 2]>,
}

impl Vertices {
    fn of(element: &Element) -> Result<Self, ReadError> {
        fn all<const N: usize>(element: &Element, names: [&str; N]) -> Option<[usize; N]> {
            let mut found = [0; N];
            for (found, name) in found.iter_mut().zip(names) {
                *found = element.find(&[name], false)?;
            }
            Some(found)
        }
        let position = all(element, ["x", "y", "z"]).ok_or(DataProblem::Missing {
            missing: "x, y and z",
            expected: "three properties of these names in the element \"vertex\"",
        });
        let full = |index: usize| element.properties[index].value.full();
        let color = COLORS.iter().find_map(|&(names, opacity)| {
            let color = all(element, names)?;
            let opacity = element.find(&[opacity], false);
            Some((color, opacity))
        });
        Ok(Self {
            position: position.map_err(ReadError::Data)?,
            normal: all(element, ["nx", "ny", "nz"]),
            color: color.map(|(color, _)| (color, full(color[0]))),
            opacity: color
                .and_then(|(_, opacity)| opacity)
                .map(|opacity| (opacity, full(opacity))),
            texture_coordinates: TEXTURE_COORDINATES
                .into_iter()
                .find_map(|names| all(element, names)),
        })
    }

    /// The numbers of the properties that are read.
    fn used(&self) -> Vec<usize> {
        let color = self.color.map(|(color, _)| color);
        let triples = [Some(self.position), self.normal, color];
        let opacity = self.opacity.map(|(opacity, _)| opacity);
        let pairs = self.texture_coordinates.into_iter().flatten();
        triples
            .into_iter()
            .flatten()
            .flatten()
            .chain(opacity)
            .chain(pairs)
            .collect()
    }

    fn reserve(&self, count: usize, surface: &mut Surface) {
        let if_any = |has: bool| if has { count } else { 0 };
        surface.positions.reserve_exact(count);
        surface.normals.reserve_exact(if_any(self.normal.is_some()));
        surface.colors.reserve_exact(if_any(self.color.is_some()));
        let has_pairs = self.texture_coordinates.is_some();
        let pairs = &mut surface.texture_coordinates;
        pairs.reserve_exact(if_any(has_pairs));
    }

    fn take(
        &self,
        element: &Element,
        values: &Values,
        surface: &mut Surface,
    ) -> Result<(), DataProblem> {
        let value = |index: usize| {
            let value = values.single[index];
            match value.is_finite() {
                true => Ok(value),
                false => Err(DataProblem::NotFinite {
                    property: element.properties[index].name.clone(),
                    found: value.to_string(),
                }),
            }
        };
        let triple = |[x, y, z]: [usize; 3]| Ok(DVec3::new(value(x)?, value(y)?, value(z)?));
        surface.positions.push(triple(self.position)?);
        if let Some(normal) = self.normal {
            // Some programs write NaN where they know no normal.
            surface.normals.push(triple(normal).unwrap_or(DVec3::ZERO));
        }
        if let Some((color, full)) = self.color {
            let rgb = triple(color)? / full;
            let opacity = match self.opacity {
                Some((index, full)) => value(index)? / full,
                None => 1.0,
            };
            surface.colors.push(DVec4::from((rgb, opacity)));
        }
        if let Some([u, v]) = self.texture_coordinates {
            let pair = DVec2::new(value(u)?, value(v)?);
            surface.texture_coordinates.push(pair);
        }
        Ok(())
    }
}

/// The vertex of a corner.
fn vertex(corner: f64, vertices: usize) -> Result<u32, DataProblem> {
    if corner >= 0.0 && corner < vertices as f64 && corner.fract() == 0.0 {
        return Ok(corner as u32);
    }
    let found = corner.to_string();
    Err(DataProblem::Corner { found, vertices })
}

/// Adds the triangles of a strip; every second one is wound the other way.
fn add_strip(strip: &[f64], vertices: usize, surface: &mut Surface) -> Result<(), DataProblem> {
    let mut corners = [0; 3];
    for (i, &corner) in strip.iter().enumerate() {
        corners = [corners[1], corners[2], vertex(corner, vertices)?];
        let [a, b, c] = corners;
        match i {
            0 | 1 => {}
            _ if i % 2 == 0 => surface.polygons.add_triangle([a, b, c]),
            _ => surface.polygons.add_triangle([b, a, c]),
        }
    }
    Ok(())
}

/// Names the properties of an element that are not read.
fn note_others(element: &Element, used: &[usize], notes: &mut Vec<Note>) {
    let properties = element.properties.iter().enumerate();
    let others = properties.filter(|(i, _)| !used.contains(i));
    let names: Vec<String> = others.map(|(_, other)| other.name.clone()).collect();
    if !names.is_empty() && element.count > 0 {
        let mesh = format!("element {:?}", element.name);
        notes.push(Note::Attributes { mesh, names });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of one polygon, colours in bytes, in text; the last property of a vertex is not read.
    const TEXT: &str = "ply\nformat ascii 1.0\ncomment c\nobj_info o\nelement vertex 4\nproperty double x\n\
        property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        property uchar alpha\nproperty float s\nproperty float t\nproperty float nx\nproperty float ny\n\
        property float nz\nproperty short quality\nelement face 1\nproperty list uchar int vertex_indices\n\
        property list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n\
        0.1 0 0 255 0 51 255 0.25 0.75 0 0 1 5\n1 0 0 255 0 51 255 0.25 0.75 0 0 1 5\n\
        1 1 0 255 0 51 255 0.25 0.75 0 0 nan 5\n0 1 0 255 0 51 0 0.25 0.75 0 0 1 -5\n4 0 1 2 3 1 0.5\n7\n";

    fn read(file: &[u8]) -> (Model, Vec<String>) {
        let (model, findings) = read_ply(file, "stem").unwrap();
        (
            model,
            findings.notes.iter().map(ToString::to_string).collect(),
        )
    }

    fn message(file: &str) -> String {
        read_ply(file.as_bytes(), "stem").unwrap_err().to_string()
    }

    /// The same file in binary.
    fn binary(is_big: bool) -> Vec<u8> {
        let order = if is_big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let (header, data) = TEXT.split_once("end_header\n").unwrap();
        let mut file = format!("{}end_header\n", header.replace("ascii", order)).into_bytes();
        let mut put = |mut bytes: Vec<u8>| {
            if is_big {
                bytes.reverse();
            }
            file.extend(bytes);
        };
        for line in data.lines() {
            let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            for (i, &number) in numbers.iter().enumerate() {
                put(match (numbers.len(), i) {
                    (13, 0) => number.to_le_bytes().to_vec(),
                    (13, 3..7) | (7, 0 | 5) => vec![number as u8],
                    (13, 12) => (number as i16).to_le_bytes().to_vec(),
                    (7, 1..5) | (1, _) => (number as i32).to_le_bytes().to_vec(),
                    _ => (number as f32).to_le_bytes().to_vec(),
                });
            }
        }
        file
    }

    #[test]
    fn the_three_encodings_hold_the_same() {
        let (model, notes) = read(TEXT.as_bytes());
        let mesh = model.parts[0].mesh();
        assert_eq!(model.parts[0].name, "stem");
        assert_eq!(mesh.positions()[0], DVec3::new(0.1, 0.0, 0.0));
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.normals().unwrap(), [DVec3::Z; 4]);
        let color = mesh.colors().unwrap()[3].to_array();
        let fifth = crate::effects::linear_of_srgb(0.2) as f32;
        assert_eq!(color, [1.0, 0.0, fifth, 0.0]);
        assert_eq!(mesh.texture_coordinates()[0][0].to_array(), [0.25, 0.25]);
        assert_eq!(
            notes,
            [
                "element \"vertex\": quality not copied",
                "element \"face\": texcoord not copied",
                "element \"edge\" (1): not copied",
                "part \"stem\": 1 zero normal replaced by that of an adjacent triangle",
                "vertex colours: taken as sRGB, made linear",
            ]
        );
        let same = (model, notes);
        assert_eq!(read(&binary(false)), same);
        assert_eq!(read(&binary(true)), same);
        let utf_16 = TEXT.encode_utf16().flat_map(u16::to_le_bytes);
        assert_eq!(read(&utf_16.collect::<Vec<u8>>()), same);
        for ends in [
            TEXT.replace('\n', "\r\n"),
            TEXT.replace('\n', "\r"),
            format!("\u{feff}{}", TEXT.trim_end()),
        ] {
            assert_eq!(read(ends.as_bytes()), same);
        }
        let mut longer = binary(true);
        longer.push(0);
        assert_eq!(
            read(&longer).1[3],
            "1 byte behind the last element: not copied"
        );
    }

    #[test]
    fn strips_are_wound_alternately_and_end_at_minus_one() {
        let (model, _) = read(
            b"ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nelement vertex 4\n\
              property float x\nproperty float y\nproperty float z\nend_header\n9 0 1 2 3 -1 3 1 0 -1\n\
              0 0 0\n1 0 0\n0 1 0\n1 1 0\n",
        );
        // Without normals each triangle has vertices of its own.
        let place = |i: usize| model.parts[0].mesh().positions()[i].truncate().to_array();
        let places: Vec<[f64; 2]> = (0..9).map(place).collect();
        let [a, b, c, d] = [[0., 0.], [1., 0.], [0., 1.], [1., 1.]];
        assert_eq!(places, [a, b, c, c, b, d, d, b, a]);
    }

    #[test]
    fn errors_name_the_line_or_the_element() {
        let data = |from: &str, to: &str| message(&TEXT.replacen(from, to, 1));
        assert!(data("property double x", "property double X").contains("no x, y and z"));
        assert_eq!(
            data("\n1 1 0", "\n1 nan 0"),
            "line 27: y is NaN, expected a finite number"
        );
        assert_eq!(
            data("\n1 1 0", "\n1 one 0"),
            "line 27: \"one\", expected a number"
        );
        assert_eq!(
            data("4 0 1 2 3", "4 0 1 2 4"),
            "line 29: a corner at vertex 4, expected one of the 4 vertices, from 0"
        );
        assert_eq!(
            data("4 0 1 2 3", "4 0 1 2 -1"),
            "line 29: a corner at vertex -1, expected one of the 4 vertices, from 0"
        );
        assert_eq!(
            data("4 0 1 2 3", "4 0 1 2 2.5"),
            "line 29: a corner at vertex 2.5, expected one of the 4 vertices, from 0"
        );
        assert_eq!(
            data("4 0 1 2 3 1 0.5", "4 0 1 2"),
            "line 29: 4 numbers, expected one for vertex_indices too"
        );
        assert_eq!(
            data("4 0 1 2 3", "-4 0 1 2 3"),
            "line 29: a list of -4 values, expected a whole number that is not negative"
        );
        assert_eq!(
            data("4 0 1 2 3 1 0.5\n7\n", ""),
            "the file ends, expected face 0 of 1"
        );
        let (_, notes) = read(TEXT.replacen("0 0 1 -5", "0 0 1 -5 6", 1).as_bytes());
        assert!(
            notes.contains(&"numbers behind those of an element: ignored once".to_owned()),
            "{notes:?}"
        );
    }

    #[test]
    fn a_binary_element_that_is_wrong_is_named() {
        let mut file = binary(false);
        let length = file.len();
        // The last corner of the face: 5 bytes of its other list and 4 of the edge follow.
        file[length - 13] = 200;
        let error = read_ply(&file, "a").unwrap_err().to_string();
        assert_eq!(
            error,
            "face 0: a corner at vertex 200, expected one of the 4 vertices, from 0"
        );
        // A list longer than the file, with the length in one byte.
        file[length - 26] = 255;
        let error = read_ply(&file, "a").unwrap_err().to_string();
        assert_eq!(error, "face 0: the file ends, expected 1020 bytes, not 25");
    }

    #[test]
    fn a_cloud_of_points_is_told_from_a_surface() {
        let (header, _) = TEXT.split_once("element face").unwrap();
        let (_, data) = TEXT.split_once("end_header\n").unwrap();
        let file = format!(
            "{header}end_header\n{}",
            data.split_once("\n4 0").unwrap().0
        );
        let found = message(&file);
        assert!(
            found
                .contains("the file has 4 vertices and no faces: a cloud of points has no surface"),
            "{found}"
        );
    }
}
