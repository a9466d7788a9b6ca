//! Films, read back by other decoders than those that made them: frames, times, how often they are shown; memory.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use photosurface::DVec2;
use photosurface::render::{Picture, PictureSize, Strokes};
use photosurface::shape::Color;
use photosurface::write::{FilmError, FilmFormat, FilmSettings, FilmWriter, FrameRate};

/// What a reader finds in a film.
struct Read {
    /// Red, green and blue of each frame.
    frames: Vec<Vec<u8>>,
    /// Length of the film in seconds.
    seconds: f64,
    loops: bool,
}

fn read_gif(path: &Path) -> Read {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(File::open(path).unwrap()).unwrap();
    let (mut frames, mut hundredths) = (vec![], 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((frame.left, frame.top), (0, 0));
        hundredths += u32::from(frame.delay);
        let (pixels, _) = frame.buffer.as_chunks::<4>();
        frames.push(
            pixels
                .iter()
                .flat_map(|pixel| pixel[..3].to_vec())
                .collect(),
        );
    }
    Read {
        frames,
        seconds: f64::from(hundredths) / 100.0,
        loops: decoder.repeat() == gif::Repeat::Infinite,
    }
}

fn read_apng(path: &Path) -> Read {
    let file = BufReader::new(File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let control = *reader.info().animation_control().expect("an animation");
    let (mut frames, mut seconds) = (vec![], 0.0);
    for _ in 0..control.num_frames {
        let mut frame = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut frame).unwrap();
        let control = reader.info().frame_control().expect("a frame");
        seconds += f64::from(control.delay_num) / f64::from(control.delay_den);
        frames.push(frame);
    }
    Read {
        frames,
        seconds,
        loops: control.num_plays == 0,
    }
}

fn read_webp(path: &Path) -> Read {
    let file = BufReader::new(File::open(path).unwrap());
    let mut decoder = image_webp::WebPDecoder::new(file).unwrap();
    assert!(decoder.is_animated() && !decoder.has_alpha());
    let (mut frames, mut milliseconds) = (vec![], 0);
    for _ in 0..decoder.num_frames() {
        let mut frame = vec![0; decoder.output_buffer_size().unwrap()];
        milliseconds += decoder.read_frame(&mut frame).unwrap();
        frames.push(frame);
    }
    let length = fs::metadata(path).unwrap().len();
    let said = fs::read(path).unwrap()[4..8].try_into().unwrap();
    assert_eq!(u64::from(u32::from_le_bytes(said)), length - 8);
    Read {
        frames,
        seconds: f64::from(milliseconds) / 1000.0,
        loops: decoder.loop_count() == image_webp::LoopCount::Forever,
    }
}

fn read(format: FilmFormat, path: &Path) -> Read {
    match format {
        FilmFormat::Gif => read_gif(path),
        FilmFormat::Apng => read_apng(path),
        _ => read_webp(path),
    }
}

/// Frames with strokes of many colours, another one each time.
fn pictures(count: usize, size: PictureSize) -> Vec<Picture> {
    let picture = |number: usize| {
        let mut picture = Picture::filled(size, Color([0x14, 0x17, 0x1c]));
        for stroke in 0..40_u8 {
            let place = DVec2::new(f64::from(stroke), 3.0 * number as f64);
            picture.draw(&Strokes {
                lines: vec![[place, place + DVec2::new(9.0, 25.0)]],
                color: Color([6 * stroke, 255 - 5 * stroke, 9 * number as u8]),
                width_px: 2.5,
            });
        }
        picture
    };
    (0..count).map(picture).collect()
}

fn settings(format: FilmFormat, size: PictureSize, frames: usize, rate: f64) -> FilmSettings {
    FilmSettings {
        format,
        size,
        frames,
        rate: FrameRate::new(rate).unwrap(),
        loops: true,
    }
}

const FORMATS: [FilmFormat; 3] = [FilmFormat::Gif, FilmFormat::Apng, FilmFormat::WebP];

