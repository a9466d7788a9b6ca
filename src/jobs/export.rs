//! The export writes the photosurfaces of a placed scene to files, in any format, for one or several tolerances.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::clock::Clock;
use super::file_camera::file_camera;
use super::files::{check_outputs, file_for_each_step, with_suffix};
use super::vertex_colors::{LightNote, VertexColors};
use super::work::Work;
use super::{ExportError, ExportSettings, Fitted, Progress, Tally};
use crate::material::Part;
use crate::pipeline::{PlacedScene, SurfaceOptions};
use crate::scene::Tolerance;
use crate::write::{
    Fingerprint, Format, ObserverCamera, Report, Seal, WriteError, replaced_data, write_whole,
};

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
    /// Of the files, those that an earlier run finished, and that were not made anew; the totals do not count them.
    pub resumed: Vec<PathBuf>,
    /// Whether everything in the files that were not made anew is certified.
    pub resumed_are_certified: bool,
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
    write_whole(path, |writer| {
        let bytes = match report.seal {
            Some(seal) => seal.close_text(text)?,
            None => text.into_bytes(),
        };
        Ok(writer.write_all(&bytes)?)
    })
}

/// One level of detail of an export, before anything is made.
#[derive(Clone, Debug)]
pub struct ExportLevel {
    placed: PlacedScene,
    settings: ExportSettings,
    format: Format,
    /// Of everything beside the steps that files depend on, if they may be resumed.
    fingerprint: Option<Fingerprint>,
    /// One file for each step, or one for all steps.
    files: Vec<PathBuf>,
    /// The steps in the files.
    steps: Range<usize>,
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
        let count = placed.scene().steps().len();
        let steps = settings.steps(count);
        ExportLevel {
            files: match settings.split {
                true => {
                    let all = file_for_each_step(&path, count);
                    all.get(steps.clone()).unwrap_or_default().to_vec()
                }
                false => vec![path],
            },
            steps,
            report: settings
                .report
                .as_ref()
                .map(|report| with_suffix(report, suffix)),
            fingerprint: settings.fingerprint(&placed, format),
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
        parts * self.steps.len()
    }

    /// The steps in a file, which is counted from 0.
    pub fn steps_of(&self, file: usize) -> Range<usize> {
        match self.settings.split {
            true => self.steps.start + file..self.steps.start + file + 1,
            false => self.steps.clone(),
        }
    }

    /// The fingerprint of a file, which is counted from 0, if files may be resumed.
    fn fingerprint(&self, file: usize) -> Option<Fingerprint> {
        Some(self.fingerprint?.with("steps", &self.steps_of(file)))
    }

    /// The seal of a report of these files.
    fn report_seal(&self, is_certified: bool) -> Option<Seal> {
        let times = self.settings.report_times;
        Some(Seal {
            fingerprint: self.fingerprint?.with("report", &(&self.steps, times)),
            is_certified,
        })
    }

    /// For each file its seal if an earlier run has finished it, so that it is not made anew. A file of all steps is only
    /// finished if its report is, too.
    pub fn finished(&self) -> Vec<Option<Seal>> {
        let finished = |file: usize| Seal::of_file(&self.files[file], self.fingerprint(file)?);
        let all = 0..self.files.len();
        match self.settings.split || self.has_finished_report() {
            true => all.map(finished).collect(),
            false => all.map(|_| None).collect(),
        }
    }

    /// Whether an earlier run has finished the report, or there is none.
    fn has_finished_report(&self) -> bool {
        let Some((path, seal)) = self.report.as_ref().zip(self.report_seal(true)) else {
            return self.report.is_none();
        };
        Seal::of_file(path, seal.fingerprint).is_some()
    }

    /// Checks that a file can hold the photosurfaces, as far as that is known before they are made.
    ///
    /// # Errors
    ///
    /// An error is returned if there are more bytes or vertices than the format has room for, or numbers beyond its
    /// range.
    pub fn check(&self) -> Result<(), ExportError> {
        let steps = self.steps_of(0).len();
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
        let finished = self.finished();
        let is_finished = finished.iter().all(Option::is_some);
        let is_limited = self.settings.max_triangles < u64::MAX;
        let fitted = (wanted.subdivide && is_limited && !is_finished)
            .then(|| Fitted::new(self.placed.clone(), wanted, self.settings.max_triangles));
        clock.stop("predict");
        FittedExport {
            level: self,
            wanted,
            fitted,
            finished,
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
    /// For each file its seal if an earlier run has finished it.
    finished: Vec<Option<Seal>>,
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
        let level = &self.level;
        let files = &level.files;
        let seals = self.finished.iter().flatten();
        let resumed_are_certified = seals.clone().all(|seal| seal.is_certified);
        let resumed: Vec<PathBuf> = files
            .iter()
            .zip(&self.finished)
            .filter_map(|(file, seal)| seal.map(|_| file.clone()))
            .collect();
        let take_report = |work: &mut Work<'_>| {
            let is_certified = resumed_are_certified && work.tally.is_certified();
            Report {
                resumed: resumed.iter().map(|f| f.display().to_string()).collect(),
                seal: level.report_seal(is_certified),
                ..work.take_report()
            }
        };
        for (file, seal) in self.finished.iter().enumerate() {
            if let Some(seal) = seal {
                let told = work.resume(&files[file], level.steps_of(file), seal);
                told.map_err(|error| ExportError::of_file(&files[file], error))?;
            }
        }
        let report = if level.settings.split {
            for (number, file) in files.iter().enumerate() {
                if self.finished[number].is_some() {
                    continue;
                }
                work.fingerprint = level.fingerprint(number);
                let written = work.write_file(file, level.steps_of(number), |_| Ok(()));
                written.map_err(|error| ExportError::of_file(file, error))?;
            }
            let report = take_report(&mut work);
            if resumed.len() < files.len() || !level.has_finished_report() {
                let done = before_it_appears(&report);
                done.map_err(|error| ExportError::of_file(&level.files[0], error))?;
            }
            report
        } else if !resumed.is_empty() {
            take_report(&mut work)
        } else {
            let mut report = None;
            work.fingerprint = level.fingerprint(0);
            let written = work.write_file(&files[0], level.steps.clone(), |work| {
                before_it_appears(report.insert(take_report(work)))
            });
            written.map_err(|error| ExportError::of_file(&files[0], error))?;
            report.unwrap_or_else(|| take_report(&mut work))
        };
        Ok(Exported {
            files: files.clone(),
            resumed,
            resumed_are_certified,
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
        work.write_stream(out, self.level.steps.clone())?;
        Ok(Exported {
            files: vec![],
            resumed: vec![],
            resumed_are_certified: true,
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
            fingerprint: None,
            uncertified_before: 0,
            last: Instant::now(),
        }
    }
}
