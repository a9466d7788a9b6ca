//! `photosurface render` as users run it: every flag reaches the picture, nonsense is refused, nothing half made stays.

use crate::common::command::Workplace;

/// Width and height that a PNG says, and whether it is one.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    let number = |at: usize| {
        bytes[at..at + 4]
            .iter()
            .fold(0, |n, &b| n << 8 | u32::from(b))
    };
    (number(16), number(20))
}

#[test]
fn every_built_in_scene_is_rendered_by_both_methods_and_from_outside() {
    let workplace = Workplace::new();
    for name in ["sphere", "cube", "lattice", "street", "snapshot"] {
        for how in [
            "",
            "--method mesh",
            "--view outside",
            "--full-sky",
            "--view outside --full-sky",
        ] {
            let line =
                format!("render --example {name} {how} --steps 0 --size 32x16 -o {name}.png");
            let run = workplace.run(&line).success();
            assert!(run.stdout.is_empty(), "{run}");
            let picture = workplace.read(&format!("{name}.png"));
            assert_eq!(png_size(&picture), (32, 16), "{run}");
        }
    }
}

#[test]
fn a_picture_for_each_step_or_one_for_stdout() {
    let workplace = Workplace::with_ball();
    let line = "render ball.json --size 16x9 --fov 60 --look 0,1,0 --steps 0,1,2";
    workplace.run(line).success();
    let pictures = ["0", "1", "2"].map(|k| format!("ball_observer_step00{k}.png"));
    for picture in &pictures {
        assert_eq!(png_size(&workplace.read(picture)), (16, 9));
    }
    assert_ne!(workplace.read(&pictures[0]), workplace.read(&pictures[2]));
    let run = workplace
        .run("render ball.json --size 16x9 --fov 60 --look 0,1,0 -o -")
        .success();
    assert_eq!(run.stdout, workplace.read(&pictures[0]));
    workplace
        .run(&format!("{line} -o -"))
        .error(&["3 steps", "--steps"]);
}

/// A part of several pictures, or of a film, has the names, numbers and cameras of the whole.
#[test]
fn a_part_of_the_pictures_is_that_of_the_whole() {
    let workplace = Workplace::with_ball();
    let line = "render ball.json --size 32x18 --samples 1 --steps=-2..2/5 --beta 0.6";
    for view in ["", "--view outside --axes", "--beta 0.6 --models seen,rest"] {
        let line = match view.starts_with("--beta") {
            true => line.replace("--beta 0.6", view),
            false => format!("{line} {view}"),
        };
        workplace.run(&format!("{line} -o whole.png")).success();
        let run = workplace
            .run(&format!("{line} --only 2..4 -o part.png"))
            .success();
        assert!(
            run.stderr
                .contains("part_step002.png to part_step003.png: 2 pictures"),
            "{run}"
        );
        for number in 0..5 {
            let [whole, part] = ["whole", "part"].map(|name| format!("{name}_step00{number}.png"));
            match (2..4).contains(&number) {
                true => assert_eq!(workplace.read(&part), workplace.read(&whole), "{view}"),
                false => assert!(!workplace.files().contains(&part), "{view}"),
            }
        }
        let one = workplace.run(&format!("{line} --only 3..4 -o -")).success();
        assert_eq!(one.stdout, workplace.read("whole_step003.png"));
        for number in 2..4 {
            std::fs::remove_file(workplace.path(&format!("part_step00{number}.png")))
                .expect("a file");
        }
    }
    workplace
        .run(&format!("{line} --only 2..6"))
        .error(&["--only is 2..6", "5 pictures"]);
    for wrong in ["2", "3..3", "4..2", "a..b", "-1..2", "1..2..3"] {
        workplace
            .run(&format!("{line} --only={wrong}"))
            .error(&["--only", "expected A..B"]);
    }
    workplace
        .run(&format!("{line} --only 0..2 --sheet"))
        .error(&["--only", "--sheet"]);
    let film = |flags: &str| {
        workplace
            .run(&format!("{line} --film film.png {flags}"))
            .success();
        workplace.read("film.png").len()
    };
    assert!(film("--only 1..3") < film(""));
}

