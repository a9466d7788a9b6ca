//! Makes photosurfaces and writes them one after the other, in any format.

use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::ahead::in_order;
use super::clock::Clock;
use super::vertex_colors::{LightNote, VertexColors};
use super::{Cancelled, Progress, Tally};
use crate::material::Part;
use crate::pipeline::{Facts, Photosurface, PlacedScene, SurfaceOptions};
use crate::write::{
    Export, Format, GltfFile, GltfOutput, ObserverCamera, OutputFile, Playback, Provenance, Report,
    Target, WriteError, write_ply, write_whole, write_whole_gltf, write_whole_target,
};

/// An export at work: its settings, and the totals and facts of the photosurfaces made so far.
pub(super) struct Work<'a> {
    pub(super) placed: &'a PlacedScene,
    pub(super) wanted: SurfaceOptions,
    pub(super) format: Format,
    pub(super) playback: Option<Playback>,
    pub(super) camera: Option<&'a ObserverCamera>,
    /// The observer's marker, if the file has one.
    pub(super) marker: Option<&'a Part>,
    pub(super) progress: &'a dyn Progress,
    /// What colours vertices, if the scene calls for it.
    pub(super) colors: Option<VertexColors<'a>>,
    pub(super) clock: Clock,
    pub(super) tally: Tally,
    /// The facts about every photosurface, if they are to be kept.
    pub(super) facts: Option<Vec<Facts>>,
    /// What the photosurfaces are made of.
    pub(super) provenance: &'a Provenance,
    /// Whether the report has the times of the stages.
    pub(super) has_times: bool,
    /// The files written so far, with their lengths.
    pub(super) outputs: Vec<OutputFile>,
    /// Data files that belong to `.gltf` files.
    pub(super) data_files: Vec<PathBuf>,
}

