//! Files that appear whole or not at all: written beside their place, then renamed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, Metadata};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile, TempDir};
use thiserror::Error;

use super::WriteError;
use super::child::SharedChild;

/// Links that are followed before they are taken to go round in circles, as on Linux.
const MAX_LINKS: usize = 40;

/// The place that writing to `path` would change, links followed: the same for all names of one file, also
/// of one that does not exist yet. Says whether it could be written, without touching what may stand there:
/// to be asked before long work is begun.
///
/// # Errors
///
/// The directory does not exist or cannot be written to, or `path` is a directory.
pub fn destination(path: &Path) -> Result<PathBuf, WriteError> {
    match Destination::of(path)? {
        Destination::Special(place) => Ok(place),
        Destination::Regular(place) => temporary_beside(&place).map(|_| place),
    }
    .map_err(|source| io_error(path, source))
}

/// What a file is, to those who write it.
pub enum Target<'a> {
    /// Something with places, empty as yet.
    File {
        /// To be read and written anywhere.
        file: &'a mut File,
        /// Where the file itself has to find room, and what has to wait may too.
        directory: &'a Path,
    },
    /// Something that takes one byte after the other.
    Stream(&'a mut dyn Write),
}

/// Writes a file with `content`; it appears whole or not at all, and what stood there is kept until then.
///
/// A link is followed; what is no regular file (a device, a pipe) is written to as it is.
///
/// # Errors
///
/// The file cannot be written, one that is there is read-only, or `content` fails.
pub fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    write_whole_target(path, |target| match target {
        Target::File { file, .. } => {
            let mut writer = BufWriter::new(file);
            content(&mut writer)?;
            Ok(writer.flush()?)
        }
        Target::Stream(stream) => content(stream),
    })
}

/// As [`write_whole`], for content that does not come in the order in which it stands in the file.
///
/// # Errors
///
/// As [`write_whole`].
pub fn write_whole_target(
    path: &Path,
    content: impl FnOnce(Target<'_>) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let here = |source| io_error(path, source);
    let told = |error| match error {
        WriteError::Stream(source) => here(source),
        other => other,
    };
    match Destination::of(path)? {
        Destination::Special(place) => {
            let file = File::options().write(true).open(place).map_err(here)?;
            let mut writer = BufWriter::new(file);
            content(Target::Stream(&mut writer)).map_err(told)?;
            writer.flush().map_err(here)
        }
        Destination::Regular(place) => {
            let mut unfinished = temporary_beside(&place).map_err(here)?;
            let directory = directory_of(&place);
            let file = unfinished.file();
            content(Target::File { file, directory }).map_err(told)?;
            unfinished.persist(&place).map_err(here)
        }
    }
}

pub(super) enum Destination {
    /// A file that is there or can be made, links followed.
    Regular(PathBuf),
    /// Something else that can be written to.
    Special(PathBuf),
}

impl Destination {
    pub(super) fn of(path: &Path) -> Result<Self, WriteError> {
        match fs::canonicalize(path) {
            Ok(place) => {
                let data = fs::metadata(&place).map_err(|source| io_error(path, source))?;
                let kind = data.file_type();
                if kind.is_file() && data.permissions().readonly() {
                    // A rename would replace it whatever it allows.
                    let kind = std::io::ErrorKind::PermissionDenied;
                    let source =
                        std::io::Error::new(kind, "the file is read-only, permission denied");
                    return Err(io_error(path, source));
                }
                if kind.is_dir() {
                    let source = std::io::Error::from(std::io::ErrorKind::IsADirectory);
                    return Err(io_error(path, source));
                }
                Ok(if kind.is_file() {
                    Self::Regular(place)
                } else {
                    Self::Special(place)
                })
            }
            Err(_) => new_file(path)
                .map(Self::Regular)
                .map_err(|source| io_error(path, source)),
        }
    }
}

/// Where a file that does not exist yet would come to stand; a link that leads to nothing says where.
fn new_file(path: &Path) -> std::io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Some(name) = path.file_name() else {
            return Err(std::io::ErrorKind::IsADirectory.into());
        };
        let place = fs::canonicalize(directory_of(&path))?.join(name);
        match fs::read_link(&place) {
            // A relative link starts from where it stands.
            Ok(target) => path = directory_of(&place).join(target),
            Err(_) => return Ok(place),
        }
    }
    Err(std::io::Error::other(
        "too many links, or links in a circle",
    ))
}

pub(super) fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// All writes in progress.
static WRITES: Mutex<Writes> = Mutex::new(Writes {
    unfinished: BTreeSet::new(),
    scratch: BTreeSet::new(),
    helpers: BTreeMap::new(),
    are_abandoned: false,
});

