//! Numbers from buffers: accessors of every type, interleaved, sparse, normalized.
//!
//! glTF 2.0, section 3.6.2. Every range is checked before the first number is read. The iterators of the
//! `gltf` crate are not used: they compute ranges unchecked and panic on an accessor of no elements
//! and on sparse indices out of order.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::{Accessor, Index, accessor::sparse::Sparse};

use super::document::Document;
use super::extensions;
use crate::read::bytes::Bytes;
use crate::read::run::Run;
use crate::read::{AccessorProblem, ReadError};

/// What an accessor has to hold.
pub(super) struct Expected {
    /// Any of these.
    pub(super) types: &'static [Type],
    /// Any of these.
    pub(super) components: &'static [ComponentType],
    /// Both in words.
    pub(super) words: &'static str,
}

/// Elements, and whether something holds for all of them.
pub(super) type Checked<const N: usize> = (Vec<[f32; N]>, bool);

/// The numbers of an accessor.
pub(super) struct Numbers {
    /// All components, element by element.
    pub(super) values: Vec<f64>,
    /// Components of an element.
    pub(super) width: usize,
}

impl Numbers {
    /// The elements, each `width` numbers.
    pub(super) fn elements(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.width)
    }
}

impl Document<'_> {
    /// The number of elements of an accessor.
    pub(super) fn count(&self, index: Index<Accessor>) -> usize {
        self.root.accessors[index.value()].count.0 as usize
    }

    /// The numbers of an accessor, normalized where it says so; `place` says what they are for.
    pub(super) fn numbers(
        &self,
        index: Index<Accessor>,
        expected: &Expected,
        place: &str,
    ) -> Result<Numbers, ReadError> {
        let accessor = &self.root.accessors[index.value()];
        self.check_compression(accessor)?;
        let layout = Layout::of(accessor, expected);
        layout
            .and_then(|layout| self.numbers_of(accessor, &layout))
            .map_err(|failure| failure.at(place, index))
    }

    /// What `make` makes of the elements of an accessor, each of `N` numbers: what would become of
    /// [`numbers`](Self::numbers), and where they are plain floats without these in between.
    pub(super) fn elements<T, const N: usize>(
        &self,
        index: Index<Accessor>,
        expected: &Expected,
        place: &str,
        make: impl Fn([f64; N]) -> T + Sync,
    ) -> Result<Vec<T>, ReadError>
    where
        T: Copy + Default + Send,
    {
        debug_assert!(expected.types.iter().any(|kind| kind.multiplicity() == N));
        let accessor = &self.root.accessors[index.value()];
        if accessor.component_type.unwrap().0 == ComponentType::F32
            && let Some(run) = self.plain(index, expected, place)?
        {
            return run.map(|bytes| {
                let words = bytes.as_chunks().0;
                make(std::array::from_fn(|i| f32::from_le_bytes(words[i]).into()))
            });
        }
        let numbers = self.numbers(index, expected, place)?;
        let elements = numbers.values.as_chunks().0;
        Ok(elements.iter().map(|&element| make(element)).collect())
    }

    /// The elements of an accessor, each of `N` numbers, if they are plain floats, and whether `is_sound` holds for all
    /// of them.
    pub(super) fn singles<const N: usize>(
        &self,
        index: Index<Accessor>,
        expected: &Expected,
        place: &str,
        is_sound: impl Fn([f32; N]) -> bool + Sync,
    ) -> Result<Option<Checked<N>>, ReadError> {
        debug_assert!(expected.types.iter().any(|kind| kind.multiplicity() == N));
        let accessor = &self.root.accessors[index.value()];
        if accessor.component_type.unwrap().0 != ComponentType::F32 {
            return Ok(None);
        }
        let Some(run) = self.plain(index, expected, place)? else {
            return Ok(None);
        };
        run.words(f32::from_le_bytes, is_sound).map(Some)
    }

    /// Where the elements of an accessor are, if it says nothing but that.
    pub(super) fn plain(
        &self,
        index: Index<Accessor>,
        expected: &Expected,
        place: &str,
    ) -> Result<Option<Run<'_>>, ReadError> {
        let accessor = &self.root.accessors[index.value()];
        self.check_compression(accessor)?;
        let layout = Layout::of(accessor, expected).map_err(|failure| failure.at(place, index))?;
        let (Some(view), None) = (accessor.buffer_view, &accessor.sparse) else {
            return Ok(None);
        };
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let run = self.run(view.value(), offset, accessor.count.0 as usize, &layout);
        let run = run.and_then(|run| self.quota.take(accessor.count.0).map(|()| run));
        run.map_err(|problem| Failure::from(problem).at(place, index))
            .map(Some)
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<Bytes<'_>, AccessorProblem> {
        let view = &self.root.buffer_views[index];
        let buffer = view.buffer.value();
        let Some(data) = &self.buffers[buffer] else {
            return Err(AccessorProblem::NoData { buffer });
        };
        let start = view.byte_offset.unwrap_or_default().0;
        let end = u128::from(start) + u128::from(view.byte_length.0);
        if end > data.len() as u128 {
            return Err(AccessorProblem::BeyondBuffer {
                view: index,
                end,
                buffer,
                length: data.len(),
            });
        }
        Ok(data.view(start as usize..end as usize))
    }

    /// Refuses compressed data that has no uncompressed stand-in, by the name of the compression.
    fn check_compression(&self, accessor: &Accessor) -> Result<(), ReadError> {
        let Some(view) = accessor.buffer_view else {
            return Ok(());
        };
        let buffer = self.root.buffer_views[view.value()].buffer;
        match extensions::compression_of_view(&self.root, view.value()) {
            Some(name) if self.buffers[buffer.value()].is_none() => {
                Err(ReadError::Extension { name: name.into() })
            }
            _ => Ok(()),
        }
    }

    fn numbers_of(&self, accessor: &Accessor, layout: &Layout) -> Result<Numbers, Failure> {
        let count = accessor.count.0 as usize;
        let width = layout.width;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                self.values(view.value(), offset, count, layout)?
            }
            // Zeros, for as many elements as it likes.
            None => {
                let numbers = accessor.count.0.saturating_mul(width as u64);
                self.zeros.take(numbers)?;
                vec![0.0; count * width]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.substitute(&mut values, sparse, count, layout)?;
        }
        Ok(Numbers { values, width })
    }

    /// The components of `count` elements from byte `offset` of a view on.
    fn values(
        &self,
        view: usize,
        offset: u64,
        count: usize,
        layout: &Layout,
    ) -> Result<Vec<f64>, Failure> {
        let run = self.run(view, offset, count, layout)?;
        if count == 0 {
            return Ok(vec![]);
        }
        self.quota.take(count as u64)?;
        let mut buffer = vec![];
        let end = run.start + run.stride * (count - 1) + run.size;
        let bytes = run.bytes.part(run.start..end, &mut buffer);
        let mut values = Vec::with_capacity(count * layout.width);
        for element in bytes.map_err(Failure::File)?.chunks(run.stride) {
            let components = element[..run.size].chunks_exact(layout.component.size());
            values.extend(components.map(|bytes| layout.number(bytes)));
        }
        Ok(values)
    }

    /// Where `count` elements from byte `offset` of a view on are.
    fn run(
        &self,
        view: usize,
        offset: u64,
        count: usize,
        layout: &Layout,
    ) -> Result<Run<'_>, AccessorProblem> {
        let bytes = self.view(view)?;
        let size = layout.component.size() * layout.width;
        let stride = self.root.buffer_views[view].byte_stride;
        let stride = stride.map_or(size, |stride| stride.0);
        if count > 0 && stride < size {
            return Err(AccessorProblem::Stride { stride, size });
        }
        let end = u128::from(offset) + stride as u128 * (count.max(1) as u128 - 1) + size as u128;
        if count > 0 && end > bytes.len() as u128 {
            return Err(AccessorProblem::BeyondView {
                end,
                view,
                length: bytes.len(),
            });
        }
        Ok(Run {
            bytes,
            start: offset as usize,
            stride,
            size,
            count,
        })
    }

    /// Puts the values of a sparse accessor in their places.
    fn substitute(
        &self,
        values: &mut [f64],
        sparse: &Sparse,
        count: usize,
        layout: &Layout,
    ) -> Result<(), Failure> {
        let substitutes = sparse.count.0 as usize;
        let index_layout = Layout {
            component: sparse.indices.component_type.unwrap().0,
            normalized: false,
            width: 1,
        };
        let (view, offset) = (&sparse.indices.buffer_view, &sparse.indices.byte_offset);
        let indices = self.values(view.value(), offset.0, substitutes, &index_layout)?;
        let (view, offset) = (&sparse.values.buffer_view, &sparse.values.byte_offset);
        let new = self.values(view.value(), offset.0, substitutes, layout)?;
        let mut first_free = 0;
        for (position, &index) in indices.iter().enumerate() {
            let index = index as usize;
            if index < first_free || index >= count {
                let problem = AccessorProblem::SparseIndex {
                    position,
                    index: index as u32,
                    count,
                };
                return Err(problem.into());
            }
            first_free = index + 1;
            values[index * layout.width..][..layout.width]
                .copy_from_slice(&new[position * layout.width..][..layout.width]);
        }
        Ok(())
    }
}

