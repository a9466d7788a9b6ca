//! Flags that commands share: what to look at, and how to override what the scene says.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use clap::Args;
use photosurface::jobs::{MAX_SCENE_BYTES, passage, text_of};
use photosurface::material::Normals;
use photosurface::read::{Access, read_whole};
use photosurface::scene::{FlightPlan, MarkerRadius, Place, Rotation, Time, Units, even_steps};
use photosurface::spacetime::Integrator;
use photosurface::{DQuat, DVec3, Model, Observer, Scene, Velocity};

use super::speeds::SpeedArgs;
use super::values::{list, number, numbers, vector, whole_number};

/// What to look at.
#[derive(Clone, Debug, Args)]
pub(super) struct InputArgs {
    /// A scene file (.json), a mesh (.glb, .gltf, .obj, .ply, .stl, .off), or - to read a scene (JSON), a GLB, PLY, STL or OFF
    /// from stdin; coordinates of a PLY, STL or OFF are taken as they stand, y up
    /// [default: the built-in scene "sphere", of page "flight"]
    #[arg(value_name = "SCENE|MESH")]
    pub(super) input: Option<PathBuf>,
    /// Use a built-in scene; `photosurface example` lists them
    #[arg(long, value_name = "NAME", conflicts_with = "input")]
    pub(super) example: Option<String>,
    /// Also read files in DIR and below that SCENE or MESH refers to; may be given several times. By default such files must
    /// be in the folder of SCENE or MESH, in the working directory, or below, after links are resolved
    #[arg(long, value_name = "DIR", value_parser = folder, help_heading = "Reading")]
    allow_read: Vec<PathBuf>,
    /// Normals of meshes from files (overrides the scene): those of the file, and of flat facets where it has none; "smooth",
    /// with shared vertices, parted along creases of more than DEGREES, 60 if not given; "flat"; "none", so that the
    /// vertices stay those of the file and viewers shade facets. All but "source" replace the normals of the file
    /// [default: source]
    #[arg(
        long,
        value_name = "source|smooth[:DEGREES]|flat|none",
        help_heading = "Reading"
    )]
    pub(super) normals: Option<Normals>,
    /// Maximum number of pixels of all decoded textures together, four bytes each; further textures are left out, with a note
    #[arg(long, value_name = "N", default_value_t = Access::default().max_texture_pixels, value_parser = whole_number, help_heading = "Reading")]
    max_texture_pixels: u64,
}

impl InputArgs {
    /// The folders that may be read beside the usual ones.
    pub(super) fn folders(&self) -> &[PathBuf] {
        &self.allow_read
    }

    /// What may be read of files that other files name.
    pub(super) fn access(&self) -> Access {
        Access {
            folders: self.allow_read.clone(),
            max_texture_pixels: self.max_texture_pixels,
        }
    }
}

/// Flags that override what the scene says of the observer.
#[derive(Debug, Args)]
#[command(next_help_heading = "Observer (overrides the scene)")]
pub(super) struct ObserverArgs {
    #[command(flatten)]
    speed: SpeedArgs,
    /// Direction of the observer's motion, a vector of any length. Without a speed it only changes the direction of the
    /// scene's velocity [default for a mesh: -1,0,0, so that the observer passes before its front, which is the side of z; with
    /// --observer 0,0,-1]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    direction: Option<DVec3>,
    /// Velocity of the observer in units of the speed of light, in place of a speed and a direction
    #[arg(long, value_name = "BX,BY,BZ", value_parser = vector, allow_hyphen_values = true, conflicts_with_all = ["speed", "direction"])]
    velocity: Option<DVec3>,
    /// The observer's own axes at the observation: a unit quaternion that turns those of the observer's frame
    /// [default for a mesh: 0,0,0,1]
    #[arg(long, value_name = "X,Y,Z,W", value_parser = quaternion, allow_hyphen_values = true)]
    orientation: Option<Rotation>,
    /// What the observer does after the observation: a JSON file with a list of segments, or an object like { "flight": [{
    /// "proper_time": 2, "acceleration": [0, 0, -0.5] }] }, as "flight" and "integrator" of an observer in a scene;
    /// with "units" if accelerations are in g and the scene has none. The scene's integrator stays unless the file has one
    #[arg(long, value_name = "FILE")]
    flight: Option<PathBuf>,
    /// The observer keeps the velocity and the axes of the observation at all times, whatever flight the scene has
    #[arg(long, conflicts_with_all = ["flight", "integrator"])]
    no_flight: bool,
    /// How the flight is computed: exact, or by Euler's method or that of Runge and Kutta with steps of so much proper time
    #[arg(long, value_name = "exact|euler:STEP|rk4:STEP", value_parser = integrator, allow_hyphen_values = true)]
    integrator: Option<Integrator>,
    /// Place of the observation in the scene frame, in scene units [default for a mesh: where the observer flies by with the
    /// mesh on its right, two bounding-box diagonals from its centre]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    observer: Option<DVec3>,
    /// Scene time of the observation, in scene units [default for a mesh: 0]
    #[arg(long, value_name = "T", value_parser = number, allow_hyphen_values = true)]
    time: Option<f64>,
    /// Proper times of the observer, counted from the observation: A,B,C or FROM..TO/COUNT; or those of a passage, from the
    /// approach of the objects over their closest pass to their departure: pass, or pass:COUNT [default for a mesh without
    /// --observer: when its centre is seen at a right angle to the motion; on a sheet and in a film: pass]
    #[arg(long, value_name = "A,B,C|FROM..TO/COUNT|pass", value_parser = steps, allow_hyphen_values = true)]
    steps: Option<Steps>,
    /// Radius of a small sphere that marks the observer, in scene units; 0 for none [default for a mesh: 0]
    #[arg(long, value_name = "R", value_parser = number, allow_hyphen_values = true)]
    marker: Option<f64>,
}

