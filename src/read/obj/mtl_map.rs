//! The pictures of a material library: what `map_` statements say, and the textures that they name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};

use super::packing::Key;
use crate::material::{Image, Texture};
use crate::read::error::reason;
use crate::read::find::{find, slashed};
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::picture;
use crate::read::text::unquoted;
use crate::read::uri::Folder;

/// `CLAMP_TO_EDGE` of glTF 2.0, section 5.26.
const CLAMP: u32 = 33071;

/// What stands behind a `map_` statement: options, then the name of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The file, with slashes as everywhere but on Windows.
    pub(super) file: String,
    /// Added to texture coordinates that have been multiplied by `scale`.
    offset: [f64; 2],
    scale: [f64; 2],
    /// How much bumps are exaggerated.
    pub(super) strength: f64,
    /// Whether the picture ends at its edge.
    pub(super) clamped: bool,
    /// Options that would change the picture and are not followed.
    pub(super) unread: Vec<String>,
}

impl Map {
    pub(super) fn new(words: &str) -> Self {
        let mut map = Self {
            file: String::new(),
            offset: [0.0; 2],
            scale: [1.0; 2],
            strength: 1.0,
            clamped: false,
            unread: vec![],
        };
        let mut rest = words.trim();
        while rest.starts_with('-') {
            let (option, behind) = next_word(rest);
            rest = map.follow(option, behind);
        }
        // Something that looks like an option, but it is all there is.
        if rest.is_empty() {
            rest = words.split_whitespace().next_back().unwrap_or_default();
        }
        // Written on Windows, read everywhere.
        map.file = slashed(unquoted(rest));
        map
    }

    /// Takes in an option; what stands behind its values.
    fn follow<'a>(&mut self, option: &str, rest: &'a str) -> &'a str {
        let (first, behind_first) = next_word(rest);
        match option {
            "-o" => return numbers(rest, &mut self.offset),
            "-s" => return numbers(rest, &mut self.scale),
            "-t" => {
                self.unread.push(option.to_owned());
                return numbers(rest, &mut []);
            }
            "-bm" => self.strength = number(first).unwrap_or(1.0),
            "-clamp" => self.clamped = first == "on",
            "-blendu" | "-blendv" | "-cc" | "-texres" | "-type" | "-colorspace" => {}
            "-mm" => {
                let (second, behind) = next_word(behind_first);
                if (number(first), number(second)) != (Some(0.0), Some(1.0)) {
                    self.unread.push(option.to_owned());
                }
                return behind;
            }
            "-boost" | "-imfchan" => self.unread.push(option.to_owned()),
            _ => {
                self.unread.push(option.to_owned());
                return rest;
            }
        }
        behind_first
    }

    /// The `KHR_texture_transform` that moves glTF's coordinates as the options move those of OBJ, unless it
    /// changes nothing. glTF counts v from above: where OBJ has `s v + o`, it has `s (1 - v) + o` from below.
    pub(super) fn transform(&self) -> Option<Value> {
        let [u, v] = self.offset;
        let offset = [u, 1.0 - self.scale[1] - v];
        let changes = self.scale != [1.0; 2] || offset != [0.0; 2];
        changes.then(|| json!({ "offset": offset, "scale": self.scale }))
    }

    /// The `sampler` of glTF that a texture of the picture needs.
    pub(super) fn sampler(&self) -> Option<Value> {
        self.clamped
            .then(|| json!({ "wrapS": CLAMP, "wrapT": CLAMP }))
    }

    /// Whether two pictures lie in the same way on a surface.
    pub(super) fn is_laid_as(&self, other: &Self) -> bool {
        let way = |map: &Self| (map.scale, map.offset, map.clamped);
        way(self) == way(other)
    }
}

/// The textures of an OBJ file, each made once and shared.
pub(super) struct Pictures<'a> {
    pub(super) files: &'a Folder<'a>,
    /// `None` for those that cannot be had.
    images: HashMap<PathBuf, Option<Arc<Image>>>,
    /// By file and whether it ends at its edge.
    textures: HashMap<(PathBuf, bool), Arc<Texture>>,
    /// Those made of two pictures, or why there is none.
    pub(super) packed: HashMap<Key, Result<Arc<Texture>, String>>,
}

impl<'a> Pictures<'a> {
    pub(super) fn new(files: &'a Folder<'a>) -> Self {
        Self {
            files,
            images: HashMap::new(),
            textures: HashMap::new(),
            packed: HashMap::new(),
        }
    }

