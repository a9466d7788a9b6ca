//! Small pictures of everything that pictures can show, against ones that were looked at.
//!
//! Where one differs, expected | difference | actual stand beside each other in `target/golden/`. With
//! `PHOTOSURFACE_UPDATE_GOLDEN=1` the references are written anew, and the tests fail all the same: what is new has to
//! be looked at. Where photosurfaces are cut into other triangles, within the same tolerance, their pictures change a little.

use std::path::Path;

use crate::common::command::Workplace;
use image::RgbImage;

/// Functions such as sine are not the same to the last bit everywhere: a level may be rounded to the other
/// side of a half.
const ONE_STEP: u8 = 1;

const SHAPES: &str = r##"{ "observer": { "velocity": { "beta": 0.8, "direction": [-1, 0, 0] } }, "objects": [
  { "name": "cylinder", "shape": { "cylinder": { "radius": 1, "height": 2 } }, "color": "#ffffff", "checker": "#2471a3",
    "position": [8, 1.5, -10], "rotation": [0.38268343, 0, 0, 0.92387953] },
  { "name": "cone", "shape": { "cone": { "radius": 1, "height": 2 } }, "color": "#ffffff", "checker": "#c0392b",
    "position": [11, 1.5, -10], "rotation": [-0.38268343, 0, 0, 0.92387953] },
  { "name": "torus", "shape": { "torus": { "major_radius": 1, "minor_radius": 0.4 } }, "color": "#ffffff",
    "checker": "#229954", "position": [8, -1.5, -10], "rotation": [0.5, 0, 0, 0.8660254] },
  { "name": "rod", "shape": { "rod": { "length": 3, "radius": 0.2 } }, "color": "#ffffff", "checker": "#7d3c98",
    "position": [11, -1.5, -10], "rotation": [0.5, 0, 0, 0.8660254] } ] }"##;

/// Name and flags of every picture; all read `shapes.json` or are of a built-in scene.
const PICTURES: [(&str, &str); 8] = [
    ("sphere", "--example sphere --steps 1 --fov 40 --size 96x72"),
    (
        "mesh",
        "--example sphere --steps 1 --fov 40 --size 96x72 --method mesh --tolerance 1e-2 --wireframe",
    ),
    ("sky", "--example street --full-sky --size 128x64"),
    ("street", "--example street --look 0,0,-1 --size 96x72"),
    ("shapes", "shapes.json --fov 35 --size 128x96"),
    (
        "outside",
        "--example cube --view outside --steps 1 --ghost rest,contracted --axes --scale-bar --size 128x96",
    ),
    (
        "together",
        "--example cube --view outside --together --steps 0,2 --size 96x48 --background #ffffff",
    ),
    (
        "sheet",
        "--example cube --sheet --steps=-0.5,3 --size 64x48",
    ),
];

#[test]
fn pictures_are_those_that_were_looked_at() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let references = root.join("fixtures/golden");
    let shown = root.join("target/golden");
    let updates = std::env::var_os("PHOTOSURFACE_UPDATE_GOLDEN").is_some();
    let workplace = Workplace::new();
    workplace.write("shapes.json", SHAPES);
    let mut wrong = Vec::new();
    for (name, flags) in PICTURES {
        workplace
            .run(&format!("render {flags} -o {name}.png"))
            .success();
        let bytes = workplace.read(&format!("{name}.png"));
        let actual = image::load_from_memory(&bytes)
            .expect("a picture")
            .to_rgb8();
        let reference = references.join(format!("{name}.png"));
        if updates {
            std::fs::write(&reference, &bytes).expect("the reference can be written");
        }
        let expected = image::open(&reference)
            .unwrap_or_else(|error| panic!("{}: {error}", reference.display()))
            .to_rgb8();
        if differ(&expected, &actual) > 0 {
            std::fs::create_dir_all(&shown).expect("target can be written");
            let place = shown.join(format!("{name}.png"));
            beside_each_other(&expected, &actual)
                .save(&place)
                .expect("target can be written");
            wrong.push(place);
        }
    }
    assert!(
        wrong.is_empty(),
        "expected | difference | actual: {wrong:?}"
    );
    assert!(
        !updates,
        "the references are new: look at them, then test without the variable"
    );
}

/// How many pixels differ; all of them where the sizes do.
fn differ(expected: &RgbImage, actual: &RgbImage) -> usize {
    if expected.dimensions() != actual.dimensions() {
        return actual.pixels().count();
    }
    let pairs = expected.pixels().zip(actual.pixels());
    let differ = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > ONE_STEP)
    };
    pairs.filter(differ).count()
}

fn beside_each_other(expected: &RgbImage, actual: &RgbImage) -> RgbImage {
    let width = expected.width().max(actual.width());
    let height = expected.height().max(actual.height());
    let at = |picture: &RgbImage, x, y| picture.get_pixel_checked(x, y).map_or([0; 3], |p| p.0);
    RgbImage::from_fn(3 * width, height, |x, y| {
        let (panel, x) = (x / width, x % width);
        let (a, b) = (at(expected, x, y), at(actual, x, y));
        image::Rgb(match panel {
            0 => a,
            2 => b,
            // So bright that a difference of two steps is seen.
            _ => [0, 1, 2].map(|c| a[c].abs_diff(b[c]).saturating_mul(32)),
        })
    })
}

#[test]
fn a_difference_is_found_and_shown() {
    let expected = RgbImage::from_pixel(4, 2, image::Rgb([10, 20, 30]));
    let mut actual = expected.clone();
    actual.put_pixel(1, 1, image::Rgb([10, 21, 30]));
    assert_eq!(differ(&expected, &actual), 0);
    actual.put_pixel(3, 0, image::Rgb([10, 20, 33]));
    assert_eq!(differ(&expected, &actual), 1);
    let shown = beside_each_other(&expected, &actual);
    assert_eq!(shown.dimensions(), (12, 2));
    let at = |x, y| shown.get_pixel(x, y).0;
    assert_eq!(
        [at(3, 0), at(7, 0), at(11, 0)],
        [[10, 20, 30], [0, 0, 96], [10, 20, 33]]
    );
    assert_eq!(differ(&expected, &RgbImage::new(1, 1)), 1);
}
