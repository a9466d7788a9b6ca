//! A mesh of one's own: a square wave of a wall, seen from a train at 0.9 c, written as `wall.glb`.
//!
//! The flat wall becomes a hyperboloid: what is ahead is seen stretched away, what is behind is seen close.
//!
//!     cargo run --release --example own_mesh

use photosurface::write::{Export, write_glb, write_whole};
use photosurface::{
    DVec3, Mesh, Model, Object, Observer, Part, PlacedScene, Scene, Source, SurfaceOptions,
    Velocity,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A strip of quads along z, each corner pushed in or out: any positions and triangles will do.
    let columns = 201u32;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for column in 0..columns {
        let z = f64::from(column) * 0.2 - 20.0;
        let x = if column / 10 % 2 == 0 { 2.0 } else { 2.3 };
        positions.extend([DVec3::new(x, -1.0, z), DVec3::new(x, 1.0, z)]);
        if column > 0 {
            let right = 2 * column;
            triangles.extend([[right - 2, right, right - 1], [right - 1, right, right + 1]]);
        }
    }
    let wall = Part::new("wall", Mesh::new(positions, triangles)?, None)?;

    let observer = Observer {
        velocity: Velocity::from_beta(0.9, DVec3::NEG_Z)?,
        ..Observer::default()
    };
    let model = Model {
        parts: vec![wall],
        ..Model::default()
    };
    let object = Object::new("wall", Source::Model(model.clone().into()));
    let placed = PlacedScene::new(Scene::new(observer, vec![object])?, vec![model])?;

    let photosurfaces: Vec<_> = placed
        .photosurfaces(0, SurfaceOptions::default())?
        .collect();
    let export = Export {
        scene: &placed.facts(),
        marker: None,
        photosurfaces: &photosurfaces,
        playback: None,
    };
    write_whole("wall.glb".as_ref(), |writer| write_glb(&export, writer))?;
    Ok(())
}
