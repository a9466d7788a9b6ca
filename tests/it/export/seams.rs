//! Parts of one object that share corners share them bit for bit in every file, however a reader adds up an offset and
//! what is relative to it: nothing is welded with a tolerance here.

use std::collections::HashMap;

use crate::common::command::Workplace;
use crate::common::glb::Glb;
use serde_json::Value;

/// A place as the bits of its coordinates.
type Bits = [u64; 3];

/// How programs add an offset and what is relative to it.
#[derive(Clone, Copy, Debug)]
enum Reader {
    /// trimesh, three.js where it is asked for places.
    Doubles,
    /// Blender, pyvista, shaders.
    Singles,
}

/// A node of a GLB: its place and its mesh.
struct Node {
    name: String,
    offset: [f64; 3],
    places: Vec<[f32; 3]>,
    targets: Vec<Vec<[f32; 3]>>,
    corners: Vec<u32>,
}

fn nodes(glb: &[u8]) -> Vec<Node> {
    let glb = Glb::new(glb);
    let json = &glb.json;
    let words = |accessor: &Value| -> Vec<[u8; 4]> {
        let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
        let (words, rest) = glb.view(&accessor["bufferView"]).as_chunks::<4>();
        assert!(rest.is_empty());
        words.to_vec()
    };
    let vectors = |accessor: &Value| -> Vec<[f32; 3]> {
        let words = words(accessor);
        let numbers: Vec<f32> = words.iter().map(|word| f32::from_le_bytes(*word)).collect();
        numbers.as_chunks::<3>().0.to_vec()
    };
    let node = |node: &Value| {
        let mesh = &json["meshes"][node["mesh"].as_u64().unwrap() as usize];
        let primitive = &mesh["primitives"][0];
        let axis = |axis: usize| node["translation"][axis].as_f64().unwrap_or(0.0);
        let targets = primitive["targets"].as_array();
        let targets = targets.into_iter().flatten();
        let indices = words(&primitive["indices"]);
        Node {
            name: node["name"].as_str().unwrap().to_owned(),
            offset: [0, 1, 2].map(axis),
            places: vectors(&primitive["attributes"]["POSITION"]),
            targets: targets.map(|target| vectors(&target["POSITION"])).collect(),
            corners: indices.into_iter().map(u32::from_le_bytes).collect(),
        }
    };
    let nodes = json["nodes"].as_array().unwrap().iter();
    let with_mesh = nodes.filter(|node| node.get("mesh").is_some());
    with_mesh.map(node).collect()
}

impl Node {
    /// Each corner's place, with these weights of the morph targets.
    fn seen_by(&self, reader: Reader, weights: &[f32]) -> Vec<Bits> {
        let place = |vertex: usize| {
            [0, 1, 2].map(|axis| {
                let mut local = self.places[vertex][axis];
                for (target, weight) in self.targets.iter().zip(weights) {
                    local += weight * target[vertex][axis];
                }
                let sum = match reader {
                    Reader::Doubles => self.offset[axis] + f64::from(local),
                    Reader::Singles => f64::from(self.offset[axis] as f32 + local),
                };
                // Both zeros are one place.
                (sum + 0.0).to_bits()
            })
        };
        self.corners.iter().map(|&c| place(c as usize)).collect()
    }
}

/// How many edges there are, and how many of them have no other that runs the other way.
fn edges(corners: &[Bits]) -> (usize, usize) {
    let mut edges: HashMap<[Bits; 2], i32> = HashMap::new();
    for triangle in corners.chunks_exact(3) {
        for side in 0..3 {
            let (a, b) = (triangle[side], triangle[(side + 1) % 3]);
            let (edge, way) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
            *edges.entry(edge).or_default() += way;
        }
    }
    let open = edges.values().filter(|ways| **ways != 0).count();
    (edges.len(), open)
}

