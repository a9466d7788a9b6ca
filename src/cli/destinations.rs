//! Where files go, looked at before any work.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{bail, ensure};
use photosurface::destination;

/// Before any work: every file can be written, none is one of those that are read, and no two are one. What goes to
/// stdout is left out.
pub(super) fn check_destinations(
    written: impl IntoIterator<Item = PathBuf>,
    read: &[PathBuf],
) -> anyhow::Result<()> {
    let read: HashSet<_> = read
        .iter()
        .filter_map(|file| fs::canonicalize(file).ok())
        .collect();
    let mut places: HashMap<PathBuf, PathBuf> = HashMap::new();
    for file in written.into_iter().filter(|file| !is_stdout(file)) {
        let place = destination(&file)?;
        ensure!(
            !read.contains(&place),
            "{}: would be written over what is read; choose another name",
            file.display()
        );
        if let Some(other) = places.get(&place) {
            bail!(
                "{}: would be written over {}, which is an output too; choose another name",
                file.display(),
                other.display()
            );
        }
        places.insert(place, file);
    }
    Ok(())
}

/// Whether `-` was said in place of a file.
pub(super) fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}
