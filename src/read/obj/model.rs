//! An OBJ file as a model: every group with a material becomes a part.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde_json::json;

use super::lines::{Faces, Statements, read_statements};
use super::mtl::read_library;
use super::mtl_map::Pictures;
use super::ordinary::read_ordinary;
use crate::material::{Material, Model, Part};
use crate::mesh::{Mesh, MeshError};
use crate::read::far::checked;
use crate::read::find::{find, slashed};
use crate::read::fitted::Fitted;
use crate::read::names::tell_apart;
use crate::read::normals::replace_zero_normals;
use crate::read::note::Note;
use crate::read::polygon::triangles;
use crate::read::text::{shown, unquoted};
use crate::read::uri::Folder;
use crate::read::vertex::{clamped_colors, texture_coordinate};
use crate::read::{Findings, ReadError};

/// Bytes of a name that parts get at most: where a material of every part is behind it, the file has it once and
/// the model as many times as there are parts.
const MAX_NAME: usize = 500;

/// Reads the bytes of an OBJ file; libraries and textures are looked for in `folder`, and parts without a
/// group are called `default_name`.
pub(in crate::read) fn read_obj_bytes(
    bytes: &[u8],
    folder: Folder,
    default_name: &str,
) -> Result<(Model, Findings), ReadError> {
    let file = match read_ordinary(bytes) {
        Some(file) => file,
        None => read_statements(bytes)?,
    };
    model_of(file, folder, default_name)
}

/// The model that statements make.
pub(super) fn model_of(
    mut file: Statements,
    folder: Folder,
    default_name: &str,
) -> Result<(Model, Findings), ReadError> {
    let mut notes = vec![];
    file.note(&mut notes);
    let mut libraries = Libraries::new(&folder, notes);
    for names in &file.libraries.all {
        libraries.load(&shown(names))?;
    }
    let materials = libraries.used_by(&file)?;
    let mut notes = libraries.notes;

    let mut fitted = Fitted::default();
    let mut parts = vec![];
    let faces = std::mem::take(&mut file.parts);
    let names = part_names(&faces, default_name, &file, &mut notes);
    for (faces, name) in faces.into_iter().zip(names) {
        // No part has the same notes as another.
        let mut of_part = vec![];
        let place = format!("part {name:?}");
        let mesh = make_mesh(&faces, &file, &name, &mut of_part);
        let part = mesh.and_then(|mesh| {
            let sets = mesh.texture_coordinates().len();
            let material = faces.material.map(|index| &materials[index as usize]);
            let material = material.map(|m| fitted.fit(m, &place, sets, &mut of_part));
            Part::new(name, mesh, material)
        });
        parts.push(part.map_err(|problem| ReadError::Mesh { place, problem })?);
        notes.append(&mut of_part);
    }
    if parts.is_empty() {
        let skipped: String = notes.iter().map(|note| format!("; {note}")).collect();
        let instead = match file.empty_faces {
            0 => format!("no faces{skipped}"),
            _ => format!("none of three corners or more{skipped}"),
        };
        return Err(ReadError::NoTriangles { instead });
    }
    let files = folder.into_opened();
    let model = Model {
        parts,
        ..Model::default()
    };
    Ok((checked(model)?, Findings { notes, files }))
}

/// The material libraries of a file.
struct Libraries<'a> {
    pictures: Pictures<'a>,
    notes: Vec<Note>,
    /// Libraries that have been read: a file may name one many times.
    known: HashSet<PathBuf>,
    /// By their names in the bytes of the libraries, and as they are shown; the last of each.
    by_bytes: HashMap<Vec<u8>, Arc<Material>>,
    by_text: HashMap<String, Arc<Material>>,
}

impl<'a> Libraries<'a> {
    fn new(folder: &'a Folder<'a>, notes: Vec<Note>) -> Self {
        Self {
            pictures: Pictures::new(folder),
            notes,
            known: HashSet::new(),
            by_bytes: HashMap::new(),
            by_text: HashMap::new(),
        }
    }

