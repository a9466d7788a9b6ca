"""Draws the pictures of the README with the program itself.

    python examples/gallery/draw.py target/release/photosurface

Each picture is one command, which is printed, of a built-in scene or of one that stands here.
"""

import json
import pathlib
import shlex
import subprocess
import sys

GALLERY = pathlib.Path(__file__).parent

# A cube that looks turned by asin(0.8) = 53 degrees when it is seen at right angles to its motion: Terrell's rotation.
ROTATION = {
    "observer": {"velocity": {"beta": 0.8, "direction": [-1, 0, 0]}},
    "objects": [
        {"name": "cube", "shape": {"box": {"size": [2, 2, 2]}}, "color": "#f2f2e6", "checker": "#2471a3",
         "position": [16, 0, -12]},
    ],
}

# Far ahead a sphere is stretched to (1 + beta) gamma = 6.2 times its width, and its outline stays a circle.
STRETCHED = {
    "observer": {"velocity": {"beta": 0.95, "direction": [-1, 0, 0]}},
    "objects": [
        {"name": "sphere", "shape": {"sphere": {"radius": 1}}, "color": "#f2f2e6", "checker": "#c0392b",
         "position": [-3, 1.5, 0]},
    ],
}

# A plane at right angles to the motion becomes a sheet of a hyperboloid.
PLANE = {
    "observer": {"velocity": {"beta": 0.95, "direction": [0, 1, 0]}, "marker": 0.3},
    "objects": [
        {"name": "plane", "shape": {"grid": {"size": 16, "cells": 16}}, "color": "#f2f2e6", "checker": "#7d3c98",
         "position": [0, 1, 0]},
    ],
}

GUIDES = "--axes --scale-bar"
WHITE = "--background #ffffff"
LATTICE = "--steps 3.4 --fov 110 --look 0,0,-1 --size 480x300"

PICTURES = [
    ("sphere", None, f"--example sphere --view outside --together --size 1200x260 --fov 10 {GUIDES} {WHITE}"),
    ("cube", None, f"--example cube --view outside --together --size 1200x260 --fov 10 {GUIDES} {WHITE}"),
    ("figure_3", None, "--example sphere --sheet --size 192x160"),
    ("figure_4", None, "--example cube --sheet --size 224x180"),
    ("rotation_seen", ROTATION, "--size 480x360 --fov 13"),
    ("rotation_shear", ROTATION, f"--view outside --ghost rest --size 480x360 --fov 10 --look 0,-1,-0.25 --scale-bar"),
    ("stretched_seen", STRETCHED, "--size 480x360 --fov 9"),
    ("stretched_shape", STRETCHED, f"--view outside --ghost rest --size 480x360 --fov 10 --scale-bar"),
    ("plane", PLANE, f"--view outside --size 480x360 --fov 20 --look -0.5,-0.35,-1 {GUIDES}"),
    ("snapshot_seen", None, "--example snapshot --size 480x360 --fov 22"),
    ("snapshot_shape", None, f"--example snapshot --view outside --ghost rest --size 480x360 --marker 0 --scale-bar"),
    ("figure_6", None, "--example flight --size 480x300 --beta 0 --steps 0"),
    ("figure_7", None, "--example flight --size 480x300 --steps 0"),
    ("figure_8", None, "--example flight --size 480x300 --steps 2.1"),
    ("figure_9", None, "--example flight --size 480x300 --steps 3.7"),
    ("takeoff", None, "--example takeoff --sheet --size 240x180"),
    ("effects_none", None, f"--example lattice {LATTICE}"),
    ("effects_doppler", None, f"--example lattice {LATTICE} --doppler spectrum"),
    ("effects_searchlight", None, f"--example lattice {LATTICE} --searchlight --exposure auto"),
    ("effects_both", None, f"--example lattice {LATTICE} --doppler spectrum --searchlight --exposure auto"),
    ("night_at_rest", None, "--example night --beta 0 --size 480x300"),
    ("night", None, "--example night --size 480x300"),
    ("stars_at_rest", None, "--example stars --beta 0 --full-sky --background #000000 --size 480x240"),
    ("stars", None, "--example stars --full-sky --background #000000 --size 480x240"),
    ("models", None, "--example models --models seen,delayed,contracted,rest --sheet --size 240x200"),
]

# Minkowski diagrams.
DIAGRAMS = [
    ("flight_diagram", "--example flight --at 0,2.1,3.7 --point ring1 --point ring2 --diagram-size 640x640"),
]


def draw(binary: str, name: str, scene: dict | None, flags: str) -> None:
    """Writes gallery/NAME.png."""
    source = [] if scene is None else ["-"]
    run([binary, "render", *source, *shlex.split(flags), "-q", "-o", str(GALLERY / f"{name}.png")], json.dumps(scene))


def draw_diagram(binary: str, name: str, flags: str) -> None:
    """Writes gallery/NAME.png."""
    run([binary, "flight", *shlex.split(flags), "-q", "--diagram", str(GALLERY / f"{name}.png")])


def run(command: list[str], stdin: str = "") -> None:
    print(shlex.join(command))
    subprocess.run(command, input=stdin, text=True, check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    binary, *names = sys.argv[1:]
    for picture in PICTURES:
        if picture[0] in names or not names:
            draw(binary, *picture)
    for diagram in DIAGRAMS:
        if diagram[0] in names or not names:
            draw_diagram(binary, *diagram)
