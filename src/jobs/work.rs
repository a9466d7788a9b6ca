//! Makes photosurfaces and writes them one after the other, in any format.

use std::io::{self, BufWriter, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::ahead::in_order;
use super::clock::Clock;
use super::vertex_colors::{LightNote, VertexColors};
use super::{Cancelled, Finished, Progress, Tally};
use crate::material::Part;
use crate::pipeline::{Facts, Photosurface, PlacedScene, SurfaceOptions};
use crate::write::{
    Export, Fingerprint, Format, GltfFile, GltfOutput, ObserverCamera, OutputFile, Playback,
    Provenance, Report, Seal, Target, WriteError, write_sealed_gltf, write_sealed_ply,
    write_whole_target,
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
    /// The fingerprint of the file that is being written, if it gets a seal.
    pub(super) fingerprint: Option<Fingerprint>,
    /// How many photosurfaces of other files are not certified.
    pub(super) uncertified_before: usize,
    /// When something was finished last.
    pub(super) last: Instant,
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
        let is_of_several = steps.len() > 1;
        let parts: usize = placed.objects().map(|(_, parts)| parts.len()).sum();
        let (mut made, mut are_certified) = (0, true);
        in_order(placed, wanted, steps, |photosurface| {
            self.count(&photosurface.facts)?;
            self.clock.stop("photosurface");
            let photosurface = self.finished(photosurface);
            file.add(&photosurface)?;
            self.clock.stop("write");
            made += 1;
            are_certified &= photosurface.facts.certificate.complete;
            if made % parts == 0 {
                let step = photosurface.facts.step;
                if is_of_several {
                    self.tell(step..step + 1, are_certified, None);
                }
                are_certified = true;
            }
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
        if let Some(seal) = self.seal() {
            file.set_seal(&seal);
        }
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
        write_sealed_ply(&export, self.seal().as_ref(), &mut *out)?;
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
        self.uncertified_before = self.tally.uncertified;
        let numbers = steps.clone();
        match self.format {
            Format::Glb => write_whole_target(path, |target| {
                let bytes = match target {
                    Target::File { file, directory } => {
                        let target = Target::File {
                            file: &mut *file,
                            directory,
                        };
                        self.glb(steps, target)?;
                        if let Some(seal) = self.seal() {
                            seal.close(file)?;
                        }
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
            Format::Ply => write_whole_target(path, |target| {
                let bytes = match target {
                    Target::File { file, .. } => {
                        let mut writer = BufWriter::new(&mut *file);
                        let mut out = Counted::new(&mut writer);
                        self.ply(steps, &mut out)?;
                        let bytes = out.bytes;
                        drop(writer);
                        if let Some(seal) = self.seal() {
                            seal.close(file)?;
                        }
                        bytes
                    }
                    Target::Stream(out) => {
                        let mut out = Counted::new(out);
                        self.ply(steps, &mut out)?;
                        out.bytes
                    }
                };
                self.has_written(path, bytes);
                before_it_appears(self)
            }),
            Format::Gltf => {
                let work = &mut *self;
                let content = |output: GltfOutput<'_>| {
                    work.gltf(steps, output)?;
                    Ok(work)
                };
                let written = |work: &mut Self, files: [(PathBuf, u64); 2]| {
                    for (file, bytes) in &files {
                        work.has_written(file, *bytes);
                    }
                    let [_, (data, _)] = files;
                    work.data_files.push(data);
                    before_it_appears(work)
                };
                let seal = |work: &&mut Self| work.seal();
                write_sealed_gltf(path, content, seal, written).map(drop)
            }
        }?;
        let length = |file: &Path| std::fs::metadata(file).map_or(0, |data| data.len());
        let is_certified = self.tally.uncertified == self.uncertified_before;
        if self.format == Format::Gltf
            && let Some(data) = self.data_files.last().cloned()
        {
            let bytes = length(&data);
            self.tell(numbers.clone(), is_certified, Some((&data, bytes)));
        }
        self.tell(numbers, is_certified, Some((path, length(path))));
        Ok(())
    }

    /// The seal of the file that is being written, if it gets one.
    fn seal(&self) -> Option<Seal> {
        Some(Seal {
            fingerprint: self.fingerprint?,
            is_certified: self.tally.uncertified == self.uncertified_before,
        })
    }

    /// Leaves a file of some steps as an earlier run has finished it.
    pub(super) fn resume(
        &mut self,
        path: &Path,
        steps: Range<usize>,
        seal: &Seal,
    ) -> Result<(), WriteError> {
        let parts: usize = self.placed.objects().map(|(_, parts)| parts.len()).sum();
        let told = self.progress.advance(parts * steps.len());
        told.map_err(|Cancelled| WriteError::Cancelled)?;
        let bytes = std::fs::metadata(path).map_or(0, |data| data.len());
        self.progress.finished(&Finished {
            steps,
            of: self.placed.scene().steps().len(),
            seconds: 0.0,
            is_certified: seal.is_certified,
            file: Some((path, bytes)),
            is_resumed: true,
        });
        Ok(())
    }

    /// Tells of a file, or of steps that go into one.
    fn tell(&mut self, steps: Range<usize>, is_certified: bool, file: Option<(&Path, u64)>) {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        self.last = now;
        self.progress.finished(&Finished {
            steps,
            of: self.placed.scene().steps().len(),
            seconds,
            is_certified,
            file,
            is_resumed: false,
        });
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
            resumed: vec![],
            seal: None,
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
