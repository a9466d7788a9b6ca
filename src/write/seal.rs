//! Seals: marks in files by which a later run knows that they are whole and what they were made of.
//!
//! A seal is a text of one length in a place where the format keeps texts: `extras` of a glTF, a comment of a PLY, a text
//! chunk of a PNG, a field of a report. It names the fingerprint of everything that the file was made of, says whether all
//! in the file is certified, and has a digest of the whole file, in which the digest itself counts as zeros. A file that was
//! copied half-way, or changed in any byte, does not match its digest.

use std::fmt;
use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

use super::replaced_data;

/// Hexadecimal digits of fingerprints and digests: 128 bits, enough against accidents.
const DIGITS: usize = 32;

/// The first letters of every seal.
const MARK: &str = "photosurface-seal:";

/// The keyword of the text chunk of a PNG.
const KEYWORD: &[u8] = b"Comment\0";

/// How many bytes of a file are in memory at a time.
const PIECE: usize = 1 << 20;

/// The first eight bytes of every PNG.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Length of a PNG up to the end of its header chunk, after which other chunks may stand.
const PNG_HEADER: usize = 8 + 25;

/// A digest of everything that a file is made of: equal fingerprints mean equal files.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Fingerprint([u8; 32]);

impl Default for Fingerprint {
    /// The fingerprint of this version of the program and nothing else.
    fn default() -> Self {
        Self([0; 32]).with("version", &env!("CARGO_PKG_VERSION"))
    }
}

impl Fingerprint {
    /// The fingerprint of everything that this one stands for, and of `value`, which is called `name`.
    #[must_use]
    pub fn with(self, name: &str, value: &impl Debug) -> Self {
        let mut digest = Sha256::new();
        digest.update(self.0);
        digest.update(format!("{name}={value:?}"));
        Self(digest.finalize().into())
    }

    /// The fingerprint of everything that this one stands for, and of the bytes of a file.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn with_file(self, path: &Path) -> io::Result<Self> {
        let mut file = File::open(path)?;
        let mut digest = Sha256::new();
        digest.update(self.0);
        let mut piece = vec![0; PIECE];
        loop {
            match file.read(&mut piece)? {
                0 => return Ok(Self(digest.finalize().into())),
                count => digest.update(&piece[..count]),
            }
        }
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&digits(&self.0))
    }
}

impl Debug for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// What a seal says of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seal {
    /// Of everything that the file was made of.
    pub fingerprint: Fingerprint,
    /// Whether everything in the file is certified.
    pub is_certified: bool,
}

impl Seal {
    /// The text of the seal, with zeros for the digest of the file.
    pub(crate) fn text(&self) -> String {
        let certified = if self.is_certified { 'y' } else { 'n' };
        format!("{}{certified}:{}", self.beginning(), "0".repeat(DIGITS))
    }

    fn beginning(&self) -> String {
        format!("{MARK}{}:", self.fingerprint)
    }

    /// Puts the digest of a file into its seal, whose text with zeros is somewhere in it.
    ///
    /// # Errors
    ///
    /// The file cannot be read or written, or there is no such seal.
    pub(crate) fn close(&self, file: &mut (impl Read + Write + Seek)) -> io::Result<()> {
        let (place, _) = find(file, &self.beginning())?
            .ok_or_else(|| io::Error::other("the seal is not in the file"))?;
        let digest = digest(file, place)?;
        file.seek(SeekFrom::Start(place))?;
        file.write_all(digest.as_bytes())?;
        file.seek(SeekFrom::End(0))?;
        Ok(())
    }

    /// As [`Seal::close`], of a text in memory.
    pub(crate) fn close_text(&self, text: String) -> io::Result<Vec<u8>> {
        let mut file = Cursor::new(text.into_bytes());
        self.close(&mut file)?;
        Ok(file.into_inner())
    }

    /// A PNG with this seal in a text chunk behind its header. The digest is that of the PNG without the chunk.
    pub fn sealed_png(&self, png: &[u8]) -> Vec<u8> {
        let certified = if self.is_certified { 'y' } else { 'n' };
        let digest = digits(&Sha256::digest(png));
        let text = format!("{}{certified}:{digest}", self.beginning());
        let content = [b"tEXt", KEYWORD, text.as_bytes()].concat();
        let (header, rest) = png.split_at(PNG_HEADER.min(png.len()));
        let length = (content.len() - 4) as u32;
        let crc = crc32fast::hash(&content);
        let chunk = [
            &length.to_be_bytes()[..],
            &content[..],
            &crc.to_be_bytes()[..],
        ];
        [header, &chunk.concat(), rest].concat()
    }