#[test]
fn every_flag_of_a_picture_changes_it() {
    let workplace = Workplace::with_ball();
    let picture = |flags: &str| {
        let line = format!("render ball.json --size 32x16 {flags} -o -");
        workplace.run(&line).success().stdout
    };
    let plain = picture("");
    for flags in [
        "--fov 30",
        "--look 0,1,0.1",
        "--target 0,1,0.1",
        "--samples 1",
        "--background #ffffff",
        "--full-sky",
        "--labels",
        "--caption speed",
        "--caption gamma",
        "--caption time",
        "--caption model",
        "--view outside",
        "--method mesh --no-subdivide --beta 0.99",
    ] {
        assert_ne!(picture(flags), plain, "{flags}");
    }
    let outside = picture("--view outside");
    for flags in [
        "--from 0,0,20",
        "--target 0,3,0",
        "--look 0,0,-1",
        "--fov 50",
        "--wireframe",
        "--ghost rest",
        "--ghost contracted",
        "--axes",
        "--scale-bar",
        "--labels",
        "--caption speed,time",
        "--together --steps 0,9",
    ] {
        assert_ne!(
            picture(&format!("--view outside {flags}")),
            outside,
            "{flags}"
        );
    }
}

/// A title of the user's: in the strip above a sheet, once, whatever it is made of.
#[test]
fn captions_are_on_sheets_and_films_and_where_they_are_asked_for() {
    let workplace = Workplace::new();
    let titled = |title: &str| {
        let title = serde_json::to_string(title).unwrap();
        let objects = r#"[ { "name": "ball", "shape": { "sphere": { "radius": 1, "resolution": 8 } }, "position": [0, 3, 0] } ]"#;
        let scene = format!(
            r#"{{ "title": {title}, "steps": [0, 1], "observer": {{ "velocity": {{ "beta": 0.6 }} }},
               "objects": {objects}, "tolerance": {{ "relative": 0.1 }} }}"#
        );
        workplace.write("scene.json", scene);
    };
    let render = |flags: &str| {
        let line = format!("render scene.json --size 200x150 --samples 1 {flags} -o a.png");
        workplace.run(&line).success();
        image::load_from_memory(&workplace.read("a.png"))
            .unwrap()
            .to_rgb8()
    };
    titled("A ball");
    let bare = render("--sheet --caption none");
    assert_eq!(bare.dimensions(), (404, 304));
    let sheet = render("--sheet");
    let strip = sheet.height() - bare.height();
    assert!(sheet.width() == 404 && (15..40).contains(&strip), "{strip}");
    let part = |picture: &image::RgbImage, from: u32| {
        let rows = from..picture.height();
        rows.flat_map(|y| (0..404).map(move |x| (x, y)))
            .map(|(x, y)| picture.get_pixel(x, y).0)
            .collect::<Vec<_>>()
    };
    // Below the strip only the proper times are new: nothing is covered by the title.
    let (with, without) = (part(&sheet, strip), part(&bare, 0));
    let changed = with.iter().zip(&without).filter(|(a, b)| a != b).count();
    assert!((50..2000).contains(&changed), "{changed}");
    for title in [
        "Another ball",
        "Ä ball, γ × β …",
        "a\tb\u{1b}[31m\n",
        "漢字",
        &"long ".repeat(3000),
    ] {
        titled(title);
        let other = render("--sheet");
        assert_eq!(other.dimensions(), sheet.dimensions(), "{title}");
        assert!(part(&other, strip) == with, "{title}");
        assert!(other != sheet, "{title}");
        // On a single picture only where it is asked for.
        let plain = render("--steps 0");
        let titled = render("--steps 0 --caption title");
        assert!(plain != titled && render("--steps 0 --caption none") == plain);
    }
    for (flags, words) in [
        ("--caption none,title", vec!["--caption", "none"]),
        ("--caption loud", vec!["--caption", "gamma"]),
    ] {
        workplace
            .run(&format!("render scene.json {flags}"))
            .error(&words);
    }
    // A film tells its times.
    let film = "render scene.json --size 200x150 --samples 1 --steps 0,1 --film";
    workplace.run(&format!("{film} with.png")).success();
    workplace
        .run(&format!("{film} without.png --caption none"))
        .success();
    assert!(workplace.read("with.png") != workplace.read("without.png"));
}

