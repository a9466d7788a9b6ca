//! The header of a PLY file: which elements follow, and which properties each of them has.

use crate::read::text::{shown, split_statement};
use crate::read::{DataProblem, ReadError};

/// What a header says.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The first byte behind the header.
    pub(super) end: usize,
    /// How many lines the header has.
    pub(super) lines: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Things of one kind, such as all vertices.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the length of a list; `None` for a single value.
    pub(super) length: Option<Scalar>,
    /// The type of the value, or of each value of a list.
    pub(super) value: Scalar,
}

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

const TYPES: &str = "a type: char, uchar, short, ushort, int, uint, float or double";

impl Scalar {
    fn named(name: &[u8]) -> Result<Self, DataProblem> {
        Ok(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return Err(DataProblem::word(name, TYPES)),
        })
    }

    /// How many bytes a value has.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value that stands for full light where it is a colour.
    pub(super) fn full(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }
}

impl Property {
    /// The fewest bytes that it takes in an element of a binary file.
    fn size(&self) -> usize {
        self.length.unwrap_or(self.value).size()
    }
}

impl Element {
    /// Which property has one of these names and is a list, or is none.
    pub(super) fn find(&self, names: &[&str], is_list: bool) -> Option<usize> {
        let fits = |property: &Property| {
            property.length.is_some() == is_list && names.contains(&property.name.as_str())
        };
        self.properties.iter().position(fits)
    }

    /// The fewest bytes that one of them takes.
    fn size(&self, encoding: Encoding) -> usize {
        match encoding {
            // A digit and what parts it from the next.
            Encoding::Ascii => 2 * self.properties.len(),
            _ => self.properties.iter().map(Property::size).sum(),
        }
    }
}

/// Whether a file starts as a PLY file does.
pub(in crate::read) fn is_ply(start: &[u8]) -> bool {
    let line = start.split(|byte| matches!(byte, b'\n' | b'\r')).next();
    line.is_some_and(|line| line.len() < start.len() && line.trim_ascii_end() == b"ply")
}

/// Reads the header, and checks that the file has room for the elements that it declares.
pub(super) fn read_header(bytes: &[u8]) -> Result<Header, ReadError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = vec![];
    let mut lines = HeaderLines::new(bytes);
    let mut number = 0;
    let mut is_whole = false;
    while !is_whole && let Some(line) = lines.next() {
        number += 1;
        let (statement, rest) = split_statement(line);
        let done = match statement {
            b"ply" if number == 1 => Ok(()),
            _ if number == 1 => Err(DataProblem::word(statement, "ply")),
            b"" | b"comment" | b"obj_info" => Ok(()),
            b"format" => read_format(rest).map(|format| encoding = Some(format)),
            b"element" => read_element(rest, &elements).map(|element| elements.push(element)),
            b"property" => read_property(rest, elements.last_mut()),
            b"end_header" => {
                is_whole = true;
                Ok(())
            }
            _ => Err(DataProblem::word(
                statement,
                "format, comment, obj_info, element, property or end_header",
            )),
        };
        done.map_err(|problem| ReadError::Line {
            line: number,
            problem,
        })?;
    }
    if !is_whole {
        let expected = "end_header".into();
        return Err(ReadError::Line {
            line: number.max(1),
            problem: DataProblem::End { expected },
        });
    }
    let Some(encoding) = encoding else {
        return Err(ReadError::Data(DataProblem::Missing {
            missing: "format",
            expected: "a line such as \"format ascii 1.0\" in the header",
        }));
    };
    let header = Header {
        encoding,
        elements,
        end: lines.at,
        lines: number,
    };
    header.check_room(bytes.len() - header.end)?;
    Ok(header)
}

impl Header {
    /// Checks that so many bytes can be what the header declares.
    fn check_room(&self, bytes: usize) -> Result<(), ReadError> {
        let mut left = bytes;
        // The last line need not end.
        let spare = u128::from(self.encoding == Encoding::Ascii);
        for element in &self.elements {
            let needed = u128::from(element.count) * element.size(self.encoding) as u128;
            if needed > left as u128 + spare {
                return Err(ReadError::Data(DataProblem::CutOff {
                    count: element.count,
                    element: element.name.clone(),
                    needed,
                    left,
                }));
            }
            left = left.saturating_sub(needed as usize);
        }
        Ok(())
    }
}

fn read_format(rest: &[u8]) -> Result<Encoding, DataProblem> {
    let (format, version) = split_statement(rest);
    let encoding = match format {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        _ => {
            return Err(DataProblem::word(
                format,
                "ascii, binary_little_endian or binary_big_endian",
            ));
        }
    };
    match version {
        b"1.0" => Ok(encoding),
        _ => Err(DataProblem::word(version, "the version 1.0")),
    }
}

