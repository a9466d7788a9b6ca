//! Pages: a scene, its meshes and the program that shows them, in one HTML file.

mod html;

pub use html::{PageContent, write_page};
