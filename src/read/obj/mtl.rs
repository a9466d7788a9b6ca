//! Material libraries of OBJ files.
//!
//! Sources: *MTL material format*, Wavefront Advanced Visualizer; for `Ke`, `Pr`, `Pm`, `norm` and their maps the
//! extension for physically based rendering that Clara.io published and Blender writes. What these say of
//! Phong's model beyond colour and exponent (`Ka`, `Ks`, `Ni`, `illum`) has no meaning in glTF's.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::mtl_map::{Map, Pictures};
use super::packing::Packing;
use crate::material::{Material, Texture, position};
use crate::read::ReadError;
use crate::read::error::reason;
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::text::{as_bytes_of_ascii, lines, shown, split_statement};

/// Statements that say something which glTF has no place for.
const LEFT: [&str; 17] = [
    "Pc", "Pcr", "Ps", "Tf", "aniso", "anisor", "decal", "disp", "map_Ka", "map_Ks", "map_Ns",
    "map_ORM", "map_Ps", "map_RMA", "map_Tr", "map_disp", "refl",
];
/// Names of maps of bumps.
const BUMPS: [&str; 2] = ["map_Bump", "bump"];
/// Roughness of what says nothing about it: hardly any gloss.
const MATT: f64 = 0.9;

/// The statements of a library about one material: the last one of each kind.
struct LibraryMaterial {
    /// In the bytes of the file.
    name: Vec<u8>,
    /// By their names in lower case.
    statements: BTreeMap<String, String>,
}

