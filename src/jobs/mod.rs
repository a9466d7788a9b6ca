//! What the program does, for everyone who calls the library.

mod load;

pub use load::{FileFindings, LoadError, load_models};
