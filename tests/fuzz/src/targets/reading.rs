//! Targets that read: files of models, and scenes.

use std::error::Error;
use std::path::Path;

use photosurface::read::{Findings, ReadError, read_gltf_bytes, read_model};
use photosurface::{Model, Scene};

use super::in_folder;

/// Between an OBJ file and the material library that it may name.
const NEXT_FILE: u8 = 0;

/// Reads a glTF or GLB file.
pub fn gltf(bytes: &[u8]) {
    in_folder(|folder| check(read_gltf_bytes(bytes, folder)));
}

/// Reads an OBJ file, and behind a zero byte the library `a.mtl`.
pub fn obj(bytes: &[u8]) {
    let mut files = bytes.splitn(2, |&byte| byte == NEXT_FILE);
    in_folder(|folder| {
        let [mesh, library] = ["a.obj", "a.mtl"].map(|name| folder.join(name));
        write(&mesh, files.next().unwrap_or_default());
        write(&library, files.next().unwrap_or_default());
        check(read_model(&mesh));
    });
}

/// Reads a PLY or an OFF file if the bytes begin with the name of one, else an STL file.
pub fn scan(bytes: &[u8]) {
    let start = &bytes[..bytes.len().min(8)];
    let name = match start {
        [b'p', b'l', b'y', ..] => "a.ply",
        _ if start.windows(3).any(|word| word == b"OFF") => "a.off",
        _ => "a.stl",
    };
    in_folder(|folder| {
        let mesh = folder.join(name);
        write(&mesh, bytes);
        check(read_model(&mesh));
    });
}

/// Reads a scene.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Scene::from_json(text) {
        Ok(scene) => {
            assert!(!scene.objects().is_empty(), "a scene shows something");
            assert!(scene.steps().iter().all(|step| step.is_finite()));
            assert!(scene.observer().velocity.beta() <= 1.0);
        }
        Err(error) => check_message(&error),
    }
}

fn write(path: &Path, bytes: &[u8]) {
    std::fs::write(path, bytes).expect("a temporary folder takes a file");
}

/// What was read is what the rest of the library relies on; what was not has a reason.
fn check(read: Result<(Model, Findings), ReadError>) {
    let (model, findings) = match read {
        Ok(read) => read,
        Err(error) => return check_message(&error),
    };
    let triangles = model.parts.iter().map(|part| part.mesh().triangles().len());
    assert!(triangles.sum::<usize>() > 0, "a model has triangles");
    for part in &model.parts {
        let mesh = part.mesh();
        let vertices = mesh.positions().len();
        assert!(mesh.positions().iter().all(|place| place.is_finite()));
        let corners = mesh.triangles().iter().flatten();
        assert!(
            corners
                .max()
                .is_none_or(|&corner| (corner as usize) < vertices)
        );
        let lengths = [
            mesh.normals().map(<[_]>::len),
            mesh.tangents().map(<[_]>::len),
            mesh.colors().map(<[_]>::len),
        ];
        let sets = mesh.texture_coordinates().iter().map(|set| set.len());
        assert!(
            lengths
                .into_iter()
                .flatten()
                .chain(sets)
                .all(|length| length == vertices)
        );
    }
    for note in findings.notes {
        assert!(!note.to_string().is_empty());
    }
}

/// Every error says something, and so do its causes.
pub(crate) fn check_message(error: &dyn Error) {
    let mut cause = Some(error);
    while let Some(error) = cause {
        assert!(!error.to_string().is_empty(), "{error:?} says nothing");
        cause = error.source();
    }
}