#[test]
fn a_film_read_back_has_the_frames_and_their_times() {
    let folder = tempfile::tempdir().unwrap();
    for format in FORMATS {
        for (width, height, count, rate, loops) in [
            (61, 37, 7, 12.0, true),
            (64, 36, 3, 29.97, false),
            (1, 1, 1, 1.0, true),
            (33, 2, 20, 48.0, false),
        ] {
            let size = PictureSize::new(width, height).unwrap();
            let pictures = pictures(count, size);
            let path = folder.path().join("a film");
            let settings = FilmSettings {
                loops,
                ..settings(format, size, count, rate)
            };
            let mut film = FilmWriter::create(&path, settings).unwrap();
            for picture in &pictures {
                film.frame(picture).unwrap();
            }
            film.finish().unwrap();
            let read = read(format, &path);
            assert_eq!(read.frames.len(), count, "{format}");
            assert_eq!(read.loops, loops, "{format}");
            // Half a hundredth of a GIF.
            assert!((read.seconds - count as f64 / rate).abs() <= 0.005 + 1e-9);
            for (frame, picture) in read.frames.iter().zip(&pictures) {
                let off = frame.iter().zip(picture.bytes());
                let off: Vec<u32> = off.map(|(a, b)| u32::from(a.abs_diff(*b))).collect();
                let most = *off.iter().max().unwrap();
                match format {
                    FilmFormat::Gif => {
                        let mean = f64::from(off.iter().sum::<u32>()) / off.len() as f64;
                        assert!(most <= 24 && mean < 2.0, "{most} {mean}");
                    }
                    _ => assert_eq!(most, 0, "{format}"),
                }
            }
        }
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_film_that_is_not_finished_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film");
    let size = PictureSize::new(8, 6).unwrap();
    let frame = Picture::filled(size, Color([9; 3]));
    let wide = Picture::filled(PictureSize::new(9, 6).unwrap(), Color([9; 3]));
    fs::write(&path, "what was there").unwrap();
    for format in FORMATS {
        let begin = || FilmWriter::create(&path, settings(format, size, 2, 25.0)).unwrap();
        let mut film = begin();
        film.frame(&frame).unwrap();
        let too_few = film.finish().unwrap_err();
        assert!(matches!(
            too_few,
            FilmError::FrameCount {
                found: 1,
                expected: 2
            }
        ));
        let mut film = begin();
        let wrong = film.frame(&wide).unwrap_err().to_string();
        assert!(
            wrong.contains("[9, 6]") && wrong.contains("[8, 6]"),
            "{wrong}"
        );
        for _ in 0..2 {
            film.frame(&frame).unwrap();
        }
        assert!(matches!(
            film.frame(&frame),
            Err(FilmError::FrameCount { found: 3, .. })
        ));
        drop(film);
        assert_eq!(fs::read(&path).unwrap(), b"what was there");
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            1,
            "nothing is left"
        );
    }
    let mut bytes = vec![];
    let webp = settings(FilmFormat::WebP, size, 2, 25.0);
    let refused = FilmWriter::stream(&mut bytes, webp)
        .err()
        .expect("a WebP is no stream");
    assert!(matches!(refused, FilmError::NeedsFile(FilmFormat::WebP)));
}

/// 1000 frames of noise are 43 MB, as files too.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_number_of_frames() {
    use crate::common::Random;
    use crate::common::alone::{alone, peak_memory};
    alone(
        "render::films::memory_does_not_grow_with_the_number_of_frames",
        || {
            let folder = tempfile::tempdir().unwrap();
            let size = PictureSize::new(160, 90).unwrap();
            let mut random = Random::new(3);
            let mut noise = || {
                let mut picture = Picture::filled(size, Color([0; 3]));
                let one = PictureSize::new(1, 1).unwrap();
                for (x, y) in (0..160).flat_map(|x| (0..90).map(move |y| (x, y))) {
                    let level = [0; 3].map(|_: u8| random.between(0.0, 256.0) as u8);
                    picture.paste(&Picture::filled(one, Color(level)), x, y);
                }
                picture
            };
            let pictures = [noise(), noise(), noise()];
            for format in FORMATS {
                let path = folder.path().join("film");
                let frames = |count: usize| {
                    let settings = settings(format, size, count, 25.0);
                    let mut film = FilmWriter::create(&path, settings).unwrap();
                    for number in 0..count {
                        film.frame(&pictures[number % 3]).unwrap();
                    }
                    film.finish().unwrap();
                };
                frames(10);
                let before = peak_memory();
                frames(1000);
                let more = peak_memory() - before;
                assert!(more < 4_000_000, "{format}: {more} bytes");
                assert!(fs::metadata(&path).unwrap().len() > 10_000_000);
            }
        },
    );
}
