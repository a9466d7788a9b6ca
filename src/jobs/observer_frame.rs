//! The frame of the observer's pictures: one projection for all steps, and one direction where the camera holds it.

use std::f64::consts::PI;

use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::extent::{bounds, middle_of_sky};
use super::framing::{
    Aim, CameraSettings, FRAME, FieldOfView, Follow, FramingError, OBSERVER_FOV_DEG,
    PictureProjection,
};
use super::seen::{seen_vertices, sky_of};
use crate::pipeline::PlacedScene;
use crate::render::{Camera, CameraError, PictureSize, Projection};

/// The smallest field of view that is found to fit, in degrees.
const MIN_FOV_DEG: f64 = 1e-6;

/// How often the middle of what is seen is found anew, in the projection about the middle before.
const ROUNDS: usize = 6;

/// A camera that looks closer to straight up or down than this, in radians, has no horizon: the motion goes across its
/// picture.
const NEAR_VERTICAL: f64 = PI / 6.0;

/// The cameras with which the observer takes pictures of all steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ObserverFrame {
    size: PictureSize,
    sight: Sight,
}

/// What the cameras of all steps have in common, whatever the size of the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sight {
    projection: Projection,
    aim: Direction,
    is_cut: bool,
}

/// What the observer's views show of the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameFacts {
    /// How directions are laid out, with the field of view.
    pub projection: Projection,
    /// The angle, in degrees, between the left and right edges of a picture, or between the upper and lower ones if that is
    /// more.
    pub widest_deg: f64,
    /// Whether everything was to be in the picture, and is not: no picture is wide enough. The camera looks in the direction
    /// of motion then.
    pub is_cut: bool,
}

/// Where the cameras look.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Direction {
    /// One direction at all steps, with a direction that is up.
    Held { look: DVec3, up: DVec3 },
    /// The middle of what is seen at each step, with a direction that is up.
    Tracked { flat: Flat, up: DVec3 },
}

/// A projection onto a plane, without its field of view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Flat {
    Perspective,
    Stereographic,
}

/// A direction, and half the height in the plane that shows everything.
#[derive(Clone, Copy, Debug)]
struct Fit {
    look: DVec3,
    half_height: f64,
}

impl CameraSettings {
    /// The observer's camera for each step of a scene, in the order of the steps, as in a series of pictures; all have the
    /// same field of view.
    ///
    /// # Errors
    ///
    /// An error is returned if the field of view is out of range or the aim gives no direction.
    pub fn observer_cameras(&self, placed: &PlacedScene) -> Result<Vec<Camera>, FramingError> {
        let steps = placed.scene().steps().len();
        let skies = (0..steps).map(|step| Ok(sky_of(&seen_vertices(placed, step)?)));
        let skies: Vec<_> = skies.collect::<Result<_, FramingError>>()?;
        let here = self.for_observer(placed.scene().observer(), false);
        let frame = ObserverFrame::new(&here, &skies, heading(placed))?;
        skies.iter().map(|sky| frame.camera(sky)).collect()
    }

    /// The field of view that is asked for, or the customary one, in degrees.
    fn fov_deg(&self) -> f64 {
        match self.field_of_view {
            FieldOfView::Degrees(fov_deg) => fov_deg,
            FieldOfView::Fitting => OBSERVER_FOV_DEG,
        }
    }
}

