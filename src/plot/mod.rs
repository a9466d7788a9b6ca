//! Axes, legends and text of plots.

mod panel;

pub(crate) use panel::{Curve, FAMILY, GREY, Panel};
