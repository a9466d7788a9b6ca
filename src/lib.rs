//! Photosurfaces: the apparent shape of fast-moving objects as real geometry.
//!
//! An observer who moves near the speed of light receives light *now*. For every point of every object
//! there is exactly one event on its worldline from which that light came. The places of all these emission
//! events, in the observer's frame, form a virtual object: the photosurface (Gekelman, Maggs, Xu 1991; Rau,
//! Weiskopf, Ruder 1998). Seen from the observer's place with an ordinary camera it gives exactly the
//! relativistic image; seen from anywhere else it explains that image.
//!
//! The way through the library: read or build a [`Scene`], get the models of its objects with
//! [`load_models`], put both on a [`Stage`], take its [`Photosurface`]s, write them with [`write_glb`]; [`CostStudy`]
//! tells what accuracy costs. The mathematics alone is in [`Velocity`], [`Lorentz`], [`PhotosurfaceMap`] and [`View`].
//!
//! Conventions: c = 1; lengths and times share one unit; right-handed coordinates, y up; angles in radians.
//! Everything is computed in `f64`. The *scene frame* is that of the scene; the *rest frame* of an object
//! moves with it, its axes those of the scene under a pure boost; the *observer's frame* is that of a [`Moment`], its
//! axes the same under a pure boost unless the observer's are turned.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod effects;
mod io;
mod light_cone;
mod mesh;
mod photosurface;
mod render;
mod scene;
mod spacetime;
mod study;
mod tessellate;

pub use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, DVec4, Vec2, Vec4};

pub use io::{
    Access, AccessorProblem, DocumentProblem, Export, FileFindings, Findings, Format, GltfFile,
    GltfOutput, LoadError, NodeProblem, Note, ObjProblem, Playback, ReadError, Report, StageTime,
    Target, UriProblem, WriteError, abandon_writes, destination, load_models, read_gltf_bytes,
    read_model, read_whole, replaced_data, write_glb, write_gltf, write_ply, write_whole,
    write_whole_gltf, write_whole_target,
};
pub use light_cone::{PhotosurfaceMap, View};
pub use mesh::{
    AlphaMode, Appearance, Cells, Color, Cone, Count, Cuboid, Cylinder, Grid, Image, Lattice,
    Length, Material, MaterialError, Mesh, MeshError, Model, Part, PictureError, Rod, Shape,
    ShapeError, Sphere, Texture, Torus, Wrap,
};
pub use photosurface::{
    Facts, Photosurface, Prediction, SceneFacts, Stage, VertexData, Wanted, step_label,
};
pub use render::{
    Camera, CameraError, MAX_PICTURE_SIDE, MissingTexture, Picture, PictureOptions, PictureSize,
    Projection, Scenery, Strokes, Textures, Viewpoint, lettering_width,
};
pub use scene::{
    Attribute, Attributes, BUILT_IN_SCENES, BuiltInScene, InvalidScene, MarkerRadius,
    MarkerRadiusError, Object, Observer, Scene, SceneError, Source, Tolerance, ToleranceError,
    UnknownAttribute, even_steps,
};
pub use spacetime::{Event, Lorentz, MAX_RAPIDITY, Moment, Velocity, VelocityError, WorldLine};
pub use study::{
    CostSettings, CostStudy, Made, MeshCost, Pictures, RayCost, RaySettings, Seconds, StudyError,
    UniformCost, UniformRun,
};
#[cfg(feature = "plot")]
pub use study::{PlotError, PlotSize};
pub use tessellate::{Certificate, Precision, edge_gap, triangle_gap, triangle_gap_place};
