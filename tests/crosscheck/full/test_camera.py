"""Through the camera of a file Blender sees what `render` draws by rays of light, without a photosurface."""

import bpy
import numpy
import pytest
from PIL import Image

import blender

SIZE = (320, 180)
# Colours of nothing in these scenes.
BACKGROUND = "#ff00ff"

# An observer inside a marker flies along x towards things on both sides of the way.
SCENE = {
    "observer": {"velocity": [0.7, 0, 0], "marker": 0.05},
    "steps": [-1, 0, 1],
    "objects": [
        {"name": "ball", "shape": {"sphere": {"radius": 1}}, "position": [3, 1.5, -1.2]},
        {"name": "cube", "shape": {"box": {"size": [1, 1.5, 1]}}, "position": [2.5, -1, 1.2]},
        {"name": "ring", "shape": {"torus": {"major_radius": 1, "minor_radius": 0.3}}, "position": [4, 0, -1]},
    ],
}
AIMS = {
    "as render looks": [],
    "tracking": ["--track"],
    "along a direction": ["--look", "1,0.1,-0.1", "--fov", "40"],
    "at a place": ["--target", "6,0,1", "--fov", "50"],
}


@pytest.fixture
def drawn(photosurface, tmp_path):
    """By step: where `render` draws something."""

    def drawn(scene, *flags):
        flags = [*flags, "--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", "1", "--background", BACKGROUND]
        path = tmp_path / "rays.png"
        photosurface("render", scene, "--method", "rays", "--projection", "perspective", *flags, "-o", path)
        pictures = [numpy.asarray(Image.open(step).convert("RGB")) for step in sorted(tmp_path.glob("rays*.png"))]
        return [(picture != [255, 0, 255]).any(axis=2) for picture in pictures]

    return drawn


def outline(mask):
    """The pixels of which a neighbour is not in the mask, or is where they are not."""
    padded = numpy.pad(mask, 1, mode="edge")
    neighbours = [padded[1:-1, :-2], padded[1:-1, 2:], padded[:-2, 1:-1], padded[2:, 1:-1]]
    return numpy.any([side != mask for side in neighbours], axis=0)


def assert_same_silhouette(found, expected):
    assert 1000 < expected.sum() < expected.size - 1000
    edge = outline(expected)
    differing = found != expected
    assert not (differing & ~edge).any()
    assert differing.sum() < 0.02 * edge.sum()


def silhouette(path):
    """Where Blender draws something through the scene's camera."""
    # One sample in the middle of each pixel, as the rays are.
    bpy.context.scene.render.filter_size = 0.01
    return blender.render(path, SIZE, "CYCLES", samples=1)[..., 3] > 0.5


def use(camera):
    bpy.context.scene.camera = camera


@pytest.mark.parametrize("aim", AIMS)
def test_each_of_several_steps_has_its_camera(aim, export, drawn, tmp_path):
    path = export(SCENE, "--tolerance", "1e-4", "--camera", *AIMS[aim])
    objects = blender.open_file(path)
    expected = drawn(path.parent / "scene.json", *AIMS[aim])
    assert len(expected) == 3
    for step, mask in enumerate(expected):
        parent = bpy.data.objects[f"step{step:03}"]
        meshes = {name for name, found in objects.items() if found.parent == parent}
        assert len(meshes) == 3
        (camera,) = [child for child in parent.children if child.type == "CAMERA"]
        blender.show_only(objects, meshes | {"observer"})
        use(camera)
        assert_same_silhouette(silhouette(tmp_path / f"{step}.png"), mask)


@pytest.mark.parametrize("how", ["--animate", "--animate=morph"])
def test_an_animation_has_a_camera_that_turns(how, export, drawn, tmp_path):
    path = export(SCENE, "--tolerance", "1e-4", "--camera", "--track", how)
    blender.open_file(path)
    (camera,) = [found for found in bpy.data.objects if found.type == "CAMERA"]
    use(camera)
    for step, mask in enumerate(drawn(path.parent / "scene.json", "--track")):
        bpy.context.scene.frame_set(step)
        assert_same_silhouette(silhouette(tmp_path / f"{step}.png"), mask)


def test_a_mesh_alone_fills_the_picture_as_render_has_it(export, drawn, tmp_path):
    path = tmp_path / "roof.obj"
    path.write_text("v -1 0 0\nv 1 0 0\nv 0 1 1\nv 0 -1 0.5\nf 1 2 3\nf 1 4 2\n")
    flags = ["--beta", "0.8", "--direction", "0.3,0,-1"]
    exported = export(path, *flags, "--tolerance", "1e-4", "--camera")
    blender.open_file(exported)
    (camera,) = [found for found in bpy.data.objects if found.type == "CAMERA"]
    use(camera)
    (mask,) = drawn(path, *flags)
    assert_same_silhouette(silhouette(tmp_path / "mesh.png"), mask)
