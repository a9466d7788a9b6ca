//! Pictures that the library draws with one call: the bytes are those of the command, and whoever calls may stop the work.

use photosurface::jobs::{
    Aim, FieldOfView, FramingError, PictureProjection, RenderError, Rendered,
};
use photosurface::render::{Picture, PictureSize};
use photosurface::spacetime::ViewModel;
use photosurface::{
    DVec3, PictureMethod, PictureSettings, PictureView, PlacedScene, Progress, Scene, Textures,
    load_models, render, render_to_files,
};

use crate::common::command::{BALL, Workplace};
use crate::common::progress::Pieces;

const STEPS: [f64; 2] = [0.0, 3.0];

/// Flags that are in every command here.
const FLAGS: &str = "render ball.json --steps 0,3";

const OUTSIDE: PictureView = PictureView::Outside {
    from: None,
    together: false,
};

const TOGETHER: PictureView = PictureView::Outside {
    from: Some(DVec3::new(2.0, 3.0, 20.0)),
    together: true,
};

const SHEET: PictureView = PictureView::Sheet {
    method: PictureMethod::Rays,
    from: None,
};

const SHEET_OF_MESHES: PictureView = PictureView::Sheet {
    method: PictureMethod::Mesh,
    from: None,
};

/// Each view with the flags of the command that mean the same, and how many rows it has at the steps above.
const VIEWS: [(PictureView, &str, usize); 6] = [
    (PictureView::Observer(PictureMethod::Rays), "", 60),
    (
        PictureView::Observer(PictureMethod::Mesh),
        "--method mesh",
        60,
    ),
    (OUTSIDE, "--view outside", 60),
    (TOGETHER, "--view outside --together --from 2,3,20", 30),
    (SHEET, "--sheet", 120),
    (SHEET_OF_MESHES, "--sheet --method mesh", 120),
];

fn ball() -> PlacedScene {
    let scene = Scene::from_json(BALL).unwrap();
    let scene = scene.with_steps(STEPS.to_vec()).unwrap();
    let (models, _) = load_models(&scene, ".".as_ref()).unwrap();
    PlacedScene::new(scene, models).unwrap()
}

fn settings(view: PictureView) -> PictureSettings {
    let mut settings = PictureSettings::new(view);
    settings.camera.size = PictureSize::new(40, 30).unwrap();
    settings
}

/// All pictures, in order, and what is said of them.
fn drawn(
    settings: &PictureSettings,
    progress: &dyn Progress,
) -> Result<(Vec<Picture>, Rendered), RenderError> {
    let mut pictures = vec![];
    let textures = Textures::default();
    let rendered = render(&ball(), &textures, settings, progress, |number, picture| {
        assert_eq!(number, pictures.len());
        pictures.push(picture.clone());
        Ok::<(), RenderError>(())
    })?;
    Ok((pictures, rendered))
}

#[test]
fn one_call_writes_the_files_of_the_command() {
    let workplace = Workplace::with_ball();
    for (view, flags, _) in VIEWS {
        workplace
            .run(&format!("{FLAGS} --size 40x30 {flags} -o command.png"))
            .success();
        let (settings, textures) = (settings(view), Textures::default());
        let path = workplace.path("library.png");
        render_to_files(&ball(), &textures, &settings, &path, &()).unwrap();
        let files = settings.files(&path, STEPS.len());
        let count = if flags.contains("sheet") || flags.contains("together") {
            1
        } else {
            STEPS.len()
        };
        assert_eq!(files.len(), count, "{flags}");
        for file in files {
            let name = file.file_name().unwrap().to_string_lossy().into_owned();
            let of_command = workplace.read(&name.replace("library", "command"));
            assert!(workplace.read(&name) == of_command, "{flags}: {name}");
        }
    }
}

#[test]
fn settings_mean_what_flags_of_the_command_do() {
    let workplace = Workplace::with_ball();
    let mut outside = settings(OUTSIDE);
    outside.guides.ghosts = vec![ViewModel::Rest, ViewModel::Contracted];
    outside.guides.axes = true;
    outside.guides.scale_bar = true;
    outside.guides.wireframe = true;
    outside.camera.aim = Aim::Target(DVec3::new(0.0, 1.0, 0.0));
    let mut observer = settings(PictureView::Observer(PictureMethod::Rays));
    observer.camera.aim = Aim::Look(DVec3::new(0.0, 1.0, 0.1));
    observer.camera.field_of_view = FieldOfView::Degrees(90.0);
    let mut sky = settings(PictureView::Observer(PictureMethod::Mesh));
    sky.camera.projection = PictureProjection::FullSky;
    sky.guides.sky_grid = true;
    sky.camera.size = PictureSize::new(40, 20).unwrap();
    sky.samples = std::num::NonZeroU32::MIN;
    for (settings, flags) in [
        (
            outside,
            "--view outside --ghost rest,contracted --axes --scale-bar --wireframe --target 0,1,0 --size 40x30",
        ),
        (observer, "--look 0,1,0.1 --fov 90 --size 40x30"),
        (sky, "--full-sky --method mesh --samples 1 --size 40x20"),
    ] {
        workplace
            .run(&format!("{FLAGS} {flags} -o a.png"))
            .success();
        let (pictures, _) = drawn(&settings, &()).unwrap();
        for (step, picture) in pictures.iter().enumerate() {
            let mut png = vec![];
            picture.write_png(&mut png).unwrap();
            let file = format!("a_step00{step}.png");
            assert!(png == workplace.read(&file), "{flags}: {file}");
        }
    }
}

