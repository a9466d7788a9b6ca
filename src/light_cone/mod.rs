//! Where, when and in which colour a moving observer sees a point: the backward light cone.
//!
//! `map` is the mathematics of one observer and one rest frame; `view` places it in a scene where both move.

mod map;
mod view;

pub use map::PhotosurfaceMap;
pub use view::View;
