//! The map in `src/README.md` is what the source does: which room uses which, and that no `mod.rs` of theirs defines.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms of the command, which is a crate of its own.
const COMMAND: &str = "cli";

/// The viewer of pages: JavaScript and shaders, whose imports `tests/page/modules.test.mjs` reads.
const VIEWER: &str = "page";

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Each room of the table, in its order, with those that it may use.
fn rooms() -> Vec<(String, BTreeSet<String>)> {
    let text = fs::read_to_string(source().join("README.md")).expect("the map");
    let (_, table) = text.split_once("| room |").expect("the table of rooms");
    let quoted = |cell: &str| -> Vec<String> {
        cell.split('`')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect()
    };
    let rows = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let room = |row: &str| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').collect();
        let [name, _, uses] = cells[..] else {
            panic!("three cells: {row}");
        };
        (quoted(name).remove(0), quoted(uses).into_iter().collect())
    };
    rows.map(room).collect()
}

/// The Rust files of a folder and of those in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in fs::read_dir(folder).expect("a folder of the source") {
        let path = entry.expect("an entry of it").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// A file without comments and without its tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a file of the source");
    let (code, _) = text
        .split_once("#[cfg(test)]\nmod tests {")
        .unwrap_or((&text, ""));
    let lines = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn each_room_uses_what_the_map_says_and_nothing_else() {
    let rooms = rooms();
    let mut above = BTreeSet::new();
    for (room, may_use) in &rooms {
        assert!(may_use.is_subset(&above), "{room} is above what it may use");
        let mut uses: BTreeMap<String, PathBuf> = BTreeMap::new();
        for path in files(&source().join(room)) {
            for part in code(&path).split("crate::").skip(1) {
                let end = part.find(|c: char| !c.is_ascii_lowercase() && c != '_');
                let used = &part[..end.unwrap_or(part.len())];
                if used != room && rooms.iter().any(|(room, _)| room == used) {
                    uses.insert(used.to_owned(), path.clone());
                }
            }
        }
        for (used, path) in &uses {
            assert!(may_use.contains(used), "{} uses {used}", path.display());
        }
        let unused: Vec<_> = may_use
            .iter()
            .filter(|used| !uses.contains_key(*used))
            .collect();
        assert!(unused.is_empty(), "{room} does not use {unused:?}");
        above.insert(room.clone());
    }
}

#[test]
fn every_folder_is_a_room_of_the_map() {
    let folders = fs::read_dir(source()).expect("the source");
    let folders = folders.map(|entry| entry.expect("an entry of it").path());
    let names = folders.filter(|path| path.is_dir()).map(|path| {
        let name = path.file_name().expect("a name").to_string_lossy();
        name.into_owned()
    });
    let in_source: BTreeSet<String> = names
        .filter(|name| name != COMMAND && name != VIEWER)
        .collect();
    let on_the_map: BTreeSet<String> = rooms().into_iter().map(|(room, _)| room).collect();
    assert_eq!(in_source, on_the_map);
}

#[test]
fn a_mod_file_says_what_there_is_and_defines_nothing() {
    const DEFINITIONS: [&str; 9] = [
        "fn ", "struct ", "enum ", "trait ", "impl ", "impl<", "const ", "static ", "type ",
    ];
    for path in files(&source()) {
        let is_mod = path.file_name().is_some_and(|name| name == "mod.rs");
        if !is_mod {
            continue;
        }
        for line in code(&path).lines() {
            let line = line
                .trim_start_matches("pub(crate) ")
                .trim_start_matches("pub ");
            let defines = DEFINITIONS.iter().any(|start| line.starts_with(start));
            assert!(!defines, "{}: {line}", path.display());
        }
    }
}
