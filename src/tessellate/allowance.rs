//! How large the gap of an edge or a triangle may be.

use glam::DVec3;

use crate::light_cone::View;

/// Where the other errors use up an angular tolerance, the gap may still be this fraction of it. Without this fraction
/// such a tolerance would ask for triangles of size zero. The certificate states that the tolerance is not kept.
const MIN_SHARE: f64 = 0.1;

/// The largest gap `e` that an edge or a triangle may have: a length in the rest frame, before the factor `gamma beta`.
#[derive(Clone, Copy, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one for a mesh, and boxed it could not be copied"
)]
pub(crate) enum Allowance {
    /// The same gap everywhere.
    Everywhere(f64),
    /// The gap that the observer sees under a given angle.
    ///
    /// In the observer's frame a point is seen at the distance `gamma (r + beta d_par)`. On a flat triangle `r` is the
    /// interpolated distance minus `e`, so a point of the triangle is seen at least at the smallest seen distance of a
    /// corner minus `gamma e`. The allowed gap is therefore the fraction `share` of that smallest distance, minus
    /// `less` for the other errors.
    Angle {
        /// Gives the distances at which the corners are seen.
        view: View,
        /// Allowed gap per smallest seen distance of a corner.
        share: f64,
        /// Part of the allowed gap that the other errors use up.
        less: f64,
        /// Lower limit of the allowed gap. It is needed where the observer touches a surface, because every gap is seen
        /// under the same angle there.
        least: f64,
    },
}

impl Allowance {
    /// The same allowance, multiplied by a factor everywhere.
    pub(super) fn times(&self, factor: f64) -> Self {
        match *self {
            Self::Everywhere(gap) => Self::Everywhere(gap * factor),
            Self::Angle {
                view,
                share,
                less,
                least,
            } => Self::Angle {
                view,
                share: share * factor,
                less: less * factor,
                least: least * factor,
            },
        }
    }

    /// The allowed gap of the edge or triangle whose corners have these offsets from the observer, in the rest frame.
    pub(crate) fn between(&self, offsets: &[DVec3]) -> f64 {
        match self {
            Self::Everywhere(gap) => *gap,
            Self::Angle {
                view,
                share,
                less,
                least,
            } => {
                let whole = nearest(view, offsets) * share;
                (whole - less).max(MIN_SHARE * whole).max(*least)
            }
        }
    }

    /// Whether the allowed gap there is at its lower limit, more than the tolerance leaves for it, so that the
    /// tolerance cannot be kept.
    pub(crate) fn is_at_its_least(&self, offsets: &[DVec3]) -> bool {
        match self {
            Self::Everywhere(_) => false,
            Self::Angle {
                view,
                share,
                less,
                least,
            } => {
                let whole = nearest(view, offsets) * share;
                whole - less < (MIN_SHARE * whole).max(*least)
            }
        }
    }
}

/// The smallest distance, in the observer's frame, at which one of the points is seen.
fn nearest(view: &View, offsets: &[DVec3]) -> f64 {
    let distances = offsets.iter().map(|&offset| view.seen_distance(offset));
    distances.fold(f64::INFINITY, f64::min)
}
