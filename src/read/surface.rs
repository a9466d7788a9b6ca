//! One surface of shared vertices, as PLY, STL and OFF files have it.

use glam::{DVec2, DVec3, DVec4};

use super::normals::replace_zero_normals;
use super::note::Note;
use super::polygon::triangles;
use super::vertex::{clamped_colors, texture_coordinate};
use crate::material::Part;
use crate::mesh::{Mesh, MeshError};

/// Vertices, and polygons between them. An attribute has one value for each vertex, or none at all.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Surface {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    /// Red, green and blue in sRGB, and opacity, all from 0 to 1.
    pub(super) colors: Vec<DVec4>,
    /// From the lower left corner of an image.
    pub(super) texture_coordinates: Vec<DVec2>,
    pub(super) polygons: Polygons,
}

/// Polygons of three corners or more.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Polygons {
    /// The vertices of all polygons, one polygon after the other.
    corners: Vec<u32>,
    /// How many corners each polygon has.
    arities: Vec<u32>,
    /// How many had fewer than three corners.
    empty: usize,
}

impl Polygons {
    /// The polygon whose corners were added since the last one.
    pub(super) fn end(&mut self, arity: usize) {
        if arity < 3 {
            self.corners.truncate(self.corners.len() - arity);
            self.empty += 1;
        } else {
            self.arities.push(arity as u32);
        }
    }

    pub(super) fn add_corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    pub(super) fn add_triangle(&mut self, corners: [u32; 3]) {
        self.corners.extend(corners);
        self.arities.push(3);
    }

    pub(super) fn note(&self, notes: &mut Vec<Note>) {
        let count = self.empty;
        if count > 0 {
            notes.push(Note::EmptyFaces { count });
        }
    }
}

impl Surface {
    /// The surface as a part; `None` if no triangle is left of it.
    ///
    /// Triangles with two corners at one vertex and vertices of no triangle are left out: the first have no area, the
    /// others would be part of the bounds.
    pub(super) fn into_part(
        self,
        name: String,
        notes: &mut Vec<Note>,
    ) -> Result<Option<Part>, MeshError> {
        self.polygons.note(notes);
        let Polygons {
            corners, arities, ..
        } = self.polygons;
        let mut triangles = triangles(&arities, &corners, &self.positions);
        drop((corners, arities));
        let all = triangles.len();
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        let count = all - triangles.len();
        if count > 0 {
            notes.push(Note::EqualCorners { count });
        }
        if triangles.is_empty() {
            return Ok(None);
        }
        let kept = used_vertices(&mut triangles, self.positions.len());
        let count = self.positions.len() - kept.len();
        if count > 0 {
            notes.push(Note::UnusedVertices { count });
        }
        let mut mesh = Mesh::new(pick(self.positions, &kept), triangles)?;
        let place = || format!("part {name:?}");
        let normals = pick(self.normals, &kept);
        // All zero is none at all.
        if normals.iter().any(|&normal| normal != DVec3::ZERO) {
            let (repaired, count) = replace_zero_normals(mesh.with_normals(normals)?);
            mesh = repaired;
            if count > 0 {
                let mesh = place();
                notes.push(Note::Normals { mesh, count });
            }
        }
        let pairs = pick(self.texture_coordinates, &kept);
        if !pairs.is_empty() {
            mesh = mesh.with_texture_coordinates(pairs.iter().map(texture_coordinate).collect())?;
        }
        let colors = pick(self.colors, &kept);
        if !colors.is_empty() {
            notes.push(Note::ColorsFromSrgb);
            let (colors, count) = clamped_colors(colors.into_iter());
            if count > 0 {
                let mesh = place();
                notes.push(Note::ColorsClamped { mesh, count });
            }
            mesh = mesh.with_colors(colors)?;
        }
        Part::new(name, mesh, None).map(Some)
    }
}

/// The vertices that triangles use, in their order; the triangles then number these.
fn used_vertices(triangles: &mut [[u32; 3]], count: usize) -> Vec<u32> {
    const UNUSED: u32 = u32::MAX;
    let mut numbers = vec![UNUSED; count];
    for &corner in triangles.iter().flatten() {
        numbers[corner as usize] = 0;
    }
    let mut kept = vec![];
    for (vertex, number) in (0..).zip(&mut numbers) {
        if *number != UNUSED {
            *number = kept.len() as u32;
            kept.push(vertex);
        }
    }
    if kept.len() < count {
        for corner in triangles.iter_mut().flatten() {
            *corner = numbers[*corner as usize];
        }
    }
    kept
}

/// The values of some vertices, in their order; nothing of nothing.
fn pick<T: Copy>(values: Vec<T>, kept: &[u32]) -> Vec<T> {
    if values.is_empty() || values.len() == kept.len() {
        return values;
    }
    kept.iter().map(|&vertex| values[vertex as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Surface {
        let places = [(9, 9), (0, 0), (1, 0), (1, 1), (0, 1), (7, 7)];
        let place = |&(x, y): &(i32, i32)| DVec3::new(f64::from(x), f64::from(y), 0.0);
        let mut surface = Surface {
            positions: places.iter().map(place).collect(),
            ..Surface::default()
        };
        for corner in [1, 2, 3, 4] {
            surface.polygons.add_corner(corner);
        }
        surface.polygons.end(4);
        surface
    }

    #[test]
    fn polygons_become_triangles_and_unused_vertices_are_left_out() {
        let mut surface = square();
        surface.texture_coordinates = vec![DVec2::new(0.5, 0.25); 6];
        surface.normals = vec![DVec3::X; 6];
        surface.normals[3] = DVec3::ZERO;
        surface.colors = vec![DVec4::new(0.5, 2.0, 0.0, 0.5); 6];
        surface.polygons.add_triangle([1, 1, 2]);
        surface.polygons.add_corner(1);
        surface.polygons.end(1);
        let mut notes = vec![];
        let part = surface.into_part("a".into(), &mut notes).unwrap().unwrap();
        let mesh = part.mesh();
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.bounds().unwrap().1, DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(
            mesh.normals().unwrap(),
            [DVec3::X, DVec3::X, DVec3::Z, DVec3::X]
        );
        assert_eq!(mesh.texture_coordinates()[0][0].to_array(), [0.5, 0.75]);
        let [r, g, b, a] = mesh.colors().unwrap()[0].to_array();
        assert!((r - 0.214_041).abs() < 1e-6);
        assert_eq!([g, b, a], [1.0, 0.0, 0.5]);
        let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
        assert_eq!(
            notes,
            [
                "1 face of fewer than three corners skipped",
                "1 triangle with two corners at one vertex skipped",
                "2 vertices of no triangle skipped",
                "part \"a\": 1 zero normal replaced by that of an adjacent triangle",
                "vertex colours: taken as sRGB, made linear",
                "part \"a\": 4 colours outside 0 to 1 clamped",
            ]
        );
    }

    #[test]
    fn nothing_but_triangles_without_area_is_no_part() {
        let mut surface = Surface {
            positions: vec![DVec3::ZERO; 3],
            ..Surface::default()
        };
        surface.polygons.add_triangle([1, 1, 2]);
        assert_eq!(surface.into_part("a".into(), &mut vec![]).unwrap(), None);
    }
}
