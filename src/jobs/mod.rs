//! The tasks of the program (load, export, render, diagrams of flights), for every caller of the library.

mod ahead;
mod budget;
mod caption;
mod check;
mod clock;
mod contrast;
#[cfg(feature = "plot")]
mod diagram;
#[cfg(feature = "plot")]
mod diagram_plot;
mod effect_costs;
mod export;
mod export_settings;
mod exposure;
mod extent;
mod file_camera;
mod files;
mod framing;
mod ghosts;
mod grid;
mod guides;
mod input;
mod labels;
mod layout;
mod legend;
mod load;
mod observer_frame;
mod outside_camera;
mod overview;
mod page;
mod page_data;
mod passage;
mod picture_settings;
mod pictures;
mod progress;
mod rendered;
mod seen;
mod sky_grid;
mod tally;
mod vertex_colors;
mod views;
mod work;

#[cfg(feature = "plot")]
pub use crate::plot::{PlotError, PlotSize};
pub use budget::{DEFAULT_MAX_TRIANGLES, Fitted};
pub use caption::Caption;
pub use check::{Check, CheckedEffect, CheckedLevel, CheckedObject, CheckedStep, CheckedTriangles};
#[cfg(feature = "plot")]
pub use diagram::{
    DiagramError, DiagramMoment, DiagramPoint, DiagramSettings, DiagramTick, Emission, PointLine,
    WorldlineDiagram,
};
pub use effect_costs::EffectCost;
pub use export::{
    ExportLevel, Exported, FittedExport, export, export_levels, levels_of_detail, write_report,
};
pub use export_settings::{ExportError, ExportSettings};
pub use files::{OutputError, check_outputs, file_for_each_step, with_suffix};
pub use framing::{
    Aim, CameraSettings, FieldOfView, Follow, FramingError, OBSERVER_FOV_DEG, PictureProjection,
};
pub use guides::Guides;
pub use input::{InputError, MAX_SCENE_BYTES, SceneTextError, scene_from_bytes, text_of};
pub use load::{FileFindings, LoadError, load_models};
pub use observer_frame::FrameFacts;
pub use overview::Overview;
pub use page::{PageError, PageSettings, page, page_to_file};
pub use passage::{PassageError, fly_by, passage, passing_observer};
pub use picture_settings::{PictureMethod, PictureSettings, PictureView};
pub use pictures::{Variant, overview, render, render_side_by_side, render_to_files};
pub use progress::{Cancelled, Finished, Progress};
pub use rendered::{EmptyView, RenderError, Rendered, ViewCost};
pub use tally::Tally;
pub use vertex_colors::LightNote;
