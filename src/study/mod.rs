//! What accuracy costs: for one tolerance after the other the triangles, bytes, time and memory that it takes, what is
//! proven and what is measured then, and what theory and uniform subdivision say; for pictures by rays of light, for one
//! number of rays per pixel after the other, the time that it takes and the error that is measured; for flights the time
//! and the error of each integrator.

mod cost_study;
mod error;
mod flight_reference;
#[cfg(feature = "plot")]
mod integrator_plot;
mod integrator_study;
mod measured;
mod median;
mod memory;
mod mesh_cost;
#[cfg(feature = "plot")]
mod plot;
mod random;
mod ray_cost;
mod settings;
mod true_surface;
mod twofold;
mod uniform;

#[cfg(feature = "plot")]
pub use crate::plot::{PlotError, PlotSize};
pub use cost_study::CostStudy;
pub use error::StudyError;
pub use integrator_study::{
    IntegratorCost, IntegratorRun, IntegratorSettings, IntegratorStudy, Method,
};
pub use mesh_cost::{Made, MeshCost, Seconds};
pub use ray_cost::{Pictures, RayCost, RaySettings};
pub use settings::CostSettings;
pub use uniform::{UniformCost, UniformRun};
