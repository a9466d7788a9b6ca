//! What the program does, for everyone who calls the library.

mod ahead;
mod budget;
mod clock;
mod export;
mod files;
mod input;
mod load;
mod progress;
mod tally;
mod work;

pub use budget::{DEFAULT_MAX_TRIANGLES, Fitted};
pub use export::{
    ExportError, ExportLevel, ExportSettings, Exported, FittedExport, export, export_levels,
    levels_of_detail, write_report,
};
pub use files::{OutputError, check_outputs, file_for_each_step, with_suffix};
pub use input::{InputError, MAX_SCENE_BYTES, SceneTextError, scene_from_bytes, stand_off};
pub use load::{FileFindings, LoadError, load_models};
pub use progress::{Cancelled, Progress};
pub use tally::Tally;
