//! Photosurfaces: the apparent shape of fast-moving objects as real geometry.
//!
//! An observer who moves near the speed of light receives light *now*. For every point of every object
//! there is exactly one event on its worldline from which that light came. The places of all these emission
//! events, in the observer's frame, form a virtual object: the photosurface (Gekelman, Maggs, Xu 1991; Rau,
//! Weiskopf, Ruder 1998). Seen from the observer's place with an ordinary camera it gives exactly the
//! relativistic image; seen from anywhere else it explains that image.
//!
//! The way through the library: read or build a [`Scene`], get the models of its objects with
//! [`load_models`], place both as a [`PlacedScene`], take its [`Photosurface`]s, write them with [`write_glb`]; [`CostStudy`]
//! tells what accuracy costs. The mathematics alone is in [`Velocity`], [`Lorentz`], [`PhotosurfaceMap`] and [`View`].
//!
//! Conventions: c = 1; lengths and times share one unit; right-handed coordinates, y up; angles in radians.
//! Everything is computed in `f64`. The *scene frame* is that of the scene; the *rest frame* of an object
//! moves with it, its axes those of the scene under a pure boost; the *observer's frame* is that of a [`Moment`], its
//! axes the same under a pure boost unless the observer's are turned.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod effects;
mod jobs;
mod light_cone;
mod material;
mod mesh;
mod pipeline;
#[cfg(feature = "plot")]
mod plot;
mod read;
mod render;
mod scene;
mod shape;
mod spacetime;
mod study;
mod tessellate;
mod write;

pub use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, DVec4, Vec2, Vec4};

pub use jobs::{
    Aim, CameraSettings, Cancelled, DEFAULT_MAX_TRIANGLES, EmptyView, ExportError, ExportLevel,
    ExportSettings, Exported, FieldOfView, FileFindings, Fitted, FittedExport, FramingError, Ghost,
    Guides, InputError, LoadError, MAX_SCENE_BYTES, OBSERVER_FOV_DEG, OutputError, PictureMethod,
    PictureSettings, PictureView, Progress, RenderError, Rendered, SceneTextError, Tally, ViewCost,
    check_outputs, export, export_levels, file_for_each_step, levels_of_detail, load_models,
    render, render_to_files, scene_from_bytes, stand_off, with_suffix, write_report,
};
pub use light_cone::{PhotosurfaceMap, View};
pub use material::{
    AlphaMode, Image, Material, MaterialError, Model, Part, PictureError, Texture, Wrap,
};
pub use mesh::{Mesh, MeshError};
pub use pipeline::{
    Facts, Photosurface, PlacedScene, PlacedSceneError, Prediction, SceneFacts, SurfaceOptions,
    VertexData, step_label,
};
pub use read::{
    Access, AccessorProblem, DocumentProblem, Findings, NodeProblem, Note, ObjProblem, ReadError,
    UriProblem, read_gltf_bytes, read_model, read_whole,
};
pub use render::{
    Camera, CameraError, MAX_PICTURE_SIDE, MissingTexture, Picture, PictureOptions, PictureSize,
    Projection, Scenery, Strokes, Textures, Viewpoint, lettering_width,
};
pub use scene::{
    Attribute, Attributes, BUILT_IN_SCENES, BuiltInScene, InvalidScene, MarkerRadius,
    MarkerRadiusError, Object, Observer, Place, PlaceError, Rotation, RotationError, Scale, Scene,
    SceneError, Source, Time, TimeError, Tolerance, ToleranceError, Unit, UnknownAttribute,
    even_steps,
};
pub use shape::{
    Appearance, Cells, Color, Cone, Count, Cuboid, Cylinder, Grid, Lattice, Length, Rod, Shape,
    ShapeError, Sphere, Torus,
};
pub use spacetime::{Event, Lorentz, MAX_RAPIDITY, Moment, Velocity, VelocityError, WorldLine};
pub use study::{
    CostSettings, CostStudy, Made, MeshCost, Pictures, RayCost, RaySettings, Seconds, StudyError,
    UniformCost, UniformRun,
};
#[cfg(feature = "plot")]
pub use study::{PlotError, PlotSize};
pub use tessellate::{Certificate, Precision, edge_gap, triangle_gap, triangle_gap_place};
pub use write::{
    Export, Format, GltfFile, GltfOutput, Playback, Report, StageTime, Target, WriteError,
    abandon_writes, destination, replaced_data, write_glb, write_gltf, write_ply, write_whole,
    write_whole_gltf, write_whole_target,
};