/// The materials of a library with their textures and their names in the bytes of the file; none where it cannot
/// be read.
pub(super) fn read_library(
    path: &Path,
    pictures: &mut Pictures,
    notes: &mut Vec<Note>,
) -> Result<Vec<(Vec<u8>, Material)>, ReadError> {
    let bytes = match pictures.files.read(path, u64::MAX) {
        Ok(bytes) => bytes,
        Err(error) => {
            let path = path.to_owned();
            let reason = reason(&error);
            add_note(notes, Note::MaterialLibrary { path, reason });
            return Ok(vec![]);
        }
    };
    let (entries, malformed) = library_materials(&bytes);
    if !malformed.is_empty() {
        let note = Note::MaterialLines {
            path: path.to_owned(),
            lines: malformed,
        };
        add_note(notes, note);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut materials = vec![];
    for entry in entries {
        // No material has the same notes as another.
        let mut of_material = vec![];
        let material = entry.material(folder, pictures, &mut of_material)?;
        materials.push((entry.name, material));
        notes.append(&mut of_material);
    }
    Ok(materials)
}

/// The materials of a library, the last of each name, and the numbers of the lines that make no sense.
fn library_materials(file: &[u8]) -> (Vec<LibraryMaterial>, Vec<usize>) {
    let mut entries: Vec<LibraryMaterial> = vec![];
    let mut numbers: HashMap<Vec<u8>, usize> = HashMap::new();
    let mut current = None;
    let mut malformed = vec![];
    for (index, line) in lines(&as_bytes_of_ascii(file)).enumerate() {
        let (statement, name) = split_statement(line);
        let statement = shown(statement).to_ascii_lowercase();
        let rest = shown(name);
        let makes_sense = match statement.as_str() {
            "" => true,
            _ if statement.starts_with('#') => true,
            "kd" | "ke" => color(&rest).is_some(),
            "ns" | "d" | "tr" | "pr" | "pm" => number(&rest).is_some(),
            _ if statement.starts_with("map_") => !rest.is_empty(),
            "newmtl" | "bump" | "norm" => !rest.is_empty(),
            _ => true,
        };
        match (statement.as_str(), current) {
            _ if !makes_sense => malformed.push(index + 1),
            ("newmtl", _) => {
                let number = *numbers.entry(name.to_vec()).or_insert(entries.len());
                let entry = LibraryMaterial {
                    name: name.to_vec(),
                    statements: BTreeMap::new(),
                };
                match entries.get_mut(number) {
                    Some(known) => *known = entry,
                    None => entries.push(entry),
                }
                current = Some(number);
            }
            (_, Some(number)) => {
                let statements = &mut entries[number].statements;
                statements.insert(statement, rest.into_owned());
            }
            (_, None) => {}
        }
    }
    (entries, malformed)
}

impl LibraryMaterial {
    fn material(
        &self,
        folder: &Path,
        pictures: &mut Pictures,
        notes: &mut Vec<Note>,
    ) -> Result<Material, ReadError> {
        let name = shown(&self.name);
        let mut left = self.left();
        let mut textures = vec![];
        let mut pack = |packing: Packing| {
            let (texture, map, are_in) = self.pack(packing, folder, pictures, &mut left, notes)?;
            Some((texture_info(&mut textures, &texture, &map), are_in))
        };
        let packed_color = pack(Packing::Opacity);
        let gloss_map = pack(Packing::Gloss);
        let [rough_map, metal_map] = gloss_map.as_ref().map_or([false; 2], |(_, are_in)| *are_in);
        let mut slot = |statement: &str, map: &Map, is_bump: bool, notes: &mut Vec<Note>| {
            let unread = map.unread.iter();
            left.extend(unread.map(|option| format!("{statement} {option}")));
            let texture = pictures.texture(map, folder, notes)?;
            if is_bump && texture.image().is_some_and(|image| is_grey(image.bytes())) {
                left.push(format!("{statement} (heights)"));
                return None;
            }
            Some(texture_info(&mut textures, &texture, map))
        };
        let base_color = self.map("map_Kd");
        // Tr, the transparency, is the other way to write d.
        let opacity = self.number("d").or(self.number("Tr").map(|t| 1.0 - t));
        let opacity = opacity.unwrap_or(1.0).clamp(0.0, 1.0);
        let [red, green, blue] = self.color("Kd").unwrap_or([1.0; 3]);
        let gloss = self.number("Pr").map(|rough| rough.clamp(0.0, 1.0));
        let gloss = gloss.or(self.number("Ns").map(roughness));
        let metal = self.number("Pm").map(|metal| metal.clamp(0.0, 1.0));
        // A map is multiplied by its number; zero, which programs write where they have nothing to say, would hide it.
        let factor = |number: Option<f64>, has_map: bool, otherwise: f64| match number {
            Some(number) if number > 0.0 || !has_map => number,
            None if !has_map => otherwise,
            _ => 1.0,
        };
        let mut surface = json!({
            "baseColorFactor": [red.clamp(0.0, 1.0), green.clamp(0.0, 1.0), blue.clamp(0.0, 1.0), opacity],
            "metallicFactor": factor(metal, metal_map, 0.0),
            "roughnessFactor": factor(gloss, rough_map, MATT),
        });
        let has_opacity = packed_color.is_some();
        let base_color = match packed_color {
            Some((packed, _)) => Some(packed),
            None => base_color.and_then(|map| slot("map_Kd", &map, false, notes)),
        };
        let has_picture = base_color.is_some();
        if let Some(info) = base_color {
            surface["baseColorTexture"] = info;
        }
        if let Some((info, _)) = gloss_map {
            surface["metallicRoughnessTexture"] = info;
        }
        // OBJ says nothing about sides, and viewers of it draw both.
        let mut properties = json!({
            "name": name,
            "pbrMetallicRoughness": surface,
            "doubleSided": true,
        });
        if opacity < 1.0 || has_opacity || (has_picture && self.is_base_color("map_d")) {
            properties["alphaMode"] = "BLEND".into();
        }
        if let Some(map) = self.map("norm") {
            if let Some(info) = slot("norm", &map, false, notes) {
                properties["normalTexture"] = info;
            }
        } else if let Some((statement, map)) = self.bumps()
            && let Some(mut info) = slot(statement, &map, true, notes)
        {
            if map.strength != 1.0 {
                info["scale"] = map.strength.into();
            }
            properties["normalTexture"] = info;
            let material = name.clone().into_owned();
            add_note(notes, Note::BumpAsNormals { material });
        }
        let glow = self.map("map_Ke");
        let glow = glow.and_then(|map| slot("map_Ke", &map, false, notes));
        self.add_emission(&mut properties, glow);

        if !left.is_empty() {
            let note = Note::Material {
                material: name.clone().into_owned(),
                properties: left,
            };
            add_note(notes, note);
        }
        Material::new(properties, textures).map_err(|problem| ReadError::Material {
            place: format!("material {name:?}"),
            problem,
        })
    }

    /// Two maps as one texture, and how it is laid.
    fn pack(
        &self,
        packing: Packing,
        folder: &Path,
        pictures: &mut Pictures,
        left: &mut Vec<String>,
        notes: &mut Vec<Note>,
    ) -> Option<(Arc<Texture>, Map, [bool; 2])> {
        let [first, second] = packing.statements();
        let mut maps = [self.map(first), self.map(second)];
        let needs_second = packing == Packing::Opacity;
        // A picture of the base colour that is named again has the opacity already.
        if needs_second && (maps[1].is_none() || self.is_base_color(second)) {
            return None;
        }
        if let [Some(one), Some(other)] = &maps
            && !one.is_laid_as(other)
        {
            left.push(format!("{second} (laid in another way than {first})"));
            maps[1] = None;
            if needs_second {
                return None;
            }
        }
        match pictures.packed(packing, maps.each_ref().map(Option::as_ref), folder, notes) {
            Ok(texture) => {
                let (texture, are_in) = texture?;
                for (map, statement) in maps.iter().zip([first, second]) {
                    let unread = map.iter().flat_map(|map| &map.unread);
                    left.extend(unread.map(|option| format!("{statement} {option}")));
                }
                Some((texture, maps.into_iter().flatten().next()?, are_in))
            }
            Err(reason) => {
                let statement = if maps[1].is_some() { second } else { first };
                left.push(format!("{statement} ({reason})"));
                None
            }
        }
    }

    /// Light of its own: above 1 only `KHR_materials_emissive_strength` can say it.
    fn add_emission(&self, properties: &mut Value, texture: Option<Value>) {
        let color = self.color("Ke").unwrap_or_default().map(|c| c.max(0.0));
        let brightest = color.into_iter().fold(0.0, f64::max);
        let color = match texture {
            // Black, which programs write where they have nothing to say, would hide the picture.
            Some(_) if brightest == 0.0 => [1.0; 3],
            None if brightest == 0.0 => return,
            _ => color.map(|c| c / brightest.max(1.0)),
        };
        properties["emissiveFactor"] = json!(color);
        if brightest > 1.0 {
            let strength = json!({ "emissiveStrength": brightest });
            properties["extensions"] = json!({ "KHR_materials_emissive_strength": strength });
        }
        if let Some(info) = texture {
            properties["emissiveTexture"] = info;
        }
    }

    /// Statements that do not come along, without those that say what is so anyway.
    fn left(&self) -> Vec<String> {
        let says_nothing = |statement: &str, rest: &str| {
            let nothing = if statement == "Tf" { 1.0 } else { 0.0 };
            let mut numbers = rest.split_whitespace().map(str::parse::<f64>);
            numbers.all(|number| number == Ok(nothing))
        };
        let bumps = match self.has("norm") {
            true => &BUMPS[..],
            false => &[],
        };
        LEFT.iter()
            .chain(bumps)
            .filter(|statement| {
                let rest = self.rest(statement);
                rest.is_some_and(|rest| !says_nothing(statement, rest))
            })
            .filter(|statement| !(**statement == "map_Ka" && self.is_base_color(statement)))
            .map(|statement| (*statement).to_owned())
            .collect()
    }

    /// Whether a map is the picture of the base colour once more.
    fn is_base_color(&self, statement: &str) -> bool {
        self.file(statement).is_some() && self.file(statement) == self.file("map_Kd")
    }

    fn bumps(&self) -> Option<(&'static str, Map)> {
        BUMPS.iter().find_map(|name| Some((*name, self.map(name)?)))
    }

    fn file(&self, statement: &str) -> Option<String> {
        Some(self.map(statement)?.file)
    }

    fn map(&self, statement: &str) -> Option<Map> {
        Some(Map::new(self.rest(statement)?))
    }

    fn has(&self, statement: &str) -> bool {
        self.rest(statement).is_some()
    }

    /// What stands behind a statement.
    fn rest(&self, statement: &str) -> Option<&String> {
        self.statements.get(&statement.to_ascii_lowercase())
    }

    fn number(&self, statement: &str) -> Option<f64> {
        number(self.rest(statement)?)
    }

    fn color(&self, statement: &str) -> Option<[f64; 3]> {
        color(self.rest(statement)?)
    }
}

/// A `textureInfo` of glTF.
fn texture_info(textures: &mut Vec<Arc<Texture>>, texture: &Arc<Texture>, map: &Map) -> Value {
    let mut info = json!({ "index": position(textures, texture) });
    if let Some(transform) = map.transform() {
        info["extensions"] = json!({ "KHR_texture_transform": transform });
    }
    info
}

/// The first number, behind the option that `d` can have.
fn number(rest: &str) -> Option<f64> {
    let rest = rest.strip_prefix("-halo").unwrap_or(rest);
    let word = rest.split_whitespace().next()?;
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Three numbers, or one for all three.
fn color(rest: &str) -> Option<[f64; 3]> {
    let words = rest.split_whitespace().take_while(|word| *word != "#");
    let numbers: Vec<f64> = words.map_while(number).collect();
    match numbers[..] {
        [grey] if rest.split_whitespace().nth(1).is_none() => Some([grey; 3]),
        [red, green, blue, ..] => Some([red, green, blue]),
        _ => None,
    }
}

/// The roughness of a surface with the specular exponent `Ns`: `alpha^2 = 2 / (Ns + 2)` for the width
/// `alpha` of the distribution of normals (Walter et al., *Microfacet Models for Refraction through Rough
/// Surfaces*, EGSR 2007, section 5.2), and `alpha = roughness^2` in glTF.
fn roughness(shininess: f64) -> f64 {
    (2.0 / (shininess.max(0.0) + 2.0)).powf(0.25)
}

/// Whether a PNG or JPEG file has shades of grey only: heights, where it is for bumps, and never normals.
/// The headers tell (PNG, third edition, 11.2.1; ITU-T T.81, B.2.2).
fn is_grey(file: &[u8]) -> bool {
    if file.starts_with(b"\x89PNG") {
        return matches!(file.get(25), Some(0 | 4));
    }
    let mut rest = file.get(2..).unwrap_or_default();
    while let [0xff, marker, high, low, segment @ ..] = rest {
        if (0xc0..=0xcf).contains(marker) && ![0xc4, 0xc8, 0xcc].contains(marker) {
            return segment.get(5) == Some(&1);
        }
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        rest = rest.get(2 + length.max(2)..).unwrap_or_default();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::uri::Folder;

    /// The only material of a library, and its notes.
    fn read(library: &str) -> (Material, Vec<String>) {
        let files = Folder::new("nowhere".as_ref());
        let mut notes = vec![];
        let (entries, _) = library_materials(library.as_bytes());
        let mut pictures = Pictures::new(&files);
        let material = entries[0].material("nowhere".as_ref(), &mut pictures, &mut notes);
        let notes = notes.iter().map(ToString::to_string).collect();
        (material.unwrap(), notes)
    }

    #[test]
    fn malformed_lines_are_left_out_and_named() {
        let text =
            "newmtl a\nKd 1 0.5\n Kd 1 0.5 0\nKa 1\nd x\nNs 10\nnewmtl\nd -halo 0.5\nKe 2 # two\n";
        let (entries, malformed) = library_materials(text.as_bytes());
        assert_eq!(malformed, [2, 5, 7, 9]);
        assert_eq!(entries.len(), 1);
        assert_eq!(entries[0].color("Kd"), Some([1.0, 0.5, 0.0]));
        assert_eq!(entries[0].number("d"), Some(0.5));
        assert_eq!(color("0.5"), Some([0.5; 3]));
        assert_eq!(color("1 2 3 # four"), Some([1.0, 2.0, 3.0]));
    }

    #[test]
    fn a_higher_exponent_is_smoother() {
        assert_eq!(roughness(0.0), 1.0);
        assert_eq!(roughness(30.0), 0.5);
        assert!(roughness(1000.0) < 0.25);
    }

    #[test]
    fn the_extension_for_physically_based_rendering_is_heeded() {
        let (material, notes) = read("newmtl a\nNs 30\nPr 0.25\nPm 1\nKe 0 4 2\nTr 0.25\n");
        let expected = json!({
            "name": "a",
            "pbrMetallicRoughness": {
                "baseColorFactor": [1.0, 1.0, 1.0, 0.75],
                "metallicFactor": 1.0,
                "roughnessFactor": 0.25,
            },
            "doubleSided": true,
            "alphaMode": "BLEND",
            "emissiveFactor": [0.0, 1.0, 0.5],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}},
        });
        assert_eq!(material.properties(), &expected);
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn what_gltf_has_no_place_for_is_named_unless_it_says_nothing() {
        let (_, notes) = read(
            "newmtl a\nKa 1 1 1\nKs 1 1 1\nNi 1.5\nillum 2\nTf 1 1 1\nPs 0.0\nKe 0 0 0\n\
             Pc 0.5\nmap_d b.png\nmap_Ka a.png\nmap_Kd -s 2 2 a.png\n",
        );
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(notes[0].starts_with("image \"a.png\" dropped"));
        assert_eq!(
            notes[1],
            "material \"a\": Pc, map_d (laid in another way than map_Kd) not copied"
        );
    }

    #[test]
    fn grey_pictures_are_told_by_their_headers() {
        let png =
            |kind: u8| [&b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"[..], &[0; 8], &[8, kind]].concat();
        assert!(is_grey(&png(0)) && is_grey(&png(4)));
        assert!(!is_grey(&png(2)) && !is_grey(&png(6)));
        let jpeg = |components: u8| {
            let comment = b"\xff\xd8\xff\xfe\0\x04hi";
            [
                &comment[..],
                b"\xff\xc2\0\x0b\x08\0\x01\0\x01",
                &[components],
            ]
            .concat()
        };
        assert!(is_grey(&jpeg(1)));
        assert!(!is_grey(&jpeg(3)));
        assert!(!is_grey(&jpeg(1)[..12]) && !is_grey(b""));
    }
}
