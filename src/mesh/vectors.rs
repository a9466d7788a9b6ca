//! One vector for each vertex, in the precision in which its source has it.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DMat3, DVec3};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::extent::{Extent, ends};
use super::values::{VALUES_PER_JOB, change, unit_or_zero};

/// One vector for each vertex.
#[derive(Clone, Debug)]
pub(crate) enum Vectors {
    Double(Vec<DVec3>),
    Single(Singles),
}

/// Vectors that are stored in `f32`, in half the memory, and computed with in `f64`.
#[derive(Clone, Debug)]
pub(crate) struct Singles {
    numbers: Arc<Vec<[f32; 3]>>,
    meaning: Meaning,
    /// All of them in `f64`, once someone has asked for a slice.
    doubles: OnceLock<Vec<DVec3>>,
}

/// How the stored numbers become the vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Meaning {
    /// They are the vectors.
    Plain,
    /// They are brought to unit length.
    Directions,
    /// They are moved; no component of the way is a negative zero, so that this is what a transform of matrix 1 makes of
    /// them.
    Moved(DVec3),
    /// They are transformed.
    Placed(DAffine3),
}

impl Meaning {
    /// That of places that a transform takes elsewhere.
    fn of_places(transform: &DAffine3) -> Self {
        let way = transform.translation;
        let has_negative_zero = way
            .to_array()
            .iter()
            .any(|&along| along == 0.0 && along.is_sign_negative());
        match transform.matrix3 == DMat3::IDENTITY && !has_negative_zero {
            true => Self::Moved(way),
            false => Self::Placed(*transform),
        }
    }

    #[inline(always)]
    fn vector(&self, numbers: [f32; 3]) -> DVec3 {
        let vector = DVec3::from_array(numbers.map(f64::from));
        match self {
            Self::Plain => vector,
            Self::Directions => unit_or_zero(vector),
            Self::Moved(way) => vector + *way,
            Self::Placed(transform) => transform.transform_point3(vector),
        }
    }
}

/// Vectors of a mesh, for whoever reads single ones of them.
#[derive(Clone, Copy)]
pub(crate) enum Places<'a> {
    Double(&'a [DVec3]),
    Single(&'a [[f32; 3]], Meaning),
}

impl Places<'_> {
    /// The place of a vertex.
    #[inline(always)]
    pub(crate) fn at(&self, index: u32) -> DVec3 {
        match self {
            Self::Double(places) => places[index as usize],
            Self::Single(numbers, meaning) => meaning.vector(numbers[index as usize]),
        }
    }
}

impl Places<'_> {
    /// Writes the offsets from `origin` of the three corners of up to `N` triangles, coordinate by coordinate.
    #[inline(always)]
    pub(crate) fn write_offsets<const N: usize>(
        &self,
        triangles: &[[u32; 3]],
        origin: DVec3,
        offsets: &mut [[[f64; N]; 3]; 3],
    ) {
        // One loop for each way to hold them.
        match *self {
            Self::Double(places) => {
                write_offsets(triangles, origin, offsets, |index| places[index as usize]);
            }
            Self::Single(numbers, Meaning::Moved(way)) => {
                let vector = |index| Meaning::Moved(way).vector(numbers[index as usize]);
                write_offsets(triangles, origin, offsets, vector);
            }
            Self::Single(numbers, meaning) => {
                let vector = |index| meaning.vector(numbers[index as usize]);
                write_offsets(triangles, origin, offsets, vector);
            }
        }
    }
}

#[inline(always)]
fn write_offsets<const N: usize>(
    triangles: &[[u32; 3]],
    origin: DVec3,
    offsets: &mut [[[f64; N]; 3]; 3],
    place: impl Fn(u32) -> DVec3,
) {
    for (index, corners) in triangles.iter().enumerate().take(N) {
        for (offsets, &corner) in offsets.iter_mut().zip(corners) {
            let offset = place(corner) - origin;
            offsets[0][index] = offset.x;
            offsets[1][index] = offset.y;
            offsets[2][index] = offset.z;
        }
    }
}