#[test]
fn pictures_that_make_no_sense_are_refused_before_any_work() {
    let workplace = Workplace::with_ball();
    for (flags, words) in [
        ("--view outside --method rays", vec!["--method mesh"]),
        ("--from 1,2,3", vec!["--view outside"]),
        ("--together", vec!["--view outside"]),
        ("--axes", vec!["--axes", "--sheet"]),
        ("--ghost flat", vec!["--ghost", "contracted"]),
        ("--wireframe", vec!["--wireframe", "--method mesh"]),
        ("--sheet --view outside", vec!["cannot be used with"]),
        (
            "--sheet --columns 99 --steps 0..1/99 --size 400x9",
            vec!["--sheet", "16384"],
        ),
        ("--size 0x9", vec!["0 x 9", "16384"]),
        ("--fov 180", vec!["--fov", "180", "less than 180"]),
        ("--look 0,0,0", vec!["--look", "not zero"]),
        (
            "--target 0,0,0",
            vec!["--target is the place of the camera"],
        ),
        (
            "--view outside --from 1,2,3 --target 1,2,3",
            vec!["--target is the place of the camera"],
        ),
        ("--background red", vec!["#rrggbb"]),
        ("--lod 1e-2,1e-3", vec!["--lod"]),
        ("-o ball.jpg", vec![".png"]),
    ] {
        workplace
            .run(&format!("render ball.json {flags}"))
            .error(&words);
    }
    assert_eq!(workplace.files(), ["ball.json", "square.obj"]);
    let mesh =
        "render ball.json --size 16x9 --method mesh --no-subdivide --tolerance 1e-9 -o m.png";
    let run = workplace.run(mesh);
    assert_eq!(run.status, 1, "{run}");
    assert_eq!(png_size(&workplace.read("m.png")), (16, 9));
}

/// Columns are steps; above what `render` alone shows, below what `--view outside` does.
#[test]
fn a_sheet_shows_every_step_twice() {
    let workplace = Workplace::with_ball();
    let flags = "render ball.json --steps 0,3 --size 40x30 --caption none";
    let run = workplace.run(&format!("{flags} --sheet")).success();
    assert!(
        run.stderr.contains("above, what the observer sees"),
        "{run}"
    );
    assert!(!run.stderr.contains("blue"), "{run}");
    let colored = format!("{flags} --sheet --ghost contracted,rest --axes -o colored.png");
    let run = workplace.run(&colored).success();
    let legend =
        "blue, the shape at rest; orange, contracted by its motion; axes, x red, y green, z blue";
    assert!(run.stderr.contains(legend), "{run}");
    let sheet = workplace.read("ball_sheet.png");
    assert_eq!(png_size(&sheet), (2 * 40 + 4, 2 * 30 + 4));
    let plain = pixels(&sheet);
    for changed in [
        "--fov 90",
        "--from 5,5,30",
        "--method mesh",
        "--wireframe",
        "--ghost rest",
    ] {
        let run = workplace.run(&format!("{flags} --sheet {changed} -o -"));
        let halves = |all: &[u8]| {
            let (above, below) = all.split_at(3 * 84 * 32);
            [above.to_vec(), below.to_vec()]
        };
        let [above, below] = halves(&pixels(&run.success().stdout));
        let [plain_above, plain_below] = halves(&plain);
        let expected = match changed {
            "--fov 90" | "--ghost rest" => [true, true],
            "--method mesh" => [true, false],
            _ => [false, true],
        };
        let found = [above != plain_above, below != plain_below];
        assert_eq!(found, expected, "{changed}");
    }
}

/// How many pixels are not of the background.
fn painted(png: &[u8]) -> usize {
    let pixels = pixels(png);
    let background = [0x14, 0x17, 0x1c];
    pixels
        .chunks(3)
        .filter(|&pixel| pixel != background)
        .count()
}

