//! The JSON of a glTF file, checked, and the buffers that belong to it.
//!
//! The `gltf` crate gives the types of the JSON and checks its references. What it is not used for, and why:
//! its validation panics where a POSITION accessor is out of range and refuses files for want of
//! bounds that nobody here reads; its types hold node transforms as `f32`; it refuses required
//! extensions without regard to what they mean; it refuses accessors without a buffer view, animations
//! by extensions, and scenes without nodes.

use std::collections::HashSet;
use std::ops::Range;

use gltf::binary::{ChunkType, Error as GlbProblem};
use gltf::json::validation::{Checked, Error as Invalid, Validate};
use gltf::json::{Root, Value, mesh::Semantic};
use serde::Deserialize;

use super::extensions;
use super::material_lists::MaterialLists;
use super::mend::mend;
use crate::read::bytes::Bytes;
use crate::read::note::Note;
use crate::read::quota::Quota;
use crate::read::uri::{Folder, read_uri};
use crate::read::{DocumentProblem, ReadError};

/// A glTF file whose references are all in range.
pub(super) struct Document<'a> {
    pub(super) root: Root,
    /// As many as there are nodes.
    pub(super) placements: Vec<Placement>,
    /// What surfaces look like.
    pub(super) material_lists: MaterialLists,
    /// How many animations were left out.
    pub(super) animations: usize,
    /// `None` where a buffer has neither a URI nor the binary chunk.
    pub(super) buffers: Vec<Option<Bytes<'a>>>,
    /// How much may be made of it.
    pub(super) quota: Quota,
    /// How many zeros may be made where it has no data.
    pub(super) zeros: Quota,
}

/// The transform of a node relative to its parent, with all digits that the file has.
#[derive(Deserialize)]
pub(super) struct Placement {
    /// Column by column.
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    /// x, y, z, w.
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
}

/// Takes apart a GLB or glTF file; buffers outside it are looked for in `folder`.
pub(super) fn read_document<'a>(
    bytes: Bytes<'a>,
    folder: &Folder,
    notes: &mut Vec<Note>,
) -> Result<Document<'a>, ReadError> {
    let (json, mut binary) = split(bytes)?;
    let mut value: Value = serde_json::from_slice(&json).map_err(ReadError::Json)?;
    check_version(&value)?;
    mend(&mut value);
    let animations = drop_animations(&mut value);
    let placements = match value.get("nodes") {
        Some(nodes) => schema::<Vec<Placement>>("nodes", nodes)?,
        None => vec![],
    };
    let mut root: Root = schema("", &value)?;
    let material_lists = MaterialLists::new(&value, std::mem::take(&mut root.extensions_required));
    extensions::check(&root, &material_lists, notes)?;
    give_bounds(&mut root)?;
    check_references(&root)?;

    let mut buffers = vec![];
    let mut size = json.len() as u64;
    let mut known = HashSet::new();
    for (index, buffer) in root.buffers.iter().enumerate() {
        let data = match &buffer.uri {
            Some(uri) => {
                let place = format!("buffers[{index}].uri");
                Some(read_uri(uri, folder, buffer.byte_length.0, &place)?)
            }
            // Only the first buffer may be the binary chunk (glTF 2.0, section 4.4.3.3).
            None if index == 0 => binary.take(),
            None => None,
        };
        // What is named again is not there again.
        if known.insert(&buffer.uri) {
            size += data.as_ref().map_or(0, Bytes::len) as u64;
        }
        buffers.push(data);
    }
    Ok(Document {
        root,
        placements,
        material_lists,
        animations,
        buffers,
        quota: Quota::of(size),
        zeros: Quota::of_zeros(size),
    })
}

/// Whether something is a GLB file, by its first bytes.
pub(in crate::read) fn is_glb(bytes: &Bytes) -> Result<bool, ReadError> {
    let first = bytes.part(0..bytes.len().min(4), &mut vec![])? == b"glTF";
    Ok(first)
}

