//! Single views of a scene: one step as the observer sees it, or some steps from outside.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::extent::{middle_of_sky, outermost};
use super::ghosts::{Ghost, ghosts};
use super::labels::draw_labels;
use super::legend::draw_ramp_legend;
use super::observer_frame::ObserverFrame;
use super::outside_camera::OutsideCamera;
use super::picture_settings::{PictureMethod, PictureSettings, PictureView};
use super::progress::Progress;
use super::rendered::{EmptyView, RenderError, Rendered, ViewCost};
use super::seen::{seen_vertices, sky_of};
use super::sky_grid::{draw_heading, draw_sky_grid};
use crate::effects::Doppler;
use crate::material::Part;
use crate::pipeline::{PlacedScene, PlacedSceneError, SurfaceOptions};
use crate::render::{
    Camera, Picture, PictureEffects, PictureOptions, Scenery, Strokes, Textures, Viewpoint,
    grid_places,
};
use crate::scene::Stops;
use crate::shape::Color;
use crate::spacetime::Moment;

/// The colour of wires, visible on light and on dark surfaces.
const WIRE: Color = Color([0x2c, 0x3e, 0x50]);

/// A placed scene, the settings for drawing views of it, and the facts about the views drawn so far.
pub(super) struct Views<'a> {
    pub(super) placed: &'a PlacedScene,
    pub(super) settings: &'a PictureSettings,
    textures: &'a Textures,
    pub(super) progress: &'a dyn Progress,
    /// All objects in their rest frames, for views by rays.
    at_rest: Option<Scenery>,
    /// What casts shadows in views of photosurfaces, if the scene has lamps.
    occluders: Option<Arc<Scenery>>,
    /// Whether the observer's views are drawn by rays.
    by_rays: bool,
    /// What the scene calls for, if it does.
    effects: Option<PictureEffects>,
    /// The frame of the observer's pictures, once it is known.
    frame: Option<ObserverFrame>,
    /// The first step whose photosurfaces have not been counted yet.
    next_step: usize,
    pub(super) rendered: Rendered,
    /// Size of the upper left corner that a caption takes on the next view, in pixels.
    pub(super) taken_corner: DVec2,
}

impl<'a> Views<'a> {
    pub(super) fn new(
        placed: &'a PlacedScene,
        textures: &'a Textures,
        settings: &'a PictureSettings,
        progress: &'a dyn Progress,
    ) -> Self {
        let by_rays = match settings.view {
            PictureView::Observer(method) | PictureView::Sheet { method, .. } => {
                method == PictureMethod::Rays
            }
            PictureView::Outside { .. } => false,
        };
        let effects = placed.scene().effects().shown();
        let effects = effects.is_some().then(|| PictureEffects::new(effects));
        let only_rays = matches!(settings.view, PictureView::Observer(PictureMethod::Rays));
        let shows_mapped = !only_rays && !placed.scene().lamps().is_empty();
        Self {
            placed,
            settings,
            textures,
            progress,
            at_rest: by_rays.then(|| at_rest(placed, textures, effects.as_ref())),
            occluders: shows_mapped.then(|| Arc::new(at_rest(placed, textures, None))),
            by_rays,
            effects,
            frame: None,
            next_step: 0,
            rendered: Rendered::default(),
            taken_corner: DVec2::ZERO,
        }
    }

    /// What `look` makes of all objects in their rest frames, with the effects that the scene calls for.
    pub(super) fn with_all_at_rest<T>(&self, look: impl FnOnce(&Scenery) -> T) -> T {
        match &self.at_rest {
            Some(scenery) => look(scenery),
            None => look(&at_rest(self.placed, self.textures, self.effects.as_ref())),
        }
    }

    /// Sets the frame of the observer's pictures, if there are any.
    pub(super) fn set_frame(&mut self, frame: Option<ObserverFrame>) {
        self.frame = frame;
        self.rendered.frame = frame.map(|frame| frame.facts());
    }

    /// Sets the exposure of all views.
    pub(super) fn set_exposure(&mut self, stops: Stops) {
        self.effects = self
            .effects
            .take()
            .map(|effects| effects.with_exposure(stops));
        if let Some((scenery, effects)) = self.at_rest.as_mut().zip(self.effects.as_ref()) {
            scenery.set_effects(effects.clone());
        }
    }

    /// Draws what explains the colours of a view, if they need it; once on a picture of several views.
    pub(super) fn draw_legend(&self, picture: &mut Picture) {
        if self.placed.scene().effects().doppler == Doppler::Ramp {
            draw_ramp_legend(picture);
        }
    }

    /// Nothing yet, with the effects that the scene calls for.
    fn scenery(&self) -> Scenery {
        let mut scenery = new_scenery(self.placed, self.textures, self.effects.as_ref());
        if let Some(occluders) = &self.occluders {
            scenery.set_occluders(occluders);
        }
        scenery
    }