impl Work<'_> {
    fn is_morphing(&self) -> bool {
        matches!(self.playback, Some(Playback::Morph { .. }))
    }

    fn count(&mut self, facts: &Facts) -> Result<(), WriteError> {
        // If all steps share one mesh, its triangles count once.
        let first = facts.step == 0 || !self.is_morphing();
        self.tally
            .add(facts, if first { facts.triangles } else { 0 });
        if let Some(kept) = &mut self.facts {
            kept.push(facts.clone());
        }
        let told = self.progress.advance(1);
        told.map_err(|Cancelled| WriteError::Cancelled)
    }

    /// What is wanted of photosurfaces in the making: colours need more than files have.
    fn needed(&self) -> SurfaceOptions {
        match self.colors {
            Some(_) => VertexColors::needed(self.wanted),
            None => self.wanted,
        }
    }

    /// A photosurface as it is in files, with its colours if the scene calls for them.
    fn finished(&mut self, photosurface: Photosurface) -> Photosurface {
        let Some(colors) = &mut self.colors else {
            return photosurface;
        };
        let photosurface = colors.colored(photosurface, self.wanted.attributes);
        self.clock.stop("effects");
        photosurface
    }

    /// Makes the photosurfaces of some steps and writes each to the file at once, so that memory does not grow with
    /// their number.
    fn fill(&mut self, file: &mut GltfFile<'_>, steps: Range<usize>) -> Result<(), WriteError> {
        let (placed, wanted) = (self.placed, self.needed());
        if self.is_morphing() {
            for part in placed.morphing(wanted) {
                part.iter().try_for_each(|step| self.count(&step.facts))?;
                self.clock.stop("photosurface");
                file.add_morphing(&part)?;
                self.clock.stop("write");
            }
            return Ok(());
        }
        in_order(placed, wanted, steps, |photosurface| {
            self.count(&photosurface.facts)?;
            self.clock.stop("photosurface");
            let photosurface = self.finished(photosurface);
            file.add(&photosurface)?;
            self.clock.stop("write");
            Ok(())
        })
    }

    /// Writes a GLB or both files of a `.gltf`.
    fn gltf(&mut self, steps: Range<usize>, output: GltfOutput<'_>) -> Result<(), WriteError> {
        let (scene, attributes) = (self.placed.facts(), self.wanted.attributes);
        let mut file = GltfFile::new(output, &scene, self.marker, attributes, self.playback)?;
        if let Some(camera) = self.camera {
            file.set_camera(camera.clone());
        }
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

    /// Writes a PLY after all its photosurfaces are made, because the format starts with the number of vertices.
    fn ply(&mut self, steps: Range<usize>, out: &mut dyn Write) -> Result<(), WriteError> {
        let (placed, wanted) = (self.placed, self.needed());
        let mut photosurfaces = vec![];
        for step in steps {
            for photosurface in placed.photosurfaces(step, wanted)? {
                self.count(&photosurface.facts)?;
                photosurfaces.push(photosurface);
            }
        }
        self.clock.stop("photosurface");
        let photosurfaces = photosurfaces.into_iter();
        let photosurfaces: Vec<_> = photosurfaces.map(|made| self.finished(made)).collect();
        let export = Export {
            scene: &placed.facts(),
            marker: self.marker,
            photosurfaces: &photosurfaces,
            playback: None,
        };
        write_ply(&export, &mut *out)?;
        self.clock.stop("write");
        Ok(out.flush()?)
    }

    /// Writes a file of some steps. `before_it_appears` is called when the whole file is written and about to appear.
    pub(super) fn write_file(
        &mut self,
        path: &Path,
        steps: Range<usize>,
        before_it_appears: impl FnOnce(&mut Self) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        match self.format {
            Format::Glb => write_whole_target(path, |target| {
                let bytes = match target {
                    Target::File { file, directory } => {
                        let target = Target::File {
                            file: &mut *file,
                            directory,
                        };
                        self.glb(steps, target)?;
                        file.metadata()?.len()
                    }
                    Target::Stream(out) => {
                        let mut out = Counted::new(out);
                        self.glb(steps, Target::Stream(&mut out))?;
                        out.bytes
                    }
                };
                self.has_written(path, bytes);
                before_it_appears(self)
            }),
            Format::Ply => write_whole(path, |writer| {
                let mut out = Counted::new(writer);
                self.ply(steps, &mut out)?;
                let bytes = out.bytes;
                self.has_written(path, bytes);
                before_it_appears(self)
            }),
            Format::Gltf => {
                let content = |output: GltfOutput<'_>| {
                    self.gltf(steps, output)?;
                    Ok(self)
                };
                let written = |work: &mut Self, files: [(PathBuf, u64); 2]| {
                    for (file, bytes) in &files {
                        work.has_written(file, *bytes);
                    }
                    let [_, (data, _)] = files;
                    work.data_files.push(data);
                    before_it_appears(work)
                };
                write_whole_gltf(path, content, written)?;
                Ok(())
            }
        }
    }

    fn has_written(&mut self, file: &Path, bytes: u64) {
        self.outputs.push(OutputFile {
            file: file.display().to_string(),
            bytes,
        });
    }

    /// Writes some steps to a stream, as a PLY if that is the format, otherwise as a GLB.
    pub(super) fn write_stream(
        &mut self,
        out: &mut dyn Write,
        steps: Range<usize>,
    ) -> Result<(), WriteError> {
        let mut out = Counted::new(out);
        match self.format {
            Format::Ply => self.ply(steps, &mut out)?,
            Format::Glb | Format::Gltf => self.glb(steps, Target::Stream(&mut out))?,
        }
        let bytes = out.bytes;
        self.has_written(Path::new("-"), bytes);
        Ok(())
    }

    /// What is to be said of light and colours that files do not hold as pictures do.
    pub(super) fn notes(&self) -> Vec<LightNote> {
        let colors = self.colors.as_ref();
        let mut notes = colors.map_or(vec![], |colors| colors.notes().to_vec());
        if !self.placed.scene().lamps().is_empty() {
            notes.push(LightNote::Lamps);
        }
        notes
    }

    /// The report of everything made, with the times of the stages. The facts go into it.
    pub(super) fn take_report(&mut self) -> Report {
        Report {
            scene: self.placed.facts(),
            objects: self.facts.take().unwrap_or_default(),
            stages: match self.has_times {
                true => self.clock.stages().to_vec(),
                false => vec![],
            },
            provenance: self.provenance.clone(),
            outputs: std::mem::take(&mut self.outputs),
        }
    }
}

/// A stream, and how many bytes it has taken.
struct Counted<'a> {
    out: &'a mut dyn Write,
    bytes: u64,
}

impl<'a> Counted<'a> {
    fn new(out: &'a mut dyn Write) -> Self {
        Self { out, bytes: 0 }
    }
}

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
