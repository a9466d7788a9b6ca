//! Which files may be read, and how much memory the pictures in them may take.
//!
//! Whoever names a file on the command line wants that file read. What the file names in turn was written by somebody
//! else: it is read where it plausibly belongs to the file, and nowhere else.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use super::ReadError;

/// Pixels of all textures together, unless said otherwise: four textures of 8192 by 8192, or 1 GiB once they are decoded.
const MAX_TEXTURE_PIXELS: u64 = 1 << 28;

/// Bytes that no pixel needs more of in a picture's file: four channels of 16 bits.
const BYTES_OF_PIXEL: u64 = 8;

/// What may be read of files that other files name: the files of a scene's objects, buffers and images of glTF, material
/// libraries and images of OBJ.
///
/// A named file is read if it lies in the folder of the file that the caller names, in the working directory, in one of
/// [`folders`](Self::folders), or below one of these, once all links are followed. A working directory that is the root of
/// the file system does not count. Only ordinary files are read: no pipe, no device, no folder.
///
/// # Example
///
/// ```
/// use photosurface::read::Access;
///
/// let access = Access { folders: vec!["/usr/share/models".into()], ..Access::default() };
/// let (model, _) = access.read_model("fixtures/meshes/external.gltf".as_ref())?;
/// assert_eq!(model.parts.len(), 1);
/// # Ok::<(), photosurface::read::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Access {
    /// Folders in which and below which files are read too, `--allow-read` of the command; one that does not exist
    /// allows nothing.
    pub folders: Vec<PathBuf>,
    /// How many pixels may be decoded to change the format of the pictures of one model; their files may have eight bytes
    /// for each. A picture that is too large is left out with a note.
    pub max_texture_pixels: u64,
}

impl Default for Access {
    /// No further folder, and 2^28 pixels.
    fn default() -> Self {
        Self {
            folders: vec![],
            max_texture_pixels: MAX_TEXTURE_PIXELS,
        }
    }
}

impl Access {
    /// What may be read on behalf of a file in `folder`.
    pub(crate) fn reach(&self, folder: &Path) -> Reach {
        let own = fs::canonicalize(or_here(folder)).ok();
        let working = std::env::current_dir().and_then(fs::canonicalize).ok();
        let working = working.filter(|folder| folder.parent().is_some());
        let further = self.folders.iter().map(|folder| or_here(folder));
        let further = further.filter_map(|folder| fs::canonicalize(folder).ok());
        Reach {
            folders: own.into_iter().chain(working).chain(further).collect(),
            max_pixels: self.max_texture_pixels,
        }
    }
}

/// The folders in which files are read that other files name, with all links followed.
#[derive(Clone)]
pub(crate) struct Reach {
    folders: Vec<PathBuf>,
    pub(super) max_pixels: u64,
}

impl Reach {
    /// How many bytes the files of the pictures of one model may have.
    pub(super) fn max_picture_bytes(&self) -> u64 {
        self.max_pixels.saturating_mul(BYTES_OF_PIXEL)
    }

    /// Opens an ordinary file in reach.
    pub(super) fn open(&self, path: &Path) -> Result<(File, Metadata), ReadError> {
        let place = self.resolve(path)?;
        let (file, metadata) = open_ordinary(&place).map_err(|error| error.at(path))?;
        // Somebody may have put a link in its place meanwhile.
        let found = self.resolve(path)?;
        let there = fs::metadata(&found).map_err(|source| file_error(path, source))?;
        if found != place || !is_same(&metadata, &there) {
            let source = io::Error::other("it was replaced while it was opened");
            return Err(file_error(path, source));
        }
        Ok((file, metadata))
    }

