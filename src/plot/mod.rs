//! Axes, legends and text of plots.

mod canvas;
mod panel;

pub(crate) use canvas::{
    Area, BLUE, Drawing, Drawn, FAMILY, GREEN, GREY, ORANGE, VIOLET, png, shortened, svg,
};
pub use canvas::{PlotError, PlotSize};
pub(crate) use panel::{Curve, Panel, Theory};
