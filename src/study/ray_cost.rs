//! Pictures by rays of light: rays, time and error for one number of rays per pixel after the other.

use std::num::NonZeroU32;
use std::time::Instant;

use glam::{DVec2, Vec3};
use serde::Serialize;

use super::median::median;
use super::random::Random;
use crate::jobs::{Cancelled, Progress};
use crate::pipeline::PlacedScene;
use crate::render::{Camera, PictureOptions, Scenery, Textures, Viewpoint, grid_places};

/// A reference has so many times the places of the finest picture along each side of a pixel: by theory, a mean of two is
/// then off by about a third of what this picture is. What is left of that is taken off too; with fewer places
/// more of the error would be uncertain, with more they would take longer than all that is studied.
const REFERENCE_FINER: u32 = 2;

/// Which pictures by rays are studied.
#[derive(Clone, Debug)]
pub struct RaySettings {
    /// What the observer looks through at each step of the scene.
    pub cameras: Vec<Camera>,
    /// Rays per pixel along each side, as [`PictureOptions::samples`], none twice, in any order.
    pub samples: Vec<NonZeroU32>,
    /// The textures of the pictures; they say afterwards which of them pictures go without.
    pub textures: Textures,
}

impl RaySettings {
    /// From one ray to 64 per pixel.
    pub fn new(cameras: Vec<Camera>) -> Self {
        let samples = [1, 2, 4, 8].into_iter().filter_map(NonZeroU32::new);
        Self {
            cameras,
            samples: samples.collect(),
            textures: Textures::default(),
        }
    }

    /// How many pictures are made: those of both references, and those of each number of rays so many times.
    pub(super) fn pieces(&self, repeats: usize) -> usize {
        match self.samples.len() {
            0 => 0,
            numbers => self.cameras.len() * (REFERENCES.len() + numbers * repeats),
        }
    }
}

/// Two, with random places of their own.
const REFERENCES: [usize; 2] = [0, 1];

/// The pictures of a study, and how well it is known what they should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pictures {
    /// One for each step.
    pub count: usize,
    /// Of each, in pixels.
    pub width: u32,
    /// Of each, in pixels.
    pub height: u32,
    /// Places in each pixel at which the references were looked at, all random.
    pub reference_samples_per_pixel: u64,
    /// The standard error of the mean of the references, a root mean square over all pixels and channels as
    /// [`RayCost::error`].
    pub reference_error: f64,
}

/// What one number of rays per pixel costs, the pictures of all steps together.
///
/// Errors are of linear light, before it is rounded to bytes: 1 is what a channel of white has.
///
/// # Theory
///
/// Within a surface light changes smoothly, and the middles of `n` by `n` squares miss `1/n^2` of it. Edges cost
/// more. Each of the `n` columns of squares that an edge crosses is wrong by up to half a square, `1/(2 n^2)` of the
/// pixel. From column to column that changes with the slope of the edge; it adds up only for slopes within `1/n` of a
/// simple ratio, and in the mean over all slopes the squares add as if they were random: `n (1/n^2)^2 / 12`. With `N = n^2`
/// rays per pixel
///
/// ```text
/// error ~ N^(-3/4)        rays ~ error^(-4/3)
/// ```
///
/// One random place in each of the squares would give the same power (Mitchell 1996), and so does a lattice over whole
/// outlines (Kendall 1948). An edge along rows or columns is wrong alike in all of them, `N^(-1/2)`, which is what places
/// give that are all random. The rim of a field of a checker is as wide as a pixel of its texture: a slope, for which `1/N`
/// holds as soon as rays are closer together.
///
/// # Accuracy
///
/// What a picture should be is found by looking at random places, one in each square of a grid in each pixel, finer
/// than any that is studied: their mean is right whatever the picture, and has nothing in common with a lattice. There
/// are two such references, independent of each other. A product of the picture's differences from both is, in the
/// mean, the square of its error, without that of a reference; and what the two differ by tells how well it is known
/// (`tests/it/cost/rays.rs`, against areas in closed form).
///
/// # Reference
///
/// D. G. Kendall, *On the number of lattice points inside a random oval*, Quart. J. Math. 19 (1948), 1;
/// D. P. Mitchell, *Consequences of stratified sampling in graphics*, SIGGRAPH 1996.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RayCost {
    /// Rays per pixel along each side, as they are asked for.
    pub samples: u32,
    /// The square of it.
    pub samples_per_pixel: u64,
    /// Of all pictures.
    pub rays: u64,
    /// How long they took, by the wall clock: the median of all repeats.
    pub seconds: f64,
    /// `rays / seconds`
    pub rays_per_second: f64,
    /// Measured: a root mean square over all pixels and channels, without what references are off; 0 if that is more.
    pub error: f64,
    /// One standard deviation of `error`, at most about.
    pub error_uncertainty: f64,
    /// Measured: the largest difference from the mean of the references in any channel of any pixel.
    pub largest_error: f64,
}

