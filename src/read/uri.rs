//! References from a glTF file to other files, and data written in place of them.
//!
//! glTF 2.0, section 2.8: relative paths as in RFC 3986, with reserved characters percent-encoded,
//! and data URIs as in RFC 2397. Everything else would have to be fetched and is refused.

use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};

use data_url::DataUrl;
use percent_encoding::percent_decode_str;

use super::access::Reach;
use super::bytes::Bytes;
use super::error::reason;
use super::{ReadError, UriProblem};

/// The folder of a file, in which those that it refers to are looked for; keeps account of what was opened.
pub(super) struct Folder<'a> {
    path: &'a Path,
    reach: Reach,
    opened: RefCell<Vec<PathBuf>>,
    /// How many bytes of pictures may still be read, and how many pixels decoded.
    left: Cell<Left>,
}

/// What of the limits of one model is left.
#[derive(Clone, Copy)]
struct Left {
    picture_bytes: u64,
    pixels: u64,
}

impl<'a> Folder<'a> {
    /// A folder where nothing but what is in `reach` is read.
    pub(super) fn within(path: &'a Path, reach: Reach) -> Self {
        let left = Left {
            picture_bytes: reach.max_picture_bytes(),
            pixels: reach.max_pixels,
        };
        Self {
            path,
            reach,
            opened: RefCell::default(),
            left: left.into(),
        }
    }

    /// A folder and what may be read for files in it by default.
    #[cfg(test)]
    pub(super) fn new(path: &'a Path) -> Self {
        Self::within(path, super::Access::default().reach(path))
    }

    /// How many pixels may still be decoded.
    pub(super) fn pixels_left(&self) -> u64 {
        self.left.get().pixels
    }

    /// Takes account of pixels that were decoded, as many as are left at most.
    pub(super) fn take_pixels(&self, pixels: u64) {
        let mut left = self.left.get();
        left.pixels = left.pixels.saturating_sub(pixels);
        self.left.set(left);
    }

    /// All bytes of a picture, if they do not exceed what may be read of pictures.
    pub(super) fn picture(&self, bytes: Bytes) -> Result<Vec<u8>, String> {
        let mut left = self.left.get();
        let length = bytes.len() as u64;
        left.picture_bytes = left.picture_bytes.checked_sub(length).ok_or_else(|| {
            format!(
                "it has {length} bytes, expected at most {} for all pictures of a model together; \
                 --max-texture-pixels allows more",
                self.reach.max_picture_bytes()
            )
        })?;
        self.left.set(left);
        bytes.into_vec().map_err(|error| reason(&error))
    }

    pub(super) fn path(&self) -> &Path {
        self.path
    }

    /// Where an ordinary file lies that may be read, with all links followed; of others nothing is told, not even
    /// whether they exist.
    pub(super) fn place_of(&self, path: &Path) -> Option<PathBuf> {
        let place = self.reach.resolve(path).ok()?;
        place.is_file().then_some(place)
    }

    /// The bytes of a file, at most `limit` of them.
    pub(super) fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
        self.open(path, limit)?.into_vec()
    }

    /// At most `limit` bytes of a file, to be read when they are wanted.
    pub(super) fn open(&self, path: &Path, limit: u64) -> Result<Bytes<'static>, ReadError> {
        let bytes = Bytes::open_in(&self.reach, path, limit)?;
        self.opened.borrow_mut().push(path.to_owned());
        Ok(bytes)
    }

    /// Takes account of a file that `uri` refers to and nobody needs: it belongs to what is read all the same.
    pub(super) fn mention(&self, uri: &str) {
        if let (None, Ok(relative)) = (scheme(uri), decode_path(uri)) {
            self.opened.borrow_mut().push(self.path.join(relative));
        }
    }

    /// All files that were read or mentioned.
    pub(super) fn into_opened(self) -> Vec<PathBuf> {
        self.opened.into_inner()
    }
}

/// The bytes that `uri` stands for, at most `limit` of them; `place` says where it stands.
pub(super) fn read_uri(
    uri: &str,
    folder: &Folder,
    limit: u64,
    place: &str,
) -> Result<Bytes<'static>, ReadError> {
    let wrong = |problem| ReadError::Uri {
        place: place.to_owned(),
        problem,
    };
    match scheme(uri) {
        Some("data") => Ok(Bytes::Held(decode_data(uri).map_err(wrong)?.into())),
        Some(scheme) => Err(wrong(UriProblem::Scheme {
            uri: shortened(uri),
            scheme: scheme.to_owned(),
        })),
        None => {
            let relative = decode_path(uri).map_err(wrong)?;
            folder.open(&folder.path.join(relative), limit)
        }
    }
}

/// What stands before the first colon, if that makes a scheme (RFC 3986, section 3.1).
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let allowed = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    (scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(allowed))
        .then_some(scheme)
}

fn decode_data(uri: &str) -> Result<Vec<u8>, UriProblem> {
    DataUrl::process(uri)
        .ok()
        .and_then(|data| data.decode_to_vec().ok())
        .map(|(bytes, _fragment)| bytes)
        .ok_or_else(|| UriProblem::Data {
            uri: shortened(uri),
        })
}

fn decode_path(uri: &str) -> Result<PathBuf, UriProblem> {
    let decoded = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| UriProblem::NotUtf8 {
            uri: shortened(uri),
        })?;
    let path = PathBuf::from(decoded.into_owned());
    if path.has_root() {
        return Err(UriProblem::Absolute {
            uri: shortened(uri),
        });
    }
    Ok(path)
}

fn shortened(uri: &str) -> String {
    if uri.chars().count() <= 60 {
        return uri.to_owned();
    }
    uri.chars().take(57).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(uri: &str) -> Result<Vec<u8>, ReadError> {
        read_uri(
            uri,
            &Folder::new(Path::new("nowhere")),
            100,
            "buffers[0].uri",
        )?
        .into_vec()
    }

    #[test]
    fn data_is_decoded() {
        let uri = "data:application/octet-stream;base64,AQID";
        assert_eq!(read(uri).unwrap(), [1, 2, 3]);
        assert_eq!(read("data:,a%20b").unwrap(), b"a b");
        let error = read("data:;base64,????").unwrap_err().to_string();
        assert!(error.starts_with("buffers[0].uri: holds \"data:;base64,????\", expected"));
    }

    #[test]
    fn what_would_have_to_be_fetched_is_refused_by_name() {
        assert_eq!(
            read("https://example.org/a.bin").unwrap_err().to_string(),
            "buffers[0].uri: refers to \"https://example.org/a.bin\" by the scheme \"https\", \
             expected a relative path or a data URI"
        );
        let error = read("/etc/passwd").unwrap_err().to_string();
        assert!(error.contains("expected a path relative to the file"));
    }

    #[test]
    fn a_path_is_decoded() {
        assert_eq!(decode_path("a%20b%23.bin"), Ok(PathBuf::from("a b#.bin")));
        // A colon behind a slash makes no scheme, nor does a leading digit.
        assert_eq!(scheme("./a:b.bin"), None);
        assert_eq!(scheme("1:b.bin"), None);
        assert!(matches!(
            decode_path("%ff.bin"),
            Err(UriProblem::NotUtf8 { .. })
        ));
        assert!(matches!(read("a.bin"), Err(ReadError::File { path, .. })
            if path == Path::new("nowhere/a.bin")));
    }

    #[test]
    fn a_long_uri_is_shortened_in_messages() {
        let long = "é".repeat(100);
        assert_eq!(shortened(&long).chars().count(), 60);
    }
}
