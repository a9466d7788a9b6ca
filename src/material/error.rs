//! Why something is no material.

use thiserror::Error;

/// Why properties do not make a [`Material`](super::Material).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// Something of another kind, or a number out of range.
    #[error("{place} is {found}, expected {expected}")]
    Property {
        /// Path to the property.
        place: String,
        /// What stands there, as JSON.
        found: String,
        /// What glTF has there.
        expected: &'static str,
    },
    /// A texture that is not there.
    #[error("{slot} asks for texture {index}, expected one of {count}")]
    Texture {
        /// Name of the property.
        slot: String,
        /// Which one.
        index: u64,
        /// How many there are.
        count: usize,
    },
}