    /// The observer's camera at one step.
    pub(super) fn observer_camera(&self, places: &[DVec3]) -> Result<Camera, RenderError> {
        let frame = self
            .frame
            .as_ref()
            .expect("the observer's pictures are framed first");
        Ok(frame.camera(&sky_of(places))?)
    }

    /// What the observer is at one step.
    pub(super) fn moment(&self, step: usize) -> Result<Moment, RenderError> {
        let (scene, steps) = (self.placed.scene(), self.steps().end);
        let moment = scene.moment(step);
        Ok(moment.ok_or(PlacedSceneError::Step { step, steps })?)
    }

    /// The directions, as unit vectors, that the observer's pictures have to show, for each step.
    pub(super) fn skies(&self) -> Result<Vec<Vec<DVec3>>, RenderError> {
        let steps = self.steps().into_par_iter();
        steps.map(|step| Ok(sky_of(&self.framed(step)?))).collect()
    }

    /// The positions, in the observer's frame, that one camera outside has to have in the picture for all steps.
    pub(super) fn all_framed(&self) -> Result<Vec<DVec3>, RenderError> {
        let steps = self.steps().into_par_iter();
        let each = steps.map(|step| self.framed_outside(step));
        let mut all = each.collect::<Result<Vec<_>, _>>()?.concat();
        let marker = self.placed.marker();
        if let Some((low, high)) = marker.and_then(|part| part.mesh().bounds()) {
            all.extend([low, high]);
        }
        Ok(all)
    }

    /// The observer's view at one step.
    pub(super) fn observer(&mut self, step: usize) -> Result<Picture, RenderError> {
        let places = self.framed(step)?;
        let camera = self.observer_camera(&places)?;
        let moment = self.moment(step)?;
        let viewpoint = Viewpoint::Observer(&moment);
        let ghosts = self.ghosts(step)?;
        let mut scenery = match self.at_rest.take() {
            Some(at_rest) => at_rest,
            None => {
                let mut scenery = self.scenery();
                self.add_photosurfaces(&mut scenery, step)?;
                scenery
            }
        };
        let edges = self.set_ghosts(&mut scenery, ghosts, &camera, DVec3::ZERO);
        let (mut picture, cost) = self.take(&scenery, &camera, viewpoint)?;
        scenery.draw(&mut picture, &camera, viewpoint, &edges);
        let background = self.settings.background;
        // Before the marks, which are no sign of an object.
        let is_empty = picture.bytes().chunks(3).all(|pixel| pixel == background.0);
        if self.settings.guides.sky_grid {
            draw_sky_grid(&mut picture, &camera, viewpoint, &scenery, background);
            if let Some(heading) = moment.heading_own() {
                draw_heading(&mut picture, &camera, heading, background);
            }
        }
        self.at_rest = Some(scenery).filter(|_| self.by_rays);
        self.rendered.costs.push(cost);
        if is_empty {
            let look = middle_of_sky(&places);
            self.rendered.empty.push(EmptyView { step, look });
        }
        self.draw_labels(&mut picture, &camera, DVec3::ZERO, step);
        Ok(picture)
    }

    /// The photosurfaces of some steps from outside, with the marker of the observer and the guides.
    pub(super) fn outside(
        &mut self,
        steps: Range<usize>,
        outside: &OutsideCamera,
    ) -> Result<Picture, RenderError> {
        let settings = self.settings;
        let mut scenery = self.scenery();
        // A camera inside the marker would see nothing else.
        let is_inside = |marker: &Part| marker_holds(marker, outside.place);
        if let Some(marker) = self.placed.marker().filter(|marker| !is_inside(marker)) {
            scenery.add_in_view(marker);
        }
        let mut ghosts = Vec::new();
        let first = steps.start;
        for step in steps {
            self.add_photosurfaces(&mut scenery, step)?;
            ghosts.extend(self.ghosts(step)?);
        }
        let edges = self.set_ghosts(&mut scenery, ghosts, &outside.camera, outside.place);
        let viewpoint = Viewpoint::Outside(outside.place);
        let (mut picture, cost) = self.take(&scenery, &outside.camera, viewpoint)?;
        self.rendered.costs.push(cost);
        let background = settings.background;
        settings
            .guides
            .draw(&mut picture, outside, &scenery, &edges, background);
        self.draw_labels(&mut picture, &outside.camera, outside.place, first);
        Ok(picture)
    }

    /// Writes the names of objects beside them, if that is asked for; the caption is on the first of a cell's views.
    fn draw_labels(&mut self, picture: &mut Picture, camera: &Camera, eye: DVec3, step: usize) {
        let corner = std::mem::take(&mut self.taken_corner);
        if self.settings.guides.labels {
            let (place, background) = ((self.placed, step), self.settings.background);
            draw_labels(picture, camera, eye, place, corner, background);
        }
    }

