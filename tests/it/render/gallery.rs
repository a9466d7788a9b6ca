//! The pictures of the README and of the lessons, and the sample page, are those that the program makes today.

use std::io::Cursor;
use std::path::Path;

use image::RgbImage;
use serde_json::Value;

use crate::common::command::Workplace;

/// Mean difference of a channel, of 255, and the part of all pixels that may differ by more than [`FAR`].
const MEAN: f64 = 1.0;
const FAR: u8 = 48;
const FAR_PART: f64 = 0.01;

#[test]
fn gallery_pictures_are_what_their_commands_draw() {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/gallery");
    let list = std::fs::read(gallery.join("pictures.json")).expect("a list");
    let list: Vec<Value> = serde_json::from_slice(&list).expect("a list in JSON");
    let workplace = Workplace::new();
    let mut stale = vec![];
    for picture in &list {
        let [file, command] = ["file", "command"].map(|key| picture[key].as_str().expect("words"));
        let output = match (command.split(' ').next(), file.ends_with(".webp")) {
            (Some("flight"), _) => "--diagram",
            (_, true) => "--film",
            _ => "-o",
        };
        workplace
            .run(&format!("{command} -q {output} {file}"))
            .success();
        let there = std::fs::read(gallery.join(file)).unwrap_or_default();
        if let Some(how) = difference(&frames(&there), &frames(&workplace.read(file))) {
            stale.push(format!("{file}: {how}"));
        }
    }
    assert!(
        stale.is_empty(),
        "not what the program draws today:\n{}\ndraw anew: python examples/gallery/draw.py target/release/photosurface",
        stale.join("\n")
    );
}

#[test]
fn the_sample_page_is_what_the_program_writes() {
    let there = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/gallery/flight.html");
    let workplace = Workplace::new();
    workplace
        .run("page --example flight -q -o flight.html")
        .success();
    assert!(
        std::fs::read(there).unwrap_or_default() == workplace.read("flight.html"),
        "flight.html is not what the program writes today\nwrite anew: python examples/gallery/draw_page.py \
         target/release/photosurface --page"
    );
}

/// All pictures of a file; none if it holds none.
fn frames(bytes: &[u8]) -> Vec<RgbImage> {
    let Ok(mut film) = image_webp::WebPDecoder::new(Cursor::new(bytes)) else {
        let picture = image::load_from_memory(bytes);
        return picture
            .map(|picture| vec![picture.into_rgb8()])
            .unwrap_or_default();
    };
    assert!(!film.has_alpha());
    let (width, height) = film.dimensions();
    let count = film.num_frames();
    let frame = |_| {
        let mut pixels = vec![0; film.output_buffer_size().expect("a size")];
        film.read_frame(&mut pixels).expect("a frame");
        RgbImage::from_raw(width, height, pixels).expect("three bytes a pixel")
    };
    (0..count).map(frame).collect()
}

/// How far two lists of pictures are from each other, if they are.
fn difference(there: &[RgbImage], drawn: &[RgbImage]) -> Option<String> {
    let sizes = |all: &[RgbImage]| all.iter().map(RgbImage::dimensions).collect::<Vec<_>>();
    if sizes(there) != sizes(drawn) {
        return Some(format!("{:?} instead of {:?}", sizes(there), sizes(drawn)));
    }
    for (number, (there, drawn)) in there.iter().zip(drawn).enumerate() {
        let channels = || there.as_raw().iter().zip(drawn.as_raw());
        let all: f64 = channels().map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
        let mean = all / there.as_raw().len() as f64;
        let far = channels().filter(|(a, b)| a.abs_diff(**b) > FAR).count();
        let far = far as f64 / there.as_raw().len() as f64;
        if mean > MEAN || far > FAR_PART {
            return Some(format!(
                "frame {number}: {mean:.2} of 255 on average, {:.2} per cent far off",
                100.0 * far
            ));
        }
    }
    None
}

#[test]
fn a_stale_picture_is_noticed() {
    let plain = [RgbImage::from_pixel(40, 30, image::Rgb([20, 23, 28]))];
    let mut other = plain.clone();
    assert_eq!(difference(&plain, &other), None);
    for x in 10..16 {
        for y in 10..16 {
            other[0].put_pixel(x, y, image::Rgb([200, 40, 40]));
        }
    }
    assert!(difference(&plain, &other).is_some());
    assert!(difference(&plain, &[RgbImage::new(40, 31)]).is_some());
    assert!(difference(&plain, &[plain.clone(), plain.clone()].concat()).is_some());
}
