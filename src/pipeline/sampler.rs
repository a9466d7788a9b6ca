//! The extremes of many places as seen, without room for the places.

use glam::DVec3;

use crate::light_cone::{Batch, Extremes, View};

/// Places that are mapped together, which the cache of a core has room for.
const PLACES_AT_ONCE: usize = 1024;

/// Maps places at rest, block by block, and keeps the extremes of where they are seen.
pub(super) struct Sampler<'a> {
    view: &'a View,
    waiting: Vec<DVec3>,
    seen: Vec<DVec3>,
    extremes: Extremes,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(view: &'a View) -> Self {
        Self {
            view,
            waiting: Vec::with_capacity(PLACES_AT_ONCE),
            seen: vec![DVec3::ZERO; PLACES_AT_ONCE],
            extremes: Extremes::NONE,
        }
    }

    /// Adds a place at rest.
    pub(super) fn add(&mut self, place: DVec3) {
        self.waiting.push(place);
        if self.waiting.len() == PLACES_AT_ONCE {
            self.map();
        }
    }

    fn map(&mut self) {
        let batch = Batch {
            rest: &self.waiting,
            seen: &mut self.seen[..self.waiting.len()],
            normals: None,
        };
        self.extremes = self.extremes.and(self.view.see(batch));
        self.waiting.clear();
    }

    /// The extremes of all places that were added.
    pub(super) fn found(mut self) -> Extremes {
        self.map();
        self.extremes
    }
}