/// Steps as one value of a flag.
#[derive(Clone, Debug, PartialEq)]
enum Steps {
    /// Proper times.
    Times(Vec<f64>),
    /// So many moments of a passage.
    Pass(usize),
}

/// How many moments of a passage are looked at unless something else is said.
pub(super) const PASSAGE: usize = 7;

impl ObserverArgs {
    /// Whether a place for the observer is given.
    pub(super) fn has_place(&self) -> bool {
        self.observer.is_some()
    }

    /// Whether steps are given that are the frames of a film, one by one; the moments of a passage are so only if they
    /// have a count.
    pub(super) fn has_frames(&self) -> bool {
        match &self.steps {
            None => false,
            Some(Steps::Times(_)) => true,
            Some(Steps::Pass(count)) => *count != PASSAGE,
        }
    }

    /// Whether place and steps of the observer are left to the program, which makes an observer of a mesh fly by.
    pub(super) fn flies_by(&self) -> bool {
        self.observer.is_none() && self.steps.is_none()
    }

    /// The file of the flight, which must not be written over.
    pub(super) fn file(&self) -> Option<&Path> {
        self.flight.as_deref()
    }

    /// The flags that do not change where a flight leads.
    pub(super) fn beside_the_flight(&self) -> [Given; 3] {
        [
            ("--integrator", self.integrator.is_some()),
            ("--steps", self.steps.is_some()),
            ("--marker", self.marker.is_some()),
        ]
    }

    /// The scene with everything that the flags say.
    pub(super) fn apply(&self, scene: Scene) -> anyhow::Result<Scene> {
        let mut observer = scene.observer().clone();
        observer.velocity = self.velocity(&observer)?;
        if let Some(orientation) = self.orientation {
            observer.orientation = orientation;
        }
        if self.no_flight {
            observer.flight.clear();
            observer.integrator = Integrator::default();
        }
        let mut scene = scene;
        if let Some(path) = &self.flight {
            let plan = read_flight(path, scene.units())?;
            observer.flight = plan.segments;
            observer.integrator = plan.integrator.unwrap_or(observer.integrator);
            scene = match plan.units {
                Some(units) => scene.with_units(units),
                None => scene,
            };
        }
        if let Some(integrator) = self.integrator {
            observer.integrator = integrator;
        }
        if let Some(position) = self.observer {
            observer.position = Place::new(position).context("--observer")?;
        }
        if let Some(time) = self.time {
            observer.time = Time::new(time).context("--time")?;
        }
        if let Some(radius) = self.marker {
            observer.marker = match radius {
                0.0 => None,
                radius => Some(MarkerRadius::new(radius).map_err(|_| {
                    anyhow!("--marker is {radius:?}, expected a length from 1e-60 to 1e60, or 0 for none")
                })?),
            };
        }
        let place = || match (&self.flight, self.integrator) {
            (Some(path), _) => path.display().to_string(),
            (None, Some(_)) => "--integrator".to_owned(),
            (None, None) => "the observer's flight".to_owned(),
        };
        scene.with_observer(observer).with_context(place)
    }

    /// The scene, whose objects have these models, with the steps that the flags say.
    pub(super) fn stepped(&self, scene: Scene, models: &[Model]) -> anyhow::Result<Scene> {
        let steps = match &self.steps {
            Some(Steps::Times(times)) => times.clone(),
            Some(Steps::Pass(count)) => passage(&scene, models, *count).context("--steps")?,
            None => return Ok(scene),
        };
        scene.with_steps(steps).context("--steps")
    }

    /// Several speeds of the observer of a scene, each with the words for a picture; none unless there are several.
    pub(super) fn speeds(&self, observer: &Observer) -> anyhow::Result<Vec<(String, Velocity)>> {
        let direction = self.direction.unwrap_or(observer.velocity.heading());
        self.speed.several(direction)
    }

