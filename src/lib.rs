//! Photosurfaces: the apparent shape of fast-moving objects as real geometry.
//!
//! An observer who moves near the speed of light receives light *now*. For every point of every object
//! there is exactly one event on its worldline from which that light came. The places of all these emission
//! events, in the observer's frame, form a virtual object: the photosurface (Gekelman, Maggs, Xu 1991; Rau,
//! Weiskopf, Ruder 1998). Seen from the observer's place with an ordinary camera it gives exactly the
//! relativistic image; seen from anywhere else it explains that image.
//!
//! # Three calls
//!
//! [`PlacedScene::load`] reads a scene with its models, or a mesh by itself; [`export`] writes its photosurfaces, and
//! [`render()`] or [`render_to_files`] draw it:
//!
//! ```
//! use photosurface::{
//!     ExportSettings, PictureMethod, PictureSettings, PictureView, PlacedScene, Textures, export, render_to_files,
//! };
//!
//! # let folder = tempfile::tempdir()?;
//! # let scene = folder.path().join("scene.json");
//! # std::fs::write(&scene, r#"{ "observer": { "velocity": { "beta": 0.9, "direction": [1, 0, 0] } }, "steps": [0, 1],
//! #   "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 3, 0] } ] }"#)?;
//! # let [meshes, pictures] = ["out.glb", "out.png"].map(|name| folder.path().join(name));
//! let (placed, findings) = PlacedScene::load(&scene)?;
//! for (file, found) in &findings {
//!     for note in found.lines() {
//!         eprintln!("{}: {note}", file.display());
//!     }
//! }
//!
//! // All steps in one file; each photosurface is proven to be within its tolerance.
//! let exported = export(&placed, &ExportSettings::default(), &meshes, &())?;
//! assert!(exported[0].tally.is_certified());
//!
//! // The observer's view of each step: out_step000.png, out_step001.png, ...
//! let settings = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
//! # let settings = PictureSettings { camera: photosurface::jobs::CameraSettings {
//! #   size: photosurface::render::PictureSize::new(32, 18)?, ..settings.camera }, ..settings };
//! render_to_files(&placed, &Textures::default(), &settings, &pictures, &())?;
//! # assert!(folder.path().join("out_step001.png").exists());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The last argument of a job hears how far the job has got and may end it: see [`Progress`].
//!
//! # Further modules
//!
//! | for | see |
//! |---|---|
//! | jobs: load, export, pictures, with settings, progress and errors; Minkowski diagrams | [`jobs`] |
//! | scenes from JSON or from Rust, and shapes | [`scene`], [`shape`] |
//! | meshes and materials, from files or of your own | [`mesh`], [`material`], [`read`] |
//! | photosurfaces, predictions, certificates | [`pipeline`], [`tessellate`] |
//! | files of photosurfaces | [`mod@write`] |
//! | pictures by rays of light | [`mod@render`] |
//! | what accuracy costs | [`study`] |
//! | colours of light and of surfaces seen moving | [`effects`] |
//! | the mathematics alone: velocities, frames, where a point is seen | [`spacetime`], [`light_cone`] |
//!
//! Conventions: c = 1; lengths and times share one unit; right-handed coordinates, y up; angles in radians.
//! Everything is computed in `f64`. The *scene frame* is that of the scene; the *rest frame* of an object
//! moves with it, its axes those of the scene under a pure boost; the *observer's frame* is that of a [`Moment`], its
//! axes the same under a pure boost unless the observer's are turned.

#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod effects;
pub mod jobs;
pub mod light_cone;
pub mod material;
pub mod mesh;
pub mod pipeline;
#[cfg(feature = "plot")]
mod plot;
pub mod read;
pub mod render;
pub mod scene;
pub mod shape;
pub mod spacetime;
pub mod study;
pub mod tessellate;
pub mod write;

pub use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, DVec4, Vec2, Vec4};

pub use jobs::{
    Cancelled, ExportSettings, Exported, PictureMethod, PictureSettings, PictureView, Progress,
    export, load_models, render, render_to_files,
};
pub use material::{Model, Part};
pub use mesh::Mesh;
pub use pipeline::{Photosurface, PlacedScene, SurfaceOptions};
pub use render::Textures;
pub use scene::{Object, Observer, Scene, Source, Tolerance};
pub use shape::Shape;
pub use spacetime::{Moment, Velocity};
pub use study::{CostSettings, CostStudy};
