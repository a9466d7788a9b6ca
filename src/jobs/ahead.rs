//! Makes the photosurfaces of later steps while those of earlier steps are written.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::mpsc::{Receiver, sync_channel};

use crate::pipeline::{Photosurface, PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::write::WriteError;

/// About how many triangles are made ahead if that is more than one step: enough to keep all cores busy, and only a few
/// megabytes, so that many steps need hardly more memory than two.
const MADE_AHEAD: usize = 100_000;

/// Steps with more triangles than this are made and written one after the other: making them uses all cores and takes
/// much longer than writing, and two of them would need much memory.
const MAX_TO_HAVE_TWO: usize = 500_000;

/// Makes the photosurfaces of some steps and hands them to `put` in the order of the steps. While `put` handles one
/// step, the next steps are made: one, or as many as there are cores if the steps are small.
///
/// # Errors
///
/// The first error of `put`, after which nothing is handed to it, or an error of the pipeline.
pub(super) fn in_order(
    placed: &PlacedScene,
    wanted: SurfaceOptions,
    steps: Range<usize>,
    mut put: impl FnMut(Photosurface) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let parts = placed.objects().flat_map(|(_, parts)| parts);
    let at_rest = parts.map(|(_, part)| part.mesh().triangle_count()).sum();
    // The number of triangles of a step is unknown until the first step is made.
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
                    // The receiver is gone if writing has failed.
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
                // A missing sender means that its task has panicked; this scope will panic too.
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

/// How many steps are made ahead if each has this number of triangles.
fn steps_ahead(triangles: usize) -> usize {
    if triangles > MAX_TO_HAVE_TWO {
        return 0;
    }
    let fitting = MADE_AHEAD / triangles.max(1);
    fitting.clamp(1, rayon::current_num_threads())
}