impl Default for Vectors {
    fn default() -> Self {
        Self::Double(vec![])
    }
}

impl From<Vec<DVec3>> for Vectors {
    fn from(vectors: Vec<DVec3>) -> Self {
        Self::Double(vectors)
    }
}

impl Vectors {
    /// Vectors whose numbers are `f32`.
    pub(crate) fn single(numbers: Vec<[f32; 3]>) -> Self {
        Self::meaning(numbers.into(), Meaning::Plain)
    }

    fn meaning(numbers: Arc<Vec<[f32; 3]>>, meaning: Meaning) -> Self {
        Self::Single(Singles {
            numbers,
            meaning,
            doubles: OnceLock::new(),
        })
    }

    /// The same brought to unit length; zero stays zero.
    pub(crate) fn into_directions(self) -> Self {
        match self {
            Self::Single(Singles {
                numbers,
                meaning: Meaning::Plain,
                ..
            }) => Self::meaning(numbers, Meaning::Directions),
            others => {
                let mut vectors = others.into_doubles();
                change(&mut vectors, unit_or_zero);
                Self::Double(vectors)
            }
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Double(vectors) => vectors.len(),
            Self::Single(singles) => singles.numbers.len(),
        }
    }

    pub(crate) fn places(&self) -> Places<'_> {
        match self {
            Self::Double(vectors) => Places::Double(vectors),
            Self::Single(singles) => Places::Single(&singles.numbers, singles.meaning),
        }
    }

    /// All of them in `f64`.
    pub(crate) fn as_slice(&self) -> &[DVec3] {
        match self {
            Self::Double(vectors) => vectors,
            Self::Single(singles) => match singles.doubles.get() {
                Some(doubles) => doubles,
                // Not while the lock is held: a thread that waits for others in here may take up work that asks too.
                None => {
                    let doubles = self.to_doubles();
                    singles.doubles.get_or_init(|| doubles)
                }
            },
        }
    }

    /// Those from number `first` on.
    pub(crate) fn read(&self, first: usize, vectors: &mut [DVec3]) {
        let part = first..first + vectors.len();
        match self {
            Self::Double(all) => vectors.copy_from_slice(&all[part]),
            Self::Single(singles) => Arch::new().dispatch(Widened {
                numbers: &singles.numbers[part],
                meaning: singles.meaning,
                vectors,
            }),
        }
    }

    /// Where some of them are, if that is quickly told: the least of `f32`, moved, is the least of what is moved.
    pub(super) fn extent_at_once(&self, part: Range<usize>) -> Option<Extent> {
        let Self::Single(Singles {
            numbers,
            meaning: meaning @ (Meaning::Plain | Meaning::Moved(_)),
            ..
        }) = self
        else {
            return None;
        };
        let ends = ends(&numbers[part])?;
        let [low, high] = ends.map(|end| meaning.vector(end));
        Extent::of_ends(low, high)
    }

    fn to_doubles(&self) -> Vec<DVec3> {
        match self {
            Self::Double(vectors) => vectors.clone(),
            Self::Single(singles) => {
                let jobs = singles.numbers.par_iter().with_min_len(VALUES_PER_JOB);
                jobs.map(|&numbers| singles.meaning.vector(numbers))
                    .collect()
            }
        }
    }

    pub(crate) fn into_doubles(self) -> Vec<DVec3> {
        match self {
            Self::Double(vectors) => vectors,
            others => others.to_doubles(),
        }
    }

    /// All of them in `f64`, to be changed.
    pub(crate) fn as_mut(&mut self) -> &mut Vec<DVec3> {
        if let Self::Single(_) = self {
            *self = Self::Double(self.to_doubles());
        }
        match self {
            Self::Double(vectors) => vectors,
            Self::Single(_) => unreachable!("it has just been replaced"),
        }
    }

    /// Those with these indices.
    pub(crate) fn picked(&self, indices: &[u32]) -> Self {
        let jobs = indices.par_iter().with_min_len(VALUES_PER_JOB);
        match self {
            Self::Double(vectors) => {
                Self::Double(jobs.map(|&index| vectors[index as usize]).collect())
            }
            Self::Single(singles) => {
                let numbers: Vec<[f32; 3]> =
                    jobs.map(|&index| singles.numbers[index as usize]).collect();
                Self::meaning(numbers.into(), singles.meaning)
            }
        }
    }

    /// Places that a transform has taken elsewhere; those who share them keep them as they are.
    pub(super) fn placed(self: &mut Arc<Self>, transform: &DAffine3) {
        match &**self {
            Self::Single(Singles {
                numbers,
                meaning: Meaning::Plain,
                ..
            }) => {
                let meaning = Meaning::of_places(transform);
                *self = Self::meaning(numbers.clone(), meaning).into();
            }
            _ => self.changed(|place| transform.transform_point3(place)),
        }
    }

    /// Something else of every vector; those who share them keep them as they are.
    pub(super) fn changed(self: &mut Arc<Self>, new: impl Fn(DVec3) -> DVec3 + Sync) {
        if let Some(Self::Double(vectors)) = Arc::get_mut(self) {
            change(vectors, new);
            return;
        }
        let places = self.places();
        let jobs = (0..self.len() as u32).into_par_iter();
        let jobs = jobs.with_min_len(VALUES_PER_JOB);
        let changed: Vec<DVec3> = jobs.map(|index| new(places.at(index))).collect();
        *self = Arc::new(Self::Double(changed));
    }
}

