//! Files that OBJ and MTL files name: often by the paths of the machine that wrote them.

use std::path::{Path, PathBuf};

use super::note::Note;
use super::uri::Folder;

/// Longer names are those of no file on any system.
const MAX_PATH: usize = 4096;

/// The path to a file in `folder`, or below it, that `name` may mean: as it says, else without folders from its
/// front, else without a comment; one that `files` allows. Where there is no such file, the path as `name` says it.
pub(super) fn find(files: &Folder, folder: &Path, name: &str, notes: &mut Vec<Note>) -> PathBuf {
    let as_named = folder.join(slashed(name));
    if name.len() > MAX_PATH {
        return as_named;
    }
    if is_of_this_folder(name) && files.place_of(&as_named).is_some() {
        return as_named;
    }
    let without_comment = name.split_once(" #").map(|(name, _)| name.trim_end());
    for name in [Some(name), without_comment].into_iter().flatten() {
        let slashed = slashed(name);
        let mut rest = Some(slashed.as_str());
        while let Some(shorter) = rest {
            let path = folder.join(shorter);
            let is_name = !shorter.is_empty() && is_of_this_folder(shorter);
            if is_name && files.place_of(&path).is_some() {
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
            let files = Folder::new(folder);
            let path = find(&files, folder, name, &mut notes);
            assert_eq!(path, folder.join(found), "{name}");
            assert_eq!(notes.len(), count, "{name}");
        }
    }

    #[test]
    fn what_may_not_be_read_is_as_if_it_were_not_there() {
        let all = tempfile::tempdir().unwrap();
        let inside = all.path().join("inside");
        std::fs::create_dir(&inside).unwrap();
        let files = Folder::new(&inside);
        let all_found = || {
            let names = [
                "../key.png",
                "gone/../../key.png",
                "../key.png # red",
                "a/b/../../../key.png",
            ];
            names.map(|name| {
                let mut notes = vec![];
                (find(&files, &inside, name, &mut notes), notes)
            })
        };
        let without = all_found();
        std::fs::write(all.path().join("key.png"), "").unwrap();
        assert_eq!(all_found(), without);
        assert!(without.iter().all(|(_, notes)| notes.is_empty()));
        // It is found where it is allowed.
        let access = crate::read::Access {
            folders: vec![all.path().to_owned()],
            ..Default::default()
        };
        let files = Folder::within(&inside, access.reach(&inside));
        let mut notes = vec![];
        let path = find(&files, &inside, "../key.png # red", &mut notes);
        assert_eq!((path, notes.len()), (inside.join("../key.png"), 1));
    }
}
