//! Files that OBJ and MTL files name: often by the paths of the machine that wrote them.

use std::path::{Path, PathBuf};

use super::note::Note;

/// Longer names are those of no file on any system.
const MAX_PATH: usize = 4096;

/// The path to a file in `folder`, or below it, that `name` may mean: as it says, else without folders from its
/// front, else without a comment. Where there is no such file, the path as `name` says it.
pub(super) fn find(folder: &Path, name: &str, notes: &mut Vec<Note>) -> PathBuf {
    let as_named = folder.join(slashed(name));
    if name.len() > MAX_PATH {
        return as_named;
    }
    if is_of_this_folder(name) && as_named.exists() {
        return as_named;
    }
    let without_comment = name.split_once(" #").map(|(name, _)| name.trim_end());
    for name in [Some(name), without_comment].into_iter().flatten() {
        let slashed = slashed(name);
        let mut rest = Some(slashed.as_str());
        while let Some(shorter) = rest {
            let path = folder.join(shorter);
            if !shorter.is_empty() && is_of_this_folder(shorter) && path.exists() {
                notes.push(Note::FoundElsewhere {
                    named: name.to_owned(),
                    path: path.clone(),
                });
                return path;
            }
            rest = shorter.split_once('/').map(|(_, rest)| rest);
        }
    }
    as_named
}

/// A path with slashes as everywhere but on Windows.
pub(super) fn slashed(name: &str) -> String {
    name.replace('\\', "/")
}

/// Whether a path starts neither at a root nor at a drive.
fn is_of_this_folder(name: &str) -> bool {
    let drive = |name: &[u8]| matches!(name, [letter, b':', ..] if letter.is_ascii_alphabetic());
    !name.starts_with(['/', '\\']) && !drive(name.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_by_the_end_of_their_path() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        std::fs::create_dir(folder.join("tex")).unwrap();
        for name in ["a.png", "tex/b.png", "c #1.png"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        for (name, found, count) in [
            ("a.png", "a.png", 0),
            ("tex\\b.png", "tex/b.png", 0),
            ("c #1.png", "c #1.png", 0),
            ("C:\\work\\tex\\b.png", "tex/b.png", 1),
            ("/home/someone/a.png", "a.png", 1),
            ("//server/a.png", "a.png", 1),
            ("gone/a.png", "a.png", 1),
            ("a.png # red", "a.png", 1),
            ("gone.png", "gone.png", 0),
            ("gone/", "gone/", 0),
        ] {
            let mut notes = vec![];
            assert_eq!(find(folder, name, &mut notes), folder.join(found), "{name}");
            assert_eq!(notes.len(), count, "{name}");
        }
    }
}