/// The corners of a PLY, whose places are exact.
fn ply_corners(ply: &[u8]) -> (Vec<[f64; 3]>, Vec<Bits>) {
    let end = b"end_header\n";
    let header = ply.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let text = std::str::from_utf8(&ply[..header]).unwrap();
    let count = |of: &str| -> usize {
        let line = text.lines().find_map(|line| line.strip_prefix(of));
        line.unwrap().trim().parse().unwrap()
    };
    let size = |line: &str| match line.split(' ').nth(1) {
        Some("double") => 8,
        Some("float") => 4,
        _ => 0,
    };
    let properties = text.lines().filter(|line| line.starts_with("property "));
    let stride: usize = properties.map(size).sum();
    let (vertices, triangles) = (count("element vertex"), count("element face"));
    let number = |at: usize| f64::from_le_bytes(ply[at..at + 8].try_into().unwrap());
    let place = |vertex: usize| [0, 8, 16].map(|axis| number(header + vertex * stride + axis));
    let places: Vec<[f64; 3]> = (0..vertices).map(place).collect();
    let faces = &ply[header + vertices * stride..];
    let mut corners = vec![];
    for face in faces.chunks_exact(13).take(triangles) {
        for corner in face[1..].chunks_exact(4) {
            let vertex = u32::from_le_bytes(corner.try_into().unwrap()) as usize;
            corners.push(places[vertex].map(|number| (number + 0.0).to_bits()));
        }
    }
    assert_eq!(corners.len(), 3 * triangles);
    (places, corners)
}

/// A cube of six parts, and its six sides.
fn with_six_sides() -> Workplace {
    let workplace = Workplace::new();
    let cube = std::fs::read("fixtures/meshes/six_sides.obj").unwrap();
    workplace.write("six.obj", cube);
    workplace
}

/// Plates in a row, each a node; those in the middle are children of each other. Their corners coincide at rest.
fn with_plates() -> Workplace {
    let workplace = Workplace::new();
    let corners = [[0.0f32, 0.0], [0.125, 0.0], [0.125, 0.125], [0.0, 0.125]];
    let mut data: Vec<u8> = vec![];
    for [x, y] in corners {
        for number in [x, y, 0.0] {
            data.extend(number.to_le_bytes());
        }
    }
    data.extend([0u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes).as_flattened());
    workplace.write("plate.bin", &data);
    workplace.write(
        "plates.gltf",
        r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [ { "nodes": [0, 3] } ],
  "nodes": [ { "name": "a", "mesh": 0, "translation": [0.5, 0, 0], "children": [1] },
             { "name": "b", "mesh": 0, "translation": [0.125, 0, 0], "children": [2] },
             { "name": "c", "mesh": 0, "translation": [0.125, 0, 0] },
             { "name": "d", "mesh": 0, "translation": [0.875, 0, 0] } ],
  "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 }, "indices": 1 } ] } ],
  "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [0.125, 0.125, 0] },
                 { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" } ],
  "bufferViews": [ { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 12 } ],
  "buffers": [ { "uri": "plate.bin", "byteLength": 60 } ] }"#,
    );
    workplace
}

const READERS: [Reader; 2] = [Reader::Doubles, Reader::Singles];

#[test]
fn parts_that_make_a_closed_body_at_rest_make_one_in_every_file() {
    let workplace = with_six_sides();
    for flags in [
        "--beta 0.9 --observer 3,0.4,0.5",
        "--beta 0.9 --observer 1000.3,0.4,0.5",
        "--gamma 1000 --observer 3,0.4,0.5 --tolerance 1e-2",
        "--beta 0.5 --observer 0.1,0.2,-0.3 --direction 1,2,3",
    ] {
        workplace
            .run(&format!("export six.obj {flags} -o six.ply"))
            .success();
        let (_, corners) = ply_corners(&workplace.read("six.ply"));
        assert_eq!(edges(&corners).1, 0, "{flags}: .ply");
        workplace
            .run(&format!("export six.obj {flags} -o six.glb"))
            .success();
        let nodes = nodes(&workplace.read("six.glb"));
        assert_eq!(nodes.len(), 6);
        for reader in READERS {
            let corners: Vec<Bits> = nodes.iter().flat_map(|n| n.seen_by(reader, &[])).collect();
            let (all, open) = edges(&corners);
            assert!(all >= 18);
            assert_eq!(open, 0, "{flags}: {open} of {all} open, {reader:?}");
        }
    }
}

