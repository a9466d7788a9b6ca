//! Photosurfaces made and written one after the other, in any format, with what is reported of them.

use std::io::{Write, stdout};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::ProgressBar;
use photosurface::{
    Export, Facts, Format, GltfFile, GltfOutput, PlacedScene, Playback, Report, StageTime,
    SurfaceOptions, Target, WriteError, write_ply, write_whole, write_whole_gltf,
    write_whole_target,
};

use super::accuracy::Tally;
use super::ahead::in_order;
use super::messages::{Verbosity, counted, print};
use super::output::is_stdout;

/// Photosurfaces in the making, and what has been made of them so far.
pub(super) struct Work<'a> {
    pub(super) placed: &'a PlacedScene,
    pub(super) wanted: SurfaceOptions,
    pub(super) playback: Option<Playback>,
    pub(super) verbosity: Verbosity,
    pub(super) progress: ProgressBar,
    pub(super) clock: Clock,
    pub(super) tally: Tally,
    /// For the report, if there is to be one.
    pub(super) reported: Option<Vec<Facts>>,
    /// Those beside a `.gltf`.
    pub(super) data_files: Vec<PathBuf>,
}

impl Work<'_> {
    fn is_morphing(&self) -> bool {
        matches!(self.playback, Some(Playback::Morph { .. }))
    }

    fn count(&mut self, facts: &Facts) {
        self.verbosity.detail(describe(facts));
        // Where all steps are one mesh, its triangles are there once.
        let first = facts.step == 0 || !self.is_morphing();
        self.tally
            .add(facts, if first { facts.triangles } else { 0 });
        if let Some(reported) = &mut self.reported {
            reported.push(facts.clone());
        }
        self.progress.inc(1);
    }

    /// Makes the photosurfaces of some steps and puts each into the file, so that memory does not grow with them.
    fn fill(&mut self, file: &mut GltfFile<'_>, steps: Range<usize>) -> Result<(), WriteError> {
        let (placed, wanted) = (self.placed, self.wanted);
        if self.is_morphing() {
            for part in placed.morphing(wanted) {
                part.iter().for_each(|step| self.count(&step.facts));
                self.clock.stop("photosurface");
                file.add_morphing(&part)?;
                self.clock.stop("write");
            }
            return Ok(());
        }
        in_order(placed, wanted, steps, |photosurface| {
            self.count(&photosurface.facts);
            self.clock.stop("photosurface");
            file.add(&photosurface)?;
            self.clock.stop("write");
            Ok(())
        })
    }

    /// A GLB or both parts of a `.gltf`.
    fn gltf(&mut self, steps: Range<usize>, output: GltfOutput<'_>) -> Result<(), WriteError> {
        let (scene, attributes) = (self.placed.facts(), self.wanted.attributes);
        let marker = self.placed.marker();
        let mut file = GltfFile::new(output, &scene, marker, attributes, self.playback)?;
        self.fill(&mut file, steps)?;
        file.finish()?;
        self.clock.stop("write");
        Ok(())
    }

    fn glb(&mut self, steps: Range<usize>, target: Target<'_>) -> Result<(), WriteError> {
        let parts: usize = self.placed.objects().map(|(_, parts)| parts.len()).sum();
        let meshes = parts * if self.is_morphing() { 1 } else { steps.len() };
        self.gltf(steps, GltfOutput::glb(target, meshes + 1))
    }

    /// All at once: the format says first how many vertices there are.
    fn ply(&mut self, steps: Range<usize>, out: &mut dyn Write) -> Result<(), WriteError> {
        let (placed, wanted) = (self.placed, self.wanted);
        let mut photosurfaces = vec![];
        for step in steps {
            for photosurface in placed.photosurfaces(step, wanted)? {
                self.count(&photosurface.facts);
                photosurfaces.push(photosurface);
            }
        }
        self.clock.stop("photosurface");
        let export = Export {
            scene: &placed.facts(),
            marker: placed.marker(),
            photosurfaces: &photosurfaces,
            playback: None,
        };
        write_ply(&export, &mut *out)?;
        self.clock.stop("write");
        Ok(out.flush()?)
    }
}

/// Writes a file of some steps, and does what is left to do when all of it is written and it is about to appear.
pub(super) fn write_file(
    path: &Path,
    format: Format,
    work: &mut Work<'_>,
    steps: Range<usize>,
    before_it_appears: impl FnOnce(&Work<'_>) -> Result<(), WriteError>,
) -> anyhow::Result<()> {
    if is_stdout(path) {
        print(|out| {
            match format {
                Format::Ply => work.ply(steps, out)?,
                Format::Glb | Format::Gltf => work.glb(steps, Target::Stream(out))?,
            }
            Ok(())
        })?;
        return Ok(before_it_appears(work)?);
    }
    match format {
        Format::Glb => write_whole_target(path, |target| {
            work.glb(steps, target)?;
            before_it_appears(work)
        })?,
        Format::Ply => write_whole(path, |writer| {
            work.ply(steps, writer)?;
            before_it_appears(work)
        })?,
        Format::Gltf => {
            let data = write_whole_gltf(path, |output| {
                work.gltf(steps, output)?;
                before_it_appears(work)
            })?;
            work.data_files.push(data);
        }
    }
    Ok(())
}

pub(super) fn write_report(
    path: &Path,
    placed: &PlacedScene,
    made: &[Facts],
    clock: &Clock,
) -> Result<(), WriteError> {
    let stages = clock.stages.iter();
    let report = Report {
        scene: placed.facts(),
        objects: made.to_vec(),
        stages: stages
            .map(|&(name, seconds)| StageTime { name, seconds })
            .collect(),
    };
    let text = report.to_json() + "\n";
    let write = |writer: &mut dyn std::io::Write| Ok(writer.write_all(text.as_bytes())?);
    if is_stdout(path) {
        let mut out = stdout().lock();
        write(&mut out)
            .and_then(|()| Ok(out.flush()?))
            .map_err(|error| match error {
                WriteError::Stream(source) => WriteError::Io {
                    path: "stdout".into(),
                    source,
                },
                other => other,
            })
    } else {
        write_whole(path, write)
    }
}

fn describe(facts: &Facts) -> String {
    format!(
        "{}: proper time {}, gamma {:.6}, {}",
        facts.name,
        facts.proper_time,
        facts.relative_gamma,
        counted(facts.triangles, "triangle")
    )
}

/// Wall-clock time of each stage, those of one name added up: what went on in the background meanwhile does not count.
#[derive(Clone)]
pub(super) struct Clock {
    last: Instant,
    pub(super) stages: Vec<(&'static str, f64)>,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            last: Instant::now(),
            stages: Vec::new(),
        }
    }
}

impl Clock {
    /// What went on since the last call, or since the beginning, was `name`.
    pub(super) fn stop(&mut self, name: &'static str) {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        self.last = now;
        match self.stages.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum += seconds,
            None => self.stages.push((name, seconds)),
        }
    }
}
