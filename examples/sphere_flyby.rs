//! A sphere flies by at 0.95 c: prints where it is seen and how far it seems stretched.
//!
//! It is seen far behind where it is, stretched sixfold, while it approaches, and flattened when it has
//! passed; the numbers are those of Fig. 3 of Rau, Weiskopf and Ruder (1998) for a sphere of radius 1 that
//! passes at a distance of 3.
//!
//!     cargo run --release --example sphere_flyby

use photosurface::{PlacedScene, Scene, SurfaceOptions, load_models};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::from_json(
        r#"{
          "observer": { "velocity": { "beta": 0.95, "direction": [-1, 0, 0] } },
          "objects": [ { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "position": [0, 3, 0] } ],
          "steps": [-6, -2, 0, 2, 12]
        }"#,
    )?;
    let (models, _) = load_models(&scene, ".".as_ref())?;
    let placed = PlacedScene::new(scene, models)?;

    println!("proper time    seen from x =       to x =    length along the motion");
    for step in 0..placed.scene().steps().len() {
        for sphere in placed.photosurfaces(step, SurfaceOptions::default())? {
            let (low, high) = sphere.mesh.bounds().ok_or("a sphere has vertices")?;
            let time = sphere.facts.proper_time;
            println!(
                "{time:>11} {:>18.4} {:>12.4} {:>26.4}",
                low.x,
                high.x,
                high.x - low.x
            );
        }
    }
    Ok(())
}
