"""Rays a second of `photosurface render --method mesh` against Embree, same mesh, same directions, one thread each.

    python -m venv target/embree && target/embree/bin/pip install embreex trimesh
    cargo build --release && target/embree/bin/python tests/bench/embree.py target/release/photosurface

Embree, called through trimesh, computes in f32 and finds the first triangle of every ray; photosurface computes in
f64 and also shades and encodes the picture.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import time

import numpy
import trimesh

WIDTH, HEIGHT, FOV = 1280, 720, 60.0
LOOK = (0.0, 0.0, -1.0)
CASES = [("lattice", "1e-3"), ("street", "1e-3"), ("street", "1e-5")]
RUNS = 5


def directions() -> numpy.ndarray:
    """One through the middle of every pixel of a camera that looks along -z."""
    half = math.tan(math.radians(FOV) / 2)
    x = (numpy.arange(WIDTH) + 0.5) / WIDTH * 2 - 1
    y = 1 - (numpy.arange(HEIGHT) + 0.5) / HEIGHT * 2
    grid = numpy.stack(numpy.meshgrid(x * half * WIDTH / HEIGHT, y * half), axis=-1).reshape(-1, 2)
    rays = numpy.hstack([grid, numpy.full((len(grid), 1), -1.0)])
    return rays / numpy.linalg.norm(rays, axis=1, keepdims=True)


def ours(binary: str, example: str, tolerance: str, picture: str) -> float:
    """Millions of rays a second, the best of several runs."""
    command = [binary, "render", "--example", example, "--tolerance", tolerance, "--method", "mesh", "--samples", "1",
               "--steps", "0", "--size", f"{WIDTH}x{HEIGHT}", "--fov", str(FOV), "--look", ",".join(map(str, LOOK)), "-v",
               "-o", picture]
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    best = 0.0
    for _ in range(RUNS):
        told = subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stderr
        best = max(best, float(re.search(r"([\d.]+) million a second", told).group(1)))
    return best


def embree(mesh: trimesh.Trimesh) -> tuple[float, int]:
    """Millions of rays a second, the best of several runs, and how many hit."""
    caster = trimesh.ray.ray_pyembree.RayMeshIntersector(mesh)
    rays = directions()
    origins = numpy.zeros_like(rays)
    caster.intersects_first(origins[:1], rays[:1])
    best = 0.0
    for _ in range(RUNS):
        start = time.perf_counter()
        first = caster.intersects_first(origins, rays)
        best = max(best, len(rays) / (time.perf_counter() - start) / 1e6)
    return best, int((first >= 0).sum())


def main() -> None:
    binary = sys.argv[1]
    print("scene    tolerance  triangles  embree  photosurface  ratio   (million rays a second)")
    for example, tolerance in CASES:
        with tempfile.TemporaryDirectory() as directory:
            ply, picture = os.path.join(directory, "mesh.ply"), os.path.join(directory, "picture.png")
            subprocess.run([binary, "export", "--example", example, "--tolerance", tolerance, "--steps", "0", "--marker",
                            "0", "-q", "-o", ply], check=True)
            mesh = trimesh.load(ply, process=False)
            theirs, hits = embree(mesh)
            speed = ours(binary, example, tolerance, picture)
            assert hits > 0.02 * WIDTH * HEIGHT, f"{example}: only {hits} rays hit"
        print(f"{example:8} {tolerance:>9} {len(mesh.faces):10} {theirs:7.2f} {speed:13.2f} {speed / theirs:6.2f}")


if __name__ == "__main__":
    main()