/// Pictures of all steps, one after the other, as the linear light of their pixels.
type Light = Vec<Vec3>;

/// Studies each of `samples`, the fewest first and at least one, with one camera for each step; `progress`
/// advances by one after each picture.
pub(super) fn ray_costs(
    placed: &PlacedScene,
    settings: &RaySettings,
    samples: &[u32],
    repeats: usize,
    progress: &dyn Progress,
) -> Result<(Pictures, Vec<RayCost>), Cancelled> {
    let cameras = &settings.cameras[..];
    let steps = placed.scene().steps().len();
    let size = cameras[0].size();
    let finest = samples[samples.len() - 1];
    let mut scenery = Scenery::with_textures(&settings.textures);
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part);
        }
    }
    let studio = Studio {
        placed,
        cameras,
        scenery,
        progress,
    };
    let finer = finest.saturating_mul(REFERENCE_FINER);
    let [first, second] = REFERENCES;
    let references = [
        studio.reference(finer, first)?,
        studio.reference(finer, second)?,
    ];
    let pictures = Pictures {
        count: steps,
        width: size.width(),
        height: size.height(),
        reference_samples_per_pixel: 2 * u64::from(finer).pow(2),
        reference_error: reference_error(&references),
    };
    let costs = samples.iter().map(|&samples| {
        let mut times = Vec::with_capacity(repeats);
        let mut light = Light::new();
        for _ in 0..repeats {
            let start = Instant::now();
            light = studio.all(|_, _| grid_places(samples))?;
            times.push(start.elapsed().as_secs_f64());
        }
        let samples_per_pixel = u64::from(samples).pow(2);
        let rays = light.len() as u64 * samples_per_pixel;
        let seconds = median(times);
        let Errors {
            mean,
            uncertainty,
            largest,
        } = Errors::new(&light, &references);
        Ok(RayCost {
            samples,
            samples_per_pixel,
            rays,
            seconds,
            rays_per_second: rays as f64 / seconds,
            error: mean,
            error_uncertainty: uncertainty,
            largest_error: largest,
        })
    });
    let costs = costs.collect::<Result<_, _>>()?;
    Ok((pictures, costs))
}

/// Everything at rest, and who looks at it.
struct Studio<'a> {
    placed: &'a PlacedScene,
    cameras: &'a [Camera],
    scenery: Scenery,
    progress: &'a dyn Progress,
}

impl Studio<'_> {
    /// The mean over `places` of a step and a pixel.
    fn all<P: Iterator<Item = DVec2>>(
        &self,
        places: impl Fn(usize, usize) -> P + Sync,
    ) -> Result<Light, Cancelled> {
        let scene = self.placed.scene();
        let mut light = Light::new();
        for (step, camera) in (0..scene.steps().len()).zip(self.cameras) {
            let moment = scene.moment(step).expect("a step of the scene");
            let viewpoint = Viewpoint::Observer(&moment);
            let options = PictureOptions::default();
            let places = |pixel| places(step, pixel);
            light.extend(self.scenery.light(camera, viewpoint, options, places));
            self.progress.advance(1)?;
        }
        Ok(light)
    }

    /// A random place in each of `finer` by `finer` squares of a pixel, others for each `number`.
    fn reference(&self, finer: u32, number: usize) -> Result<Light, Cancelled> {
        self.all(|step, pixel| {
            // A picture has fewer than 2^32 pixels: no two seeds are the same.
            let mut random = Random::new((((2 * step + number) as u64) << 32) + pixel as u64);
            grid_places(finer).map(move |middle| {
                let within = DVec2::new(random.fraction(), random.fraction()) - 0.5;
                middle + within / f64::from(finer)
            })
        })
    }
}

