//! Steps that are made while those before them are written.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::mpsc::{Receiver, sync_channel};

use crate::pipeline::{Photosurface, PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::write::WriteError;

/// Triangles of steps that are made ahead, about, where that is more than one step: enough to keep cores busy, and a
/// few megabytes, so that many steps take hardly more memory than two.
const MADE_AHEAD: usize = 100_000;

/// Steps of more triangles are made one after the other: what is written of them is little against what they take to
/// make, in which all cores take part, and in memory.
const MAX_TO_HAVE_TWO: usize = 500_000;

/// Makes the photosurfaces of some steps and hands them to `put` in their order. While those of one step are put away
/// the next are made: one step, or as many as there are cores where they are small.
///
/// # Errors
///
/// Those of `put`; nothing is handed to it after the first.
pub(super) fn in_order(
    placed: &PlacedScene,
    wanted: SurfaceOptions,
    steps: Range<usize>,
    mut put: impl FnMut(Photosurface) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let parts = placed.objects().flat_map(|(_, parts)| parts);
    let at_rest = parts.map(|(_, part)| part.mesh().triangles().len()).sum();
    // Until one step is made nobody knows what it comes to.
    let (mut largest, mut ahead) = (at_rest, steps_ahead(at_rest).min(1));
    let mut begun: VecDeque<Receiver<Result<Vec<Photosurface>, PlacedSceneError>>> =
        VecDeque::new();
    rayon::in_place_scope(|scope| {
        let mut next = steps.start;
        for step in steps.clone() {
            let begun_before = begun.pop_front();
            next = next.max(step + 1);
            while begun.len() < ahead && next < steps.end {
                let (made, receiver) = sync_channel(1);
                scope.spawn(move |_| {
                    // Nobody takes it when writing has failed.
                    let photosurfaces = placed.photosurfaces(next, wanted);
                    let _ = made.send(photosurfaces.map(Iterator::collect));
                });
                begun.push_back(receiver);
                next += 1;
            }
            let mut triangles = 0;
            let mut put = |photosurface: Photosurface| {
                triangles += photosurface.facts.triangles;
                put(photosurface)
            };
            match begun_before {
                // Without a sender it has panicked, and so will this scope.
                Some(made) => {
                    for made in made {
                        made?.into_iter().try_for_each(&mut put)?;
                    }
                }
                None => placed.photosurfaces(step, wanted)?.try_for_each(&mut put)?,
            }
            largest = largest.max(triangles);
            ahead = steps_ahead(largest);
        }
        Ok(())
    })
}

/// How many steps are made ahead where each has so many triangles.
fn steps_ahead(triangles: usize) -> usize {
    if triangles > MAX_TO_HAVE_TWO {
        return 0;
    }
    let fitting = MADE_AHEAD / triangles.max(1);
    fitting.clamp(1, rayon::current_num_threads())
}
