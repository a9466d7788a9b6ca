//! How large a gap may be, and where.

use glam::DVec3;

use crate::light_cone::View;

/// What part of an angle the gap gets where other errors take more than there is; the certificate tells. Without it
/// they would ask for triangles of no size at all.
const MIN_SHARE: f64 = 0.1;

/// The largest gap `e`, in the rest frame before the factor `gamma beta`, that an edge or a triangle may
/// have.
#[derive(Clone, Copy, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one for a mesh, and boxed it could not be copied"
)]
pub(crate) enum Allowance {
    /// The same everywhere.
    Everywhere(f64),
    /// As much as the observer sees under one angle.
    ///
    /// The distance at which a point is seen is `gamma (r + beta d_par)`, and on a flat triangle `r` is the
    /// interpolated one minus `e`: it is at least the smallest at a corner minus `gamma e`. So what is allowed is
    /// a `share` of the smallest, `less` what other errors take.
    Angle {
        /// Gives the distances.
        view: View,
        /// Of the smallest distance at a corner.
        share: f64,
        /// Taken by other errors.
        less: f64,
        /// Never less than this: where the observer touches a surface, every gap is seen under the same angle.
        least: f64,
    },
}

impl Allowance {
    /// So many times as much everywhere.
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

    /// What is allowed for the edge or triangle between these offsets from the observer.
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

    /// Whether what is allowed there is more than the tolerance, so that it cannot be kept.
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

/// The smallest of the distances at which points are seen.
fn nearest(view: &View, offsets: &[DVec3]) -> f64 {
    let distances = offsets.iter().map(|&offset| view.seen_distance(offset));
    distances.fold(f64::INFINITY, f64::min)
}
