//! Where a picture is taken from.

use glam::DVec3;

use crate::spacetime::Moment;

/// Where the picture is taken.
#[derive(Clone, Copy, Debug)]
pub enum Viewpoint<'a> {
    /// By the observer, at one moment, in its own axes.
    Observer(&'a Moment),
    /// At a place in the frame in which things stand.
    Outside(DVec3),
}

impl Viewpoint<'_> {
    pub(super) fn eye(&self) -> DVec3 {
        match *self {
            Viewpoint::Observer(..) => DVec3::ZERO,
            Viewpoint::Outside(place) => place,
        }
    }
}