/// A mesh of which nothing else is said is passed: it fills the picture, and at each speed it looks turned by another angle.
#[test]
fn a_bare_mesh_fills_the_picture() {
    let workplace = Workplace::new();
    workplace.write(
        "square.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n",
    );
    let picture = |flags: &str| {
        let line = format!("render square.obj --size 64x48 {flags} -o -");
        painted(&workplace.run(&line).success().stdout) as f64 / (64.0 * 48.0)
    };
    // As high as the picture but for the margin; as wide as a square turned by asin(beta), without the shear of what is near.
    let mut before = 1.0;
    for beta in [0.0, 0.6, 0.9, 0.99] {
        let part = picture(&format!("--beta {beta}"));
        let turned = 0.75 / 1.08 / 1.08 * f64::sqrt(1.0 - beta * beta);
        assert!(
            part > 0.8 * turned && part < 1.6 * turned + 0.05,
            "{beta}: {part} {turned}"
        );
        assert!(part < before, "{beta}: {part} {before}");
        before = part;
    }
    // The same from any direction: nothing of the square is before the camera that looks away from it.
    let run = workplace
        .run("render square.obj --beta 0.9 --look 0,0,1 --size 64x48 -o away.png")
        .success();
    assert!(run.stderr.contains("nothing is to be seen"), "{run}");
    // Several speeds have one field of view, and series of a passage hold their direction.
    let run = workplace
        .run("render square.obj --beta 0.5,0.9 --steps=pass:3 --size 64x48 -o pass.png")
        .success();
    assert!(run.stderr.contains("pass_step002.png"), "{run}");
    assert_eq!(png_size(&workplace.read("pass_step001.png")), (64, 100));
}

#[test]
fn an_empty_picture_is_noted() {
    let workplace = Workplace::with_ball();
    let line = "render ball.json --size 16x9 -o out.png";
    let run = workplace.run(line).success();
    assert!(!run.stderr.contains("note"), "{run}");
    let run = workplace.run(&format!("{line} --look 0,-1,0.1")).success();
    assert!(
        run.stderr.contains("nothing is to be seen in the picture"),
        "{run}"
    );
    let (_, advice) = run.stderr.split_once("--look=").expect("advice");
    let look = advice.split(' ').next().expect("a direction");
    let run = workplace
        .run(&format!("{line} --look={look} --fov 40"))
        .success();
    assert!(!run.stderr.contains("note"), "{run}");
    let run = workplace
        .run(&format!("{line} --look 0,-1,0.1 --steps 0,1,2"))
        .success();
    assert!(
        run.stderr
            .contains("nothing is to be seen in 3 of 3 observer's views"),
        "{run}"
    );
}

fn pixels(png: &[u8]) -> Vec<u8> {
    let picture = image::load_from_memory(png).expect("a picture");
    picture.to_rgb8().into_raw()
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_leaves_whole_pictures_or_none() {
    for signal in ["INT", "TERM"] {
        let workplace = Workplace::new();
        let steps = 4000;
        let line = format!("render --steps=-6..6/{steps} --size 96x64 -o out.png");
        let status = workplace.interrupt(&line, signal, |files| files.len() >= 3);
        assert_eq!(status, Some(130), "{signal}");
        let files = workplace.files();
        assert!(files.len() < steps, "it was done before the signal");
        for file in files {
            assert!(file.starts_with("out_step"), "{signal}: {file}");
            assert_eq!(png_size(&workplace.read(&file)), (96, 64));
            assert_eq!(pixels(&workplace.read(&file)).len(), 3 * 96 * 64);
        }
    }
}

/// A picture of many rows is interrupted while it is made.
#[cfg(unix)]
#[test]
fn an_interrupted_picture_is_not_there() {
    use std::time::{Duration, Instant};
    let workplace = Workplace::new();
    let start = Instant::now();
    let line = "render --example lattice --size 16384x16384 --samples 16 -o out.png";
    let begun = |_: &[String]| start.elapsed() > Duration::from_millis(300);
    assert_eq!(workplace.interrupt(line, "INT", begun), Some(130));
    assert!(workplace.files().is_empty(), "{:?}", workplace.files());
}

/// At the largest speeds places are from 1e-152 to 1e152 away: the sheet is made, whatever the direction.
#[test]
fn cameras_look_somewhere_at_any_speed() {
    let workplace = Workplace::with_ball();
    for rapidity in ["20", "200", "350"] {
        for direction in ["1,2,3", "0,0,-1", "-1,0,0"] {
            let line = format!(
                "render ball.json --sheet --caption none --no-subdivide --size 16x12 --samples 1 --steps=-1,0,1 \
                 --rapidity {rapidity} --direction {direction} -o sheet.png"
            );
            let run = workplace.run(&line);
            // Not certified, for nothing is refined.
            assert!(run.status == 0 || run.status == 1, "{run}");
            assert!(!run.stderr.contains("NaN"), "{run}");
            assert_eq!(png_size(&workplace.read("sheet.png")), (3 * 20 - 4, 28));
        }
    }
}