/// Vectors in `f64` in the making, several in one instruction where the processor can.
struct Widened<'a> {
    numbers: &'a [[f32; 3]],
    meaning: Meaning,
    vectors: &'a mut [DVec3],
}

/// Number of vectors that are made together: enough for the longest vector registers.
const BLOCK: usize = 32;

impl NullaryFnOnce for Widened<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // One loop for each meaning.
        let all = self.vectors.iter_mut().zip(self.numbers);
        match self.meaning {
            Meaning::Plain => all.for_each(|(to, &from)| *to = Meaning::Plain.vector(from)),
            Meaning::Moved(way) => {
                all.for_each(|(to, &from)| *to = Meaning::Moved(way).vector(from))
            }
            Meaning::Placed(transform) => {
                all.for_each(|(to, &from)| *to = Meaning::Placed(transform).vector(from));
            }
            Meaning::Directions => {
                let (numbers, last_numbers) = self.numbers.as_chunks::<BLOCK>();
                let (vectors, last_vectors) = self.vectors.as_chunks_mut::<BLOCK>();
                for (vectors, numbers) in vectors.iter_mut().zip(numbers) {
                    by_columns(vectors, numbers, short_way_to_unit);
                    // What that is not good for is rare.
                    if !vectors.iter().all(|vector| vector.is_finite()) {
                        one_by_one(vectors, numbers);
                    }
                }
                one_by_one(last_vectors, last_numbers);
            }
        }
    }
}

fn one_by_one(vectors: &mut [DVec3], numbers: &[[f32; 3]]) {
    for (to, &from) in vectors.iter_mut().zip(numbers) {
        *to = Meaning::Directions.vector(from);
    }
}

/// A vector of ordinary numbers, as all `f32` but zero are, brought to unit length as [`unit_or_zero`] does.
#[inline(always)]
fn short_way_to_unit([x, y, z]: [f64; 3]) -> [f64; 3] {
    let inverse = (x * x + y * y + z * z).sqrt().recip();
    [x * inverse, y * inverse, z * inverse]
}

