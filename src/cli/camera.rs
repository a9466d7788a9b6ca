//! Flags that say what a picture shows and from where, and cameras that frame everything.

use std::f64::consts::PI;
use std::num::NonZeroU32;

use anyhow::{Context, anyhow, bail, ensure};
use photosurface::{
    Camera, CameraError, Color, DVec3, PictureSize, PlacedScene, Projection, SurfaceOptions,
};

use super::args::{Given, number, refuse, vector};

/// From where everything is looked at if nothing else is said: from in front, a little from above and the right.
const FROM: DVec3 = DVec3::new(0.3, 0.3, 1.0);

/// Room around what is framed.
const FRAME: f64 = 1.08;

/// The field of view of an observer's picture, in degrees, if nothing else is said.
pub(super) const OBSERVER_FOV: f64 = 60.0;

/// Between this many directions there are about 20 degrees: what is round sticks out by less than 2 % of its radius
/// between two places that are farthest out.
const DIRECTIONS: usize = 128;

/// A camera that frames something by itself is at least so narrow and at most so wide, in degrees.
const FIELD: std::ops::RangeInclusive<f64> = 1e-6..=100.0;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Camera (places and directions are in the observer's frame)")]
pub(super) struct CameraArgs {
    /// What the observer sees, or photosurfaces from any other place
    #[arg(long, value_enum, default_value_t = View::Observer)]
    pub(super) view: View,
    /// How the observer's view is made; from outside there are photosurfaces only
    /// [default: rays for the observer, mesh from outside]
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Width and height of the picture in pixels, of each one on a sheet [default: 1280x720, on a sheet 320x240]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<PictureSize>,
    /// Field of view from the lower to the upper edge, in degrees, above 0 and below 180 [default: 60, from outside
    /// 30; the observer's on a sheet, and of a mesh without --look and --target, so that everything is in the picture]
    #[arg(long, value_name = "DEG", value_parser = number, allow_hyphen_values = true)]
    fov: Option<f64>,
    /// Show the whole sky in longitude and latitude instead
    #[arg(long, conflicts_with = "fov")]
    full_sky: bool,
    /// Direction in which the camera looks, of any length [default: to the middle of what is there]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, conflicts_with = "target")]
    look: Option<DVec3>,
    /// Place at which the camera looks, in scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Place of an outside camera, in scene units; the observer is at 0,0,0 [default: so that all of every step
    /// is in the picture]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    from: Option<DVec3>,
    /// Show all steps on one sheet, a column for each: above, what the observer sees, with its proper time; below, the
    /// photosurface from outside, at one scale
    #[arg(long, conflicts_with_all = ["view", "look", "target", "full_sky"])]
    pub(super) sheet: bool,
    /// Show the photosurfaces of all steps in one picture (--view outside)
    #[arg(long, conflicts_with = "sheet")]
    pub(super) together: bool,
    /// Rays a pixel along each side: N for N x N of them, from 1 to 16; they smooth edges and textures
    #[arg(long, value_name = "N", default_value = "3", value_parser = samples, allow_hyphen_values = true)]
    pub(super) samples: NonZeroU32,
    /// Colour where nothing is seen, #rrggbb
    #[arg(long, value_name = "COLOR", value_parser = color, default_value = "#14171c")]
    pub(super) background: Color,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum View {
    /// From the observer's place, with the light that arrives there
    Observer,
    /// From any other place
    Outside,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Method {
    /// Follow light back to where it came from
    Rays,
    /// Look at the photosurfaces
    Mesh,
}

/// A camera somewhere outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outside {
    pub(super) camera: Camera,
    pub(super) place: DVec3,
    /// How high the picture is in the middle of what it shows, in scene units.
    pub(super) height: f64,
}

impl CameraArgs {
    /// How the observer's view is made, if there is one.
    pub(super) fn method(&self) -> anyhow::Result<Method> {
        let outside = self.view == View::Outside;
        ensure!(
            outside || !self.together,
            "--together is for --view outside"
        );
        match self.method {
            Some(Method::Rays) if outside => bail!(
                "--method rays is what the observer sees; from outside there are photosurfaces only (--method mesh)"
            ),
            _ if !outside && !self.sheet && self.from.is_some() => {
                bail!("--from is for --view outside; the observer is at 0,0,0")
            }
            Some(method) => Ok(method),
            None if outside => Ok(Method::Mesh),
            None => Ok(Method::Rays),
        }
    }

    /// Flags of meshes are an error where there are rays alone.
    pub(super) fn refuse_unused(&self, method: Method, of_meshes: &[Given]) -> anyhow::Result<()> {
        match self.shows_meshes(method) {
            true => Ok(()),
            false => refuse(
                of_meshes,
                "is for meshes, which rays do not need; add --method mesh, --view outside or --sheet",
            ),
        }
    }

    /// Whether there are photosurfaces in the pictures.
    pub(super) fn shows_meshes(&self, method: Method) -> bool {
        self.sheet || method == Method::Mesh
    }

    /// Of one picture.
    pub(super) fn size(&self) -> PictureSize {
        let [width, height] = if self.sheet { [320, 240] } else { [1280, 720] };
        self.size.unwrap_or_else(|| {
            PictureSize::new(width, height).expect("both sides are within the limits")
        })
    }

    fn camera(&self, fov: f64, look: DVec3) -> anyhow::Result<Camera> {
        let projection = match self.full_sky {
            true => Projection::FullSky,
            false => Projection::Pinhole {
                vertical_fov_deg: fov,
            },
        };
        Camera::new(self.size(), projection, look).map_err(|error| match error {
            CameraError::FieldOfView(_) => anyhow::Error::new(error).context("--fov"),
            CameraError::Look(_) if self.look.is_some() => {
                anyhow::Error::new(error).context("--look")
            }
            CameraError::Look(_) if self.target.is_some() => {
                anyhow!("--target is the place of the camera, expected another one")
            }
            CameraError::Look(_) if self.from.is_some() => anyhow!(
                "--from is the middle of what is shown, expected another place, or a --look"
            ),
            _ => error.into(),
        })
    }

    fn aspect(&self) -> f64 {
        f64::from(self.size().width()) / f64::from(self.size().height())
    }

    /// The field of view of the observer at all steps, in degrees; `places` are those of each step, of a mesh alone or
    /// of a scene.
    pub(super) fn observer_fov(
        &self,
        places: impl Iterator<Item = Vec<DVec3>>,
        is_mesh: bool,
    ) -> f64 {
        let is_turned = self.look.is_some() || self.target.is_some();
        match self.fov {
            Some(fov) => fov,
            None if self.sheet || (is_mesh && !is_turned) => fitting_fov(places, self.size()),
            None => OBSERVER_FOV,
        }
    }

    /// The camera of the observer, who sees something at `places`.
    pub(super) fn at_observer(&self, fov: f64, places: &[DVec3]) -> anyhow::Result<Camera> {
        let look = self.look.or(self.target);
        self.camera(fov, look.unwrap_or_else(|| middle_of_sky(places)))
    }

    /// A camera outside that frames places, several lists of them one after another from one distance.
    pub(super) fn outside(&self, places: &[Vec<DVec3>]) -> anyhow::Result<Vec<Outside>> {
        let fov = self.fov.unwrap_or(30.0);
        let half = (fov.clamp(*FIELD.start(), 179.0).to_radians() / 2.0).tan();
        let away = match self.look {
            Some(look) => -look.normalize_or_zero(),
            None => FROM.normalize(),
        };
        // A camera of no direction or field of view is an error in a moment.
        let right = away.cross(DVec3::NEG_Y).try_normalize().unwrap_or(DVec3::X);
        let up = away.cross(right);
        let frames = places.iter().map(|places| {
            let local =
                |place: &DVec3| DVec3::new(place.dot(right), place.dot(up), place.dot(away));
            let (low, high) = bounds(places.iter().map(local));
            // Halves first: the sum of two large numbers may be none.
            let middle = low / 2.0 + high / 2.0;
            let target = right * middle.x + up * middle.y + away * middle.z;
            let target = match self.target {
                Some(target) => target,
                // Nothing is framed as well by one place as by another.
                None if places.is_empty() => DVec3::ZERO,
                None => target,
            };
            let distances = places.iter().map(|place| {
                let from_target = local(&(*place - target));
                let across = (from_target.x.abs() / self.aspect()).max(from_target.y.abs());
                from_target.z + FRAME * across / half
            });
            let distance = distances.fold(0.0, f64::max);
            (target, distance.max(least_distance(target, distance)))
        });
        let frames: Vec<_> = frames.collect();
        let distance = frames.iter().map(|frame| frame.1).fold(0.0, f64::max);
        let outside = |(target, _): (DVec3, f64)| {
            let place = self.from.unwrap_or(target + away * distance);
            let distance = match self.from {
                Some(from) => length(from - target),
                None => distance,
            };
            let height = 2.0 * half * distance;
            ensure!(
                target.is_finite() && place.is_finite() && height.is_finite(),
                "what is to be seen is so far away or so large, up to {:e}, that no camera outside can frame it; look at other \
                 --steps, or at a lower speed",
                places_reach(places)
            );
            let camera = self.camera(fov, self.look.unwrap_or(target - place))?;
            Ok(Outside {
                camera,
                place,
                height,
            })
        };
        frames.into_iter().map(outside).collect()
    }
}

/// The field of view in which the observer sees all places of each step, looking to their middle, in degrees.
pub(super) fn fitting_fov(places: impl Iterator<Item = Vec<DVec3>>, size: PictureSize) -> f64 {
    let widest = places.map(|places| {
        let middle = middle_of_sky(&places);
        // Of small angles the cosine knows nothing.
        let angle = |place: &DVec3| {
            let place = fair(*place);
            place.cross(middle).length().atan2(place.dot(middle))
        };
        places.iter().map(angle).fold(0.0, f64::max)
    });
    let half = widest.fold(0.0, f64::max) * FRAME;
    // The narrower side of the picture holds it.
    let aspect = f64::from(size.width()) / f64::from(size.height());
    let tan = half.min(1.5).tan() / aspect.min(1.0);
    (2.0 * tan.atan().to_degrees()).clamp(*FIELD.start(), *FIELD.end())
}

/// The middle of the sky that is taken up, not of space: an observer may be in the midst of things.
pub(super) fn middle_of_sky(places: &[DVec3]) -> DVec3 {
    let directions: Vec<_> = places
        .iter()
        .filter_map(|place| fair(*place).try_normalize())
        .collect();
    // Not the mean of the vertices, of which there may be more on one side.
    let (low, high) = bounds(directions.into_iter());
    (low + high).try_normalize().unwrap_or(DVec3::NEG_Z)
}

/// A place, or what is in the same direction and neither so far away nor so close that squares overflow or vanish.
fn fair(place: DVec3) -> DVec3 {
    let largest = place.abs().max_element();
    if (1e-140..1e140).contains(&largest) || largest == 0.0 || !place.is_finite() {
        return place;
    }
    // In two steps, because the reciprocal of the least numbers is none.
    let scale = if largest < 1.0 { 1e160 } else { 1e-160 };
    let nearer = place * scale;
    nearer / nearer.abs().max_element()
}

/// The length of a vector, also where its square overflows or vanishes.
fn length(vector: DVec3) -> f64 {
    let largest = vector.abs().max_element();
    match (1e-140..1e140).contains(&largest) || !(largest > 0.0 && vector.is_finite()) {
        true => vector.length(),
        false => (vector / largest).length() * largest,
    }
}

/// How far from `target` a camera has to be at least so that it looks at it in spite of roundings, and at a single point
/// from somewhere.
fn least_distance(target: DVec3, distance: f64) -> f64 {
    let least = target.abs().max_element() * 1e-12;
    if distance > 0.0 {
        least
    } else {
        least.max(1.0)
    }
}

/// The largest coordinate of all places.
fn places_reach(places: &[Vec<DVec3>]) -> f64 {
    let all = places.iter().flatten();
    all.map(|place| place.abs().max_element())
        .fold(0.0, f64::max)
}

fn bounds(places: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    places.fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), place| (low.min(place), high.max(place)),
    )
}

