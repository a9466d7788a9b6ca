//! The lattice: square bars along the edges of a stack of cubes, as one closed surface.
//!
//! Crossings and pieces of bars are the boxes of a rectangular grid of slots, which are filled or not; the
//! surface is where a filled one meets an empty one. So it is watertight without a seam.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::surface::{Side, Surface};
use super::{Cells, Count, Length, ShapeError};

/// Square bars along the edges of cubic cells stacked about the origin.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(try_from = "LatticeFields")]
pub struct Lattice {
    cells: Cells,
    spacing: Length,
    thickness: Length,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) resolution: Option<Count<1, 4>>,
}

/// Square bars along the edges of cubic cells stacked about the origin.
#[derive(JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
struct LatticeFields {
    /// Number of cells along each axis: one number, or an array of three for x, y and z.
    cells: Cells,
    /// Distance between the middles of neighbouring bars, in the object's units before `scale`.
    spacing: Length,
    /// Width of a bar, less than `spacing`, in the object's units before `scale`.
    thickness: Length,
    /// Number of segments along a bar from crossing to crossing. If absent, refinement starts from one; without refinement
    /// there are 4.
    resolution: Option<Count<1, 4>>,
}

impl TryFrom<LatticeFields> for Lattice {
    type Error = ShapeError;

    fn try_from(fields: LatticeFields) -> Result<Self, ShapeError> {
        Self::new(
            fields.cells,
            fields.spacing,
            fields.thickness,
            fields.resolution,
        )
    }
}

impl Lattice {
    /// Columns and rows of the checker, which repeats; a cell is about as wide as a bar.
    pub(super) const CHECKER_CELLS: [u32; 2] = [2, 2];

    /// Bars of `thickness` around `cells` cubes of edge `spacing`, each split into `resolution` segments,
    /// 4 if there is none.
    ///
    /// # Errors
    ///
    /// Bars that touch each other.
    pub fn new(
        cells: Cells,
        spacing: Length,
        thickness: Length,
        resolution: Option<Count<1, 4>>,
    ) -> Result<Self, ShapeError> {
        if thickness >= spacing {
            return Err(ShapeError::NotLess {
                name: "thickness",
                value: thickness.get(),
                limit_name: "spacing",
                limit: spacing.get(),
            });
        }
        Ok(Self {
            cells,
            spacing,
            thickness,
            resolution,
        })
    }

    /// Number of cells along x, y and z.
    pub fn cells(&self) -> [u32; 3] {
        self.cells.get()
    }

    /// Distance between the middles of neighbouring bars.
    pub fn spacing(&self) -> Length {
        self.spacing
    }

    /// Width of a bar.
    pub fn thickness(&self) -> Length {
        self.thickness
    }

