//! The export writes the photosurfaces of a placed scene to files, in any format, for one or several tolerances.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::clock::Clock;
use super::file_camera::file_camera;
use super::files::{check_outputs, file_for_each_step, with_suffix};
use super::vertex_colors::{LightNote, VertexColors};
use super::work::Work;
use super::{ExportError, ExportSettings, Fitted, Progress, Tally};
use crate::material::Part;
use crate::pipeline::{PlacedScene, SurfaceOptions};
use crate::scene::Tolerance;
use crate::write::{Format, ObserverCamera, Report, WriteError, replaced_data, write_whole};

/// The result of an export at one level of detail.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The files with photosurfaces: one for all steps, or one for each step.
    pub files: Vec<PathBuf>,
    /// The data files of `.gltf` files.
    pub data_files: Vec<PathBuf>,
    /// Totals of the photosurfaces in the files.
    pub tally: Tally,
    /// The time that each stage took, and the facts about every photosurface if [`ExportSettings::keep_facts`] is set
    /// or a report is written.
    pub report: Report,
    /// What colours of vertices do not show as pictures do.
    pub notes: Vec<LightNote>,
}

/// Writes the photosurfaces of a placed scene to `path`, in the format of its extension (.glb, .gltf or .ply), with the
/// attributes that the scene asks for. Returns the result for each level of detail.
///
/// The memory needed does not grow with the number of steps, except for a `.ply`. Each file appears whole or not at
/// all; until then an older file with the same name stays.
///
/// # Errors
///
/// An error is returned if settings contradict each other or the format, if a file cannot be written or cannot hold the
/// photosurfaces (found before any work if possible), or if `progress` cancels the export.
pub fn export(
    placed: &PlacedScene,
    settings: &ExportSettings,
    path: &Path,
    progress: &dyn Progress,
) -> Result<Vec<Exported>, ExportError> {
    let format = Format::of_path(path);
    let format = format.ok_or_else(|| ExportError::UnknownExtension(path.to_owned()))?;
    let levels = export_levels(placed, settings, format, path)?;
    check_outputs(levels.iter().flat_map(ExportLevel::outputs), &[])?;
    for level in &levels {
        level.check()?;
    }
    progress.begin(levels.iter().map(ExportLevel::pieces).sum());
    let write = |level: ExportLevel| {
        let fitted = level.fit();
        let report = fitted.level.report.clone();
        fitted.write(progress, |made| match report {
            Some(path) => write_report(&path, made),
            None => Ok(()),
        })
    };
    levels.into_iter().map(write).collect()
}

/// Writes a report as JSON text; the file appears whole or not at all.
///
/// # Errors
///
/// An error is returned if the file cannot be written.
pub fn write_report(path: &Path, report: &Report) -> Result<(), WriteError> {
    let text = report.to_json() + "\n";
    write_whole(path, |writer| Ok(writer.write_all(text.as_bytes())?))
}

/// One level of detail of an export, before anything is made.
#[derive(Clone, Debug)]
pub struct ExportLevel {
    placed: PlacedScene,
    settings: ExportSettings,
    format: Format,
    /// One file for each step, or one for all steps.
    files: Vec<PathBuf>,
    report: Option<PathBuf>,
    camera: Option<ObserverCamera>,
    /// Whether the camera would see the marker.
    sees_marker: bool,
}

/// The levels of detail of an export in a given format. This function splits [`export`] into stages, for callers that
/// show messages or decide something between them.
///
/// # Errors
///
/// An error is returned if settings contradict each other or the format.
pub fn export_levels(
    placed: &PlacedScene,
    settings: &ExportSettings,
    format: Format,
    path: &Path,
) -> Result<Vec<ExportLevel>, ExportError> {
    settings.check(placed, format)?;
    let camera = settings.camera.as_ref();
    let camera = camera
        .map(|camera| file_camera(placed, camera))
        .transpose()?;
    let (camera, sees_marker) = camera.map_or((None, false), |(camera, sees)| (Some(camera), sees));
    let level = |placed: PlacedScene, suffix: &str| {
        let path = with_suffix(path, suffix);
        ExportLevel {
            files: match settings.split {
                true => file_for_each_step(&path, placed.scene().steps().len()),
                false => vec![path],
            },
            report: settings
                .report
                .as_ref()
                .map(|report| with_suffix(report, suffix)),
            settings: settings.clone(),
            camera: camera.clone(),
            sees_marker,
            placed,
            format,
        }
    };
    if settings.levels.is_empty() {
        return Ok(vec![level(placed.clone(), "")]);
    }
    let levels = levels_of_detail(placed, &settings.levels)?.into_iter();
    let levels = levels.enumerate();
    let levels = levels.map(|(index, placed)| level(placed, &format!("_lod{index}")));
    Ok(levels.collect())
}

/// One copy of the placed scene for each of these tolerances, which then holds for all objects.
///
/// # Errors
///
/// An error is returned if a tolerance is given twice.
pub fn levels_of_detail(
    placed: &PlacedScene,
    tolerances: &[Tolerance],
) -> Result<Vec<PlacedScene>, ExportError> {
    for (level, tolerance) in tolerances.iter().enumerate() {
        if tolerances[..level].contains(tolerance) {
            return Err(ExportError::RepeatedLevel(*tolerance));
        }
    }
    let level = |&tolerance| placed.clone().with_tolerance_for_all(tolerance);
    Ok(tolerances.iter().map(level).collect())
}

impl ExportLevel {
    /// The placed scene with the tolerances of this level.
    pub fn placed(&self) -> &PlacedScene {
        &self.placed
    }

    /// The observer's marker in the files: none if the scene has none, or if it would hide everything from a camera
    /// in the file, because objects are as near as the marker is large.
    pub fn marker(&self) -> Option<&Part> {
        self.placed.marker().filter(|_| !self.sees_marker)
    }

