//! What is tried for the triangles of a round shape: one measure or the other, and looser tolerances where triangles are
//! limited.

use super::minimum::needed;
use super::sight::{About, Sight};
use super::triangulate::{Triangulated, coarsest, triangulate_about};
use crate::shape::Shape;

/// Where a surface takes more than this many times the fewest triangles, points may take fewer: the proof asks places not to
/// slide far along the surface.
const THRIFTY: f64 = 2.5;

/// A tolerance that needs more triangles than there may be is multiplied by a factor, at first by this one; each time that is
/// not enough the factor is squared.
const LOOSER: f64 = 1.15;
const LOOSENINGS: usize = 18;
const LOOSEST: f64 = 1e305;

/// At least this share of the triangles that there may be is used, if a few more attempts with tolerances that are not as
/// loose find that. There are more attempts only up to so many triangles.
const USED: f64 = 0.8;
const FEW_TO_USE: u64 = 50_000;
const TIGHTENINGS: usize = 5;

/// The triangles of a round shape for all of these sights, at most `most` of them or those of the coarsest form; `None` if
/// there are more or one cannot be proven. Surfaces that cannot be proven, mostly those of few triangles for a fast observer,
/// and those that take many triangles, are tried as points, which are never nearer than surfaces.
pub(crate) fn triangulate(
    shape: &Shape,
    sights: &[Sight],
    about: About,
    most: u64,
) -> Option<Triangulated> {
    let made = triangulate_about(shape, sights, about, most);
    if about == About::Points {
        return made;
    }
    let least = || {
        let of_each = sights.iter().map(|sight| needed(shape, sight, about).least);
        of_each.fold(1.0, f64::max)
    };
    match made {
        Some(made) if made.count() as f64 <= THRIFTY * least() => Some(made),
        Some(made) => {
            let fewer = made.count() as u64 - 1;
            Some(triangulate_about(shape, sights, About::Points, fewer.min(most)).unwrap_or(made))
        }
        None => triangulate_about(shape, sights, About::Points, most),
    }
}

/// The triangles of a round shape for tolerances that are multiplied by a factor, so that at most `most` triangles are left:
/// about by `guess`. Where no looser tolerance can be proven these are the triangles of the coarsest form, and nothing is
/// known of them.
pub(crate) fn triangulate_within(
    shape: &Shape,
    sights: &[Sight],
    about: About,
    most: u64,
    guess: f64,
) -> Triangulated {
    let attempt = |looser: f64| {
        let aimed: Vec<Sight> = sights.iter().map(|sight| sight.loosened(looser)).collect();
        triangulate_about(shape, &aimed, about, most)
    };
    let (mut too_tight, mut looser, mut factor) = (1.0f64, guess.max(LOOSER), LOOSER);
    let mut best = None;
    for _ in 0..LOOSENINGS {
        best = attempt(looser.min(LOOSEST));
        if best.is_some() || looser > LOOSEST {
            break;
        }
        too_tight = looser;
        looser *= factor;
        factor *= factor;
    }
    let Some(mut best) = best else {
        return coarsest(shape, sights, about);
    };
    for _ in 0..TIGHTENINGS {
        let is_used = best.count() as f64 >= USED * most as f64;
        if is_used || most > FEW_TO_USE || looser < LOOSER * too_tight {
            break;
        }
        let between = looser.sqrt() * too_tight.sqrt();
        match attempt(between) {
            Some(made) if made.count() >= best.count() => (best, looser) = (made, between),
            _ => too_tight = between,
        }
    }
    best
}