    /// The same lattice with another number of segments along a bar.
    #[must_use]
    pub fn with_resolution(self, resolution: Count<1, 4>) -> Self {
        Self {
            resolution: Some(resolution),
            ..self
        }
    }

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        let cells = self.cells.get();
        let mut lattice = Builder {
            surface: Surface::with_room_for(self.triangle_count())?,
            axes: cells.map(|cells| self.places_along(cells)),
            segments: i64::from(self.resolution.unwrap_or_default().get()),
            origin: cells
                .map(|cells| -self.spacing.get() * (f64::from(cells) / 2.0))
                .into(),
            texture_period: 2.0 * self.checker_cell(),
            known: HashMap::new(),
        };
        for x in 0..=i64::from(cells[0]) {
            for y in 0..=i64::from(cells[1]) {
                for z in 0..=i64::from(cells[2]) {
                    lattice.crossing_and_bars([x, y, z]);
                }
            }
        }
        Ok(lattice.surface)
    }

    fn crossings_and_bars(&self) -> [u64; 2] {
        let [x, y, z] = self.cells.get().map(u64::from);
        let crossings = (x + 1) * (y + 1) * (z + 1);
        let bars = x * (y + 1) * (z + 1) + y * (x + 1) * (z + 1) + z * (x + 1) * (y + 1);
        [crossings, bars]
    }

    /// Tells the places of the vertices: they are the corners of slots that are filled.
    pub(super) fn places(&self, mut tell: impl FnMut(DVec3)) {
        let period = self.resolution.unwrap_or_default().get() as usize + 1;
        let axes = self.cells.get().map(|cells| self.places_along(cells));
        // Whether a place along an axis is on the way from one crossing to the next.
        let is_between = |place: usize| place % period > 1;
        for (i, &x) in axes[0].iter().enumerate() {
            for (j, &y) in axes[1].iter().enumerate() {
                let between = usize::from(is_between(i)) + usize::from(is_between(j));
                if between > 1 {
                    continue;
                }
                for (k, &z) in axes[2].iter().enumerate() {
                    if between == 0 || !is_between(k) {
                        // As in a `Surface`.
                        tell(DVec3::new(x, y, z) + DVec3::ZERO);
                    }
                }
            }
        }
    }

    /// Two triangles for each of four sides of each segment, and for each of six of each crossing but
    /// for those where the two ends of a bar are attached.
    pub(super) fn triangle_count(&self) -> u64 {
        let [crossings, bars] = self.crossings_and_bars();
        2 * (4 * u64::from(self.resolution.unwrap_or_default().get()) * bars + 6 * crossings
            - 2 * bars)
    }

    /// The number of vertices: four on each of the six sides of a crossing, but for those of the outermost bars where the
    /// next bar begins and no other bar is attached; and two on each of the four sides of a bar between two segments.
    pub(super) fn vertex_count(&self) -> usize {
        let [crossings, bars] = self.crossings_and_bars();
        let cells = self.cells.get().into_iter().map(u64::from).sum::<u64>();
        let between = u64::from(self.resolution.unwrap_or_default().get()) - 1;
        (24 * crossings + 8 * bars * between - 8 * cells) as usize
    }

    /// The places along one axis where crossings and segments begin and end, in ascending order.
    fn places_along(&self, cells: u32) -> Vec<f64> {
        let [spacing, half] = [self.spacing.get(), self.thickness.get() / 2.0];
        let middle = |i: u32| spacing * ((2.0 * f64::from(i) - f64::from(cells)) / 2.0);
        let mut places = vec![middle(0) - half, middle(0) + half];
        for i in 1..=cells {
            let [start, end] = [middle(i - 1) + half, middle(i) - half];
            let segments = self.resolution.unwrap_or_default().get();
            let between =
                (1..segments).map(|k| start + (end - start) * f64::from(k) / f64::from(segments));
            places.extend(between.chain([end, middle(i) + half]));
        }
        places
    }

    /// The width of a checker cell: no less than a bar's, so that bars are not striped lengthwise, and
    /// a whole number of them from crossing to crossing, so that bars look alike.
    fn checker_cell(&self) -> f64 {
        let across = self.spacing.get() / self.thickness.get();
        self.spacing.get() / across.floor().clamp(2.0, 64.0)
    }
}

/// The lattice while it is built.
struct Builder {
    surface: Surface,
    axes: [Vec<f64>; 3],
    segments: i64,
    /// The middle of the crossing with the smallest coordinates.
    origin: DVec3,
    texture_period: f64,
    /// Vertices by the side they are on and their place along each axis.
    known: HashMap<(usize, [usize; 3]), u32>,
}

impl Builder {
    /// Adds a crossing, counted from the smallest coordinates, and the bars from it to the next ones.
    fn crossing_and_bars(&mut self, crossing: [i64; 3]) {
        let slot = crossing.map(|count| count * (self.segments + 1));
        self.box_at(slot);
        for axis in 0..3 {
            for segment in 1..=self.segments {
                let mut slot = slot;
                slot[axis] += segment;
                if self.is_filled(slot) {
                    self.box_at(slot);
                }
            }
        }
    }

    /// Whether a slot is part of a crossing or of a bar: along at most one axis between crossings.
    fn is_filled(&self, slot: [i64; 3]) -> bool {
        let inside = (0..3).all(|k| (0..self.axes[k].len() as i64 - 1).contains(&slot[k]));
        let between = slot
            .iter()
            .filter(|&place| place % (self.segments + 1) != 0);
        inside && between.count() <= 1
    }

    /// Adds those sides of a filled slot that meet an empty one.
    fn box_at(&mut self, slot: [i64; 3]) {
        for (index, side) in Side::ALL.into_iter().enumerate() {
            let step = side.outward().to_array().map(|component| component as i64);
            if self.is_filled(std::array::from_fn(|k| slot[k] + step[k])) {
                continue;
            }
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let [a, b, c, d] = corners.map(|[right, up]| {
                let corner = side.outward() + right * side.right + up * side.up;
                let corner = corner
                    .to_array()
                    .map(|component| usize::from(component > 0.0));
                let place = std::array::from_fn(|k| slot[k] as usize + corner[k]);
                self.vertex(index, side, place)
            });
            self.surface.triangle([a, b, c]);
            self.surface.triangle([a, c, d]);
        }
    }

