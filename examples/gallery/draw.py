"""Draws the pictures of the README from files that the program writes.

    python examples/gallery/draw.py target/release/photosurface

needs pyvista and, on a machine without a screen, libegl1 and libgl1. Each picture shows the photosurfaces of one
built-in scene at all its steps, seen at right angles to the motion, as in Figs. 3 and 4 of Rau, Weiskopf and
Ruder (1998). The small red sphere is the observer, who flies to the left.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
import pyvista  # noqa: E402  (after the environment that it reads)

GALLERY = pathlib.Path(__file__).parent


def draw(binary: str, scene: str) -> None:
    """Writes gallery/SCENE.png."""
    with tempfile.TemporaryDirectory() as directory:
        path = os.path.join(directory, f"{scene}.glb")
        subprocess.run([binary, "export", "--example", scene, "-q", "-o", path], check=True)
        plotter = pyvista.Plotter(off_screen=True, window_size=(1200, 280))
        plotter.import_gltf(path)
    plotter.set_background("white")
    plotter.remove_all_lights()
    plotter.add_light(pyvista.Light(light_type="headlight", intensity=3.0))
    plotter.enable_parallel_projection()
    plotter.enable_anti_aliasing("ssaa")
    bounds = plotter.bounds
    middle = [(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2, 0]
    plotter.camera_position = [(middle[0], middle[1], 60), middle, (0, 1, 0)]
    width, height = plotter.window_size
    plotter.camera.parallel_scale = 0.52 * max(bounds[3] - bounds[2], (bounds[1] - bounds[0]) * height / width)
    plotter.screenshot(GALLERY / f"{scene}.png")


if __name__ == "__main__":
    for name in ("sphere", "cube"):
        draw(sys.argv[1], name)
