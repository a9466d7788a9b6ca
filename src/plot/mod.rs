//! Axes, curves, legends and text of plots, and Minkowski diagrams.

mod canvas;
mod frame;
mod labels;
mod minkowski;
mod panel;

pub(crate) use canvas::{
    Area, BLUE, Drawing, Drawn, FAMILY, GREEN, GREY, ORANGE, VIOLET, png, shortened, svg,
};
pub use canvas::{PlotError, PlotSize};
pub(crate) use frame::{Spot, round_step};
pub(crate) use minkowski::{Axes, Course, Dot, Line, Minkowski, Role, Tick};
pub(crate) use panel::{Curve, Panel, Theory};
