//! Where pictures are made: step by step, by either method, from either side, alone or on a sheet.

use std::ops::Range;
use std::time::Instant;

use anyhow::Context;
use indicatif::ProgressBar;
use photosurface::{
    Camera, Color, DVec3, Picture, PictureOptions, PictureSize, PlacedScene, Scenery, Strokes,
    SurfaceOptions, Tally, Textures, Viewpoint,
};

use super::camera::{CameraArgs, Method, Outside, View, middle_of_sky, outermost, rough_places};
use super::guides::{GuideArgs, label};
use super::messages::{Verbosity, counted};

/// Pixels between the pictures of a sheet.
const GAP: u32 = 4;

/// The colour of wires: it shows on light and on dark surfaces.
const WIRE: Color = Color([0x2c, 0x3e, 0x50]);

/// A placed scene and how pictures of it are taken.
pub(super) struct Studio<'a> {
    placed: &'a PlacedScene,
    camera: &'a CameraArgs,
    guides: &'a GuideArgs,
    textures: &'a Textures,
    wanted: SurfaceOptions,
    verbosity: Verbosity,
    progress: ProgressBar,
    /// All objects in their rest frames, for rays.
    at_rest: Option<Scenery>,
    /// What was made, each photosurface counted once.
    pub(super) tally: Tally,
    /// The first step that has not been counted.
    uncounted: usize,
    /// Whether a mesh alone is looked at, without a scene.
    is_mesh: bool,
    /// The observer's views in which there is nothing, and where the first of them should look.
    empty: Vec<DVec3>,
}

impl<'a> Studio<'a> {
    pub(super) fn new(
        placed: &'a PlacedScene,
        (camera, guides): (&'a CameraArgs, &'a GuideArgs),
        (method, is_mesh): (Method, bool),
        textures: &'a Textures,
        wanted: SurfaceOptions,
        verbosity: Verbosity,
        progress: ProgressBar,
    ) -> Self {
        Self {
            at_rest: match method {
                Method::Rays => Some(at_rest(placed, textures)),
                Method::Mesh => None,
            },
            placed,
            camera,
            guides,
            textures,
            wanted,
            verbosity,
            progress,
            tally: Tally::default(),
            uncounted: 0,
            is_mesh,
            empty: vec![],
        }
    }

    /// Takes all pictures and hands over each, with its number, as soon as it is there.
    pub(super) fn take_all(
        &mut self,
        mut finished: impl FnMut(usize, &Picture) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let steps = self.placed.scene().steps().len();
        let placed = self.placed;
        let all_places = (0..steps).map(|step| rough_places(placed, step));
        let fov = self.camera.observer_fov(all_places, self.is_mesh);
        if self.camera.sheet {
            return finished(0, &self.sheet(fov)?);
        }
        if self.camera.view == View::Observer {
            for step in 0..steps {
                finished(step, &self.observer_view(step, fov)?)?;
            }
            return Ok(());
        }
        let mut all: Vec<DVec3> = (0..steps).flat_map(|step| self.framed(step)).collect();
        if let Some((low, high)) = placed.marker().and_then(|part| part.mesh().bounds()) {
            all.extend([low, high]);
        }
        if self.guides.axes {
            all.push(DVec3::ZERO);
        }
        let outside = self.camera.outside(&[all])?[0];
        if self.camera.together {
            return finished(0, &self.outside_view(0..steps, &outside)?);
        }
        for step in 0..steps {
            finished(step, &self.outside_view(step..step + 1, &outside)?)?;
        }
        Ok(())
    }

    /// What a camera outside has to show of one step.
    fn framed(&self, step: usize) -> Vec<DVec3> {
        let ghosts = self.guides.ghosts(self.placed, step).1;
        outermost([rough_places(self.placed, step), ghosts].concat())
    }

    /// The size of a sheet of so many steps.
    pub(super) fn sheet_size(camera: &CameraArgs, steps: usize) -> anyhow::Result<PictureSize> {
        let size = camera.size();
        let width = steps as u64 * u64::from(size.width() + GAP) - u64::from(GAP);
        let width = u32::try_from(width).unwrap_or(u32::MAX);
        PictureSize::new(width, 2 * size.height() + GAP)
            .context("--sheet: all steps side by side; choose fewer --steps or a smaller --size")
    }

    /// For each step what the observer sees and, below, the photosurface from outside, followed by a camera at
    /// one distance.
    fn sheet(&mut self, fov: f64) -> anyhow::Result<Picture> {
        let size = self.camera.size();
        let background = self.camera.background;
        let steps = self.placed.scene().steps().len();
        let sheet_size = Self::sheet_size(self.camera, steps)?;
        let mut sheet = Picture::filled(sheet_size, between(background));
        let framed: Vec<_> = (0..steps).map(|step| self.framed(step)).collect();
        let outside = self.camera.outside(&framed)?;
        for (step, outside) in outside.iter().enumerate() {
            let mut above = self.observer_view(step, fov)?;
            let proper_time = self.placed.scene().steps()[step];
            label(&mut above, &format!("τ = {proper_time}"), background);
            let below = self.outside_view(step..step + 1, outside)?;
            let x = step as u32 * (size.width() + GAP);
            sheet.paste(&above, x, 0);
            sheet.paste(&below, x, size.height() + GAP);
        }
        Ok(sheet)
    }