/// Makes vectors of numbers that are stored coordinate by coordinate meanwhile, so that the compiler can use vector
/// instructions.
#[inline(always)]
fn by_columns(
    vectors: &mut [DVec3; BLOCK],
    numbers: &[[f32; 3]; BLOCK],
    make: impl Fn([f64; 3]) -> [f64; 3],
) {
    let mut columns = [[0.0; BLOCK]; 3];
    for (index, numbers) in numbers.iter().enumerate() {
        for (column, &number) in columns.iter_mut().zip(numbers) {
            column[index] = f64::from(number);
        }
    }
    let [x, y, z] = &mut columns;
    for index in 0..BLOCK {
        [x[index], y[index], z[index]] = make([x[index], y[index], z[index]]);
    }
    for (index, vector) in vectors.iter_mut().enumerate() {
        *vector = DVec3 {
            x: x[index],
            y: y[index],
            z: z[index],
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_at_once_are_the_same_as_one_by_one() {
        let numbers: Vec<[f32; 3]> = (0..1000u16)
            .map(|k| {
                let turn = f32::from(k);
                match k % 97 {
                    3 => [0.0, -0.0, 0.0],
                    5 => [1e-45, -1e-45, 0.0],
                    7 => [3e38, -3e38, 3e38],
                    _ => [turn.sin(), -0.0, turn.cos()],
                }
            })
            .collect();
        let turn = DAffine3::from_rotation_z(0.3);
        for transform in [
            None,
            Some(DAffine3::from_translation(DVec3::new(1.0, 0.0, 2.0))),
            Some(DAffine3::from_translation(DVec3::new(1.0, -0.0, 2.0))),
            Some(turn),
        ] {
            let mut places = Arc::new(Vectors::single(numbers.clone()));
            let mut doubles = Arc::new(Vectors::Double(places.as_slice().to_vec()));
            if let Some(transform) = &transform {
                places.placed(transform);
                doubles.placed(transform);
                assert!(matches!(*places, Vectors::Single(_)));
            }
            check(&places, doubles.as_slice());
        }
        let directions = Vectors::single(numbers.clone()).into_directions();
        let widened = Vectors::single(numbers).into_doubles();
        let expected = Vectors::Double(widened).into_directions();
        check(&directions, expected.as_slice());
    }

    #[test]
    fn the_ends_of_what_is_moved_are_those_of_single_vectors() {
        let place = |k: u16| {
            let turn = f32::from(k) + 0.1;
            [turn.sin(), turn.cos() - 1e-3, 1e3 * turn]
        };
        let numbers: Vec<[f32; 3]> = (0..1000).map(place).collect();
        for way in [DVec3::ZERO, DVec3::new(0.1, -7.3, 1e-9), DVec3::splat(1e9)] {
            let mut places = Arc::new(Vectors::single(numbers.clone()));
            if way != DVec3::ZERO {
                places.placed(&DAffine3::from_translation(way));
            }
            for part in [0..1000, 3..4, 500..517] {
                let found = places.extent_at_once(part.clone()).unwrap();
                let expected = Extent::around(None, &places.as_slice()[part]).unwrap();
                assert_eq!((found.low, found.high), (expected.low, expected.high));
                assert!(found.is_finite);
            }
        }
        for odd in [
            [0.0, 1.0, 1.0],
            [f32::NAN, 1.0, 1.0],
            [1.0, f32::INFINITY, 1.0],
        ] {
            let odd = Vectors::single(vec![[0.5; 3], odd, [2.0; 3]]);
            assert!(odd.extent_at_once(0..2).is_none());
        }
    }

    fn check(vectors: &Vectors, expected: &[DVec3]) {
        let bits = |vectors: &[DVec3]| -> Vec<[u64; 3]> {
            let bits = |vector: &DVec3| vector.to_array().map(f64::to_bits);
            vectors.iter().map(bits).collect()
        };
        assert_eq!(vectors.len(), expected.len());
        let mut read = vec![DVec3::ONE; expected.len()];
        vectors.read(0, &mut read);
        assert_eq!(bits(&read), bits(expected));
        let places = vectors.places();
        let one_by_one: Vec<DVec3> = (0..read.len() as u32).map(|i| places.at(i)).collect();
        assert_eq!(bits(&one_by_one), bits(expected));
        assert_eq!(bits(vectors.as_slice()), bits(expected));
        let picked = vectors.picked(&[7, 5, 5]);
        assert_eq!(
            bits(picked.as_slice()),
            bits(&[expected[7], expected[5], expected[5]])
        );
    }
}