/// The JSON and, in a GLB file that has one, the binary chunk.
fn split(bytes: Bytes) -> Result<(Vec<u8>, Option<Bytes>), ReadError> {
    if !is_glb(&bytes)? {
        let mut text = bytes.into_vec()?;
        if text.starts_with(b"\xef\xbb\xbf") {
            text.drain(..3);
        }
        return Ok((text, None));
    }
    let length = |expected| ReadError::GlbLength {
        found: bytes.len(),
        expected,
    };
    let mut header = vec![];
    let header = bytes.part(0..bytes.len().min(12), &mut header)?;
    let word = |at: usize| -> Option<u32> {
        let word = header.get(at..at + 4)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    let (Some(version), Some(announced)) = (word(4), word(8)) else {
        return Err(length(20));
    };
    if version != 2 {
        return Err(ReadError::Version {
            found: version.to_string(),
        });
    }
    let announced = announced as usize;
    if announced < 20 || announced > bytes.len() {
        return Err(length(announced.max(20)));
    }
    let json = chunk(&bytes, 12..announced, ChunkType::Json)?;
    let rest = json.end..announced;
    let text = bytes.part(json, &mut vec![])?.to_vec();
    let binary = match rest.is_empty() {
        true => None,
        false => Some(chunk(&bytes, rest, ChunkType::Bin)?),
    };
    Ok((text, binary.map(|binary| bytes.cut(binary))))
}

/// The content of the first chunk in a part of a GLB file, which has to be of a certain type.
fn chunk(
    bytes: &Bytes,
    part: Range<usize>,
    expected: ChunkType,
) -> Result<Range<usize>, ReadError> {
    let wrong = |problem| Err(ReadError::Glb(gltf::Error::Binary(problem)));
    let mut header = vec![];
    let content = part.end.min(part.start + 8);
    let header = bytes.part(part.start..content, &mut header)?;
    let &[a, b, c, d, ref name @ ..] = header else {
        return wrong(GlbProblem::Io(std::io::ErrorKind::UnexpectedEof.into()));
    };
    let length = u32::from_le_bytes([a, b, c, d]);
    match (name, expected) {
        (b"JSON", ChunkType::Json) | (b"BIN\0", ChunkType::Bin) => {}
        (b"JSON", _) => return wrong(GlbProblem::ChunkType(ChunkType::Json)),
        (b"BIN\0", _) => return wrong(GlbProblem::ChunkType(ChunkType::Bin)),
        (&[a, b, c, d], _) => return wrong(GlbProblem::UnknownChunkType([a, b, c, d])),
        _ => return wrong(GlbProblem::Io(std::io::ErrorKind::UnexpectedEof.into())),
    }
    if length as usize > part.end - content {
        return wrong(GlbProblem::ChunkLength {
            ty: expected,
            length,
            length_read: part.end - content,
        });
    }
    Ok(content..content + length as usize)
}

fn check_version(value: &Value) -> Result<(), ReadError> {
    match value.pointer("/asset/version").and_then(Value::as_str) {
        Some(version) if version == "2" || version.starts_with("2.") => Ok(()),
        Some(version) => Err(ReadError::Version {
            found: version.to_owned(),
        }),
        None => Err(ReadError::Document {
            place: "asset.version".to_owned(),
            problem: DocumentProblem::Missing,
        }),
    }
}

/// Takes out the animations, which are not read: those of `KHR_animation_pointer` have targets that the
/// crate refuses. Says how many there were.
fn drop_animations(value: &mut Value) -> usize {
    let animations = value
        .as_object_mut()
        .and_then(|root| root.remove("animations"));
    animations
        .as_ref()
        .and_then(Value::as_array)
        .map_or(0, Vec::len)
}

/// The part of the JSON at `place` as the type that glTF has there.
fn schema<T: for<'a> Deserialize<'a>>(place: &str, value: &Value) -> Result<T, ReadError> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = error.path().to_string();
        let place = match (place, path.as_str()) {
            ("", ".") => "the file".to_owned(),
            ("", _) => path,
            (_, ".") => place.to_owned(),
            _ => format!("{place}{path}"),
        };
        ReadError::Schema {
            place,
            source: error.into_inner(),
        }
    })
}

/// Gives every POSITION accessor bounds, which the crate wants and nobody here reads.
fn give_bounds(root: &mut Root) -> Result<(), ReadError> {
    let position = Checked::Valid(Semantic::Positions);
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let Some(index) = primitive.attributes.get(&position) else {
                continue;
            };
            let Some(accessor) = root.accessors.get_mut(index.value()) else {
                return Err(ReadError::Document {
                    place: format!("meshes[{m}].primitives[{p}].attributes[\"POSITION\"]"),
                    problem: DocumentProblem::OutOfRange,
                });
            };
            accessor.min = Some(Value::from(vec![0.0; 3]));
            accessor.max = Some(Value::from(vec![0.0; 3]));
        }
    }
    Ok(())
}

