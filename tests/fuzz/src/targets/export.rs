//! The whole way to a file.

use photosurface::read::read_gltf_bytes;
use photosurface::tessellate::{Certificate, Precision};
use photosurface::write::{
    Export, Format, GltfFile, GltfOutput, Playback, Report, Target, WriteError, write_ply,
};
use photosurface::{DVec3, Photosurface, PlacedScene, Source, SurfaceOptions};

use super::case::Case;
use super::in_folder;
use super::reading::check_message;

/// Makes the photosurfaces of a [`Case`] and writes them as the command does.
pub fn export(bytes: &[u8]) {
    let case = Case::new(bytes);
    in_folder(|folder| {
        let Some(placed) = case.placed(folder) else {
            return;
        };
        let scene = placed.scene();
        let steps = scene.steps().len();
        let format = case.format;
        if format.min_size(&placed, steps).is_err() {
            return;
        }
        if let Err(error) = format.check_range(&placed) {
            return check_message(&error);
        }
        let wanted = SurfaceOptions {
            attributes: format.attributes(scene),
            subdivide: case.subdivide,
            precision: match format {
                Format::Ply => Precision::Double,
                Format::Glb | Format::Gltf => Precision::Single,
            },
        };
        let _ = placed.predictions(wanted);
        let placed = match case.subdivide {
            true => placed.within_budget(wanted, case.budget).0,
            false => placed,
        };
        let playback = playback(&case, &placed, wanted);
        let morphing = matches!(playback, Some(Playback::Morph { .. }));
        let made: Vec<Vec<Photosurface>> = match morphing {
            true => placed.morphing(wanted).collect(),
            false => (0..steps)
                .map(|step| {
                    placed
                        .photosurfaces(step, wanted)
                        .expect("a step")
                        .collect()
                })
                .collect(),
        };
        let facts = made.iter().flatten().map(|made| made.facts.clone());
        let report = Report {
            scene: placed.facts(),
            objects: facts.collect(),
            stages: vec![],
            provenance: Default::default(),
            outputs: vec![],
            resumed: vec![],
            seal: None,
        };
        assert!(!report.to_json().is_empty());
        for photosurface in made.iter().flatten() {
            check_certificate(&photosurface.facts.certificate);
            check_cover(&placed, photosurface);
        }
        let written = match format {
            Format::Ply => write_as_ply(&placed, &made),
            Format::Glb => write_as_glb(&placed, &made, wanted, playback),
            Format::Gltf => write_as_gltf(&placed, &made, wanted, playback, folder),
        };
        if let Err(error) = written {
            check_message(&error);
        }
    });
}

fn playback(case: &Case, placed: &PlacedScene, wanted: SurfaceOptions) -> Option<Playback> {
    let frames_per_second = 24.0;
    let several = placed.scene().steps().len() > 1 && case.format != Format::Ply;
    match case.animate.filter(|_| several)? {
        "morph" if !wanted.attributes.is_empty() => None,
        "morph" => Some(Playback::Morph { frames_per_second }),
        _ => Some(Playback::Frames { frames_per_second }),
    }
}

fn check_certificate(certificate: &Certificate) {
    let Certificate {
        tolerance,
        gap,
        surface_gap,
        curvature,
        rounding,
        total,
        complete,
        ..
    } = *certificate;
    assert!(
        surface_gap <= gap,
        "{certificate:?}: places are never nearer than surfaces"
    );
    if complete {
        assert!(total <= tolerance, "{certificate:?} is not complete");
        let parts = [certificate.measured_gap(), curvature, rounding];
        assert!(
            parts.iter().all(|&part| part <= total),
            "{certificate:?} has a part larger than the sum"
        );
    }
}

