//! One primitive of a glTF mesh: its vertices, its triangles.
//!
//! glTF 2.0, section 3.7.2. Attributes are read as what they mean, whatever they are stored as;
//! `KHR_mesh_quantization` only widens what they may be stored as.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec2, DVec3, DVec4, Vec2, Vec4};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index};

use super::accessor::{Expected, Numbers};
use super::document::Document;
use crate::mesh::{Mesh, Vectors, check_triangles};
use crate::read::normals::replace_zero_normals;
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::run::Run;
use crate::read::{AccessorProblem, ReadError};

const VECTOR: Expected = Expected {
    types: &[Type::Vec3],
    components: &FLOAT_OR_SMALL,
    words: "VEC3 of floats, or of bytes or shorts as KHR_mesh_quantization has it",
};
const TANGENT: Expected = Expected {
    types: &[Type::Vec4],
    components: &FLOAT_OR_SMALL,
    words: "VEC4 of floats, or of bytes or shorts as KHR_mesh_quantization has it",
};
const TEXTURE_COORDINATE: Expected = Expected {
    types: &[Type::Vec2],
    components: &FLOAT_OR_SMALL,
    words: "VEC2 of floats, bytes or shorts",
};
const COLOR: Expected = Expected {
    types: &[Type::Vec3, Type::Vec4],
    components: &[ComponentType::F32, ComponentType::U8, ComponentType::U16],
    words: "VEC3 or VEC4 of floats, unsigned bytes or unsigned shorts",
};
const INDEX: Expected = Expected {
    types: &[Type::Scalar],
    components: &[ComponentType::U8, ComponentType::U16, ComponentType::U32],
    words: "SCALAR of unsigned bytes, shorts or integers",
};
const FLOAT_OR_SMALL: [ComponentType; 5] = [
    ComponentType::F32,
    ComponentType::I8,
    ComponentType::U8,
    ComponentType::I16,
    ComponentType::U16,
];

/// A primitive, and what errors and notes about it need.
pub(super) struct Source<'a> {
    pub(super) document: &'a Document<'a>,
    pub(super) primitive: &'a Primitive,
    /// Such as `meshes[2].primitives[0] (mesh "Wheel")`.
    pub(super) place: String,
    /// Such as `mesh "Wheel"`.
    pub(super) mesh: String,
}

/// The attributes of vertices that a change of shape changes.
pub(super) struct Shape {
    pub(super) positions: Vectors,
    pub(super) normals: Option<Vectors>,
    pub(super) tangents: Option<Vec<DVec4>>,
    /// Whether the triangles have come to face the other way.
    pub(super) mirrored: bool,
    /// Whether all positions and normals were seen to be finite, and the normals not to be zero; then they are of unit
    /// length.
    pub(super) is_sound: bool,
}

/// The triangles of a primitive.
#[derive(Default)]
struct Triangles {
    corners: Vec<[u32; 3]>,
    /// Whether they were seen to use nothing but vertices that are there.
    are_sound: bool,
}

/// Whether something holds of all that several threads look at.
struct Sound(AtomicBool);

impl Default for Sound {
    fn default() -> Self {
        Self(true.into())
    }
}

impl Sound {
    fn and(&self, holds: bool) {
        if !holds {
            self.0.store(false, Ordering::Relaxed);
        }
    }

