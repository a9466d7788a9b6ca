//! What the program does, for everyone who calls the library.

mod load;
mod progress;

pub use load::{FileFindings, LoadError, load_models};
pub use progress::{Cancelled, Progress};