    /// Where a file lies once all links are followed, if it is in reach; a file that does not exist is an error of its
    /// own only where it might be read.
    pub(crate) fn resolve(&self, path: &Path) -> Result<PathBuf, ReadError> {
        let (place, missing) = match fs::canonicalize(or_here(path)) {
            Ok(place) => (place, None),
            Err(source) => (would_be(path), Some(source)),
        };
        if !self.folders.iter().any(|folder| place.starts_with(folder)) {
            return Err(ReadError::OutOfReach {
                path: path.to_owned(),
                folder: place.parent().unwrap_or(&place).to_owned(),
            });
        }
        match missing {
            Some(source) => Err(file_error(path, source)),
            None => Ok(place),
        }
    }
}

/// Where a file would be that cannot be found: the links of the folders that exist are followed.
fn would_be(path: &Path) -> PathBuf {
    let path = match std::env::current_dir() {
        Ok(here) => here.join(path),
        Err(_) => path.to_owned(),
    };
    let known = path
        .ancestors()
        .find_map(|folder| Some((fs::canonicalize(folder).ok()?, folder)));
    let (mut place, rest) = match known {
        Some((place, folder)) => (place, path.strip_prefix(folder).unwrap_or(&path)),
        None => (PathBuf::new(), path.as_path()),
    };
    for component in rest.components() {
        match component {
            Component::ParentDir => {
                place.pop();
            }
            Component::CurDir => {}
            other => place.push(other),
        }
    }
    place
}

/// A folder without a name is the working directory.
fn or_here(path: &Path) -> &Path {
    match path.as_os_str().is_empty() {
        true => Path::new("."),
        false => path,
    }
}

/// Opens an ordinary file, wherever it lies; pipes, which may have no writer, and devices are not even opened.
pub(super) fn open_ordinary(path: &Path) -> Result<(File, Metadata), ReadError> {
    let ordinary = |metadata: Metadata| match what_else(&metadata) {
        None => Ok(metadata),
        Some(found) => Err(ReadError::NotOrdinary {
            path: path.to_owned(),
            found,
        }),
    };
    let system = |source| file_error(path, source);
    ordinary(fs::metadata(path).map_err(system)?)?;
    let file = File::open(path).map_err(system)?;
    let metadata = ordinary(file.metadata().map_err(system)?)?;
    Ok((file, metadata))
}

/// Reads an ordinary file, all of it.
///
/// # Errors
///
/// A file that cannot be read, that is no ordinary one, or that has more than `limit` bytes.
pub fn read_whole(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let (file, metadata) = open_ordinary(path)?;
    let too_long = || ReadError::TooLong {
        path: path.to_owned(),
        limit,
    };
    if metadata.len() > limit {
        return Err(too_long());
    }
    let mut bytes = vec![];
    file.take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|source| file_error(path, source))?;
    match bytes.len() as u64 > limit {
        true => Err(too_long()),
        false => Ok(bytes),
    }
}

fn file_error(path: &Path, source: io::Error) -> ReadError {
    ReadError::File {
        path: path.to_owned(),
        source,
    }
}

/// What something is that is no ordinary file.
fn what_else(metadata: &Metadata) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = metadata.file_type();
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_char_device() || kind.is_block_device() {
            return Some("a device");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    match (metadata.is_file(), metadata.is_dir()) {
        (true, _) => None,
        (_, true) => Some("a folder"),
        _ => Some("something else"),
    }
}

