//! `photosurface cost` of pictures by rays: errors against areas in closed form and against theory, and its ways out say
//! the same.

use std::f64::consts::TAU;
use std::num::{NonZeroU32, NonZeroUsize};
use std::sync::Arc;

use crate::common::command::Workplace;
use glam::{DVec2, DVec3};
use photosurface::material::Material;
use photosurface::render::{Camera, PictureSize, Projection};
use photosurface::study::RaySettings;
use photosurface::{
    CostSettings, CostStudy, Mesh, Model, Object, Observer, Part, Scene, Source, Velocity,
};
use serde_json::{Value, json};

const SIDES: [u32; 4] = [1, 2, 4, 8];

/// Linear light of the background, `#14171c`, in each channel, by the formula of IEC 61966-2-1.
fn background() -> [f64; 3] {
    [0x14, 0x17, 0x1c].map(|byte: u8| ((f64::from(byte) / 255.0 + 0.055) / 1.055).powf(2.4))
}

/// A white area that shines by itself, before an observer at the origin.
struct Area {
    /// Counter-clockwise seen from the observer; convex.
    corners: Vec<DVec3>,
    /// Along -z.
    rapidity: f64,
    width: u32,
    height: u32,
    fov_deg: f64,
    look: DVec3,
}

impl Area {
    /// Its pictures with so many rays a pixel along each side, studied.
    fn study(&self, sides: &[u32]) -> CostStudy {
        let fan = (1..self.corners.len() as u32 - 1).map(|corner| [0, corner, corner + 1]);
        let mesh = Mesh::new(self.corners.clone(), fan.collect()).expect("a fan of triangles");
        let shines = json!({ "extensions": { "KHR_materials_unlit": {} }, "doubleSided": true });
        let material = Arc::new(Material::new(shines, vec![]).expect("a material"));
        let part = Part::new("area", mesh, Some(material)).expect("normals can be had");
        let model = Model {
            parts: vec![part],
            ..Model::default()
        };
        let observer = Observer {
            velocity: Velocity::from_rapidity(self.rapidity, DVec3::NEG_Z).expect("a rapidity"),
            ..Observer::default()
        };
        let source = Source::Model(Arc::new(model.clone()));
        let scene = Scene::new(observer, vec![Object::new("area", source)]).expect("one object");
        let size = PictureSize::new(self.width, self.height).expect("a fair size");
        let projection = Projection::Perspective {
            vertical_fov_deg: self.fov_deg,
        };
        let mut rays = RaySettings::new(vec![
            Camera::new(size, projection, self.look).expect("a fair camera"),
        ]);
        let samples = sides
            .iter()
            .map(|&side| NonZeroU32::new(side).expect("rays"));
        rays.samples = samples.collect();
        let settings = CostSettings {
            tolerances: vec![],
            rays: Some(rays),
            repeats: NonZeroUsize::MIN,
            ..CostSettings::default()
        };
        CostStudy::new(&scene, &[model], &settings, &()).expect("a study")
    }

    /// Right, up and forward of the camera, and how long the middle of an edge is from the middle of the picture at
    /// distance 1.
    fn axes(&self) -> ([DVec3; 3], DVec2) {
        let forward = self.look.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let half_height = (self.fov_deg.to_radians() / 2.0).tan();
        let half_width = half_height * f64::from(self.width) / f64::from(self.height);
        let axes = [right, right.cross(forward), forward];
        (axes, DVec2::new(half_width, half_height))
    }

    /// Where on the picture, in pixels from its upper left corner, a place at rest is seen.
    fn seen(&self, rest: DVec3) -> DVec2 {
        let direction = aberrated(rest, self.rapidity);
        let ([right, up, forward], half) = self.axes();
        let depth = direction.dot(forward);
        let across = direction.dot(right) / depth / half.x;
        let upwards = direction.dot(up) / depth / half.y;
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        DVec2::new((1.0 + across) / 2.0 * width, (1.0 - upwards) / 2.0 * height)
    }

    /// Whether the area is seen at a place of the picture.
    fn holds(&self, place: DVec2) -> bool {
        let ([right, up, forward], half) = self.axes();
        let across = (2.0 * place.x / f64::from(self.width) - 1.0) * half.x;
        let upwards = (1.0 - 2.0 * place.y / f64::from(self.height)) * half.y;
        let rest = aberrated(forward + right * across + up * upwards, -self.rapidity);
        // Within the cone of all sides, which have the observer at its tip.
        let next = self.corners.iter().cycle().skip(1);
        let mut sides = self.corners.iter().zip(next);
        sides.all(|(a, b)| a.cross(*b).dot(rest) < 0.0)
    }