    /// The seal of a file, if the file is whole and was made of what `fingerprint` stands for; the data of a `.gltf` must be
    /// whole too. A file that cannot be read is like one that is not there.
    pub fn of_file(path: &Path, fingerprint: Fingerprint) -> Option<Self> {
        let mut file = File::open(path).ok()?;
        let length = file.metadata().ok().filter(|data| data.is_file())?.len();
        let sealed = |is_certified| Self {
            fingerprint,
            is_certified,
        };
        let (place, is_certified) = find(&mut file, &sealed(true).beginning()).ok()??;
        let mut start = [0; PNG.len()];
        file.seek(SeekFrom::Start(0)).ok()?;
        file.read_exact(&mut start).ok()?;
        file.seek(SeekFrom::Start(0)).ok()?;
        if start == PNG {
            let mut bytes = Vec::with_capacity(length as usize);
            file.read_to_end(&mut bytes).ok()?;
            let end = PNG_HEADER + 12 + KEYWORD.len() + sealed(true).text().len();
            let (header, rest) = (bytes.get(..PNG_HEADER)?, bytes.get(end..)?);
            let again = sealed(is_certified).sealed_png(&[header, rest].concat());
            return (again == bytes).then(|| sealed(is_certified));
        }
        let wanted = digits_at(&mut file, place)?;
        let found = digest(&mut file, place).ok()?;
        let is_gltf = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("gltf"));
        let has_data = || replaced_data(path).is_some_and(|data| is_named_by_content(&data));
        (found == wanted && (!is_gltf || has_data())).then(|| sealed(is_certified))
    }
}

/// Whether the digest in the name of the data of a `.gltf` is that of its bytes.
fn is_named_by_content(data: &Path) -> bool {
    let name = data.file_name().and_then(|name| name.to_str());
    match (name, crc_of(data)) {
        (Some(name), Ok(digest)) => name.ends_with(&format!("-{digest:08x}.bin")),
        _ => false,
    }
}

fn crc_of(path: &Path) -> io::Result<u32> {
    let mut file = File::open(path)?;
    let mut digest = crc32fast::Hasher::new();
    let mut piece = vec![0; PIECE];
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(digest.finalize()),
            count => digest.update(&piece[..count]),
        }
    }
}

/// The first digits of a digest.
fn digits(digest: &[u8]) -> String {
    let bytes = digest.iter().take(DIGITS / 2);
    bytes.map(|byte| format!("{byte:02x}")).collect()
}

/// The digits that stand at a place of a file.
fn digits_at(file: &mut (impl Read + Seek), place: u64) -> Option<String> {
    let mut bytes = vec![0; DIGITS];
    file.seek(SeekFrom::Start(place)).ok()?;
    file.read_exact(&mut bytes).ok()?;
    String::from_utf8(bytes).ok()
}

/// Where the digest of the seal with this beginning stands in a file, and whether the seal says that all is certified.
fn find(file: &mut (impl Read + Seek), beginning: &str) -> io::Result<Option<(u64, bool)>> {
    let wanted = beginning.as_bytes();
    // With the letter and the colon that follow.
    let length = wanted.len() + 2;
    let mut bytes = vec![];
    let mut start = 0;
    file.seek(SeekFrom::Start(0))?;
    loop {
        let read = file.by_ref().take(PIECE as u64).read_to_end(&mut bytes)?;
        let mut places = bytes.windows(length);
        if let Some(place) = places.position(|window| window.starts_with(wanted)) {
            let is_certified = bytes[place + wanted.len()] == b'y';
            return Ok(Some((start + (place + length) as u64, is_certified)));
        }
        if read == 0 {
            return Ok(None);
        }
        // A seal may begin in one piece and end in the next.
        let done = bytes.len().saturating_sub(length - 1);
        bytes.drain(..done);
        start += done as u64;
    }
}

