//! Shapes that the program makes itself.
//!
//! Every shape is centred on the origin of its object, with y as its axis, and comes with normals of the
//! true surface and with texture coordinates. Triangles are about as long as wide: each of their
//! corners is mapped by a nonlinear map, and a long edge would stay straight where the surface bends.

mod appearance;
mod band;
mod checker;
#[cfg_attr(
    not(test),
    allow(
        dead_code,
        reason = "exports use of it the fewest triangles by theory so far"
    )
)]
mod curved;
mod deviation;
mod error;
mod flat;
mod flat_form;
mod lathe;
mod lattice;
mod round;
mod shape;
mod size;
mod sphere;
mod surface;
#[cfg(test)]
mod witness;

pub use appearance::{Appearance, Color};
pub(crate) use band::Band;
pub(crate) use curved::{Body, Jet, LEAST_PARTS, MAX_SPAN, Piece, Spot, axes_of_turn};
pub use error::ShapeError;
pub use flat::{Cuboid, Grid};
pub use lattice::Lattice;
pub use round::{Cone, Cylinder, Rod, Torus};
pub use shape::Shape;
pub use size::{Cells, Count, Length};
pub use sphere::Sphere;