/// The triangles that a mesh is refined to cover it, once: they have its area.
fn check_cover(placed: &PlacedScene, made: &Photosurface) {
    let facts = &made.facts;
    let parts = placed.objects().filter(|(object, _)| {
        // Shapes are made as fine as they have to be, which changes their area.
        object.name == facts.object && matches!(object.source, Source::File(_))
    });
    let mut parts = parts.flat_map(|(_, parts)| parts);
    let part = parts.find(|(_, part)| part.name == facts.part);
    let Some(((_, part), places)) = part.zip(made.vertex_data.rest_positions()) else {
        return;
    };
    let before = areas(part.mesh().positions(), part.mesh().triangles());
    let after = areas(places, made.mesh.triangles());
    if !before.is_finite() {
        return;
    }
    // New corners are rounded to the last place of what they are far from.
    let (low, high) = part.mesh().bounds().unwrap_or_default();
    let size = low.abs().max(high.abs()).max_element();
    let rounding = 1e-12 * size * (high - low).length();
    assert!(
        (before - after).abs() <= 1e-6 * before + rounding,
        "the area at rest was {before:e} and is {after:e}: {facts:?}"
    );
}

/// The area of all triangles.
fn areas(places: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| places[corner as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    triangles.iter().map(area).sum()
}

fn write_as_ply(placed: &PlacedScene, made: &[Vec<Photosurface>]) -> Result<(), WriteError> {
    let photosurfaces: Vec<_> = made.iter().flatten().cloned().collect();
    let mut out = vec![];
    let export = Export {
        scene: &placed.facts(),
        marker: placed.marker(),
        photosurfaces: &photosurfaces,
        playback: None,
    };
    write_ply(&export, &mut out)?;
    let triangles = made_triangles(placed, made);
    let header = out.windows(11).position(|text| text == b"end_header\n");
    let header = String::from_utf8_lossy(&out[..header.expect("a PLY has a header")]);
    assert!(
        header.contains(&format!("element face {triangles}\n")),
        "{triangles} triangles made, written {header}"
    );
    Ok(())
}

fn write_as_glb(
    placed: &PlacedScene,
    made: &[Vec<Photosurface>],
    wanted: SurfaceOptions,
    playback: Option<Playback>,
) -> Result<(), WriteError> {
    let mut out = vec![];
    let output = GltfOutput::glb(Target::Stream(&mut out), 1);
    fill(placed, made, wanted, playback, output)?;
    check_reading(placed, made, playback, &out, "".as_ref());
    Ok(())
}

fn write_as_gltf(
    placed: &PlacedScene,
    made: &[Vec<Photosurface>],
    wanted: SurfaceOptions,
    playback: Option<Playback>,
    folder: &std::path::Path,
) -> Result<(), WriteError> {
    let (mut out, mut data) = (vec![], vec![]);
    let output = GltfOutput::gltf("out.bin", &mut out, &mut data);
    fill(placed, made, wanted, playback, output)?;
    std::fs::write(folder.join("out.bin"), data).expect("a temporary folder takes a file");
    check_reading(placed, made, playback, &out, folder);
    Ok(())
}

fn fill(
    placed: &PlacedScene,
    made: &[Vec<Photosurface>],
    wanted: SurfaceOptions,
    playback: Option<Playback>,
    output: GltfOutput<'_>,
) -> Result<(), WriteError> {
    let marker = placed.marker();
    let mut file = GltfFile::new(output, &placed.facts(), marker, wanted.attributes, playback)?;
    match playback {
        Some(Playback::Morph { .. }) => made.iter().try_for_each(|part| file.add_morphing(part))?,
        _ => made.iter().flatten().try_for_each(|made| file.add(made))?,
    }
    file.finish()
}

/// What was written is read again, whole.
fn check_reading(
    placed: &PlacedScene,
    made: &[Vec<Photosurface>],
    playback: Option<Playback>,
    file: &[u8],
    folder: &std::path::Path,
) {
    let read = read_gltf_bytes(file, folder);
    // Of an animation there is one step to be seen.
    if playback.is_some() {
        return;
    }
    let (model, _) = read.expect("what is written can be read");
    let triangles = model.parts.iter().map(|part| part.mesh().triangles().len());
    let (made, read) = (made_triangles(placed, made), triangles.sum::<usize>());
    assert_eq!(made, read, "triangles made and read");
}

/// How many triangles a file without animation has.
fn made_triangles(placed: &PlacedScene, made: &[Vec<Photosurface>]) -> usize {
    let made = made.iter().flatten().map(|made| &made.mesh);
    let marker = placed.marker().map(|part| part.mesh());
    made.chain(marker).map(|mesh| mesh.triangles().len()).sum()
}
