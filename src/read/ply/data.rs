//! The values of the elements of a PLY file, one element after the other.

use super::header::{Element, Encoding, Header, Property, Scalar};
use crate::read::text::{lines, words};
use crate::read::{DataProblem, ReadError};

/// What stands behind the header and was not read yet.
pub(super) struct Data<'a> {
    encoding: Encoding,
    rest: Rest<'a>,
}

enum Rest<'a> {
    /// Lines that are not blank, with their numbers.
    Text(Box<dyn Iterator<Item = (usize, &'a [u8])> + 'a>),
    Bytes(&'a [u8]),
}

/// The values of one element.
#[derive(Default)]
pub(super) struct Values {
    /// One for each property; of a list its length.
    pub(super) single: Vec<f64>,
    /// Those of the list that was asked for.
    pub(super) list: Vec<f64>,
    /// How many words of text were left over.
    pub(super) extra: usize,
}

impl<'a> Data<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        let bytes = &bytes[header.end..];
        let before = header.lines;
        let numbered = (before + 1..).zip(lines(bytes));
        let full = numbered.filter(|(_, line)| !line.trim_ascii().is_empty());
        let rest = match header.encoding {
            Encoding::Ascii => Rest::Text(Box::new(full)),
            _ => Rest::Bytes(bytes),
        };
        Self {
            encoding: header.encoding,
            rest,
        }
    }

    /// How many bytes of a binary file are left.
    pub(super) fn left(&self) -> usize {
        match &self.rest {
            Rest::Text(_) => 0,
            Rest::Bytes(bytes) => bytes.len(),
        }
    }

    /// Passes over all elements of a kind.
    pub(super) fn skip(&mut self, element: &Element) -> Result<(), ReadError> {
        if let Rest::Text(lines) = &mut self.rest {
            if !element.properties.is_empty() {
                for index in 0..element.count {
                    lines.next().ok_or_else(|| cut_off(element, index))?;
                }
            }
            return Ok(());
        }
        self.each(element, None, |_| Ok(()))
    }

    /// Has `take` take the values of each element of a kind, and those of the list `list` among its properties.
    pub(super) fn each(
        &mut self,
        element: &Element,
        list: Option<usize>,
        mut take: impl FnMut(&Values) -> Result<(), DataProblem>,
    ) -> Result<(), ReadError> {
        let mut values = Values::default();
        if element.properties.is_empty() {
            return Ok(());
        }
        for index in 0..element.count {
            values.single.clear();
            values.list.clear();
            match &mut self.rest {
                Rest::Text(lines) => {
                    let (line, text) = lines.next().ok_or_else(|| cut_off(element, index))?;
                    read_text(text, &element.properties, list, &mut values)
                        .and_then(|()| take(&values))
                        .map_err(|problem| ReadError::Line { line, problem })?;
                }
                Rest::Bytes(bytes) => {
                    let mut source = Source {
                        bytes,
                        is_big: self.encoding == Encoding::BigEndian,
                    };
                    source
                        .read(&element.properties, list, &mut values)
                        .and_then(|()| take(&values))
                        .map_err(|problem| ReadError::Element {
                            element: element.name.clone(),
                            index,
                            problem,
                        })?;
                    *bytes = source.bytes;
                }
            }
        }
        Ok(())
    }
}

fn cut_off(element: &Element, index: u64) -> ReadError {
    ReadError::Data(DataProblem::End {
        expected: format!("{} {index} of {}", element.name, element.count),
    })
}

/// Reads a line of text.
fn read_text(
    line: &[u8],
    properties: &[Property],
    list: Option<usize>,
    values: &mut Values,
) -> Result<(), DataProblem> {
    let mut words = words(line);
    let mut found = 0;
    let mut next = |name: &str| {
        let word = words.next().ok_or_else(|| DataProblem::Count {
            found,
            expected: format!("one for {name} too"),
        })?;
        found += 1;
        let number = std::str::from_utf8(word).ok();
        let number = number.and_then(|word| word.parse::<f64>().ok());
        number.ok_or_else(|| DataProblem::word(word, "a number"))
    };
    for (i, property) in properties.iter().enumerate() {
        let value = next(&property.name)?;
        values.single.push(value);
        if property.length.is_some() {
            for _ in 0..length(value)? {
                let value = next(&property.name)?;
                if list == Some(i) {
                    values.list.push(value);
                }
            }
        }
    }
    values.extra += words.count();
    Ok(())
}

/// How many values a list has that says so.
fn length(value: f64) -> Result<u64, DataProblem> {
    if value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0 {
        return Ok(value as u64);
    }
    let found = value.to_string();
    Err(DataProblem::Length { found })
}

/// The bytes that are left of a binary file.
struct Source<'a> {
    bytes: &'a [u8],
    is_big: bool,
}

impl Source<'_> {
    fn read(
        &mut self,
        properties: &[Property],
        list: Option<usize>,
        values: &mut Values,
    ) -> Result<(), DataProblem> {
        for (i, property) in properties.iter().enumerate() {
            let Some(of_length) = property.length else {
                let value = self.number(property.value)?;
                values.single.push(value);
                continue;
            };
            let value = self.number(of_length)?;
            values.single.push(value);
            let size = property.value.size();
            let items = self.take(length(value)?.saturating_mul(size as u64))?;
            if list == Some(i) {
                let items = items.chunks_exact(size);
                let is_big = self.is_big;
                values
                    .list
                    .extend(items.map(|item| decode(item, property.value, is_big)));
            }
        }
        Ok(())
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, DataProblem> {
        let bytes = self.take(scalar.size() as u64)?;
        Ok(decode(bytes, scalar, self.is_big))
    }
}

impl<'a> Source<'a> {
    fn take(&mut self, count: u64) -> Result<&'a [u8], DataProblem> {
        let split = usize::try_from(count)
            .ok()
            .and_then(|count| self.bytes.split_at_checked(count));
        let left = self.bytes.len();
        let (taken, rest) = split.ok_or_else(|| DataProblem::End {
            expected: format!("{count} bytes, not {left}"),
        })?;
        self.bytes = rest;
        Ok(taken)
    }
}

/// A number in as many bytes as its type has.
fn decode(bytes: &[u8], scalar: Scalar, is_big: bool) -> f64 {
    /// The bytes in little-endian order.
    fn ordered<const N: usize>(bytes: &[u8], is_big: bool) -> [u8; N] {
        let mut ordered = [0; N];
        ordered.copy_from_slice(bytes);
        if is_big {
            ordered.reverse();
        }
        ordered
    }
    match scalar {
        Scalar::I8 => i8::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::U8 => u8::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::I16 => i16::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::U16 => u16::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::I32 => i32::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::U32 => u32::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::F32 => f32::from_le_bytes(ordered(bytes, is_big)).into(),
        Scalar::F64 => f64::from_le_bytes(ordered(bytes, is_big)),
    }
}