impl ObserverFrame {
    /// The frame that settings without a usual aim ask for. `skies` are the directions that pictures have to show, as
    /// unit vectors in the observer's axes, a list for each step; `heading` is the direction of motion, if there is one.
    pub(super) fn new(
        settings: &CameraSettings,
        skies: &[Vec<DVec3>],
        heading: Option<DVec3>,
    ) -> Result<Self, FramingError> {
        let frame = |projection, aim, is_cut| {
            let sight = Sight {
                projection,
                aim,
                is_cut,
            };
            Self::of(sight, settings.size)
        };
        let aimed = match settings.aim {
            Aim::Look(look) => Some(look),
            Aim::Target(target) => Some(target),
            Aim::Usual | Aim::Middle => None,
        };
        let held = |look, up| Direction::Held { look, up };
        let all = skies.concat();
        if settings.projection == PictureProjection::FullSky {
            let aim = match (aimed, settings.follow) {
                (Some(look), _) => held(look, DVec3::Y),
                (None, Follow::Track) => Direction::Tracked {
                    flat: Flat::Perspective,
                    up: DVec3::Y,
                },
                (None, _) => held(heading.unwrap_or(DVec3::NEG_Z), DVec3::Y),
            };
            return frame(Projection::FullSky, aim, false).checked(settings);
        }
        let asked = match (settings.projection, settings.field_of_view) {
            // The field of view is one of a camera as people know it.
            (PictureProjection::Usual, FieldOfView::Degrees(_)) => PictureProjection::Perspective,
            (asked, _) => asked,
        };
        let (first, _) = candidates(asked)[0];
        if let Some(look) = aimed {
            let projection = first.projection(settings.fov_deg());
            return frame(projection, held(look, DVec3::Y), false).checked(settings);
        }
        let aspect = aspect(settings.size);
        let up = up_of_passage(middle_of_sky(&all), heading);
        for &(flat, limit_deg) in candidates(asked) {
            let fits: Option<Vec<Fit>> = match settings.follow {
                Follow::Track => {
                    let skies = skies.iter();
                    skies.map(|sky| fit(flat, sky, aspect, up)).collect()
                }
                _ => fit(flat, &all, aspect, up).map(|fit| vec![fit]),
            };
            let Some(fits) = fits else {
                continue;
            };
            let half_height = fits.iter().map(|fit| fit.half_height).fold(0.0, f64::max);
            let fov_deg = match settings.field_of_view {
                FieldOfView::Degrees(fov_deg) => fov_deg,
                FieldOfView::Fitting => flat.fov_deg(half_height).max(MIN_FOV_DEG),
            };
            let widest_deg = flat.fov_deg(half_height * aspect.max(1.0));
            if settings.field_of_view == FieldOfView::Fitting && widest_deg > limit_deg {
                continue;
            }
            let aim = match (settings.follow, fits.first()) {
                (Follow::Track, _) | (_, None) => Direction::Tracked { flat, up },
                (_, Some(fit)) => held(fit.look, up),
            };
            return frame(flat.projection(fov_deg), aim, false).checked(settings);
        }
        let is_cut = settings.field_of_view == FieldOfView::Fitting;
        let look = match is_cut {
            true => heading.unwrap_or(DVec3::NEG_Z),
            false => middle_of_sky(&all),
        };
        let projection = first.projection(settings.fov_deg());
        frame(projection, held(look, DVec3::Y), is_cut).checked(settings)
    }

    /// The frame of pictures of this size.
    pub(super) fn of(sight: Sight, size: PictureSize) -> Self {
        Self { size, sight }
    }

    /// What does not depend on the size of the pictures.
    pub(super) fn sight(&self) -> Sight {
        self.sight
    }

    /// This frame, if it has cameras.
    fn checked(self, settings: &CameraSettings) -> Result<Self, FramingError> {
        match (self.camera(&[]), settings.aim) {
            (Ok(_), _) => Ok(self),
            (Err(FramingError::Camera(CameraError::Look(_))), Aim::Target(target)) => {
                Err(FramingError::TargetIsCamera(target))
            }
            (Err(error), _) => Err(error),
        }
    }

    /// The camera for a step at which things are seen in these directions.
    pub(super) fn camera(&self, sky: &[DVec3]) -> Result<Camera, FramingError> {
        let (look, up) = match self.sight.aim {
            Direction::Held { look, up } => (look, up),
            Direction::Tracked { flat, up } => match fit(flat, sky, aspect(self.size), up) {
                Some(fit) => (fit.look, up),
                None => (middle_of_sky(sky), up),
            },
        };
        Ok(Camera::with_up(self.size, self.sight.projection, look, up)?)
    }

    /// The facts about the pictures.
    pub(super) fn facts(&self) -> FrameFacts {
        let (flat, fov_deg) = match self.sight.projection {
            Projection::Perspective { vertical_fov_deg } => (Flat::Perspective, vertical_fov_deg),
            Projection::Stereographic { vertical_fov_deg } => {
                (Flat::Stereographic, vertical_fov_deg)
            }
            Projection::FullSky => {
                return FrameFacts {
                    projection: self.sight.projection,
                    widest_deg: 360.0,
                    is_cut: self.sight.is_cut,
                };
            }
        };
        let half = flat.half_extent(fov_deg);
        FrameFacts {
            projection: self.sight.projection,
            widest_deg: flat.fov_deg(half * aspect(self.size).max(1.0)),
            is_cut: self.sight.is_cut,
        }
    }
}

