//! Writes the scene and the mesh that an input of the targets `export` and `render` stands for, and prints the commands
//! that do the same: `cargo run -p photosurface-fuzz --example show -- INPUT FOLDER`.

use std::{env, fs, path::Path};

use photosurface_fuzz::Case;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = env::args().collect();
    let [_, input, folder] = &arguments[..] else {
        return Err("expected an input and a folder".into());
    };
    let case = Case::new(&fs::read(input)?);
    let folder = Path::new(folder);
    fs::create_dir_all(folder)?;
    fs::write(
        folder.join("scene.json"),
        serde_json::to_string_pretty(&case.scene)?,
    )?;
    fs::write(folder.join("mesh.obj"), &case.mesh)?;
    println!("photosurface export scene.json {}", case.export_flags());
    println!("photosurface render scene.json {}", case.render_flags());
    Ok(())
}