/// The mean over red, green and blue of a product.
fn mean_product(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().dot(b.as_dvec3()) / 3.0
}

/// The variance of one reference at a pixel, by its distance from the other.
fn variance([first, second]: [Vec3; 2]) -> f64 {
    mean_product(first - second, first - second) / 2.0
}

/// The same pixel in both references.
fn pairs([first, second]: &[Light; 2]) -> impl Iterator<Item = [Vec3; 2]> {
    first.iter().zip(second).map(|(&a, &b)| [a, b])
}

fn reference_error(references: &[Light; 2]) -> f64 {
    let sum: f64 = pairs(references).map(variance).sum();
    // Of the mean of two the variance is half.
    (sum / 2.0 / references[0].len() as f64).sqrt()
}

/// What a picture is off.
struct Errors {
    mean: f64,
    uncertainty: f64,
    largest: f64,
}

impl Errors {
    /// With independent errors `a` and `b` of the references, of variance `v` each, and `e` of the picture, the
    /// product `(e + a)(e + b)` has the mean `e^2` and the variance `2 e^2 v + v^2`; summed over channels at most that of
    /// their sums.
    fn new(light: &Light, references: &[Light; 2]) -> Self {
        let (mut sum, mut spread, mut largest) = (0.0, 0.0, 0.0_f64);
        for (&light, pair) in light.iter().zip(pairs(references)) {
            let square = mean_product(light - pair[0], light - pair[1]);
            let variance = variance(pair);
            sum += square;
            spread += (2.0 * square.max(0.0) + variance) * variance;
            let off = (light - (pair[0] + pair[1]) / 2.0).abs().max_element();
            largest = largest.max(off.into());
        }
        let pixels = light.len() as f64;
        let square = (sum / pixels).max(0.0);
        let mean = square.sqrt();
        Self {
            mean,
            uncertainty: (square + spread.sqrt() / pixels).sqrt() - mean,
            largest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pictures of noise of a known size: what is told is what it is, not what the references add.
    #[test]
    fn the_error_of_references_is_not_taken_for_that_of_the_picture() {
        const PIXELS: usize = 40_000;
        let mut random = Random::new(1);
        // Even between -1 and 1 in all channels alike: of variance 1/3.
        let mut noise = |size: f64| -> Light {
            let value = |_| Vec3::splat((size * (2.0 * random.fraction() - 1.0)) as f32);
            (0..PIXELS).map(value).collect()
        };
        let references = [noise(0.3), noise(0.3)];
        let (picture, none) = (noise(0.1), noise(0.0));
        let third = 1.0_f64 / 3.0;
        // Each a mean of 40,000 independent squares, which vary by less than twice their mean: to 1 % and five times less
        // than the limit.
        let of_mean = reference_error(&references);
        assert!((of_mean / (0.3 * (third / 2.0).sqrt()) - 1.0).abs() < 0.03);
        let errors = Errors::new(&picture, &references);
        let expected = 0.1 * third.sqrt();
        assert!((errors.mean - expected).abs() < 5.0 * errors.uncertainty);
        // sqrt(2 e^2 v + v^2) / sqrt(pixels) / (2 e), where the mean of the square of the estimated v is more than v^2:
        // 2.4 of it for a triangle's distribution.
        let (e, v) = (expected * expected, 0.09 * third);
        let least = (2.0 * e * v + v * v).sqrt() / 200.0 / (2.0 * expected);
        assert!(errors.uncertainty > 0.9 * least && errors.uncertainty < 2.0 * least);
        assert!((0.1..=0.4).contains(&errors.largest));
        let nothing = Errors::new(&none, &references);
        assert!(nothing.mean < 5.0 * nothing.uncertainty);
        let still = [none.clone(), none.clone()];
        let exact = Errors::new(&none, &still);
        assert_eq!(
            (exact.mean, exact.uncertainty, exact.largest),
            (0.0, 0.0, 0.0)
        );
    }
}