/// Why there are no numbers.
enum Failure {
    Problem(AccessorProblem),
    File(ReadError),
}

impl From<AccessorProblem> for Failure {
    fn from(problem: AccessorProblem) -> Self {
        Self::Problem(problem)
    }
}

impl Failure {
    /// As an error that says what the numbers are for.
    fn at(self, place: &str, index: Index<Accessor>) -> ReadError {
        match self {
            Self::Problem(problem) => ReadError::Accessor {
                place: place.to_owned(),
                accessor: index.value(),
                problem,
            },
            Self::File(error) => error,
        }
    }
}

/// How the elements of an accessor are written.
struct Layout {
    component: ComponentType,
    normalized: bool,
    /// Components of an element.
    width: usize,
}

impl Layout {
    /// That of an accessor, if it is one of those that are expected.
    fn of(accessor: &Accessor, expected: &Expected) -> Result<Self, Failure> {
        let kind = accessor.type_.unwrap();
        let component = accessor.component_type.unwrap().0;
        if !expected.types.contains(&kind) || !expected.components.contains(&component) {
            let problem = AccessorProblem::Kind {
                found: format!("{} of {}", type_name(kind), component_name(component)),
                expected: expected.words,
            };
            return Err(problem.into());
        }
        Ok(Self {
            component,
            normalized: accessor.normalized,
            width: kind.multiplicity(),
        })
    }

