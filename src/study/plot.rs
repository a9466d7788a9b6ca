//! Cost against accuracy, drawn: of meshes triangles and time over the tolerance, of pictures rays and time over the
//! error, all logarithmic.

use plotters::prelude::*;

use crate::plot::{
    Area, BLUE, Curve, Drawing, Drawn, FAMILY, GREEN, GREY, ORANGE, Panel, PlotError, PlotSize,
    Theory, VIOLET, png, shortened, svg,
};
use crate::scene::Unit;
use crate::study::{CostStudy, Made, MeshCost, RayCost};

impl CostStudy {
    /// A plot of cost against accuracy as SVG: above of meshes, below of pictures by rays.
    ///
    /// # Errors
    ///
    /// There is no point to draw.
    pub fn plot_svg(&self, size: PlotSize) -> Result<String, PlotError> {
        svg(&self.drawing()?, size)
    }

    /// The same as PNG.
    ///
    /// # Errors
    ///
    /// As [`CostStudy::plot_svg`].
    pub fn plot_png(&self, size: PlotSize) -> Result<Vec<u8>, PlotError> {
        png(&self.drawing()?, size)
    }

    fn drawing(&self) -> Result<CostDrawing, PlotError> {
        let rows = [self.mesh_panels(), self.ray_panels()];
        let rows: Vec<[Panel; 2]> = rows.into_iter().flatten().collect();
        if rows.is_empty() {
            return Err(PlotError::Nothing);
        }
        let title = match &self.scene.title {
            Some(title) => format!("What accuracy costs: {title}"),
            None => "What accuracy costs".to_owned(),
        };
        Ok(CostDrawing { title, rows })
    }

    /// Triangles and times; `None` if there are none.
    fn mesh_panels(&self) -> Option<[Panel; 2]> {
        let made = |value: fn(&Made) -> f64| self.points(|cost| cost.made.as_ref().map(value));
        let ours = made(|made| made.triangles as f64);
        let theory = made(|made| made.minimum_with_source);
        let uniform = made(|made| made.uniform.triangles);
        let predicted = self.points(|cost| Some(cost.predicted_triangles));
        let times = made(|made| made.seconds.photosurface);
        let (&tightest, &slowest) = (theory.last()?, times.last()?);
        let tolerance = match self.unit? {
            Unit::Relative => "tolerance, of the diagonal",
            Unit::Absolute => "tolerance, a length",
            Unit::Degrees => "tolerance, degrees",
        };
        let panel = |y_text, through, curves| Panel {
            x_text: tolerance,
            y_text,
            over_errors: true,
            theories: vec![Theory {
                through,
                slope: 1.0,
            }],
            theory_text: "inverse to the tolerance",
            curves,
        };
        Some([
            panel(
                "triangles",
                tightest,
                vec![
                    Curve::new("uniform 1:4", ORANGE, uniform),
                    Curve::new("made", BLUE, ours),
                    Curve::new("least by theory", GREEN, theory),
                    Curve::new("predicted", GREY, predicted).points_alone(),
                ],
            ),
            panel(
                "seconds for meshes",
                slowest,
                vec![
                    Curve::new("refine, map, prove", BLUE, times),
                    Curve::new("write", VIOLET, made(|made| made.seconds.write)),
                    Curve::new("predict", GREY, made(|made| made.seconds.predict)),
                ],
            ),
        ])
    }

    /// Rays and times; `None` if there are no errors that they are for.
    fn ray_panels(&self) -> Option<[Panel; 2]> {
        let points = |error: fn(&RayCost) -> f64, value: fn(&RayCost) -> f64| {
            logarithms(self.rays.iter().map(|cost| (error(cost), value(cost))))
        };
        let rays = points(|cost| cost.error, |cost| cost.rays as f64);
        let largest = points(|cost| cost.largest_error, |cost| cost.rays as f64);
        let times = points(|cost| cost.error, |cost| cost.seconds);
        let (&finest, &slowest) = (rays.last()?, times.last()?);
        let panel = |y_text, through, curves| Panel {
            x_text: "picture error, of white in linear light",
            y_text,
            over_errors: true,
            theories: vec![Theory {
                through,
                slope: 4.0 / 3.0,
            }],
            theory_text: "edges by theory: error to the \u{2212}4/3",
            curves,
        };
        Some([
            panel(
                "rays",
                finest,
                vec![
                    Curve::new("root mean square", BLUE, rays),
                    Curve::new("largest of a pixel", ORANGE, largest),
                ],
            ),
            panel(
                "seconds for pictures",
                slowest,
                vec![Curve::new("root mean square", BLUE, times)],
            ),
        ])
    }

    /// Tolerances and what they cost.
    fn points(&self, value: impl Fn(&MeshCost) -> Option<f64>) -> Vec<(f64, f64)> {
        let point = |cost: &MeshCost| Some((cost.tolerance, value(cost)?));
        logarithms(self.meshes.iter().filter_map(point))
    }
}

/// Rows of panels under a title.
pub(super) struct CostDrawing {
    pub(super) title: String,
    pub(super) rows: Vec<[Panel; 2]>,
}

impl Drawing for CostDrawing {
    fn draw<B: DrawingBackend>(&self, area: &Area<B>, scale: f64) -> Drawn<B> {
        let text = (FAMILY, 17.0 * scale);
        let above = (5.0 * scale) as i32;
        let style = text.into_text_style(area);
        let title = shortened(self.title.clone(), area, &style, area.dim_in_pixel().0)?;
        let area = area.margin(above, 0, 0, 0).titled(&title, text)?;
        let parts = area.split_evenly((self.rows.len(), 2));
        for (row, parts) in self.rows.iter().zip(parts.chunks(2)) {
            // The axes of a row begin at one height.
            let mut lines = 0;
            for (panel, part) in row.iter().zip(parts) {
                lines = lines.max(panel.legend(part, scale)?.len());
            }
            for (panel, part) in row.iter().zip(parts) {
                panel.draw(part, lines, scale)?;
            }
        }
        Ok(())
    }
}

/// Tolerances or errors as numbers that grow with accuracy, and what they cost, both as logarithms.
fn logarithms(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    points
        .map(|(error, cost)| (-error.log10(), cost.log10()))
        .filter(|&(x, y)| x.is_finite() && y.is_finite())
        .collect()
}
