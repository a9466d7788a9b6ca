//! Why a shape is refused.

use thiserror::Error;

use crate::mesh::MeshError;

/// Why parameters do not make a shape.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length that is none.
    #[error("{name} is {value}, expected a finite length > 0")]
    Length {
        /// Which parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A factor that is none.
    #[error("factor is {value}, expected a finite factor > 0")]
    Factor {
        /// Its value.
        value: f64,
    },
    /// A count out of range.
    #[error("{name} is {value}, expected a whole number from {least} to {most}")]
    Count {
        /// Which parameter.
        name: &'static str,
        /// Its value.
        value: u32,
        /// The smallest value allowed.
        least: u32,
        /// The largest value allowed.
        most: u32,
    },
    /// A length that has to be smaller than another one and is not.
    #[error("{name} is {value}, expected less than {limit_name}, which is {limit}")]
    NotLess {
        /// The length that has to be smaller.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The length that has to be larger.
        limit_name: &'static str,
        /// Its value.
        limit: f64,
    },
    /// Lengths so small, large or different that `f64` cannot tell all vertices apart.
    #[error(
        "sizes and gaps of the shape run from {smallest:e} to {largest:e}, \
         expected from 1e-60 to 1e60 and no more than 1e6 times each other"
    )]
    Proportions {
        /// The smallest length or gap of the shape.
        smallest: f64,
        /// The largest.
        largest: f64,
    },
    /// A resolution that asks for more than memory has.
    #[error("{triangles} triangles, expected at most {limit}: lower the resolution")]
    TooManyTriangles {
        /// How many the shape would have.
        triangles: u64,
        /// The most allowed.
        limit: u64,
    },
    /// Text that is no colour.
    #[error("color is {0:?}, expected #rrggbb, two hexadecimal digits each for red, green, blue")]
    Color(String),
    /// The mesh does not hold the surface.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}