    /// One number; `bytes` are as many as the component has.
    fn number(&self, bytes: &[u8]) -> f64 {
        let (value, largest) = match (self.component, bytes) {
            (ComponentType::I8, &[a]) => (f64::from(a as i8), 127.0),
            (ComponentType::U8, &[a]) => (f64::from(a), 255.0),
            (ComponentType::I16, &[a, b]) => (f64::from(i16::from_le_bytes([a, b])), 32767.0),
            (ComponentType::U16, &[a, b]) => (f64::from(u16::from_le_bytes([a, b])), 65535.0),
            (ComponentType::U32, &[a, b, c, d]) => {
                return f64::from(u32::from_le_bytes([a, b, c, d]));
            }
            (ComponentType::F32, &[a, b, c, d]) => {
                return f64::from(f32::from_le_bytes([a, b, c, d]));
            }
            _ => unreachable!("cut to the size of the component"),
        };
        match self.normalized {
            true => f64::max(value / largest, -1.0),
            false => value,
        }
    }
}

fn type_name(kind: Type) -> &'static str {
    match kind {
        Type::Scalar => "SCALAR",
        Type::Vec2 => "VEC2",
        Type::Vec3 => "VEC3",
        Type::Vec4 => "VEC4",
        Type::Mat2 => "MAT2",
        Type::Mat3 => "MAT3",
        Type::Mat4 => "MAT4",
    }
}

fn component_name(component: ComponentType) -> &'static str {
    match component {
        ComponentType::I8 => "bytes",
        ComponentType::U8 => "unsigned bytes",
        ComponentType::I16 => "shorts",
        ComponentType::U16 => "unsigned shorts",
        ComponentType::U32 => "unsigned integers",
        ComponentType::F32 => "floats",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(component: ComponentType, normalized: bool, bytes: &[u8]) -> f64 {
        let layout = Layout {
            component,
            normalized,
            width: 1,
        };
        layout.number(bytes)
    }

    /// The formulas of glTF 2.0, section 3.6.2.2.
    #[test]
    fn integers_are_normalized_as_gltf_says() {
        assert_eq!(number(ComponentType::I8, true, &[127]), 1.0);
        assert_eq!(number(ComponentType::I8, true, &[0x80]), -1.0);
        assert_eq!(number(ComponentType::I8, false, &[0x80]), -128.0);
        assert_eq!(number(ComponentType::U8, true, &[51]), 0.2);
        assert_eq!(number(ComponentType::I16, true, &[1, 0x80]), -1.0);
        assert_eq!(number(ComponentType::I16, true, &[0, 0x80]), -1.0);
        assert_eq!(number(ComponentType::U16, true, &[255, 255]), 1.0);
        assert_eq!(
            number(ComponentType::F32, false, &2.5f32.to_le_bytes()),
            2.5
        );
    }
}
