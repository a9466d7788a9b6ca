//! Text files as programs on any machine write them, as lines.
//!
//! Lines end in LF, CR LF or CR alone; byte-order marks may begin any line, as in files that were put together;
//! UTF-16 is made into UTF-8. Names in other encodings keep their bytes, by which they are compared, and are
//! shown as Latin-1.

use std::borrow::Cow;

/// The mark that begins some files in UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// The bytes of a text file with ASCII as one byte for each character.
pub(super) fn as_bytes_of_ascii(file: &[u8]) -> Cow<'_, [u8]> {
    let from_pair: fn([u8; 2]) -> u16 = match file {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        // A text starts with ASCII, with or without a mark.
        [1..=255, 0, 1..=255, 0, ..] => u16::from_le_bytes,
        [0, 1..=255, 0, 1..=255, ..] => u16::from_be_bytes,
        _ => return file.into(),
    };
    let units = file.as_chunks().0.iter().map(|&pair| from_pair(pair));
    let text: String = char::decode_utf16(units)
        .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect();
    text.into_bytes().into()
}

/// The bytes of a text file without a byte-order mark of UTF-8 before them.
pub(super) fn without_mark(file: &[u8]) -> &[u8] {
    file.strip_prefix(MARK).unwrap_or(file)
}

/// The lines of a file, without their ends and byte-order marks.
pub(super) fn lines(file: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(file).filter(|file| !file.is_empty());
    std::iter::from_fn(move || {
        let now = rest?;
        let end = now.iter().position(|&byte| byte == b'\n' || byte == b'\r');
        let line = &now[..end.unwrap_or(now.len())];
        rest = end.map(|end| match &now[end..] {
            [b'\r', b'\n', behind @ ..] => behind,
            behind => &behind[1..],
        });
        rest = rest.filter(|rest| !rest.is_empty());
        Some(without_mark(line))
    })
}

/// The first word of a line, and what stands behind it without the spaces around.
pub(super) fn split_statement(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace);
    let (statement, rest) = line.split_at(end.unwrap_or(line.len()));
    (statement, rest.trim_ascii())
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = line.split(u8::is_ascii_whitespace);
    words.filter(|word| !word.is_empty())
}

/// Bytes as text: UTF-8, or else Latin-1.
pub(super) fn shown(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// A finite number.
pub(super) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Text without a comment behind it.
pub(super) fn without_comment(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().position(|&byte| byte == b'#');
    bytes[..end.unwrap_or(bytes.len())].trim_ascii_end()
}

/// Text without the quotes around it.
pub(super) fn unquoted(text: &str) -> &str {
    let text = text.trim();
    let inner = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
    inner.unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_way_and_marks_are_no_part_of_them() {
        let file = b"\xef\xbb\xbfa\nb\r\nc\rd\n\n\xef\xbb\xbfe";
        let found: Vec<&[u8]> = lines(file).collect();
        assert_eq!(found, [&b"a"[..], b"b", b"c", b"d", b"", b"e"]);
        assert_eq!(lines(b"").count(), 0);
        assert_eq!(lines(b"a\r\n").count(), 1);
    }

    #[test]
    fn utf_16_is_read_with_and_without_a_mark() {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}v 1 2 3\nusemtl é");
            let units = || text.encode_utf16();
            let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
            let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
            assert_eq!(as_bytes_of_ascii(&little), text.as_bytes());
            assert_eq!(as_bytes_of_ascii(&big), text.as_bytes());
        }
        assert_eq!(as_bytes_of_ascii(b"v 1 2 3"), &b"v 1 2 3"[..]);
    }

    #[test]
    fn other_encodings_are_shown_as_latin_1() {
        assert_eq!(shown(b"St\xfchle"), "Stühle");
        assert_eq!(shown("Stühle".as_bytes()), "Stühle");
        assert_eq!(unquoted(" \"a b\" "), "a b");
        assert_eq!(unquoted("\"a"), "\"a");
    }
}