pub(super) struct Writes {
    /// Their temporary files.
    unfinished: BTreeSet<PathBuf>,
    /// Folders that go when their owners end.
    scratch: BTreeSet<PathBuf>,
    /// Programs that write some of them, by their process ids.
    pub(super) helpers: BTreeMap<u32, SharedChild>,
    /// Whether no file may be begun or finished any more.
    are_abandoned: bool,
}

/// What writing ends with once it has been abandoned.
#[derive(Debug, Error)]
#[error("cancelled")]
struct Cancelled;

impl Writes {
    pub(super) fn lock() -> MutexGuard<'static, Self> {
        // A set of names is sound whoever panicked.
        WRITES.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Those in progress, where they may go on.
    pub(super) fn going_on() -> std::io::Result<MutexGuard<'static, Self>> {
        let writes = Self::lock();
        match writes.are_abandoned {
            true => Err(std::io::Error::other(Cancelled)),
            false => Ok(writes),
        }
    }
}

/// Removes the temporary files of all writes in progress, and stops all writing for good: for a program that
/// was told to end. What was finished before stays; every other write ends with [`WriteError::Cancelled`].
pub fn abandon_writes() {
    let mut writes = Writes::lock();
    writes.are_abandoned = true;
    // First: what they have open they would make anew.
    for helper in writes.helpers.values() {
        helper.end();
    }
    for path in &writes.unfinished {
        // There is nobody left to tell.
        let _ = fs::remove_file(path);
    }
    for path in &writes.scratch {
        let _ = fs::remove_dir_all(path);
    }
}

/// Whether all writing has been abandoned: errors after that are those of a program that was told to end.
pub fn writes_are_abandoned() -> bool {
    Writes::lock().are_abandoned
}

/// A folder for files that nobody keeps, among the system's temporary files; [`abandon_writes`] knows of it.
pub(crate) struct ScratchFolder(TempDir);

impl ScratchFolder {
    /// # Errors
    ///
    /// The folder cannot be made, or all writing has been abandoned.
    pub(crate) fn new() -> Result<Self, WriteError> {
        let parent = std::env::temp_dir();
        let mut writes = Writes::going_on().map_err(|source| io_error(&parent, source))?;
        let folder = Builder::new().prefix(".photosurface-").tempdir_in(&parent);
        let folder = folder.map_err(|source| io_error(&parent, source))?;
        writes.scratch.insert(folder.path().to_owned());
        Ok(Self(folder))
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        Writes::lock().scratch.remove(self.path());
    }
}

/// A temporary file that [`abandon_writes`] knows of.
pub(super) struct Unfinished {
    file: Option<NamedTempFile>,
    path: PathBuf,
    /// Of the file that it will replace.
    replaced: Option<Metadata>,
}

impl Unfinished {
    fn begin(
        make: impl FnOnce() -> std::io::Result<NamedTempFile>,
        replaced: Option<Metadata>,
    ) -> std::io::Result<Self> {
        let mut writes = Writes::going_on()?;
        let file = make()?;
        // Absolute or not: the program never changes its directory.
        let path = file.path().to_owned();
        writes.unfinished.insert(path.clone());
        let file = Some(file);
        Ok(Self {
            file,
            path,
            replaced,
        })
    }

    /// Where it is until it is finished.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn file(&mut self) -> &mut File {
        let file = self.file.as_mut();
        file.expect("there until it is persisted").as_file_mut()
    }

    /// Gives the file to whoever has the one that it replaces, with the same permissions, and takes it out.
    fn finished(&mut self) -> std::io::Result<NamedTempFile> {
        if let Some(replaced) = self.replaced.take() {
            let file = self.file();
            #[cfg(unix)]
            {
                use std::os::unix::fs::{MetadataExt, fchown};
                let own = file.metadata()?;
                let (owner, group) = (replaced.uid(), replaced.gid());
                if (own.uid(), own.gid()) != (owner, group) {
                    // Only some may give files away; the others own what they write.
                    let _ = fchown(&*file, Some(owner), Some(group));
                }
            }
            file.set_permissions(replaced.permissions())?;
        }
        Ok(self.file.take().expect("only this takes it, and only once"))
    }

    pub(super) fn persist(mut self, place: &Path) -> std::io::Result<()> {
        let file = self.finished()?;
        // Held while the file gets its name: it is either unfinished or finished.
        let writes = Writes::going_on()?;
        let persisted = file.persist(place);
        drop(writes);
        persisted.map(drop).map_err(|error| error.error)
    }
}

