//! The errors of integrators over steps and over time, drawn, both logarithmic.

use plotters::prelude::RGBColor;

use super::plot::CostDrawing;
use crate::plot::{BLUE, Curve, GREEN, ORANGE, Panel, PlotError, PlotSize, Theory, png, svg};
use crate::study::{IntegratorCost, IntegratorRun, IntegratorStudy, Method};

/// Smaller relative errors are drawn as this one: it is the rounding of one number.
const LEAST_ERROR: f64 = 0.5 * f64::EPSILON;

/// Names of the curves: of the event, and of velocity and axes.
type Labels = [&'static str; 2];

impl IntegratorStudy {
    /// A plot of the relative errors of event and axes at the end of the flight as SVG: over the number of steps, with
    /// lines of orders 1 and 4, and over the time.
    ///
    /// # Errors
    ///
    /// No method with steps came to the end, or the drawing library fails.
    pub fn plot_svg(&self, size: PlotSize) -> Result<String, PlotError> {
        svg(&self.drawing()?, size)
    }

    /// The same as PNG.
    ///
    /// # Errors
    ///
    /// As [`IntegratorStudy::plot_svg`].
    pub fn plot_png(&self, size: PlotSize) -> Result<Vec<u8>, PlotError> {
        png(&self.drawing()?, size)
    }

    fn drawing(&self) -> Result<CostDrawing, PlotError> {
        let came_to_the_end = |cost: &IntegratorCost| cost.steps.is_some() && cost.run.is_some();
        if !self.rows.iter().any(came_to_the_end) {
            return Err(PlotError::Nothing);
        }
        let title = match &self.title {
            Some(title) => format!("What the accuracy of a flight costs: {title}"),
            None => "What the accuracy of a flight costs".to_owned(),
        };
        let steps = |cost: &IntegratorCost, _: &IntegratorRun| cost.steps.map(|n| n as f64);
        let seconds = |_: &IntegratorCost, run: &IntegratorRun| Some(run.seconds);
        let exact = ["exact: event", "axes"];
        let rk4 = ["RK4: event", "axes"];
        let euler = ["Euler: event", "axes"];
        let over_steps = [
            self.curves(Method::Euler, euler, ORANGE, steps),
            self.curves(Method::Rk4, rk4, BLUE, steps),
        ];
        let over_time = [
            self.curves(Method::Euler, euler, ORANGE, seconds),
            self.curves(Method::Rk4, rk4, BLUE, seconds),
            self.curves(Method::Exact, exact, GREEN, seconds),
        ];
        let panel = |x_text, theories, theory_text, curves| Panel {
            x_text,
            y_text: "relative error at the end",
            over_errors: false,
            theories,
            theory_text,
            curves,
        };
        let theory = |method, order: f64, x| {
            let through = self.middle(method, x)?;
            Some(Theory {
                through,
                slope: -order,
            })
        };
        let theories = |x: Abscissa| {
            let lines = [theory(Method::Euler, 1.0, x), theory(Method::Rk4, 4.0, x)];
            lines.into_iter().flatten().collect()
        };
        let orders = "orders 1 and 4";
        Ok(CostDrawing {
            title,
            rows: vec![[
                panel(
                    "steps",
                    theories(steps),
                    orders,
                    over_steps.into_iter().flatten().collect(),
                ),
                panel(
                    "seconds",
                    theories(seconds),
                    orders,
                    over_time.into_iter().flatten().collect(),
                ),
            ]],
        })
    }

    /// The errors of the event, joined, and those of the axes, as rings.
    fn curves(&self, method: Method, labels: Labels, color: RGBColor, x: Abscissa) -> [Curve; 2] {
        let [event, axes] = labels;
        let events = self.points(method, x, |run| run.relative_error);
        let of_axes = self.points(method, x, |run| run.axes_error);
        [
            Curve::new(event, color, events),
            Curve::new(axes, color, of_axes).points_alone(),
        ]
    }

    /// The point of a curve that the line of its order goes through: the last one whose error is well above rounding.
    fn middle(&self, method: Method, x: Abscissa) -> Option<(f64, f64)> {
        let points = self.points(method, x, |run| run.relative_error);
        points.into_iter().rfind(|&(_, error)| error > -11.0)
    }

    fn points(
        &self,
        method: Method,
        x: Abscissa,
        error: fn(&IntegratorRun) -> f64,
    ) -> Vec<(f64, f64)> {
        let rows = self.rows.iter().filter(|cost| cost.method == method);
        rows.filter_map(|cost| {
            let run = cost.run.as_ref()?;
            Some((x(cost, run)?.log10(), error(run).max(LEAST_ERROR).log10()))
        })
        .filter(|point| point.1.is_finite())
        .collect()
    }
}

/// What a curve is drawn over.
type Abscissa = fn(&IntegratorCost, &IntegratorRun) -> Option<f64>;
