"""Runs the binary under test. `cargo test --test crosscheck` makes the environment this runs in."""

import json
import os
import subprocess

import pytest


def pytest_configure():
    if "PHOTOSURFACE_BINARY" not in os.environ:
        pytest.exit("these tests are run by `cargo test --test crosscheck`", returncode=3)


@pytest.fixture(scope="session")
def photosurface():
    """Runs the binary with these arguments; it has to succeed. Returns what it printed, as bytes."""

    def run(*arguments, stdin=b"", threads=None):
        command = [os.environ["PHOTOSURFACE_BINARY"], *map(str, arguments)]
        environment = os.environ | ({"RAYON_NUM_THREADS": str(threads)} if threads else {})
        done = subprocess.run(
            command, input=stdin, capture_output=True, timeout=120, env=environment
        )
        assert done.returncode == 0, f"{command} gave {done.returncode}\n{done.stderr.decode()}"
        return done.stdout

    return run


@pytest.fixture(scope="session")
def export(photosurface, tmp_path_factory):
    """Exports a scene (as a dictionary) or a mesh (as a path); returns the path of the file.

    The same export is made once per session. Other files that belong to it lie beside it, in a
    directory of its own; `report.json` is there always.
    """
    done = {}

    def run(source, *flags, to="out.glb"):
        key = json.dumps([source if isinstance(source, dict) else str(source), flags, to])
        if key not in done:
            directory = tmp_path_factory.mktemp("export")
            if isinstance(source, dict):
                scene = directory / "scene.json"
                scene.write_text(json.dumps(source))
                source = scene
            report = directory / "report.json"
            photosurface("export", source, *flags, "-o", directory / to, "--report", report, "-q")
            done[key] = directory / to
        return done[key]

    return run


@pytest.fixture(scope="session")
def placed_vertices(export):
    """The vertices of an object's mesh, scaled, turned and in its rest frame, with double precision.

    The program itself tells them: they are where an observer at rest sees the same object when its
    origin is at the observer's place.
    """

    def vertices(spec):
        import ply

        at_rest = {k: v for k, v in spec.items() if k not in ("position", "velocity")}
        return ply.read(export({"objects": [at_rest]}, to="rest.ply"))

    return vertices