/// Where things are seen at one step, as far as their given vertices say.
pub(super) fn rough_places(placed: &PlacedScene, step: usize) -> Vec<DVec3> {
    let wanted = SurfaceOptions {
        subdivide: false,
        ..SurfaceOptions::default()
    };
    placed
        .photosurfaces(step, wanted)
        .expect("a step of the scene")
        .flat_map(|surface| surface.mesh.positions().to_vec())
        .collect()
}

/// Those of many places that are farthest out, one for each of [`DIRECTIONS`] directions: what a frame needs of them.
pub(super) fn outermost(places: Vec<DVec3>) -> Vec<DVec3> {
    if places.len() <= DIRECTIONS {
        return places;
    }
    let farthest = |direction: DVec3| {
        let by_distance = |a: &&DVec3, b: &&DVec3| a.dot(direction).total_cmp(&b.dot(direction));
        places.iter().max_by(by_distance).copied()
    };
    directions().filter_map(farthest).collect()
}

/// Evenly over the sphere, along a spiral of the golden angle.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..DIRECTIONS).map(|index| {
        let height = (2.0 * index as f64 + 1.0) / DIRECTIONS as f64 - 1.0;
        let (sin, cos) = (index as f64 * PI * (3.0 - 5f64.sqrt())).sin_cos();
        let across = (1.0 - height * height).sqrt();
        DVec3::new(across * cos, height, across * sin)
    })
}