    /// The part of each pixel that it covers, of its outline cut into so many pieces a side.
    fn coverage(&self, pieces: usize) -> Vec<f64> {
        let next = self.corners.iter().cycle().skip(1);
        let sides = self.corners.iter().zip(next);
        let outline: Vec<DVec2> = sides
            .flat_map(|(a, b)| (0..pieces).map(|piece| a.lerp(*b, piece as f64 / pieces as f64)))
            .map(|place| self.seen(place))
            .collect();
        self.pixels()
            .map(|corner| area_in_square(&outline, corner))
            .collect()
    }

    fn pixels(&self) -> impl Iterator<Item = DVec2> {
        let row = |y| (0..self.width).map(move |x| DVec2::new(x.into(), f64::from(y)));
        (0..self.height).flat_map(row)
    }

    /// How far the middles of `side` by `side` squares are from the covered part, of each pixel.
    fn errors(&self, coverage: &[f64], side: u32) -> Vec<f64> {
        let squares = |corner: DVec2| {
            let place = move |part: u32| {
                let square = DVec2::new((part % side).into(), (part / side).into());
                corner + (square + 0.5) / f64::from(side)
            };
            let inside = (0..side * side).filter(|&part| self.holds(place(part)));
            inside.count() as f64 / f64::from(side * side)
        };
        let pixels = self.pixels().zip(coverage);
        pixels
            .map(|(corner, part)| squares(corner) - part)
            .collect()
    }
}

/// The direction in which an observer who moves along -z sees what is in the direction `rest`: half the angle's tangent
/// is divided by the exponential of the rapidity.
fn aberrated(rest: DVec3, rapidity: f64) -> DVec3 {
    let across = rest.truncate();
    let angle = across.length().atan2(-rest.z);
    let seen = 2.0 * ((angle / 2.0).tan() * (-rapidity).exp()).atan();
    let across = across.normalize_or_zero() * seen.sin();
    across.extend(-seen.cos())
}

/// The area of a polygon within the unit square at `corner`: cut by each side in turn (Sutherland, Hodgman 1974).
fn area_in_square(polygon: &[DVec2], corner: DVec2) -> f64 {
    let low = polygon.iter().copied().reduce(DVec2::min).expect("corners");
    let high = polygon.iter().copied().reduce(DVec2::max).expect("corners");
    if (low - corner).max_element() >= 1.0 || (high - corner).min_element() <= 0.0 {
        return 0.0;
    }
    let mut kept: Vec<DVec2> = polygon.iter().map(|&place| place - corner).collect();
    let sides: [fn(DVec2) -> f64; 4] = [|p| p.x, |p| 1.0 - p.x, |p| p.y, |p| 1.0 - p.y];
    for inside in sides {
        let mut cut = Vec::new();
        for (index, &end) in kept.iter().enumerate() {
            let start = kept[(index + kept.len() - 1) % kept.len()];
            let (from, to) = (inside(start), inside(end));
            if (from < 0.0) != (to < 0.0) {
                cut.push(start.lerp(end, from / (from - to)));
            }
            if to >= 0.0 {
                cut.push(end);
            }
        }
        kept = cut;
    }
    let next = kept.iter().cycle().skip(1);
    let twice: f64 = kept.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    twice.abs() / 2.0
}

/// A square of side 2 `distance` ahead, turned out of everything's axes.
fn turned_square(distance: f64) -> Vec<DVec3> {
    let turn = glam::DQuat::from_euler(glam::EulerRot::ZXY, 0.37, 0.5, -0.4);
    let middle = DVec3::new(0.13, -0.21, -distance);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| middle + turn * DVec3::new(x, y, 0.0))
        .to_vec()
}

