//! Shapes that the program makes itself.

/// stub
#[derive(Clone, Debug, PartialEq)]
pub struct Shape;
/// stub
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance;
