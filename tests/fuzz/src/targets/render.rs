//! The whole way to a small picture.

use std::sync::Arc;

use photosurface::render::{
    Camera, PictureEffects, PictureOptions, PictureSize, Projection, Scenery, Viewpoint,
};
use photosurface::shape::Color;
use photosurface::tessellate::Precision;
use photosurface::{PlacedScene, SurfaceOptions};

use super::case::{Case, Picture};
use super::in_folder;
use super::reading::check_message;

/// Takes a picture of a [`Case`] at each of its steps, as the command does.
pub fn render(bytes: &[u8]) {
    let case = Case::new(bytes);
    in_folder(|folder| {
        let Some(placed) = case.placed(folder) else {
            return;
        };
        take(&case, placed);
    });
}

fn take(case: &Case, placed: PlacedScene) {
    let Picture {
        size: [width, height],
        samples,
        fov,
        look,
        from,
        by_mesh,
        wireframe,
    } = case.picture;
    let size = PictureSize::new(width, height).expect("a few pixels are a picture");
    let projection = match fov {
        Some(vertical_fov_deg) => Projection::Perspective { vertical_fov_deg },
        None => Projection::FullSky,
    };
    let camera = match Camera::new(size, projection, look.into()) {
        Ok(camera) => camera,
        Err(error) => return check_message(&error),
    };
    let options = PictureOptions {
        samples,
        wireframe: wireframe.then_some(Color([0x2c, 0x3e, 0x50])),
        ..PictureOptions::default()
    };
    let wanted = SurfaceOptions {
        subdivide: case.subdivide,
        precision: Precision::Double,
        ..SurfaceOptions::default()
    };
    let by_mesh = by_mesh || from.is_some();
    let placed = match by_mesh && case.subdivide {
        true => placed.within_budget(wanted, case.budget).0,
        false => placed,
    };
    let at_rest = match by_mesh {
        true => None,
        false => Some(at_rest(&placed)),
    };
    for step in 0..placed.scene().steps().len() {
        let moment = placed.scene().moment(step).expect("a step");
        let viewpoint = match from {
            Some(place) => Viewpoint::Outside(place.into()),
            None => Viewpoint::Observer(&moment),
        };
        let seen;
        let scenery = match &at_rest {
            Some(scenery) => scenery,
            None => {
                seen = photosurfaces(&placed, step, wanted);
                &seen
            }
        };
        let picture = scenery.picture(&camera, viewpoint, options);
        let mut png = vec![];
        picture.write_png(&mut png).expect("memory takes a picture");
        assert!(png.starts_with(b"\x89PNG"));
    }
}

/// Nothing yet, in the light that the scene calls for.
fn lit(placed: &PlacedScene) -> Scenery {
    let mut scenery = Scenery::new();
    let effects = placed.scene().effects();
    if effects.is_some() {
        scenery.set_effects(PictureEffects::new(effects));
    }
    scenery.set_lamps(placed.scene());
    scenery
}

fn at_rest(placed: &PlacedScene) -> Scenery {
    let mut scenery = lit(placed);
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part);
        }
    }
    scenery
}

fn photosurfaces(placed: &PlacedScene, step: usize, wanted: SurfaceOptions) -> Scenery {
    let mut scenery = lit(placed);
    scenery.set_occluders(&Arc::new(at_rest(placed)));
    if let Some(marker) = placed.marker() {
        scenery.add_in_view(marker);
    }
    let moment = placed.scene().moment(step).expect("a step");
    for surface in placed.photosurfaces(step, wanted).expect("a step") {
        let mut objects = placed.scene().objects().iter();
        let object = objects
            .find(|object| object.name == surface.facts.object)
            .expect("a photosurface is of an object of its scene");
        scenery.add_photosurface(object, &moment, &surface.mesh, surface.material.as_ref());
    }
    scenery
}