/// `WxH`
pub(super) fn size(text: &str) -> anyhow::Result<PictureSize> {
    let (width, height) = text
        .split_once(['x', 'X'])
        .context("expected WxH like 1280x720")?;
    let number = |text: &str| {
        let text = text.trim();
        text.parse()
            .with_context(|| format!("\"{text}\" is not a number of pixels (expected e.g. 640)"))
    };
    Ok(PictureSize::new(number(width)?, number(height)?)?)
}

/// Rays a pixel along each side.
pub(super) fn samples(text: &str) -> anyhow::Result<NonZeroU32> {
    let number = text.trim().parse().ok();
    let number = number.filter(|number: &NonZeroU32| number.get() <= 16);
    number.with_context(|| format!("\"{text}\" is not a number of rays (expected 1 to 16)"))
}

/// `#rrggbb`
fn color(text: &str) -> anyhow::Result<Color> {
    Ok(Color::try_from(text.to_owned())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use photosurface::DVec2;

    #[test]
    fn what_is_outermost_stands_for_all() {
        let angles = (0..5000).map(|k| f64::from(k) * 2.399_963);
        let ball: Vec<_> = angles
            .map(|angle| DVec3::new(angle.cos(), (0.01 * angle).sin(), angle.sin()).normalize())
            .collect();
        let outer = outermost(ball.clone());
        assert!(outer.len() <= DIRECTIONS && outer.iter().all(|place| ball.contains(place)));
        // What is farthest along a neighbouring direction is less far by twice what lies between the two at most, for
        // all are within 1 of the origin.
        for direction in [DVec3::X, DVec3::Y, DVec3::ONE.normalize()] {
            let farthest = |places: &[DVec3]| {
                let along = places.iter().map(|place| place.dot(direction));
                along.fold(f64::NEG_INFINITY, f64::max)
            };
            let between = directions().map(|other| other.distance(direction));
            let between = between.fold(f64::INFINITY, f64::min);
            assert!(between < 0.3, "{between}");
            assert!(
                farthest(&outer) >= farthest(&ball) - 2.0 * between,
                "{direction}"
            );
        }
        let few = vec![DVec3::ZERO; 3];
        assert_eq!(outermost(few.clone()), few);
    }

    #[test]
    fn sizes_and_colours_are_read() {
        let read = size("640x480").unwrap();
        assert_eq!((read.width(), read.height()), (640, 480));
        for wrong in ["", "640", "0x480", "640x-1", "640x99999", "axb"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(color("#ff0080").unwrap(), Color([255, 0, 128]));
        assert!(color("red").is_err());
    }

    /// Flags as the command line has them.
    fn flags(line: &str) -> CameraArgs {
        #[derive(clap::Parser)]
        struct Flags {
            #[command(flatten)]
            camera: CameraArgs,
        }
        let line = std::iter::once("flags").chain(line.split_whitespace());
        <Flags as clap::Parser>::parse_from(line).camera
    }

    /// Whatever is framed: nothing, one point, tiny and huge things, far and near. The camera is finite and looks at the
    /// middle, or there is one error that says what is wrong.
    #[test]
    fn every_frame_is_finite_or_an_error() {
        let sizes = [
            0.0, 1e-300, 1e-155, 1e-30, 1e-9, 1.0, 1e30, 1e152, 1e156, 1e290, 1e308,
        ];
        let mut frames = vec![vec![], vec![DVec3::splat(f64::NAN)]];
        for size in sizes {
            for away in sizes {
                let middle = DVec3::new(0.2, -0.5, 0.8) * away;
                frames.push(vec![middle - size * 0.5, middle + size * 0.5]);
                frames.push(vec![middle]);
            }
        }
        let mut made = 0;
        for line in [
            "",
            "--look=1,2,3",
            "--look=0,1,0",
            "--target=1,2,3",
            "--from=0,0,0",
            "--from=4,5,6 --fov 1e-6",
            "--fov=179.99",
            "--size 4000x1",
        ] {
            let flags = flags(line);
            for places in &frames {
                let fov = fitting_fov(std::iter::once(places.clone()), flags.size());
                assert!(
                    (*FIELD.start()..=*FIELD.end()).contains(&fov),
                    "{line} {places:?}"
                );
                let look = middle_of_sky(places);
                assert!((look.length() - 1.0).abs() < 1e-12, "{line} {places:?}");
                flags.at_observer(fov, places).unwrap();
                match flags.outside(std::slice::from_ref(places)) {
                    Ok(outside) => {
                        let [
                            Outside {
                                camera,
                                place,
                                height,
                            },
                        ] = outside[..]
                        else {
                            panic!("one frame, one camera")
                        };
                        let middle = DVec2::new(0.5, 0.5) * f64::from(camera.size().height());
                        assert!(place.is_finite() && height.is_finite(), "{line} {places:?}");
                        assert!(camera.direction(middle).is_finite());
                        made += 1;
                    }
                    Err(error) => {
                        let error = format!("{error:#}");
                        assert!(
                            !error.contains("NaN") || places.iter().any(|p| p.is_nan()),
                            "{error}"
                        );
                        let of_frame = error.contains("no camera outside can frame it");
                        let of_flag = error.contains("--from") || error.contains("--target");
                        assert!(of_frame || of_flag, "{line} {places:?}: {error}");
                    }
                }
            }
        }
        assert!(made > 1000, "{made}");
    }

    /// A place so far away, or so close, that its square is not a number is seen where it is.
    #[test]
    fn the_middle_of_the_sky_is_that_of_places_at_any_distance() {
        for distance in [1e-310, 1e-200, 1.0, 1e200, 1e305] {
            let places = [DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.6, -0.8, 0.0)];
            let places = places.map(|place| place * distance);
            assert!(
                middle_of_sky(&places).distance(DVec3::X) < 1e-12,
                "{distance}"
            );
            let size = PictureSize::new(100, 100).unwrap();
            let fov = fitting_fov(std::iter::once(places.to_vec()), size);
            assert_eq!(fov, *FIELD.end());
            let ahead = places.map(|place| DVec3::new(place.x, place.y / 8.0, 0.0));
            let fov = fitting_fov(std::iter::once(ahead.to_vec()), size);
            let expected = 2.0 * FRAME * (1.0_f64 / 6.0).atan().to_degrees();
            assert!(
                (fov - expected).abs() < 1e-9,
                "{distance}: {fov} {expected}"
            );
        }
    }
}
