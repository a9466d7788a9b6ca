//! What pictures of all steps have in common: found once by looking at all of them, and handed to whoever draws a part.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::exposure::{expose, is_auto};
use super::observer_frame::{ObserverFrame, Sight};
use super::outside_camera::{Outlook, OutsideCamera};
use super::picture_settings::PictureView;
use super::pictures::frame_observer;
use super::rendered::RenderError;
use super::views::Views;
use crate::scene::Stops;

/// What is found by looking at all steps of scenes before any of their pictures is drawn: the field of view and the direction
/// of the observer's pictures, their exposure, and the places of cameras outside.
///
/// An overview belongs to its scenes and [`PictureSettings`](super::PictureSettings), all but those that say which pictures
/// are drawn. With it a part of the pictures is drawn without a look at the others, and is the same to the byte. As JSON it
/// keeps every digit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Overview {
    /// The observer's pictures, if there are any.
    pub(super) observer: Option<Sight>,
    /// The exposure, in stops, if a scene leaves it to be found.
    exposure: Option<f64>,
    /// A camera outside for each scene, if there are any.
    pub(super) outside: Vec<Outlook>,
}

impl Overview {
    /// Looks at all steps of scenes, of which there is at least one, and hands their views what they need of it. Cameras outside
    /// are left out.
    pub(super) fn look(all: &mut [Views]) -> Result<Self, RenderError> {
        let observer = frame_observer(all)?;
        let has_auto = all.iter().any(is_auto);
        let stops = expose(all)?;
        Ok(Self {
            observer: observer.map(|frame| frame.sight()),
            exposure: has_auto.then_some(stops.get()),
            outside: vec![],
        })
    }

    /// Hands views what they need of it.
    pub(super) fn hand_to(&self, all: &mut [Views]) -> Result<(), RenderError> {
        for views in all.iter_mut() {
            let is_outside = matches!(views.settings.view, PictureView::Outside { .. });
            if self.observer.is_some() == is_outside {
                return Err(RenderError::Overview);
            }
            let size = views.settings.camera.size;
            views.set_frame(self.observer.map(|sight| ObserverFrame::of(sight, size)));
            if is_auto(views) {
                let stops = self.exposure.ok_or(RenderError::Overview)?;
                views.set_exposure(Stops::new(stops).map_err(|_| RenderError::Overview)?);
            }
        }
        Ok(())
    }

    /// The cameras outside, one for each of these scenes.
    pub(super) fn outside_cameras(
        &self,
        all: &[Views],
        from: Option<DVec3>,
    ) -> Result<Vec<OutsideCamera>, RenderError> {
        if self.outside.len() != all.len() {
            return Err(RenderError::Overview);
        }
        let each = self.outside.iter().zip(all);
        let cameras = each.map(|(&found, views)| {
            let camera = &views.settings.camera;
            camera
                .outside_camera(from, found)
                .map_err(RenderError::from)
        });
        cameras.collect()
    }
}