#[test]
fn parts_stay_together_in_every_step_and_between_steps() {
    let workplace = with_six_sides();
    let flags = "--beta 0.9 --observer 3,0.4,0.5 --steps=-3,0.25,4";
    workplace
        .run(&format!("export six.obj {flags} --animate -o frames.glb"))
        .success();
    let frames = nodes(&workplace.read("frames.glb"));
    for step in ["_step000", "_step001", "_step002"] {
        for reader in READERS {
            let of_step = frames.iter().filter(|node| node.name.ends_with(step));
            let corners: Vec<Bits> = of_step.flat_map(|n| n.seen_by(reader, &[])).collect();
            assert!(corners.len() >= 36);
            assert_eq!(edges(&corners).1, 0, "{step}, {reader:?}");
        }
    }
    workplace
        .run(&format!(
            "export six.obj {flags} --animate=morph -o morph.glb"
        ))
        .success();
    let morphing = nodes(&workplace.read("morph.glb"));
    assert_eq!(morphing.len(), 6);
    for weights in [[0.0, 0.0], [0.3, 0.0], [1.0, 0.0], [0.37, 0.63], [0.0, 1.0]] {
        for reader in READERS {
            let corners = morphing.iter().flat_map(|n| n.seen_by(reader, &weights));
            let (all, open) = edges(&corners.collect::<Vec<_>>());
            assert!(all >= 18);
            assert_eq!(open, 0, "{weights:?}, {reader:?}");
        }
    }
}

#[test]
fn nodes_of_a_hierarchy_whose_corners_coincide_at_rest_stay_together() {
    let workplace = with_plates();
    for (accuracy, least) in [("--tolerance 1e-2", 20), ("--no-subdivide", 17)] {
        let flags = format!("--beta 0.95 --observer 0.6,0.3,0.2 {accuracy}");
        for output in ["plates.ply", "plates.glb"] {
            let run = workplace.run(&format!("export plates.gltf {flags} -o {output}"));
            assert!(run.status < 2, "{run}");
        }
        let (_, exact) = ply_corners(&workplace.read("plates.ply"));
        let (all, outline) = edges(&exact);
        assert!(all >= least && outline < all, "{outline} of {all}");
        let nodes = nodes(&workplace.read("plates.glb"));
        assert_eq!(nodes.len(), 4);
        for reader in READERS {
            let corners = nodes.iter().flat_map(|node| node.seen_by(reader, &[]));
            let corners: Vec<Bits> = corners.collect();
            assert_eq!(corners.len(), exact.len(), "both are refined alike");
            assert_eq!(edges(&corners), (all, outline), "{reader:?}");
        }
    }
}

/// A part far from the middle of all is rounded like those farthest from it; that is in its certificate.
#[test]
fn the_rounding_of_parts_with_one_offset_is_within_what_is_proven() {
    let workplace = Workplace::new();
    let mut far = String::new();
    for (part, x) in [0.0, 0.3, 1234.567].into_iter().enumerate() {
        far += &format!(
            "o part{part}\nv {x} 0 0\nv {} 0.1 0\nv {x} 0.1 0.7\n",
            x + 0.1
        );
        let first = 3 * part + 1;
        far += &format!("f {first} {} {}\n", first + 1, first + 2);
    }
    workplace.write("far.obj", far);
    let flags = "--beta 0.9 --observer 3,0.4,0.5 --no-subdivide";
    for output in ["far.ply", "far.glb --report far.json"] {
        let run = workplace.run(&format!("export far.obj {flags} -o {output}"));
        assert!(run.status < 2, "{run}");
    }
    let (exact, _) = ply_corners(&workplace.read("far.ply"));
    let report = workplace.read_json("far.json");
    let nodes = nodes(&workplace.read("far.glb"));
    let mut exact = exact.chunks_exact(3);
    let mut worst = 0.0f64;
    for (node, facts) in nodes.iter().zip(report["objects"].as_array().unwrap()) {
        let rounding = facts["certificate"]["rounding"].as_f64().unwrap();
        for (local, exact) in node.places.iter().zip(exact.next().unwrap()) {
            let off = |axis: usize| node.offset[axis] + f64::from(local[axis]) - exact[axis];
            let error = off(0).hypot(off(1)).hypot(off(2));
            assert!(error <= rounding, "{}: {error:e} > {rounding:e}", node.name);
            worst = worst.max(error / rounding);
        }
        // Two units in the last place of half of what is seen, which is at most 1235 exp(atanh(0.9)) long.
        assert!(rounding < 1235.0 * 4.4 * 2f64.powi(-23), "{rounding:e}");
    }
    assert!(
        worst > 0.05,
        "the bound is no larger than it has to be: {worst}"
    );
}