/// The direction in which the observer moves at the first step, in its own axes, unless it is at rest in the scene.
pub(super) fn heading(placed: &PlacedScene) -> Option<DVec3> {
    placed.scene().moment(0)?.heading_own()
}

/// Projections in the order in which they are tried, each with the largest angle, in degrees, that a picture may show.
fn candidates(asked: PictureProjection) -> &'static [(Flat, f64)] {
    match asked {
        PictureProjection::Usual => &[(Flat::Perspective, 100.0), (Flat::Stereographic, 240.0)],
        PictureProjection::Stereographic => &[(Flat::Stereographic, 300.0)],
        PictureProjection::Perspective | PictureProjection::FullSky => {
            &[(Flat::Perspective, 150.0)]
        }
    }
}

fn aspect(size: PictureSize) -> f64 {
    f64::from(size.width()) / f64::from(size.height())
}

impl Flat {
    /// The place in the plane of a direction in the camera's axes, right, up and forward; `None` where there is none.
    fn place(self, direction: DVec3) -> Option<DVec2> {
        let depth = match self {
            Self::Perspective => direction.z,
            Self::Stereographic => 1.0 + direction.z,
        };
        (depth > 1e-9).then(|| direction.truncate() / depth)
    }

    /// A direction, of any length, that is seen at a place in the plane.
    fn direction(self, place: DVec2) -> DVec3 {
        match self {
            Self::Perspective => place.extend(1.0),
            Self::Stereographic => (2.0 * place).extend(1.0 - place.length_squared()),
        }
    }

    /// The angle, in degrees, between the edges of a picture whose half extent in the plane is given.
    fn fov_deg(self, half: f64) -> f64 {
        match self {
            Self::Perspective => 2.0 * half.atan().to_degrees(),
            Self::Stereographic => 4.0 * half.atan().to_degrees(),
        }
    }

    /// Half the extent in the plane of a picture between whose edges there is an angle, in degrees.
    fn half_extent(self, fov_deg: f64) -> f64 {
        match self {
            Self::Perspective => (fov_deg.to_radians() / 2.0).tan(),
            Self::Stereographic => (fov_deg.to_radians() / 4.0).tan(),
        }
    }

    fn projection(self, vertical_fov_deg: f64) -> Projection {
        match self {
            Self::Perspective => Projection::Perspective { vertical_fov_deg },
            Self::Stereographic => Projection::Stereographic { vertical_fov_deg },
        }
    }
}

/// The direction in which a picture has to be least high to show everything; `None` if a picture cannot.
fn fit(flat: Flat, sky: &[DVec3], aspect: f64, up: DVec3) -> Option<Fit> {
    let mut look = middle_of_sky(sky);
    let mut best: Option<Fit> = None;
    for _ in 0..ROUNDS {
        let axes = axes(look, up);
        let (low, high) = in_plane(flat, axes, sky)?;
        let half_height = half_height((low, high), aspect);
        if best.is_none_or(|best| half_height < best.half_height) {
            best = Some(Fit { look, half_height });
        }
        let next = axes * flat.direction((low + high) / 2.0);
        look = next.try_normalize()?;
    }
    best
}

/// Half the height of a picture that shows a rectangle of the plane, with a margin.
fn half_height((low, high): (DVec2, DVec2), aspect: f64) -> f64 {
    let reach = low.abs().max(high.abs());
    FRAME * reach.y.max(reach.x / aspect)
}

/// The bounds of all directions in the plane; those of nothing are the middle of the picture.
fn in_plane(flat: Flat, axes: DMat3, sky: &[DVec3]) -> Option<(DVec2, DVec2)> {
    let to_camera = axes.transpose();
    let places: Option<Vec<DVec3>> = sky
        .iter()
        .map(|&direction| Some(flat.place(to_camera * direction)?.extend(0.0)))
        .collect();
    let places = places?;
    if places.is_empty() {
        return Some((DVec2::ZERO, DVec2::ZERO));
    }
    let (low, high) = bounds(places.into_iter());
    Some((low.truncate(), high.truncate()))
}

/// Right, up and forward of a camera, as [`Camera`] has them.
fn axes(look: DVec3, up: DVec3) -> DMat3 {
    let right = look.cross(up).try_normalize().unwrap_or(DVec3::X);
    DMat3::from_cols(right, right.cross(look), look)
}