    fn get(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The mesh of a primitive, its shape changed by `deform`; `None` without triangles.
pub(super) fn read_primitive(
    source: &Source,
    deform: impl FnOnce(&mut Shape) -> Result<(), ReadError>,
    notes: &mut Vec<Note>,
) -> Result<Option<Mesh>, ReadError> {
    if source.attribute(&Semantic::Positions).is_none() {
        let place = source.place.clone();
        add_note(notes, Note::NoPositions { place });
        return Ok(None);
    }
    // In this order, because a count is only proven by the bytes behind it.
    let mut shape = source.shape()?;
    let mut triangles = source.triangles(shape.positions.len(), notes)?;
    if triangles.corners.is_empty() {
        let place = source.place.clone();
        add_note(notes, Note::Empty { place });
        return Ok(None);
    }
    deform(&mut shape)?;
    if shape.mirrored {
        let corners = triangles.corners.iter_mut();
        corners.for_each(|corners| corners.swap(1, 2));
    }
    let vertices = shape.positions.len();
    let wrong = |problem| ReadError::Mesh {
        place: source.place.clone(),
        problem,
    };
    if !triangles.are_sound {
        check_triangles(&triangles.corners, vertices).map_err(wrong)?;
    }
    let mut mesh = if shape.is_sound {
        let (positions, normals) = (shape.positions, shape.normals);
        Mesh::from_vectors(positions, triangles.corners, normals, vec![], None)
    } else {
        let positions = shape.positions.into_doubles();
        let mesh = Mesh::new(positions, triangles.corners).map_err(wrong)?;
        match shape.normals {
            Some(normals) => mesh.with_normals(normals.into_doubles()).map_err(wrong)?,
            None => mesh,
        }
    };
    if let Some(tangents) = shape.tangents {
        mesh = mesh.with_tangents(tangents).map_err(wrong)?;
    }
    let mut sets = 0;
    while let Some(index) = source.attribute(&Semantic::TexCoords(sets)) {
        let name = Semantic::TexCoords(sets).to_string();
        let set = source.texture_coordinates(index, &name, vertices)?;
        mesh = mesh.with_texture_coordinates(set).map_err(wrong)?;
        sets += 1;
    }
    if let Some(index) = source.attribute(&Semantic::Colors(0)) {
        let colors = source.colors(index, vertices)?;
        // Checked before they are clamped, which would make a number of NaN.
        mesh = mesh.with_colors(colors).map_err(wrong)?;
        mesh = clamp_colors(mesh, source, notes).map_err(wrong)?;
    }
    source.note_attributes(sets, notes);
    let (mesh, replaced) = match shape.is_sound {
        true => (mesh, 0),
        false => replace_zero_normals(mesh),
    };
    if replaced > 0 {
        let note = Note::Normals {
            mesh: source.mesh.clone(),
            count: replaced,
        };
        add_note(notes, note);
    }
    Ok(Some(mesh))
}

impl Source<'_> {
    /// The accessor of an attribute, if the primitive has it.
    pub(super) fn attribute(&self, semantic: &Semantic) -> Option<Index<Accessor>> {
        let attributes = &self.primitive.attributes;
        attributes.get(&Checked::Valid(semantic.clone())).copied()
    }

    /// The numbers of an accessor that has to have one element for each vertex.
    pub(super) fn numbers(
        &self,
        index: Index<Accessor>,
        expected: &Expected,
        name: &str,
        vertices: usize,
    ) -> Result<Numbers, ReadError> {
        let place = self.check_count(index, name, vertices)?;
        self.document.numbers(index, expected, &place)
    }

    /// What `make` makes of the elements of an accessor that has to have one for each vertex.
    fn elements<T: Copy + Default + Send, const N: usize>(
        &self,
        index: Index<Accessor>,
        expected: &Expected,
        name: &str,
        vertices: usize,
        make: impl Fn([f64; N]) -> T + Sync,
    ) -> Result<Vec<T>, ReadError> {
        let place = self.check_count(index, name, vertices)?;
        self.document.elements(index, expected, &place, make)
    }

    /// Before reading, because it may be a count that no memory has room for; the place for further errors.
    fn check_count(
        &self,
        index: Index<Accessor>,
        name: &str,
        vertices: usize,
    ) -> Result<String, ReadError> {
        let place = format!("{}, {name}", self.place);
        let found = self.document.count(index);
        if found != vertices {
            return Err(ReadError::Accessor {
                place,
                accessor: index.value(),
                problem: AccessorProblem::Count {
                    found,
                    expected: vertices,
                },
            });
        }
        Ok(place)
    }

    /// Vectors for all vertices.
    pub(super) fn vectors(
        &self,
        index: Index<Accessor>,
        name: &str,
        vertices: usize,
    ) -> Result<Vec<DVec3>, ReadError> {
        self.elements(index, &VECTOR, name, vertices, DVec3::from_array)
    }

    /// Vectors for all vertices, in the precision of the file, and whether `is_sound` holds for all of them.
    fn checked_vectors(
        &self,
        index: Index<Accessor>,
        name: &str,
        vertices: usize,
        is_sound: impl Fn(DVec3) -> bool + Sync,
    ) -> Result<(Vectors, bool), ReadError> {
        let place = self.check_count(index, name, vertices)?;
        let of_single = |numbers: [f32; 3]| is_sound(DVec3::from_array(numbers.map(f64::from)));
        if let Some((singles, are_sound)) =
            self.document.singles(index, &VECTOR, &place, of_single)?
        {
            return Ok((Vectors::single(singles), are_sound));
        }
        let vectors = self
            .document
            .elements(index, &VECTOR, &place, DVec3::from_array)?;
        let are_sound = vectors.iter().all(|&vector| is_sound(vector));
        Ok((vectors.into(), are_sound))
    }

    /// Texture coordinates for all vertices.
    fn texture_coordinates(
        &self,
        index: Index<Accessor>,
        name: &str,
        vertices: usize,
    ) -> Result<Vec<Vec2>, ReadError> {
        let place = self.check_count(index, name, vertices)?;
        let document = self.document;
        if let Some((pairs, _)) =
            document.singles(index, &TEXTURE_COORDINATE, &place, |_: [f32; 2]| true)?
        {
            // In place: they are the same bytes.
            return Ok(pairs.into_iter().map(Vec2::from_array).collect());
        }
        let pair = |uv: [f64; 2]| DVec2::from_array(uv).as_vec2();
        document.elements(index, &TEXTURE_COORDINATE, &place, pair)
    }

    /// Colours for all vertices.
    fn colors(&self, index: Index<Accessor>, vertices: usize) -> Result<Vec<Vec4>, ReadError> {
        let full = self.full_scale(index);
        match self.document.root.accessors[index.value()].type_ {
            Checked::Valid(Type::Vec3) => {
                let make = |c: [f64; 3]| color([c[0], c[1], c[2], full], full);
                self.elements(index, &COLOR, "COLOR_0", vertices, make)
            }
            _ => {
                let make = |c: [f64; 4]| color(c, full);
                self.elements(index, &COLOR, "COLOR_0", vertices, make)
            }
        }
    }

    /// Positions, normals and tangents as they are stored.
    fn shape(&self) -> Result<Shape, ReadError> {
        let mut is_sound = self.is_rigid();
        let mut positions = Vectors::default();
        if let Some(index) = self.attribute(&Semantic::Positions) {
            let accessor = &self.document.root.accessors[index.value()];
            if accessor.buffer_view.is_none() && accessor.sparse.is_none() {
                return Err(ReadError::Accessor {
                    place: format!("{}, POSITION", self.place),
                    accessor: index.value(),
                    problem: AccessorProblem::AllZeros,
                });
            }
            let count = self.document.count(index);
            let (read, are_finite) =
                self.checked_vectors(index, "POSITION", count, |p| p.is_finite())?;
            is_sound &= are_finite;
            positions = read;
        }
        let mut normals = None;
        if let Some(index) = self.attribute(&Semantic::Normals) {
            let count = positions.len();
            // Of any other the length is neither zero nor infinite.
            let has_direction = |n: DVec3| n.is_finite() && n != DVec3::ZERO;
            let (read, are_directions) =
                self.checked_vectors(index, "NORMAL", count, has_direction)?;
            is_sound &= are_directions;
            normals = Some(match is_sound {
                true => read.into_directions(),
                false => read,
            });
        }
        let tangents = self
            .attribute(&Semantic::Tangents)
            .map(|index| {
                let (count, make) = (positions.len(), DVec4::from_array);
                self.elements(index, &TANGENT, "TANGENT", count, make)
            })
            .transpose()?;
        Ok(Shape {
            positions,
            normals,
            tangents,
            mirrored: false,
            is_sound,
        })
    }

    /// Whether nothing will change the shape.
    fn is_rigid(&self) -> bool {
        self.primitive.targets.is_none() && self.attribute(&Semantic::Joints(0)).is_none()
    }

    fn triangles(&self, vertices: usize, notes: &mut Vec<Note>) -> Result<Triangles, ReadError> {
        if vertices == 0 {
            return Ok(Triangles::default());
        }
        let mode = self.primitive.mode.unwrap();
        let indices: Vec<u32> = match self.primitive.indices {
            Some(index) => {
                if mode == Mode::Triangles
                    && let Some(corners) = self.plain_triangles(index, vertices)?
                {
                    let are_sound = true;
                    return Ok(Triangles { corners, are_sound });
                }
                self.indices(index, vertices, notes)?
            }
            None => (0..u32::try_from(vertices).unwrap_or(u32::MAX)).collect(),
        };
        let left_over = indices.len() % 3;
        if mode == Mode::Triangles && left_over > 0 {
            let note = Note::LeftOver {
                place: self.place.clone(),
                count: left_over,
            };
            add_note(notes, note);
        }
        Ok(Triangles {
            corners: triangles(mode, &indices),
            are_sound: false,
        })
    }

    /// Triangles that are stored one after another and all use vertices that are there; if they are not,
    /// [`indices`](Self::indices) or the mesh will say what is wrong.
    fn plain_triangles(
        &self,
        index: Index<Accessor>,
        vertices: usize,
    ) -> Result<Option<Vec<[u32; 3]>>, ReadError> {
        let place = format!("{}, indices", self.place);
        let Some(run) = self.document.plain(index, &INDEX, &place)? else {
            return Ok(None);
        };
        if run.stride != run.size || run.count % 3 != 0 {
            return Ok(None);
        }
        let of_three = Run {
            stride: 3 * run.size,
            size: 3 * run.size,
            count: run.count / 3,
            ..run
        };
        if run.size == 4 {
            // No index has the largest number, which is reserved.
            let limit = u32::try_from(vertices).unwrap_or(u32::MAX);
            let is_there = |corners: [u32; 3]| corners.iter().all(|&index| index < limit);
            let (corners, are_there) = of_three.words(u32::from_le_bytes, is_there)?;
            return Ok(are_there.then_some(corners));
        }
        let (vertices, sound) = (vertices as u64, Sound::default());
        let checked = |corners: [u32; 3], restart: u32| {
            let limit = vertices.min(restart.into());
            sound.and(corners.iter().all(|&index| u64::from(index) < limit));
            corners
        };
        let corners = match run.size {
            1 => of_three.map(|bytes| {
                let corners = std::array::from_fn(|i| bytes[i].into());
                checked(corners, u8::MAX.into())
            }),
            _ => of_three.map(|bytes| {
                let words = bytes.as_chunks().0;
                let corners = std::array::from_fn(|i| u16::from_le_bytes(words[i]).into());
                checked(corners, u16::MAX.into())
            }),
        }?;
        Ok(sound.get().then_some(corners))
    }

    /// The indices, one by one. The largest number of their type begins a new strip in some programs and is reserved in
    /// glTF; where there is a vertex of that number, its writer meant it.
    fn indices(
        &self,
        index: Index<Accessor>,
        vertices: usize,
        notes: &mut Vec<Note>,
    ) -> Result<Vec<u32>, ReadError> {
        let place = format!("{}, indices", self.place);
        let numbers = self.document.numbers(index, &INDEX, &place)?;
        let component = self.document.root.accessors[index.value()].component_type;
        let restart = match component.unwrap().0 {
            ComponentType::U8 => u32::from(u8::MAX),
            ComponentType::U16 => u32::from(u16::MAX),
            _ => u32::MAX,
        };
        let indices: Vec<u32> = numbers.values.iter().map(|&i| i as u32).collect();
        let Some(position) = indices.iter().position(|&i| i == restart) else {
            return Ok(indices);
        };
        if vertices as u64 <= restart.into() {
            return Err(ReadError::Accessor {
                place,
                accessor: index.value(),
                problem: AccessorProblem::Restart {
                    position,
                    index: restart,
                },
            });
        }
        let note = Note::LastIndex {
            place: self.place.clone(),
            index: restart,
            count: indices.iter().filter(|&&i| i == restart).count(),
        };
        add_note(notes, note);
        Ok(indices)
    }

    /// What the largest integer of a colour has to be divided by: glTF wants colours normalized, so
    /// those that do not say so are meant to be.
    fn full_scale(&self, index: Index<Accessor>) -> f64 {
        let accessor = &self.document.root.accessors[index.value()];
        match accessor.component_type.unwrap().0 {
            ComponentType::U8 if !accessor.normalized => 255.0,
            ComponentType::U16 if !accessor.normalized => 65535.0,
            _ => 1.0,
        }
    }

    /// Names the attributes that are left behind.
    fn note_attributes(&self, texture_coordinate_sets: u32, notes: &mut Vec<Note>) {
        let left = |semantic: &Checked<Semantic>| match semantic {
            Checked::Valid(Semantic::Extras(_)) => true,
            Checked::Valid(Semantic::Colors(set)) => *set > 0,
            Checked::Valid(Semantic::TexCoords(set)) => *set >= texture_coordinate_sets,
            _ => false,
        };
        let names: Vec<String> = self
            .primitive
            .attributes
            .keys()
            .filter(|semantic| left(semantic))
            .map(ToString::to_string)
            .collect();
        if !names.is_empty() {
            let mesh = self.mesh.clone();
            add_note(notes, Note::Attributes { mesh, names });
        }
    }
}

/// Triangles, strips and fans as triangles of their own. In a strip two equal indices only lead on to
/// the next piece of it, and the triangles that they make are left out.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let windows = indices.windows(3);
    let is_open = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    match mode {
        Mode::Triangles => indices.as_chunks().0.to_vec(),
        Mode::TriangleStrip => windows
            .zip([false, true].into_iter().cycle())
            .map(|(w, is_odd)| match is_odd {
                false => [w[0], w[1], w[2]],
                true => [w[0], w[2], w[1]],
            })
            .filter(is_open)
            .collect(),
        Mode::TriangleFan => windows
            .map(|w| [w[1], w[2], indices[0]])
            .filter(is_open)
            .collect(),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => vec![],
    }
}