    /// The picture that a map names, as a texture; `folder` is that of its library.
    pub(super) fn texture(
        &mut self,
        map: &Map,
        folder: &Path,
        notes: &mut Vec<Note>,
    ) -> Option<Arc<Texture>> {
        let (path, image) = self.image(map, folder, notes)?;
        let texture = self.textures.entry((path, map.clamped));
        let texture = texture.or_insert_with(|| Arc::new(Texture::new(image, map.sampler())));
        Some(texture.clone())
    }

    /// The picture that a map names, and its path.
    pub(super) fn image(
        &mut self,
        map: &Map,
        folder: &Path,
        notes: &mut Vec<Note>,
    ) -> Option<(PathBuf, Arc<Image>)> {
        let path = find(self.files, folder, &map.file, notes);
        if !self.images.contains_key(&path) {
            let image = format!("{:?}", map.file);
            let read = match self.read(&path, &map.file) {
                Ok((read, format)) => {
                    if let Some(format) = format {
                        add_note(notes, Note::ImageConverted { image, format });
                    }
                    Some(Arc::new(read))
                }
                Err(reason) => {
                    add_note(notes, Note::Image { image, reason });
                    None
                }
            };
            self.images.insert(path.clone(), read);
        }
        let image = self.images.get(&path)?.clone()?;
        Some((path, image))
    }

    /// A picture, and the name of the format that it had, if that was another; or why there is none.
    fn read(&self, path: &Path, name: &str) -> Result<(Image, Option<&'static str>), String> {
        let bytes = self.files.open(path, u64::MAX).map_err(|e| reason(&e))?;
        let bytes = self.files.picture(bytes)?;
        let stem = Path::new(name).file_stem().unwrap_or_default();
        let properties = json!({ "name": stem.to_string_lossy() });
        let (image, format) = picture::image(properties, bytes, name, self.files)?;
        match image.is_for_every_program() {
            true => Ok((image, format)),
            false => Err("neither PNG nor JPEG".to_owned()),
        }
    }
}

/// Takes up to three numbers, of which the first ones are wanted; what stands behind them.
fn numbers<'a>(mut rest: &'a str, wanted: &mut [f64]) -> &'a str {
    for place in 0..3 {
        let (word, behind) = next_word(rest);
        let Some(number) = number(word) else {
            break;
        };
        if let Some(wanted) = wanted.get_mut(place) {
            *wanted = number;
        }
        rest = behind;
    }
    rest
}

fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The first word and what stands behind it.
fn next_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stand_before_a_name_that_may_have_spaces() {
        let map =
            Map::new("-blendu on -s 2 3 -o 0.5 0.25 0 -bm 0.5 -clamp on -mm 0 1 a\\my wood.png");
        assert_eq!(map.file, "a/my wood.png");
        assert_eq!((map.scale, map.offset), ([2.0, 3.0], [0.5, 0.25]));
        assert_eq!((map.strength, map.clamped), (0.5, true));
        assert_eq!(map.unread, [""; 0]);
        let map = Map::new("-imfchan r -mm 0.5 1 -t 1 1 1 -boost 2 -odd 1.png");
        assert_eq!(map.unread, ["-imfchan", "-mm", "-t", "-boost", "-odd"]);
        assert_eq!(map.file, "1.png");
        assert_eq!(Map::new("-strange.png").file, "-strange.png");
        assert_eq!(Map::new("plain - name.png").file, "plain - name.png");
    }

    #[test]
    fn a_picture_is_moved_in_gltf_as_in_obj() {
        assert_eq!(Map::new("a.png").transform(), None);
        assert_eq!(Map::new("-s 1 1 1 -o 0 0 0 a.png").transform(), None);
        let map = Map::new("-s 2 4 -o 0.5 0.125 a.png");
        let transform = map.transform().unwrap();
        let number = |key: &str, axis: usize| transform[key][axis].as_f64().unwrap();
        for [u, v] in [[0.0, 0.0], [1.0, 0.0], [0.25, 0.75]] {
            // Moved as OBJ says, then counted from above; and the other way round.
            let expected = [2.0 * u + 0.5, 1.0 - (4.0 * v + 0.125)];
            let flipped = [u, 1.0 - v];
            let moved =
                [0, 1].map(|axis| number("scale", axis) * flipped[axis] + number("offset", axis));
            assert_eq!(moved, expected);
        }
    }
}