    /// Reads the libraries that one `mtllib` names: one whose name may have spaces, or several.
    fn load(&mut self, names: &str) -> Result<(), ReadError> {
        let files = self.pictures.files;
        let whole = unquoted(names);
        let as_named = files.path().join(slashed(whole));
        if files.place_of(&as_named).is_some() {
            return self.load_one(whole);
        }
        let words = || names.split_ascii_whitespace().map(unquoted);
        let are_libraries = words().all(|word| word.to_ascii_lowercase().ends_with(".mtl"));
        match are_libraries && words().count() > 1 {
            true => words().try_for_each(|word| self.load_one(word)),
            false => self.load_one(whole),
        }
    }

    fn load_one(&mut self, name: &str) -> Result<(), ReadError> {
        let files = self.pictures.files;
        let path = find(files, files.path(), name, &mut self.notes);
        // One file can be named in many ways.
        let file = files.place_of(&path).unwrap_or_else(|| path.clone());
        if !self.known.insert(file) {
            return Ok(());
        }
        let materials = read_library(&path, &mut self.pictures, &mut self.notes)?;
        for (name, material) in materials {
            let material = Arc::new(material);
            self.by_text
                .insert(shown(&name).into_owned(), material.clone());
            self.by_bytes.insert(name, material);
        }
        Ok(())
    }

    /// The materials that a file uses, in their order; those that no library defines have only a name.
    fn used_by(&mut self, file: &Statements) -> Result<Vec<Arc<Material>>, ReadError> {
        let mut materials = vec![];
        for name in &file.materials.all {
            if let Some(material) = self.find(name) {
                materials.push(material);
                continue;
            }
            let name = shown(name).into_owned();
            let material = Material::new(json!({ "name": name }), vec![]);
            let material = material.map_err(|problem| ReadError::Material {
                place: format!("material {name:?}"),
                problem,
            })?;
            self.notes.push(Note::UnknownMaterial { name });
            materials.push(Arc::new(material));
        }
        Ok(materials)
    }

    fn find(&self, name: &[u8]) -> Option<Arc<Material>> {
        let text = shown(name);
        let found = self.by_bytes.get(name);
        let found = found.or_else(|| self.by_text.get(&*text));
        // Some names are followed by a comment.
        let cut = || self.by_text.get(text.split_once(" #")?.0.trim_end());
        found.or_else(cut).cloned()
    }
}

/// The names of groups, told apart where `usemtl` splits them.
fn part_names(
    parts: &[Faces],
    default_name: &str,
    file: &Statements,
    notes: &mut Vec<Note>,
) -> Vec<String> {
    let mut groups: HashMap<u32, Vec<usize>> = HashMap::new();
    for (i, part) in parts.iter().enumerate() {
        groups.entry(part.name).or_default().push(i);
    }
    let mut count = 0;
    let mut cut = |name: &str| {
        let mut end = name.len().min(MAX_NAME);
        while !name.is_char_boundary(end) {
            end -= 1;
        }
        count += usize::from(end < name.len());
        name[..end].to_owned()
    };
    let mut names = vec![String::new(); parts.len()];
    for (name, members) in groups {
        let name = match &file.names.all[name as usize][..] {
            b"" => default_name.to_owned(),
            name => cut(&shown(name)),
        };
        let material = |&i: &usize| {
            let index = parts[i].material?;
            Some(cut(&shown(&file.materials.all[index as usize])))
        };
        let materials: Vec<Option<String>> = match members.len() {
            1 => vec![None],
            _ => members.iter().map(material).collect(),
        };
        for (i, name) in members.into_iter().zip(tell_apart(&name, &materials)) {
            names[i] = name;
        }
    }
    if count > 0 {
        let limit = MAX_NAME;
        notes.push(Note::NamesCut { count, limit });
    }
    names
}