/// The digest of a file in which the digest at `place` counts as zeros.
fn digest(file: &mut (impl Read + Seek), place: u64) -> io::Result<String> {
    file.seek(SeekFrom::Start(0))?;
    let mut digest = Sha256::new();
    let mut piece = vec![0; PIECE];
    let mut start = 0;
    loop {
        let count = file.read(&mut piece)?;
        if count == 0 {
            return Ok(digits(&digest.finalize()));
        }
        let end = start + count as u64;
        let (from, to) = (place.max(start), (place + DIGITS as u64).min(end));
        if from < to {
            piece[(from - start) as usize..(to - start) as usize].fill(b'0');
        }
        digest.update(&piece[..count]);
        start = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seal() -> Seal {
        Seal {
            fingerprint: Fingerprint::default().with("a", &1.5),
            is_certified: false,
        }
    }

    #[test]
    fn a_fingerprint_is_of_all_that_went_into_it() {
        let of = |name, value: f64| Fingerprint::default().with(name, &value);
        assert_eq!(of("a", 1.5), of("a", 1.5));
        assert_ne!(of("a", 1.5), of("b", 1.5));
        assert_ne!(of("a", 1.5), of("a", 1.5 + f64::EPSILON));
        assert_ne!(of("a", 0.0), of("a", -0.0));
    }

    #[test]
    fn every_changed_byte_of_a_sealed_file_is_found() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        let text = format!("{}{}{}", "before ".repeat(9), seal().text(), " after");
        let whole = seal().close_text(text).unwrap();
        std::fs::write(&path, &whole).unwrap();
        let fingerprint = seal().fingerprint;
        assert_eq!(Seal::of_file(&path, fingerprint), Some(seal()));
        assert_eq!(Seal::of_file(&path, fingerprint.with("b", &2)), None);
        for place in 0..whole.len() {
            let mut changed = whole.clone();
            changed[place] ^= 1;
            std::fs::write(&path, &changed).unwrap();
            assert_eq!(Seal::of_file(&path, fingerprint), None, "{place}");
            std::fs::write(&path, &whole[..place]).unwrap();
            assert_eq!(Seal::of_file(&path, fingerprint), None, "cut at {place}");
        }
        std::fs::write(&path, [&whole[..], b" "].concat()).unwrap();
        assert_eq!(Seal::of_file(&path, fingerprint), None, "longer");
        assert_eq!(Seal::of_file(directory.path(), fingerprint), None);
    }

    #[test]
    fn every_changed_byte_of_a_sealed_picture_is_found() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        let mut plain = Vec::new();
        let picture = image::RgbImage::from_fn(5, 4, |x, y| image::Rgb([x as u8, y as u8, 7]));
        let format = image::ImageFormat::Png;
        picture
            .write_to(&mut Cursor::new(&mut plain), format)
            .unwrap();
        let whole = seal().sealed_png(&plain);
        std::fs::write(&path, &whole).unwrap();
        assert_eq!(image::open(&path).unwrap().to_rgb8(), picture);
        assert_eq!(Seal::of_file(&path, seal().fingerprint), Some(seal()));
        for place in 0..whole.len() {
            let mut changed = whole.clone();
            changed[place] ^= 1;
            std::fs::write(&path, &changed).unwrap();
            assert_eq!(Seal::of_file(&path, seal().fingerprint), None, "{place}");
            std::fs::write(&path, &whole[..place]).unwrap();
            assert_eq!(Seal::of_file(&path, seal().fingerprint), None, "{place}");
        }
    }

    /// A seal across the border of two pieces that are read.
    #[test]
    fn a_seal_is_found_wherever_it_stands() {
        for before in [PIECE - 70, PIECE - 20, PIECE, 3 * PIECE - 50] {
            let mut text = vec![b'.'; before];
            text.extend_from_slice(seal().text().as_bytes());
            text.extend_from_slice(&[b','; 40]);
            let mut file = Cursor::new(text);
            seal().close(&mut file).unwrap();
            let place = (before + seal().text().len() - DIGITS) as u64;
            let found = find(&mut file, &seal().beginning()).unwrap();
            assert_eq!(found, Some((place, false)));
            let wanted = digits_at(&mut file, place).unwrap();
            assert_eq!(digest(&mut file, place).unwrap(), wanted);
        }
    }
}