    /// The files with photosurfaces that will be written.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The file of this level's report, if one is to be written.
    pub fn report(&self) -> Option<&Path> {
        self.report.as_deref()
    }

    /// Every file that will be overwritten or removed. The data file of a new `.gltf` gets a name made from its
    /// content; the data file of a replaced `.gltf` is removed.
    pub fn outputs(&self) -> impl Iterator<Item = PathBuf> {
        let files = self.files.iter();
        let gltf = files.clone().filter(|_| self.format == Format::Gltf);
        let replaced = gltf.filter_map(|file| replaced_data(file));
        files.cloned().chain(replaced).chain(self.report.clone())
    }

    /// The number of pieces of work for [`Progress`]: one for each photosurface of this level.
    pub fn pieces(&self) -> usize {
        let parts: usize = self.placed.objects().map(|(_, parts)| parts.len()).sum();
        parts * self.placed.scene().steps().len()
    }

    /// Checks that a file can hold the photosurfaces, as far as that is known before they are made.
    ///
    /// # Errors
    ///
    /// An error is returned if there are more bytes or vertices than the format has room for, or numbers beyond its
    /// range.
    pub fn check(&self) -> Result<(), ExportError> {
        let steps = match self.settings.split {
            true => 1,
            false => self.placed.scene().steps().len(),
        };
        let fits = self.format.min_size(&self.placed, steps);
        fits.and_then(|_| self.format.check_range(&self.placed))
            .map_err(|source| ExportError::of_file(&self.files[0], source))
    }

    /// Loosens the aims of this level until they fit the budget.
    pub fn fit(self) -> FittedExport {
        let mut clock = Clock::after(&self.settings.stages_before);
        let wanted = SurfaceOptions {
            subdivide: self.settings.subdivide,
            ..self.format.surface_options(self.placed.scene())
        };
        let fitted = wanted
            .subdivide
            .then(|| Fitted::new(self.placed.clone(), wanted, self.settings.max_triangles));
        clock.stop("predict");
        FittedExport {
            level: self,
            wanted,
            fitted,
            clock,
        }
    }
}

/// One level of detail of an export whose aims fit the budget, before its photosurfaces are made.
#[derive(Clone, Debug)]
pub struct FittedExport {
    level: ExportLevel,
    wanted: SurfaceOptions,
    fitted: Option<Fitted>,
    clock: Clock,
}

impl FittedExport {
    /// The predictions, and how the budget loosens the tolerances; `None` if meshes are not subdivided.
    pub fn fitted(&self) -> Option<&Fitted> {
        self.fitted.as_ref()
    }

    /// Makes and writes all photosurfaces; their number is [`ExportLevel::pieces`].
    ///
    /// `before_it_appears` is called when the whole file is written and about to appear, or, with one file for each
    /// step, after all files have appeared. If it fails, the export fails, and a single file does not appear.
    ///
    /// # Errors
    ///
    /// An error is returned if a file cannot be written, if its format cannot hold a number, or if `progress` cancels
    /// the export.
    pub fn write(
        self,
        progress: &dyn Progress,
        before_it_appears: impl FnOnce(&Report) -> Result<(), WriteError>,
    ) -> Result<Exported, ExportError> {
        let mut work = self.work(progress);
        let files = &self.level.files;
        let steps = work.placed.scene().steps().len();
        let report = if self.level.settings.split {
            for (step, file) in files.iter().enumerate() {
                let written = work.write_file(file, step..step + 1, |_| Ok(()));
                written.map_err(|error| ExportError::of_file(file, error))?;
            }
            let report = work.take_report();
            let done = before_it_appears(&report);
            done.map_err(|error| ExportError::of_file(&files[0], error))?;
            report
        } else {
            let mut report = None;
            let written = work.write_file(&files[0], 0..steps, |work| {
                before_it_appears(report.insert(work.take_report()))
            });
            written.map_err(|error| ExportError::of_file(&files[0], error))?;
            report.unwrap_or_else(|| work.take_report())
        };
        Ok(Exported {
            files: files.clone(),
            notes: work.notes(),
            data_files: work.data_files,
            tally: work.tally,
            report,
        })
    }

    /// Makes all photosurfaces and writes them to a stream, as a PLY if that is the format, otherwise as a GLB.
    ///
    /// # Errors
    ///
    /// An error is returned if the stream fails, if the format cannot hold a number, or if `progress` cancels the
    /// export.
    pub fn write_to(
        self,
        out: &mut dyn Write,
        progress: &dyn Progress,
    ) -> Result<Exported, WriteError> {
        let mut work = self.work(progress);
        let steps = work.placed.scene().steps().len();
        work.write_stream(out, 0..steps)?;
        Ok(Exported {
            files: vec![],
            data_files: vec![],
            report: work.take_report(),
            notes: work.notes(),
            tally: work.tally,
        })
    }

    fn work<'a>(&'a self, progress: &'a dyn Progress) -> Work<'a> {
        let level = &self.level;
        let placed = self
            .fitted
            .as_ref()
            .map_or(&level.placed, |fitted| &fitted.placed);
        let has_report = level.report.is_some();
        Work {
            placed,
            wanted: self.wanted,
            format: level.format,
            playback: level.settings.playback,
            camera: level.camera.as_ref(),
            marker: level.marker(),
            progress,
            colors: VertexColors::new(placed, &level.settings.textures),
            clock: self.clock.resumed(),
            tally: Tally::default(),
            facts: (level.settings.keep_facts || has_report).then(Vec::new),
            provenance: &level.settings.provenance,
            has_times: level.settings.report_times,
            outputs: vec![],
            data_files: vec![],
        }
    }
}