#[test]
fn progress_hears_of_every_row_that_it_was_told_of() {
    for (view, flags, rows) in VIEWS {
        let progress = Pieces::until(usize::MAX);
        let (_, rendered) = drawn(&settings(view), &progress).unwrap();
        assert_eq!(progress.begun_and_done(), (rows, rows), "{flags}");
        let rays: u64 = rendered.costs.iter().map(|cost| cost.rays).sum();
        assert_eq!(rays, 9 * 40 * rows as u64, "{flags}");
        let photosurfaces = match view {
            PictureView::Observer(PictureMethod::Rays) => 0,
            _ => STEPS.len(),
        };
        assert_eq!(rendered.tally.photosurfaces, photosurfaces, "{flags}");
        assert_eq!(rendered.empty, [], "{flags}");
    }
}

/// Each thread ends the row that it is at.
#[test]
fn work_that_is_cancelled_ends_soon_and_says_so() {
    let threads = rayon::current_num_threads();
    for (view, flags, rows) in VIEWS {
        for end in [0, 7, rows / 2, rows - 1] {
            let progress = Pieces::until(end);
            let mut finished = 0;
            let (settings, textures) = (settings(view), Textures::default());
            let result = render(&ball(), &textures, &settings, &progress, |_, _| {
                finished += 1;
                Ok::<(), RenderError>(())
            });
            let context = format!("{flags}, after {end} rows");
            assert!(
                matches!(result, Err(RenderError::Cancelled)),
                "{context}: {result:?}"
            );
            let (_, done) = progress.begun_and_done();
            assert!((end..=end + threads).contains(&done), "{context}: {done}");
            let of_each = rows / settings.picture_count(STEPS.len());
            assert!(finished <= end / of_each, "{context}: {finished}");
        }
    }
}

#[test]
fn an_error_of_the_caller_ends_the_work_and_comes_back() {
    #[derive(Debug, PartialEq)]
    enum Mine {
        Enough(usize),
        Theirs(String),
    }
    impl From<RenderError> for Mine {
        fn from(error: RenderError) -> Self {
            Self::Theirs(error.to_string())
        }
    }
    let observer = settings(PictureView::Observer(PictureMethod::Rays));
    let ball = ball();
    let drawn = |settings: &PictureSettings| {
        let textures = Textures::default();
        render(&ball, &textures, settings, &(), |number, _| {
            Err(Mine::Enough(number))
        })
    };
    assert_eq!(drawn(&observer), Err(Mine::Enough(0)));
    let mut blind = observer;
    blind.camera.aim = Aim::Look(DVec3::ZERO);
    assert!(matches!(drawn(&blind), Err(Mine::Theirs(_))));
}

#[test]
fn what_cannot_be_drawn_is_an_error_and_what_is_empty_is_told() {
    let mut sheet = settings(SHEET);
    sheet.camera.size = PictureSize::new(9000, 9).unwrap();
    let error = drawn(&sheet, &()).unwrap_err();
    assert!(
        matches!(error, RenderError::Sheet { steps: 2, .. }),
        "{error}"
    );
    assert!(sheet.picture_size(1).is_ok() && sheet.picture_size(2).is_err());
    let mut outside = settings(TOGETHER);
    outside.camera.aim = Aim::Target(DVec3::new(2.0, 3.0, 20.0));
    let error = drawn(&outside, &()).unwrap_err();
    let of_target = |error: &RenderError| {
        matches!(error, RenderError::Framing(FramingError::TargetIsCamera(_)))
    };
    assert!(of_target(&error), "{error}");
    let mut away = settings(PictureView::Observer(PictureMethod::Rays));
    away.camera.aim = Aim::Look(DVec3::NEG_Y);
    let (_, rendered) = drawn(&away, &()).unwrap();
    let steps: Vec<usize> = rendered.empty.iter().map(|view| view.step).collect();
    assert_eq!(steps, [0, 1]);
    let mut there = away;
    there.camera.aim = Aim::Look(rendered.empty[0].look);
    assert!(
        drawn(&there, &())
            .unwrap()
            .1
            .empty
            .iter()
            .all(|view| view.step != 0)
    );
}