/// Against the exact error, that of a still observer and of one at 0.8 c, who sees the sides bent.
///
/// # Where the limits come from
///
/// Five standard deviations for what the references are off, as the study tells, and what an `f32` rounds, `6e-8`. Sides bent by less than `20 pixels` are cut into 400 pieces: they are `20 / 400^2 / 8`
/// of a pixel off. In one pixel the references, of 16 x 16 random places each, are wrong only in squares that
/// the outline crosses, 33 by one side, 66 at a corner, each by a half at most in the standard deviation: of the mean of two
/// that is `sqrt(66 / 2) / 2 / 256 = 0.0112`.
#[test]
fn errors_are_those_against_exact_areas() {
    for (rapidity, distance) in [(0.0, 4.0), (0.8f64.atanh(), 1.5)] {
        let area = Area {
            corners: turned_square(distance),
            rapidity,
            width: 48,
            height: 36,
            fov_deg: 45.0,
            look: DVec3::new(0.05, 0.02, -1.0),
        };
        let study = area.study(&[4, 1, 8, 2]);
        let coverage = area.coverage(400);
        let white: f64 = coverage.iter().sum();
        assert!((100.0..1500.0).contains(&white), "{white}");
        let contrasts = background().map(|dark| 1.0 - dark);
        let contrast = (contrasts.iter().map(|c| c * c).sum::<f64>() / 3.0).sqrt();
        let rounding = 6e-8 + 20.0 / 400.0f64.powi(2) / 8.0;
        assert_eq!(study.rays.len(), SIDES.len());
        for (cost, side) in study.rays.iter().zip(SIDES) {
            assert_eq!(cost.samples, side);
            let errors = area.errors(&coverage, side);
            let squares: f64 = errors.iter().map(|error| error * error).sum();
            let expected = contrast * (squares / errors.len() as f64).sqrt();
            let limit = 5.0 * cost.error_uncertainty + rounding;
            assert!(limit < 0.5 * expected, "{side}: {limit} {expected}");
            assert!(
                (cost.error - expected).abs() < limit,
                "{rapidity} {side}: {} against {expected} +- {limit}",
                cost.error
            );
            let largest = errors.iter().fold(0.0f64, |l, error| l.max(error.abs()));
            let largest = largest * contrasts.into_iter().fold(0.0, f64::max);
            assert!(
                (cost.largest_error - largest).abs() < 5.0 * 0.0112 + rounding,
                "{rapidity} {side}: {} against {largest}",
                cost.largest_error
            );
        }
    }
}

/// A disc, cut out by 96 straight sides, has edges of all slopes alike: the mean square of the error is `length n^-3 / 12` for each column that is
/// crossed (or row, where these are more), and there are `max(|cos|, |sin|)` to a length, 0.900 in the mean.
///
/// # Where the limits come from
///
/// The picture has about 450 pixels on the outline, whose squares of errors vary by less than three times their mean: `3 /
/// sqrt(450) = 0.14`, of two standard deviations each way 0.28. The slope, over a factor of 16 in rays, has half the
/// spread of two logarithms: `sqrt(2) * 0.07 / ln 16 = 0.036`, of two standard deviations 0.07.
#[test]
fn edges_of_all_directions_follow_theory() {
    let corner = |k: u32| TAU * f64::from(k) / 96.0;
    let middle = DVec3::new(0.011, 0.017, -4.0);
    let place = |angle: f64| middle + DVec3::new(angle.cos(), angle.sin(), 0.0);
    let area = Area {
        corners: (0..96).map(corner).map(place).collect(),
        rapidity: 0.0,
        width: 160,
        height: 160,
        fov_deg: 32.0,
        look: DVec3::NEG_Z,
    };
    let study = area.study(&[1, 2, 4]);
    // Of a circle on a plane that is at right angles to the look.
    let radius = 1.0 / 4.0 / 16.0f64.to_radians().tan() * 80.0;
    let length = TAU * radius;
    let contrast = background().map(|dark| (1.0 - dark).powi(2));
    let contrast = contrast.iter().sum::<f64>() / 3.0;
    for cost in &study.rays {
        let square = 0.900 * length * f64::from(cost.samples).powi(-3) / 12.0;
        let theory = contrast * square / 160.0 / 160.0;
        let ratio = cost.error.powi(2) / theory;
        assert!((0.72..1.28).contains(&ratio), "{}: {ratio}", cost.samples);
        assert!(cost.error > 20.0 * cost.error_uncertainty, "{cost:?}");
    }
    let [first, .., last] = study.rays.as_slice() else {
        panic!("{study:?}");
    };
    let slope = (last.error / first.error).ln() / 16f64.ln();
    assert!((slope + 0.75).abs() < 0.07, "{slope}");
    let pictures = study.pictures.unwrap();
    assert!(pictures.reference_error < last.error, "{pictures:?}");
}

fn number(row: &Value, name: &str) -> f64 {
    row[name]
        .as_f64()
        .unwrap_or_else(|| panic!("{name} in {row:#}"))
}

