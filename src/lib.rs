//! Photosurfaces: the apparent shape of fast-moving objects as real geometry.

mod io;
mod light_cone;
mod mesh;
mod spacetime;

pub use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4, Vec2, Vec4};

pub use io::{
    AccessorProblem, DocumentProblem, NodeProblem, Note, ObjProblem, ReadError, UriProblem,
    read_gltf_bytes, read_model,
};
pub use light_cone::PhotosurfaceMap;
pub use mesh::{
    AlphaMode, Appearance, Cells, Color, Cone, Count, Cuboid, Cylinder, Filter, Grid, Image,
    Lattice, Length, Material, Mesh, MeshError, Model, Part, Rod, Sampler, Shape, ShapeError,
    Sphere, Texture, Torus, Wrap,
};
pub use spacetime::{Event, Lorentz, MAX_RAPIDITY, Velocity, VelocityError, WorldLine};
