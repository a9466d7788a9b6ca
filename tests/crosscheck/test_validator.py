"""The Khronos validator finds no error and no warning in any kind of file that is written."""

import json
import math
import os
import subprocess
from pathlib import Path

import pytest

from kinds import KINDS
from scenes import CUBE, SEVERAL, SPHERE, TORUS, write_airplane, write_obj

ERROR, WARNING = 0, 1
SCRIPT = Path(__file__).with_name("validate.cjs")


def reports_of(paths):
    """The reports of the validator, one for each file."""
    done = subprocess.run(["node", SCRIPT, *paths], capture_output=True, text=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    reports = json.loads(done.stdout)
    assert len(reports) == len(paths)
    return reports


def validate(path):
    """The messages of the validator: all of them, and its report."""
    [report] = reports_of([path])
    return report["issues"]["messages"], report


def assert_valid(path):
    assert_clean(validate(path)[1])


def assert_clean(report):
    messages = report["issues"]["messages"]
    # Everything binary was there to be looked at.
    assert report["info"]["totalTriangleCount"] > 0
    assert not report["issues"]["truncated"]
    serious = [message for message in messages if message["severity"] in (ERROR, WARNING)]
    for message in messages:
        print(message)  # pytest shows it where the assertion fails
    assert not serious


@pytest.mark.parametrize("to", ["out.glb", "out.gltf"])
@pytest.mark.parametrize(
    "scene", [SPHERE, CUBE, TORUS, SEVERAL], ids=["steps", "placed", "one step", "marker and checker"]
)
def test_scenes(scene, to, export):
    assert_valid(export(scene, to=to))


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind(kind, export, tmp_path):
    for path in KINDS[kind](export, tmp_path):
        assert_valid(path)


@pytest.mark.parametrize("name", ["sphere", "cube", "lattice", "street", "snapshot"])
def test_built_in_scenes(name, export, photosurface):
    assert_valid(export(json.loads(photosurface("example", name))))


@pytest.mark.parametrize("shape", ["cylinder", "cone", "torus", "rod", "grid", "lattice", "box", "sphere"])
def test_shapes_with_a_checkered_texture(shape, export):
    sizes = {
        "cylinder": {"radius": 1, "height": 2},
        "cone": {"radius": 1, "height": 2},
        "torus": {"major_radius": 2, "minor_radius": 0.5},
        "rod": {"length": 4, "radius": 0.1},
        "grid": {"size": 4, "cells": 4},
        "lattice": {"cells": 2, "spacing": 1, "thickness": 0.1},
        "box": {"size": [1, 1, 1]},
        "sphere": {"radius": 1},
    }
    spec = {
        "name": "thing",
        "shape": {shape: sizes[shape]},
        "position": [0, 3, 0],
        "color": "#ffffff",
        "checker": "#4060a0",
    }
    assert_valid(export({"observer": {"velocity": [-0.9, 0, 0]}, "objects": [spec]}))


@pytest.mark.parametrize("to", ["out.glb", "out.gltf"])
def test_materials_and_textures_of_an_obj(to, export, tmp_path):
    spec = {"name": "roof", "file": str(write_obj(tmp_path)), "position": [0, 0, -5]}
    path = export({"observer": {"velocity": [0, 0, -0.9]}, "objects": [spec], "steps": [0, 1]}, to=to)
    assert_valid(path)
    _, report = validate(path)
    assert report["info"]["materialCount"] >= 2
    assert report["info"]["hasTextures"]


def test_a_mesh_from_elsewhere(export, tmp_path):
    assert_valid(export(write_airplane(tmp_path), "--beta", "0.9"))


@pytest.mark.parametrize("rapidity", [0, 1e-9, 0.5, 3, 7.6, 14.5, 19, 28, 40, 60])
def test_hard_files(rapidity, export):
    """Twelve files of each rapidity: the observer passes four things, near and far, small and large, and is in one.

    Where they are at rest he is `time sinh(rapidity)` farther on: steps that shrink with `exp(-rapidity)` stay near.
    """
    places = {"in": [0, 0, 0], "ahead": [0, 0, -1e6], "behind": [0, 1e-9, 1e3], "aside": [30, 40, 1e-3]}
    sizes = {"in": [2, 2, 2], "ahead": [1e3, 1, 1e-3], "behind": [1e-3, 1e-6, 1], "aside": [1, 0.5, 20]}
    scene = {
        "observer": {"velocity": {"rapidity": rapidity, "direction": [0.01, -0.02, -1]}},
        "objects": [
            {"name": name, "shape": {"box": {"size": sizes[name]}}, "position": place}
            for name, place in places.items()
        ],
        "steps": [t * math.exp(-rapidity) for t in (-1e6, -1e3, -30, -3, -1, -1e-9, 0, 1e-9, 0.5, 7, 1e3, 1e6)],
    }
    first = export(scene, "--split", "--max-triangles", "20000", to="hard.glb", certified=None)
    paths = sorted(first.parent.glob("*.glb"))
    assert len(paths) == len(scene["steps"])
    for report in reports_of(paths):
        assert_clean(report)


def test_the_validator_does_find_errors(export, tmp_path):
    """A file whose bounds are wrong is not valid: the validator looks into the binary part."""
    whole = export(CUBE, to="out.gltf")
    json_text = json.loads(whole.read_text())
    for accessor in json_text["accessors"]:
        if "min" in accessor:
            accessor["min"][0] -= 1
    (tmp_path / "out.gltf").write_text(json.dumps(json_text))
    for buffer in json_text["buffers"]:
        (tmp_path / buffer["uri"]).write_bytes((whole.parent / buffer["uri"]).read_bytes())
    messages, _ = validate(tmp_path / "out.gltf")
    assert "ACCESSOR_MIN_MISMATCH" in {message["code"] for message in messages}