fn read_element(rest: &[u8], known: &[Element]) -> Result<Element, DataProblem> {
    let (name, count) = split_statement(rest);
    let number = std::str::from_utf8(count).ok().and_then(|n| n.parse().ok());
    let count = number.ok_or_else(|| DataProblem::word(count, "how many elements there are"))?;
    let name = shown(name).into_owned();
    if known.iter().any(|element| element.name == name) {
        return Err(DataProblem::Word {
            found: name,
            expected: "an element that is not declared yet",
        });
    }
    Ok(Element {
        name,
        count,
        properties: vec![],
    })
}

fn read_property(rest: &[u8], element: Option<&mut Element>) -> Result<(), DataProblem> {
    let element = element.ok_or(DataProblem::Word {
        found: "property".into(),
        expected: "an element before its properties",
    })?;
    let (kind, rest) = split_statement(rest);
    let (length, value, name) = match kind {
        b"list" => {
            let (length, rest) = split_statement(rest);
            let (value, name) = split_statement(rest);
            let length = Scalar::named(length)?;
            (Some(length), Scalar::named(value)?, name)
        }
        _ => (None, Scalar::named(kind)?, rest),
    };
    element.properties.push(Property {
        name: shown(name).into_owned(),
        length,
        value,
    });
    Ok(())
}

/// The lines of a header, which all end as the first one does: binary data may begin with any byte.
struct HeaderLines<'a> {
    bytes: &'a [u8],
    at: usize,
    end: u8,
}

impl<'a> HeaderLines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let ends = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let end = match ends.map(|at| &bytes[at..]) {
            Some([b'\r', b'\n', ..]) | Some([b'\n', ..]) | None => b'\n',
            _ => b'\r',
        };
        Self { bytes, at: 0, end }
    }
}

impl<'a> Iterator for HeaderLines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&byte| byte == self.end);
        self.at += end.map_or(rest.len(), |end| end + 1);
        Some(&rest[..end.unwrap_or(rest.len())])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(header: &str) -> String {
        read_header(header.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn data_begin_right_behind_the_header_whatever_ends_its_lines() {
        for end in ["\n", "\r\n", "\r"] {
            let header = [
                "ply",
                "format binary_big_endian 1.0",
                "comment a",
                "end_header",
                "",
            ];
            let mut file = header.join(end).into_bytes();
            let start = file.len();
            // What would be the end of a line in text.
            file.extend(b"\n\r\n");
            let header = read_header(&file).unwrap();
            assert_eq!((header.end, header.lines), (start, 4), "{end:?}");
            assert_eq!(header.encoding, Encoding::BigEndian);
            assert!(is_ply(&file));
        }
        assert!(!is_ply(b"ply"));
        assert!(!is_ply(b"plywood\n"));
    }

    #[test]
    fn a_wrong_header_is_an_error_of_its_line() {
        assert_eq!(message("plyx\n"), "line 1: \"plyx\", expected ply");
        assert_eq!(message(""), "line 1: the file ends, expected end_header");
        assert_eq!(
            message("ply\nformat ascii 1.0\nelement vertex 3\n"),
            "line 3: the file ends, expected end_header"
        );
        assert_eq!(
            message("ply\nformat ascii 2.0\n"),
            "line 2: \"2.0\", expected the version 1.0"
        );
        assert_eq!(
            message("ply\nformat text 1.0\n"),
            "line 2: \"text\", expected ascii, binary_little_endian or binary_big_endian"
        );
        assert_eq!(
            message("ply\nelement vertex -1\n"),
            "line 2: \"-1\", expected how many elements there are"
        );
        assert_eq!(
            message("ply\nproperty float x\n"),
            "line 2: \"property\", expected an element before its properties"
        );
        assert!(message("ply\nelement a 1\nproperty int64 x\n").contains("expected a type: char"));
        assert!(message("ply\nelement a 1\nelement a 1\n").contains("not declared yet"));
        assert!(message("ply\nelment a 1\n").contains("\"elment\", expected format, comment"));
        assert_eq!(
            message("ply\nend_header\n"),
            "no format, expected a line such as \"format ascii 1.0\" in the header"
        );
    }

    #[test]
    fn more_elements_than_bytes_are_refused_before_anything_is_read() {
        let header = |format: &str, count: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
                 property float z\nend_header\n0 0 0"
            )
        };
        assert_eq!(
            message(&header("binary_little_endian", "4000000000")),
            "4000000000 vertex elements need at least 48000000000 bytes, but 5 are left: the file is cut off"
        );
        assert!(message(&header("ascii", "18446744073709551615")).contains("cut off"));
        assert!(message(&header("ascii", "2")).contains("cut off"));
        assert!(read_header(header("ascii", "1").as_bytes()).is_ok());
    }
}