fn make_mesh(
    faces: &Faces,
    file: &Statements,
    part: &str,
    notes: &mut Vec<Note>,
) -> Result<Mesh, MeshError> {
    let (vertices, indices) = vertices(&faces.corners);
    let positions: Vec<DVec3> = vertices
        .iter()
        .map(|&[v, ..]| file.positions[v as usize - 1])
        .collect();
    let triangles = triangles(&faces.arities, &indices, &positions);
    let mut mesh = Mesh::new(positions, triangles)?;
    let normal = |&[.., vn]: &[u32; 3]| match vn {
        0 => DVec3::ZERO,
        vn => file.normals[vn as usize - 1],
    };
    let normals: Vec<DVec3> = vertices.iter().map(normal).collect();
    // All zero is none at all.
    if normals.iter().any(|&normal| normal != DVec3::ZERO) {
        let (repaired, count) = replace_zero_normals(mesh.with_normals(normals)?);
        mesh = repaired;
        if count > 0 {
            let mesh = format!("part {part:?}");
            notes.push(Note::Normals { mesh, count });
        }
    }
    let pair = |&[_, vt, _]: &[u32; 3]| match vt {
        0 => DVec2::NAN,
        vt => file.texture_coordinates[vt as usize - 1],
    };
    let pairs: Vec<DVec2> = vertices.iter().map(pair).collect();
    let count = pairs.iter().filter(|pair| pair.is_nan()).count();
    if count < pairs.len() {
        if count > 0 {
            let part = part.to_owned();
            notes.push(Note::TextureCoordinates { part, count });
        }
        mesh = mesh.with_texture_coordinates(pairs.iter().map(texture_coordinate).collect())?;
    }
    if !file.colors.is_empty() {
        let colors = vertices.iter().map(|&[v, ..]| file.colors[v as usize - 1]);
        let (colors, count) = clamped_colors(colors.map(|color| color.extend(1.0)));
        if count > 0 {
            let mesh = format!("part {part:?}");
            notes.push(Note::ColorsClamped { mesh, count });
        }
        mesh = mesh.with_colors(colors)?;
    }
    Ok(mesh)
}

/// The different corners, in the order of their first use, and which of them each corner is.
fn vertices(corners: &[[u32; 3]]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut numbers = HashMap::new();
    let mut vertices = vec![];
    let number = |&corner: &[u32; 3]| {
        *numbers.entry(corner).or_insert_with(|| {
            vertices.push(corner);
            vertices.len() as u32 - 1
        })
    };
    let indices = corners.iter().map(number).collect();
    (vertices, indices)
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec4};

    use super::*;

    fn read(file: &str) -> (Model, Vec<Note>) {
        let read = read_obj_bytes(file.as_bytes(), Folder::new("nowhere".as_ref()), "stem");
        let (model, findings) = read.unwrap();
        (model, findings.notes)
    }

    const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

    #[test]
    fn a_part_without_normals_gets_flat_ones_though_others_have_some() {
        let file = format!("{CORNERS}vn 0 0 -1\ng a\nf 1 2 3\ng b\nf 1//1 2//1 3//1\n");
        let (model, notes) = read(&file);
        assert_eq!(model.parts[0].mesh().normals().unwrap(), [DVec3::Z; 3]);
        assert_eq!(model.parts[1].mesh().normals().unwrap(), [DVec3::NEG_Z; 3]);
        assert!(notes.is_empty());
    }

    #[test]
    fn corners_without_what_others_have_are_filled_and_noted() {
        let file = format!("{CORNERS}vt 0.25 0.25\nvn 1 0 0\nf 1/1/1 2 3/1/1\n");
        let (model, notes) = read(&file);
        let mesh = model.parts[0].mesh();
        assert_eq!(mesh.normals().unwrap(), [DVec3::X, DVec3::Z, DVec3::X]);
        assert_eq!(
            mesh.texture_coordinates()[0][..],
            [Vec2::new(0.25, 0.75), Vec2::ZERO, Vec2::new(0.25, 0.75)]
        );
        assert_eq!(notes.len(), 2);
        assert_eq!(model.parts[0].name, "stem");
    }

    #[test]
    fn colours_of_some_vertices_stay_with_them() {
        let (model, notes) = read("v 0 0 0\nv 1 0 0 0.5 0 1\nv 0 1 0\nf 1 2 3\n");
        let colors = model.parts[0].mesh().colors().unwrap();
        assert_eq!(colors[0], Vec4::ONE);
        assert!((colors[1].x - 0.214_041).abs() < 1e-6);
        assert_eq!((colors[1].y, colors[1].z), (0.0, 1.0));
        assert_eq!(notes, [Note::ColorsFromSrgb]);
    }

    #[test]
    fn a_line_of_three_points_is_no_triangle() {
        let file = format!("{CORNERS}l 1 2 3\n");
        let error =
            read_obj_bytes(file.as_bytes(), Folder::new("nowhere".as_ref()), "stem").unwrap_err();
        assert_eq!(
            error.to_string(),
            "no triangles, expected at least one; the file has no faces; \
             the file: 1 primitive of points or lines skipped"
        );
    }
}