/// Gives two files their names, `first` first; a signal finds both with their names or neither, and where the second
/// cannot have its own, the first is gone too, unless it replaced another.
pub(super) fn persist_both(
    (mut first, first_place): (Unfinished, &Path),
    (mut second, second_place): (Unfinished, &Path),
) -> std::io::Result<()> {
    let (first_file, second_file) = (first.finished()?, second.finished()?);
    let writes = Writes::going_on()?;
    let is_new = !first_place.exists();
    let persisted = first_file.persist(first_place).and_then(|_| {
        second_file.persist(second_place).inspect_err(|_| {
            if is_new {
                // There is nothing else to be done about it.
                let _ = fs::remove_file(first_place);
            }
        })
    });
    drop(writes);
    persisted.map(drop).map_err(|error| error.error)
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        // The file first: it must not be there when its name is forgotten.
        drop(self.file.take());
        Writes::lock().unfinished.remove(&self.path);
    }
}

pub(super) fn temporary_beside(place: &Path) -> std::io::Result<Unfinished> {
    temporary_in(directory_of(place), fs::metadata(place).ok())
}

/// A temporary file that may be read by those who may read what it will replace.
pub(super) fn temporary_in(
    directory: &Path,
    replaced: Option<Metadata>,
) -> std::io::Result<Unfinished> {
    let mut builder = Builder::new();
    builder.prefix(".photosurface-");
    #[cfg(unix)]
    {
        // The permissions of any new file; while it is not known that others may read what it replaces, they may not.
        use std::os::unix::fs::PermissionsExt;
        let mode = if replaced.is_some() { 0o600 } else { 0o666 };
        builder.permissions(fs::Permissions::from_mode(mode));
    }
    Unfinished::begin(|| builder.tempfile_in(directory), replaced)
}

/// An error where all writing has been abandoned.
pub(super) fn check_going_on() -> Result<(), WriteError> {
    Writes::going_on()
        .map(drop)
        .map_err(|_| WriteError::Cancelled)
}

/// Whether an error says that all writing has been abandoned.
pub(super) fn is_cancelled(error: &std::io::Error) -> bool {
    error.get_ref().is_some_and(|said| said.is::<Cancelled>())
}

pub(super) fn io_error(path: &Path, source: std::io::Error) -> WriteError {
    if is_cancelled(&source) {
        return WriteError::Cancelled;
    }
    // tempfile names its file behind what the system says; nobody else knows that file.
    let text = source.to_string();
    let source = match text.split_once(" at path ") {
        Some((said, _)) if source.get_ref().is_some() => {
            std::io::Error::new(source.kind(), said.to_owned())
        }
        _ => source,
    };
    WriteError::Io {
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_what_was_there() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.glb");
        fs::write(&path, "old").unwrap();
        let failed = write_whole(&path, |writer| {
            writer.write_all(b"half")?;
            Err(WriteError::Empty("x".into()))
        });
        assert!(matches!(failed, Err(WriteError::Empty(_))));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(
            fs::read_dir(directory.path()).unwrap().count(),
            1,
            "nothing is left beside it"
        );

        write_whole(&path, |writer| Ok(writer.write_all(b"new")?)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_new_files_have_ordinary_permissions() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let directory = tempfile::tempdir().unwrap();
        let (real, link) = (directory.path().join("real"), directory.path().join("link"));
        let plain = directory.path().join("plain");
        fs::write(&real, "old").unwrap();
        fs::write(&plain, "").unwrap();
        symlink(&real, &link).unwrap();
        write_whole(&link, |writer| Ok(writer.write_all(b"new")?)).unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&real), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_leads_to_nothing_says_where_the_new_file_belongs() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        fs::create_dir(path("far")).unwrap();
        symlink("far/target", path("link")).unwrap();
        symlink("link", path("again")).unwrap();
        assert_eq!(
            destination(&path("again")).unwrap(),
            destination(&path("far/../far/target")).unwrap()
        );
        write_whole(&path("again"), |writer| Ok(writer.write_all(b"new")?)).unwrap();
        assert_eq!(fs::read(path("far/target")).unwrap(), b"new");
        assert!(fs::symlink_metadata(path("link")).unwrap().is_symlink());
        symlink("round", path("round")).unwrap();
        let message = destination(&path("round")).unwrap_err();
        assert!(message.to_string().contains("round"), "{message}");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_named_before_work_begins() {
        let directory = tempfile::tempdir().unwrap();
        let missing = directory.path().join("no/such/place.glb");
        let message = destination(&missing).unwrap_err().to_string();
        assert!(message.contains("place.glb"), "{message}");
        assert!(destination(directory.path()).is_err());
        let fine = directory.path().join("fine.glb");
        let place = destination(&fine).unwrap();
        assert_eq!(place.file_name(), fine.file_name());
        assert!(!fine.exists());
    }
}
