//! Surfaces of revolution about the y axis, and how fine their triangles are.
//!
//! A profile is turned about the axis in rings, each with as many segments as its size calls for; two
//! neighbouring rings are joined like a zip. Smooth parts of a profile are strips; where two
//! strips meet, the vertices of the last and the first ring are the same but for their normals.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::ShapeError;
use super::surface::{Surface, direction_of_turn};

/// A smooth part of the profile, from top to bottom as seen from outside.
pub(super) struct Strip {
    pub(super) chart: Chart,
    pub(super) rings: Vec<Ring>,
}

/// How a picture is laid on a strip.
pub(super) enum Chart {
    /// Wrapped around the axis, so many times.
    Around { repeats: f64 },
    /// Laid flat on a disc of this radius, so many times from rim to rim.
    Across { radius: f64, repeats: f64 },
}

impl Chart {
    /// Where a point of a disc that faces up or down, as its normal says, is on a flat picture.
    pub(super) fn across(&self, position: DVec3, up: f64) -> DVec2 {
        let Self::Across { radius, repeats } = self else {
            return DVec2::ZERO;
        };
        let across = DVec2::new(position.x, position.z * up) / (2.0 * radius);
        *repeats * (across + 0.5)
    }
}

/// A circle of vertices about the axis, or with radius zero the point where the axis pierces it.
pub(super) struct Ring {
    pub(super) radius: f64,
    pub(super) height: f64,
    /// Away from the axis and up.
    pub(super) normal: DVec2,
    /// The texture coordinate down the strip; a flat chart has no use for it.
    pub(super) down: f64,
    /// Zero for a point.
    pub(super) segments: u64,
}

/// Turns a profile, all strips from top to bottom, about the y axis.
pub(super) fn revolve(strips: &[Strip]) -> Result<Surface, ShapeError> {
    let mut surface = Surface::with_room_for(triangle_count(strips))?;
    for Strip { chart, rings } in strips {
        let mut upper = Vec::new();
        for (k, ring) in rings.iter().enumerate() {
            let neighbour = if k == 0 { &rings[1] } else { &rings[k - 1] };
            let lower = if ring.segments == 0 {
                add_point(&mut surface, chart, ring, neighbour.segments)
            } else {
                add_ring(&mut surface, chart, ring)
            };
            if k > 0 {
                zip(
                    &mut surface,
                    (&upper, neighbour.segments),
                    (&lower, ring.segments),
                );
            }
            upper = lower;
        }
    }
    Ok(surface)
}

/// Of how many triangles [`revolve`] makes the surface.
pub(super) fn triangle_count(strips: &[Strip]) -> u64 {
    let bands = strips.iter().flat_map(|strip| strip.rings.windows(2));
    bands.map(|band| band[0].segments + band[1].segments).sum()
}

/// How many segments of the width that `around` of them have at the full `radius` make up `length`.
///
/// At most 16 per segment of the turn: what is longer than 16 circumferences gets triangles longer than
/// wide, rather than millions of them.
pub(super) fn segments_along(length: f64, radius: f64, around: u64) -> u64 {
    let width = TAU * radius / around as f64;
    ((length / width).ceil() as u64).clamp(1, 16 * around)
}

/// A flat lid at `height` that faces up or down, its checker repeating `repeats` times across.
pub(super) fn lid(radius: f64, height: f64, up: bool, segments: u64, repeats: f64) -> Strip {
    let bands = segments_along(radius, radius, segments);
    let mut rings: Vec<Ring> = (0..=bands)
        .map(|k| Ring {
            radius: radius * (k as f64 / bands as f64),
            height,
            normal: DVec2::new(0.0, if up { 1.0 } else { -1.0 }),
            down: 0.0,
            segments: match k {
                0 => 0,
                _ => (segments * k).div_ceil(bands).max(3),
            },
        })
        .collect();
    if !up {
        rings.reverse();
    }
    Strip {
        chart: Chart::Across { radius, repeats },
        rings,
    }
}

