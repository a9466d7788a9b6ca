//! The corners of triangles, listed or in the order of the vertices.

use std::sync::OnceLock;

use rayon::prelude::*;

/// The corners of triangles, each as the index of a vertex.
#[derive(Clone, Debug)]
pub(crate) enum Triangles {
    Listed(Vec<[u32; 3]>),
    InOrder(InOrder),
}

/// So many triangles, each with the next three vertices for itself.
#[derive(Clone, Debug)]
pub(crate) struct InOrder {
    count: usize,
    /// Once someone has asked for a list.
    listed: OnceLock<Vec<[u32; 3]>>,
}

impl Default for Triangles {
    fn default() -> Self {
        Self::Listed(vec![])
    }
}

impl From<Vec<[u32; 3]>> for Triangles {
    fn from(triangles: Vec<[u32; 3]>) -> Self {
        Self::Listed(triangles)
    }
}

impl PartialEq for Triangles {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::InOrder(one), Self::InOrder(other)) => one.count == other.count,
            _ => self.as_slice() == other.as_slice(),
        }
    }
}

impl Triangles {
    /// So many, each with three vertices for itself.
    pub(crate) fn in_order(count: usize) -> Self {
        Self::InOrder(InOrder {
            count,
            listed: OnceLock::new(),
        })
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Listed(triangles) => triangles.len(),
            Self::InOrder(triangles) => triangles.count,
        }
    }

    /// The corners of one.
    #[inline]
    pub(crate) fn at(&self, index: usize) -> [u32; 3] {
        match self {
            Self::Listed(triangles) => triangles[index],
            Self::InOrder(_) => in_order(index),
        }
    }

    /// All of them.
    pub(crate) fn as_slice(&self) -> &[[u32; 3]] {
        match self {
            Self::Listed(triangles) => triangles,
            Self::InOrder(InOrder { count, listed }) => match listed.get() {
                Some(listed) => listed,
                // Not while the lock is held: a thread that waits for others in here may take up work that asks too.
                None => {
                    let all: Vec<_> = (0..*count).into_par_iter().map(in_order).collect();
                    listed.get_or_init(|| all)
                }
            },
        }
    }
}

fn in_order(index: usize) -> [u32; 3] {
    let first = 3 * index as u32;
    [first, first + 1, first + 2]
}
