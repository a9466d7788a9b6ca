//! Time and peak memory of the command with 5,000 objects in one scene, of one shape or of as many.
//!
//! `cargo bench --bench crowd`; with `-- --quick` with 500 objects. Each row is a kind of objects and a command: the
//! wall-clock time, and the most memory that the process had, where the system is Linux.

#![allow(clippy::print_stdout, reason = "a benchmark prints what it measures")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use photosurface::Shape;
use serde_json::{Value, json};

const OBJECTS: u32 = 5000;
const OBJECTS_QUICK: u32 = 500;

/// Time between two looks at the memory of a process.
const LOOK: Duration = Duration::from_millis(2);

/// A grid of so many cells along each edge has 968 triangles.
const CELLS_OF_MESH: u32 = 22;
const MESH: &str = "mesh.obj";

fn main() {
    let is_quick = std::env::args().any(|argument| argument == "--quick");
    let count = if is_quick { OBJECTS_QUICK } else { OBJECTS };
    let folder = tempfile::tempdir().expect("a temporary directory can be made");
    write_mesh(&folder.path().join(MESH));
    let edge = |k: u32| 1.0 + f64::from(k % 4999) / 10_000.0;
    let box_of = |edge: f64| json!({ "box": { "size": [edge, 1, 1] } });
    let shape = |shape: Value| json!({ "shape": shape });
    let grid = json!({ "grid": { "size": 1, "cells": 4 } });
    let lattice = json!({ "lattice": { "cells": 1, "spacing": 0.9, "thickness": 0.1 } });
    let ball = json!({ "sphere": { "radius": 0.5 } });
    let kinds: [(&str, &dyn Fn(u32) -> Value); 7] = [
        ("boxes of one size", &|_| shape(box_of(1.0))),
        ("boxes of all sizes", &|k| shape(box_of(edge(k)))),
        ("grids of one size", &|_| shape(grid.clone())),
        ("lattices of one size", &|_| shape(lattice.clone())),
        ("spheres of one size", &|_| shape(ball.clone())),
        ("meshes of 968 triangles", &|_| json!({ "file": MESH })),
        (
            "meshes of all scales",
            &|k| json!({ "file": MESH, "scale": edge(k) }),
        ),
    ];
    println!("{count} objects, the observer at 0.9 c");
    for (name, source) in kinds {
        let scene = folder.path().join("scene.json");
        let objects = (0..count).map(|k| object(k, count, source(k)));
        let text = json!({
            "observer": { "velocity": { "beta": 0.9 } },
            "objects": objects.collect::<Vec<_>>(),
        });
        fs::write(&scene, text.to_string()).expect("a temporary file can be written");
        for (command, output) in [
            ("export", Some("out.glb")),
            ("check", None),
            ("render", Some("out.png")),
        ] {
            let mut process = Command::new(env!("CARGO_BIN_EXE_photosurface"));
            process.arg(command).arg(&scene).arg("-q");
            if let Some(output) = output {
                process.arg("-o").arg(folder.path().join(output));
            }
            let (time, memory) = watched(&mut process);
            let memory = memory.map_or("unknown".to_owned(), |bytes| {
                format!("{:.0} MB", bytes as f64 / 1e6)
            });
            println!(
                "{name:<24} {command:<7} {:>8.2} s {memory:>10}",
                time.as_secs_f64()
            );
        }
    }
}

/// An object of a source, far enough from the others, 6 below the observer and ahead.
fn object(k: u32, count: u32, source: Value) -> Value {
    let side = f64::from(count).sqrt().ceil();
    let (x, z) = (f64::from(k) % side, (f64::from(k) / side).floor());
    let mut object = json!({
        "name": format!("object{k}"),
        "position": [3.0 * (x - side / 2.0), -6.0, -3.0 * z - 6.0],
    });
    for (key, value) in source.as_object().into_iter().flatten() {
        object[key] = value.clone();
    }
    object
}

/// A square of 968 triangles as an OBJ.
fn write_mesh(path: &Path) {
    let grid = Shape::grid(1.0, CELLS_OF_MESH).and_then(|grid| grid.with_resolution(1));
    let mesh = grid.and_then(|grid| grid.mesh()).expect("a small grid");
    let mut text = String::new();
    for place in mesh.positions() {
        writeln!(text, "v {} {} {}", place.x, place.y, place.z).expect("a string takes everything");
    }
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| corner + 1);
        writeln!(text, "f {a} {b} {c}").expect("a string takes everything");
    }
    fs::write(path, text).expect("a temporary file can be written");
}

/// The time that a process takes, and the most memory that it has, in bytes, if the system tells.
fn watched(process: &mut Command) -> (Duration, Option<u64>) {
    let start = Instant::now();
    let process = process.stdout(Stdio::null()).spawn();
    let mut process = process.expect("the command has been built");
    let mut memory = None;
    let status = loop {
        match process.try_wait().expect("a child of this process") {
            Some(status) => break status,
            None => memory = memory.max(peak_memory(process.id())),
        }
        sleep(LOOK);
    };
    // 1: not certified.
    let code = status.code();
    assert!(code == Some(0) || code == Some(1), "{status}");
    (start.elapsed(), memory)
}

fn peak_memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = peak.split_whitespace().next()?.parse().ok()?;
    Some(1024 * kibibytes)
}