/// Adds the vertices of a ring; the last one closes it.
fn add_ring(surface: &mut Surface, chart: &Chart, ring: &Ring) -> Vec<u32> {
    match chart {
        Chart::Around { .. } => (0..=ring.segments)
            .map(|i| add_vertex(surface, chart, ring, i, ring.segments))
            .collect(),
        Chart::Across { .. } => {
            let open =
                (0..ring.segments).map(|i| add_vertex(surface, chart, ring, i, ring.segments));
            let mut indices: Vec<u32> = open.collect();
            indices.push(indices[0]);
            indices
        }
    }
}

/// Adds a point on the axis: one vertex for each triangle around it, halfway between the other two.
/// On a flat chart these are all the same.
fn add_point(surface: &mut Surface, chart: &Chart, ring: &Ring, triangles: u64) -> Vec<u32> {
    match chart {
        Chart::Around { .. } => (0..triangles)
            .map(|i| add_vertex(surface, chart, ring, 2 * i + 1, 2 * triangles))
            .collect(),
        Chart::Across { .. } => {
            vec![add_vertex(surface, chart, ring, 0, 1); triangles as usize]
        }
    }
}

/// Adds the vertex of a ring after `part / parts` of a turn.
fn add_vertex(surface: &mut Surface, chart: &Chart, ring: &Ring, part: u64, parts: u64) -> u32 {
    let direction = direction_of_turn(part, parts);
    let position = ring.radius * direction + ring.height * DVec3::Y;
    let normal = ring.normal.x * direction + ring.normal.y * DVec3::Y;
    let texture = match chart {
        Chart::Around { repeats } => DVec2::new(repeats * (part as f64 / parts as f64), ring.down),
        flat @ Chart::Across { .. } => flat.across(position, ring.normal.y),
    };
    surface.vertex(position, normal, texture)
}

/// Joins two rings by triangles, always taking the step to the vertex that comes first.
///
/// Every triangle reaches no further around than one segment of the coarser ring.
fn zip(surface: &mut Surface, (upper, above): (&[u32], u64), (lower, below): (&[u32], u64)) {
    let (mut i, mut j) = (0, 0);
    while i < above || j < below {
        // A point has a vertex for every step of the ring around it.
        let at_upper = if above == 0 { j } else { i } as usize;
        let at_lower = if below == 0 { i } else { j } as usize;
        let [from_upper, from_lower] = [upper[at_upper], lower[at_lower]];
        if j < below && (i == above || (j + 1) * above <= (i + 1) * below) {
            surface.triangle([from_upper, from_lower, lower[at_lower + 1]]);
            j += 1;
        } else {
            surface.triangle([from_upper, from_lower, upper[at_upper + 1]]);
            i += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lid_is_a_polygon_of_even_triangles() {
        for segments in (3..100).chain([333, 1000]) {
            for up in [true, false] {
                let lid = lid(2.0, 0.5, up, segments, 4.0);
                let mesh = revolve(&[lid]).unwrap().into_mesh().unwrap();
                crate::shape::witness::assert_well_made(&mesh);
                let area = crate::shape::witness::area(&mesh);
                let sector = TAU / segments as f64;
                let polygon = 2.0 * segments as f64 * sector.sin();
                assert!(
                    (area / polygon - 1.0).abs() < 1e-12,
                    "{segments} {area} {polygon}"
                );
            }
        }
    }

    #[test]
    fn lengths_are_cut_into_pieces_as_long_as_wide() {
        assert_eq!(segments_along(TAU, 1.0, 96), 96);
        assert_eq!(segments_along(1e-9, 1.0, 96), 1);
        assert_eq!(segments_along(2.0, 1.0, 96), 31);
        assert_eq!(segments_along(1e9, 1.0, 96), 16 * 96);
    }
}
