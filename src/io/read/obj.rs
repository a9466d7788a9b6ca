//! An OBJ file as a model: every group with a material becomes a part.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec4};
use tobj::LoadOptions;

use super::materials::Fitted;
use super::mtl::read_library;
use super::mtl_map::Pictures;
use super::names::tell_apart;
use super::normals::replace_zero_normals;
use super::note::{Note, add_note, plural};
use super::obj_lines::{Prepared, prepare};
use super::polygon::triangulate;
use super::uri::Folder;
use super::{Findings, ReadError, checked};
use crate::mesh::{Material, Mesh, MeshError, Model, Part};

/// Reads the bytes of an OBJ file; libraries and textures are looked for in `folder`, and parts without a
/// group are called `default_name`.
pub(super) fn read_obj_bytes(
    bytes: &[u8],
    folder: Folder,
    default_name: &str,
) -> Result<(Model, Findings), ReadError> {
    let prepared = prepare(&String::from_utf8_lossy(bytes))?;
    let mut notes = vec![];
    note_other_content(&prepared, &mut notes);
    let libraries = RefCell::new(Libraries {
        materials: vec![],
        pictures: Pictures::new(&folder),
        notes,
        problem: None,
    });
    let options = LoadOptions {
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
        ..LoadOptions::default()
    };
    let loaded = tobj::load_obj_buf(&mut prepared.text.as_bytes(), &options, |library| {
        Ok(libraries.borrow_mut().load(library))
    });
    let (models, _) = loaded.map_err(ReadError::Obj)?;
    let Libraries {
        materials,
        mut notes,
        problem,
        ..
    } = libraries.into_inner();
    problem.map_or(Ok(()), Err)?;
    note_unknown_materials(&prepared, &materials, &mut notes);

    let models: Vec<tobj::Model> = models
        .into_iter()
        .filter(|m| !m.mesh.indices.is_empty())
        .collect();
    let material_of = |model: &tobj::Model| materials.get(model.mesh.material_id?).cloned();
    let names = part_names(&models, default_name, material_of);
    let mut fitted = Fitted::default();
    let mut parts = vec![];
    for (model, name) in models.iter().zip(names) {
        let mesh = make_mesh(&model.mesh, &prepared, &name, &mut notes);
        let part = mesh.and_then(|mesh| {
            let sets = mesh.texture_coordinates().len();
            let place = format!("part {name:?}");
            let material = material_of(model);
            let material = material.map(|m| fitted.fit(&m, &place, sets, &mut notes));
            Part::new(name.clone(), mesh, material)
        });
        parts.push(part.map_err(|problem| ReadError::Mesh {
            place: format!("part {name:?}"),
            problem,
        })?);
    }
    if parts.is_empty() {
        let skipped: String = notes.iter().map(|note| format!("; {note}")).collect();
        let instead = match prepared.empty_faces {
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

fn note_other_content(prepared: &Prepared, notes: &mut Vec<Note>) {
    let count = prepared.points_and_lines;
    if count > 0 {
        let place = "the file".to_owned();
        add_note(notes, Note::PointsAndLines { place, count });
    }
    let count = prepared.empty_faces;
    if count > 0 {
        add_note(notes, Note::EmptyFaces { count });
    }
    if prepared.curves > 0 {
        let what = plural(prepared.curves, "free-form curve or surface");
        add_note(notes, Note::NotCarried { what });
    }
    if prepared.has_colors {
        add_note(notes, Note::ColorsFromSrgb);
    }
}

/// The material libraries of a file.
struct Libraries<'a> {
    materials: Vec<Arc<Material>>,
    pictures: Pictures<'a>,
    notes: Vec<Note>,
    /// The first that `tobj` has no way to pass on.
    problem: Option<ReadError>,
}

impl Libraries<'_> {
    /// Reads the libraries that one `mtllib` names: one whose name may have spaces, or several. Also tells
    /// `tobj` the names of their materials, which is all it needs.
    fn load(&mut self, names: &Path) -> (Vec<tobj::Material>, HashMap<String, usize>) {
        let folder = self.pictures.files.path();
        let names = names.to_string_lossy().replace('\\', "/");
        let paths = match folder.join(&names).exists() {
            true => vec![folder.join(&names)],
            false => names
                .split_whitespace()
                .map(|name| folder.join(name))
                .collect(),
        };
        let mut new = vec![];
        for path in paths {
            match read_library(&path, &mut self.pictures, &mut self.notes) {
                Ok(materials) => new.extend(materials),
                Err(problem) => self.problem = self.problem.take().or(Some(problem)),
            }
        }
        let named = |material: &Material| tobj::Material {
            name: material.name().unwrap_or_default().to_owned(),
            ..tobj::Material::default()
        };
        let stand_ins: Vec<tobj::Material> = new.iter().map(named).collect();
        let names = stand_ins.iter().map(|material| material.name.clone());
        let by_name = names.enumerate().map(|(i, name)| (name, i)).collect();
        self.materials.extend(new.into_iter().map(Arc::new));
        (stand_ins, by_name)
    }
}

fn note_unknown_materials(prepared: &Prepared, materials: &[Arc<Material>], notes: &mut Vec<Note>) {
    let known: HashSet<&str> = materials.iter().filter_map(|m| m.name()).collect();
    for name in &prepared.materials {
        if !known.contains(name.as_str()) {
            let name = name.clone();
            add_note(notes, Note::UnknownMaterial { name });
        }
    }
}

/// The names of groups, told apart where `usemtl` splits them.
fn part_names(
    models: &[tobj::Model],
    default_name: &str,
    material_of: impl Fn(&tobj::Model) -> Option<Arc<Material>>,
) -> Vec<String> {
    let name = |model: &tobj::Model| match model.name.as_str() {
        "" | "unnamed_object" => default_name.to_owned(),
        name => name.to_owned(),
    };
    let mut groups: HashMap<String, Vec<usize>> = HashMap::new();
    for (i, model) in models.iter().enumerate() {
        groups.entry(name(model)).or_default().push(i);
    }
    let mut names = vec![String::new(); models.len()];
    for (name, members) in groups {
        let materials: Vec<Option<String>> = members
            .iter()
            .map(|&i| material_of(&models[i])?.name().map(str::to_owned))
            .collect();
        for (i, name) in members.into_iter().zip(tell_apart(&name, &materials)) {
            names[i] = name;
        }
    }
    names
}

fn make_mesh(
    source: &tobj::Mesh,
    prepared: &Prepared,
    part: &str,
    notes: &mut Vec<Note>,
) -> Result<Mesh, MeshError> {
    let positions = vectors(&source.positions);
    let triangles = triangles(source, &positions);
    let mut mesh = Mesh::new(positions, triangles)?;
    let normals = vectors(&source.normals);
    // All zero is the substitute for none at all.
    if normals.iter().any(|&normal| normal != DVec3::ZERO) {
        let (repaired, count) = replace_zero_normals(mesh.with_normals(normals)?);
        mesh = repaired;
        if count > 0 {
            let mesh = format!("part {part:?}");
            add_note(notes, Note::Normals { mesh, count });
        }
    }
    let missing = source
        .texcoords
        .chunks_exact(2)
        .filter(|uv| uv[0].is_nan())
        .count();
    if missing < source.texcoords.len() / 2 {
        if missing > 0 {
            let part = part.to_owned();
            let count = missing;
            add_note(notes, Note::TextureCoordinates { part, count });
        }
        let pairs = source.texcoords.chunks_exact(2);
        mesh = mesh.with_texture_coordinates(pairs.map(texture_coordinate).collect())?;
    }
    if prepared.has_colors {
        let colors = vectors(&source.vertex_color);
        let outside = |c: &&DVec3| c.clamp(DVec3::ZERO, DVec3::ONE) != **c;
        let count = colors.iter().filter(outside).count();
        if count > 0 {
            let mesh = format!("part {part:?}");
            add_note(notes, Note::ColorsClamped { mesh, count });
        }
        mesh = mesh.with_colors(colors.into_iter().map(linear_color).collect())?;
    }
    Ok(mesh)
}

fn vectors(numbers: &[f64]) -> Vec<DVec3> {
    numbers.chunks_exact(3).map(DVec3::from_slice).collect()
}

/// The faces of a part as triangles.
fn triangles(source: &tobj::Mesh, positions: &[DVec3]) -> Vec<[u32; 3]> {
    // Without arities all faces are triangles.
    if source.face_arities.is_empty() {
        return source.indices.as_chunks().0.to_vec();
    }
    let mut rest = source.indices.as_slice();
    let mut triangles = vec![];
    for &arity in &source.face_arities {
        let (face, others) = rest.split_at(arity as usize);
        rest = others;
        let corners: Vec<DVec3> = face.iter().map(|&i| positions[i as usize]).collect();
        let of_face = triangulate(&corners);
        triangles.extend(of_face.into_iter().map(|corners| corners.map(|i| face[i])));
    }
    triangles
}

/// OBJ counts v from the lower edge of an image, glTF from the upper one.
fn texture_coordinate(uv: &[f64]) -> Vec2 {
    match uv[0].is_nan() {
        true => Vec2::ZERO,
        false => Vec2::new(uv[0] as f32, (1.0 - uv[1]) as f32),
    }
}

/// Programs that write colours of vertices into OBJ files write them as on the screen, in sRGB (IEC
/// 61966-2-1).
fn linear_color(srgb: DVec3) -> Vec4 {
    let linear = |c: f64| match c {
        c if c <= 0.04045 => c / 12.92,
        c => ((c + 0.055) / 1.055).powf(2.4),
    };
    let clamped = srgb.clamp(DVec3::ZERO, DVec3::ONE);
    let [r, g, b] = clamped.to_array().map(|c| linear(c) as f32);
    Vec4::new(r, g, b, 1.0)
}

#[cfg(test)]
mod tests {
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