    fn vertex(&mut self, index: usize, side: Side, place: [usize; 3]) -> u32 {
        *self.known.entry((index, place)).or_insert_with(|| {
            let position = DVec3::from_array(std::array::from_fn(|k| self.axes[k][place[k]]));
            let offset = (position - self.origin) / self.texture_period;
            // A quarter period puts the middle of a cell on the middle of a bar.
            let texture = DVec2::new(side.right.dot(offset), -side.up.dot(offset)) + 0.25;
            self.surface.vertex(position, side.outward(), texture)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Shape, witness};
    use super::*;

    #[test]
    fn is_closed_and_exact() {
        for cells in [[1, 1, 1], [2, 2, 2], [1, 2, 3]] {
            for (spacing, thickness) in [(1.0, 0.1), (2.0, 1.5), (0.3, 0.001)] {
                for resolution in [1, 2, 5] {
                    let shape = Shape::lattice(cells, spacing, thickness).unwrap();
                    let mesh = witness::mesh(&shape.with_resolution(resolution).unwrap());
                    let [x, y, z] = cells.map(f64::from);
                    let crossings = (x + 1.0) * (y + 1.0) * (z + 1.0);
                    let bars = x * (y + 1.0) * (z + 1.0)
                        + y * (x + 1.0) * (z + 1.0)
                        + z * (x + 1.0) * (y + 1.0);
                    let squares = 4.0 * bars * f64::from(resolution) + 6.0 * crossings - 2.0 * bars;
                    assert_eq!(mesh.triangles().len() as f64, 2.0 * squares);
                    // Twice that of the solid, which shrinks to a graph of crossings and bars.
                    let characteristic = witness::assert_closed(&mesh) as f64;
                    assert_eq!(characteristic, 2.0 * (crossings - bars));
                    witness::assert_well_made(&mesh);
                    witness::assert_normals_within(&mesh, 1e-9);
                    let free = spacing - thickness;
                    let volume = thickness * thickness * (crossings * thickness + bars * free);
                    witness::assert_volume(&mesh, volume);
                    let area = thickness
                        * (4.0 * bars * free + (6.0 * crossings - 2.0 * bars) * thickness);
                    witness::assert_area(&mesh, area);
                    let (low, high) = mesh.bounds().unwrap();
                    let size = spacing * DVec3::new(x, y, z) + thickness;
                    assert!((high - low - size).abs().max_element() < 1e-14 * size.max_element());
                    assert_eq!(low, -high);
                }
            }
        }
    }

    #[test]
    fn a_checker_cell_spans_a_bar_and_fits_between_crossings() {
        let mesh = witness::mesh(&Shape::lattice([2; 3], 1.0, 0.1).unwrap());
        let vertices = mesh
            .positions()
            .iter()
            .zip(mesh.texture_coordinates()[0].iter());
        for ((position, uv), normal) in vertices.zip(mesh.normals().unwrap()) {
            let facing_front = *normal == DVec3::Z;
            // The bar along y in the middle: its edges are edges of a cell, half a repeat.
            if facing_front && position.x.abs() < 0.06 && position.y.abs() > 0.06 {
                let edge = f64::from(uv.x) * 2.0;
                assert!((edge - edge.round()).abs() < 1e-5, "{position} {uv}");
            }
        }
    }

    #[test]
    fn a_few_bars_in_many_segments_take_no_more_time_than_their_triangles() {
        let shape = Shape::lattice([1; 3], 1.0, 0.1).unwrap();
        let mesh = witness::mesh(&shape.with_resolution(4096).unwrap());
        assert_eq!(mesh.triangles().len(), 2 * (12 * 4 * 4096 + 8 * 6 - 12 * 2));
    }

    #[test]
    fn bars_that_touch_are_refused() {
        let message = Shape::lattice([1; 3], 1.0, 1.0).unwrap_err().to_string();
        assert_eq!(
            message,
            "thickness is 1, expected less than spacing, which is 1"
        );
        let json = r#"{"cells": 2, "spacing": 1, "thickness": 2}"#;
        let message = serde_json::from_str::<Lattice>(json)
            .unwrap_err()
            .to_string();
        assert!(
            message.starts_with("thickness is 2, expected less"),
            "{message}"
        );
    }

    #[test]
    fn too_many_bars_are_refused_before_any_work() {
        let shape = Shape::lattice([4096; 3], 1.0, 0.1).unwrap();
        let error = shape
            .model(&super::super::Appearance::default())
            .unwrap_err();
        assert!(
            matches!(error, ShapeError::TooManyTriangles { .. }),
            "{error}"
        );
    }
}
