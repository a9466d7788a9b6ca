//! Every step of a scene as meshes and as pictures: `street.glb`, `street_step000.png`, `street_step001.png`, ...
//!
//!     cargo run --release --example every_step

use std::path::Path;

use photosurface::scene::BuiltInScene;
use photosurface::{
    ExportSettings, PictureMethod, PictureSettings, PictureView, PlacedScene, Textures, export,
    render_to_files,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let street = BuiltInScene::named("street").ok_or("a built-in scene")?;
    std::fs::write("street.json", street.json)?;
    let (placed, _) = PlacedScene::load(Path::new("street.json"))?;

    let meshes = Path::new("street.glb");
    let exported = export(&placed, &ExportSettings::default(), meshes, &())?;
    println!(
        "{}: {} triangles",
        meshes.display(),
        exported[0].tally.triangles
    );

    let settings = PictureSettings::new(PictureView::Observer(PictureMethod::Rays));
    let pictures = Path::new("street.png");
    render_to_files(&placed, &Textures::default(), &settings, pictures, &())?;
    Ok(())
}