#[cfg(unix)]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    (one.len(), one.created().ok()) == (other.len(), other.created().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with `inside/model` and `secret/key` in it.
    fn folders() -> tempfile::TempDir {
        let all = tempfile::tempdir().unwrap();
        for (folder, file) in [("inside", "model"), ("secret", "key")] {
            fs::create_dir(all.path().join(folder)).unwrap();
            fs::write(all.path().join(folder).join(file), file).unwrap();
        }
        all
    }

    fn read(reach: &Reach, path: &Path) -> Result<String, ReadError> {
        let mut text = String::new();
        let (mut file, _) = reach.open(path)?;
        file.read_to_string(&mut text).unwrap();
        Ok(text)
    }

    #[test]
    fn a_file_outside_is_refused_however_it_is_named() {
        let all = folders();
        let (inside, secret) = (all.path().join("inside"), all.path().join("secret"));
        let reach = Access::default().reach(&inside);
        assert_eq!(read(&reach, &inside.join("model")).unwrap(), "model");
        assert_eq!(
            read(&reach, &inside.join("../inside/./model")).unwrap(),
            "model"
        );
        for name in [
            "../secret/key",
            "./../secret/key",
            "../inside/../secret/key",
            // Whether something is there is nobody's business.
            "../secret/nothing",
            "nothing/../../secret/key",
        ] {
            let error = read(&reach, &inside.join(name)).unwrap_err();
            assert!(matches!(error, ReadError::OutOfReach { .. }), "{error}");
            let folder = fs::canonicalize(&secret).unwrap();
            let advice = format!("--allow-read {folder:?}");
            assert!(error.to_string().contains(&advice), "{error}");
        }
        let error = read(&reach, &secret.join("key")).unwrap_err();
        assert!(matches!(error, ReadError::OutOfReach { .. }), "{error}");
        let error = read(&reach, &inside.join("nothing/at/all")).unwrap_err();
        assert!(matches!(error, ReadError::File { .. }), "{error}");
        // A name that only begins alike is another folder.
        fs::create_dir(all.path().join("inside too")).unwrap();
        fs::write(all.path().join("inside too/key"), "").unwrap();
        let error = read(&reach, &inside.join("../inside too/key")).unwrap_err();
        assert!(matches!(error, ReadError::OutOfReach { .. }), "{error}");

        let access = Access {
            folders: vec![secret.clone()],
            ..Access::default()
        };
        assert_eq!(
            read(&access.reach(&inside), &inside.join("../secret/key")).unwrap(),
            "key"
        );
    }

    #[test]
    fn the_working_directory_is_within_reach() {
        let reach = Access::default().reach(Path::new("nowhere"));
        assert!(read(&reach, Path::new("Cargo.toml")).is_ok());
        assert!(matches!(
            read(&reach, Path::new("nowhere/a")),
            Err(ReadError::File { .. })
        ));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_before_the_place_is_judged() {
        use std::os::unix::fs::symlink;
        let all = folders();
        let inside = all.path().join("inside");
        symlink("../secret/key", inside.join("file")).unwrap();
        symlink("../secret", inside.join("folder")).unwrap();
        symlink("../secret/nothing", inside.join("dangling")).unwrap();
        symlink("model", inside.join("own")).unwrap();
        // The same folder by another way is the same folder.
        symlink("inside", all.path().join("other")).unwrap();
        let reach = Access::default().reach(&all.path().join("other"));
        for name in ["file", "folder/key", "folder/nothing"] {
            let error = read(&reach, &inside.join(name)).unwrap_err();
            assert!(matches!(error, ReadError::OutOfReach { .. }), "{error}");
        }
        assert_eq!(read(&reach, &inside.join("own")).unwrap(), "model");
        assert!(read(&reach, &inside.join("dangling")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn nothing_but_ordinary_files_is_opened() {
        for (path, found) in [("/dev/zero", "a device"), ("src", "a folder")] {
            let error = open_ordinary(Path::new(path)).unwrap_err();
            let expected = format!("{path:?} is {found}, expected an ordinary file");
            assert_eq!(error.to_string(), expected);
        }
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert!(matches!(
            open_ordinary(&socket),
            Err(ReadError::NotOrdinary {
                found: "a socket",
                ..
            })
        ));
    }

    #[test]
    fn what_is_too_long_is_not_read() {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), "four").unwrap();
        assert_eq!(read_whole(file.path(), 4).unwrap(), b"four");
        let error = read_whole(file.path(), 3).unwrap_err();
        assert!(matches!(error, ReadError::TooLong { limit: 3, .. }));
        // It takes no memory and no time, though there is hardly so much of either.
        file.as_file().set_len(1 << 42).unwrap();
        assert!(read_whole(file.path(), 1 << 20).is_err());
    }
}