    fn observer_view(&mut self, step: usize, fov: f64) -> anyhow::Result<Picture> {
        let places = rough_places(self.placed, step);
        let camera = self.camera.at_observer(fov, &places)?;
        let moment = self.placed.scene().moment(step).context("no such step")?;
        let viewpoint = Viewpoint::Observer(&moment);
        let mapped;
        let scenery = match &self.at_rest {
            Some(scenery) => scenery,
            None => {
                let mut scenery = Scenery::with_textures(self.textures);
                self.add_photosurfaces(&mut scenery, step);
                mapped = scenery;
                &mapped
            }
        };
        let picture = self.take(scenery, &camera, viewpoint);
        let background = self.camera.background.0;
        if picture.bytes().chunks(3).all(|pixel| pixel == background) {
            self.empty.push(middle_of_sky(&places));
        }
        Ok(picture)
    }

    /// Says where there is nothing to be seen, and where there would be.
    pub(super) fn tell_of_empty_pictures(&self) {
        let Some(DVec3 { x, y, z }) = self.empty.first() else {
            return;
        };
        let steps = self.placed.scene().steps().len();
        let which = match steps {
            1 => "nothing is to be seen in the picture".to_owned(),
            _ => format!(
                "nothing is to be seen at {} of {steps} steps",
                self.empty.len()
            ),
        };
        self.verbosity.note(format_args!(
            "{which}: what there is is in another direction, or smaller than a pixel; try --look={x:.3},{y:.3},{z:.3} \
             with a --fov, or --full-sky"
        ));
    }

    fn outside_view(&mut self, steps: Range<usize>, outside: &Outside) -> anyhow::Result<Picture> {
        let mut scenery = Scenery::with_textures(self.textures);
        if let Some(marker) = self.placed.marker() {
            scenery.add_plain(marker);
        }
        let mut edges: Vec<Strokes<DVec3>> = Vec::new();
        for step in steps {
            self.add_photosurfaces(&mut scenery, step);
            for (mesh, ghost_edges) in self.guides.ghosts(self.placed, step).0 {
                scenery.add_ghost(mesh, ghost_edges.color);
                edges.push(ghost_edges);
            }
        }
        let viewpoint = Viewpoint::Outside(outside.place);
        let mut picture = self.take(&scenery, &outside.camera, viewpoint);
        let background = self.camera.background;
        self.guides
            .draw(&mut picture, outside, &scenery, &edges, background);
        Ok(picture)
    }

    fn add_photosurfaces(&mut self, scenery: &mut Scenery, step: usize) {
        let placed = self.placed;
        let mut objects = placed.scene().objects().iter().peekable();
        // On a sheet by meshes each is in two pictures.
        let is_new = step >= self.uncounted;
        self.uncounted = self.uncounted.max(step + 1);
        let surfaces = placed.photosurfaces(step, self.wanted);
        for surface in surfaces.expect("a step of the scene") {
            // Both are in the order of the scene, in which no two objects have one name.
            while objects
                .next_if(|object| object.name != surface.facts.object)
                .is_some()
            {}
            let object = objects
                .peek()
                .expect("a photosurface is of an object of its scene");
            scenery.add_photosurface(object, &surface.mesh, surface.material.as_ref());
            if is_new {
                self.tally.add(&surface.facts, surface.facts.triangles);
            }
        }
    }

    fn take(&self, scenery: &Scenery, camera: &Camera, viewpoint: Viewpoint) -> Picture {
        let options = PictureOptions {
            samples: self.camera.samples.get(),
            background: self.camera.background,
            wireframe: self.guides.wireframe.then_some(WIRE),
        };
        let start = Instant::now();
        let picture = scenery.picture(camera, viewpoint, options, &|| self.progress.inc(1));
        let seconds = start.elapsed().as_secs_f64();
        let pixels = camera.size().width() as usize * camera.size().height() as usize;
        let rays = pixels * (options.samples * options.samples) as usize;
        self.verbosity.detail(format_args!(
            "{} in {seconds:.3} s, {:.2} million a second",
            counted(rays, "ray"),
            rays as f64 / seconds / 1e6
        ));
        picture
    }

    /// How many rows all pictures have together.
    pub(super) fn rows(camera: &CameraArgs, steps: usize) -> usize {
        let pictures = match (camera.sheet, camera.together) {
            (true, _) => 2 * steps,
            (_, true) => 1,
            _ => steps,
        };
        camera.size().height() as usize * pictures
    }
}

/// A colour for what is between pictures: halfway to grey.
fn between(background: Color) -> Color {
    Color(background.0.map(|level| level / 2 + 0x40))
}

fn at_rest(placed: &PlacedScene, textures: &Textures) -> Scenery {
    let mut scenery = Scenery::with_textures(textures);
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part);
        }
    }
    scenery
}
