//! What the fuzz targets do with their bytes.
//!
//! Each target is a function that takes any bytes. It panics where the library is wrong; a value or an error
//! of the library are equally good. `fuzz_targets/` hands the functions to libFuzzer, and the root package's
//! `tests/it/fuzz_corpus.rs` runs them over the corpus.

mod case;
mod export;
mod given;
mod reading;
mod render;

use std::path::Path;

use tempfile::TempDir;

pub use case::Case;
pub use export::export;
pub use reading::{gltf, obj, scan, scene};
pub use render::render;

/// Most memory that one input may take: a program that needs more for a kilobyte is wrong.
pub const MEMORY: usize = 1 << 29;

/// A target: its name, which is that of its folder in the corpus, and what it does.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 6] = [
    ("gltf", gltf),
    ("obj", obj),
    ("scan", scan),
    ("scene", scene),
    ("export", export),
    ("render", render),
];

/// Does something in a folder that is there for the whole run, as making one takes longer than most targets.
pub(crate) fn in_folder(action: impl FnOnce(&Path)) {
    thread_local! {
        static FOLDER: TempDir = tempfile::tempdir().expect("the system has room for a temporary folder");
    }
    FOLDER.with(|folder| action(folder.path()));
}
