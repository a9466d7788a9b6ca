//! A page taken apart, as a browser would.

use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine};
use photosurface::jobs::{PageSettings, page};
use photosurface::write::write_page;
use photosurface::{PlacedScene, Scene, load_models};
use serde_json::Value;

use crate::common::glb::{Glb, index};

/// The parts of a page.
pub(super) struct Page {
    pub(super) html: String,
    /// What the viewer reads of the scene.
    pub(super) scene: Value,
    /// The meshes: a GLB.
    pub(super) meshes: Vec<u8>,
    /// The table of colours.
    pub(super) colors: Vec<u8>,
}

impl Page {
    pub(super) fn new(html: Vec<u8>) -> Self {
        let html = String::from_utf8(html).expect("UTF-8");
        let bytes = |name: &str| BASE64_STANDARD.decode(element(&html, name));
        Self {
            scene: serde_json::from_str(element(&html, "scene")).expect("JSON"),
            meshes: bytes("meshes").expect("base64"),
            colors: bytes("colors").expect("base64"),
            html,
        }
    }

    /// The page of a scene, whose files are in a folder.
    pub(super) fn of(scene: &str, folder: &Path) -> Self {
        Self::new(html_of(scene, folder, ""))
    }

    /// The names of all nodes with a mesh, object by object.
    pub(super) fn nodes(&self) -> Vec<Vec<String>> {
        let names = |object: &Value| {
            let nodes = object["nodes"].as_array().expect("a list");
            let name = |node: &Value| node.as_str().expect("a name").to_owned();
            nodes.iter().map(name).collect()
        };
        let objects = self.scene["objects"].as_array().expect("a list");
        objects.iter().map(names).collect()
    }

    /// The places of the vertices of an object, relative to the translations of its nodes and these translations.
    pub(super) fn vertices(&self, object: usize) -> Vec<([f64; 3], [f64; 3])> {
        let glb = Glb::new(&self.meshes);
        let mut places = vec![];
        for name in &self.nodes()[object] {
            let nodes = glb.json["nodes"].as_array().expect("a list");
            let mut named = nodes.iter().filter(|node| node["name"] == **name);
            let node = named.next().expect("a node of this name");
            assert!(named.next().is_none(), "two nodes are called {name}");
            assert!(
                node.get("rotation").is_none()
                    && node.get("scale").is_none()
                    && node.get("matrix").is_none()
            );
            let part = |axis: usize| node["translation"][axis].as_f64().unwrap_or(0.0);
            let translation = [0, 1, 2].map(part);
            let mesh = &glb.json["meshes"][index(&node["mesh"])];
            for primitive in mesh["primitives"].as_array().expect("a list") {
                let numbers = glb.numbers(&primitive["attributes"]["POSITION"]);
                let local = numbers.as_chunks().0.iter();
                places.extend(local.map(|place: &[f32; 3]| (place.map(f64::from), translation)));
            }
        }
        places
    }
}

/// A page made by the library.
pub(super) fn html_of(scene: &str, folder: &Path, input: &str) -> Vec<u8> {
    let scene = Scene::from_json(scene).expect("a valid scene");
    let (models, _) = load_models(&scene, folder).expect("its files are there");
    let placed = PlacedScene::new(scene, models).expect("it can be placed");
    let settings = PageSettings {
        input: input.to_owned(),
        ..PageSettings::default()
    };
    let content = page(&placed, &settings, &()).expect("there is a page");
    let mut html = vec![];
    write_page(&content, &mut html).expect("memory takes it");
    html
}

/// The text of the script element of this name.
fn element<'a>(html: &'a str, name: &str) -> &'a str {
    let (_, after) = html
        .split_once(&format!(" id=\"{name}\">"))
        .expect("the element");
    after.split_once("</script>").expect("its end").0
}
