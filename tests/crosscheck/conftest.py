"""Runs the binary under test.

`cargo test --test it crosscheck -- --include-ignored` makes the environment this runs in.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

# Blender and MeshLab are asked from an environment of their own.
collect_ignore = ["full"]


def pytest_configure():
    if "PHOTOSURFACE_BINARY" not in os.environ:
        pytest.exit("these tests are run by `cargo test --test it crosscheck -- --include-ignored`", returncode=3)


@pytest.fixture(scope="session")
def run():
    """Runs the binary with these arguments; returns how it ended and what it printed, as bytes."""

    def run(*arguments, stdin=b"", threads=None):
        command = [os.environ["PHOTOSURFACE_BINARY"], *map(str, arguments)]
        environment = os.environ | ({"RAYON_NUM_THREADS": str(threads)} if threads else {})
        return subprocess.run(
            command, input=stdin, capture_output=True, timeout=120, env=environment
        )

    return run


@pytest.fixture(scope="session")
def photosurface(run):
    """Runs the binary with these arguments; it has to succeed. Returns what it printed, as bytes."""

    def succeed(*arguments, **options):
        done = run(*arguments, **options)
        assert done.returncode == 0, f"{done.args} gave {done.returncode}\n{done.stderr.decode()}"
        return done.stdout

    return succeed


@pytest.fixture(scope="session")
def export(run, tmp_path_factory):
    """Exports a scene (as a dictionary) or a mesh (as a path); returns the path of the file.

    The same export is made once per session. Other files that belong to it lie beside it, in a
    directory of its own; `report.json` is there always, and `messages.txt`, what was said on stderr.

    The exit status has to be that of the certificates in the report: 0 if all are complete, else 1. And
    all have to be complete, unless that was not asked for: with `--no-subdivide`, or `certified` is None
    (either will do) or False (not all).
    """
    done = {}

    def make(source, *flags, to="out.glb", certified=True):
        key = json.dumps([source if isinstance(source, dict) else str(source), flags, to])
        if key not in done:
            directory = tmp_path_factory.mktemp("export")
            allowed = []
            if isinstance(source, dict):
                # The scene lies in a directory of its own, its meshes do not.
                meshes = [spec["file"] for spec in source["objects"] if "file" in spec]
                allowed = [word for mesh in meshes for word in ("--allow-read", Path(mesh).parent)]
                scene = directory / "scene.json"
                scene.write_text(json.dumps(source))
                source = scene
            report = directory / "report.json"
            ended = run(
                "export", source, *flags, *allowed, "-o", directory / to, "--report", report
            )
            done[key] = directory / to, ended
            (directory / "messages.txt").write_bytes(ended.stderr)
        path, ended = done[key]
        said = f"{ended.args} gave {ended.returncode}\n{ended.stderr.decode()}"
        assert ended.returncode in (0, 1), said
        reports = [json.loads(file.read_text()) for file in path.parent.glob("report*.json")]
        complete = all(
            facts["certificate"]["complete"] for report in reports for facts in report["objects"]
        )
        assert ended.returncode == (0 if complete else 1), said
        if "--no-subdivide" not in flags and certified is not None:
            assert complete == certified, said
        return path

    return make


@pytest.fixture(scope="session")
def placed_vertices(export):
    """The vertices of an object's mesh, scaled, turned and in its rest frame, with double precision.

    The program itself tells them: they are where an observer at rest sees the same object when its
    origin is at the observer's place.
    """

    def vertices(spec):
        import ply

        at_rest = {k: v for k, v in spec.items() if k not in ("position", "velocity")}
        return ply.read(export({"objects": [at_rest]}, "--no-subdivide", to="rest.ply"))

    return vertices
