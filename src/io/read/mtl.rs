//! Material libraries of OBJ files.
//!
//! Source: *MTL material format*, Wavefront Advanced Visualizer. Only what [`Material`] has room for is
//! read; `tobj` panics on colours of fewer than three numbers, so that every line is checked first.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use super::materials::{make_image, reason};
use super::note::{Note, add_note};
use super::uri::Folder;
use crate::mesh::{AlphaMode, Image, Material, Sampler, Texture};

/// The materials of a library, with their textures; none where it cannot be read.
pub(super) fn read_library(path: &Path, files: &Folder, notes: &mut Vec<Note>) -> Vec<Material> {
    let bytes = match files.read(path, u64::MAX) {
        Ok(bytes) => bytes,
        Err(error) => {
            let path = path.to_owned();
            let reason = reason(&error);
            add_note(notes, Note::MaterialLibrary { path, reason });
            return vec![];
        }
    };
    let (text, malformed) = sound_lines(&String::from_utf8_lossy(&bytes));
    if !malformed.is_empty() {
        let note = Note::MaterialLines {
            path: path.to_owned(),
            lines: malformed,
        };
        add_note(notes, note);
    }
    let Ok((materials, _)) = tobj::load_mtl_buf(&mut text.as_bytes()) else {
        let note = Note::MaterialLibrary {
            path: path.to_owned(),
            reason: "not as MTL has it".to_owned(),
        };
        add_note(notes, note);
        return vec![];
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let make = |material: &tobj::Material| make_material(material, folder, files, notes);
    materials.iter().map(make).collect()
}

/// The lines that make sense, and the numbers of those that do not.
fn sound_lines(text: &str) -> (String, Vec<usize>) {
    let mut sound = String::new();
    let mut malformed = vec![];
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        let (statement, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let mut words = rest.split_whitespace();
        let mut number = || {
            words
                .next()
                .is_some_and(|word| word.parse::<f64>().is_ok_and(f64::is_finite))
        };
        let makes_sense = match statement {
            "Kd" => number() && number() && number(),
            "Ns" | "d" | "Tr" => number(),
            "newmtl" | "map_Kd" => !rest.trim().is_empty(),
            // Only named in a note.
            "Ke" | "map_Ks" | "map_Ke" | "map_Bump" | "map_bump" | "bump" | "map_d" | "norm"
            | "disp" => {
                sound += &format!("left_{statement} 1\n");
                continue;
            }
            _ => continue,
        };
        if makes_sense {
            sound += &format!("{line}\n");
        } else {
            malformed.push(index + 1);
        }
    }
    (sound, malformed)
}

fn make_material(
    source: &tobj::Material,
    folder: &Path,
    files: &Folder,
    notes: &mut Vec<Note>,
) -> Material {
    let left = source.unknown_param.keys();
    let left: BTreeSet<&str> = left.filter_map(|name| name.strip_prefix("left_")).collect();
    if !left.is_empty() {
        let note = Note::Material {
            material: source.name.clone(),
            properties: left.into_iter().map(str::to_owned).collect(),
        };
        add_note(notes, note);
    }
    // Tr, the transparency, is the other way to write d.
    let transparency = source.unknown_param.get("Tr");
    let transparency =
        transparency.and_then(|word| word.split_whitespace().next()?.parse::<f64>().ok());
    let opacity = source.dissolve.or(transparency.map(|t| 1.0 - t));
    let opacity = opacity.unwrap_or(1.0).clamp(0.0, 1.0) as f32;
    let [r, g, b] = source
        .diffuse
        .unwrap_or([1.0; 3])
        .map(|c| c.clamp(0.0, 1.0) as f32);
    let image = source.diffuse_texture.as_ref();
    let image = image.and_then(|words| read_texture(words, folder, files, notes));
    Material {
        name: Some(source.name.clone()),
        base_color: [r, g, b, opacity],
        base_color_texture: image.map(|image| Texture {
            image: Arc::new(image),
            tex_coord: 0,
            sampler: Sampler::default(),
        }),
        metallic: 0.0,
        roughness: source.shininess.map_or(0.9, roughness),
        metallic_roughness_texture: None,
        alpha_mode: if opacity < 1.0 {
            AlphaMode::Blend
        } else {
            AlphaMode::Opaque
        },
        // OBJ says nothing about sides, and viewers of it draw both.
        double_sided: true,
    }
}

/// The roughness of a surface with the specular exponent `Ns`: `alpha^2 = 2 / (Ns + 2)` for the width
/// `alpha` of the distribution of normals (Walter et al., *Microfacet Models for Refraction through Rough
/// Surfaces*, EGSR 2007, section 5.2), and `alpha = roughness^2` in glTF.
fn roughness(shininess: f64) -> f32 {
    (2.0 / (shininess.max(0.0) + 2.0)).powf(0.25) as f32
}

/// The image that `map_Kd` names; its options, which start with a dash, are passed over.
fn read_texture(
    words: &str,
    folder: &Path,
    files: &Folder,
    notes: &mut Vec<Note>,
) -> Option<Image> {
    let name = match words.starts_with('-') {
        true => words.split_whitespace().next_back().unwrap_or_default(),
        false => words,
    };
    // Written on Windows, read everywhere.
    let relative = name.replace('\\', "/");
    let stem = Path::new(&relative).file_stem();
    let stem = stem.map(|stem| stem.to_string_lossy().into_owned());
    let image = files
        .read(&folder.join(&relative), u64::MAX)
        .map_err(|error| reason(&error))
        .and_then(|bytes| make_image(stem, bytes).ok_or_else(|| "neither PNG nor JPEG".to_owned()));
    let dropped = |reason| Note::Image {
        image: format!("{relative:?}"),
        reason,
    };
    image
        .map_err(|reason| add_note(notes, dropped(reason)))
        .ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn malformed_lines_are_left_out_and_named() {
        let (text, malformed) =
            sound_lines("newmtl a\nKd 1 0.5\n Kd 1 0.5 0\nKa 1\nd x\nNs 10\nnewmtl\n");
        assert_eq!(text, "newmtl a\nKd 1 0.5 0\nNs 10\n");
        assert_eq!(malformed, [2, 5, 7]);
    }

    #[test]
    fn a_higher_exponent_is_smoother() {
        assert_eq!(roughness(0.0), 1.0);
        assert_eq!(roughness(30.0), 0.5);
        assert!(roughness(1000.0) < 0.25);
    }
}
