"""A study of what accuracy costs is a study of exports: its memory is what an export of the same takes."""

import json
import os
import subprocess
import sys

import pytest

SCENE = {
    "observer": {"velocity": {"beta": 0.5, "direction": [0, 0, -1]}},
    "steps": list(range(12)),
    "tolerance": {"relative": 1e-2},
    "objects": [
        {"name": "grid", "shape": {"grid": {"size": 2, "cells": 100}}, "position": [0, 0, -20]}
    ],
}


# A process counts what its parent had in use when it began: a small one starts the binary, and asks.
MEASURE = """
import resource, subprocess, sys
subprocess.run(sys.argv[2:], check=True, stdout=subprocess.DEVNULL)
with open(sys.argv[1], "w") as out:
    out.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
"""


def peak_bytes(folder, *arguments):
    """The most memory that the binary had in use, as the system tells its parent."""
    told = folder / "peak"
    binary = os.environ["PHOTOSURFACE_BINARY"]
    # How much waits at once depends on which thread is done first: with one it is always the same.
    measure = [sys.executable, "-c", MEASURE, told, binary, *arguments, "--threads", 1]
    subprocess.run([str(word) for word in measure], check=True, timeout=120)
    return 1024 * int(told.read_text())


@pytest.mark.skipif(sys.platform != "linux", reason="the study tells its memory on Linux")
def test_the_memory_of_a_study_is_that_of_an_export(tmp_path):
    """12 steps of 20,000 triangles: all photosurfaces at once would take several times as much."""
    scene, mesh, study = (tmp_path / name for name in ("scene.json", "out.glb", "study.json"))
    scene.write_text(json.dumps(SCENE))
    exported = peak_bytes(tmp_path, "export", scene, "-q", "-o", mesh)
    peak_bytes(
        tmp_path,
        *("cost", scene, "--only", "meshes", "--tolerances", "1e-2"),
        *("--repeats", 1, "--places", 1, "-q", "--json", study),
    )
    (row,) = json.loads(study.read_text())["meshes"]
    assert row["made"]["file_bytes"] == mesh.stat().st_size
    studied = row["made"]["peak_memory_bytes"]
    print(f"export {exported / 1e6:.1f} MB, study {studied / 1e6:.1f} MB")
    assert 0.9 <= studied / exported <= 1.1
