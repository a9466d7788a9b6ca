"""The comparison of speed (`tests/bench/goals.py`) gives no number for what did not run."""

import os
import subprocess
import sys
from pathlib import Path

GOALS = Path(__file__).parent.parent / "bench" / "goals.py"


def ended(*command):
    done = subprocess.run([sys.executable, *command], capture_output=True, text=True, timeout=60)
    assert done.returncode != 0, done
    assert done.stdout == "", done
    return done.stderr


def test_without_what_it_compares_with_nothing_is_measured():
    # -S leaves out installed packages, and with them numpy.
    said = ended("-S", GOALS, os.environ["PHOTOSURFACE_BINARY"])
    assert "has no numpy, scipy, trimesh to compare with" in said


def test_a_command_that_fails_is_not_measured():
    # Its own part for numpy, as it is run by itself, with a mesh that is not there.
    failing = [sys.executable, str(GOALS), "--numpy", "absent.glb", "out.glb"]
    said = ended("-c", f"import sys; sys.path[0] = {str(GOALS.parent)!r}; import goals; goals.run({failing!r})")
    assert "ended with 1: nothing is measured" in said
    assert "Traceback" in said