fn check_references(root: &Root) -> Result<(), ReadError> {
    let mut first = None;
    root.validate(root, gltf::json::Path::new, &mut |path, error| {
        let path = path();
        // An accessor may do without a view: it is all zeros then (glTF 2.0, section 5.1.1).
        let all_zeros = path.as_str().starts_with("accessors[")
            && path.as_str().ends_with("].bufferView")
            && error == Invalid::Missing;
        // A primitive without positions is ignored.
        let no_positions =
            path.as_str().ends_with(".attributes[\"POSITION\"]") && error == Invalid::Missing;
        if !all_zeros && !no_positions {
            first.get_or_insert((path, error));
        }
    });
    let Some((path, error)) = first else {
        return Ok(());
    };
    Err(ReadError::Document {
        place: path.as_str().to_owned(),
        problem: match error {
            Invalid::IndexOutOfBounds => DocumentProblem::OutOfRange,
            Invalid::Missing => DocumentProblem::Missing,
            Invalid::Oversize => DocumentProblem::Oversize,
            Invalid::Invalid | Invalid::Unsupported => DocumentProblem::Invalid,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(json: &str) -> Result<Document<'_>, ReadError> {
        let bytes = Bytes::Held(json.as_bytes().into());
        read_document(bytes, &Folder::new(".".as_ref()), &mut vec![])
    }

    fn message(json: &str) -> String {
        let error = read(json).err().expect("an error");
        let source = std::error::Error::source(&error);
        source.map_or(error.to_string(), |source| format!("{error}: {source}"))
    }

    #[test]
    fn a_translation_keeps_all_its_digits() {
        let json =
            r#"{"asset": {"version": "2.0"}, "nodes": [{"translation": [1e9, 0.1, 1e-300]}]}"#;
        let document = read(json).unwrap();
        assert_eq!(document.placements[0].translation, Some([1e9, 0.1, 1e-300]));
    }

    #[test]
    fn a_scene_may_be_empty_and_an_attribute_unknown() {
        let json = r#"{"asset": {"version": "2.0"}, "scenes": [{}], "accessors": [{"count": 1,
            "componentType": 5126, "type": "VEC3", "bufferView": 0}], "buffers": [{"byteLength": 12}],
            "bufferViews": [{"buffer": 0, "byteLength": 12}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "HEAT": 0}}]}]}"#;
        let document = read(json).unwrap();
        let attributes = &document.root.meshes[0].primitives[0].attributes;
        let names: Vec<String> = attributes.keys().map(ToString::to_string).collect();
        assert_eq!(names, ["_HEAT", "POSITION"]);
    }

    #[test]
    fn errors_say_where() {
        assert_eq!(
            message(r#"{"asset": {}}"#),
            "asset.version: missing, expected by glTF 2.0"
        );
        assert_eq!(
            message(r#"{"asset": {"version": "1.0"}}"#),
            "glTF of version 1.0, expected 2"
        );
        assert_eq!(
            message("[1,\n 2"),
            "not glTF, neither binary nor JSON: EOF while parsing a list at line 2 column 2"
        );
        let wrong = r#"{"asset": {"version": "2.0"}, "nodes": [{}, {"scale": [1, 2, "x"]}]}"#;
        assert_eq!(
            message(wrong),
            "nodes[1].scale[2]: not valid glTF: invalid type: string \"x\", expected f64"
        );
        let lost = r#"{"asset": {"version": "2.0"}, "nodes": [{"mesh": 3}]}"#;
        assert_eq!(
            message(lost),
            "nodes[0].mesh: index out of range, expected that of an existing element"
        );
        let lost = r#"{"asset": {"version": "2.0"},
            "meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}]}"#;
        assert!(message(lost).starts_with("meshes[0].primitives[0].attributes[\"POSITION\"]: "));
    }

    #[test]
    fn a_cut_glb_says_how_long_it_should_be() {
        let header = [&b"glTF"[..], &2u32.to_le_bytes(), &60u32.to_le_bytes()].concat();
        let split = |bytes: &[u8]| split(Bytes::Held(bytes.into())).map(|_| ());
        let error = split(&header).unwrap_err().to_string();
        assert_eq!(error, "a GLB file of 12 bytes, expected 60: it is cut off");
        assert!(split(&header[..7]).is_err());
        let short = [&b"glTF"[..], &2u32.to_le_bytes(), &3u32.to_le_bytes()].concat();
        assert!(matches!(split(&short), Err(ReadError::GlbLength { .. })));
        let old = [&b"glTF"[..], &1u32.to_le_bytes(), &60u32.to_le_bytes()].concat();
        assert!(matches!(split(&old), Err(ReadError::Version { found }) if found == "1"));
    }
}