fn color(components: [f64; 4], full: f64) -> Vec4 {
    Vec4::from_array(components.map(|component| (component / full) as f32))
}

fn clamp_colors(
    mesh: Mesh,
    source: &Source,
    notes: &mut Vec<Note>,
) -> Result<Mesh, crate::mesh::MeshError> {
    let colors = mesh.colors().unwrap_or_default();
    let clamp = |color: Vec4| color.clamp(Vec4::ZERO, Vec4::ONE);
    let count = colors.iter().filter(|&&c| clamp(c) != c).count();
    if count == 0 {
        return Ok(mesh);
    }
    let note = Note::ColorsClamped {
        mesh: source.mesh.clone(),
        count,
    };
    add_note(notes, note);
    let clamped = colors.iter().copied().map(clamp).collect();
    mesh.with_colors(clamped)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The orders that glTF 2.0 gives in section 3.7.2.1.
    #[test]
    fn strips_and_fans_wind_as_gltf_says() {
        let indices = [10, 11, 12, 13, 14];
        assert_eq!(
            triangles(Mode::TriangleStrip, &indices),
            [[10, 11, 12], [11, 13, 12], [12, 13, 14]]
        );
        assert_eq!(
            triangles(Mode::TriangleFan, &indices),
            [[11, 12, 10], [12, 13, 10], [13, 14, 10]]
        );
        assert_eq!(triangles(Mode::Triangles, &indices), [[10, 11, 12]]);
        assert!(triangles(Mode::TriangleStrip, &[0, 1]).is_empty());
    }

    #[test]
    fn a_stitched_strip_loses_its_stitches_and_keeps_its_winding() {
        // Two squares, stitched by repeating the last index and the first.
        let indices = [0, 1, 2, 3, 3, 4, 4, 5, 6, 7];
        assert_eq!(
            triangles(Mode::TriangleStrip, &indices),
            [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]]
        );
    }
}