#[test]
fn table_csv_and_json_say_the_same() {
    let workplace = Workplace::new();
    let flags = "--example sphere --steps=-2,0,1.5 --size 64x48 --repeats 2 --tolerances 1e-2 --samples 100";
    let run = workplace.run(&format!("cost {flags} --json a.json --csv a.csv"));
    let run = run.success();
    assert_eq!(workplace.files(), ["a.csv", "a.json", "a_rays.csv"]);
    let study = workplace.read_json("a.json");
    let pictures = &study["pictures"];
    assert_eq!(
        ["count", "width", "height", "reference_samples_per_pixel"]
            .map(|name| number(pictures, name)),
        [3.0, 64.0, 48.0, 512.0]
    );
    let csv = String::from_utf8(workplace.read("a_rays.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let table = run.stdout_text().split_once("\n\n").expect("two tables").1;
    let shown: Vec<&str> = table.lines().collect();
    let rows = study["rays"].as_array().unwrap();
    assert_eq!((rows.len(), lines.len(), shown.len()), (4, 5, 6), "{run}");
    for ((row, side), (line, shown)) in rows
        .iter()
        .zip(SIDES)
        .zip(lines[1..].iter().zip(&shown[1..]))
    {
        let side = f64::from(side);
        assert_eq!(number(row, "samples"), side);
        assert_eq!(number(row, "samples_per_pixel"), side * side);
        assert_eq!(number(row, "rays"), 3.0 * 64.0 * 48.0 * side * side);
        let rate = number(row, "rays") / number(row, "seconds");
        assert!((number(row, "rays_per_second") / rate - 1.0).abs() < 1e-12);
        assert!(
            number(row, "error") > number(pictures, "reference_error"),
            "{study:#}"
        );
        assert!(
            number(row, "error") > 5.0 * number(row, "error_uncertainty"),
            "{row:#}"
        );
        assert!(
            number(row, "largest_error") > number(row, "error"),
            "{row:#}"
        );
        for (name, cell) in lines[0].iter().zip(line) {
            assert_eq!(cell.parse().ok(), row[name].as_f64(), "{name}");
        }
        let words: Vec<String> = shown
            .split_whitespace()
            .map(|word| word.replace(',', ""))
            .collect();
        assert_eq!(words[1].parse().ok(), row["rays"].as_f64(), "{run}");
        assert_eq!(words[2], format!("{:.2e}", number(row, "error")), "{run}");
        assert_eq!(
            words[4],
            format!("{:.2e}", number(row, "largest_error")),
            "{run}"
        );
    }
    for pair in rows.windows(2) {
        assert!(
            number(&pair[1], "error") < number(&pair[0], "error"),
            "{study:#}"
        );
    }
}

#[test]
fn each_half_can_be_had_alone() {
    let workplace = Workplace::new();
    let flags = "cost --example cube --size 32x18 --pixel-samples 2,1 --repeats 1";
    let run = workplace
        .run(&format!("{flags} --only rays --csv - --plot a.svg"))
        .success();
    assert!(
        run.stdout_text()
            .starts_with("samples,samples_per_pixel,rays,"),
        "{run}"
    );
    assert_eq!(run.stdout_text().lines().count(), 3);
    let svg = String::from_utf8(workplace.read("a.svg")).unwrap();
    assert!(
        svg.starts_with("<svg width=\"960\" height=\"480\""),
        "{svg}"
    );
    assert!(
        svg.contains("picture error") && !svg.contains("triangles"),
        "{svg}"
    );
    let run = workplace
        .run(&format!("{flags} --only rays --json -"))
        .success();
    let study: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert!(
        study["unit"].is_null() && study["meshes"] == json!([]),
        "{study:#}"
    );
    let run = workplace
        .run("cost --example cube --only meshes --tolerances 1e-1 --json -")
        .success();
    let study: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert!(
        study["pictures"].is_null() && study["rays"] == json!([]),
        "{study:#}"
    );
}

/// Seen larger, the same ball has a longer outline.
#[test]
fn the_field_of_view_is_that_of_the_pictures() {
    let workplace = Workplace::new();
    let error = |fov: &str| {
        let flags = "cost --only rays --example sphere --steps 0 --size 32x24 --pixel-samples 2 --repeats 1";
        let run = workplace.run(&format!("{flags} --fov {fov} --json -"));
        let study: Value = serde_json::from_slice(&run.success().stdout).unwrap();
        number(&study["rays"][0], "error")
    };
    assert!(error("20") > 1.5 * error("60"));
}

/// Where nothing is seen nothing is wrong, and there is nothing to plot.
#[test]
fn an_empty_picture_is_without_error() {
    let workplace = Workplace::new();
    let flags = "cost --only rays --look 0,0,1 --beta 0 --steps 0 --size 8x8 --repeats 1";
    let run = workplace.run(&format!("{flags} --json -")).success();
    let study: Value = serde_json::from_slice(&run.stdout).unwrap();
    for row in study["rays"].as_array().unwrap() {
        assert_eq!(
            number(row, "error") + number(row, "largest_error"),
            0.0,
            "{row:#}"
        );
    }
    // Which the table still tells.
    let run = workplace.run(&format!("{flags} --plot a.png"));
    assert_eq!(run.status, 2, "{run}");
    assert!(
        run.stderr.contains("--plot: there is nothing to plot"),
        "{run}"
    );
    assert!(run.stdout_text().contains("0.00e0"), "{run}");
}