/// The direction that is up in pictures about a middle: y, but where that is almost straight up or down, the direction for
/// which the motion goes across the picture.
fn up_of_passage(middle: DVec3, heading: Option<DVec3>) -> DVec3 {
    let is_vertical = middle.y.abs() > NEAR_VERTICAL.cos();
    let across = heading.filter(|_| is_vertical);
    let up = across.and_then(|heading| heading.cross(middle).try_normalize());
    // As a camera that looks straight up or down has it.
    let usual = if middle.y > 0.0 {
        DVec3::Z
    } else {
        DVec3::NEG_Z
    };
    match up {
        None => DVec3::Y,
        Some(up) if up.dot(usual) < 0.0 => -up,
        Some(up) => up,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(width: u32, height: u32) -> CameraSettings {
        CameraSettings {
            aim: Aim::Middle,
            follow: Follow::Hold,
            ..CameraSettings::new(PictureSize::new(width, height).unwrap())
        }
    }

    /// Directions on a circle about `middle`, as unit vectors.
    fn ring(middle: DVec3, angle_deg: f64) -> Vec<DVec3> {
        let middle = middle.normalize();
        let (right, up) = middle.any_orthonormal_pair();
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let around = (0..60).map(|k| f64::from(6 * k).to_radians().sin_cos());
        around
            .map(|(y, x)| middle * cos + (right * x + up * y) * sin)
            .collect()
    }

    fn shows(camera: &Camera, direction: DVec3) -> bool {
        let (width, height) = (camera.size().width(), camera.size().height());
        camera.place(direction).is_some_and(|at| {
            at.cmpge(DVec2::ZERO).all() && at.cmple(DVec2::new(width.into(), height.into())).all()
        })
    }

    fn vertical_deg(projection: Projection) -> f64 {
        match projection {
            Projection::Perspective { vertical_fov_deg }
            | Projection::Stereographic { vertical_fov_deg } => vertical_fov_deg,
            Projection::FullSky => 180.0,
        }
    }

    #[test]
    fn everything_is_in_the_picture_and_little_more() {
        let middles = [
            DVec3::NEG_Z,
            DVec3::new(1.0, 0.3, 0.2),
            DVec3::new(0.1, 1.0, 0.0),
            DVec3::NEG_Y,
        ];
        for (width, height) in [(1280, 720), (300, 900), (64, 64)] {
            for middle in middles {
                for angle_deg in [1e-5, 3.0, 40.0, 70.0, 100.0] {
                    let sky = ring(middle, angle_deg);
                    let frame = ObserverFrame::new(
                        &settings(width, height),
                        std::slice::from_ref(&sky),
                        Some(DVec3::X),
                    );
                    let frame = frame.unwrap();
                    let facts = frame.facts();
                    let camera = frame.camera(&sky).unwrap();
                    let context = format!("{width} {middle} {angle_deg} {facts:?}");
                    if facts.is_cut {
                        assert!(angle_deg > 60.0, "{context}");
                        continue;
                    }
                    assert!(
                        sky.iter().all(|&direction| shows(&camera, direction)),
                        "{context}"
                    );
                    // A ring of more than 90 degrees is one of less about the opposite direction.
                    let angle_deg = angle_deg.min(180.0 - angle_deg);
                    let higher = f64::from(height) / f64::from(width);
                    let fov = vertical_deg(facts.projection);
                    // A wide picture in perspective has more degrees in its middle than at its edges.
                    assert!(
                        fov > 2.0 * angle_deg * higher.min(1.0).min(1.0 / higher),
                        "{context}"
                    );
                    assert!(fov < 2.8 * angle_deg * higher.max(1.0), "{context}");
                    let is_flat = matches!(facts.projection, Projection::Perspective { .. });
                    assert!(!is_flat || facts.widest_deg <= 100.0, "{context}");
                    assert!(is_flat || angle_deg > 30.0, "{context}");
                }
            }
        }
    }

    /// Three places of one ball, and what the camera does with them.
    #[test]
    fn a_camera_holds_or_tracks() {
        let skies = [
            DVec3::new(-1.0, 0.0, -2.0),
            DVec3::NEG_Z,
            DVec3::new(1.0, 0.0, -2.0),
        ];
        let skies = skies.map(|middle| ring(middle, 5.0));
        let hold = settings(640, 360);
        let held = ObserverFrame::new(&hold, &skies, Some(DVec3::X)).unwrap();
        let cameras = skies.each_ref().map(|sky| held.camera(sky).unwrap());
        assert!(cameras.iter().all(|camera| camera == &cameras[0]));
        assert!(skies.iter().flatten().all(|&at| shows(&cameras[0], at)));
        let middle = DVec2::new(320.0, 180.0);
        assert!(cameras[0].direction(middle).distance(DVec3::NEG_Z) < 1e-6);
        let track = CameraSettings {
            follow: Follow::Track,
            ..hold
        };
        let tracked = ObserverFrame::new(&track, &skies, Some(DVec3::X)).unwrap();
        for sky in &skies {
            let camera = tracked.camera(sky).unwrap();
            let middle_of_ball = sky.iter().sum::<DVec3>().normalize();
            assert!(camera.direction(middle).distance(middle_of_ball) < 1e-2);
        }
        let widths = [held, tracked].map(|frame| frame.facts().widest_deg);
        assert!(widths[0] > 60.0 && widths[1] < 21.0, "{widths:?}");
    }

    /// A passage overhead goes from left to right, as a passage before the observer does.
    #[test]
    fn a_passage_overhead_goes_across_the_picture() {
        let skies = [-1.0, 0.0, 1.0].map(|x| ring(DVec3::new(x, 2.0, 0.0), 3.0));
        let frame = ObserverFrame::new(&settings(640, 360), &skies, Some(DVec3::NEG_X)).unwrap();
        let camera = frame.camera(&skies[0]).unwrap();
        let places = [-1.0, 1.0].map(|x| camera.place(DVec3::new(x, 2.0, 0.0)).unwrap());
        let across = places[1] - places[0];
        assert!(
            across.x > 100.0 && across.y.abs() < 1e-3 * across.x,
            "{across}"
        );
    }

    #[test]
    fn what_is_all_around_is_cut_along_the_direction_of_motion() {
        let skies = [DVec3::AXES.to_vec(), DVec3::AXES.map(|axis| -axis).to_vec()];
        let frame = ObserverFrame::new(&settings(640, 360), &skies, Some(DVec3::X)).unwrap();
        let facts = frame.facts();
        assert!(facts.is_cut && vertical_deg(facts.projection) == OBSERVER_FOV_DEG);
        let ahead = frame
            .camera(&[])
            .unwrap()
            .direction(DVec2::new(320.0, 180.0));
        assert!(ahead.distance(DVec3::X) < 1e-12);
        let sky = CameraSettings {
            projection: PictureProjection::FullSky,
            ..settings(640, 320)
        };
        assert!(
            !ObserverFrame::new(&sky, &skies, Some(DVec3::X))
                .unwrap()
                .facts()
                .is_cut
        );
    }

    #[test]
    fn settings_that_are_no_numbers_are_errors() {
        let sky = [ring(DVec3::NEG_Z, 10.0)];
        for (bad, projection) in [
            (f64::NAN, PictureProjection::Usual),
            (0.0, PictureProjection::Perspective),
            (180.0, PictureProjection::Usual),
            (360.0, PictureProjection::Stereographic),
        ] {
            let settings = CameraSettings {
                field_of_view: FieldOfView::Degrees(bad),
                projection,
                ..settings(16, 9)
            };
            let error = ObserverFrame::new(&settings, &sky, Some(DVec3::X)).unwrap_err();
            let field = matches!(error, FramingError::Camera(CameraError::FieldOfView { .. }));
            assert!(field, "{bad}: {error}");
        }
        for aim in [
            Aim::Look(DVec3::ZERO),
            Aim::Look(DVec3::NAN),
            Aim::Target(DVec3::INFINITY),
        ] {
            let settings = CameraSettings {
                aim,
                ..settings(16, 9)
            };
            assert!(
                ObserverFrame::new(&settings, &sky, Some(DVec3::X)).is_err(),
                "{aim:?}"
            );
        }
        // Nothing to be seen is no error.
        ObserverFrame::new(&settings(16, 9), &[vec![]], Some(DVec3::X)).unwrap();
        ObserverFrame::new(&settings(16, 9), &[], Some(DVec3::X)).unwrap();
    }
}