    /// Has a scenery show ghosts; returns their lines, which are drawn onto the picture.
    fn set_ghosts(
        &self,
        scenery: &mut Scenery,
        ghosts: Vec<Ghost>,
        camera: &Camera,
        eye: DVec3,
    ) -> Vec<Strokes<DVec3>> {
        let background = self.settings.background;
        let strokes = ghosts
            .iter()
            .map(|ghost| ghost.strokes(camera, eye, background));
        let strokes = strokes.collect();
        let colored = |ghost: Ghost| {
            let color = ghost.color(background);
            (ghost.mesh, color)
        };
        scenery.set_ghosts(ghosts.into_iter().map(colored));
        strokes
    }

    /// The ghosts of one step.
    fn ghosts(&self, step: usize) -> Result<Vec<Ghost>, RenderError> {
        let options = self.settings.surface_options;
        Ok(ghosts(
            &self.settings.guides.ghosts,
            self.placed,
            step,
            options,
        )?)
    }

    pub(super) fn steps(&self) -> Range<usize> {
        0..self.placed.scene().steps().len()
    }

    /// The seen positions of the source vertices at one step, in the observer's frame; an error if the job has been
    /// cancelled.
    pub(super) fn seen_vertices(&self, step: usize) -> Result<Vec<DVec3>, RenderError> {
        self.progress.advance(0)?;
        Ok(seen_vertices(self.placed, step)?)
    }

    /// The positions, in the observer's frame, of everything that pictures show at one step beside the guides: objects and
    /// their ghosts.
    pub(super) fn framed(&self, step: usize) -> Result<Vec<DVec3>, RenderError> {
        let mut places = self.seen_vertices(step)?;
        let options = SurfaceOptions {
            subdivide: false,
            ..self.settings.surface_options
        };
        for ghost in ghosts(&self.settings.guides.ghosts, self.placed, step, options)? {
            places.extend_from_slice(ghost.mesh.positions());
        }
        Ok(places)
    }

    /// As [`Views::framed`], without those that are not farthest out.
    pub(super) fn framed_outside(&self, step: usize) -> Result<Vec<DVec3>, RenderError> {
        Ok(outermost(self.framed(step)?))
    }

    fn add_photosurfaces(&mut self, scenery: &mut Scenery, step: usize) -> Result<(), RenderError> {
        let placed = self.placed;
        let moment = self.moment(step)?;
        let mut objects = placed.scene().objects().iter().peekable();
        // On a sheet drawn by meshes each photosurface is in two views.
        let is_new = step >= self.next_step;
        self.next_step = self.next_step.max(step + 1);
        for surface in placed.photosurfaces(step, self.settings.surface_options)? {
            self.progress.advance(0)?;
            // Objects and photosurfaces are both in the order of the scene, in which no two objects have the same name.
            while objects
                .next_if(|object| object.name != surface.facts.object)
                .is_some()
            {}
            let object = objects
                .peek()
                .expect("a photosurface is of an object of its scene");
            scenery.add_photosurface(object, &moment, &surface.mesh, surface.material.as_ref());
            if is_new {
                let facts = &surface.facts;
                self.rendered.tally.add(facts, facts.triangles);
            }
        }
        Ok(())
    }

    fn take(
        &self,
        scenery: &Scenery,
        camera: &Camera,
        viewpoint: Viewpoint,
    ) -> Result<(Picture, ViewCost), RenderError> {
        let settings = self.settings;
        let options = PictureOptions {
            samples: settings.samples.get(),
            background: settings.background,
            wireframe: settings.guides.wireframe.then_some(WIRE),
        };
        let start = Instant::now();
        let row_done = || self.progress.advance(1);
        let picture = scenery.try_picture(camera, viewpoint, options, row_done)?;
        let seconds = start.elapsed().as_secs_f64();
        let (width, height) = (camera.size().width(), camera.size().height());
        let of_a_pixel = grid_places(options.samples).count() as u64;
        let rays = u64::from(width) * u64::from(height) * of_a_pixel;
        Ok((picture, ViewCost { rays, seconds }))
    }
}

/// Whether a place is within the bounds of the marker.
fn marker_holds(marker: &Part, place: DVec3) -> bool {
    let holds = |(low, high): (DVec3, DVec3)| place.cmpge(low).all() && place.cmple(high).all();
    marker.mesh().bounds().is_some_and(holds)
}

/// Nothing yet, in the light of the scene's lamps.
fn new_scenery(
    placed: &PlacedScene,
    textures: &Textures,
    effects: Option<&PictureEffects>,
) -> Scenery {
    let mut scenery = Scenery::with_textures(textures);
    if let Some(effects) = effects {
        scenery.set_effects(effects.clone());
    }
    // A ramp is seen by the lamp at the eye: its colours are a scale.
    if placed.scene().effects().doppler != Doppler::Ramp {
        scenery.set_lamps(placed.scene());
    }
    scenery
}

/// All objects of a scene in their rest frames.
fn at_rest(placed: &PlacedScene, textures: &Textures, effects: Option<&PictureEffects>) -> Scenery {
    let mut scenery = new_scenery(placed, textures, effects);
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part);
        }
    }
    scenery
}
