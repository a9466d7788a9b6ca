//! Both files of a `.gltf`: the JSON, and its data beside it in a file whose name is made of what is in it.
//!
//! Two programs that write one `.gltf` at the same time, or one that is read while it is replaced, never make a pair of
//! the JSON of one and the data of another: the name in the JSON is that of its own data. The data of the `.gltf` that
//! is replaced goes when nothing refers to it any more.

use std::fs::{self, File, TryLockError};
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use percent_encoding::percent_decode_str;
use serde::Deserialize;

use crate::write::file::{Destination, directory_of, io_error, persist_both, temporary_in};
use crate::write::{GltfOutput, Seal, WriteError};

/// How often, and how far apart, it is tried to be alone in a directory.
const TRIES: u32 = 200;
const BETWEEN_TRIES: Duration = Duration::from_millis(10);

/// A `.gltf` that is larger is not searched for the name of its data before it is replaced: none of ours is.
const MAX_SEARCHED: u64 = 1 << 30;

/// Writes a `.gltf` with `content`, and its data beside it as `out-1a2b3c4d.bin`; the path of the latter. Both appear
/// whole, the data first, or nothing does. Where that replaces a `.gltf` that was written in the same way, its data is
/// removed.
///
/// `before_they_appear` gets the result of `content`, and the `.gltf` and its data with their lengths.
///
/// # Errors
///
/// A file cannot be written, one that is there is read-only, the name is not UTF-8, or `content` or
/// `before_they_appear` fails.
pub fn write_whole_gltf<T>(
    path: &Path,
    content: impl FnOnce(GltfOutput<'_>) -> Result<T, WriteError>,
    before_they_appear: impl FnOnce(T, [(PathBuf, u64); 2]) -> Result<(), WriteError>,
) -> Result<PathBuf, WriteError> {
    write_sealed_gltf(path, content, |_| None, before_they_appear)
}

/// As [`write_whole_gltf`]; the seal of the result of `content`, if it has one, is closed in the JSON.
pub(crate) fn write_sealed_gltf<T>(
    path: &Path,
    content: impl FnOnce(GltfOutput<'_>) -> Result<T, WriteError>,
    seal: impl FnOnce(&T) -> Option<Seal>,
    before_they_appear: impl FnOnce(T, [(PathBuf, u64); 2]) -> Result<(), WriteError>,
) -> Result<PathBuf, WriteError> {
    let here = |source| io_error(path, source);
    let told = |error| match error {
        WriteError::Stream(source) => here(source),
        other => other,
    };
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let stem = stem.ok_or_else(|| WriteError::NotText(path.to_owned()))?;
    let directory = directory_of(path);
    let Destination::Regular(place) = Destination::of(path)? else {
        let expected = "no ordinary file; a .gltf has its .bin beside it";
        return Err(here(std::io::Error::other(expected)));
    };
    // Whoever may not read the one may not read the other.
    let begin = |directory| temporary_in(directory, fs::metadata(&place).ok()).map_err(here);
    let mut data = begin(directory)?;
    let mut json = begin(directory_of(&place))?;
    let mut name = String::new();
    let mut json_writer = BufWriter::new(json.file());
    let mut data_writer = BufWriter::new(data.file());
    let output = GltfOutput::named_by_content(
        stem,
        directory,
        &mut json_writer,
        &mut data_writer,
        &mut name,
    );
    let made = content(output).map_err(told)?;
    data_writer.flush().map_err(here)?;
    json_writer.flush().map_err(here)?;
    drop((json_writer, data_writer));
    if let Some(seal) = seal(&made) {
        seal.close(json.file()).map_err(here)?;
    }

    let binary = path.with_file_name(&name);
    let length = |file: &mut File| file.metadata().map(|data| data.len()).map_err(here);
    let lengths = [length(json.file())?, length(data.file())?];
    before_they_appear(
        made,
        [(path.to_owned(), lengths[0]), (binary.clone(), lengths[1])],
    )?;
    let alone = alone_in(directory);
    let replaced = data_of(&place, stem).filter(|replaced| *replaced != name);
    persist_both((data, &binary), (json, &place)).map_err(here)?;
    if let Some(replaced) = replaced {
        // What cannot be removed does no harm.
        let _ = fs::remove_file(path.with_file_name(replaced));
    }
    drop(alone);
    Ok(binary)
}

/// Lets no other process put a `.gltf` into this directory as long as the result is kept: none leaves data behind that
/// only a `.gltf` referred to which another has replaced meanwhile. Where directories cannot be locked, or one is for
/// long, that may happen; no pair is ever mixed.
fn alone_in(directory: &Path) -> Option<File> {
    let directory = File::open(directory).ok()?;
    for _ in 0..TRIES {
        match directory.try_lock() {
            Ok(()) => return Some(directory),
            Err(TryLockError::WouldBlock) => sleep(BETWEEN_TRIES),
            Err(TryLockError::Error(_)) => return None,
        }
    }
    None
}

/// The data of a `.gltf` that [`write_whole_gltf`] would remove if it replaced that.
pub fn replaced_data(path: &Path) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_str()?;
    Some(path.with_file_name(data_of(path, stem)?))
}

#[derive(Deserialize)]
struct Referring {
    #[serde(default)]
    buffers: Vec<Buffer>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<String>,
}

/// The name of the data that a `.gltf` refers to, if it is one that [`write_whole_gltf`] gives.
fn data_of(gltf: &Path, stem: &str) -> Option<String> {
    let file = File::open(gltf).ok()?;
    if file.metadata().ok()?.len() > MAX_SEARCHED {
        return None;
    }
    let Referring { buffers } = serde_json::from_reader(BufReader::new(file)).ok()?;
    let uri = buffers.into_iter().next()?.uri?;
    let name = percent_decode_str(&uri).decode_utf8().ok()?.into_owned();
    let digest = name.strip_prefix(stem)?.strip_prefix('-')?;
    let digest = digest.strip_suffix(".bin")?;
    let is_digest = digest.len() == 8 && digest.bytes().all(|b| b.is_ascii_hexdigit());
    is_digest.then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_data_with_a_name_of_ours_is_ever_removed() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a b.gltf");
        for (uri, expected) in [
            ("a%20b-0123abcd.bin", Some("a b-0123abcd.bin")),
            ("a%20b.bin", None),
            ("other-0123abcd.bin", None),
            ("a%20b-../../../x.bin", None),
            ("data:;base64,AAAA", None),
        ] {
            fs::write(&path, format!(r#"{{"buffers":[{{"uri":"{uri}"}}]}}"#)).unwrap();
            assert_eq!(data_of(&path, "a b").as_deref(), expected);
        }
        fs::write(&path, "no JSON").unwrap();
        assert_eq!(data_of(&path, "a b"), None);
        assert_eq!(data_of(&directory.path().join("none"), "a b"), None);
    }
}
