//! One vector for each vertex, in the precision in which its source has it.

use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::mesh::{VALUES_PER_JOB, change, unit_or_zero};

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
            Self::Single(singles) => {
                let numbers = &singles.numbers[part];
                // One loop for each meaning.
                match singles.meaning {
                    Meaning::Plain => fill(vectors, numbers, |n| Meaning::Plain.vector(n)),
                    Meaning::Directions => {
                        fill(vectors, numbers, |n| Meaning::Directions.vector(n));
                    }
                    Meaning::Moved(way) => {
                        fill(vectors, numbers, |n| Meaning::Moved(way).vector(n))
                    }
                    Meaning::Placed(transform) => {
                        fill(vectors, numbers, |n| Meaning::Placed(transform).vector(n));
                    }
                }
            }
        }
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

#[inline(always)]
fn fill(vectors: &mut [DVec3], numbers: &[[f32; 3]], vector: impl Fn([f32; 3]) -> DVec3) {
    for (to, &from) in vectors.iter_mut().zip(numbers) {
        *to = vector(from);
    }
}