    /// Several speeds are an error where there is one observer.
    pub(super) fn refuse_speeds(&self) -> anyhow::Result<()> {
        self.speed.refuse_several()
    }

    fn velocity(&self, observer: &Observer) -> anyhow::Result<Velocity> {
        if let Some(vector) = self.velocity {
            return Velocity::from_vector(vector).context("--velocity");
        }
        let scene = observer.velocity;
        let direction = self.direction.unwrap_or(scene.heading());
        if self.direction.is_some() {
            Velocity::from_rapidity(0.0, direction).context("--direction")?;
        }
        match self.speed.velocity(direction)? {
            Some(velocity) => Ok(velocity),
            None => Velocity::from_rapidity(scene.rapidity(), direction).context("--direction"),
        }
    }
}

fn folder(text: &str) -> anyhow::Result<PathBuf> {
    let folder = PathBuf::from(text);
    ensure!(folder.is_dir(), "no such folder");
    Ok(folder)
}

/// `X,Y,Z,W`
fn quaternion(text: &str) -> anyhow::Result<Rotation> {
    let numbers = list(text, "expected four numbers, X,Y,Z,W like 0,0.6,0,0.8")?;
    let &[x, y, z, w] = numbers.as_slice() else {
        anyhow::bail!("has {} numbers, expected 4: X,Y,Z,W", numbers.len());
    };
    Ok(Rotation::new(DQuat::from_xyzw(x, y, z, w))?)
}

/// `exact`, `euler:STEP` or `rk4:STEP`
fn integrator(text: &str) -> anyhow::Result<Integrator> {
    let made = match text.split_once(':') {
        None if text == "exact" => return Ok(Integrator::Exact),
        Some(("euler", step)) => Integrator::euler(number(step)?),
        Some(("rk4", step)) => Integrator::runge_kutta_4(number(step)?),
        _ => bail!("expected exact, euler:STEP or rk4:STEP, as in rk4:0.01"),
    };
    Ok(made?)
}

/// The flight of a file.
fn read_flight(path: &Path, units: Option<Units>) -> anyhow::Result<FlightPlan> {
    let place = || path.display().to_string();
    let bytes = read_whole(path, MAX_SCENE_BYTES).map_err(|error| match error.file() {
        Some(named) if named == path => anyhow::Error::new(error),
        _ => anyhow::Error::new(error).context(place()),
    })?;
    let text = text_of(&bytes).with_context(place)?;
    FlightPlan::from_json(text, units).with_context(place)
}

/// `A,B,C`, `FROM..TO/COUNT`, `pass` or `pass:COUNT`
fn steps(text: &str) -> anyhow::Result<Steps> {
    const FORMS: &str = "expected A,B,C like -1,0,2.5, or FROM..TO/COUNT like -6..6/7, or pass, or pass:COUNT like pass:9";
    let whole = |text: &str| {
        let count: usize = text.trim().parse().ok()?;
        Some(count)
    };
    match text.trim().split_once(':') {
        None if text.trim() == "pass" => return Ok(Steps::Pass(PASSAGE)),
        Some(("pass", count)) => {
            let count = whole(count)
                .with_context(|| format!("\"{}\" is not a count, {FORMS}", count.trim()))?;
            return Ok(Steps::Pass(count));
        }
        _ => {}
    }
    let Some((from, rest)) = text.split_once("..") else {
        return numbers(text).map(Steps::Times).context(FORMS);
    };
    let (to, count) = rest
        .split_once('/')
        .with_context(|| format!("no count; {FORMS}"))?;
    let count = whole(count)
        .with_context(|| format!("\"{}\" is not a count (expected e.g. 7)", count.trim()))?;
    Ok(Steps::Times(even_steps(number(from)?, number(to)?, count)?))
}

/// A flag, and whether it is there.
pub(super) type Given = (&'static str, bool);

/// A flag that would change nothing is an error: whoever gives it expects something of it.
pub(super) fn refuse(flags: &[Given], why: &str) -> anyhow::Result<()> {
    match flags.iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) => Err(anyhow!("{flag} {why}")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_read_as_people_write_them() {
        let times = |text| match steps(text).unwrap() {
            Steps::Times(times) => times,
            Steps::Pass(_) => vec![],
        };
        assert_eq!(times("-1,0.5"), [-1.0, 0.5]);
        assert_eq!(times("-6..6/3"), [-6.0, 0.0, 6.0]);
        assert_eq!(times("2"), [2.0]);
        assert_eq!(steps("pass").unwrap(), Steps::Pass(PASSAGE));
        assert_eq!(steps("pass:3").unwrap(), Steps::Pass(3));
        for wrong in [
            "", "1..2", "1..2/0", "1..2/x", "1..2/-1", "1,,2", "pass:", "pass:x", "past",
        ] {
            assert!(steps(wrong).is_err(), "{wrong}");
        }
    }
}
