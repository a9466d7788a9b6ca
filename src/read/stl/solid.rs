//! A solid: facets as they come, each with its normal and places of its own, as vertices that facets share.

use std::collections::HashMap;

use glam::DVec3;

use crate::read::surface::Surface;

/// A solid as far as it was read.
#[derive(Default)]
pub(super) struct Solid {
    /// Bytes of its name; empty where it has none.
    pub(super) name: Vec<u8>,
    pub(super) surface: Surface,
    /// How many facets have a normal that contradicts the order of their corners.
    pub(super) contradictions: usize,
    /// The vertex at each place.
    known: HashMap<[u64; 3], u32>,
}

impl Solid {
    pub(super) fn named(name: &[u8]) -> Self {
        Self {
            name: name.to_vec(),
            ..Self::default()
        }
    }

    /// Adds a facet of three corners or more. Corners at one place, to the last bit, are one vertex.
    pub(super) fn add(&mut self, normal: DVec3, corners: &[DVec3]) {
        for &corner in corners {
            // Adding zero makes one of both zeros.
            let corner = corner + DVec3::ZERO;
            let positions = &mut self.surface.positions;
            let next = positions.len() as u32;
            let key = corner.to_array().map(f64::to_bits);
            let vertex = *self.known.entry(key).or_insert(next);
            if vertex == next {
                positions.push(corner);
            }
            self.surface.polygons.add_corner(vertex);
        }
        self.surface.polygons.end(corners.len());
        if let [a, b, c, ..] = *corners {
            let across = (b - a).cross(c - a).dot(normal);
            self.contradictions += usize::from(across < 0.0);
        }
    }
}
